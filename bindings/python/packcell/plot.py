"""Pictures by matplotlib, which is imported when the first is drawn."""
from __future__ import annotations

from typing import Any, Optional

from .bin import Bin
from .errors import argument_error
from .records import CELL_FIXED
from .schedule import Activity, Schedule, Wait

_COLOURS = {
    Activity.TRAVEL: "#4c78a8",
    Activity.LOWER: "#72b7b2",
    Activity.GRIP: "#f58518",
    Activity.RELEASE: "#e45756",
    Activity.LIFT: "#54a24b",
    Activity.WAIT: "#d9d9d9",
}


def _axes(ax: Optional[Any], size: tuple[float, float]) -> Any:
    if ax is not None:
        return ax
    from matplotlib import pyplot
    return pyplot.subplots(figsize=size, layout="constrained")[1]


def draw_bin(bin: Bin, ax: Optional[Any] = None) -> Any:
    """The bin from above, each item with its id, fixed cells dark. Draws into the axes given, or
    new ones, and returns them."""
    import matplotlib
    from matplotlib.patches import Rectangle
    info = bin.info
    inch = 5.0 / max(info.w, info.h)
    ax = _axes(ax, (max(2.0, info.w * inch), max(2.0, info.h * inch)))
    colours = matplotlib.colormaps["tab20"]
    for p in bin.items():
        ax.add_patch(Rectangle((p.x, p.y), p.w, p.h, facecolor=colours(p.item.id % 20),
                               edgecolor="black"))
        ax.text(p.x + p.w / 2, p.y + p.h / 2, str(p.item.id), ha="center", va="center")
    for y, row in enumerate(bin.cells()):
        for x, cell in enumerate(row):
            if cell == CELL_FIXED:
                ax.add_patch(Rectangle((x, y), 1, 1, facecolor="#404040"))
    ax.set_xlim(0, info.w)
    ax.set_ylim(info.h, 0)
    ax.set_aspect("equal")
    ax.set_title(f"{100 * bin.utilization:.1f} % full")
    return ax


def spans(schedule: Schedule, arm: int,
          period: float = 0.05) -> list[tuple[float, float, Activity, Wait, int]]:
    """What an arm does from when to when: (begin, end, activity, reason of a wait, item), looked
    at every `period` seconds."""
    if not period > 0:
        raise argument_error(f"period {period}: must be > 0")
    makespan = schedule.info.makespan
    found: list[tuple[float, float, Activity, Wait, int]] = []
    begin, now = 0.0, None
    for tick in range(int(makespan / period) + 1):
        sample = schedule.sample(arm, min(tick * period, makespan))
        what = (sample.activity, sample.reason, sample.item)
        if what != now:
            if now is not None:
                found.append((begin, tick * period, *now))
            begin, now = tick * period, what
    if now is not None and makespan > begin:
        found.append((begin, makespan, *now))
    return found


def gantt(schedule: Schedule, ax: Optional[Any] = None, period: float = 0.05) -> Any:
    """The arms' activities over time, with the item's id where it is gripped and let go. Draws into
    the axes given, or new ones, and returns them."""
    from matplotlib.patches import Patch
    info = schedule.info
    ax = _axes(ax, (12.0, 2.5))
    arms = [0] if info.min_clearance < 0 else [0, 1]
    for arm in arms:
        for begin, end, activity, _, item in spans(schedule, arm, period):
            ax.broken_barh([(begin, end - begin)], (arm - 0.4, 0.8),
                           facecolors=_COLOURS.get(activity, "black"))
            if activity in (Activity.GRIP, Activity.RELEASE) and item >= 0:
                ax.text((begin + end) / 2, arm, str(item), ha="center", va="center", fontsize=7)
    ax.set_yticks(arms, [f"arm {arm}" for arm in arms])
    ax.set_ylim(len(arms) - 0.5, -0.5)
    ax.set_xlim(0, info.makespan or 1)
    ax.set_xlabel("time (s)")
    ax.legend(handles=[Patch(color=colour, label=activity.name.lower())
                       for activity, colour in _COLOURS.items()],
              ncol=len(_COLOURS), loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)
    return ax
