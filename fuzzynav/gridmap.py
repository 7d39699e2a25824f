"""The occupancy grid as a map: cells, points, inflation, distance, sight and ray casting."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.geometry import Array

__all__ = ["GridMap"]


@dataclass(frozen=True, slots=True, eq=False)
class GridMap:
    """A map of square cells. `occupied[row, col]` is bool; row 0 is the lowest y.

    resolution [m] is the side of a cell; origin [m] is the lower left corner of cell [0, 0].
    Cells are named `(n, 2)` integers x = column, y = row, counted from 0. What lies outside the
    map counts as occupied.
    """

    occupied: NDArray[np.bool_]
    resolution: float = 1.0
    origin: tuple[float, float] = (0.0, 0.0)

    def cell_of(self, points: ArrayLike) -> NDArray[np.int64]:
        """Cells `(..., 2)` x, y that hold the points `(..., 2)` [m]; may lie outside the map."""
        return np.floor((np.asarray(points, dtype=float) - self.origin) / self.resolution).astype(np.int64)

    def center_of(self, cells: ArrayLike) -> Array:
        """Centres `(..., 2)` [m] of cells `(..., 2)` x, y."""
        return (np.asarray(cells, dtype=float) + 0.5) * self.resolution + self.origin
