"""Harmonic fields: Laplace's equation over the free cells of a map, which has no local extremum but the goal.

Source: Connolly, Burns and Weiss 1990; solved by SciPy's sparse factorisation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage, sparse
from scipy.sparse.linalg import splu

from fuzzynav.checks import finite
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap

__all__ = ["Climb", "climb", "harmonic"]

SIDES = np.array([[0, 1], [1, 0], [0, -1], [-1, 0]])  # rows, columns


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Climb:
    """A way up a harmonic field: 'reached', or 'no_path'."""

    cells: NDArray[np.int64]  # (n, 2) column, row
    status: str


def harmonic(grid: GridMap, goal: ArrayLike) -> Array:
    """Field of every cell `[row, col]`: the chance that a random walk from it meets the goal before what stands.

    1 at the goal, 0 where the map is occupied, beyond its rim and where no way leads to the goal; between them the mean
    of the four neighbours. A mean is never more than the greatest neighbour, so nothing but the goal is a summit. Small
    chances keep their digits: the factorisation of such a matrix subtracts nothing. Minus the field is the potential.
    Raises ValueError for a goal outside the map or on an occupied cell.
    """
    column, row = grid.cell_of(finite(np.asarray(goal, dtype=float), "the goal", 2))
    rows, cols = grid.shape
    if not (0 <= row < rows and 0 <= column < cols) or grid.occupied[row, column]:
        raise ValueError(f"the goal {np.asarray(goal, dtype=float).tolist()} must lie on a free cell of the map")
    regions, _ = ndimage.label(~grid.occupied)
    inside = regions == regions[row, column]
    found = np.zeros(grid.shape)
    found[row, column] = 1.0
    inside[row, column] = False
    number = np.full((rows + 2, cols + 2), -1, dtype=np.int64)
    places = np.argwhere(inside)
    if not len(places):
        return found
    number[places[:, 0] + 1, places[:, 1] + 1] = np.arange(len(places))
    near = [number[places[:, 0] + 1 + dy, places[:, 1] + 1 + dx] for dy, dx in SIDES]
    mine = [np.flatnonzero(other >= 0) for other in near]
    i = np.concatenate([np.arange(len(places)), *mine])
    j = np.concatenate([np.arange(len(places)), *(other[m] for other, m in zip(near, mine, strict=True))])
    values = np.concatenate([np.full(len(places), 4.0), *(np.full(len(m), -1.0) for m in mine)])
    matrix = sparse.csc_array((values, (i, j)), shape=(len(places), len(places)))
    beside = np.abs(places - [row, column]).sum(axis=1) == 1
    factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    found[inside] = factors.solve(beside.astype(float))
    return found


def climb(field: Array, grid: GridMap, start: ArrayLike) -> Climb:
    """Cells from the start up a harmonic field, always to the greatest of the four neighbours.

    Raises ValueError for a start outside the map.
    """
    cell = np.asarray(grid.cell_of(finite(np.asarray(start, dtype=float)[:2], "the start", 2)))
    rows, cols = field.shape
    if not (0 <= cell[1] < rows and 0 <= cell[0] < cols):
        raise ValueError(f"the start {np.asarray(start, dtype=float).tolist()} lies outside the map")
    path = [cell]
    while field[cell[1], cell[0]] < 1.0:
        near = cell + SIDES[:, ::-1]
        near = near[((near >= 0) & (near < [cols, rows])).all(axis=1)]
        best = near[int(np.argmax(field[near[:, 1], near[:, 0]]))]
        if grid.occupied[cell[1], cell[0]] or not field[best[1], best[0]] > field[cell[1], cell[0]]:
            return Climb(cells=np.array(path), status="no_path")
        cell = best
        path.append(cell)
    return Climb(cells=np.array(path), status="reached")
