"""The true world of an experiment: map, discs, rectangles, what no map shows, and moving obstacles.

Truth reaches a controller only through sensors; a planner gets `World.known_grid`. All distances are exact.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap, cells_across
from fuzzynav.world import kernels
from fuzzynav.world.movers import Mover

__all__ = ["World"]

_NO_MASK, _NO_FIELD = np.zeros((0, 0), dtype=np.bool_), np.zeros((0, 0))
_NO_SKIP = np.zeros((0, 0), dtype=np.uint8)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class World:
    """Everything that can be hit. Rows of discs are x, y, r [m]; rows of rectangles x, y (centre), width, height [m],
    theta [rad].

    The unknown ones exist in truth but not in `known_grid`. The ground ends in walls at `bounds` (xmin, xmax, ymin,
    ymax), or at the edge of `grid`; without either it has no end. Raises ValueError for malformed shapes.
    """

    grid: GridMap | None = None
    discs: Array = field(default_factory=lambda: np.zeros((0, 3)))
    rectangles: Array = field(default_factory=lambda: np.zeros((0, 5)))
    unknown_discs: Array = field(default_factory=lambda: np.zeros((0, 3)))
    unknown_rectangles: Array = field(default_factory=lambda: np.zeros((0, 5)))
    movers: tuple[Mover, ...] = ()
    bounds: tuple[float, float, float, float] | None = None
    scene: kernels.Scene = field(init=False, repr=False)  # all that stands still, as the kernels read it

    def __post_init__(self) -> None:
        """Check the shapes and pack them for the kernels."""
        for name, width in (("discs", 3), ("rectangles", 5), ("unknown_discs", 3), ("unknown_rectangles", 5)):
            object.__setattr__(self, name, _shapes(getattr(self, name), name, width))
        object.__setattr__(self, "movers", tuple(self.movers))
        if not all(isinstance(m, Mover) for m in self.movers):
            raise ValueError(f"movers must be a sequence of Mover, got {self.movers}")
        if self.grid is not None and self.bounds not in (None, self.grid.extent):
            raise ValueError(f"a world with a grid ends where the grid ends, {self.grid.extent}: leave bounds out")
        if self.grid is not None or self.bounds is not None:
            object.__setattr__(self, "bounds", _box(self.grid.extent if self.grid is not None else self.bounds))
        if any(m.motion == "wander" for m in self.movers) and self.bounds is None:
            raise ValueError("a wandering mover needs a world with bounds or a grid")
        object.__setattr__(self, "scene", self._pack())

    def _pack(self) -> kernels.Scene:
        """Everything that stands still, in arrays that nobody can write to."""
        mask, cells, skip, frame = _NO_MASK, _NO_FIELD, _NO_SKIP, (1.0, 0.0, 0.0)
        if self.grid is not None:
            mask, cells = self.grid.occupied, self.grid.field_in_cells(border=False)
            skip, frame = self.grid.skip_in_cells(border=False), (self.grid.resolution, *self.grid.origin)
        bounds = (-np.inf, np.inf, -np.inf, np.inf) if self.bounds is None else self.bounds
        discs = np.concatenate([self.discs, self.unknown_discs])
        rectangles = np.concatenate([self.rectangles, self.unknown_rectangles])
        ground = np.array([(*frame, *bounds)], dtype=kernels.GROUND)
        shapes = _locked(discs), _locked(rectangles)
        return kernels.Scene(_locked(mask), _locked(cells), _locked(skip), _locked(ground), *shapes)

    def clearance(self, points: ArrayLike, mover_positions: ArrayLike | None = None) -> Array:
        """Distance [m] from the points `(..., 2)` to the nearest obstacle surface or wall, shape `(...)`.

        Negative inside a disc or rectangle or beyond a wall, 0 inside an occupied cell. Movers stand at
        `mover_positions` `(m, 2)`, by default at their starts; an empty list leaves them out. inf on empty ground.

        >>> float(World(discs=[[2.0, 0.0, 0.5]]).clearance([0.0, 0.0]))
        1.5
        """
        p = _finite(points, "points", 2)
        return kernels.clearance(self.scene, self._mover_discs(mover_positions), p.reshape(-1, 2)).reshape(p.shape[:-1])

    def cast(
        self,
        pose: ArrayLike,
        angles: ArrayLike,
        range_max: float,
        mover_positions: ArrayLike | None = None,
    ) -> Array:
        """Ranges [m] `(n,)` of beams at `angles` [rad, body frame] from a pose `(3,)`, or `(m, n)` from `(m, 3)`.

        The nearest of grid, discs, rectangles, walls and movers, known or not; `range_max` where nothing is nearer;
        0 from inside an obstacle. Movers as in `clearance`.

        >>> World(discs=[[2.0, 0.0, 0.5]]).cast([0, 0, 0], [0.0, 1.0], 9.0).tolist()
        [1.5, 9.0]
        """
        return self.cast_labelled(pose, angles, range_max, mover_positions)[0]

    def cast_labelled(
        self, pose: ArrayLike, angles: ArrayLike, range_max: float, mover_positions: ArrayLike | None = None
    ) -> tuple[Array, NDArray[np.int64]]:
        """`cast`, and for each beam the index of the mover it met, -1 where it met something else or nothing."""
        poses, beams = _finite(pose, "pose", 3), np.ascontiguousarray(angles, dtype=float)
        if poses.ndim > 2 or beams.ndim != 1 or not np.isfinite(beams).all():
            raise ValueError(f"pose must be (3,) or (m, 3), angles (n,) finite, got {poses.shape}, {beams.shape}")
        if not range_max > 0:
            raise ValueError(f"range_max must be positive metres, got {range_max}")
        movers = self._mover_discs(mover_positions)
        ranges, labels = kernels.scan(self.scene, movers, poses.reshape(-1, 3), beams, float(range_max))
        return (ranges, labels) if poses.ndim == 2 else (ranges[0], labels[0])

    def _mover_discs(self, positions: ArrayLike | None) -> Array:
        """Movers as discs (m, 3)."""
        out = np.empty((len(self.movers), 3))
        if positions is None:
            for k, mover in enumerate(self.movers):
                out[k, :2], out[k, 2] = mover.start, mover.radius
            return out
        given = np.asarray(positions, dtype=float).reshape(-1, 2)
        if len(given) == 0:
            return np.empty((0, 3))
        if len(given) != len(out) or not np.isfinite(given).all():
            raise ValueError(f"mover_positions must be {len(out)} finite points, got {given.tolist()}")
        out[:, :2], out[:, 2] = given, [m.radius for m in self.movers]
        return out

    def known_grid(self, resolution: float | None = None) -> GridMap:
        """Map that a planner is given: grid, discs and rectangles without the unknown ones and the movers.

        A cell is occupied as soon as a shape overlaps its square. resolution [m] is by default that of the grid; the
        map covers the bounds, its last row and column may reach beyond them. Raises ValueError without bounds, or for
        over 25 million cells.
        """
        if self.bounds is None:
            raise ValueError("a map needs an end: give the world bounds or a grid")
        step = resolution if resolution is not None else (self.grid.resolution if self.grid else None)
        if step is None or not (np.isfinite(step) and step > 0):
            raise ValueError(f"resolution must be a positive number of metres, got {resolution}")
        xmin, xmax, ymin, ymax = self.bounds
        target = np.zeros(cells_across(ymax - ymin, xmax - xmin, step), dtype=np.bool_)
        kernels.raster(self.scene, self.discs, self.rectangles, step, xmin, ymin, target)
        return GridMap(target, step, (xmin, ymin))


def _box(values: ArrayLike | None) -> tuple[float, float, float, float]:
    """Bounds that enclose ground, or a ValueError."""
    box = np.asarray(values, dtype=float).ravel()
    if len(box) != 4 or not np.isfinite(box).all() or box[0] >= box[1] or box[2] >= box[3]:
        raise ValueError(f"bounds must be finite xmin < xmax, ymin < ymax, got {box.tolist()}")
    return float(box[0]), float(box[1]), float(box[2]), float(box[3])


def _shapes(values: ArrayLike, name: str, width: int) -> Array:
    """Rows of `width` finite numbers with positive sizes, or a ValueError that names the field."""
    array = np.array(values, dtype=float)
    if array.size == 0:
        return np.asarray(_locked(np.zeros((0, width))))
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"{name} must have rows of {width} numbers, got shape {array.shape}")
    sizes = array[:, 2:3] if width == 3 else array[:, 2:4]
    if not np.isfinite(array).all() or not (sizes > 0).all():
        raise ValueError(f"{name} must be finite with positive sizes, got {array.tolist()}")
    return np.asarray(_locked(array))


def _finite(values: ArrayLike, name: str, width: int) -> Array:
    """Finite floats whose last axis has `width`, or a ValueError that names them."""
    array = np.ascontiguousarray(values, dtype=float)
    if array.shape[-1:] != (width,) or not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite with {width} numbers each, got {values!r}")
    return array


def _locked(array: Any) -> Any:
    """A view, in one piece, that cannot be written to."""
    view = np.ascontiguousarray(array).view()
    view.flags.writeable = False
    return view
