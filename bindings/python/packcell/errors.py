"""What goes wrong: the library's status codes as exceptions, with its own line about the cause."""
from __future__ import annotations

from enum import IntEnum

from . import _raw as raw


class Status(IntEnum):
    """Status of a call; the numbers are pinned."""

    OK = raw.PKC_OK
    ARGUMENT = raw.PKC_E_ARGUMENT
    STRUCT = raw.PKC_E_STRUCT
    MEMORY = raw.PKC_E_MEMORY
    BUSY = raw.PKC_E_BUSY
    STATE = raw.PKC_E_STATE
    CAPACITY = raw.PKC_E_CAPACITY
    LIMIT = raw.PKC_E_LIMIT
    FORMAT = raw.PKC_E_FORMAT
    IO = raw.PKC_E_IO
    UNSUPPORTED = raw.PKC_E_UNSUPPORTED
    INTERNAL = raw.PKC_E_INTERNAL


class PackcellError(Exception):
    """A call that failed. `status` is the library's code, `message` its line: which value, and what
    is allowed."""

    def __init__(self, status: int, message: str) -> None:
        super().__init__(status, message)
        self.status = status
        self.message = message

    def __str__(self) -> str:
        return self.message


class ArgumentError(PackcellError, ValueError):
    """A value lies outside what is allowed."""


class ClosedError(ArgumentError):
    """The object was closed before."""


class StructError(PackcellError):
    """The library does not know a struct's layout: package and library do not fit."""


class OutOfMemoryError(PackcellError, MemoryError):
    """Memory could not be had."""


class BusyError(PackcellError):
    """The object is in use by another thread."""


class StateError(PackcellError):
    """The call does not fit the object's state: an overlap, an item that is not there, ..."""


class CapacityError(PackcellError):
    """An array is too small."""


class LimitError(PackcellError):
    """More than the limits that the object was made with."""


class FormatError(PackcellError, ValueError):
    """Bytes do not hold what they should."""


class FileError(PackcellError):
    """A named file could not be read or written."""


class UnsupportedError(PackcellError):
    """Not in this build of the library, or not something that this policy does."""


class InternalError(PackcellError):
    """A fault of packcell's own; please report it."""


_CLASSES: dict[int, type[PackcellError]] = {
    Status.ARGUMENT: ArgumentError,
    Status.STRUCT: StructError,
    Status.MEMORY: OutOfMemoryError,
    Status.BUSY: BusyError,
    Status.STATE: StateError,
    Status.CAPACITY: CapacityError,
    Status.LIMIT: LimitError,
    Status.FORMAT: FormatError,
    Status.IO: FileError,
    Status.UNSUPPORTED: UnsupportedError,
    Status.INTERNAL: InternalError,
}


def check(status: int) -> None:
    """Raises what a status stands for. Must directly follow the call that gave it: the library's
    line about it lasts until this thread's next call."""
    if status != raw.PKC_OK:
        message: bytes = raw.pkc_last_error() or b""
        raise _CLASSES.get(status, PackcellError)(status, message.decode("utf-8", "replace"))


def argument_error(message: str) -> ArgumentError:
    """For values that would not survive the way into the library."""
    return ArgumentError(Status.ARGUMENT, message)
