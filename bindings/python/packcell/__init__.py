"""packcell plans a robotic bin-packing cell: Python over the C library, by ctypes.

    with Bin(10, 10) as bin, Queue("S-R5A3") as queue, Planner() as planner:
        queue.extend(Item(i, w, h) for i, (w, h) in enumerate(sizes))
        plan = planner.plan(bin, queue)
        apply_step(bin, queue, plan.actions)

The library is the one that PACKCELL_LIBRARY names, else libpackcell.so.0 beside this package, else
the loader's. packcell.env has environments for learning, packcell.plot draws.
"""
from .bin import Bin, BinInfo
from .cell import MAX_JOINTS, Cell, CellInfo, LayoutInfo, allocate
from .environment import Environment, EnvironmentInfo, Observation, StepOutcome
from .errors import (ArgumentError, BusyError, CapacityError, ClosedError, FileError, FormatError,
                     InternalError, LimitError, OutOfMemoryError, PackcellError, StateError, Status,
                     StructError, UnsupportedError)
from .generator import Generate, Generator
from .grid import Grid
from .planner import (SELECT_ALL, SELECT_AUTO, UNLIMITED, Bound, Budget, ExactPacking, Method,
                      Packing, Plan, PlanInfo, Planner, Proof, Repack, bound_in_order, exact_pack)
from .policy import Architecture, BatchEvaluation, Evaluation, Measurement, Policy, PolicyInfo
from .queue import (Queue, QueueInfo, Scenario, apply_step, load_snapshot, save_snapshot)
from .records import (CELL_FIXED, CELL_FREE, MAX_SIDE, Action, Item, ItemFlag, Op, Placement,
                      Queued, plan_hash, version)
from .schedule import (Activity, ArmSample, ArmTimes, Mode, Outcome, Place, Schedule, ScheduleInfo,
                       Simulation, SimulationInfo, Trace, Wait)
from .trainer import Trainer, TrainerInfo
from .training_options import Learner, Rotation, TrainerOptions

__version__ = "0.1.0"

__all__ = [
    "Action", "Activity", "Architecture", "ArgumentError", "ArmSample", "ArmTimes",
    "BatchEvaluation", "Bin", "BinInfo", "Bound", "Budget", "BusyError", "CELL_FIXED", "CELL_FREE",
    "CapacityError", "Cell", "CellInfo", "ClosedError", "Environment", "EnvironmentInfo",
    "Evaluation", "ExactPacking", "FileError", "FormatError", "Generate", "Generator", "Grid",
    "InternalError", "Item", "ItemFlag", "LayoutInfo", "Learner", "LimitError", "MAX_JOINTS",
    "MAX_SIDE", "Measurement", "Method", "Mode", "Observation", "Op", "OutOfMemoryError", "Outcome",
    "PackcellError", "Packing", "Place", "Placement", "Plan", "PlanInfo", "Planner", "Policy",
    "PolicyInfo", "Proof", "Queue", "QueueInfo", "Queued", "Repack", "Rotation", "SELECT_ALL",
    "SELECT_AUTO", "Scenario", "Schedule", "ScheduleInfo", "Simulation", "SimulationInfo",
    "StateError", "Status", "StepOutcome", "StructError", "Trace", "Trainer", "TrainerInfo",
    "TrainerOptions", "UNLIMITED", "UnsupportedError", "Wait", "allocate", "apply_step",
    "bound_in_order", "exact_pack", "load_snapshot", "plan_hash", "save_snapshot", "version",
]
