"""Thesis 4, global planning: the printed numbers of Table 4.2 and of eq 4.4, measured.

What concerns the dynamic window and the fusion of both planners stands in modules of their own.
"""

from __future__ import annotations

from functools import cache, partial

import numpy as np

from fuzzynav import smoothing
from fuzzynav.planning import heuristics
from fuzzynav.studies.planning import maps
from fuzzynav.studies.planning.claims import is_safe, smooth_is_continuous
from fuzzynav.studies.planning.maps import SCENES_4, Planned
from fuzzynav.studies.reproduction import Reproduction

__all__ = ["REPRODUCTIONS", "STAIRCASE", "grid_bound", "length_reduction", "plan"]

STAIRCASE = float(np.sqrt(4.0 - 2.0 * np.sqrt(2.0)))  # longest grid staircase along a straight line of length 1: 1.0824


@cache
def plan(scene: str, planner: str) -> Planned:
    """The answer of "TA" (traditional) or "EA" (enhanced) in a scene of astar_maps.SCENES_4."""
    return {"TA": maps.traditional, "EA": maps.enhanced}[planner](SCENES_4[scene])


def _length(scene: str, planner: str) -> float:
    return plan(scene, planner).length


def length_reduction(scene: str) -> float:
    """How much shorter the enhanced path is than the traditional one [%]."""
    before, after = plan(scene, "TA").length, plan(scene, "EA").length
    return 100.0 * (before - after) / before


def grid_bound(length: float) -> float:
    """Longest the optimal grid path can be if a path of `length` [m] keeps half a cell of clearance.

    >>> round(grid_bound(23.18), 2)
    25.09
    """
    return STAIRCASE * length


def _grade(scene: str, planner: str, name: str) -> str:
    given, found = SCENES_4[scene], plan(scene, planner)
    good = is_safe(given, found) if name == "safe" else smooth_is_continuous(given, found, planner == "EA")
    return "High" if good else "Low"


def _ends() -> str:
    """Start and goal of all scenes, in the thesis' count, if they are one pair."""
    pairs = {(scene.start, scene.goal) for scene in SCENES_4.values()}
    (sx, sy), (gx, gy) = pairs.pop()
    return f"({sx + 1},{sy + 1}) -> ({gx + 1},{gy + 1})" if not pairs else "several"


def _factor_tends_to_one() -> bool:
    """Whether H'/H of eq 4.4 comes near 1 at the goal."""
    near = [0.001, 0.0]
    return bool(abs(heuristics.enhanced(near, [15.0, 16.0]) / heuristics.euclidean(near) - 1.0) < 0.1)


def _basis_sums_to_one() -> bool:
    return bool(np.allclose(smoothing.cubic_basis(np.linspace(0.0, 1.0, 101)).sum(axis=-1), 1.0, atol=1e-12))


_OURS = "raster (data/maps/README.md), base 10, corner rule and safety radius: fitted to this table"
_BOUND = (
    "23.18 m with half a cell of clearance can be walked on the grid in at most 1.0824 x 23.18 = 25.09 m, less "
    "than 25.14 m; the two rows exclude each other unless the enhanced path touches corners, as on our map 1"
)
_METRIC = (
    "the metric, which the thesis does not define: smooth is a line without a jump of heading, safe keeps 0.3 m "
    "of clearance; and the raster"
)

REPRODUCTIONS: tuple[Reproduction, ...] = (
    *(
        Reproduction(
            claim=f"thesis:c-4.2-{scene}-{planner}-len",
            ours=_OURS,
            tolerance=0.005,
            measure=partial(_length, scene, planner),
            because="rounding of two decimals" + (f"; {_BOUND}" if scene == "M1" else ""),
        )
        for scene in ("M1", "M2")
        for planner in ("TA", "EA")
    ),
    *(
        Reproduction(
            claim=f"thesis:c-4.2-{scene}-{planner}-time", verdict="not testable", because="seconds of another computer"
        )
        for scene in ("M1", "M2")
        for planner in ("TA", "EA")
    ),
    *(
        Reproduction(
            claim=f"thesis:c-4.2-{scene}-{planner}-smooth",
            ours=_METRIC,
            measure=partial(_grade, scene, planner, "smooth"),
        )
        for scene in ("M1", "M2")
        for planner in ("TA", "EA")
    ),
    *(
        Reproduction(
            claim=f"thesis:c-4.2-{scene}-{planner}-safe",
            ours=_METRIC,
            because=because,
            measure=partial(_grade, shown, planner, "safe"),
        )
        for scene, shown, planner, because in (
            ("M1", "M1", "TA", "no corner is cut, so the grid path keeps half a cell; else it is Low"),
            ("M1", "M1", "EA", "the printed length leaves no clearance on an optimal map (see the lengths)"),
            ("M2", "M2 cut", "TA", "on the map where the traditional search may cut corners; else it is High"),
            ("M2", "M2 cut", "EA", "safety radius 0.5 m"),
        )
    ),
    Reproduction(
        claim="thesis:c-4.2-pct-1",
        measure=partial(length_reduction, "M1"),
        tolerance=0.05,
        ours=_OURS,
        because="one decimal",
    ),
    Reproduction(
        claim="thesis:c-4.2-pct-2",
        measure=partial(length_reduction, "M2"),
        tolerance=0.05,
        ours=_OURS,
        because="one decimal",
    ),
    Reproduction(
        claim="thesis:c-4.2-eff",
        verdict="contradicts itself",
        because="the table's own times rise: 0.0064 to 0.0208 s (x 3.25) and 0.0033 to 0.0118 s (x 3.58); 7.8 % and "
        "3.9 % are length reductions (T24)",
    ),
    Reproduction(claim="thesis:c-4.4-startgoal", measure=_ends),
    Reproduction(
        claim="thesis:c-formula-5",
        measure=_factor_tends_to_one,
        because="(1 + H/D) tends to 1 but lg(H + 1) to 0: the factor is 2.72 at the start, 0.31 at H = 1 m, 0 at the "
        "goal (T17)",
    ),
    Reproduction(claim="thesis:c-formula-9", measure=_basis_sums_to_one),
)
