"""Pictures of thesis 4: the steps of the fusion, its runs moment by moment, and the speeds of two planners."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from numpy.typing import ArrayLike

from fuzzynav.fusion.task import Task
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.plot.base import (
    COLORS,
    CYCLE,
    arrow,
    block,
    diagram,
    draw_goal,
    draw_grid,
    draw_path,
    draw_robot,
)
from fuzzynav.plot.planning import draw_start
from fuzzynav.plot.runs import draw_world, mover_marks
from fuzzynav.simulate.record import Run

__all__ = [
    "draw_braking",
    "draw_driven",
    "draw_fusion_flowchart",
    "draw_fusion_moment",
    "draw_fusion_moments",
    "draw_two_speeds",
    "even_moments",
]

DASHES = ("-", "--", "-.", ":")
KINDS = {"yield": ("movers that yield", COLORS["reference"], "o"), "blind": ("movers that do not", COLORS["path"], "s")}


def draw_fusion_flowchart(ax: Axes) -> Axes:
    """The steps of section 4.4: a path once, its turning points as sub-goals, the window between them."""
    diagram(ax, 13.4, 5.6)
    size = (2.6, 1.0)
    path, cut, points = (
        block(ax, (1.5 + 3.1 * k, 4.7), text, size=size, role="reference")
        for k, text in enumerate(
            ("enhanced A* on the\nknown map (4.4)", "prune (4.2.2.2)", "turning points\nas sub-goals")
        )
    )
    goal = block(ax, (7.7, 2.9), "head for the\ncurrent sub-goal", size=size, role="goal")
    window = block(ax, (4.6, 2.9), "window\n(4.11-4.13)", size=size, role="accent")
    best = block(ax, (1.5, 2.9), "largest $G$\n(4.15)", size=size, role="accent")
    drive = block(ax, (1.5, 1.0), "drive for one step,\nscan", size=size)
    there = block(ax, (4.6, 1.0), "sub-goal\nreached?", size=(2.2, 1.0), role="path")
    last = block(ax, (7.7, 1.0), "the last one?", size=(2.2, 1.0), role="path")
    end = block(ax, (10.9, 1.0), "goal", size=(1.4, 1.0), role="goal")
    for a, b in ((path, cut), (cut, points)):
        arrow(ax, a.right, b.left)
    arrow(ax, points.bottom, goal.top)
    arrow(ax, goal.left, window.right)
    arrow(ax, window.left, best.right)
    arrow(ax, best.bottom, drive.top)
    arrow(ax, drive.right, there.left)
    arrow(ax, there.top, window.bottom, "no", offset=(0.3, 0.0))
    arrow(ax, there.right, last.left, "yes", offset=(0.0, 0.2))
    arrow(ax, last.top, goal.bottom, "no: the next", offset=(0.85, 0.0))
    arrow(ax, last.right, end.left, "yes", offset=(0.0, 0.2))
    ax.text(
        11.4,
        4.2,
        "unknown and moving obstacles\nare met by the window alone:\nthe path is planned once",
        fontsize=8.5,
        ha="center",
    )
    return ax


def draw_driven(ax: Axes, grid: GridMap, runs: Mapping[str, Run], *, title: str = "") -> list[Line2D]:
    """One or more driven paths on a map, with start and goal; a legend above where there are several."""
    draw_grid(ax, grid, lines=True)
    lines = []
    for (name, run), role, dash in zip(runs.items(), ("path", "robot", "reference"), DASHES, strict=False):
        label = f"{name}: {run.length:.2f} m, {run.status}"
        lines.append(draw_path(ax, run.poses, role=role, linestyle=dash, label=label))
        draw_start(ax, run.poses[0, :2])
        draw_goal(ax, run.goal)
    if title:
        ax.set_title(title)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), frameon=False)
    return lines


def even_moments(run: Run, count: int = 8) -> list[int]:
    """Steps at equal shares of the driven way, the first and the last among them.

    Raises ValueError for fewer than two moments.
    """
    if count < 2:
        raise ValueError(f"a run is shown at two moments or more, got {count}")
    way = np.concatenate([[0.0], np.cumsum(np.abs(run.driven[:, 0]))])
    return [int(np.searchsorted(way, share * way[-1] - 1e-9)) for share in np.linspace(0.0, 1.0, count)]


def draw_fusion_moment(ax: Axes, task: Task, run: Run, step: int, path: ArrayLike, *, title: str = "") -> None:
    """One moment of a fusion run, in the printed code of colours as far as it can be told apart.

    Dark: known, grey and hatched: unknown, orange: moving; dotted: the global path, with a ring around the sub-goal
    that is headed for; drawn through: driven so far.
    """
    draw_world(ax, task.world)
    points = np.asarray(path, dtype=float)
    draw_path(ax, points, role="reference", linestyle=":", marker="o")
    draw_path(ax, run.poses[: step + 1])
    mover_marks(ax, task.world, run).place(step)
    draw_robot(ax, run.poses[step], max(run.radius, 0.05))
    draw_start(ax, run.poses[0, :2])
    draw_goal(ax, run.goal)
    if "subgoal" in run.log and len(run.log["subgoal"]):
        headed = points[1:][int(run.log["subgoal"][min(step, run.iterations - 1)])]
        ax.add_patch(Circle((headed[0], headed[1]), 0.6, fill=False, edgecolor=COLORS["goal"], linewidth=1.6, zorder=6))
    ax.set_title(title or f"{run.t[step]:.1f} s")


def draw_fusion_moments(axes: Sequence[Axes], task: Task, run: Run, path: ArrayLike) -> list[int]:
    """The moments of a run at equal shares of its way, one on each of the axes; returns their steps."""
    steps = even_moments(run, len(axes))
    for letter, ax, step in zip("abcdefghijklmnop", axes, steps, strict=False):
        draw_fusion_moment(ax, task, run, step, path, title=f"({letter}) {run.t[step]:.1f} s")
        ax.set(xlabel="", ylabel="")
    return steps


def draw_two_speeds(axes: Sequence[Axes], runs: Mapping[str, Run]) -> list[Line2D]:
    """v and omega of several runs over time, with the total variation of each in the legend."""
    lines = []
    for k, (ax, name, unit) in enumerate(zip(axes, ("v", r"\omega"), ("m/s", "rad/s"), strict=True)):
        for color, dash, (label, run) in zip(CYCLE, DASHES, runs.items(), strict=False):
            sum_ = run.variation[k] if run.iterations > 1 else 0.0
            text = f"{label}: total variation {sum_:.1f} {unit}"
            (line,) = ax.plot(run.t[:-1], run.driven[:, k], color=color, linestyle=dash, linewidth=1.1, label=text)
            lines.append(line)
        ax.set_ylabel(f"${name}$ [{unit}]")
        ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
    axes[-1].set_xlabel("t [s]")
    return lines


def draw_braking(axes: Sequence[Axes], table: pd.DataFrame) -> list[Line2D]:
    """Left the share of runs that reach the goal with its 95 % interval, right their median time, over braking power.

    table: rows with `brake` [m/s^2], `movers` ("yield" or "blind") and the columns of the protocol's summary.
    """
    rate, time = axes
    made = []
    for kind, (label, color, mark) in KINDS.items():
        rows = table[table["movers"] == kind].sort_values("brake")
        (line,) = rate.plot(rows["brake"], rows["reached rate"], mark + "-", color=color, label=label)
        rate.fill_between(rows["brake"], rows["reached low"], rows["reached high"], color=color, alpha=0.2, linewidth=0)
        (other,) = time.plot(rows["brake"], rows["median time"], mark + "-", color=color, label=label)
        made += [line, other]
    for ax in axes:
        ax.set(xscale="log", xlabel="braking power [m/s²]")
        ax.set_xticks(sorted(table["brake"].unique()), [f"{b:g}" for b in sorted(table["brake"].unique())])
        ax.minorticks_off()
    rate.set(ylim=(0.0, 1.02), ylabel="share that reaches the goal")
    time.set(ylim=(0.0, None), ylabel="median time [s]")
    rate.legend(loc="lower right")
    return made
