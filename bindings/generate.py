#!/usr/bin/env python3
"""Generates what the bindings know of packcell.h: api.json, and from it the raw layers.

usage: generate.py                    write api.json and the raw layer of every language
       generate.py --check            say which of them is not what the header gives; status 1
       generate.py --layout           print the layout of every struct as the C compiler has it
       generate.py --layout-check     compare such lines on stdin, in any order, with the C
                                      compiler's; status 1

Needs clang, which reads the header, and a C compiler (CC, else cc), which measures the structs.
"""
import difflib
import json
import pathlib
import sys

sys.dont_write_bytecode = True
from generate import csharp, header, java, node, python, rust  # noqa: E402 (the line above)

BINDINGS = pathlib.Path(__file__).resolve().parent
HEADER = BINDINGS.parent / "include" / "packcell.h"

LAYERS = {
    "python/packcell/_raw.py": python.emit,
    "rust/packcell-sys/src/lib.rs": rust.emit,
    "csharp/Packcell/Raw.cs": csharp.emit,
    "java/src/io/packcell/Raw.java": java.emit,
    "node/raw.js": node.emit,
}


def generated():
    """What every file should hold, by its path in bindings/."""
    api = header.read(HEADER)
    texts = {"api.json": json.dumps(api, indent=2, ensure_ascii=False) + "\n"}
    for path, emit in LAYERS.items():
        texts[path] = emit(api)
    return texts


def write():
    for path, text in generated().items():
        target = BINDINGS / path
        if not target.is_file() or target.read_text(encoding="utf-8") != text:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
            print(f"wrote bindings/{path}")


def check():
    status = 0
    for path, text in generated().items():
        target = BINDINGS / path
        there = target.read_text(encoding="utf-8") if target.is_file() else ""
        if there != text:
            status = 1
            print(f"bindings/{path} is not what include/packcell.h gives: run bindings/generate.py")
            lines = difflib.unified_diff(there.splitlines(), text.splitlines(), "checked in",
                                         "generated", n=1, lineterm="")
            for line in list(lines)[:20]:
                print(f"    {line}")
    return status


def layout_check():
    expected = sorted(header.layout_lines(header.read(HEADER)))
    found = sorted(line.strip() for line in sys.stdin if line.strip())
    if found == expected:
        return 0
    for line in difflib.unified_diff(expected, found, "C compiler", "binding", n=0, lineterm=""):
        print(line)
    return 1


def main():
    arguments = sys.argv[1:]
    try:
        if arguments == []:
            write()
        elif arguments == ["--check"]:
            return check()
        elif arguments == ["--layout"]:
            print("\n".join(header.layout_lines(header.read(HEADER))))
        elif arguments == ["--layout-check"]:
            return layout_check()
        else:
            print(__doc__, file=sys.stderr)
            return 2
    except header.HeaderError as error:
        print(f"generate.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
