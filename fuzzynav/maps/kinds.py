"""Other kinds of map from one occupancy grid: walls as lines, places and passages as a graph, names for places."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from fuzzynav.geometry import Array, read_only
from fuzzynav.maps.gridmap import GridMap

__all__ = ["Places", "name_places", "outline", "places"]


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """A topological map: places as nodes, passages between them as edges.

    `labels` (rows, cols) numbers the cells from 1, 0 where occupied or not reached; `centers` `(n, 2)` [m] lie in the
    widest part of each place; `passages` `(m, 2)` are pairs of places counted from 0, at the points `doors` `(m, 2)`.
    The arrays are read-only.
    """

    labels: NDArray[np.int64]
    centers: Array
    areas: Array  # (n,) [m^2]
    passages: NDArray[np.int64]
    doors: Array

    def __post_init__(self) -> None:
        for name in ("labels", "passages"):
            object.__setattr__(self, name, read_only(getattr(self, name), np.int64))
        for name in ("centers", "areas", "doors"):
            object.__setattr__(self, name, read_only(getattr(self, name)))


def outline(grid: GridMap) -> Array:
    """The metric map: straight wall faces `(n, 2, 2)` [m], each from its start to its end, between free and occupied.

    >>> outline(GridMap.from_ascii("..\\n##")).tolist()
    [[[0.0, 1.0], [2.0, 1.0]]]
    """
    across = [((j, int(a)), (j, int(b))) for j, a, b in _runs(grid.occupied)]
    up = [((int(a), i), (int(b), i)) for i, a, b in _runs(grid.occupied.T)]
    lines = [[(a[1], a[0]), (b[1], b[0])] for a, b in across + up]
    return np.array(lines, dtype=float).reshape(-1, 2, 2) * grid.resolution + grid.origin


def _runs(mask: NDArray[np.bool_]) -> list[tuple[int, int, int]]:
    """Row border, first and end column of each stretch along which rows j - 1 and j differ in one sense."""
    found = []
    for j in range(1, len(mask)):
        sense = mask[j].astype(int) - mask[j - 1]
        cuts = np.flatnonzero(np.diff(sense, prepend=0, append=0))
        found += [(j, a, b) for a, b in pairwise(cuts.tolist()) if sense[a] != 0]
    return found


def places(grid: GridMap, door: float) -> Places:
    """The topological map: passages no wider than `door` [m] separate the places, of which they are then the edges.

    Cells further than half of `door` from every wall are the cores; each place is a core and the free ground that
    grows from it. Raises ValueError if door is not positive or nowhere fits between the walls.
    """
    if not door > 0:
        raise ValueError(f"door must be a positive width in metres, got {door}")
    field = grid.distance_field()
    labels, count = ndimage.label(field > 0.5 * door)
    if count == 0:
        raise ValueError(f"no free ground is wider than {door} m")
    labels = _grown(labels.astype(np.int64), ~grid.occupied)
    peaks = ndimage.maximum_position(field, labels, np.arange(1, count + 1))
    areas = np.asarray(np.bincount(labels.ravel(), minlength=count + 1)[1:] * grid.resolution**2, dtype=float)
    pairs, doors = _contacts(labels, grid)
    return Places(labels, grid.center_of(np.array(peaks)[:, ::-1]), areas, pairs, doors)


def _grown(labels: NDArray[np.int64], free: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Labels spread over free ground, one cell at a time, to whatever touches them."""
    while True:
        near = ndimage.maximum_filter(labels, footprint=ndimage.generate_binary_structure(2, 1))
        fresh = free & (labels == 0) & (near > 0)
        if not fresh.any():
            return labels
        labels = np.where(fresh, near, labels)


def _contacts(labels: NDArray[np.int64], grid: GridMap) -> tuple[NDArray[np.int64], Array]:
    """Pairs of places that touch, and the middle of each contact [m]."""
    touching: dict[tuple[int, int], list[tuple[float, float]]] = {}
    for dy, dx in ((0, 1), (1, 0)):
        a, b = labels[: len(labels) - dy, : labels.shape[1] - dx], labels[dy:, dx:]
        for j, i in zip(*np.nonzero((a != b) & (a > 0) & (b > 0)), strict=True):
            key = (int(min(a[j, i], b[j, i])) - 1, int(max(a[j, i], b[j, i])) - 1)
            touching.setdefault(key, []).append((i + 0.5 + dx / 2, j + 0.5 + dy / 2))
    keys = sorted(touching)
    middles = [np.mean(touching[key], axis=0) for key in keys]
    return (
        np.array(keys, dtype=np.int64).reshape(-1, 2),
        np.array(middles, dtype=float).reshape(-1, 2) * grid.resolution + grid.origin,
    )


def name_places(found: Places, grid: GridMap, names: Mapping[str, ArrayLike]) -> list[str]:
    """The semantic map: one name for each place, from points `(2,)` [m] that are known to lie in it.

    A place that no point names is called 'place k'. Raises ValueError for a point outside every place, or two names
    for one place.
    """
    out = [f"place {k}" for k in range(len(found.centers))]
    given: dict[int, str] = {}
    for name, point in names.items():
        cell = grid.cell_of(point)
        label = int(found.labels[cell[1], cell[0]]) if grid.contains(cell) else 0
        if label == 0:
            raise ValueError(f"{name!r} lies in no place")
        if label in given:
            raise ValueError(f"{given[label]!r} and {name!r} name the same place")
        given[label] = out[label - 1] = name
    return out
