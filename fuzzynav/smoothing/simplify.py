"""Fewer nodes on a path: drop what lies on a line, then what a straight free leg can skip.

A leg is free when a disc of `radius` [m] can move along it; at radius 0 the corner rule of GridMap.clear_line
decides about contact, and "permissive" lets a leg touch corners and slide along walls, as a point may.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.maps.gridmap import GridMap
from fuzzynav.maps.kernels import disc_passes

__all__ = ["best_shortcut", "key_nodes", "prune", "remove_collinear", "shorten", "shorten_as_printed"]

Cells = NDArray[np.int64]


def remove_collinear(cells: ArrayLike) -> Cells:
    """Path `(n, 2)` without the nodes that lie on the straight line between their neighbours.

    Node B goes when AB = l BC with l > 0. Source: thesis section 3.3.4, collinearity (errata T21: printed with l on
    both sides, which asks for equal lengths too), and step 1 of 4.2.2.2.

    >>> remove_collinear([[0, 0], [1, 1], [3, 3], [3, 4]]).tolist()
    [[0, 0], [3, 3], [3, 4]]
    """
    path = _path(cells)
    if len(path) < 3:
        return path
    before, after = path[1:-1] - path[:-2], path[2:] - path[1:-1]
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turns = (cross != 0) | ((before * after).sum(axis=1) <= 0)
    kept: Cells = path[np.concatenate([[True], turns, [True]])]
    return kept


def key_nodes(cells: ArrayLike, grid: GridMap, radius: float = 0.0, corners: str = "permissive") -> Cells:
    """Key nodes of thesis section 3.3.4: of A, B, C drop B if it is collinear or if the leg A-C is free.

    A is the last node kept, so that one pass decides about each node once. Raises ValueError for a leg of the given
    path that is not free itself.
    """
    path = _free_path(cells, grid, radius, corners)
    if len(path) < 3:
        return path
    kept = [0]
    for b in range(1, len(path) - 1):
        a, c = path[kept[-1]], path[b + 1]
        one, two = path[b] - a, c - path[b]
        collinear = one[0] * two[1] == one[1] * two[0] and (one * two).sum() > 0
        if not (collinear or _free(grid, a, c, radius, corners)):
            kept.append(b)
    return path[kept + [len(path) - 1]]


def shorten(cells: ArrayLike, grid: GridMap, radius: float = 0.0, corners: str = "permissive") -> Cells:
    """Turning points that remain when each leg is led on until it is first blocked.

    From N_1 try N_3, N_4, ... until the leg to N_k is blocked; keep N_(k-1) and go on from there. Source: thesis
    section 4.2.2.2, step 2 (errata T22: printed is a restart from N_k). Raises ValueError as key_nodes.
    """
    path = _free_path(cells, grid, radius, corners)
    if len(path) < 3:
        return path
    kept = [0]
    for k in range(2, len(path)):
        if not _free(grid, path[kept[-1]], path[k], radius, corners):
            kept.append(k - 1)
    return path[kept + [len(path) - 1]]


def shorten_as_printed(cells: ArrayLike, grid: GridMap, radius: float = 0.0, corners: str = "permissive") -> Cells:
    """Step 2 as the thesis prints it: keep N_(k-1), restart from N_k, which stays on the path (errata T22)."""
    path = _free_path(cells, grid, radius, corners)
    if len(path) < 3:
        return path
    kept, base = [0], 0
    for k in range(2, len(path)):
        if k > base + 1 and not _free(grid, path[base], path[k], radius, corners):
            kept += [k - 1, k]
            base = k
    kept.append(len(path) - 1)
    return path[np.unique(kept)]


def best_shortcut(cells: ArrayLike, grid: GridMap, radius: float = 0.0, corners: str = "permissive") -> Cells:
    """Shortest chain of free legs through nodes of the path, in their order: all pairs are tried.

    Sight along a path is not monotone, so that `shorten` can miss it. Raises ValueError as key_nodes.
    """
    path = _free_path(cells, grid, radius, corners)
    n = len(path)
    if n < 3:
        return path
    length, before = np.full(n, np.inf), np.zeros(n, dtype=int)
    length[0] = 0.0
    for a in range(n - 1):
        for b in range(a + 1, n):
            via = length[a] + float(np.hypot(*(path[b] - path[a])))
            if via < length[b] - 1e-9 and (b == a + 1 or _free(grid, path[a], path[b], radius, corners)):
                length[b], before[b] = via, a
    kept = [n - 1]
    while kept[-1] > 0:
        kept.append(int(before[kept[-1]]))
    return path[kept[::-1]]


def prune(cells: ArrayLike, grid: GridMap, radius: float = 0.0, corners: str = "permissive") -> Cells:
    """The two steps of thesis section 4.2.2.2: remove collinear nodes, then lead each leg on until it is blocked.

    >>> wall = GridMap.from_ascii("...\\n.#.\\n...")
    >>> prune([[0, 0], [0, 1], [0, 2], [1, 2], [2, 2]], wall).tolist()
    [[0, 0], [0, 2], [2, 2]]
    """
    return shorten(remove_collinear(cells), grid, radius, corners)


def _path(cells: ArrayLike) -> Cells:
    path = np.asarray(cells)
    if path.size == 0:
        return np.empty((0, 2), dtype=np.int64)
    if path.ndim != 2 or path.shape[1] != 2 or path.dtype.kind not in "iu":
        raise ValueError(f"a path is (n, 2) whole numbers x, y of cells, got {path.dtype} of shape {path.shape}")
    return path.astype(np.int64)


def _free_path(cells: ArrayLike, grid: GridMap, radius: float, corners: str) -> Cells:
    path = _path(cells)
    grid.clear_line(grid.origin, grid.origin, radius, corners)  # refuses a bad radius or rule
    for a, b in pairwise(path):
        if not _free(grid, a, b, radius, corners):
            raise ValueError(f"the leg from cell {a.tolist()} to {b.tolist()} is not free at radius {radius} m")
    return path


def _free(grid: GridMap, a: Cells, b: Cells, radius: float, corners: str) -> bool:
    """As GridMap.clear_line between two cell centres, without its checks."""
    return bool(
        disc_passes(
            grid.occupied, a[0] + 0.5, a[1] + 0.5, b[0] + 0.5, b[1] + 0.5, radius / grid.resolution, corners == "strict"
        )
    )
