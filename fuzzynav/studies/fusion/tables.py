"""What the studies of chapter 07 say: tables of endings, from the stored results."""

from __future__ import annotations

import numpy as np
import pandas as pd

from fuzzynav import batch
from fuzzynav.batch import proportion
from fuzzynav.data import folder
from fuzzynav.fusion import barn
from fuzzynav.fusion.protocol import TIMED, summary
from fuzzynav.studies.fusion.worlds import CLASSES

__all__ = ["barn_worlds", "braking", "comparison", "dynabarn_worlds", "endings", "ingredients", "step_times", "stored"]

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
    """One row for movers that yield, or do not, and each braking power `brake` [m/s^2] of the TurtleBot2."""
    table = stored("fusion_braking")
    named = table.assign(
        brake=table["planner"].astype(float), method=table["movers"] + " " + table["planner"].astype(str)
    )
    kinds = named.drop_duplicates("method").set_index("method")[["movers", "brake"]]
    return endings(named, "method").join(kinds, on="method")


def step_times() -> pd.DataFrame:
    """Median and 99th percentile [ms] of a step of each planner, medians of ten scenes, on the machine of the study."""
    table = stored("fusion_times")
    named = table["planner"].where(table["movers"] == "yield", table["planner"] + ", from scans")
    return table.assign(method=named).groupby("method", sort=False)[list(TIMED)].median().reset_index()


def barn_worlds() -> pd.DataFrame:
    """One row for each planner and top speed on BARN's 50 test worlds, with the mean score.

    Above them move_base's DWA, as its ten published runs a world say.
    """
    table = stored("barn_planners")
    theirs = barn.outcome(barn.published_runs(folder("benchmarks")))
    first = {"planner": "move_base DWA, published", "speed": 2.0, "runs": 500, "reached rate": theirs["success"]}
    first |= {"hit rate": theirs["contact"], "late rate": theirs["late"], "score": theirs["metric"]}
    rows = [first]
    for (speed, planner), group in table.groupby(["speed", "planner"], sort=False):
        (row,) = _blank(group.assign(ratio=np.nan), "planner").to_dict("records")
        rows.append({**row, "planner": planner, "speed": speed, "score": group["score"].mean()})
    return pd.DataFrame(rows)


def dynabarn_worlds(part: str = "held-out") -> pd.DataFrame:
    """One row for each planner, tracking and speed: the share that reaches the goal in easy, medium and hard worlds.

    part: "held-out", the even worlds, or "all", for planners that were driven in all of them.
    """
    table = pd.concat([stored("dynabarn_planners"), stored("dynabarn_guests")])
    if part == "held-out":
        table = table[table["world"] % 2 == 0]
    rows = []
    for (speed, tracking, planner), group in table.groupby(["speed", "tracking", "planner"], sort=False):
        row = {"planner": planner, "tracking": tracking, "speed": speed, "runs": len(group)}
        for name in CLASSES:
            ends = group[group["class"] == name]["ending"]
            rate, low, high = proportion(int((ends == "reached").sum()), len(ends))
            row |= {name: rate, f"{name} low": low, f"{name} high": high}
        rows.append(row | {f"{end} rate": float((group["ending"] == end).mean()) for end in ("hit", "struck", "late")})
    made = pd.DataFrame(rows)
    return made if part == "held-out" else made[made["runs"] == made["runs"].max()]


def endings(table: pd.DataFrame, by: str) -> pd.DataFrame:
    """The protocol's summary, with the driven length over the optimum."""
    return _blank(table.assign(ratio=table["length"] / table["optimum"]), by)


def _blank(table: pd.DataFrame, by: str) -> pd.DataFrame:
    """The protocol's summary of rows that keep neither the clock nor all lengths."""
    lacking = {name: np.nan for name in ("length", *TIMED) if name not in table}
    found = summary(table.assign(**lacking), by)
    return found.drop(columns=[f"median {name}" for name in lacking])
