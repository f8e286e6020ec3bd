"""From the millimetres of a real bin to cells and back."""
from __future__ import annotations

import ctypes
from ctypes import byref
from typing import Optional

from . import _raw as raw
from ._marshal import initialised, int32, real
from .errors import check


class Grid:
    """A side has floor((side - 2 * margin) / cell) cells; an item takes ceil((side + clearance) /
    cell). All in millimetres, up to 1e6; what is not given is the paper's: 320 x 260, margin 10,
    cell 30, clearance 0."""

    def __init__(self, *, bin_w: Optional[float] = None, bin_h: Optional[float] = None,
                 margin: Optional[float] = None, cell: Optional[float] = None,
                 clearance: Optional[float] = None) -> None:
        self._grid = initialised(raw.pkc_grid, bin_w=bin_w, bin_h=bin_h, margin=margin, cell=cell,
                                 clearance=clearance)
        self.bin()

    def bin(self) -> tuple[int, int]:
        """Cells of the bin's sides."""
        w, h = ctypes.c_int32(), ctypes.c_int32()
        check(raw.pkc_grid_bin(byref(self._grid), byref(w), byref(h)))
        return w.value, h.value

    def item(self, w: float, h: float) -> tuple[int, int]:
        """Cells that an item of w x h millimetres takes."""
        across, down = ctypes.c_int32(), ctypes.c_int32()
        check(raw.pkc_grid_item(byref(self._grid), real("w", w), real("h", h), byref(across),
                                byref(down)))
        return across.value, down.value

    def centre(self, x: int, y: int, w: int, h: int) -> tuple[float, float]:
        """Centre of a w x h cell rectangle at cell (x, y), in millimetres from the inside top-left
        corner of the bin: where an item is put down with its own centre."""
        to_right, down = ctypes.c_double(), ctypes.c_double()
        check(raw.pkc_grid_centre(byref(self._grid), int32("x", x), int32("y", y), int32("w", w),
                                  int32("h", h), byref(to_right), byref(down)))
        return to_right.value, down.value
