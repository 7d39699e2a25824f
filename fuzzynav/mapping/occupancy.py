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

from fuzzynav.geometry import Array, read_only, sealed
from fuzzynav.maps.gridmap import GridMap, cells_across
from fuzzynav.maps.kernels import Record, framed

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
_ODDS = np.dtype((np.record, [(name, "f8") for name in ("hit", "miss", "low", "high", "reach")]))


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
    """Log odds `(rows, cols)` of occupation, row 0 lowest; 0 where nothing was seen; resolution and origin [m].

    The log odds are read-only: `update` makes a new grid.
    """

    log_odds: Array
    resolution: float
    origin: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "log_odds", read_only(self.log_odds))

    @property
    def probability(self) -> Array:
        """Chance `(rows, cols)` that each cell is occupied; 0.5 where nothing was seen."""
        return probability(self.log_odds)

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Cells `(rows, cols)` that a beam has told about."""
        return np.asarray(self.log_odds != 0.0)

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
    size = cells_across(ymax - ymin, xmax - xmin, resolution, LARGEST)
    return OccupancyGrid(sealed(np.zeros(size)), float(resolution), (xmin, ymin))


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
    odds = np.zeros(1, dtype=_ODDS)
    odds[0] = (*log_odds([sensor.hit, sensor.miss, sensor.low, sensor.high]), sensor.reach)
    _update(out, where, told, beams, framed(grid.resolution, grid.origin), odds)
    return OccupancyGrid(sealed(out), grid.resolution, grid.origin)


def build(
    poses: ArrayLike,
    ranges: ArrayLike,
    angles: ArrayLike,
    sensor: InverseSensor = InverseSensor(),
    resolution: float = 0.1,
    bounds: ArrayLike | None = None,
) -> OccupancyGrid:
    """A map from scans as in `update`; by default just large enough for all poses and measured points."""
    if not (np.isfinite(resolution) and resolution > 0):
        raise ValueError(f"resolution must be a positive number of metres, got {resolution}")
    where, told, beams = _scans(poses, ranges, angles)
    return update(
        empty(_around(where, told, beams, sensor.reach, resolution) if bounds is None else bounds, resolution),
        where,
        told,
        beams,
        sensor,
    )


def _scans(poses: ArrayLike, ranges: ArrayLike, angles: ArrayLike) -> tuple[Array, Array, Array]:
    """Poses, ranges and angles as read-only arrays, or a ValueError."""
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
    return sealed(where.view()), sealed(told.view()), sealed(beams.view())


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


class _Beam(NamedTuple):
    """A beam in cells: where it starts, its unit direction, how far it clears, and whether it has no end there."""

    x: float
    y: float
    dx: float
    dy: float
    length: float
    endless: bool


@njit(cache=True)
def _update(odds: Array, poses: Array, ranges: Array, angles: Array, frame: Record, sensor: Record) -> None:
    """Add scans to the log odds in place; `sensor` holds the log odds of hit, miss, low, high, and the reach [m]."""
    rows, cols = odds.shape
    resolution, reach, hit, high = frame[0].resolution, sensor[0].reach, sensor[0].hit, sensor[0].high
    told = np.zeros((rows, cols), dtype=np.int32)  # the scan that told this cell last, counted from 1
    for n in range(poses.shape[0]):
        x, y = (poses[n, 0] - frame[0].x) / resolution, (poses[n, 1] - frame[0].y) / resolution
        c, s = np.cos(poses[n, 2] + angles), np.sin(poses[n, 2] + angles)
        for k in range(angles.shape[0]):
            r = ranges[n, k]
            if not (0.0 <= r <= reach):
                continue
            i, j = int(np.floor(x + r / resolution * c[k])), int(np.floor(y + r / resolution * s[k]))
            if 0 <= i < cols and 0 <= j < rows and told[j, i] != n + 1:
                odds[j, i] = min(odds[j, i] + hit, high)
                told[j, i] = n + 1
        for k in range(angles.shape[0]):
            if ranges[n, k] >= 0.0:  # neither nan nor -inf
                length = min(ranges[n, k], reach) / resolution
                _clear_way(odds, told, n + 1, _Beam(x, y, c[k], s[k], length, ranges[n, k] > reach), sensor)


@njit(cache=True)
def _clear_way(odds: Array, told: NDArray[np.int32], scan: int, beam: _Beam, sensor: Record) -> None:
    """Lower the odds of the cells from the start to the end of a beam, without the cell it ends in."""
    rows, cols = odds.shape
    miss, low = sensor[0].miss, sensor[0].low
    i, j = int(np.floor(beam.x)), int(np.floor(beam.y))
    last_i, last_j = int(np.floor(beam.x + beam.length * beam.dx)), int(np.floor(beam.y + beam.length * beam.dy))
    step_x, step_y = 1 if beam.dx > 0.0 else -1, 1 if beam.dy > 0.0 else -1
    inv_x = 1.0 / beam.dx if beam.dx != 0.0 else np.inf
    inv_y = 1.0 / beam.dy if beam.dy != 0.0 else np.inf
    tx = ((i + 1 if beam.dx > 0.0 else i) - beam.x) * inv_x if beam.dx != 0.0 else np.inf
    ty = ((j + 1 if beam.dy > 0.0 else j) - beam.y) * inv_y if beam.dy != 0.0 else np.inf
    count = abs(last_i - i) + abs(last_j - j) + (1 if beam.endless else 0)
    for _ in range(count):
        if 0 <= i < cols and 0 <= j < rows and told[j, i] != scan:
            odds[j, i] = max(odds[j, i] + miss, low)
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
