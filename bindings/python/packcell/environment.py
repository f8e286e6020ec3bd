"""The low level as a decision process (paper, Sec. III-B), many bins side by side: what packcell.env
is made of."""
from __future__ import annotations

import ctypes
from ctypes import byref
from typing import Any, NamedTuple, Optional, Sequence, SupportsIndex

from . import _marshal, _raw as raw
from ._handle import Handle
from ._marshal import Array, initialised, int32, read, real, uint64
from .errors import argument_error, check
from .training_options import Rotation


class EnvironmentInfo(NamedTuple):
    count: int  # type: ignore[assignment]  # bins side by side
    bin_w: int  # cells
    bin_h: int
    actions: int  # w*h + 1, or 2*w*h + 1 where items may be turned
    closed: int  # bins that are closed now
    steps: int  # items placed since the creation
    bins: int  # bins closed since then


class StepOutcome(NamedTuple):
    """Of a step, a value for each bin."""

    rewards: Array  # (1 - reward_fill) * contact / 20, and reward_fill * utilisation at the end
    contacts: Array  # the contact reward of paper eq. (3)
    closed: Array  # 1 where the bin closed


class Observation(NamedTuple):
    """Of n bins; arrays of the caller's own."""

    cells: Array  # n x h x w, 1 where taken
    sizes: Array  # n x 2: the item's sides
    mask: Array  # n x actions, 1 where the action is allowed
    occupied: Array  # n: taken cells


def _shaped(array: Any, kind: str, *shape: int) -> Array:
    """A ctypes array as an ndarray that has its memory, or as lists of lists."""
    if _marshal.numpy is not None:
        return _marshal.numpy.frombuffer(array, kind).reshape(shape)
    values: list[Any] = list(array)
    for size in reversed(shape[1:]):
        values = [values[at:at + size] for at in range(0, len(values), size)]
    return values


def _int32s(name: str, values: Any) -> Any:
    """A ctypes array of a sequence of integers, fast where it is an ndarray."""
    np = _marshal.numpy
    if np is None or not isinstance(values, np.ndarray):
        return (ctypes.c_int32 * len(values))(*(int32(name, value) for value in values))
    if values.dtype.kind not in "iu":
        raise TypeError(f"{name} must be integers, not {values.dtype}")
    if values.ndim != 1:
        raise argument_error(f"{name} of {values.ndim} dimensions: must have 1")
    narrow: Any = values.astype(np.int32)
    wide = np.flatnonzero(narrow != values)
    if wide.size:
        int32(name, values[wide[0]])
    return (ctypes.c_int32 * len(narrow)).from_buffer(memoryview(narrow))


class Environment(Handle):
    """`count` bins of w x h cells, 1..65536 of them with at most 2^24 cells together. Items have
    sides least_side..most_side. With `items` 0 the first one without a position closes the bin and
    begins the next; else so many are offered to a bin, and those without a position are skipped.

    An action is the position x + y*w of the item's top-left corner; w*h more for the turned item,
    where rotation is not OFF; the last one is "no position", which only a closed bin has."""

    _free = raw.pkc_environment_free

    def __init__(self, count: int = 1, w: int = 10, h: int = 10, *, least_side: int = 1,
                 most_side: int = 5, items: int = 0, rotation: int = Rotation.OFF,
                 reward_fill: float = 0.0) -> None:
        options = initialised(
            raw.pkc_environment_options, count=int32("count", count), bin_w=int32("w", w),
            bin_h=int32("h", h), least_side=int32("least_side", least_side),
            most_side=int32("most_side", most_side), items=int32("items", items),
            rotation=int32("rotation", rotation), reward_fill=real("reward_fill", reward_fill))
        made = ctypes.POINTER(raw.pkc_environment)()
        check(raw.pkc_environment_create(byref(options), byref(made)))
        self._take(made)
        self._measure()

    def _measure(self) -> None:
        info = self.info
        self._count, self._w, self._h, self._actions = info[:4]

    @property
    def info(self) -> EnvironmentInfo:
        info = initialised(raw.pkc_environment_info)
        check(raw.pkc_environment_get_info(self._handle, byref(info)))
        return read(EnvironmentInfo, info)

    def clone(self) -> Environment:
        made = ctypes.POINTER(raw.pkc_environment)()
        check(raw.pkc_environment_clone(self._handle, byref(made)))
        clone = type(self)._adopt(made)
        clone._measure()
        return clone

    def __copy__(self) -> Environment:
        return self.clone()

    def __deepcopy__(self, _: Any) -> Environment:
        return self.clone()

    def reset(self, seed: Optional[SupportsIndex] = None,
              seeds: Optional[Sequence[SupportsIndex]] = None) -> None:
        """Empties every bin. With `seed` bin i gets its stream i, with `seeds`, one for each bin,
        their streams 0; without them the streams go on with the items that wait."""
        if seeds is None:
            given = [] if seed is None else [uint64("seed", seed)]
        else:
            given = [uint64("seed", one) for one in seeds]
            if len(given) != self._count:
                raise argument_error(f"{len(given)} seeds: must be {self._count}")
        check(raw.pkc_environment_reset(self._handle, (ctypes.c_uint64 * len(given))(*given),
                                        len(given)))

    def step(self, actions: Any) -> StepOutcome:
        """An item into each bin. Nothing is placed where one of the actions is not allowed: an
        ArgumentError, or a StateError if its bin is closed. A closed bin stays as it is until
        open() or reset()."""
        chosen = _int32s("action", actions)
        count = len(chosen)
        rewards = (ctypes.c_double * count)()
        contacts = (ctypes.c_int32 * count)()
        closed = (ctypes.c_uint8 * count)()
        check(raw.pkc_environment_step(self._handle, chosen, count, rewards, contacts, closed))
        return StepOutcome(_shaped(rewards, "f8", count), _shaped(contacts, "i4", count),
                           _shaped(closed, "u1", count))

    def open(self) -> None:
        """Opens the next bin, empty, where one is closed; it begins with the item that closed
        it."""
        check(raw.pkc_environment_open(self._handle))

    def observe(self, which: Any = None) -> Observation:
        """All bins, or those of these indices."""
        indices = None if which is None else _int32s("which", which)
        count = self._count if indices is None else len(indices)
        cells = (ctypes.c_uint8 * (count * self._h * self._w))()
        sizes = (ctypes.c_int32 * (count * 2))()
        mask = (ctypes.c_uint8 * (count * self._actions))()
        occupied = (ctypes.c_int32 * count)()
        check(raw.pkc_environment_observe(self._handle, indices, count, cells, sizes, mask,
                                          occupied))
        return Observation(_shaped(cells, "u1", count, self._h, self._w),
                           _shaped(sizes, "i4", count, 2),
                           _shaped(mask, "u1", count, self._actions),
                           _shaped(occupied, "i4", count))
