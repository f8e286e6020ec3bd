"""Gymnasium's spaces and base classes where it is installed, else simple ones of the same use."""
from __future__ import annotations

import random
from typing import Any, Mapping, Optional, Sequence

try:
    import gymnasium as gymnasium
except ImportError:
    gymnasium = None


class Discrete:
    """0..n-1."""

    def __init__(self, n: int) -> None:
        self.n = n
        self._random = random.Random()

    def seed(self, seed: Optional[int] = None) -> None:
        self._random.seed(seed)

    def sample(self, mask: Optional[Sequence[int]] = None) -> int:
        if mask is None:
            return self._random.randrange(self.n)
        allowed = [at for at in range(self.n) if mask[at]]
        return self._random.choice(allowed) if allowed else 0

    def contains(self, x: Any) -> bool:
        return hasattr(x, "__index__") and 0 <= x.__index__() < self.n

    __contains__ = contains


class Box:
    """Numbers low..high in an array of this shape."""

    def __init__(self, low: int, high: int, shape: tuple[int, ...], dtype: str) -> None:
        self.low, self.high, self.shape, self.dtype = low, high, shape, dtype


class MultiDiscrete:
    """0..nvec[i]-1 at index i."""

    def __init__(self, nvec: Sequence[int]) -> None:
        self.nvec = nvec
        self.shape = (len(nvec),)


def discrete(n: int) -> Any:
    return Discrete(n) if gymnasium is None else gymnasium.spaces.Discrete(n)


def multi_discrete(nvec: Sequence[int]) -> Any:
    return MultiDiscrete(nvec) if gymnasium is None else gymnasium.spaces.MultiDiscrete(nvec)


def box(low: int, high: int, shape: tuple[int, ...], dtype: str) -> Any:
    if gymnasium is None:
        return Box(low, high, shape, dtype)
    import numpy
    return gymnasium.spaces.Box(low, high, shape, numpy.dtype(dtype).type)


def dictionary(spaces: Mapping[str, Any]) -> Any:
    return dict(spaces) if gymnasium is None else gymnasium.spaces.Dict(spaces)


class Plain:
    """What an environment has of Gymnasium's base classes where those are not."""

    spec: Any = None
    render_mode: Optional[str] = None

    @property
    def unwrapped(self) -> Any:
        return self

    def close(self) -> None:
        pass

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


Env: Any = Plain if gymnasium is None else gymnasium.Env
VectorEnv: Any = Plain if gymnasium is None else gymnasium.vector.VectorEnv


def same_step() -> Any:
    """How a vectorised environment says that a closed bin is replaced within the same step."""
    mode = getattr(getattr(gymnasium, "vector", None), "AutoresetMode", None)
    return "SameStep" if mode is None else mode.SAME_STEP
