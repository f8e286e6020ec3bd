"""Environments for learning, with the interface of Gymnasium (which need not be installed).

They play the paper's low-level process (Sec. III-B) by the protocol of pkc_environment_options:

- state: {"bin": H x W cells, 1 where taken; "item": (w, h) of the next item};
- action: the position x + y*W of the item's top-left corner; with `rotation` W*H more, for the
  turned item; the last action is "no position", which an open bin never needs;
- info["action_mask"]: which actions are allowed; another one is an ArgumentError;
- reward: (1 - reward_fill) * contact reward (paper eq. (3)) / 20, and once the bin closes
  reward_fill * its utilisation;
- an episode is one bin; the item that closed it begins the next.

PackingEnv packs one bin; VectorPackingEnv many side by side, in NumPy's arrays.
"""
from __future__ import annotations

import os
from typing import Any, Mapping, NamedTuple, Optional, Sequence, Union

from . import _marshal, _spaces
from .environment import Environment
from .errors import ClosedError, StateError, Status, argument_error

__all__ = ["PackingEnv", "Protocol", "VectorPackingEnv"]


class Protocol(NamedTuple):
    """What is played. `items` 0: the first item without a position closes the bin, and begins the
    next one. n: so many are offered to a bin, and those without a position are skipped.
    `rotation`: an item may be turned, which doubles the positions. `reward_fill`: share of the
    closed bin's utilisation in the reward; the rest is the contact reward over 20."""

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


def _protocol(w: Any, h: Any, least_side: Any, most_side: Any, items: Any, rotation: Any,
              reward_fill: Any) -> Protocol:
    """In Python's own numbers."""
    int32, real = _marshal.int32, _marshal.real
    return Protocol(int32("w", w), int32("h", h), int32("least_side", least_side),
                    int32("most_side", most_side), int32("items", items), bool(rotation),
                    real("reward_fill", reward_fill))


def _environment(count: Any, p: Protocol) -> Environment:
    return Environment(count, p.w, p.h, least_side=p.least_side, most_side=p.most_side,
                       items=p.items, rotation=int(p.rotation), reward_fill=p.reward_fill)


def _fresh_seed() -> int:
    return int.from_bytes(os.urandom(8), "little")


def _refuse_options(options: Optional[Mapping[str, Any]]) -> None:
    if options:
        raise argument_error(f"option {next(iter(options))!r}: reset knows none")


class PackingEnv(_spaces.Env):  # type: ignore[misc]
    """One bin, packed item by item."""

    metadata: dict[str, Any] = {"render_modes": ["ansi"], "render_fps": 4}

    def __init__(self, w: int = 10, h: int = 10, *, least_side: int = 1, most_side: int = 5,
                 items: int = 0, rotation: bool = False, reward_fill: float = 0.0,
                 render_mode: Optional[str] = None) -> None:
        if render_mode not in (None, "ansi"):
            raise argument_error(f"render_mode {render_mode!r}: must be None or 'ansi'")
        self.render_mode = render_mode
        p = _protocol(w, h, least_side, most_side, items, rotation, reward_fill)
        self.protocol = p
        self.environment = _environment(1, p)
        self.action_space = _spaces.discrete(p.actions)
        self.observation_space = _spaces.dictionary({
            "bin": _spaces.box(0, 1, (p.h, p.w), "uint8"),
            "item": _spaces.box(p.least_side, p.most_side, (2,), "int32")})
        self._begun = False  # a stream of items
        self._open = False

    def reset(self, *, seed: Optional[int] = None,
              options: Optional[Mapping[str, Any]] = None) -> tuple[Any, dict[str, Any]]:
        """An empty bin. With a seed a new stream of items begins, else the old one goes on."""
        _refuse_options(options)
        if seed is not None:
            seed = _marshal.uint64("seed", seed)
        if _spaces.gymnasium is not None:
            super().reset(seed=seed)  # its own generator, which nothing here draws from
        self._open = False
        self.environment.reset(_fresh_seed() if seed is None and not self._begun else seed)
        self._begun = True
        told = self._told(0)
        self._open = True
        return told

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Puts the item there; then comes the next, or the bin closes."""
        if not self._open and not self.environment.closed:
            raise StateError(Status.STATE, "no bin is being packed: call reset")
        rewards, contacts, closed = self.environment.step((action,))
        self._open = False  # if a thread that looks at the bin makes what follows fail: reset
        observation, info = self._told(int(contacts[0]))
        self._open = not closed[0]
        return observation, float(rewards[0]), bool(closed[0]), False, info

    def render(self) -> Optional[str]:
        """The bin as text, '#' where it is taken and '.' where it is free."""
        cells = self.environment.observe().cells[0]
        return "\n".join("".join(".#"[cell] for cell in row) for row in cells)

    def close(self) -> None:
        self._open = False
        self.environment.close()

    def _told(self, contact: int) -> tuple[Any, dict[str, Any]]:
        seen = self.environment.observe()
        mask = seen.mask[0] if _marshal.numpy is None else seen.mask[0].view("int8")
        return {"bin": seen.cells[0], "item": seen.sizes[0]}, {
            "action_mask": mask, "contact": contact,
            "utilization": int(seen.occupied[0]) / (self.protocol.w * self.protocol.h)}


class VectorPackingEnv(_spaces.VectorEnv):  # type: ignore[misc]
    """`num_envs` bins with the play of PackingEnv: bin i of reset(seed=s) has stream i of s, stream
    0 being PackingEnv's; with a sequence of seeds bin i is PackingEnv's of seeds[i]. Needs NumPy.

    A bin that closes is replaced within the same step, as in Gymnasium's SAME_STEP mode: its reward
    and termination are told, observation and infos are those of the next bin, and its own last ones
    are in infos["final_obs"][i] and, by key, in infos["final_info"]; both are there only in steps
    that close some bin. infos has action_mask, contact and utilization, and beside each `key`
    a `_key`: the bins that it is told of."""

    metadata: dict[str, Any] = {"autoreset_mode": _spaces.same_step()}
    closed = True  # until it is made: Gymnasium's closes itself, even half made

    def __init__(self, num_envs: int, w: int = 10, h: int = 10, *, least_side: int = 1,
                 most_side: int = 5, items: int = 0, rotation: bool = False,
                 reward_fill: float = 0.0) -> None:
        if _marshal.numpy is None:
            raise ImportError("VectorPackingEnv needs NumPy")
        p = _protocol(w, h, least_side, most_side, items, rotation, reward_fill)
        self.protocol = p
        self.num_envs = _marshal.int32("num_envs", num_envs)
        self.environment = _environment(self.num_envs, p)
        self.closed = False
        self.single_action_space = _spaces.discrete(p.actions)
        self.single_observation_space = _spaces.dictionary({
            "bin": _spaces.box(0, 1, (p.h, p.w), "uint8"),
            "item": _spaces.box(p.least_side, p.most_side, (2,), "int32")})
        self.action_space = _spaces.multi_discrete([p.actions] * self.num_envs)
        self.observation_space = _spaces.dictionary({
            "bin": _spaces.box(0, 1, (self.num_envs, p.h, p.w), "uint8"),
            "item": _spaces.box(p.least_side, p.most_side, (self.num_envs, 2), "int32")})
        self._begun = False  # streams of items

    def reset(self, *, seed: Union[int, Sequence[int], None] = None,
              options: Optional[Mapping[str, Any]] = None) -> tuple[Any, dict[str, Any]]:
        """Empty bins. With a seed, or one for each, new streams begin, else the old ones go on."""
        _refuse_options(options)
        self._require_open()
        one: Any = _fresh_seed() if seed is None and not self._begun else seed
        if one is None or _marshal.numpy.ndim(one) == 0:
            if one is not None:
                one = _marshal.uint64("seed", one)
                if _spaces.gymnasium is not None:
                    super().reset(seed=one)  # its own generator, which nothing here draws from
            self.environment.reset(one)
        else:
            self.environment.reset(seeds=one)
        self._begun = True
        return self._told(_marshal.numpy.zeros(self.num_envs, "int64"))

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """One item into each bin."""
        self._require_open()
        if not self._begun:
            raise StateError(Status.STATE, "nothing was begun: call reset")
        np = _marshal.numpy
        rewards, contacts, closed = self.environment.step(self._checked(actions))
        contacts, terminated = contacts.astype("int64"), closed.astype(bool)
        final: dict[str, Any] = {}
        if terminated.any():
            final = self._final(terminated, contacts)
            self.environment.open()
            contacts[terminated] = 0
        observation, infos = self._told(contacts)
        return observation, rewards, terminated, np.zeros_like(terminated), {**infos, **final}

    def close(self, **_: Any) -> None:
        if not self.closed:
            self.closed = True
            self.environment.close()

    def _require_open(self) -> None:
        if self.closed:
            raise ClosedError(Status.ARGUMENT, "the VectorPackingEnv is closed")

    def _checked(self, actions: Any) -> Any:
        at = _marshal.numpy.asarray(actions)
        if at.shape != (self.num_envs,):
            raise argument_error(f"actions of shape {at.shape}: must be ({self.num_envs},)")
        return at

    def _told(self, contacts: Any) -> tuple[Any, dict[str, Any]]:
        seen = self.environment.observe()
        each = _marshal.numpy.ones(self.num_envs, bool)
        return {"bin": seen.cells, "item": seen.sizes}, _masked({
            "action_mask": seen.mask.view("int8"), "contact": contacts,
            "utilization": seen.occupied / (self.protocol.w * self.protocol.h)}, each)

    def _final(self, closed: Any, contacts: Any) -> dict[str, Any]:
        """What PackingEnv says of a bin in the step that closes it, for those that just did."""
        np, p = _marshal.numpy, self.protocol
        which = np.flatnonzero(closed)
        seen = self.environment.observe(which)
        observations = np.full(self.num_envs, None, object)
        for i, cells, sizes in zip(which, seen.cells, seen.sizes):
            observations[i] = {"bin": cells, "item": sizes}
        mask = np.zeros((self.num_envs, p.actions), "int8")
        mask[which] = seen.mask
        share = np.zeros(self.num_envs)
        share[which] = seen.occupied / (p.w * p.h)
        return _masked({"final_obs": observations,
                        "final_info": _masked({"action_mask": mask,
                                               "contact": np.where(closed, contacts, 0),
                                               "utilization": share}, closed)}, closed)


def _masked(infos: dict[str, Any], which: Any) -> dict[str, Any]:
    """Infos with Gymnasium's masks: `_key` says which bins `key` is told of."""
    return {**infos, **{"_" + key: which.copy() for key in infos}}
