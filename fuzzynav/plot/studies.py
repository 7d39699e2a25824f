"""Pictures of what long studies found."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from fuzzynav.plot.base import COLORS

__all__ = ["draw_braking"]

KINDS = {"yield": ("movers that yield", COLORS["reference"], "o"), "blind": ("movers that do not", COLORS["path"], "s")}


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
        (other,) = time.plot(rows["brake"], rows["median time"], mark + "-", color=color)
        made += [line, other]
    for ax in axes:
        ax.set(xscale="log", xlabel="braking power [m/s²]")
        ax.set_xticks(sorted(table["brake"].unique()), [f"{b:g}" for b in sorted(table["brake"].unique())])
        ax.minorticks_off()
    rate.set(ylim=(0.0, 1.02), ylabel="share that reaches the goal")
    time.set(ylim=(0.0, None), ylabel="median time [s]")
    rate.legend(loc="lower right")
    return made
