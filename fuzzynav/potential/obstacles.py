"""Obstacles of a potential field as rows x1, y1, x2, y2, radius: points, discs and walls in one array."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array

__all__ = ["checked", "discs", "walls"]


def discs(rows: ArrayLike) -> Array:
    """Obstacles `(n, 5)` from rows x, y [m], of points, or x, y, radius [m].

    >>> discs([[1.0, 2.0]]).tolist()
    [[1.0, 2.0, 1.0, 2.0, 0.0]]
    """
    found = np.asarray(rows, dtype=float)
    found = found.reshape(-1, 2) if found.size == 0 else np.atleast_2d(found)
    radii = found[:, 2:] if found.shape[1] == 3 else np.zeros((len(found), 1))
    return checked(np.hstack([found[:, :2], found[:, :2], radii]))


def walls(points: ArrayLike, radius: float = 0.0) -> Array:
    """Obstacles `(n - 1, 5)`: walls from each of the points `(n, 2)` [m] to the next, 2 `radius` [m] thick.

    >>> walls([[0, 0], [1, 0], [1, 1]]).shape
    (2, 5)
    """
    line = np.asarray(points, dtype=float)
    if line.ndim != 2 or line.shape[1] != 2 or len(line) < 2:
        raise ValueError(f"a wall needs two points (x, y) or more, got an array of shape {line.shape}")
    return checked(np.hstack([line[:-1], line[1:], np.full((len(line) - 1, 1), float(radius))]))


def checked(obstacles: ArrayLike) -> Array:
    """Obstacles as the kernels take them `(n, 5)`.

    Raises ValueError for another shape, numbers that are not finite, or a radius below 0.
    """
    rows = np.ascontiguousarray(obstacles, dtype=float)
    rows = rows.reshape(0, 5) if rows.size == 0 else rows
    if rows.ndim != 2 or rows.shape[1] != 5:
        raise ValueError(f"obstacles are rows x1, y1, x2, y2, radius (see discs and walls), got shape {rows.shape}")
    if not np.isfinite(rows).all() or (rows[:, 4] < 0).any():
        raise ValueError("obstacles need finite places and radii of 0 m or more")
    return rows
