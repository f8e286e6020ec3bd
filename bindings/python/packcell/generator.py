"""Streams and sets of items."""
from __future__ import annotations

import ctypes
from ctypes import byref
from enum import IntEnum
from typing import Optional

from . import _raw as raw
from ._handle import Handle
from ._marshal import initialised, int32, ranged, text
from .errors import check
from .records import Item, item_out

_MOST_ITEMS = 1 << 24  # asked for at once: 256 MB


class Generate(IntEnum):
    RANDOM = raw.PKC_GENERATE_RANDOM  # sides uniform on 1..W/2 and 1..H/2
    FULL = raw.PKC_GENERATE_FULL  # sets that fill the bin, the paper's Algorithm 4


class Generator(Handle):
    """Items for bins of w x h cells (10 x 10). Equal options give equal items on every machine.
    `mean` of FULL's sides, as a fraction of the bin's, above 0 and at most 1, and `sigma`, in
    cells, above 0 and at most 128; `preset` ("text", "table") sets both, before those that are
    given."""

    _free = raw.pkc_generator_free

    def __init__(self, kind: int = Generate.RANDOM, *, w: Optional[int] = None,
                 h: Optional[int] = None, preset: Optional[str] = None,
                 mean: Optional[float] = None, sigma: Optional[float] = None,
                 seed: Optional[int] = None) -> None:
        options = initialised(raw.pkc_generator_options, kind=int32("kind", kind), w=w, h=h,
                              mean=mean, sigma=sigma, seed=seed)
        if preset is not None:
            given = options.mean, options.sigma
            check(raw.pkc_generator_preset(byref(options), text("preset", preset)))
            options.mean = options.mean if mean is None else given[0]
            options.sigma = options.sigma if sigma is None else given[1]
        self._kind, self._most = options.kind, options.w * options.h
        made = ctypes.POINTER(raw.pkc_generator)()
        check(raw.pkc_generator_create(byref(options), byref(made)))
        self._take(made)

    def next(self, count: Optional[int] = None) -> list[Item]:
        """RANDOM: the stream's next `count` items (1), ids counting on. FULL: the next set,
        shuffled, ids from 0; a `count` that is too small for it is a CapacityError."""
        if count is None:
            count = self._most if self._kind == Generate.FULL else 1
        count = ranged("count", count, 0, _MOST_ITEMS)
        items = (raw.pkc_item * count)()
        made = ctypes.c_size_t()
        check(raw.pkc_generator_next(self._handle, items, count, byref(made)))
        return [item_out(item) for item in items[:made.value]]
