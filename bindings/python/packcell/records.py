"""Items, placements and actions: plain tuples, and the numbers that they use."""
from __future__ import annotations

import ctypes
from enum import IntEnum, IntFlag
from typing import Any, Iterable, NamedTuple, Union

from . import _raw as raw
from ._marshal import int32, known, uint32
from .errors import check

MAX_SIDE: int = raw.PKC_MAX_SIDE
CELL_FREE: int = raw.PKC_CELL_FREE
CELL_FIXED: int = raw.PKC_CELL_FIXED


class ItemFlag(IntFlag):
    NO_ROTATE = raw.PKC_ITEM_NO_ROTATE  # may only be packed with rot 0
    PINNED = raw.PKC_ITEM_PINNED  # is never unpacked


class Op(IntEnum):
    """What an action does."""

    UNPACK = raw.PKC_OP_UNPACK
    PACK = raw.PKC_OP_PACK
    SKIP = raw.PKC_OP_SKIP
    TERMINATE = raw.PKC_OP_TERMINATE


class Item(NamedTuple):
    """An item of w x h cells, 1..128 each; `id` is yours, >= 0 and unique in a bin and a queue."""

    id: int
    w: int
    h: int
    flags: int = 0


class Placement(NamedTuple):
    """An item in a bin, its top-left corner at (x, y); rot 1 swaps its w and h."""

    item: Item
    x: int
    y: int
    rot: int

    @property
    def w(self) -> int:
        """Cells that it covers to the right, as it is turned."""
        return self.item.h if self.rot else self.item.w

    @property
    def h(self) -> int:
        return self.item.w if self.rot else self.item.h


class Queued(NamedTuple):
    """An item on the conveyor or in a buffer. `arms`: bit 0 and 1 say which arms can take it."""

    item: Item
    arms: int
    recognized: bool


class Action(NamedTuple):
    """A task primitive (paper, Sec. III-A); fields that an operation does not use are 0: UNPACK has
    item and arm, PACK all, SKIP item, TERMINATE none."""

    op: Op
    item: int = 0
    x: int = 0
    y: int = 0
    rot: int = 0
    arm: int = 0


# What functions take: plain tuples do too.
ItemLike = Union[Item, tuple[int, int, int], tuple[int, int, int, int]]
ActionLike = Union[Action, tuple[int, ...]]


def item_in(item: Any) -> Any:
    """pkc_item of an Item or of a tuple (id, w, h[, flags])."""
    if not isinstance(item, tuple) or not 3 <= len(item) <= 4:
        raise TypeError(f"an item is an Item or a tuple (id, w, h[, flags]), not {item!r}")
    flags = uint32("item flags", item[3]) if len(item) == 4 else 0
    return raw.pkc_item(int32("item id", item[0]), int32("item w", item[1]),
                        int32("item h", item[2]), flags)


def items_in(items: Iterable[ItemLike]) -> Any:
    made = [item_in(item) for item in items]
    return (raw.pkc_item * len(made))(*made)


def item_out(item: Any) -> Item:
    return Item(item.id, item.w, item.h, item.flags)


def placement_out(p: Any) -> Placement:
    return Placement(item_out(p.item), p.x, p.y, p.rot)


def queued_out(q: Any) -> Queued:
    return Queued(item_out(q.item), q.arms, bool(q.recognized))


def actions_in(actions: Iterable[ActionLike]) -> Any:
    made = []
    for action in actions:
        if not isinstance(action, tuple) or not 1 <= len(action) <= 6:
            raise TypeError(f"an action is an Action or a tuple (op, item, x, y, rot, arm), "
                            f"not {action!r}")
        made.append(raw.pkc_action(*(int32("action's " + name, value)
                                     for name, value in zip(Action._fields, action))))
    return (raw.pkc_action * len(made))(*made)


def actions_out(actions: Iterable[Any]) -> list[Action]:
    return [Action(known(Op, a.op), a.item, a.x, a.y, a.rot, a.arm) for a in actions]


def plan_hash(actions: Iterable[ActionLike]) -> int:
    """FNV-1a 64 of the actions: equal plans have equal hashes on every machine."""
    array = actions_in(actions)
    hashed = ctypes.c_uint64()
    check(raw.pkc_plan_hash(array, len(array), ctypes.byref(hashed)))
    return hashed.value


def version() -> tuple[int, int, int]:
    """Of the library that is loaded."""
    number: int = raw.pkc_version()
    return number // 10000, number // 100 % 100, number % 100
