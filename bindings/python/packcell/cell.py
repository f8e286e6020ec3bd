"""The cell: arms, bin, belt and buffers. Metres, radians and seconds from here on."""
from __future__ import annotations

import ctypes
from ctypes import byref
from typing import Any, Iterable, NamedTuple, Optional, Sequence, Union

from . import _raw as raw
from ._handle import Handle, handle_of
from ._marshal import (Path, gathered_text, initialised, int32, names, path, read, real, text,
                       utf8)
from .errors import argument_error, check
from .queue import Queue, Scenario, scenario_in
from .records import Action, ActionLike, actions_in, actions_out

MAX_JOINTS: int = raw.PKC_MAX_JOINTS


class CellInfo(NamedTuple):
    arms: int  # 1 or 2
    bin_w: int  # cells
    bin_h: int
    buffer_slots: tuple[int, int]  # items that each arm's buffer holds
    joints: tuple[int, int]  # of each arm: 6 or 4; 0 where there is none
    margin: float  # kept between the arms, metres
    tick: float  # of coordination, seconds
    cycle: float  # one arm's, seconds: home, belt, bin, home, with dwells
    name: str


class LayoutInfo(NamedTuple):
    evaluations: int
    before: float  # mean transfer time, seconds
    after: float


def _doubles(name: str, values: Sequence[float], count: int, least: int) -> Any:
    given = [real(name, value) for value in values]
    if not least <= len(given) <= count:
        raise argument_error(f"{name} has {len(given)} numbers: must have {least}..{count}")
    return (ctypes.c_double * count)(*given)


class Cell(Handle):
    """A preset by name (Cell.presets()), or a description by Cell.load and Cell.load_file.
    Immutable; threads may share it."""

    _free = raw.pkc_cell_free

    def __init__(self, preset: str = "ur5e") -> None:
        made = ctypes.POINTER(raw.pkc_cell)()
        check(raw.pkc_cell_create(text("preset", preset), byref(made)))
        self._take(made)

    @staticmethod
    def presets() -> list[str]:
        return names(raw.pkc_cell_preset)

    @classmethod
    def load(cls, json: str) -> Cell:
        """From the text of a cell.json: a FormatError names what is no cell description, an
        ArgumentError a cell that cannot work."""
        given = utf8("json", json)
        made = ctypes.POINTER(raw.pkc_cell)()
        check(raw.pkc_cell_load(given, len(given), byref(made)))
        return cls._adopt(made)

    @classmethod
    def load_file(cls, file: Path) -> Cell:
        made = ctypes.POINTER(raw.pkc_cell)()
        check(raw.pkc_cell_load_file(path(file), byref(made)))
        return cls._adopt(made)

    def save(self) -> str:
        """The description as JSON text; loading it gives the same cell."""
        handle = self._handle
        return gathered_text(lambda *out: raw.pkc_cell_save(handle, *out))

    def save_file(self, file: Path) -> None:
        check(raw.pkc_cell_save_file(self._handle, path(file)))

    @property
    def info(self) -> CellInfo:
        info = initialised(raw.pkc_cell_info)
        check(raw.pkc_cell_get_info(self._handle, byref(info)))
        return read(CellInfo, info)

    def check(self, scenario: Union[Scenario, str]) -> None:
        """Raises an ArgumentError if the arms do not reach the belt's zones as it says."""
        check(raw.pkc_cell_check(self._handle, byref(scenario_in(scenario))))

    def inverse(self, arm: int, pose: Sequence[float]) -> tuple[float, ...]:
        """Joints (radians; metres for the third of a SCARA) at which the tool, straight down, has
        its tip at (x, y, z), metres, with this yaw, radians; a StateError if there are none."""
        joints = (ctypes.c_double * MAX_JOINTS)()
        check(raw.pkc_cell_inverse(self._handle, int32("arm", arm), _doubles("pose", pose, 4, 4),
                                   joints))
        return tuple(joints)

    def forward(self, arm: int, joints: Sequence[float]) -> tuple[float, ...]:
        """(x, y, z, yaw) of the tool at these joints; a missing one is 0."""
        pose = (ctypes.c_double * 4)()
        check(raw.pkc_cell_forward(self._handle, int32("arm", arm),
                                   _doubles("joints", joints, MAX_JOINTS, 1), pose))
        return tuple(pose)

    def optimize_layout(self, scenario: Union[Scenario, str], *, evaluations: Optional[int] = None,
                        range: Optional[float] = None) -> tuple[Cell, LayoutInfo]:
        """Moves bases, buffers and homes for the shortest mean transfer; never worse. `evaluations`
        of the mean, 10..100000 (800); `range` by which they may move, 0..2 metres (0.3)."""
        options = initialised(raw.pkc_layout_options, evaluations=evaluations, range=range)
        info = initialised(raw.pkc_layout_info)
        made = ctypes.POINTER(raw.pkc_cell)()
        check(raw.pkc_cell_optimize_layout(self._handle, byref(scenario_in(scenario)),
                                           byref(options), byref(info), byref(made)))
        return Cell._adopt(made), read(LayoutInfo, info)


def allocate(cell: Cell, queue: Queue, actions: Iterable[ActionLike]) -> list[Action]:
    """Task allocation (paper, Sec. IV-D): the actions, each item from the belt with the nearest arm
    that reaches it. `queue` is the one before the step."""
    array = actions_in(actions)
    check(raw.pkc_allocate(handle_of("cell", cell, Cell), handle_of("queue", queue, Queue), array,
                           len(array)))
    return actions_out(array)
