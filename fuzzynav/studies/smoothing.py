"""Thesis 4, global planning: the printed numbers of Table 4.2 and of eq 4.4, measured.

What concerns the dynamic window and the fusion of both planners stands in modules of their own.
"""

from __future__ import annotations

from functools import cache, partial

import numpy as np
import pandas as pd

from fuzzynav import documents, smoothing
from fuzzynav.planning import heuristics
from fuzzynav.studies.planning import maps, random_maps
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


def _kept() -> pd.DataFrame:
    """The random maps on which the enhanced planner finds a path."""
    table = random_maps.results()
    return table[table["safe_length"].notna()]


def _untuned() -> str:
    """How much shorter the enhanced path is than the traditional one on random maps [%]."""
    rows = _kept()
    low, middle, high = (100.0 * (1.0 - rows["safe_kept_length"] / rows["strict_length"])).quantile([0.05, 0.5, 0.95])
    return (
        f"on {len(rows)} random maps, 0.5 m of clearance, length {middle:.1f} % less than the traditional one in the "
        f"median, {low:.1f} to {high:.1f} % for 90 %"
    )


def _splines() -> tuple[int, int]:
    """On how many random maps the plain spline keeps the 0.5 m."""
    clear = _kept()["spline_clearance"].dropna()
    return int((clear >= 0.499).sum()), len(clear)


def _given(scene: str) -> list[str]:
    """Our reconstructions of one printed map."""
    return [name for name in SCENES_4 if name.startswith(scene)]


def _readings(scene: str, planner: str) -> tuple[int, int]:
    printed = float(documents.claim(f"thesis:c-4.2-{scene}-{planner}-len").value)
    return sum(abs(_length(name, planner) - printed) <= 0.005 for name in _given(scene)), len(_given(scene))


def _safe_readings(scene: str, planner: str) -> tuple[int, int]:
    printed = documents.claim(f"thesis:c-4.2-{scene}-{planner}-safe").value
    return sum(_grade(name, planner, "safe") == printed for name in _given(scene)), len(_given(scene))


def _reductions(scene: str, printed: float) -> tuple[int, int]:
    return sum(abs(length_reduction(name) - printed) <= 0.05 for name in _given(scene)), len(_given(scene))


MAP_OF = {"M1": "M1", "M2": "M2 cut"}  # one map of ours for a whole row of the table
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
            free=_OURS,
            shows="fitted",
            tolerance=0.005,
            measure=partial(_length, MAP_OF[scene], planner),
            because="rounding of two decimals" + (f"; {_BOUND}" if scene == "M1" else ""),
            beside=_untuned if planner == "EA" else None,
            holds_for=partial(_readings, scene, planner),
        )
        for scene in MAP_OF
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
            free=_METRIC,
            shows="by definition",
            because="judged with the spline, which only the enhanced planner is given"
            if planner == "EA"
            else "corners of the raw path are jumps of heading",
            measure=partial(_grade, MAP_OF[scene], planner, "smooth"),
            holds_for="follows from the measure",
        )
        for scene in MAP_OF
        for planner in ("TA", "EA")
    ),
    *(
        Reproduction(
            claim=f"thesis:c-4.2-{scene}-{planner}-safe",
            free=_METRIC,
            shows="by definition",
            because=because,
            measure=partial(_grade, MAP_OF[scene], planner, "safe"),
            holds_for=partial(_safe_readings, scene, planner),
        )
        for scene, planner, because in (
            ("M1", "TA", "no corner is cut, so the grid path keeps half a cell; else it is Low"),
            ("M1", "EA", "the printed length leaves no clearance on an optimal map (see the lengths)"),
            ("M2", "TA", "on the map where the traditional search may cut corners; else it is High"),
            ("M2", "EA", "safety radius 0.5 m"),
        )
    ),
    Reproduction(
        claim="thesis:c-4.2-pct-1",
        measure=partial(length_reduction, MAP_OF["M1"]),
        tolerance=0.05,
        shows="fitted",
        free=_OURS,
        because="one decimal",
        beside=_untuned,
        holds_for=partial(_reductions, "M1", 7.8),
    ),
    Reproduction(
        claim="thesis:c-4.2-pct-2",
        measure=partial(length_reduction, MAP_OF["M2"]),
        tolerance=0.05,
        shows="fitted",
        free=_OURS,
        because="one decimal",
        beside=_untuned,
        holds_for=partial(_reductions, "M2", 3.9),
    ),
    Reproduction(
        claim="thesis:c-4.2-eff",
        verdict="contradicts itself",
        because="the table's own times rise: 0.0064 to 0.0208 s (x 3.25) and 0.0033 to 0.0118 s (x 3.58); 7.8 % and "
        "3.9 % are length reductions (T24)",
    ),
    Reproduction(
        claim="thesis:c-4.4-startgoal", measure=_ends, shows="input", because="start and goal of every map of ours"
    ),
    Reproduction(
        claim="thesis:c-formula-5",
        measure=_factor_tends_to_one,
        because="(1 + H/D) tends to 1 but lg(H + 1) to 0: the factor is 2.72 at the start, 0.31 at H = 1 m, 0 at the "
        "goal (T17)",
    ),
    Reproduction(claim="thesis:c-formula-9", measure=_basis_sums_to_one, because="at 101 parameters, to 1e-12"),
    Reproduction(
        claim="thesis:c-extra-10",
        measure=lambda: _splines()[0] == _splines()[1],
        free="random maps, safety radius 0.5 m, a spline on the kept nodes",
        because="safer, or as safe: the spline keeps the 0.5 m that its polyline keeps",
        holds_for=_splines,
    ),
)
