"""What the studies of chapter 07 say: tables of endings, from the stored results."""

from __future__ import annotations

import numpy as np
import pandas as pd

from fuzzynav import batch
from fuzzynav.data import folder
from fuzzynav.fusion.protocol import summary

__all__ = ["comparison", "endings", "ingredients", "stored"]

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


def endings(table: pd.DataFrame, by: str) -> pd.DataFrame:
    """The protocol's summary, with the driven length over the optimum."""
    blank = table.assign(ratio=table["length"] / table["optimum"], step_median_ms=np.nan, step_p99_ms=np.nan)
    found = summary(blank, by)
    return found.drop(columns=[name for name in found if "step_" in name])
