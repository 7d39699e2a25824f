"""Fuzzy against fixed weights, fairly: paired on seeded random maps, with the best fixed weights found by search.

A case is a text 'density/seed'. Seeds below 10000 are for the comparison; searches and tuning see other seeds only.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pandas as pd
from scipy import ndimage

from fuzzynav import batch
from fuzzynav.data import folder
from fuzzynav.dwa.decision import Field
from fuzzynav.dwa.fast import drive, shipped
from fuzzynav.dwa.steps import TABLE_3_3, TABLE_4_1, Params
from fuzzynav.fuzzy.compiled import Tables
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import THESIS
from fuzzynav.simulate.record import Run
from fuzzynav.world import World

__all__ = [
    "CASES",
    "DENSITIES",
    "GOAL",
    "MID_RANGE",
    "RESULTS",
    "START",
    "TIME_LIMIT",
    "TRAINING",
    "best_fixed",
    "compare",
    "compare_tuned",
    "comparison",
    "fixed_weights",
    "go",
    "mean_score",
    "methods",
    "penalised",
    "penalised_gain",
    "random_map",
    "score_weights",
]

RESULTS = folder("results")
DENSITIES = ("0.05", "0.10", "0.15")
CASES = tuple(f"{density}/{seed}" for density in DENSITIES for seed in range(500))
TRAINING = tuple(f"{density}/{seed}" for density in DENSITIES for seed in range(10000, 10025))
START, GOAL = (1.5, 1.5), (18.5, 18.5)  # centres of the corner cells but one, 20 x 20 cells of 1 m
TIME_LIMIT = 120.0  # [s]
MID_RANGE = (0.5, 0.5, 0.5)  # what MATLAB's evalfis answers where no rule fires


@cache
def _scene(case: str) -> tuple[World, Field]:
    grid = random_map(case)
    return World(grid=grid), Field.of(grid)


def random_map(case: str) -> GridMap:
    """A 20 x 20 map of 1 m cells, each blocked with the density; start and goal free and joined for the robot.

    Maps on which the disc cannot pass are drawn anew.
    """
    density, seed = case.split("/")
    rng = np.random.default_rng([round(float(density) * 1000), int(seed)])
    keep = np.zeros((20, 20), dtype=bool)
    for x, y in (START, GOAL):
        keep[int(y) - 1 : int(y) + 2, int(x) - 1 : int(x) + 2] = True
    while True:
        grid = GridMap((rng.random((20, 20)) < float(density)) & ~keep)
        if _joined(grid):
            return grid


def _joined(grid: GridMap) -> bool:
    """Whether a disc of the robot's size can pass from start to goal, judged on cells of 0.1 m."""
    field = Field.of(grid, 0.1)
    parts, _ = ndimage.label(field.values > THESIS.radius + 0.07)
    a, b = (parts[int(y * 10), int(x * 10)] for x, y in (START, GOAL))
    return bool(a == b and a > 0)


def methods() -> dict[str, tuple[Params, Tables | None]]:
    """The ways of weighting that are compared."""
    return {
        "printed .8 .1 .1": (TABLE_3_3, None),
        "equal": (Params(weights=(1 / 3, 1 / 3, 1 / 3)), None),
        "table 4.1 .05 .2 .3": (TABLE_4_1, None),
        "best fixed": (Params(weights=best_fixed()), None),
        "fuzzy 9, else printed": (TABLE_3_3, shipped("thesis_table_3_2")),
        "fuzzy 9, else mid-range": (Params(weights=MID_RANGE), shipped("thesis_table_3_2")),
        "fuzzy 27": (TABLE_3_3, shipped("thesis_table_3_2_completed")),
    }


def go(case: str, params: Params, rules: Tables | None) -> Run:
    """One run of one method on one map."""
    world, field = _scene(case)
    return drive(world, START, GOAL, params, field=field, rules=rules, t_max=TIME_LIMIT)


def compare(case: str) -> list[dict[str, Any]]:
    """One row for each way of scoring the distance (along the arc, at its end) and each method, on this case's map."""
    rows = [
        _row(case, name, replace(params, distance=scored), rules)
        for name, (params, rules) in methods().items()
        for scored in ("arc", "end")
    ]
    _scene.cache_clear()
    return rows


def compare_tuned(case: str) -> dict[str, Any]:
    """The row of the tuned rule base on this case's map."""
    row = _row(case, "fuzzy tuned", Params(weights=best_fixed()), shipped("ours_dwa_tuned"))
    _scene.cache_clear()
    return row


def _row(case: str, name: str, params: Params, rules: Tables | None) -> dict[str, Any]:
    """One run as a row."""
    made = go(case, params, rules)
    return {
        "density": case.split("/")[0],
        "scored": params.distance,
        "method": name,
        "success": int(made.status == "reached"),
        "status": made.status,
        "length": round(made.length, 3),
        "iterations": made.iterations,
        "clearance": round(made.min_clearance, 3),
        "uncovered": int(made.log["uncovered"].sum()),
        "time": round(penalised(made), 1),
    }


def penalised(made: Run) -> float:
    """Time to the goal [s]; a run that does not arrive counts twice the limit."""
    return made.iterations * made.dt if made.status == "reached" else 2.0 * TIME_LIMIT


# --- the best fixed weights -----------------------------------------------------------------------


def fixed_weights(step: float = 0.05) -> tuple[str, ...]:
    """All weights on a grid with sum 1, as texts 'alpha/beta/gamma': only their ratios matter."""
    n = round(1.0 / step)
    return tuple(f"{i / n:.3f}/{j / n:.3f}/{(n - i - j) / n:.3f}" for i in range(n + 1) for j in range(n + 1 - i))


def score_weights(case: str) -> dict[str, float]:
    """Mean penalised time [s] and successes of fixed weights over the training maps."""
    params = Params(weights=tuple(float(w) for w in case.split("/")))  # type: ignore[arg-type]
    return mean_score(params, None, TRAINING)


def mean_score(params: Params, rules: Tables | None, cases: tuple[str, ...]) -> dict[str, float]:
    """Mean penalised time [s] and share of successes over cases."""
    made = [go(case, params, rules) for case in cases]
    return {
        "time": round(float(np.mean([penalised(m) for m in made])), 3),
        "success": round(float(np.mean([m.status == "reached" for m in made])), 4),
    }


@cache
def best_fixed() -> tuple[float, float, float]:
    """The fixed weights of least mean penalised time on the training maps; FileNotFoundError before the search."""
    table: pd.DataFrame = batch.read(RESULTS / "dwa_fixed_search.csv")
    case = str(table.sort_values(["time", "case"])["case"].iloc[0])
    a, b, c = (float(w) for w in case.split("/"))
    return a, b, c


def comparison(scored: str = "arc") -> pd.DataFrame:
    """The stored comparison, for one way of scoring the distance; the base was tuned for the way along the arc."""
    names = ("dwa_comparison", "dwa_comparison_tuned")
    table = pd.concat([batch.read(RESULTS / f"{name}.csv") for name in names], ignore_index=True)
    return table[table["scored"] == scored].drop(columns="scored").astype({"density": float})


def penalised_gain(table: pd.DataFrame, first: str, second: str) -> tuple[float, float, float]:
    """Mean difference second - first of the penalised time [s] over all maps, with its 95 % bootstrap interval."""
    wide = table.pivot_table(index="case", columns="method", values="time")
    gap = (wide[second] - wide[first]).to_numpy(float)
    draws = gap[np.random.default_rng(0).integers(0, len(gap), (2000, len(gap)))].mean(axis=1)
    low, high = np.quantile(draws, [0.025, 0.975])
    return float(gap.mean()), float(low), float(high)
