"""The bin: what is packed where, and what still fits."""
from __future__ import annotations

import ctypes
from ctypes import byref
from typing import Any, NamedTuple

from . import _marshal, _raw as raw
from ._handle import Handle
from ._marshal import Array, gathered, initialised, int32, read
from .errors import check
from .records import ItemLike, Placement, item_in, placement_out


class BinInfo(NamedTuple):
    w: int
    h: int
    items: int
    occupied_cells: int  # fixed cells and items
    fixed_cells: int
    hash: int  # of the occupied cells; equal occupancy, equal hash


class Bin(Handle):
    """A bin of w x h cells, each 1..128: x to the right, y down, the origin at the top left."""

    _free = raw.pkc_bin_free

    def __init__(self, w: int, h: int) -> None:
        made = ctypes.POINTER(raw.pkc_bin)()
        check(raw.pkc_bin_create(int32("w", w), int32("h", h), byref(made)))
        self._take(made)

    def clone(self) -> Bin:
        made = ctypes.POINTER(raw.pkc_bin)()
        check(raw.pkc_bin_clone(self._handle, byref(made)))
        return Bin._adopt(made)

    __copy__ = clone

    def __deepcopy__(self, _memo: Any) -> Bin:
        return self.clone()

    def clear(self) -> None:
        """Removes every item; fixed cells stay."""
        check(raw.pkc_bin_clear(self._handle))

    def block(self, x: int, y: int, w: int, h: int) -> None:
        """Marks free cells as taken from the start; they count in the utilisation."""
        check(raw.pkc_bin_block(self._handle, int32("x", x), int32("y", y), int32("w", w),
                                int32("h", h)))

    def pack(self, item: ItemLike, x: int, y: int, rot: int = 0) -> None:
        """Puts an item with its top-left corner at (x, y); rot 1 turns it by a quarter.
        A StateError if it does not lie on free cells alone, its id is in the bin already, or it
        must not turn."""
        check(raw.pkc_bin_pack(self._handle, byref(item_in(item)), int32("x", x), int32("y", y),
                               int32("rot", rot)))

    def unpack(self, id: int) -> Placement:
        """Takes an item out, and says where it was; a StateError if it is not there or pinned."""
        placement = raw.pkc_placement()
        check(raw.pkc_bin_unpack(self._handle, int32("id", id), byref(placement)))
        return placement_out(placement)

    @property
    def info(self) -> BinInfo:
        info = initialised(raw.pkc_bin_info)
        check(raw.pkc_bin_get_info(self._handle, byref(info)))
        return read(BinInfo, info)

    @property
    def w(self) -> int:
        return self.info.w

    @property
    def h(self) -> int:
        return self.info.h

    @property
    def utilization(self) -> float:
        """Share of the cells that are taken, 0..1."""
        info = self.info
        return info.occupied_cells / (info.w * info.h)

    def items(self) -> list[Placement]:
        """In packing order."""
        handle = self._handle
        return [placement_out(p) for p in gathered(
            raw.pkc_placement, lambda *out: raw.pkc_bin_items(handle, *out))]

    def cells(self) -> Array:
        """Cell by cell, [y, x] of an int32 ndarray (without NumPy: [y][x] of lists): the id of the
        item there, CELL_FREE or CELL_FIXED."""
        handle = self._handle
        w = self.w
        array = gathered(ctypes.c_int32, lambda *out: raw.pkc_bin_cells(handle, *out))
        if _marshal.numpy is not None:
            return _marshal.flat(array).reshape(-1, w)
        return [array[at:at + w] for at in range(0, len(array), w)]

    def feasible(self, w: int, h: int) -> Array:
        """The mask of the paper's Sec. IV-A for an item that covers w x h cells as it is turned:
        W*H + 1 bools of an ndarray (without NumPy: bytes), by position x + y*W; the last is "no
        position", true only when no other is."""
        handle = self._handle
        across, down = int32("w", w), int32("h", h)
        array = gathered(ctypes.c_uint8,
                         lambda *out: raw.pkc_bin_feasible(handle, across, down, *out))
        return bytes(array) if _marshal.numpy is None else _marshal.flat(array).view(bool)

    def contact(self, x: int, y: int, w: int, h: int) -> int:
        """The contact reward, paper eq. (3), of a free rectangle: 0..2(w+h)."""
        reward = ctypes.c_int32()
        check(raw.pkc_bin_contact(self._handle, int32("x", x), int32("y", y), int32("w", w),
                                  int32("h", h), byref(reward)))
        return reward.value
