"""The objective of the Improved Dynamic Window Approach: four terms, one sum.

They work on arrays of samples `(n, 2)` of v [m/s] and omega [rad/s]. The clearances are those at the end of each
predicted arc, as the thesis prints it (errata T35 shows what that costs).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.dwa.steps import distance_score, heading_score, normalise, speed_score
from fuzzynav.geometry import Array

__all__ = ["DELTA", "WEIGHTS", "checked_weights", "clearances_at", "improved_objective", "terms"]

DELTA = 0.2  # weight of the clearance from what moves; ours, the thesis prints none (errata T39)
WEIGHTS = (0.05, 0.2, 0.3, DELTA)  # alpha, beta, gamma of table 4.1, and delta


def terms(
    pose: ArrayLike,
    samples: ArrayLike,
    target: ArrayLike,
    clearances: tuple[ArrayLike, ArrayLike],
    sim_time: float,
    d_max: float,
) -> Array:
    """The four terms `(n, 4)`: PHead [deg], dist_s [m], vel [m/s], dist_d [m].

    PHead is 180 minus the angle between the heading at the end of the arc, after `sim_time` [s], and the direction to
    the current sub-goal `target`: printed is the angle itself, which a G that is maximised must not reward (errata
    T39). clearances: from what stands and from what moves, each `(n,)` [m]; both are cut at d_max [m].
    """
    static, dynamic = clearances
    columns = (
        heading_score(pose, samples, target, sim_time),
        distance_score(static, d_max),
        speed_score(samples),
        distance_score(dynamic, d_max),
    )
    return np.column_stack(columns)


def clearances_at(ends: Array, points: Array, radius: float) -> Array:
    """Clearance `(n,)` [m] of a disc at each of the ends `(n, 2)` from the nearest of the points `(m, 2)`."""
    if not len(points):
        return np.full(len(ends), np.inf)
    dx, dy = ends[:, :1] - points[:, 0], ends[:, 1:2] - points[:, 1]
    return np.asarray(np.maximum(np.sqrt((dx * dx + dy * dy).min(axis=1)) - radius, 0.0))


def improved_objective(found: ArrayLike, weights: ArrayLike = WEIGHTS) -> Array:
    """G of each candidate `(n,)`: each of its four terms as a share of all candidates' (sigma), weighted and added.

    Source: thesis eq 4.15 (errata T39).

    >>> improved_objective([[180.0, 2.0, 0.5, 1.0], [90.0, 2.0, 0.5, 1.0]], [1.0, 0.0, 0.0, 0.0]).round(3).tolist()
    [0.667, 0.333]
    """
    return np.asarray(normalise(found) @ checked_weights(weights))


def checked_weights(weights: ArrayLike) -> Array:
    """Four weights alpha, beta, gamma, delta; raises ValueError where one is negative, or all are zero."""
    w = np.asarray(weights, dtype=float)
    if w.shape != (4,) or not np.isfinite(w).all() or w.min() < 0 or not w.sum() > 0:
        raise ValueError(f"weights must be four finite numbers, none negative and not all zero, got {w.tolist()}")
    return w
