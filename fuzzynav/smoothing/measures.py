"""What a path costs: its length, its turning, its sharpest bend, and how near it comes to an obstacle."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array, cumulative_length, curvature, resample
from fuzzynav.maps.gridmap import GridMap

__all__ = ["SPACING", "arc_length", "is_free", "least_clearance", "measure", "total_turning"]

SPACING = 0.02  # [m] between the samples at which a curve is checked against a map
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)
_SETTLED = 1e-12  # of the whole length: what halving an interval may still change
_HALVINGS = 50


def arc_length(velocity: Callable[[Array], Array], breaks: ArrayLike) -> float:
    """Length [m] of a curve from its derivative `(..., 2)` by the parameter, smooth between `breaks` `(n,)`.

    Gauss-Legendre quadrature with 20 nodes, each interval halved until that changes nothing, so that the result is
    right to 1e-10 of the length also where the speed nearly vanishes.

    >>> arc_length(lambda t: np.stack([-np.sin(t), np.cos(t)], axis=-1), [0.0, np.pi]).__round__(12)
    3.14159265359
    """
    b = np.asarray(breaks, dtype=float)
    low, high, total = b[:-1], b[1:], 0.0
    coarse = _pieces(velocity, low, high)
    whole = float(coarse.sum())
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        fine = np.stack([_pieces(velocity, low, middle), _pieces(velocity, middle, high)])
        rough = np.abs(fine.sum(axis=0) - coarse) > _SETTLED * whole
        total += float(fine[:, ~rough].sum())
        low, high = np.concatenate([low[rough], middle[rough]]), np.concatenate([middle[rough], high[rough]])
        coarse = fine[:, rough].ravel()
        if not len(low):
            break
    return total + float(coarse.sum())


def _pieces(velocity: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """Length of each interval `(n,)`, by one rule."""
    half = (high - low) / 2.0
    d = velocity(low[:, None] + half[:, None] * (1.0 + _NODES))
    pieces: Array = (np.hypot(d[..., 0], d[..., 1]) * _WEIGHTS).sum(axis=-1) * half
    return pieces


def is_free(points: ArrayLike, grid: GridMap, radius: float = 0.0) -> bool:
    """Whether a disc of radius [m] moves along the polyline `(n, 2)` [m] without overlapping an occupied square."""
    p = np.asarray(points, dtype=float)
    return all(grid.clear_line(a, b, radius, "permissive") for a, b in pairwise(p))


def least_clearance(points: ArrayLike, grid: GridMap, spacing: float = SPACING) -> float:
    """Smallest distance [m] from the polyline `(n, 2)` [m] to an occupied square, sampled every `spacing` [m].

    The true value is at most half a spacing smaller; the map's edge counts as occupied.
    """
    return float(grid.distance(resample(points, spacing)).min())


def total_turning(points: ArrayLike) -> float:
    """Sum of the absolute turns [rad] of a polyline `(n, 2)`: 0 for a straight one, 2 pi once round a circle."""
    d = np.diff(np.asarray(points, dtype=float)[:, :2], axis=0)
    d = d[np.hypot(d[:, 0], d[:, 1]) > 0.0]
    cross = d[:-1, 0] * d[1:, 1] - d[:-1, 1] * d[1:, 0]
    return float(np.abs(np.arctan2(cross, (d[:-1] * d[1:]).sum(axis=1))).sum())


def measure(points: ArrayLike, grid: GridMap) -> dict[str, float]:
    """Length [m], total turning [rad], sharpest curvature [1/m] and rate [1/m^2] by differences, least clearance [m].

    The curve `(n, 2)` is sampled finely and evenly by the caller; a polyline's corner has no finite curvature, its
    value grows as the samples come closer.
    """
    p = np.asarray(points, dtype=float)[:, :2]
    s = cumulative_length(p)
    first = np.gradient(p, s, axis=0, edge_order=2)
    second = np.gradient(first, s, axis=0, edge_order=2)
    bend = curvature(first, second)
    return {
        "length": float(s[-1]),
        "turning": total_turning(p),
        "curvature": float(np.abs(bend).max()),
        "curvature_rate": float(np.abs(np.gradient(bend, s)).max()),
        "clearance": least_clearance(p, grid),
    }
