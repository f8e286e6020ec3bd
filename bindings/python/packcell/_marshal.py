"""Values on their way to the library and back: ctypes alone would cut a number that is too large
and end a text at its first zero without a word."""
from __future__ import annotations

import ctypes
import operator
import os
from enum import IntEnum
from typing import Any, Callable, Optional, Sequence, SupportsFloat, SupportsIndex, TypeVar, Union

from . import _raw as raw
from .errors import argument_error, check

try:
    import numpy as numpy
except ImportError:
    numpy = None  # type: ignore[assignment]

# An ndarray where NumPy is installed, else lists or bytes, as each function says.
Array = Any
Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]

E = TypeVar("E", bound=IntEnum)
R = TypeVar("R")


def ranged(name: str, value: SupportsIndex, least: int, most: int) -> int:
    """An int of any integer type (NumPy's too) within these bounds."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be an integer, not {type(value).__name__}") from None
    if not least <= number <= most:
        # Python refuses to write out a number of very many digits.
        told = str(number) if number.bit_length() <= 128 else f"of {number.bit_length()} bits"
        raise argument_error(f"{name} {told}: must be {least}..{most}")
    return number


def int32(name: str, value: SupportsIndex) -> int:
    return ranged(name, value, -(1 << 31), (1 << 31) - 1)


def uint32(name: str, value: SupportsIndex) -> int:
    return ranged(name, value, 0, (1 << 32) - 1)


def uint64(name: str, value: SupportsIndex) -> int:
    return ranged(name, value, 0, (1 << 64) - 1)


def real(name: str, value: SupportsFloat) -> float:
    if isinstance(value, (str, bytes)) or not hasattr(value, "__float__"):
        if not hasattr(value, "__index__"):
            raise TypeError(f"{name} must be a number, not {type(value).__name__}")
    try:
        return float(value)
    except OverflowError:
        raise argument_error(f"{name}: too large for a double") from None
    except TypeError:  # an array that is not one number, say
        raise TypeError(f"{name} must be a number, not {type(value).__name__}") from None


def utf8(name: str, value: str) -> bytes:
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a str, not {type(value).__name__}")
    try:
        return value.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError as error:
        raise argument_error(f"{name} {value!r}: {error.reason}") from None


def text(name: str, value: str) -> bytes:
    """For C, which reads to the first zero."""
    encoded = utf8(name, value)
    if b"\0" in encoded:
        raise argument_error(f"{name} {value!r}: must not hold a zero")
    return encoded


def path(value: Path) -> bytes:
    try:
        name = os.fsencode(value)
    except UnicodeEncodeError as error:
        raise argument_error(f"path {value!r}: {error.reason}") from None
    if b"\0" in name:
        raise argument_error(f"path {name!r}: must not hold a zero")
    return name


def octets(name: str, value: Any) -> bytes:
    """Any bytes-like object as bytes; not a number, of which bytes() would make so many zeros."""
    try:
        return memoryview(value).tobytes()
    except TypeError:
        raise TypeError(f"{name} must be bytes-like, not {type(value).__name__}") from None


def known(enum: type[E], value: int) -> E:
    """The member, or the bare number that a later library may give."""
    try:
        return enum(value)
    except ValueError:
        return value  # type: ignore[return-value]


_CONVERT: dict[Any, Callable[[str, Any], Any]] = {
    ctypes.c_int32: int32,
    ctypes.c_uint32: uint32,
    ctypes.c_uint64: uint64,
    ctypes.c_double: real,
}


def initialised(struct: type[Any], **fields: Any) -> Any:
    """A struct with the library's defaults and, over them, the fields that are not None."""
    value = struct()
    check(getattr(raw, struct.__name__ + "_init")(ctypes.byref(value), ctypes.sizeof(value)))
    types = dict(struct._fields_)
    for name, given in fields.items():
        if given is None:
            continue
        convert = _CONVERT.get(types[name])
        if convert is not None:
            setattr(value, name, convert(name, given))
            continue
        encoded = text(name, given)
        if len(encoded) >= ctypes.sizeof(types[name]):
            raise argument_error(
                f"{name} {given!r}: must be at most {ctypes.sizeof(types[name]) - 1} bytes")
        setattr(value, name, encoded)
    return value


def read(record: Callable[..., R], struct: Any, **changed: Any) -> R:
    """A NamedTuple from the struct's fields of the same names, but for those given."""
    fields: Sequence[str] = record._fields  # type: ignore[attr-defined]
    values = {}
    for name in fields:
        value = changed[name] if name in changed else getattr(struct, name)
        if isinstance(value, bytes):
            value = value.decode("utf-8", "replace")
        elif isinstance(value, ctypes.Array):
            value = tuple(value)
        values[name] = value
    return record(**values)


def gathered(element: Any, call: Callable[[Any, int, Any], int]) -> Any:
    """The ctypes array that a call with (array, capacity, out_count) fills."""
    count = ctypes.c_size_t()
    array: Any = None
    while True:
        capacity = 0 if array is None else len(array)
        status = call(array, capacity, ctypes.byref(count))
        if status == raw.PKC_E_CAPACITY and count.value > capacity:
            array = (element * count.value)()
            continue
        check(status)
        if count.value == capacity:
            return array if array is not None else (element * 0)()
        return (element * count.value)(*(array or ())[:count.value])


def gathered_bytes(call: Callable[[Any, int, Any], int]) -> bytes:
    return bytes(gathered(ctypes.c_uint8, call))


def gathered_text(call: Callable[[Any, int, Any], int]) -> str:
    return bytes(gathered(ctypes.c_char, call)).decode("utf-8")


def names(call: Callable[[int], Optional[bytes]]) -> list[str]:
    """What a function of an index names, until NULL."""
    found: list[str] = []
    while True:
        name = call(len(found))
        if name is None:
            return found
        found.append(name.decode("utf-8"))


def flat(array: Any) -> Array:
    """A ctypes array as an ndarray that shares its memory, or as a list."""
    return list(array) if numpy is None else numpy.ctypeslib.as_array(array)
