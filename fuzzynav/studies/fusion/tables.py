"""What the studies of chapter 07 say: tables of endings, from the stored results."""

from __future__ import annotations

import numpy as np
import pandas as pd

from fuzzynav import batch
from fuzzynav.data import folder
from fuzzynav.fusion.protocol import summary

__all__ = ["braking", "comparison", "endings", "ingredients", "step_times", "stored"]

RESULTS = folder("results")
TOLD = {"yield": "movers told", "yield scans": "from scans", "blind": "movers told, that yield to nobody"}


def stored(name: str) -> pd.DataFrame:
    """The rows of a study; raises FileNotFoundError where it has not been run."""
    return batch.read(RESULTS / f"{name}.csv")


def comparison(robot: str) -> pd.DataFrame:
    """One row for each planner with this robot: scenes, endings with Wilson intervals, medians among the reached."""
    table = pd.concat([stored("fusion_rivals"), stored("fusion_scenes")])
    chosen = table[table["robot"] == robot]
    ours = chosen["planner"] == "ours"
    named = chosen["planner"].where(~ours, "ours, " + chosen["movers"].map(TOLD))
    return endings(chosen.assign(method=named), "method")


def ingredients() -> pd.DataFrame:
    """One row for each ingredient that was left out, and two for the whole: movers told, and from scans."""
    table = stored("fusion_ingredients")
    named = table["planner"].where(table["movers"] == "yield", table["planner"] + ", from scans")
    return endings(table.assign(method=named), "method")


def braking() -> pd.DataFrame:
    """One row for each braking power [m/s^2] and kind of movers, `brake` and `movers` as columns."""
    table = stored("fusion_braking")
    found = endings(table.assign(method=table["movers"] + "/" + table["planner"].astype(str)), "method")
    parts = found["method"].str.split("/", expand=True)
    return found.assign(movers=parts[0], brake=parts[1].astype(float))


def endings(table: pd.DataFrame, by: str) -> pd.DataFrame:
    """The protocol's summary, with the driven length over the optimum."""
    blank = table.assign(ratio=table["length"] / table["optimum"], step_median_ms=np.nan, step_p99_ms=np.nan)
    found = summary(blank, by)
    return found.drop(columns=[name for name in found if "step_" in name])


def step_times() -> pd.DataFrame:
    """Median and 99th percentile [ms] of one step, for each planner the median over its scenes."""
    table = stored("fusion_times")
    named = table["planner"].where(table["movers"] == "yield", table["planner"] + ", from scans")
    columns = ["step_median_ms", "step_p99_ms"]
    return table.assign(method=named).groupby("method", sort=False)[columns].median().reset_index()
