"""Pictures of a comparison of planners: how runs ended, how long they took, and the ground that a player plays on."""

from __future__ import annotations

import io

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.container import BarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fuzzynav.plot.base import COLORS, draw_goal, style
from fuzzynav.plot.runs import draw_world
from fuzzynav.simulate.record import Run
from fuzzynav.world import World

__all__ = ["comparison_svg", "draw_endings", "draw_solved", "ground_png"]

ENDING_COLORS = {
    "reached": COLORS["reference"],
    "hit": COLORS["path"],
    "struck": COLORS["mover"],
    "late": COLORS["accent"],
    "failed": COLORS["obstacle"],
}
HATCHES = {"hit": "xx", "struck": "//", "late": "..", "failed": "\\\\"}
MARGIN = 3.0  # [m] around what a player shows


def draw_endings(ax: Axes, summary: pd.DataFrame, by: str = "method") -> list[BarContainer]:
    """Share of each ending, a bar for each row of a benchmark's summary; the line is the 95 % interval of reached."""
    made, left = [], np.zeros(len(summary))
    rows = np.arange(len(summary))
    for ending, color in ENDING_COLORS.items():
        share = summary[f"{ending} rate"].fillna(0.0).to_numpy()
        made.append(
            ax.barh(rows, share, left=left, color=color, label=ending, hatch=HATCHES.get(ending), edgecolor="white")
        )
        left += share
    low, high = summary["reached low"].to_numpy(float), summary["reached high"].to_numpy(float)
    ax.hlines(rows, low, high, color="black", linewidth=2.0, zorder=5)
    ax.set_yticks(rows, [str(name) for name in summary[by]])
    ax.set(xlim=(0.0, 1.0), xlabel="share of the tasks that can be solved")
    ax.invert_yaxis()
    ax.grid(False)
    ax.legend(ncols=len(ENDING_COLORS), loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)
    return made


def draw_solved(ax: Axes, table: pd.DataFrame, by: str = "method") -> list[Line2D]:
    """Share of the tasks whose goal was reached within a time, a step line for each planner."""
    lines = []
    for key, group in table[table["ending"] != "unsolvable"].groupby(by, sort=False):
        times = np.sort(group.loc[group["ending"] == "reached", "time"].to_numpy(float))
        share = np.arange(len(times) + 1) / len(group)
        ends = np.concatenate([[0.0], times, [max(table["time"].fillna(0.0).max(), 1.0)]])
        (line,) = ax.step(ends, np.append(share, share[-1]), where="post", label=str(key))
        lines.append(line)
    ax.set(xlabel="t [s]", ylabel="reached by then", ylim=(0.0, 1.02), xlim=(0.0, None))
    ax.legend(loc="lower right")
    return lines


def comparison_svg(summary: pd.DataFrame, table: pd.DataFrame) -> str:
    """Both pictures below each other, as the text of an SVG that repeats exactly."""
    style()
    figure = Figure(figsize=(8.0, 3.6 + 0.4 * len(summary)), layout="constrained")
    FigureCanvasAgg(figure)
    above, below = figure.subplots(2, 1, height_ratios=[0.6 + 0.4 * len(summary), 3.0])
    draw_endings(above, summary)
    draw_solved(below, table)
    file = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": "fuzzynav"}):
        figure.savefig(file, format="svg", metadata=dict.fromkeys(("Date", "Creator", "Format", "Type")))
    return file.getvalue()[file.getvalue().index("<svg") :]


def ground_png(world: World, run: Run, width: int = 420) -> tuple[bytes, tuple[float, float, float, float]]:
    """What stands in a run's world, as a PNG without frame, and its edges xmin, xmax, ymin, ymax [m]."""
    style()
    if world.bounds is not None:
        xmin, xmax, ymin, ymax = world.bounds
    else:
        shown = np.vstack([run.poses[:, :2], run.goal])
        (xmin, ymin), (xmax, ymax) = shown.min(axis=0) - MARGIN, shown.max(axis=0) + MARGIN
    box = (float(xmin), float(xmax), float(ymin), float(ymax))
    figure = Figure(figsize=(width / 100.0, width / 100.0 * (ymax - ymin) / (xmax - xmin)), dpi=100)
    figure.set_layout_engine("none")
    canvas = FigureCanvasAgg(figure)
    ax = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    draw_world(ax, world)
    draw_goal(ax, run.goal)
    ax.axis("off")
    ax.set(xlim=box[:2], ylim=box[2:], aspect="auto")
    file = io.BytesIO()
    canvas.print_png(file)
    return file.getvalue(), box
