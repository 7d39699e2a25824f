"""The occupancy grid as a map: cells, points, inflation, distance, sight and ray casting."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.geometry import Array, read_only, sealed
from fuzzynav.maps import files, kernels
from fuzzynav.maps.drawings import format_ascii, parse_ascii
from fuzzynav.maps.mapdata import MAX_CELLS, MapData

__all__ = ["CORNER_RULES", "GridMap", "cells_across"]

_FARTHEST = 2.0**62  # [cells] further off no cell is counted
CORNER_RULES = ("strict", "permissive")
_NO_SKIP = read_only(np.empty((0, 0)), np.uint8)


def cells_across(height: float, width: float, resolution: float, limit: int = MAX_CELLS) -> tuple[int, int]:
    """Rows and columns of cells of side `resolution` [m] that cover a rectangle [m]; a sliver of 1e-9 is no cell.

    Raises ValueError for a resolution that is not positive, and for more cells than `limit`.

    >>> cells_across(1.0, 2.1, 0.5)
    (2, 5)
    """
    if not (np.isfinite(resolution) and resolution > 0):
        raise ValueError(f"resolution must be a positive number of metres, got {resolution}")
    rows, cols = (max(float(np.ceil(side / float(resolution) - 1e-9)), 1.0) for side in (float(height), float(width)))
    if not rows * cols <= limit:
        raise ValueError(
            f"{rows:.6g} x {cols:.6g} cells of {resolution} m are too many, at most {limit} are made: "
            "take larger cells, or see whether a pose or a range is far off"
        )
    return int(rows), int(cols)


@dataclass(frozen=True, slots=True, eq=False)
class GridMap:
    """A map of square cells. `occupied[row, col]` is bool; row 0 is the lowest y.

    resolution [m] is the side of a cell; origin [m] is the lower left corner of cell [0, 0].
    Cells are named `(n, 2)` integers x = column, y = row, counted from 0. What lies outside the
    map counts as occupied, in every method. `unknown`, where a file has it, is a mask of cells that nobody has
    seen: free for every method of this class until `unknown_as_occupied()` is called.
    Both arrays are copies that cannot be written to, so that no distance is ever that of an older map.
    Raises ValueError for an empty, not two-dimensional or not boolean array, or a bad resolution or origin.
    """

    occupied: NDArray[np.bool_]
    resolution: float = 1.0
    origin: tuple[float, float] = (0.0, 0.0)
    unknown: NDArray[np.bool_] | None = None
    _frame: kernels.Record = field(init=False, repr=False)
    _fields: dict[bool, Array] = field(default_factory=dict, init=False, repr=False)
    _skips: dict[bool, kernels.Bytes] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        """Check the fields and take copies, so that later changes of the caller's arrays do not reach the map."""
        object.__setattr__(self, "occupied", _mask(self.occupied, "occupied"))
        if not (np.isfinite(self.resolution) and self.resolution > 0):
            raise ValueError(f"resolution must be a positive number of metres, got {self.resolution}")
        origin = tuple(float(v) for v in np.asarray(self.origin, dtype=float).ravel())
        if len(origin) != 2 or not np.isfinite(origin).all():
            raise ValueError(f"origin must be two finite numbers of metres, got {self.origin}")
        object.__setattr__(self, "origin", origin)
        object.__setattr__(self, "resolution", float(self.resolution))
        object.__setattr__(self, "_frame", kernels.framed(self.resolution, self.origin))
        if self.unknown is not None:
            object.__setattr__(self, "unknown", _mask(self.unknown, "unknown"))
            if self.unknown.shape != self.occupied.shape:
                raise ValueError(f"unknown has shape {self.unknown.shape}, occupied {self.occupied.shape}")
            if (self.unknown & self.occupied).any():
                raise ValueError("a cell cannot be both unknown and occupied")

    def __reduce__(self) -> tuple[type[GridMap], tuple[object, ...]]:
        """Copies and pickles are made anew from the cells: their arrays are read-only too."""
        return GridMap, (self.occupied, self.resolution, self.origin, self.unknown)

    # -- files

    @classmethod
    def load(cls, path: str | Path) -> GridMap:
        """Map from a MovingAI `.map`, a ROS map_server `.yaml` with its image, or an ASCII `.txt` file."""
        return cls(*files.load(path))

    def save(self, path: str | Path) -> None:
        """Write the map as `.map`, `.yaml` with a `.pgm` beside it, or `.txt`; whole or not at all."""
        files.save(path, MapData(self.occupied, self.resolution, self.origin, self.unknown))

    @classmethod
    def from_ascii(cls, text: str, resolution: float = 1.0, origin: tuple[float, float] = (0.0, 0.0)) -> GridMap:
        """Map drawn with characters: '#' occupied, '.' or blank free, '?' unknown; the top line has the highest y.

        >>> GridMap.from_ascii('''
        ... ..#
        ... ...''').is_occupied([[2.5, 1.5], [2.5, 0.5]]).tolist()
        [True, False]
        """
        occupied, _, _, unknown = parse_ascii(text)
        return cls(occupied, resolution, origin, unknown)

    def to_ascii(self) -> str:
        """The map as the characters that `from_ascii` reads."""
        return format_ascii(self.occupied, self.unknown)

    # -- cells and points

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.occupied.shape

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """xmin, xmax, ymin, ymax [m] of the map, in the order of matplotlib's imshow."""
        (rows, cols), (x, y) = self.shape, self.origin
        return (x, x + cols * self.resolution, y, y + rows * self.resolution)

    def cell_of(self, points: ArrayLike) -> NDArray[np.int64]:
        """Cells `(..., 2)` x, y that hold the points `(..., 2)` [m]; may lie outside the map, at most 2^62 cells.

        Raises ValueError for a point that is not finite.
        """
        cells = np.floor((_finite(points, "points") - self.origin) / self.resolution)
        return np.minimum(np.maximum(cells, -_FARTHEST), _FARTHEST).astype(np.int64)

    def center_of(self, cells: ArrayLike) -> Array:
        """Centres `(..., 2)` [m] of cells `(..., 2)` x, y."""
        return (np.asarray(cells, dtype=float) + 0.5) * self.resolution + self.origin

    def contains(self, cells: ArrayLike) -> NDArray[np.bool_]:
        """Whether the cells `(..., 2)` lie on the map; shape `(...)`."""
        c = np.asarray(cells)
        return np.asarray(((c >= 0) & (c < self.shape[::-1])).all(axis=-1))

    def is_occupied(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether the points `(..., 2)` [m] lie in occupied cells or outside the map; shape `(...)`."""
        cells = self.cell_of(points)
        inside = self.contains(cells)
        x, y = np.where(inside[..., None], cells, 0)[..., 0], np.where(inside[..., None], cells, 0)[..., 1]
        return np.asarray(~inside | self.occupied[y, x])

    def move_allowed(self, cell: ArrayLike, step: ArrayLike, corners: str = "strict") -> bool:
        """Whether one step (-1, 0, 1 each way) from a cell ends on free ground and respects the corner rule.

        A diagonal step needs both side cells free ("strict") or none of them ("permissive").
        """
        _check_rule(corners)
        (x, y), (dx, dy) = np.asarray(cell, dtype=int).tolist(), np.asarray(step, dtype=int).tolist()
        needed = [(x + dx, y + dy)]
        if corners == "strict" and dx and dy:
            needed += [(x + dx, y), (x, y + dy)]
        return all(self.contains(c) and not self.occupied[c[1], c[0]] for c in needed)

    # -- distance

    def distance_field(self, border: bool = True) -> Array:
        """Distance [m] from each cell's centre to the nearest occupied cell's square, `(rows, cols)`; exact.

        0 in occupied cells. With `border` the outside of the map is occupied too; without it a map with nothing on
        it has the distance inf everywhere.

        >>> GridMap.from_ascii("#....").distance_field(border=False).tolist()
        [[0.0, 0.5, 1.5, 2.5, 3.5]]
        """
        return self.field_in_cells(border) * self.resolution

    def field_in_cells(self, border: bool = True) -> Array:
        """The distance field in cells, computed once, shared and therefore read-only."""
        if border not in self._fields:
            self._fields[border] = sealed(kernels.distance_field(self.occupied, border))
        return self._fields[border]

    def skip_in_cells(self, border: bool = True) -> kernels.Bytes:
        """The distance field in whole cells, at most 255, for rays to jump by; shared and therefore read-only."""
        if border not in self._skips:
            self._skips[border] = sealed(np.minimum(self.field_in_cells(border), 255.0).astype(np.uint8))
        return self._skips[border]

    def distance(self, points: ArrayLike, border: bool = True) -> Array:
        """Distance [m] from any points `(..., 2)` to the nearest occupied square; exact, 0 inside one."""
        p = (_finite(points, "points") - self.origin) / self.resolution
        return (
            kernels.distances_at(self.occupied, self.field_in_cells(border), p.reshape(-1, 2), border).reshape(
                p.shape[:-1]
            )
            * self.resolution
        )

    def inflate(self, radius: float, border: bool = True) -> GridMap:
        """Map whose cells are occupied where a disc of `radius` [m] at their centre would overlap an occupied square.

        A disc that only touches does not overlap. With `border` the same holds for the map's edge.
        """
        if not (np.isfinite(radius) and radius >= 0):
            raise ValueError(f"radius must be a finite number of metres, 0 or more, got {radius}")
        grown = self.occupied | (self.field_in_cells(border) < radius / self.resolution - kernels.EDGE)
        return GridMap(grown, self.resolution, self.origin, None if self.unknown is None else self.unknown & ~grown)

    def unknown_as_occupied(self) -> GridMap:
        """The cautious reading of the map: cells that nobody has seen are occupied."""
        if self.unknown is None:
            return self
        return GridMap(self.occupied | self.unknown, self.resolution, self.origin)

    # -- lines and rays

    def line_cells(self, a: ArrayLike, b: ArrayLike, corners: str = "strict") -> NDArray[np.int64]:
        """Cells `(n, 2)` that the segment a-b [m] meets, from a to b (supercover); some may lie outside the map.

        "strict" takes every cell that is touched, also by a corner only; "permissive" only those whose inside is met.
        Raises ValueError for a segment longer than a million cells.
        """
        _check_rule(corners)
        (ax, ay), (bx, by) = self._cells_float(a), self._cells_float(b)
        if not max(abs(bx - ax), abs(by - ay)) <= 1e6:
            raise ValueError(
                f"the line from {(ax, ay)} to {(bx, by)} in cells is longer than a million cells of {self.resolution} m"
            )
        cells = kernels.crossed_cells(ax, ay, bx, by, kernels.EDGE if corners == "strict" else -kernels.EDGE)
        return cells[np.argsort(cells @ [bx - ax, by - ay], kind="stable")]

    def clear_line(self, a: ArrayLike, b: ArrayLike, radius: float = 0.0, corners: str = "strict") -> bool:
        """Whether a disc of `radius` [m] can move straight from a to b without overlapping an occupied square.

        At radius 0 the rule decides about contact: "strict" forbids touching an occupied square, even its corner;
        "permissive" allows sliding along edges and between two squares that meet in a corner.
        """
        _check_rule(corners)
        if not (np.isfinite(radius) and radius >= 0):
            raise ValueError(f"radius must be a finite number of metres, 0 or more, got {radius}")
        (ax, ay), (bx, by) = self._cells_float(a), self._cells_float(b)
        return bool(kernels.disc_passes(self.occupied, ax, ay, bx, by, radius / self.resolution, corners == "strict"))

    def cast(self, pose: ArrayLike, angles: ArrayLike, range_max: float, border: bool = True) -> Array:
        """Ranges [m] `(n,)` of beams at `angles` [rad, body frame] from one pose `(3,)`, or `(m, n)` from `(m, 3)`.

        Exact to the face of the first occupied cell; `range_max` where nothing is nearer; 0 from inside an occupied
        cell. The edge of the map is a wall, or with `border=False` open.

        >>> GridMap.from_ascii(".....#").cast([0.5, 0.5, 0.0], [0.0], 10.0).tolist()
        [4.5]
        """
        poses, beams = _finite(pose, "pose"), _finite(angles, "angles")
        if poses.shape[-1:] != (3,) or poses.ndim > 2 or beams.ndim != 1:
            raise ValueError(f"pose must be (3,) or (m, 3) and angles (n,), got {poses.shape} and {beams.shape}")
        if not range_max > 0:
            raise ValueError(f"range_max must be positive metres, got {range_max}")
        rows, beams = (sealed(np.ascontiguousarray(v).view()) for v in (np.atleast_2d(poses), beams))
        worth = border in self._fields or len(rows) * len(beams) > 2000
        ranges = kernels.cast_rays(
            self.occupied,
            self.skip_in_cells(border) if worth else _NO_SKIP,
            self._frame,
            rows,
            beams,
            float(range_max),
            border,
        )
        return ranges if poses.ndim == 2 else ranges[0]

    def _cells_float(self, point: ArrayLike) -> tuple[float, float]:
        """A point [m] in cell units."""
        p = (_finite(point, "point").reshape(2) - self.origin) / self.resolution
        return float(p[0]), float(p[1])


def _mask(values: ArrayLike, name: str) -> NDArray[np.bool_]:
    """A contiguous boolean copy that cannot be written to, or a ValueError that names the field."""
    array = np.array(values, order="C")
    if array.ndim != 2 or array.size == 0:
        raise ValueError(f"{name} must be a two-dimensional array with at least one cell, got shape {array.shape}")
    if array.dtype != np.bool_:
        raise ValueError(f"{name} must be boolean, got {array.dtype}; compare with a threshold first")
    return sealed(array)


def _finite(values: ArrayLike, name: str) -> Array:
    """The values as floats, or a ValueError that names them."""
    array = np.asarray(values, dtype=float)
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got {array[~np.isfinite(array)][0]}")
    return array


def _check_rule(corners: str) -> None:
    """Refuse an unknown corner rule."""
    if corners not in CORNER_RULES:
        raise ValueError(f"corners must be one of {CORNER_RULES}, got {corners!r}")
