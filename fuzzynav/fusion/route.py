"""The way to the goal over a fine map, and the point of it that the robot heads for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fuzzynav.geometry import Array, length
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar
from fuzzynav.smoothing import prune

__all__ = ["Route", "clear_from", "route", "target_of"]

REACHED = 0.15  # [m]
WORTH, WORTH_A_TRY = 1.1, 1.5  # times shorter than the way with more room


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Route:
    """Turning points `(n, 2)` [m] from start to goal, and the room that the centre keeps from what stands."""

    points: Array
    room: float  # [m]

    @property
    def length(self) -> float:
        """Length [m]."""
        return length(self.points)

    def left(self, here: Array, first: int) -> float:
        """Length [m] from `here` over the turning points from `first` on."""
        return length(np.vstack([here, self.points[first:]]))


def route(
    grid: GridMap, start: Array, goal: Array, radius: float, rooms: tuple[float, ...], options: astar.Options
) -> Route | None:
    """A way that keeps `radius` and one of the rooms [m], the widest first, from what stands; None: there is none.

    The widest room is taken whose way is at most a tenth longer than with the narrowest. Rooms below 0 find gaps that
    are only narrow because cells are coarse; such a way is tried where every other is half as long again. Start and
    goal may stand nearer to something: the nearest cell with room takes their place.
    """
    wide, seeming = [r for r in rooms if r >= 0.0], [r for r in rooms if r < 0.0]
    best = _search(grid, start, goal, radius + wide[-1], options) if wide else None
    for room in wide[:-1] if best is not None else ():
        found = _search(grid, start, goal, radius + room, options)
        if found is not None and best is not None and found.length <= WORTH * best.length:
            best = found
            break
    straight = float(np.hypot(*(np.asarray(goal) - start)))
    if best is not None and best.length <= WORTH_A_TRY * straight:
        return best
    for room in seeming:
        found = _search(grid, start, goal, radius + room, options)
        if found is not None:
            return found if best is None or best.length > WORTH_A_TRY * found.length else best
    return best


def _search(grid: GridMap, start: Array, goal: Array, room: float, options: astar.Options) -> Route | None:
    """One search; its cells are pruned to turning points."""
    field = grid.distance_field()
    ends = [_open(grid, field, point, room) for point in (start, goal)]
    if ends[0] is None or ends[1] is None:
        return None
    found = astar.search(grid, ends[0], ends[1], replace(options, safety_radius=room))
    if found.status != "reached":
        return None
    free = max(room - 0.75 * grid.resolution, 0.0)
    points = grid.center_of(prune(found.cells, grid, free))
    near = np.hypot(*(points[0] - start)) < grid.resolution
    points = np.vstack([start, points[1:] if near and len(points) > 1 else points])
    if grid.clear_line(points[-1], goal, free):
        points[-1] = goal
    return Route(points=points, room=free)


def _open(grid: GridMap, field: Array, point: Array, room: float) -> NDArray[np.int64] | None:
    """The cell nearest to a point that keeps the room, within 1 m; None where there is none."""
    col, row = grid.cell_of(point)
    rows, cols = grid.shape
    reach = int(np.ceil(1.0 / grid.resolution))
    top, left = max(row - reach, 0), max(col - reach, 0)
    part = field[top : min(row + reach + 1, rows), left : min(col + reach + 1, cols)]
    free = np.argwhere(part > room)
    if not len(free):
        return None
    away = (free[:, 0] + top - row) ** 2 + (free[:, 1] + left - col) ** 2
    j, i = free[int(np.argmin(away))]
    return np.array([i + left, j + top])


def clear_from(grid: GridMap, here: Array, way: Route, first: int, least: float) -> bool:
    """Whether the way from `here` over the turning points from `first` on is free for a disc of `least` [m].

    For one of the way's own room, where that is less.
    """
    points = np.vstack([here, way.points[first:]])
    room = min(way.room, least)
    return all(grid.clear_line(a, b, room) for a, b in pairwise(points))


def target_of(grid: GridMap, here: Array, way: Route, first: int, least: float) -> int:
    """Index of the last turning point that a disc of `least` [m] could drive to straight, not before `first`.

    One of the way's own room, where that is less. A point nearer than REACHED is done with.
    """
    room, at = min(way.room, least), first
    while at + 1 < len(way.points) and (
        grid.clear_line(here, way.points[at + 1], room) or np.hypot(*(way.points[at] - here)) < REACHED
    ):
        at += 1
    return at
