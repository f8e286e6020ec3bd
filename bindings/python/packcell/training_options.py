"""What is trained, or measured: the protocol, the learner and its settings."""
from __future__ import annotations

from dataclasses import asdict, dataclass
from enum import IntEnum
from typing import Any, Optional

from . import _raw as raw
from ._marshal import initialised


class Rotation(IntEnum):
    OFF = raw.PKC_ROTATION_OFF
    ON = raw.PKC_ROTATION_ON
    MIXED = raw.PKC_ROTATION_MIXED  # each bin draws whether its items may be turned


class Learner(IntEnum):
    A3C = raw.PKC_LEARNER_A3C  # the paper's actor-critic
    AFTERSTATE = raw.PKC_LEARNER_AFTERSTATE  # the value of bins left behind


@dataclass(frozen=True)
class TrainerOptions:
    """What is played, by whom and how; None is the library's default (in brackets). Equal options
    give equal trainings on one architecture. Learner.AFTERSTATE takes bins up to 12 x 12 with
    (bin_w + 1) * bin_h <= 128 and items up to 8, and of what follows the protocol seed and name
    alone."""

    learner: Optional[int] = None  # (Learner.A3C)
    architecture: Optional[int] = None  # (Architecture.ACTOR_CRITIC, bins of 3..32 cells a side)
    # The protocol.
    bin_w: Optional[int] = None  # 1..128 cells (10)
    bin_h: Optional[int] = None
    least_side: Optional[int] = None  # of items, cells (1)
    most_side: Optional[int] = None  # at most the bin's shorter side (5)
    items: Optional[int] = None  # offered to a bin, 1..1000000; 0: until one has no position (0)
    rotation: Optional[int] = None  # (Rotation.MIXED)
    # The learner.
    workers: Optional[int] = None  # threads, 1..64 (3)
    environments: Optional[int] = None  # bins that a worker packs side by side, 1..1024 (32)
    steps: Optional[int] = None  # items it places in each between two updates, 1..1024 (8)
    channels: Optional[int] = None  # of each convolution, 1..64 (16)
    features: Optional[int] = None  # of the encoded bin, 1..1024 (128)
    hidden: Optional[int] = None  # units where bin and item are joined, 1..1024 (128)
    seed: Optional[int] = None  # 0..2^64 - 1
    anneal: Optional[int] = None  # updates until rates are a tenth; 0: they stay (0)
    gamma: Optional[float] = None  # discount of later rewards, 0..1 (0.9)
    learning_rate: Optional[float] = None  # of Adam, 1e-9..1 (0.0015)
    entropy: Optional[float] = None  # weight of the policy's entropy, 0..10 (0.02)
    value_weight: Optional[float] = None  # of the critic's loss, 0..10 (0.5)
    clip: Optional[float] = None  # largest norm of a gradient, 1e-6..1e6 (1)
    reward_fill: Optional[float] = None  # share of the utilisation in the reward, 0..1 (0)
    name: Optional[str] = None  # of the policy, 1..31 of a-z, 0-9, '_', '.', '/', '-' ("a3c")


def options_in(options: Optional[TrainerOptions]) -> Any:
    if options is not None and not isinstance(options, TrainerOptions):
        raise TypeError(f"options must be TrainerOptions, not {type(options).__name__}")
    return initialised(raw.pkc_trainer_options, **(asdict(options) if options else {}))
