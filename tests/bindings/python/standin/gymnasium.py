"""Stands in for Gymnasium 1.x where it cannot be installed: as much of its documented interface as
packcell.env uses, and strict where Gymnasium is. It shows that our side keeps to the documents, not
that Gymnasium does."""
import enum
import types

import numpy as np


class Space:
    def __init__(self, shape, dtype):
        self.shape, self.dtype = shape, np.dtype(dtype)


class Discrete(Space):
    def __init__(self, n, seed=None, start=0):
        assert isinstance(n, int) and n > 0
        super().__init__((), np.int64)
        self.n, self.start = n, start

    def sample(self, mask=None):
        assert isinstance(mask, np.ndarray) and mask.dtype == np.int8 and mask.shape == (self.n,)
        assert np.isin(mask, (0, 1)).all()
        return np.int64(np.flatnonzero(mask)[0])

    def contains(self, x):
        return isinstance(x, (int, np.integer)) and 0 <= x < self.n


class Box(Space):
    def __init__(self, low, high, shape=None, dtype=np.float32, seed=None):
        super().__init__(tuple(map(int, shape)), dtype)
        self.low = np.full(self.shape, low, self.dtype)
        self.high = np.full(self.shape, high, self.dtype)

    def contains(self, x):
        return (isinstance(x, np.ndarray) and np.can_cast(x.dtype, self.dtype)
                and x.shape == self.shape and bool((self.low <= x).all() and (x <= self.high).all()))


class MultiDiscrete(Space):
    def __init__(self, nvec, dtype=np.int64, seed=None, start=None):
        self.nvec = np.array(nvec, dtype)
        super().__init__(self.nvec.shape, dtype)

    def contains(self, x):
        return (isinstance(x, np.ndarray) and np.issubdtype(x.dtype, np.integer)
                and x.shape == self.shape and bool((0 <= x).all() and (x < self.nvec).all()))


class Dict(Space):
    def __init__(self, spaces=None, seed=None):
        assert all(isinstance(space, Space) for space in spaces.values())
        super().__init__(None, object)
        self.spaces = dict(sorted(spaces.items()))

    def __getitem__(self, key):
        return self.spaces[key]

    def contains(self, x):
        return (isinstance(x, dict) and x.keys() == self.spaces.keys()
                and all(space.contains(x[key]) for key, space in self.spaces.items()))


def _generator(seed):
    assert type(seed) is int and seed >= 0
    return np.random.default_rng(seed)


class Env:
    metadata = {"render_modes": []}
    render_mode = None
    spec = None
    np_random = None

    def reset(self, *, seed=None, options=None):
        if seed is not None:
            self.np_random = _generator(seed)

    @property
    def unwrapped(self):
        return self

    def close(self):
        pass

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class VectorEnv:
    metadata = {}
    render_mode = None
    spec = None
    closed = False
    np_random = None

    def reset(self, *, seed=None, options=None):
        if seed is not None:
            self.np_random = _generator(seed)

    @property
    def unwrapped(self):
        return self

    def close(self, **_):
        self.closed = True

    def __del__(self):
        if not getattr(self, "closed", True):
            self.close()


class AutoresetMode(enum.Enum):
    NEXT_STEP = "NextStep"
    SAME_STEP = "SameStep"
    DISABLED = "Disabled"


spaces = types.SimpleNamespace(Discrete=Discrete, Box=Box, MultiDiscrete=MultiDiscrete, Dict=Dict)
vector = types.SimpleNamespace(VectorEnv=VectorEnv, AutoresetMode=AutoresetMode)
