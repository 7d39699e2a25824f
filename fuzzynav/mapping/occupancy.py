"""Occupancy mapping: from laser scans at known or estimated poses to the chance that each cell is occupied.

A cell keeps the logarithm of its odds, so that independent sightings add. The inverse sensor model says what one beam
means: the cells it crosses are probably free, the cell it ends in is probably occupied, the rest is not known.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray
from scipy.special import expit

from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap

__all__ = [
    "InverseSensor",
    "OccupancyGrid",
    "Sharpness",
    "build",
    "empty",
    "log_odds",
    "probability",
    "update",
    "voxels",
]

LARGEST = 50_000_000  # cells of one map


def log_odds(chance: ArrayLike) -> Array:
    """ln(p / (1 - p)) of chances p in (0, 1): 0 for a half.

    >>> log_odds([0.5, 0.9]).round(4).tolist()
    [0.0, 2.1972]
    """
    p = np.asarray(chance, dtype=float)
    if not ((p > 0) & (p < 1)).all():
        raise ValueError("a chance must lie between 0 and 1, both excluded")
    return np.log(p / (1.0 - p))


def probability(odds: ArrayLike) -> Array:
    """Chance from the logarithm of its odds, the inverse of `log_odds`."""
    return np.asarray(expit(np.asarray(odds, dtype=float)))


@dataclass(frozen=True, slots=True, kw_only=True)
class InverseSensor:
    """What one beam says about the cells on its way.

    A cell in which a beam ends is occupied with the chance `hit`, a cell that beams of the scan only cross with the
    chance `miss`; a cell is told once a scan, and an end outweighs a crossing. Chances stay within `low` .. `high`, so
    that a wall that was moved can be unlearned. Beyond `reach` [m] a beam says nothing: a longer one only clears the
    way up to there. Raises ValueError for chances that contradict this.
    """

    hit: float = 0.7
    miss: float = 0.4
    low: float = 0.12
    high: float = 0.97
    reach: float = 30.0

    def __post_init__(self) -> None:
        if not 0.0 < self.low < self.miss < 0.5 < self.hit < self.high < 1.0:
            raise ValueError(
                "chances must rise as 0 < low < miss < 0.5 < hit < high < 1, got "
                f"{self.low}, {self.miss}, {self.hit}, {self.high}"
            )
        if not (np.isfinite(self.reach) and self.reach > 0):
            raise ValueError(f"reach must be a positive number of metres, got {self.reach}")


class Sharpness(NamedTuple):
    """How definite a map is: cells by verdict, and the mean doubt of the cells that were seen."""

    occupied: int
    free: int
    seen: int
    entropy: float  # [bit] a seen cell; 0 certain, 1 no idea


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyGrid:
    """Log odds `(rows, cols)` of occupation, row 0 lowest; 0 where nothing was seen; resolution and origin [m]."""

    log_odds: Array
    resolution: float
    origin: tuple[float, float]

    @property
    def probability(self) -> Array:
        """Chance `(rows, cols)` that each cell is occupied; 0.5 where nothing was seen."""
        return probability(self.log_odds)

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Cells `(rows, cols)` that a beam has told about."""
        return self.log_odds != 0.0

    def to_gridmap(self, occupied: float = 0.65, free: float = 0.196) -> GridMap:
        """The map decided: occupied above one chance, free below the other, else unknown."""
        p = self.probability
        return GridMap(p > occupied, self.resolution, self.origin, (p <= occupied) & (p >= free))

    def sharpness(self, occupied: float = 0.65, free: float = 0.196) -> Sharpness:
        """Counts of decided cells, and the mean entropy of a seen cell."""
        p = self.probability[self.seen]
        bits = -(p * np.log2(p) + (1.0 - p) * np.log2(1.0 - p))
        mean = float(bits.mean()) if len(p) else 1.0
        return Sharpness(int((p > occupied).sum()), int((p < free).sum()), len(p), mean)


def empty(bounds: ArrayLike, resolution: float) -> OccupancyGrid:
    """A map of which nothing is known; bounds are xmin, xmax, ymin, ymax [m], grown to whole cells.

    Raises ValueError for bounds that enclose nothing, a bad resolution or more than 50 million cells.
    """
    xmin, xmax, ymin, ymax = (float(v) for v in np.asarray(bounds, dtype=float))
    if not (np.isfinite(resolution) and resolution > 0):
        raise ValueError(f"resolution must be a positive number of metres, got {resolution}")
    if not (np.isfinite([xmin, xmax, ymin, ymax]).all() and xmin < xmax and ymin < ymax):
        raise ValueError(f"bounds must be finite xmin < xmax, ymin < ymax, got {[xmin, xmax, ymin, ymax]}")
    size = [max(int(np.ceil((high - low) / resolution - 1e-9)), 1) for low, high in ((ymin, ymax), (xmin, xmax))]
    if size[0] * size[1] > LARGEST:
        raise ValueError(f"{size[0]} x {size[1]} cells are too many: is a pose or a range far off?")
    return OccupancyGrid(np.zeros(size), float(resolution), (xmin, ymin))


def update(
    grid: OccupancyGrid,
    poses: ArrayLike,
    ranges: ArrayLike,
    angles: ArrayLike,
    sensor: InverseSensor = InverseSensor(),
) -> OccupancyGrid:
    """The map after scans `ranges` `(n, b)` [m] from `poses` `(n, 3)` with beams at `angles` `(b,)` [rad], body frame.

    nan and -inf: no measurement, the beam is left out. inf: nothing within reach, the way up to it is cleared. What
    lies off the map is left out. Raises ValueError for an empty log, zero beams, poses or angles that are not finite,
    negative ranges.
    """
    where, told, beams = _scans(poses, ranges, angles)
    out = grid.log_odds.copy()
    odds = log_odds([sensor.hit, sensor.miss, sensor.low, sensor.high])
    _update(out, where, told, beams, grid.resolution, *grid.origin, odds, float(sensor.reach))
    return OccupancyGrid(out, grid.resolution, grid.origin)


def build(
    poses: ArrayLike,
    ranges: ArrayLike,
    angles: ArrayLike,
    sensor: InverseSensor = InverseSensor(),
    resolution: float = 0.1,
    bounds: ArrayLike | None = None,
) -> OccupancyGrid:
    """A map from scans as in `update`; by default just large enough for all poses and measured points."""
    where, told, beams = _scans(poses, ranges, angles)
    return update(
        empty(_around(where, told, beams, sensor.reach, resolution) if bounds is None else bounds, resolution),
        where,
        told,
        beams,
        sensor,
    )


def _scans(poses: ArrayLike, ranges: ArrayLike, angles: ArrayLike) -> tuple[Array, Array, Array]:
    """Poses, ranges and angles as arrays, or a ValueError."""
    where, told = np.ascontiguousarray(poses, dtype=float), np.ascontiguousarray(ranges, dtype=float)
    beams = np.ascontiguousarray(angles, dtype=float)
    where, told = (where[None] if where.ndim == 1 else where), (told[None] if told.ndim == 1 else told)
    if len(where) == 0 or beams.size == 0:
        raise ValueError(f"a map needs at least one scan of at least one beam, got {len(where)} of {beams.size}")
    if where.ndim != 2 or where.shape[1] != 3 or told.shape != (len(where), beams.size) or beams.ndim != 1:
        raise ValueError(
            f"poses (n, 3), ranges (n, b) and angles (b,) expected, got {where.shape}, {told.shape}, {beams.shape}"
        )
    if not np.isfinite(where).all() or not np.isfinite(beams).all():
        raise ValueError("poses and angles must be finite")
    if (told[np.isfinite(told)] < 0).any():
        scan = int(np.argwhere(np.isfinite(told) & (told < 0))[0, 0])
        raise ValueError(f"scan {scan} holds a negative range; nan stands for no measurement")
    return where, told, beams


def _around(poses: Array, ranges: Array, angles: Array, reach: float, resolution: float) -> Array:
    """Bounds of all poses and beam ends, in whole cells with one to spare."""
    told = np.where(np.isnan(ranges) | (ranges < 0), 0.0, np.minimum(ranges, reach))
    heading = poses[:, 2:] + angles
    x, y = poses[:, :1] + told * np.cos(heading), poses[:, 1:2] + told * np.sin(heading)
    low = np.floor(np.array([x.min(), y.min()]) / resolution) - 1
    high = np.floor(np.array([x.max(), y.max()]) / resolution) + 2
    return np.array([low[0], high[0], low[1], high[1]]) * resolution


def voxels(points: ArrayLike, size: float) -> NDArray[np.int64]:
    """Cells `(k, 3)` of side `size` [m] that hold at least one of the points `(n, 3)` [m]: a map in three dimensions.

    Points that are not finite are left out. Raises ValueError if size is not positive.

    >>> voxels([[0.1, 0.2, 0.9], [0.3, 0.1, 0.8], [1.5, 0.0, 0.0]], 1.0).tolist()
    [[0, 0, 0], [1, 0, 0]]
    """
    if not size > 0:
        raise ValueError(f"size must be positive metres, got {size}")
    p = np.asarray(points, dtype=float).reshape(-1, 3)
    return np.unique(np.floor(p[np.isfinite(p).all(axis=1)] / size).astype(np.int64), axis=0)


@njit(cache=True)
def _update(
    odds: Array,
    poses: Array,
    ranges: Array,
    angles: Array,
    resolution: float,
    origin_x: float,
    origin_y: float,
    sensor: Array,
    reach: float,
) -> None:
    """Add scans to the log odds in place; `sensor` holds the log odds of hit, miss, low, high."""
    rows, cols = odds.shape
    told = np.zeros((rows, cols), dtype=np.int32)  # the scan that told this cell last, counted from 1
    for n in range(poses.shape[0]):
        x, y = (poses[n, 0] - origin_x) / resolution, (poses[n, 1] - origin_y) / resolution
        c, s = np.cos(poses[n, 2] + angles), np.sin(poses[n, 2] + angles)
        for k in range(angles.shape[0]):
            r = ranges[n, k]
            if not (0.0 <= r <= reach):
                continue
            i, j = int(np.floor(x + r / resolution * c[k])), int(np.floor(y + r / resolution * s[k]))
            if 0 <= i < cols and 0 <= j < rows and told[j, i] != n + 1:
                odds[j, i] = min(odds[j, i] + sensor[0], sensor[3])
                told[j, i] = n + 1
        for k in range(angles.shape[0]):
            if ranges[n, k] >= 0.0:  # neither nan nor -inf
                _clear(odds, told, n + 1, x, y, c[k], s[k], ranges[n, k], reach, resolution, sensor)


@njit(cache=True)
def _clear(
    odds: Array,
    told: NDArray[np.int32],
    scan: int,
    x: float,
    y: float,
    dx: float,
    dy: float,
    range_: float,
    reach: float,
    resolution: float,
    sensor: Array,
) -> None:
    """Lower the odds of the cells from (x, y) [cells] to the end of a beam, without the cell it ends in."""
    rows, cols = odds.shape
    long = range_ > reach
    length = min(range_, reach) / resolution
    i, j = int(np.floor(x)), int(np.floor(y))
    last_i, last_j = int(np.floor(x + length * dx)), int(np.floor(y + length * dy))
    step_x, step_y = 1 if dx > 0.0 else -1, 1 if dy > 0.0 else -1
    inv_x = 1.0 / dx if dx != 0.0 else np.inf
    inv_y = 1.0 / dy if dy != 0.0 else np.inf
    tx = ((i + 1 if dx > 0.0 else i) - x) * inv_x if dx != 0.0 else np.inf
    ty = ((j + 1 if dy > 0.0 else j) - y) * inv_y if dy != 0.0 else np.inf
    count = abs(last_i - i) + abs(last_j - j) + (1 if long else 0)
    for _ in range(count):
        if 0 <= i < cols and 0 <= j < rows and told[j, i] != scan:
            odds[j, i] = max(odds[j, i] + sensor[1], sensor[2])
            told[j, i] = scan
        if tx < ty:
            i += step_x
            tx += abs(inv_x)
        else:
            j += step_y
            ty += abs(inv_y)


def _warm() -> None:
    """Compile the kernels."""
    update(empty([0.0, 1.0, 0.0, 1.0], 0.5), [[0.2, 0.2, 0.0]], [[0.5]], [0.0])
