"""The planners of thesis 3 and 4 on 1000 seeded random maps for each density, and their times on our maps.

One row a map: cells searched, lengths [m] and times [us] of every planner, and the optimum of all. Times are the least
of five runs, search and node removal together; everything else is the same on every computer.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd

from fuzzynav import batch, smoothing
from fuzzynav.data import folder
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar, visibility
from fuzzynav.planning.astar import Options, SearchResult
from fuzzynav.smoothing import simplify
from fuzzynav.studies.planning.maps import SCENES_3, SCENES_4, Scene, efficient, enhanced, random_scene, traditional

__all__ = ["CASES", "DENSITIES", "compare_times", "one_map", "results", "times"]

RESULTS = folder("results")
DENSITIES = (0.1, 0.2, 0.3, 0.4)
MAPS = 1000
CASES = tuple(f"{density:.2f}-{seed:04d}" for density in DENSITIES for seed in range(MAPS))
_LOOSE = replace(astar.ENHANCED, corners="permissive", safety_radius=0.0)
SEARCHES: dict[str, Options] = {
    "dijkstra": replace(astar.DIJKSTRA, corners="permissive"),
    "traditional": astar.TRADITIONAL,
    "octile": replace(astar.OPTIMAL, corners="permissive"),
    "straight_g": replace(astar.TRADITIONAL, cost="straight line"),
    "manhattan": replace(astar.TRADITIONAL, heuristic="manhattan"),
    "efficient": astar.EFFICIENT,
    "efficient8": replace(astar.EFFICIENT, five_directions=False),
    "enhanced10": _LOOSE,
    "enhanced_e": replace(_LOOSE, log_base=math.e),
}


def one_map(case: str) -> dict[str, object]:
    """The row of one map, named like "0.20-0017": density and seed."""
    density, seed = float(case[:4]), int(case[5:])
    grid, start, goal = random_scene(seed, density)
    row: dict[str, object] = {"density": density}
    for name, options in SEARCHES.items():
        found = astar.search(grid, start, goal, options)
        row[f"{name}_searched"], row[f"{name}_length"] = found.searched, _tidy(found.length)
        if name == "efficient":
            row["efficient_fallback"] = int(found.fallback)
            row.update(_kept("efficient", grid, found, simplify.key_nodes, 0.0))
    ends = grid.center_of([start, goal])
    row["point_optimum"] = _tidy(visibility.shortest(grid, ends[0], ends[1], 0.0, "permissive").length)
    row.update(_safe(grid, start, goal))
    for name, work in _timed(grid, start, goal).items():
        row[f"{name}_us"] = round(1e6 * _least(work), 1)
    return row


def _tidy(length: float) -> float:
    return round(float(length), 4)


def _kept(
    name: str, grid: GridMap, found: SearchResult, rule: Callable[..., np.ndarray], radius: float
) -> dict[str, object]:
    """Raw nodes, kept nodes and their length; empty without a path."""
    if found.status != "reached":
        return {f"{name}_raw_nodes": 0, f"{name}_nodes": 0, f"{name}_kept_length": float("nan")}
    nodes = rule(found.cells, grid, radius)
    return {
        f"{name}_raw_nodes": len(found.cells),
        f"{name}_nodes": len(nodes),
        f"{name}_kept_length": _tidy(astar.path_length(nodes)),
    }


def _safe(grid: GridMap, start: tuple[int, int], goal: tuple[int, int]) -> dict[str, object]:
    """Thesis 4 with strict corners and 0.5 m of clearance: traditional, enhanced, optimum, plain spline."""
    strict = astar.search(grid, start, goal, replace(astar.TRADITIONAL, corners="strict"))
    found = astar.search(grid, start, goal, astar.ENHANCED)
    row: dict[str, object] = {
        "strict_searched": strict.searched,
        "strict_length": _tidy(strict.length),
        "safe_searched": found.searched,
        "safe_length": _tidy(found.length),
        **_kept("safe", grid, found, simplify.prune, 0.5),
    }
    ends = grid.center_of([start, goal])
    row["safe_optimum"] = _tidy(visibility.shortest(grid, ends[0], ends[1], 0.5).length)
    row["spline_clearance"] = float("nan")
    if found.status == "reached":
        points = grid.center_of(simplify.prune(found.cells, grid, 0.5))
        if len(points) >= 4:
            row["spline_clearance"] = round(smoothing.least_clearance(smoothing.bspline(points).points(500), grid), 3)
    return row


def _timed(grid: GridMap, start: tuple[int, int], goal: tuple[int, int]) -> dict[str, Callable[[], object]]:
    """The planners as a user calls them: search, then node removal where the method has it."""

    def removal(options: Options, rule: Callable[..., np.ndarray], radius: float) -> Callable[[], object]:
        return lambda: rule(astar.search(grid, start, goal, options).cells, grid, radius)

    return {
        "traditional": lambda: astar.search(grid, start, goal, astar.TRADITIONAL),
        "efficient_search": lambda: astar.search(grid, start, goal, astar.EFFICIENT),
        "efficient": removal(astar.EFFICIENT, simplify.key_nodes, 0.0),
        "enhanced": removal(astar.ENHANCED, simplify.prune, 0.5),
    }


def _least(work: Callable[[], object], runs: int = 5) -> float:
    spent = []
    for _ in range(runs):
        began = time.perf_counter()
        work()
        spent.append(time.perf_counter() - began)
    return min(spent)


def results() -> pd.DataFrame:
    """The stored study, one row a map. Raises FileNotFoundError if it has not been run."""
    return batch.read(RESULTS / "astar_random_maps.csv")


def times(name: str) -> dict[str, float]:
    """Times [us] on one of our maps: the median of 400 runs of each planner, in turns."""
    scene: Scene = {**SCENES_3, **SCENES_4}[name]
    better = efficient if name in SCENES_3 else enhanced
    radius = 0.0 if name in SCENES_3 else scene.safety_radius
    options = (
        replace(astar.EFFICIENT, corners=scene.traditional.corners)
        if name in SCENES_3
        else replace(astar.ENHANCED, safety_radius=radius)
    )
    plans: dict[str, Callable[[], object]] = {
        "traditional_us": lambda: traditional(scene),
        "better_us": lambda: better(scene),
        "better_search_us": lambda: astar.search(scene.grid, scene.start, scene.goal, options),
    }
    spent: dict[str, list[float]] = {key: [] for key in plans}
    for _ in range(400):
        for key, work in plans.items():
            began = time.perf_counter()
            work()
            spent[key].append(1e6 * (time.perf_counter() - began))
    return {key: round(float(np.median(values)), 1) for key, values in spent.items()}


def compare_times(name: str, column: str = "better_us") -> float:
    """Change of the planning time from the traditional to the better planner [%], from the stored times.

    column: "better_us" counts the removal of nodes, "better_search_us" does not.
    """
    table = batch.read(RESULTS / "astar_times.csv").set_index("case")
    return float(100.0 * (table.loc[name, column] / table.loc[name, "traditional_us"] - 1.0))
