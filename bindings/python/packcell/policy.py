"""The low level: where an item goes."""
from __future__ import annotations

import ctypes
from ctypes import byref
from enum import IntEnum
from typing import Any, Iterable, NamedTuple, Optional

from . import _marshal, _raw as raw
from ._handle import Handle, handle_of
from ._marshal import (Array, Path, flat, gathered_bytes, initialised, int32, known, names, octets,
                       path, read, text, uint64)
from .bin import Bin
from .errors import argument_error, check
from .training_options import TrainerOptions, options_in


class Architecture(IntEnum):
    """What a policy is made of."""

    HEURISTIC = raw.PKC_ARCH_HEURISTIC
    ACTOR_CRITIC = raw.PKC_ARCH_ACTOR_CRITIC
    FULLY_CONVOLUTIONAL = raw.PKC_ARCH_FULLY_CONVOLUTIONAL
    AFTERSTATE = raw.PKC_ARCH_AFTERSTATE


class PolicyInfo(NamedTuple):
    """Where a policy comes from; zeros, and utilization -1, for a heuristic."""

    architecture: Architecture
    bin_w: int  # the bins it serves; 0 x 0: any
    bin_h: int
    parameters: int
    seed: int
    steps: int
    reward_fill: float
    utilization: float  # mean on held-out streams, 0..1; -1: not measured
    learner: str


class Evaluation(NamedTuple):
    """What actor and critic say about an item, by position x + y*W; the last is "no position"."""

    logits: Array
    probabilities: Array
    value: float


class BatchEvaluation(NamedTuple):
    """`positions` has one number a pair, `probabilities` W*H + 1 (rows of a 2-D ndarray, or lists),
    `values` one; what was not asked for is None."""

    positions: Array
    probabilities: Optional[Array]
    values: Optional[Array]


class Measurement(NamedTuple):
    """Mean utilisation, 0..1, and half the width of its 95 % interval."""

    mean: float
    half_width: float


def _pair(at: int, size: Any) -> tuple[int, int]:
    try:
        w, h = size
    except (TypeError, ValueError):
        raise TypeError(f"sizes[{at}] must be a pair (w, h), not {size!r}") from None
    return int32("w", w), int32("h", h)


class Policy(Handle):
    """By name ("default", "contact", ...; see Policy.builtins()), or from a weight blob by
    Policy.load and Policy.load_file. Immutable; threads may share it."""

    _free = raw.pkc_policy_free

    def __init__(self, name: str = "default") -> None:
        made = ctypes.POINTER(raw.pkc_policy)()
        check(raw.pkc_policy_create(text("policy", name), byref(made)))
        self._take(made)

    @staticmethod
    def builtins() -> list[str]:
        return names(raw.pkc_policy_builtin)

    @classmethod
    def load(cls, blob: bytes) -> Policy:
        """From the bytes of a .pkw file."""
        given = octets("blob", blob)
        made = ctypes.POINTER(raw.pkc_policy)()
        check(raw.pkc_policy_load(given, len(given), byref(made)))
        return cls._adopt(made)

    @classmethod
    def load_file(cls, file: Path) -> Policy:
        made = ctypes.POINTER(raw.pkc_policy)()
        check(raw.pkc_policy_load_file(path(file), byref(made)))
        return cls._adopt(made)

    def save(self) -> bytes:
        """The weight blob; an UnsupportedError for a heuristic."""
        handle = self._handle
        return gathered_bytes(lambda *out: raw.pkc_policy_save(handle, *out))

    def save_file(self, file: Path) -> None:
        """All or nothing: if it fails, what was there before is unchanged."""
        check(raw.pkc_policy_save_file(self._handle, path(file)))

    @property
    def name(self) -> str:
        found: bytes = raw.pkc_policy_name(self._handle)
        return found.decode()

    @property
    def info(self) -> PolicyInfo:
        info = initialised(raw.pkc_policy_info)
        check(raw.pkc_policy_get_info(self._handle, byref(info)))
        return read(PolicyInfo, info, architecture=known(Architecture, info.architecture))

    def select(self, bin: Bin, w: int, h: int) -> int:
        """The position x + y*W for an item that covers w x h cells; W*H is "no position"."""
        position = ctypes.c_int32()
        check(raw.pkc_policy_select(self._handle, handle_of("bin", bin, Bin), int32("w", w),
                                    int32("h", h), byref(position)))
        return position.value

    def evaluate(self, bin: Bin, w: int, h: int) -> Evaluation:
        """Logits, probabilities and value; an UnsupportedError for a heuristic. The arrays are
        float32 (without NumPy: lists)."""
        packed = handle_of("bin", bin, Bin)
        info = bin.info
        actions = info.w * info.h + 1
        logits, probabilities = (ctypes.c_float * actions)(), (ctypes.c_float * actions)()
        count, value = ctypes.c_size_t(), ctypes.c_float()
        check(raw.pkc_policy_evaluate(self._handle, packed, int32("w", w), int32("h", h), logits,
                                      probabilities, actions, byref(count), byref(value)))
        return Evaluation(flat(logits), flat(probabilities), value.value)

    def evaluate_batch(self, bins: Iterable[Bin], sizes: Any, *, probabilities: bool = False,
                       values: bool = False) -> BatchEvaluation:
        """The same for many pairs of a bin and a size (w, h) at once, faster than one by one.
        `sizes` is an array of shape (n, 2) or a sequence of pairs. All bins have the same sides;
        the same bin may stand in many pairs. A heuristic gives positions alone."""
        bins = list(bins)
        handles = [handle_of("bin", bin, Bin) for bin in bins]
        pointers = (ctypes.POINTER(raw.pkc_bin) * len(handles))(
            *(handle._as_parameter_ for handle in handles))
        pairs = [_pair(at, size) for at, size in enumerate(sizes)]
        if len(pairs) != len(handles):
            raise argument_error(f"{len(pairs)} sizes for {len(handles)} bins: must be as many")
        count = len(pairs)
        flat_sizes = (ctypes.c_int32 * (2 * count))(*(side for pair in pairs for side in pair))
        info = bins[0].info if count else None
        actions = info.w * info.h + 1 if info is not None else 0
        positions = (ctypes.c_int32 * count)()
        chances = (ctypes.c_float * (count * actions))() if probabilities else None
        worth = (ctypes.c_float * count)() if values else None
        # The array of pointers does not keep the bins: `handles` does, until the call is over.
        status = raw.pkc_policy_evaluate_batch(self._handle, pointers, flat_sizes, count, positions,
                                               chances, worth)
        check(status)
        rows: Optional[Array] = None
        if chances is not None:
            rows = (flat(chances).reshape(count, actions) if _marshal.numpy is not None else
                    [chances[at:at + actions] for at in range(0, len(chances), actions)])
        return BatchEvaluation(flat(positions), rows, None if worth is None else flat(worth))

    def measure(self, options: Optional[TrainerOptions] = None, *, seed: int = 1,
                bins: int = 1000) -> Measurement:
        """Packs so many bins, 1..2^32, of a held-out stream; bins, items and rotation are those of
        the options."""
        mean, half_width = ctypes.c_double(), ctypes.c_double()
        check(raw.pkc_policy_measure(self._handle, byref(options_in(options)), uint64("seed", seed),
                                     uint64("bins", bins), byref(mean), byref(half_width)))
        return Measurement(mean.value, half_width.value)
