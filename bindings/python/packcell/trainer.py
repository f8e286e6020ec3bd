"""Training of policies."""
from __future__ import annotations

import ctypes
from ctypes import byref
from typing import Any, NamedTuple, Optional

from . import _raw as raw
from ._handle import Handle
from ._marshal import Path, initialised, int32, path, read, uint64
from .errors import check
from .policy import Measurement, Policy
from .training_options import Rotation, TrainerOptions, options_in


class TrainerInfo(NamedTuple):
    """How far a training is, and means over the last run."""

    updates: int  # since the training began
    steps: int  # items placed since then
    bins: int  # closed since then
    policy_loss: float
    value_loss: float
    entropy: float  # of the policy, in nats
    reward: float  # sum over a bin
    utilization: float  # of the bins closed, 0..1, while the policy explores


class Trainer(Handle):
    """A training. TrainerOptions, or the same names as keywords."""

    _free = raw.pkc_trainer_free

    def __init__(self, options: Optional[TrainerOptions] = None, **settings: Any) -> None:
        if settings:
            if options is not None:
                raise TypeError("either options or keywords")
            options = TrainerOptions(**settings)
        made = ctypes.POINTER(raw.pkc_trainer)()
        check(raw.pkc_trainer_create(byref(options_in(options)), byref(made)))
        self._take(made)

    @classmethod
    def load_file(cls, file: Path) -> Trainer:
        """A training that was saved goes on bit for bit."""
        made = ctypes.POINTER(raw.pkc_trainer)()
        check(raw.pkc_trainer_load_file(path(file), byref(made)))
        return cls._adopt(made)

    def save_file(self, file: Path) -> None:
        check(raw.pkc_trainer_save_file(self._handle, path(file)))

    def run(self, updates: int) -> None:
        """Trains for so many updates, 0..2^48. However they are split, the training is the same.
        Other threads run meanwhile, and may call cancel(); Ctrl-C is heard once the call ends. A
        StateError if the gradient is not finite any more."""
        check(raw.pkc_trainer_run(self._handle, uint64("updates", updates)))

    def cancel(self) -> None:
        """From any thread: a run under way returns within some updates."""
        check(raw.pkc_trainer_cancel(self._handle))

    @property
    def info(self) -> TrainerInfo:
        info = initialised(raw.pkc_trainer_info)
        check(raw.pkc_trainer_get_info(self._handle, byref(info)))
        return read(TrainerInfo, info)

    @property
    def options(self) -> TrainerOptions:
        options = initialised(raw.pkc_trainer_options)
        check(raw.pkc_trainer_get_options(self._handle, byref(options)))
        values = {name: getattr(options, name) for name in TrainerOptions.__dataclass_fields__}
        values["name"] = options.name.decode()
        return TrainerOptions(**values)

    def policy(self) -> Policy:
        """What has been learned so far; training on does not change it."""
        made = ctypes.POINTER(raw.pkc_policy)()
        check(raw.pkc_trainer_policy(self._handle, byref(made)))
        return Policy._adopt(made)

    def measure(self, *, rotation: int = Rotation.OFF, seed: int = 1,
                bins: int = 1000) -> Measurement:
        """Packs so many bins, 1..2^32, of a held-out stream by the policy so far, always its most
        probable position."""
        mean, half_width = ctypes.c_double(), ctypes.c_double()
        check(raw.pkc_trainer_measure(self._handle, int32("rotation", rotation),
                                      uint64("seed", seed), uint64("bins", bins), byref(mean),
                                      byref(half_width)))
        return Measurement(mean.value, half_width.value)
