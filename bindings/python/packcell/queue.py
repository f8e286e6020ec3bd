"""The conveyor with its regions and buffers, the steps that bin and queue take, and snapshots."""
from __future__ import annotations

import ctypes
from ctypes import byref
from typing import Any, Iterable, NamedTuple, Union

from . import _raw as raw
from ._handle import Handle, handle_of
from ._marshal import gathered, gathered_bytes, initialised, int32, octets, read, text
from .bin import Bin
from .errors import check
from .records import ActionLike, ItemLike, Queued, actions_in, item_in, queued_out


class Scenario(NamedTuple):
    """Who sees and reaches what (paper, Sec. V-C). Scenario.parse("D-R5A3O1") is two robots that
    recognise 5 items, reach 3 each, and one of them both."""

    robots: int = 1
    recognized: int = 1
    accessible: int = 1
    overlap: int = 0

    @classmethod
    def parse(cls, name: str) -> Scenario:
        scenario = initialised(raw.pkc_scenario)
        check(raw.pkc_scenario_parse(text("scenario", name), byref(scenario)))
        return read(cls, scenario)

    @property
    def name(self) -> str:
        name = ctypes.create_string_buffer(32)
        check(raw.pkc_scenario_name(byref(scenario_in(self)), name, len(name)))
        return name.value.decode()


def scenario_in(scenario: Union[Scenario, str]) -> Any:
    """pkc_scenario of a Scenario or of its name."""
    if isinstance(scenario, str):
        scenario = Scenario.parse(scenario)
    if not isinstance(scenario, Scenario):
        raise TypeError(f"scenario must be a Scenario or a str, not {type(scenario).__name__}")
    return initialised(raw.pkc_scenario, **{name: int32(name, value) for name, value in
                                            scenario._asdict().items()})


class QueueInfo(NamedTuple):
    belt: int  # items on the conveyor, recognised or not
    buffered: int
    k_alpha: int  # items only arm 0 (rear, downstream) reaches
    k_shared: int
    k_beta: int  # items only arm 1 (front) reaches
    alpha_left: int  # items that stayed in arm 0's region when the conveyor last moved


class Queue(Handle):
    """The conveyor, and one buffer an arm."""

    _free = raw.pkc_queue_free

    def __init__(self, scenario: Union[Scenario, str] = Scenario()) -> None:
        made = ctypes.POINTER(raw.pkc_queue)()
        check(raw.pkc_queue_create(byref(scenario_in(scenario)), byref(made)))
        self._take(made)

    def clone(self) -> Queue:
        made = ctypes.POINTER(raw.pkc_queue)()
        check(raw.pkc_queue_clone(self._handle, byref(made)))
        return Queue._adopt(made)

    __copy__ = clone

    def __deepcopy__(self, _memo: Any) -> Queue:
        return self.clone()

    def push(self, item: ItemLike) -> None:
        """An item arrives at the conveyor's end; a StateError if the queue holds its id already."""
        check(raw.pkc_queue_push(self._handle, byref(item_in(item))))

    def extend(self, items: Iterable[ItemLike]) -> None:
        """Items arrive one after the other; those before one that is refused stay."""
        for item in items:
            self.push(item)

    def remove(self, id: int) -> None:
        """An item leaves without being packed; the conveyor advances."""
        check(raw.pkc_queue_remove(self._handle, int32("id", id)))

    def remove_items(self, ids: Iterable[int]) -> None:
        """Several leave at once, or none does; the conveyor advances as it does after a step."""
        given = [int32("id", id) for id in ids]
        check(raw.pkc_queue_remove_items(self._handle, (ctypes.c_int32 * len(given))(*given),
                                         len(given)))

    def put_in_buffer(self, item: ItemLike, arm: int) -> None:
        """An item comes into the buffer of `arm` from without."""
        check(raw.pkc_queue_put_in_buffer(self._handle, byref(item_in(item)), int32("arm", arm)))

    def set_alpha_left(self, alpha_left: int) -> None:
        """Arranges the regions as if so many items (0..64) had stayed in arm 0's: for a queue
        rebuilt from a message."""
        check(raw.pkc_queue_set_alpha_left(self._handle, int32("alpha_left", alpha_left)))

    @property
    def scenario(self) -> Scenario:
        scenario = initialised(raw.pkc_scenario)
        check(raw.pkc_queue_get_scenario(self._handle, byref(scenario)))
        return read(Scenario, scenario)

    @property
    def info(self) -> QueueInfo:
        info = initialised(raw.pkc_queue_info)
        check(raw.pkc_queue_get_info(self._handle, byref(info)))
        return read(QueueInfo, info)

    def belt(self) -> list[Queued]:
        """The conveyor's items in arrival order."""
        handle = self._handle
        return [queued_out(q) for q in gathered(
            raw.pkc_queued, lambda *out: raw.pkc_queue_belt(handle, *out))]

    def buffer(self) -> list[Queued]:
        """The buffered items in the order they were unpacked."""
        handle = self._handle
        return [queued_out(q) for q in gathered(
            raw.pkc_queued, lambda *out: raw.pkc_queue_buffer(handle, *out))]


def apply_step(bin: Bin, queue: Queue, actions: Iterable[ActionLike]) -> None:
    """Carries out one step on bin and queue, then lets the conveyor advance. All or nothing: a
    StateError names the first action that breaks a rule. TERMINATE changes nothing: clear or
    replace the bin then."""
    array = actions_in(actions)
    check(raw.pkc_step_apply(handle_of("bin", bin, Bin), handle_of("queue", queue, Queue), array,
                             len(array)))


def save_snapshot(bin: Bin, queue: Queue) -> bytes:
    """Bin, conveyor and buffers as bytes, the same on every machine."""
    packed, waiting = handle_of("bin", bin, Bin), handle_of("queue", queue, Queue)
    return gathered_bytes(lambda *out: raw.pkc_snapshot_save(packed, waiting, *out))


def load_snapshot(snapshot: bytes) -> tuple[Bin, Queue]:
    """A bin and a queue from such bytes; a FormatError names the first offset that is wrong."""
    given = octets("snapshot", snapshot)
    bin, queue = ctypes.POINTER(raw.pkc_bin)(), ctypes.POINTER(raw.pkc_queue)()
    padded = given or b"\0"  # no bytes are not NULL
    array = (ctypes.c_uint8 * len(padded)).from_buffer_copy(padded)
    check(raw.pkc_snapshot_load(array, len(given), byref(bin), byref(queue)))
    return Bin._adopt(bin), Queue._adopt(queue)
