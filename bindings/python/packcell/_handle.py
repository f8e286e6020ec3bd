"""What all objects of the library have in common: they own a handle, and give it back once."""
from __future__ import annotations

from typing import Any, Callable, ClassVar, Optional, TypeVar

from .errors import ClosedError, Status

H = TypeVar("H", bound="Handle")


class _Owner:
    """Frees a handle when nobody refers to it any more. ctypes takes it for the handle itself, and
    holds it during a call: an object that another thread closes meanwhile is freed afterwards."""

    __slots__ = ("_as_parameter_", "_free")

    def __init__(self, pointer: Any, free: Callable[[Any], None]) -> None:
        self._as_parameter_ = pointer
        self._free = free

    def __del__(self) -> None:
        self._free(self._as_parameter_)

    def __reduce__(self) -> Any:
        raise TypeError("a handle cannot be copied")


class Handle:
    """A context manager that closes itself; an object left alone is closed with its last reference.
    It belongs to one thread at a time: a second one gets a BusyError."""

    _free: ClassVar[Callable[[Any], None]]
    _owner: Optional[_Owner] = None

    def _take(self, pointer: Any) -> None:
        self._owner = _Owner(pointer, type(self)._free)

    @classmethod
    def _adopt(cls: type[H], pointer: Any) -> H:
        made = cls.__new__(cls)
        made._take(pointer)
        return made

    @property
    def _handle(self) -> _Owner:
        owner = self._owner
        if owner is None:
            raise ClosedError(Status.ARGUMENT, f"the {type(self).__name__} is closed")
        return owner

    @property
    def closed(self) -> bool:
        return self._owner is None

    def close(self) -> None:
        """Gives the handle back; closing twice does no harm."""
        self._owner = None

    def __enter__(self: H) -> H:
        self._handle
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __reduce__(self) -> Any:
        raise TypeError(f"a {type(self).__name__} cannot be pickled")


def handle_of(name: str, value: Any, wanted: type[Handle]) -> _Owner:
    """The handle of an argument that must be an open object of the class."""
    if not isinstance(value, wanted):
        raise TypeError(f"{name} must be a {wanted.__name__}, not {type(value).__name__}")
    return value._handle
