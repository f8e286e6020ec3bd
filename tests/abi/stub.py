#!/usr/bin/env python3
"""Writes a C file that defines every function of a header emptily: compiled with -g, it is a
library with the header's binary interface and nothing else, made in a second.

usage: stub.py HEADER >stub.c
"""
import pathlib
import re
import sys

header = pathlib.Path(sys.argv[1])
print(f'#include "{header.resolve()}"')
for declaration in re.findall(r"^PKC_API ([^;#]*\));", header.read_text(encoding="ascii"), re.M):
    print(declaration, "{}" if declaration.startswith("void ") else "{ return 0; }")
