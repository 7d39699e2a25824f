"""Fuzzy-APF tables 3 and 4: iterations over the exponent of the distance factor.

The paper prints neither the obstacles of its two environments, nor the tolerance at the goal. Its counts can only come
from steps on each axis (eq 6 as printed, errata A6 and A7). Ours are point obstacles that were sought until the counts
came near; beside them stand the counts of layouts that nobody sought.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fuzzynav.geometry import Array
from fuzzynav.potential import Gains, Steps, discs, walk
from fuzzynav.studies.study import Study

__all__ = ["EXPONENTS", "LAYOUTS", "LAYOUT_STUDY", "SOUGHT", "START_GOAL", "counts", "one_layout", "random_layout"]

EXPONENTS = tuple(range(1, 15))
ALL = (0, *EXPONENTS)  # 0: without the distance factor
START_GOAL = ((0.0, 0.0), (8.0, 8.0))  # [m] table 2
LAYOUTS = 500
# places [m] and tolerance [m] that were sought until the counts of a table came near
SOUGHT: Mapping[str, tuple[tuple[tuple[float, float], ...], float]] = {
    "3": (((1.51, 1.93), (7.19, 5.64)), 0.4),
    "4": (((4.13, 4.31), (3.57, 3.25), (3.56, 6.1), (2.99, 7.25), (3.85, 4.81)), 0.1),
    "5-e1": (((3.0, 3.46), (4.75, 5.93)), 0.4),
    "5-e2": (((0.87, 1.43), (5.09, 4.48), (5.64, 4.29), (1.44, 1.24)), 0.4),
}


def counts(points: Array, tolerance: float, exponents: Sequence[float] = EXPONENTS) -> Array:
    """Iterations for each exponent past points `(n, 2)` [m], all as printed; nan where the walk does not arrive."""
    steps, rows = Steps(axes=True, tolerance=tolerance), discs(points)
    walks = [walk(*START_GOAL, rows, Gains(exponent=n), steps, printed=True) for n in exponents]
    return np.array([made.iterations if made.status == "reached" else np.nan for made in walks])


def random_layout(seed: int) -> tuple[Array, float]:
    """Two to six points, 1.5 m from start and goal at least, and a tolerance of 0.1 to 0.5 m."""
    rng = np.random.default_rng([3, seed])
    points = np.empty((0, 2))
    wanted = int(rng.integers(2, 7))
    while len(points) < wanted:
        place = rng.uniform(0.5, 7.5, 2)
        if min(np.hypot(*(place - end)) for end in np.array(START_GOAL)) > 1.5:
            points = np.vstack([points, place])
    return points, float(rng.uniform(0.1, 0.5))


def one_layout(seed: int | str) -> dict[str, Any]:
    """The counts of a layout that nobody sought."""
    points, tolerance = random_layout(int(seed))
    found = counts(points, tolerance, ALL)
    return {"points": len(points), "tolerance": round(tolerance, 6)} | {
        f"n{n}": float(count) for n, count in zip(ALL, found, strict=True)
    }


LAYOUT_STUDY = Study(
    name="apf_layouts", experiment=one_layout, cases=range(LAYOUTS), parameters={"points": "2 to 6", "step [m]": 0.01}
)
