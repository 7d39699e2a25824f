"""Artificial potential fields: a goal that attracts, obstacles that repel, and the force of both.

Source: Fuzzy-APF eq 1 to 5, 8 and 9, in their corrected form (errata A1 to A5); Khatib 1986.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.checks import finite, not_negative, positive
from fuzzynav.geometry import Array
from fuzzynav.potential import kernels
from fuzzynav.potential.obstacles import checked

__all__ = ["CLASSICAL", "IMPROVED", "Gains", "force", "potential", "printed_force", "record"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Gains:
    """Gains of a potential field; the values of Fuzzy-APF table 2.

    Raises ValueError for gains below 0 and lengths that are not positive.
    """

    attract: float = 2.0  # eta of eq 1
    conic: float = float("inf")  # [m] beyond it the attraction grows no more
    repel: float = 20.0  # k of eq 3
    influence: float = 5.0  # [m] rho_0: obstacles further away do not repel
    exponent: float = 0.0  # n of eq 8; 0: no distance factor

    def __post_init__(self) -> None:
        not_negative(attract=self.attract, repel=self.repel, exponent=self.exponent)
        positive(influence=self.influence)
        if not self.conic > 0:
            raise ValueError(f"conic must be a positive distance or inf, got {self.conic}")


CLASSICAL = Gains()
IMPROVED = Gains(exponent=10.0)  # the exponent that Fuzzy-APF section 4.1 chooses


@lru_cache(maxsize=256)
def record(gains: Gains, printed: bool = False) -> Array:
    """The gains as the kernels take them; `printed`: the force as eq 4 and 9 print it."""
    values = (gains.attract, gains.conic, gains.repel, gains.influence, gains.exponent, printed)
    return np.array([values], dtype=kernels.GAINS)


def potential(points: ArrayLike, goal: ArrayLike, obstacles: ArrayLike, gains: Gains, radius: float = 0.0) -> Array:
    """Potential `(...)` of a disc of `radius` [m] at points `(..., 2)` [m].

    U = eta d^2/2 + sum of k(d) (1/rho - 1/rho_0)^2/2 over the obstacles nearer than rho_0, with d the distance to the
    goal, rho the gap to the obstacle, and k(d) = k (d/(d + 1))^n. Raises ValueError for rows of the wrong shape.

    Source: Fuzzy-APF eq 1, 3 and 8.

    >>> float(potential([3.0, 4.0], [0.0, 0.0], [], CLASSICAL))
    25.0
    """
    return _evaluated(points, goal, obstacles, gains, radius, printed=False)[1]


def force(points: ArrayLike, goal: ArrayLike, obstacles: ArrayLike, gains: Gains, radius: float = 0.0) -> Array:
    """Force `(..., 2)` on a disc of `radius` [m] at points `(..., 2)` [m]: minus the gradient of `potential`.

    Each obstacle gives k(d) (1/rho - 1/rho_0)/rho^2 away from it, and (1/rho - 1/rho_0)^2/2 dk/dd towards the goal: as
    the distance factor falls towards the goal, so does the potential. The print has neither 1/rho^2 nor the second
    term (errata A4, A5). Raises ValueError for rows of the wrong shape.

    Source: Fuzzy-APF eq 2, 4, 5 and 9, corrected.

    >>> force([3.0, 4.0], [0.0, 0.0], [], CLASSICAL).tolist()
    [-6.0, -8.0]
    """
    return _evaluated(points, goal, obstacles, gains, radius, printed=False)[0]


def printed_force(points: ArrayLike, goal: ArrayLike, obstacles: ArrayLike, gains: Gains, radius: float = 0.0) -> Array:
    """The force as Fuzzy-APF eq 4 and 9 print it: k(d) (1/rho - 1/rho_0) away from each obstacle; no gradient."""
    return _evaluated(points, goal, obstacles, gains, radius, printed=True)[0]


def _evaluated(
    points: ArrayLike, goal: ArrayLike, obstacles: ArrayLike, gains: Gains, radius: float, *, printed: bool
) -> tuple[Array, Array]:
    places = np.asarray(points, dtype=float)
    if places.ndim < 1 or places.shape[-1] != 2:
        raise ValueError(f"points need x and y in their last axis, got shape {places.shape}")
    target = finite(np.asarray(goal, dtype=float), "the goal", 2)
    not_negative(radius=radius)
    rows = np.ascontiguousarray(places.reshape(-1, 2))
    found, energy = kernels.forces(rows, target, checked(obstacles), float(radius), record(gains, printed))
    return found.reshape(places.shape), energy.reshape(places.shape[:-1])
