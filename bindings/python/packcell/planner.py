"""The planner, the exact packer and the clairvoyant bound."""
from __future__ import annotations

import ctypes
from ctypes import byref
from enum import IntEnum
from typing import Any, Iterable, NamedTuple, Optional, Union

from . import _raw as raw
from ._handle import Handle, handle_of
from ._marshal import initialised, known, read, uint64
from .bin import Bin
from .errors import BusyError, Status, check
from .policy import Policy
from .queue import Queue
from .records import Action, ItemLike, Placement, actions_out, items_in, placement_out

UNLIMITED: int = raw.PKC_UNLIMITED
SELECT_AUTO: int = raw.PKC_SELECT_AUTO
SELECT_ALL: int = raw.PKC_SELECT_ALL


class Method(IntEnum):
    PAPER = raw.PKC_METHOD_PAPER  # Algorithms 1-3 of the paper as written
    EXACT = raw.PKC_METHOD_EXACT  # equal states once; repacking by an exact packer


class Repack(IntEnum):
    OFF = raw.PKC_REPACK_OFF
    ANYTIME = raw.PKC_REPACK_ANYTIME  # raises the utilisation as far as the budget allows
    FULL = raw.PKC_REPACK_FULL  # only for a plan that places all known items or fills the bin


class Proof(IntEnum):
    """What a plan is known to be."""

    NONE = raw.PKC_PROOF_NONE
    OPTIMAL = raw.PKC_PROOF_OPTIMAL
    IMPOSSIBLE = raw.PKC_PROOF_IMPOSSIBLE
    BUDGET = raw.PKC_PROOF_BUDGET


class Packing(IntEnum):
    """What the exact packer found."""

    FOUND = raw.PKC_PACKING_FOUND
    IMPOSSIBLE = raw.PKC_PACKING_IMPOSSIBLE
    BUDGET = raw.PKC_PACKING_BUDGET  # not decided within the budget


class Budget(NamedTuple):
    """How much a plan may cost: placements tried, and wall time, 0..1e12 ms; 0 is no limit, and
    without any a plan may take hours. A budget in nodes alone gives the same plan on every
    machine."""

    nodes: int = 200000
    milliseconds: float = 0.0


class PlanInfo(NamedTuple):
    actions: int
    packs: int
    unpacks: int
    repacked: bool  # the plan came from repacking
    terminate: bool  # the bin is closed by this step
    proof: Proof
    cancelled: bool
    utilization: float  # of the bin once all that was planned ahead is packed, 0..1
    score: int  # contact rewards summed over the forward simulation; 0 after repacking
    nodes: int
    tree_nodes: int
    hash: int  # plan_hash of the actions
    milliseconds: float  # thread CPU time spent planning
    repack_milliseconds: float


class Plan(NamedTuple):
    """One step's actions, and what is known about them."""

    actions: list[Action]
    info: PlanInfo

    @property
    def terminate(self) -> bool:
        return self.info.terminate


class ExactPacking(NamedTuple):
    """`placements`, in the items' order, when the answer is FOUND."""

    answer: Packing
    placements: Optional[list[Placement]]
    nodes: int


class Bound(NamedTuple):
    """`items` is exact unless the answer is BUDGET: then it is an upper bound."""

    items: int
    answer: Packing


def budget_in(budget: Union[Budget, int, None]) -> Any:
    """pkc_budget of a Budget or a number of nodes; None is the library's default."""
    if budget is None:
        return initialised(raw.pkc_budget)
    if isinstance(budget, Budget):
        return initialised(raw.pkc_budget, **budget._asdict())
    return initialised(raw.pkc_budget, nodes=budget)


def plan_info_out(info: Any) -> PlanInfo:
    return read(PlanInfo, info, repacked=bool(info.repacked), terminate=bool(info.terminate),
                proof=known(Proof, info.proof), cancelled=bool(info.cancelled))


class Planner(Handle):
    """Plans steps (Algorithm 1). All memory is taken here; None is the library's default, of the
    policy too.

    - method: Method.EXACT;
    - rotation: items may be turned (True); if not, packed ones that lie turned stay where they are;
    - repack: Repack.OFF;
    - select: SELECT_AUTO (two candidates in Method.PAPER with repacking, else all), SELECT_ALL, or
      candidates kept a node, 1..128;
    - buffer_capacity: items an arm's buffer holds at any moment of a step, 0..4096, or UNLIMITED;
    - skip: an accessible item that cannot be placed is skipped for good (False: it stays for the
      next bin);
    - max_side: largest bin side planned for, 1..128 (128);
    - max_items: most items in the bin at once, 1..16384 (256);
    - max_known: most recognised and buffered items together, 1..128 (128);
    - memory: bytes for tables of states met, 64 KiB..4 GiB (8 MiB)."""

    _free = raw.pkc_planner_free

    def __init__(self, policy: Union[Policy, str, None] = None, *, method: Optional[int] = None,
                 rotation: Optional[bool] = None, repack: Optional[int] = None,
                 select: Optional[int] = None, buffer_capacity: Optional[int] = None,
                 skip: Optional[bool] = None, max_side: Optional[int] = None,
                 max_items: Optional[int] = None, max_known: Optional[int] = None,
                 memory: Optional[int] = None) -> None:
        options = initialised(raw.pkc_planner_options, method=method, rotation=rotation,
                              repack=repack, select=select, buffer_capacity=buffer_capacity,
                              skip=skip, max_side=max_side, max_items=max_items,
                              max_known=max_known, memory=memory)
        if isinstance(policy, str):
            policy = Policy(policy)
        chosen = None if policy is None else handle_of("policy", policy, Policy)
        made = ctypes.POINTER(raw.pkc_planner)()
        check(raw.pkc_planner_create(byref(options), chosen, byref(made)))
        self._take(made)

    def plan(self, bin: Bin, queue: Queue, budget: Union[Budget, int, None] = None) -> Plan:
        """The next step for what bin and queue hold; changes neither. Always a legal plan:
        TERMINATE alone when nothing within reach has a position, an empty conveyor included. A
        LimitError if bin or queue hold more than the planner was made for. Other threads run
        meanwhile, and one of them may call cancel(); Ctrl-C is heard once the call ends."""
        info = initialised(raw.pkc_plan_info)
        check(raw.pkc_planner_plan(self._handle, handle_of("bin", bin, Bin),
                                   handle_of("queue", queue, Queue), byref(budget_in(budget)),
                                   byref(info)))
        plan = self.result()
        if plan.info.hash != info.hash:  # nobody shall carry out the plan for another bin
            raise BusyError(Status.BUSY, "planner was used by another thread before its plan was "
                                         "read: a planner belongs to one thread at a time")
        return plan

    def begin(self, bin: Bin, queue: Queue, budget: Union[Budget, int, None] = None) -> None:
        """The same work in slices: begin copies the state, step() does some of it."""
        check(raw.pkc_planner_begin(self._handle, handle_of("bin", bin, Bin),
                                    handle_of("queue", queue, Queue), byref(budget_in(budget))))

    def step(self, nodes: int) -> bool:
        """Spends up to `nodes` nodes, >= 1; true when nothing is left to do."""
        done = ctypes.c_int32()
        check(raw.pkc_planner_step(self._handle, uint64("nodes", nodes), byref(done)))
        return bool(done.value)

    def result(self) -> Plan:
        """The plan, or the best so far while steps are left; a StateError if nothing was begun."""
        info = initialised(raw.pkc_plan_info)
        actions = (raw.pkc_action * raw.PKC_MAX_ACTIONS)()
        count = ctypes.c_size_t()
        check(raw.pkc_planner_result(self._handle, byref(info), actions, len(actions),
                                     byref(count)))
        return Plan(actions_out(actions[:count.value]), plan_info_out(info))

    def cancel(self) -> None:
        """From any thread: the plan being made ends at once with the best so far."""
        check(raw.pkc_planner_cancel(self._handle))


def exact_pack(bin: Bin, items: Iterable[ItemLike], *, rotation: bool = True,
               budget: Union[Budget, int, None] = None) -> ExactPacking:
    """Can all items, at most 16384, be placed on the bin's free cells as it is?"""
    array = items_in(items)
    placements = (raw.pkc_placement * len(array))()
    answer, nodes = ctypes.c_int32(), ctypes.c_uint64()
    check(raw.pkc_exact_pack(handle_of("bin", bin, Bin), array, len(array), int(bool(rotation)),
                             byref(budget_in(budget)), placements, byref(answer), byref(nodes)))
    found = answer.value == Packing.FOUND
    return ExactPacking(known(Packing, answer.value),
                        [placement_out(p) for p in placements] if found else None, nodes.value)


def bound_in_order(bin: Bin, items: Iterable[ItemLike], *, rotation: bool = True,
                   budget: Union[Budget, int, None] = None) -> Bound:
    """How many of the next items, in arrival order and without one left out, fit together: no
    planner without a buffer packs more into this bin."""
    array = items_in(items)
    count, answer = ctypes.c_size_t(), ctypes.c_int32()
    check(raw.pkc_bound_in_order(handle_of("bin", bin, Bin), array, len(array),
                                 int(bool(rotation)), byref(budget_in(budget)), byref(count),
                                 byref(answer)))
    return Bound(count.value, known(Packing, answer.value))
