"""What the environments play: the paper's low-level decision process (Sec. III-C), item by item."""
from __future__ import annotations

import os
from typing import Any, Mapping, NamedTuple, Optional, SupportsIndex

from ._marshal import ranged, real, uint64
from .errors import argument_error
from .records import MAX_SIDE

_MASK = (1 << 64) - 1
GOLDEN = 0x9E3779B97F4A7C15
CONTACT_SCALE = 20.0


def mix64(v: int) -> int:
    """SplitMix64: its finaliser after one step."""
    v = (v + GOLDEN) & _MASK
    v = ((v ^ (v >> 30)) * 0xBF58476D1CE4E5B9) & _MASK
    v = ((v ^ (v >> 27)) * 0x94D049BB133111EB) & _MASK
    return v ^ (v >> 31)


def stream_state(seed: SupportsIndex, stream: int = 0) -> int:
    """Where a stream of items begins: one of many for each seed."""
    return mix64((mix64(uint64("seed", seed)) + stream) & _MASK)


class Stream:
    """Sides of items: the same for equal seeds on every machine, with NumPy and without."""

    def __init__(self, seed: SupportsIndex) -> None:
        self.state = stream_state(seed)

    def below(self, bound: int) -> int:
        drawn = mix64(self.state)
        self.state = (self.state + GOLDEN) & _MASK
        return (drawn >> 32) * bound >> 32


class Protocol(NamedTuple):
    """`items` 0: the first item without a position closes the bin, and begins the next one. n: so
    many are offered to a bin, and those without a position are skipped. `rotation`: an item may
    be turned, which doubles the positions. `reward_fill`: share of the closed bin's utilisation in
    the reward; the rest is the contact reward over 20."""

    w: int
    h: int
    least_side: int
    most_side: int
    items: int
    rotation: bool
    reward_fill: float

    @property
    def positions(self) -> int:
        return self.w * self.h * (2 if self.rotation else 1)

    @property
    def actions(self) -> int:
        return self.positions + 1


def checked(protocol: Protocol, most: int = MAX_SIDE) -> Protocol:
    """The same in Python's own numbers; raises on values out of range. `most` cells a side are
    allowed."""
    w, h = ranged("w", protocol.w, 1, most), ranged("h", protocol.h, 1, most)
    least_side = ranged("least_side", protocol.least_side, 1, min(w, h))
    most_side = ranged("most_side", protocol.most_side, least_side, min(w, h))
    items = ranged("items", protocol.items, 0, 1000000)
    reward_fill = real("reward_fill", protocol.reward_fill)
    if not 0 <= reward_fill <= 1:
        raise argument_error(f"reward_fill {reward_fill}: must be 0..1")
    return Protocol(w, h, least_side, most_side, items, bool(protocol.rotation), reward_fill)


def fresh_seed() -> int:
    return int.from_bytes(os.urandom(8), "little")


def refuse_options(options: Optional[Mapping[str, Any]]) -> None:
    if options:
        raise argument_error(f"option {next(iter(options))!r}: reset knows none")
