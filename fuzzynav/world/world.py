"""The true world of an experiment: map, discs, rectangles, what no map shows, and moving obstacles.

Truth reaches a controller only through sensors; a planner gets `World.known_grid`. All distances are exact.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.world import kernels

__all__ = ["Mover", "MoverState", "World", "movers_start", "movers_step"]

MOTIONS = ("constant", "patrol", "wander")
_Static = tuple[kernels.Mask, Array, Array, Array, Array, Array]
_Parameters = tuple[kernels.Cells, Array, Array, Array, Array, kernels.Cells, Array]
_NO_MASK, _NO_FIELD = np.zeros((0, 0), dtype=np.bool_), np.zeros((0, 0))
_NO_SKIP = np.zeros((0, 0), dtype=np.uint8)


@dataclass(frozen=True, slots=True, kw_only=True)
class Mover:
    """A disc that moves by itself; make one with `constant`, `patrol` or `wander`.

    A mover whose yield_distance is not 0 slows down when the robot's centre is ahead of it and nearer to its edge
    than that distance, and stands at half of it. Movers pass through obstacles and one another.
    """

    radius: float  # [m]
    start: tuple[float, float]  # [m]
    motion: str = "constant"
    velocity: tuple[float, float] = (0.0, 0.0)  # [m/s], constant
    waypoints: tuple[tuple[float, float], ...] = ()  # [m], patrol
    speed: float = 0.0  # [m/s], patrol and wander
    yield_distance: float = 0.0  # [m]

    def __post_init__(self) -> None:
        """Refuse what cannot move."""
        numbers = [self.radius, *self.start, *self.velocity, self.speed, self.yield_distance, *np.ravel(self.waypoints)]
        if len(self.start) != 2 or len(self.velocity) != 2 or not np.isfinite(numbers).all():
            raise ValueError(f"a mover needs finite numbers, points of two numbers each, got {self}")
        if not self.radius > 0 or self.speed < 0 or self.yield_distance < 0:
            raise ValueError(
                "a mover needs a positive radius, and a speed and yield_distance of 0 or more, got "
                f"{self.radius}, {self.speed}, {self.yield_distance}"
            )
        if self.motion not in MOTIONS:
            raise ValueError(f"motion must be one of {MOTIONS}, got {self.motion!r}")
        if self.motion == "patrol" and (len(self.waypoints) < 2 or np.ptp(self.waypoints, axis=0).max() == 0.0):
            raise ValueError(f"a patrol needs two or more different waypoints, got {self.waypoints}")

    @classmethod
    def constant(cls, start: ArrayLike, velocity: ArrayLike, radius: float, yield_distance: float = 0.0) -> Mover:
        """Mover that keeps its velocity (2,) [m/s] for ever."""
        return cls(radius=radius, start=_pair(start), velocity=_pair(velocity), yield_distance=yield_distance)

    @classmethod
    def patrol(cls, waypoints: ArrayLike, speed: float, radius: float, yield_distance: float = 0.0) -> Mover:
        """Mover that walks along the waypoints `(n, 2)` [m], turns at the last one and walks back."""
        points = tuple(_pair(p) for p in np.asarray(waypoints, dtype=float))
        if not points:
            raise ValueError("a patrol needs two or more different waypoints, got none")
        return cls(
            radius=radius,
            start=points[0],
            motion="patrol",
            waypoints=points,
            speed=speed,
            yield_distance=yield_distance,
        )

    @classmethod
    def wander(cls, start: ArrayLike, speed: float, radius: float, yield_distance: float = 0.0) -> Mover:
        """Mover that walks straight from one random point of free ground to the next."""
        return cls(radius=radius, start=_pair(start), motion="wander", speed=speed, yield_distance=yield_distance)


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
    _static: _Static = field(init=False, repr=False)
    _skip: kernels.Bytes = field(init=False, repr=False)

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
        object.__setattr__(self, "_static", self._pack())
        object.__setattr__(self, "_skip", _NO_SKIP if self.grid is None else self.grid.skip_in_cells(border=False))

    def _pack(self) -> _Static:
        """Arrays that the kernels take: grid, its field, scale and origin, bounds, discs, rectangles."""
        mask, cells, frame = _NO_MASK, _NO_FIELD, np.array([1.0, 0.0, 0.0])
        if self.grid is not None:
            mask, cells = self.grid.occupied, self.grid.field_in_cells(border=False)
            frame = np.array([self.grid.resolution, *self.grid.origin])
        bounds = np.array([-np.inf, np.inf, -np.inf, np.inf] if self.bounds is None else self.bounds)
        return (
            mask,
            cells,
            frame,
            bounds,
            np.concatenate([self.discs, self.unknown_discs]),
            np.concatenate([self.rectangles, self.unknown_rectangles]),
        )

    def clearance(self, points: ArrayLike, mover_positions: ArrayLike | None = None) -> Array:
        """Distance [m] from the points `(..., 2)` to the nearest obstacle surface or wall, shape `(...)`.

        Negative inside a disc or rectangle or beyond a wall, 0 inside an occupied cell. Movers stand at
        `mover_positions` `(m, 2)`, by default at their starts; an empty list leaves them out. inf on empty ground.

        >>> float(World(discs=[[2.0, 0.0, 0.5]]).clearance([0.0, 0.0]))
        1.5
        """
        p = _finite(points, "points", 2)
        return kernels._clearance(*self._static, self._mover_discs(mover_positions), p.reshape(-1, 2)).reshape(
            p.shape[:-1]
        )

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
        mask, _, frame, bounds, discs, rectangles = self._static
        movers = self._mover_discs(mover_positions)
        ranges, labels = kernels._scan(
            mask, self._skip, frame, bounds, discs, rectangles, movers, np.atleast_2d(poses), beams, float(range_max)
        )
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
        map covers the bounds, its last row and column may reach beyond them. Raises ValueError without bounds.
        """
        if self.bounds is None:
            raise ValueError("a map needs an end: give the world bounds or a grid")
        step = resolution if resolution is not None else (self.grid.resolution if self.grid else None)
        if step is None or not (np.isfinite(step) and step > 0):
            raise ValueError(f"resolution must be a positive number of metres, got {resolution}")
        xmin, xmax, ymin, ymax = self.bounds
        size = [max(int(np.ceil((high - low) / step - 1e-9)), 1) for low, high in ((xmin, xmax), (ymin, ymax))]
        mask, _, frame = self._static[:3]
        occupied = kernels._raster(
            mask, frame, np.array([step, xmin, ymin]), size[1], size[0], self.discs, self.rectangles
        )
        return GridMap(occupied, step, (xmin, ymin))


@dataclass(frozen=True, slots=True, eq=False)
class MoverState:
    """Where the movers of a world are; `positions` and `velocities` are `(m, 2)`."""

    world: World
    positions: Array  # (m, 2) [m]
    velocities: Array  # (m, 2) [m/s]
    targets: Array  # (m, 2) [m], where a wandering mover walks to
    travelled: Array  # (m,) [m], walked so far
    _parameters: _Parameters = field(repr=False)


def movers_start(world: World, rng: np.random.Generator | int | None = None) -> MoverState:
    """State of the movers at time 0; wandering ones draw their first target from `rng`."""
    movers, rng = world.movers, np.random.default_rng(rng)
    count, corners = len(movers), max([len(m.waypoints) for m in movers], default=0)
    way, starts = np.zeros((count, max(corners, 1), 2)), np.zeros((count, 2))
    for k, mover in enumerate(movers):
        starts[k] = mover.start
        way[k, : len(mover.waypoints)] = np.reshape(mover.waypoints, (-1, 2))
    parameters = (
        np.array([MOTIONS.index(m.motion) for m in movers], dtype=np.int64),
        np.array([m.radius for m in movers]),
        np.array([m.velocity for m in movers]).reshape(-1, 2),
        np.array([m.speed for m in movers]),
        way,
        np.array([len(m.waypoints) for m in movers], dtype=np.int64),
        np.array([m.yield_distance for m in movers]),
    )
    targets = starts.copy()
    for k, mover in enumerate(movers):
        if mover.motion == "wander":
            targets[k] = _draw_target(world, starts[k], mover.radius, rng)
    travelled = np.zeros(count)
    _, velocities, _, _ = kernels._advance(*parameters, starts, targets, travelled, 0.0, np.full(2, np.inf))
    return MoverState(world, starts, velocities, targets, travelled, parameters)


def movers_step(state: MoverState, dt: float, robot_pose: ArrayLike | None, rng: np.random.Generator) -> MoverState:
    """State after `dt` [s]; movers that yield look at the robot's pose `(3,)`, None where there is no robot.

    A mover that reaches its random target waits there for the rest of the step and draws the next one.
    Raises ValueError if dt is not positive.
    """
    if not dt > 0:
        raise ValueError(f"dt must be positive seconds, got {dt}")
    if not state.world.movers:
        return state
    robot = np.full(2, np.inf) if robot_pose is None else np.array(robot_pose, dtype=float)[:2]
    positions, velocities, travelled, arrived = kernels._advance(
        *state._parameters, state.positions, state.targets, state.travelled, float(dt), robot
    )
    targets = state.targets
    if arrived.any():
        targets = targets.copy()
        for k in np.flatnonzero(arrived):
            targets[k] = _draw_target(state.world, positions[k], state.world.movers[k].radius, rng)
    return MoverState(state.world, positions, velocities, targets, travelled, state._parameters)


def _draw_target(world: World, start: Array, radius: float, rng: np.random.Generator) -> Array:
    """A random point that a disc can walk to straight; `start` where 100 draws find none."""
    xmin, xmax, ymin, ymax = world.bounds or (0.0, 0.0, 0.0, 0.0)
    for _ in range(100):
        target = rng.uniform([xmin, ymin], [xmax, ymax])
        steps = max(int(np.ceil(np.hypot(*(target - start)) / (0.5 * radius))), 1)
        line = start + np.linspace(0.0, 1.0, steps + 1)[1:, None] * (target - start)
        if (world.clearance(line, []) >= 1.05 * radius).all():
            return target
    return start


def _pair(values: ArrayLike) -> tuple[float, float]:
    pair = np.asarray(values, dtype=float).ravel()
    if len(pair) != 2:
        raise ValueError(f"expected two numbers, got {pair.tolist()}")
    return float(pair[0]), float(pair[1])


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
        return np.zeros((0, width))
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"{name} must have rows of {width} numbers, got shape {array.shape}")
    sizes = array[:, 2:3] if width == 3 else array[:, 2:4]
    if not np.isfinite(array).all() or not (sizes > 0).all():
        raise ValueError(f"{name} must be finite with positive sizes, got {array.tolist()}")
    return np.ascontiguousarray(array)


def _finite(values: ArrayLike, name: str, width: int) -> Array:
    """Finite floats whose last axis has `width`, or a ValueError that names them."""
    array = np.ascontiguousarray(values, dtype=float)
    if array.shape[-1:] != (width,) or not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite with {width} numbers each, got {values!r}")
    return array
