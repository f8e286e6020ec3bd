"""What the arms do and when, how it runs in a simulated world, and files that show both."""
from __future__ import annotations

import ctypes
from ctypes import byref
from enum import IntEnum
from typing import Any, Iterable, NamedTuple, Optional, Union

from . import _raw as raw
from ._handle import Handle, handle_of
from ._marshal import Path, gathered, initialised, int32, known, path, read, real
from .bin import Bin
from .cell import Cell
from .errors import check
from .queue import Queue, Scenario, scenario_in
from .records import ActionLike, actions_in


class Mode(IntEnum):
    """How two arms are coordinated."""

    SYNC_PAPER = raw.PKC_MODE_SYNC_PAPER
    ZONE_MUTEX = raw.PKC_MODE_ZONE_MUTEX
    COORDINATED = raw.PKC_MODE_COORDINATED


class Wait(IntEnum):
    """Why an arm waits; the index of ArmTimes.waits."""

    NONE = 0
    BELT = raw.PKC_WAIT_BELT
    PLANNING = raw.PKC_WAIT_PLANNING
    OTHER_ARM = raw.PKC_WAIT_OTHER_ARM
    BIN = raw.PKC_WAIT_BIN
    CELLS = raw.PKC_WAIT_CELLS
    SYNC = raw.PKC_WAIT_SYNC
    DONE = raw.PKC_WAIT_DONE


class Activity(IntEnum):
    TRAVEL = raw.PKC_ACTIVITY_TRAVEL
    LOWER = raw.PKC_ACTIVITY_LOWER
    GRIP = raw.PKC_ACTIVITY_GRIP
    RELEASE = raw.PKC_ACTIVITY_RELEASE
    LIFT = raw.PKC_ACTIVITY_LIFT
    WAIT = raw.PKC_ACTIVITY_WAIT


class Outcome(IntEnum):
    """What became of an item that was to be put into the bin."""

    OK = raw.PKC_PLACE_OK
    JAMMED = raw.PKC_PLACE_JAMMED
    MISPLACED = raw.PKC_PLACE_MISPLACED
    ABSENT = raw.PKC_PLACE_ABSENT


class Trace(IntEnum):
    """Kinds of files about a schedule."""

    CHROME = raw.PKC_TRACE_CHROME
    TIMELINE = raw.PKC_TRACE_TIMELINE
    JOINTS_0 = raw.PKC_TRACE_JOINTS_0
    JOINTS_1 = raw.PKC_TRACE_JOINTS_1
    GANTT = raw.PKC_TRACE_GANTT
    REPLAY = raw.PKC_TRACE_REPLAY


class ArmTimes(NamedTuple):
    """Where an arm's time goes, in seconds; it adds up to the makespan."""

    travel: float
    strokes: float
    grips: float
    waits: tuple[float, ...]


class ScheduleInfo(NamedTuple):
    mode: Mode
    taken: Mode  # whose schedule it is: its own or an incumbent's
    steps: int
    makespan: float  # seconds until both arms are home
    lower_bound: float
    released: float  # when the last step's work was
    belt: float  # seconds in which the belt moves
    planning: float  # seconds, as the cell description has them
    min_clearance: float  # between the arms, metres; -1 with one arm
    arms: tuple[ArmTimes, ArmTimes]
    hash: int  # of the schedule, times to the microsecond
    nodes: int  # of the coordination search
    milliseconds: float  # thread CPU time of motion planning and coordination


class ArmSample(NamedTuple):
    """An arm at a time: its joints, in radians (metres for the third of a SCARA), and what it
    does."""

    position: tuple[float, ...]
    velocity: tuple[float, ...]  # a second
    acceleration: tuple[float, ...]
    tool: tuple[float, ...]  # x, y, z of the tip, metres; yaw, radians
    held: float  # half the diagonal of the item in the gripper, metres; 0: none
    item: int  # that it is about; -1: none
    step: int
    activity: Activity
    reason: Wait


class Schedule(Handle):
    """What the arms, the belt and the planner do and when."""

    _free = raw.pkc_schedule_free

    def __init__(self, cell: Cell, scenario: Union[Scenario, str],
                 mode: int = Mode.COORDINATED) -> None:
        made = ctypes.POINTER(raw.pkc_schedule)()
        check(raw.pkc_schedule_create(handle_of("cell", cell, Cell), byref(scenario_in(scenario)),
                                      int32("mode", mode), byref(made)))
        self._take(made)

    def add_step(self, bin: Bin, queue: Queue, actions: Iterable[ActionLike]) -> None:
        """Adds the work of a step that was planned for `bin` and `queue`: those before the step."""
        array = actions_in(actions)
        check(raw.pkc_schedule_add_step(self._handle, handle_of("bin", bin, Bin),
                                        handle_of("queue", queue, Queue), array, len(array)))

    def put_aside(self, item: int, time: float) -> None:
        """The item that is let go over the bin at `time` did not fit: its arm takes it to its
        buffer before it does anything else."""
        check(raw.pkc_schedule_put_aside(self._handle, int32("item", item), real("time", time)))

    @property
    def info(self) -> ScheduleInfo:
        info = initialised(raw.pkc_schedule_info)
        check(raw.pkc_schedule_get_info(self._handle, byref(info)))
        return read(ScheduleInfo, info, mode=known(Mode, info.mode), taken=known(Mode, info.taken),
                    arms=tuple(read(ArmTimes, arm) for arm in info.arms))

    def sample(self, arm: int, time: float) -> ArmSample:
        """The arm at a time, 0..makespan seconds."""
        sample = raw.pkc_arm_sample()
        check(raw.pkc_schedule_sample(self._handle, int32("arm", arm), real("time", time),
                                      byref(sample)))
        return read(ArmSample, sample, activity=known(Activity, sample.activity),
                    reason=known(Wait, sample.reason))

    def simulate(self, **options: Any) -> Simulation:
        """Runs what the schedule has so far; the keywords of Simulation."""
        return Simulation(self, **options)

    def write_trace(self, kind: int, file: Path, *, simulation: Optional[Simulation] = None,
                    period: float = 0.01) -> None:
        """Writes a file about the schedule, all or nothing. `simulation` adds the poses of its run;
        `period`, 0.0001..10 seconds, is that of the CSV files."""
        run = None if simulation is None else handle_of("simulation", simulation, Simulation)
        check(raw.pkc_trace_write_file(self._handle, run, int32("kind", kind),
                                       real("period", period), path(file)))


class Place(NamedTuple):
    item: int
    step: int
    arm: int
    outcome: Outcome
    time: float  # of the release, seconds
    error: float  # between where it lies at the end and where it should, metres
    turn: float  # the same in radians


class SimulationInfo(NamedTuple):
    places: int
    jams: int
    misplaced: int
    worst_error: float  # of an item in the bin at the end, metres
    worst_overlap: float  # by which two of them, or one and a wall, overlap
    seconds: float  # simulated
    steps: int
    detections: int  # arrivals that the photo-eyes saw
    missed: int  # and did not see
    hash: int  # of all final poses
    milliseconds: float  # thread CPU time of the run


class Simulation(Handle):
    """A run of a schedule in a fresh Box2D world; equal schedules and options give equal runs.
    `hertz`: steps a second, 60..1000 (240); `sigma`, `sigma_yaw`: standard deviations of an item's
    place, 0..0.05 metres, and turn, 0..0.5 radians, in the gripper (0); `frames`: keep the poses
    for the replay (False)."""

    _free = raw.pkc_simulation_free

    def __init__(self, schedule: Schedule, *, hertz: Optional[int] = None,
                 sigma: Optional[float] = None, sigma_yaw: Optional[float] = None,
                 seed: Optional[int] = None, frames: Optional[bool] = None) -> None:
        options = initialised(raw.pkc_simulation_options, hertz=hertz, sigma=sigma,
                              sigma_yaw=sigma_yaw, seed=seed, frames=frames)
        made = ctypes.POINTER(raw.pkc_simulation)()
        check(raw.pkc_simulate(handle_of("schedule", schedule, Schedule), byref(options),
                               byref(made)))
        self._take(made)

    @property
    def info(self) -> SimulationInfo:
        info = initialised(raw.pkc_simulation_info)
        check(raw.pkc_simulation_get_info(self._handle, byref(info)))
        return read(SimulationInfo, info)

    def places(self) -> list[Place]:
        """In the order of their times."""
        handle = self._handle
        return [read(Place, place, outcome=known(Outcome, place.outcome)) for place in gathered(
            raw.pkc_place, lambda *out: raw.pkc_simulation_places(handle, *out))]
