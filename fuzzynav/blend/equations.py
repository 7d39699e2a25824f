"""The printed equations of the blend: the turn of avoidance, the weighted command, and the hard switch."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array

__all__ = ["avoidance_yaw_rate", "hybrid", "mixed", "safety_switch"]


def avoidance_yaw_rate(bearing: ArrayLike, turn: float = 1.0) -> Array:
    """Yaw rate of avoidance: +turn [rad/s] for an obstacle ahead or on the right (bearing <= 0), else -turn.

    Source: thesis eq 5.5.

    >>> avoidance_yaw_rate([-0.3, 0.0, 0.3]).tolist()
    [1.0, 1.0, -1.0]
    """
    return np.where(np.asarray(bearing, dtype=float) <= 0.0, turn, -turn)


def mixed(track: ArrayLike, avoid: ArrayLike, weight: ArrayLike) -> Array:
    """Command (1 - F) track + F avoid, `(..., 2)` as v [m/s], omega [rad/s].

    Source: thesis eq 5.6. Raises ValueError unless every weight lies in 0 to 1.

    >>> mixed([0.2, 0.1], [0.0, 1.0], 0.5).tolist()
    [0.1, 0.55]
    """
    f = np.asarray(weight, dtype=float)
    if not ((f >= 0.0) & (f <= 1.0)).all():
        raise ValueError(f"the weight F must lie in 0 to 1, got {f.tolist()}")
    first, second = np.asarray(track, dtype=float), np.asarray(avoid, dtype=float)
    return np.asarray((1.0 - f)[..., None] * first + f[..., None] * second)


def safety_switch(distance: ArrayLike, safe_distance: float) -> Array:
    """S = 1.0 where the nearest obstacle is nearer than safe_distance [m], else 0.0.   Source: thesis eq 2.50."""
    return (np.asarray(distance, dtype=float) < safe_distance).astype(float)


def hybrid(track: ArrayLike, fuzzy: ArrayLike, switch: ArrayLike) -> Array:
    """Command (1 - S) track + S fuzzy for S of 0 or 1: the hard switch, applied to v and omega.

    Source: thesis eq 2.51 (errata T52: printed for accelerations and velocities together, which cannot be added).
    """
    s = np.asarray(switch, dtype=float)
    if not np.isin(s, (0.0, 1.0)).all():
        raise ValueError(f"the switch S must be 0 or 1, got {s.tolist()}")
    return mixed(track, fuzzy, s)
