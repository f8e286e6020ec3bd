"""Environments for learning, with the interface of Gymnasium (which need not be installed).

They play the paper's low-level process (Sec. III-C) by the protocol of pkc_trainer_options:

- state: {"bin": H x W cells, 1 where taken; "item": (w, h) of the next item};
- action: the position x + y*W of the item's top-left corner; with `rotation` W*H more, for the
  turned item; the last action is "no position", which an open bin never needs;
- info["action_mask"]: which actions are allowed; another one is an ArgumentError;
- reward: (1 - reward_fill) * contact reward (paper eq. (3)) / 20, and once the bin closes
  reward_fill * its utilisation;
- an episode is one bin; the item that closed it begins the next.

PackingEnv is one bin of the library; VectorPackingEnv packs many side by side in NumPy.
"""
from __future__ import annotations

import ctypes
from ctypes import byref
from typing import TYPE_CHECKING, Any, Mapping, Optional

from . import _marshal, _raw as raw, _spaces
from ._protocol import CONTACT_SCALE, Protocol, Stream, checked, fresh_seed, refuse_options
from .bin import Bin
from .errors import ClosedError, StateError, Status, argument_error, check
from .records import CELL_FREE, Item

if TYPE_CHECKING:
    from ._vector import VectorPackingEnv

__all__ = ["PackingEnv", "VectorPackingEnv"]


def __getattr__(name: str) -> Any:
    if name == "VectorPackingEnv":  # needs NumPy, the rest does not
        from ._vector import VectorPackingEnv
        return VectorPackingEnv
    raise AttributeError(name)


class PackingEnv(_spaces.Env):  # type: ignore[misc]
    """One bin, packed item by item."""

    metadata: dict[str, Any] = {"render_modes": ["ansi"], "render_fps": 4}

    def __init__(self, w: int = 10, h: int = 10, *, least_side: int = 1, most_side: int = 5,
                 items: int = 0, rotation: bool = False, reward_fill: float = 0.0,
                 render_mode: Optional[str] = None) -> None:
        if render_mode not in (None, "ansi"):
            raise argument_error(f"render_mode {render_mode!r}: must be None or 'ansi'")
        self.render_mode = render_mode
        p = checked(Protocol(w, h, least_side, most_side, items, rotation, reward_fill))
        self.protocol = p
        self.bin = Bin(p.w, p.h)  # for looking at
        self.action_space = _spaces.discrete(p.actions)
        self.observation_space = _spaces.dictionary({
            "bin": _spaces.box(0, 1, (p.h, p.w), "uint8"),
            "item": _spaces.box(p.least_side, p.most_side, (2,), "int32")})
        # What the library fills at each step.
        self._bits = (ctypes.c_uint8 * (p.w * p.h + 1))()
        self._cells = (ctypes.c_int32 * (p.w * p.h))()
        self._count = ctypes.c_size_t()
        self._stream: Optional[Stream] = None
        self._item = (0, 0)
        self._occupied = 0
        self._mask = b""
        self._offered = 0
        self._packed = 0
        self._open = False

    def reset(self, *, seed: Optional[int] = None,
              options: Optional[Mapping[str, Any]] = None) -> tuple[Any, dict[str, Any]]:
        """An empty bin. With a seed a new stream of items begins, else the old one goes on."""
        refuse_options(options)
        if seed is not None:
            seed = _marshal.uint64("seed", seed)
        if _spaces.gymnasium is not None:
            super().reset(seed=seed)  # its own generator, which nothing here draws from
        if seed is not None or self._stream is None:
            self._stream = Stream(fresh_seed() if seed is None else seed)
            self._draw()
        self._open = False
        self.bin.clear()
        self._offered, self._packed, self._occupied = 1, 0, 0
        self._fits()
        told = self._observation(), self._info(0)
        self._open = True
        return told

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Puts the item there; then comes the next, or the bin closes."""
        if self.bin.closed:
            raise ClosedError(Status.ARGUMENT, "the PackingEnv is closed")
        if not self._open:
            raise StateError(Status.STATE, "no bin is being packed: call reset")
        p = self.protocol
        at = _marshal.int32("action", action)
        if not 0 <= at < p.actions:
            raise argument_error(f"action {at}: must be 0..{p.actions - 1}")
        w, h = self._item
        if not self._mask[at]:
            raise argument_error(f"action {at}: no place for the {w} x {h} item there")
        rot, position = divmod(at, p.w * p.h)
        y, x = divmod(position, p.w)
        contact = self.bin.contact(x, y, h if rot else w, w if rot else h)
        self.bin.pack(Item(self._packed, w, h), x, y, rot)
        self._open = False  # if a thread that looks at the bin makes what follows fail: reset
        self._packed += 1
        self._occupied += w * h
        closed = self._next()
        reward = (1 - p.reward_fill) * contact / CONTACT_SCALE
        if closed:
            reward += p.reward_fill * self._occupied / (p.w * p.h)
        told = self._observation(), reward, closed, False, self._info(contact)
        self._open = not closed
        return told

    def render(self) -> Optional[str]:
        """The bin as text, a letter an item, '.' where it is free."""
        letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
        return "\n".join("".join("." if cell < 0 else letters[cell % len(letters)] for cell in row)
                         for row in self.bin.cells())

    def close(self) -> None:
        self._open = False
        self.bin.close()

    def _draw(self) -> None:
        assert self._stream is not None
        sides = self.protocol.most_side - self.protocol.least_side + 1
        w = self.protocol.least_side + self._stream.below(sides)
        self._item = (w, self.protocol.least_side + self._stream.below(sides))

    def _next(self) -> bool:
        """Draws the next item that has a position; true if the bin closes instead."""
        p = self.protocol
        self._draw()
        if p.items == 0:
            return not self._fits()
        full = self._occupied == p.w * p.h
        while not full and self._offered < p.items:
            self._offered += 1
            if self._fits():
                return False
            self._draw()
        self._mask = bytes(p.positions) + b"\1"
        return True

    def _fits(self) -> bool:
        """Makes the mask for the item; whether there is a position."""
        w, h = self._item
        mask = self._feasible(w, h)
        if self.protocol.rotation:
            mask += self._feasible(h, w) if w != h else bytes(len(mask))
        fits = 1 in mask
        self._mask = mask + (b"\0" if fits else b"\1")
        return fits

    def _feasible(self, w: int, h: int) -> bytes:
        check(raw.pkc_bin_feasible(self.bin._handle, w, h, self._bits, len(self._bits),
                                   byref(self._count)))
        return bytes(self._bits)[:-1]

    def _observation(self) -> dict[str, Any]:
        check(raw.pkc_bin_cells(self.bin._handle, self._cells, len(self._cells),
                                byref(self._count)))
        w, h, np = self.protocol.w, self.protocol.h, _marshal.numpy
        if np is None:
            taken = [int(cell != CELL_FREE) for cell in self._cells]
            return {"bin": [taken[at:at + w] for at in range(0, len(taken), w)],
                    "item": self._item}
        cells = np.frombuffer(memoryview(self._cells), np.int32).reshape(h, w)
        return {"bin": (cells != CELL_FREE).view(np.uint8), "item": np.array(self._item, np.int32)}

    def _info(self, contact: int) -> dict[str, Any]:
        mask: Any = self._mask
        if _marshal.numpy is not None:
            mask = _marshal.numpy.frombuffer(mask, "int8").copy()
        return {"action_mask": mask, "contact": contact,
                "utilization": self._occupied / (self.protocol.w * self.protocol.h)}
