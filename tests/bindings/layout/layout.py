"""Prints the layout of every struct as ctypes has it."""
import ctypes

from packcell import _raw

for struct in _raw.STRUCTS:
    print(struct.__name__, ctypes.sizeof(struct))
    for name, *_ in struct._fields_:
        print(f"{struct.__name__}.{name} {getattr(struct, name).offset}")
