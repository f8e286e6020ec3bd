"""Many bins side by side: the same play as PackingEnv in NumPy, where a bin is a few machine words
(a row of cells each, and a column each), so that one array operation asks all bins at once."""
from __future__ import annotations

from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np

from . import _spaces
from ._marshal import ranged, uint64
from ._protocol import (CONTACT_SCALE, GOLDEN, Protocol, checked, fresh_seed, refuse_options,
                        stream_state)
from .errors import ClosedError, StateError, Status, argument_error

_MOST_SIDE = 62  # and a wall at each end: 64 bits
_POPCOUNT = np.array([bin(v).count("1") for v in range(1 << 16)], np.uint8)

Words = Any  # ndarray of little-endian words of the width that a row, or a column, needs


def _word(side: int) -> np.dtype[Any]:
    return np.dtype("<u2" if side + 2 <= 16 else "<u4" if side + 2 <= 32 else "<u8")


def _walls(side: int, word: np.dtype[Any]) -> Any:
    """All bits but those of the cells: bit 0, and what follows the last cell."""
    inside = ((1 << side) - 1) << 1
    return word.type(((1 << 8 * word.itemsize) - 1) ^ inside)


def _count(words: Words) -> Any:
    """Ones in each word of a vector."""
    parts = _POPCOUNT[np.ascontiguousarray(words).view("<u2").reshape(len(words), -1)]
    return parts[:, 0] if parts.shape[1] == 1 else parts.sum(axis=1, dtype=np.int64)


def _bits(words: Words, side: int) -> Any:
    """Cells of [line, bin] words as [bin, line, cell], 0 or 1."""
    lines = np.ascontiguousarray(words.T)
    bits = np.unpackbits(lines.view(np.uint8).reshape(*lines.shape, lines.itemsize), axis=-1,
                         bitorder="little")
    return bits[:, :, 1:side + 1]


def _told(infos: dict[str, Any], which: Any) -> dict[str, Any]:
    """Infos with Gymnasium's masks: `_key` says which bins `key` is told of."""
    return {**infos, **{"_" + key: which.copy() for key in infos}}


class VectorPackingEnv(_spaces.VectorEnv):  # type: ignore[misc]
    """`num_envs` bins with the play of PackingEnv, bit for bit: bin i of reset(seed=s) has stream i
    of s, stream 0 being PackingEnv's; with a sequence of seeds bin i is PackingEnv's of seeds[i].

    A bin that closes is replaced within the same step, as in Gymnasium's SAME_STEP mode: its reward
    and termination are told, observation and infos are those of the next bin, and its own last ones
    are in infos["final_obs"][i] and, by key, in infos["final_info"]; both are there only in steps
    that close some bin. infos has action_mask, contact and utilization, and beside each `key`
    a `_key`: the bins that it is told of. Sides up to 62 cells."""

    metadata: dict[str, Any] = {"autoreset_mode": _spaces.same_step()}

    def __init__(self, num_envs: int, w: int = 10, h: int = 10, *, least_side: int = 1,
                 most_side: int = 5, items: int = 0, rotation: bool = False,
                 reward_fill: float = 0.0) -> None:
        num_envs = ranged("num_envs", num_envs, 1, 1 << 20)
        p = checked(Protocol(w, h, least_side, most_side, items, rotation, reward_fill), _MOST_SIDE)
        self.protocol = p
        self.num_envs = num_envs
        self.closed = False
        self.single_action_space = _spaces.discrete(p.actions)
        self.single_observation_space = _spaces.dictionary({
            "bin": _spaces.box(0, 1, (p.h, p.w), "uint8"),
            "item": _spaces.box(p.least_side, p.most_side, (2,), "int32")})
        self.action_space = _spaces.multi_discrete([p.actions] * num_envs)
        self.observation_space = _spaces.dictionary({
            "bin": _spaces.box(0, 1, (num_envs, p.h, p.w), "uint8"),
            "item": _spaces.box(p.least_side, p.most_side, (num_envs, 2), "int32")})
        self._row_word, self._column_word = _word(p.w), _word(p.h)
        self._rows: Words = np.empty((p.h + 2, num_envs), self._row_word)
        self._columns: Words = np.empty((p.w + 2, num_envs), self._column_word)
        self._state: Optional[Any] = None
        self._w = np.zeros(num_envs, np.int64)
        self._h = np.zeros(num_envs, np.int64)
        self._offered = np.zeros(num_envs, np.int64)
        self._occupied = np.zeros(num_envs, np.int64)
        self._mask = np.zeros((num_envs, p.actions), np.int8)
        self._each = np.arange(num_envs)

    def reset(self, *, seed: Union[int, Sequence[int], None] = None,
              options: Optional[Mapping[str, Any]] = None) -> tuple[Any, dict[str, Any]]:
        """Empty bins. With a seed, or one for each, new streams begin, else the old ones go on."""
        refuse_options(options)
        if self.closed:
            raise ClosedError(Status.ARGUMENT, "the VectorPackingEnv is closed")
        seeds: Any = fresh_seed() if seed is None and self._state is None else seed
        if seeds is not None:
            if np.ndim(seeds) == 0:
                seeds = uint64("seed", seeds)
                if _spaces.gymnasium is not None:
                    super().reset(seed=seeds)  # its own generator, which nothing here draws from
                states = [stream_state(seeds, i) for i in range(self.num_envs)]
            else:
                states = [stream_state(one) for one in seeds]
            if len(states) != self.num_envs:
                raise argument_error(f"{len(states)} seeds: must be {self.num_envs}")
            self._state = np.array(states, np.uint64)
            self._draw(self._each)
        self._open(self._each)
        self._set_mask(self._each)
        return self._observation(), self._infos(np.zeros(self.num_envs, np.int64))

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """One item into each bin."""
        if self.closed:
            raise ClosedError(Status.ARGUMENT, "the VectorPackingEnv is closed")
        if self._state is None:
            raise StateError(Status.STATE, "nothing was begun: call reset")
        p = self.protocol
        at = self._checked(actions)
        turned, position = np.divmod(at, p.w * p.h)
        y, x = np.divmod(position, p.w)
        if p.rotation:
            w, h = np.where(turned, self._h, self._w), np.where(turned, self._w, self._h)
        else:
            w, h = self._w, self._h
        contact = self._place(x, y, w, h)
        rewards = (1 - p.reward_fill) / CONTACT_SCALE * contact

        self._draw(self._each)
        closed = self._close() if p.items else ~self._set_mask(self._each)
        again = np.flatnonzero(closed)
        final: dict[str, Any] = {}
        if again.size:
            rewards[again] += p.reward_fill / (p.w * p.h) * self._occupied[again]
            final = self._final(closed, again, contact)
            self._open(again)
            self._set_mask(again)
            contact[again] = 0
        return (self._observation(), rewards, closed, np.zeros(self.num_envs, bool),
                {**self._infos(contact), **final})

    def close(self, **_: Any) -> None:
        self._state = None
        self.closed = True

    def _checked(self, actions: Any) -> Any:
        at = np.asarray(actions)
        if at.dtype.kind not in "iu":
            raise TypeError(f"actions must be integers, not {at.dtype}")
        if at.shape != (self.num_envs,):
            raise argument_error(f"actions of shape {at.shape}: must be ({self.num_envs},)")
        outside = np.flatnonzero((at < 0) | (at >= self.protocol.actions))
        if outside.size:
            i = outside[0]
            raise argument_error(f"action {at[i]} of bin {i}: must be 0.."
                                 f"{self.protocol.actions - 1}")
        at = at.astype(np.int64)
        wrong = np.flatnonzero(self._mask[self._each, at] == 0)
        if wrong.size:
            i = wrong[0]
            raise argument_error(f"action {at[i]} of bin {i}: no place for the {self._w[i]} x "
                                 f"{self._h[i]} item there")
        return at

    def _place(self, x: Any, y: Any, w: Any, h: Any) -> Any:
        """Fills the rectangles; their contact rewards, before."""
        rows, columns, each = self._rows, self._columns, self._each
        one = np.uint64(1)
        across = (((one << w.astype(np.uint64)) - one) << (x + 1).astype(np.uint64)).astype(
            self._row_word)
        down = (((one << h.astype(np.uint64)) - one) << (y + 1).astype(np.uint64)).astype(
            self._column_word)
        contact = (_count(rows[y, each] & across).astype(np.int64) +
                   _count(rows[y + h + 1, each] & across) + _count(columns[x, each] & down) +
                   _count(columns[x + w + 1, each] & down))
        for k in range(int(h.max())):
            taken = np.flatnonzero(h > k)
            rows[y[taken] + 1 + k, taken] |= across[taken]
        for k in range(int(w.max())):
            taken = np.flatnonzero(w > k)
            columns[x[taken] + 1 + k, taken] |= down[taken]
        self._occupied += w * h
        return contact

    def _draw(self, which: Any) -> None:
        p = self.protocol
        self._w[which] = p.least_side + self._below(which, p.most_side - p.least_side + 1)
        self._h[which] = p.least_side + self._below(which, p.most_side - p.least_side + 1)

    def _below(self, which: Any, bound: int) -> Any:
        assert self._state is not None
        v = self._state[which] + np.uint64(GOLDEN)
        self._state[which] = v
        v = (v ^ (v >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        v = (v ^ (v >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        v ^= v >> np.uint64(31)
        return ((v >> np.uint64(32)) * np.uint64(bound) >> np.uint64(32)).astype(np.int64)

    def _open(self, which: Any) -> None:
        p = self.protocol
        self._rows[:, which] = _walls(p.w, self._row_word)
        self._columns[:, which] = _walls(p.h, self._column_word)
        full_row = self._row_word.type((1 << 8 * self._row_word.itemsize) - 1)
        full_column = self._column_word.type((1 << 8 * self._column_word.itemsize) - 1)
        self._rows[0, which] = self._rows[-1, which] = full_row
        self._columns[0, which] = self._columns[-1, which] = full_column
        self._offered[which] = 1
        self._occupied[which] = 0

    def _close(self) -> Any:
        """Offers items until one has a position; the bins that close instead."""
        p = self.protocol
        closed = np.zeros(self.num_envs, bool)
        left = self._each
        while left.size:
            over = (self._occupied[left] == p.w * p.h) | (self._offered[left] >= p.items)
            closed[left[over]] = True
            left = left[~over]
            self._offered[left] += 1
            left = left[~self._set_mask(left)]
            self._draw(left)
        return closed

    def _set_mask(self, which: Any) -> Any:
        """Makes the masks of these bins for their items; which of them have a position."""
        p = self.protocol
        w, h = self._w[which], self._h[which]
        free = ~self._rows[1:-1, which]
        mask = np.zeros((len(w), p.actions), np.int8)
        cells = p.w * p.h
        fits = self._corners(free, w, h, mask[:, :cells])
        if p.rotation:
            turned = np.where(w != h, free, 0).astype(free.dtype)
            fits = self._corners(turned, h, w, mask[:, cells:2 * cells]) | fits
        mask[:, -1] = ~fits
        if len(which) == self.num_envs:
            self._mask = mask
        else:
            self._mask[which] = mask
        return fits

    def _corners(self, free: Words, w: Any, h: Any, out: Any) -> Any:
        """Where the top-left corner of a w x h item may lie on free cells; whether anywhere."""
        if not len(w):
            return np.zeros(0, bool)
        p = self.protocol
        word = free.dtype
        ones = word.type((1 << 8 * word.itemsize) - 1)
        run = free.copy()  # bits where a run of w free cells begins, by doubling
        have = np.ones(len(w), np.int64)
        while True:
            by = np.minimum(have, w - have)
            if not by.any():
                break
            run &= run >> by.astype(word)
            have += by
        rows = run.copy()  # and where h rows one below the other have one
        for k in range(1, int(h.max())):
            shorter = np.where(h <= k, ones, word.type(0))
            rows[:-k] &= run[k:] | shorter
            rows[-k:] &= shorter
        out.reshape(len(w), p.h, p.w)[...] = _bits(rows, p.w)
        return np.bitwise_or.reduce(rows, axis=0) != 0

    def _observation(self) -> dict[str, Any]:
        return {"bin": np.ascontiguousarray(_bits(self._rows[1:-1], self.protocol.w)),
                "item": np.stack((self._w, self._h), axis=1).astype(np.int32)}

    def _infos(self, contact: Any) -> dict[str, Any]:
        return _told({"action_mask": self._mask.copy(), "contact": contact,
                      "utilization": self._occupied / (self.protocol.w * self.protocol.h)},
                     np.ones(self.num_envs, bool))

    def _final(self, closed: Any, which: Any, contact: Any) -> dict[str, Any]:
        """What PackingEnv says of a bin in the step that closes it, for those that just did."""
        bins = _bits(self._rows[1:-1, which], self.protocol.w)
        items = np.stack((self._w[which], self._h[which]), axis=1).astype(np.int32)
        observations = np.full(self.num_envs, None, object)
        for i, bin, item in zip(which, bins, items):
            observations[i] = {"bin": bin.copy(), "item": item}
        mask = np.zeros_like(self._mask)
        mask[which, -1] = 1
        share = self._occupied / (self.protocol.w * self.protocol.h)
        return _told({"final_obs": observations,
                      "final_info": _told({"action_mask": mask,
                                           "contact": np.where(closed, contact, 0),
                                           "utilization": np.where(closed, share, 0.0)}, closed)},
                     closed)
