"""Turning points of a global path as sub-goals, when to go on to the next one, and what ends the orbit around one.

A robot that keeps its speed turns on a circle of radius v/omega, 2.9 m at the 1 m/s and 0.35 rad/s of the thesis. A
sub-goal that lies inside that circle is never reached: the robot orbits it. Two cures: go on as soon as the next one
is in clear view, and drive no faster than the arc through the sub-goal allows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.checks import finite, points
from fuzzynav.geometry import Array, sealed, wrap
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar
from fuzzynav.planning.astar import ENHANCED, Options
from fuzzynav.robot import Robot
from fuzzynav.smoothing import simplify

__all__ = [
    "NEAR",
    "SWITCH_RADIUS",
    "VIEW_RADIUS",
    "SubGoals",
    "arc_cap",
    "capped",
    "global_path",
    "key_nodes",
    "pruned",
    "sub_goals",
    "switched_by_radius",
    "switched_by_view",
    "turning_points",
]

SWITCH_RADIUS = 1.0  # [m] of the printed rule; ours, the thesis prints none
VIEW_RADIUS = 0.5  # [m] a sub-goal nearer than this is reached, whatever is in view
NEAR = 3.0  # [m] a sub-goal further away is not left yet, so that the path is still followed

Cells = NDArray[np.int64]
Keep = Callable[[Cells, GridMap, Options], Cells]  # which cells of a path remain


def pruned(cells: Cells, grid: GridMap, options: Options) -> Cells:
    """The two steps of thesis section 4.2.2.2, for a disc of the safety radius; a point may touch corners."""
    return simplify.prune(cells, grid, _passable(cells, grid, options))


def key_nodes(cells: Cells, grid: GridMap, options: Options) -> Cells:
    """The key nodes of thesis section 3.3.4, for a disc of the safety radius."""
    return simplify.key_nodes(cells, grid, _passable(cells, grid, options))


def turning_points(cells: Cells, grid: GridMap, options: Options) -> Cells:
    """Where the path of the search turns; nothing is cut short."""
    return simplify.remove_collinear(cells)


def _passable(cells: Cells, grid: GridMap, options: Options) -> float:
    """The safety radius [m], or a little less: a step between two cells at that distance may come nearer halfway."""
    radius, spots = options.safety_radius, grid.center_of(cells)
    if all(grid.clear_line(a, b, radius, "permissive") for a, b in pairwise(spots)):
        return radius
    return float(np.sqrt(max(radius**2 - 0.5 * grid.resolution**2, 0.0)))


def global_path(
    grid: GridMap, start: ArrayLike, goal: ArrayLike, options: Options = ENHANCED, keep: Keep = pruned
) -> Array:
    """Points `(n, 2)` [m] from start to goal: searched on the cells, then what `keep` leaves of them; empty if none.

    Start and goal stand where they are, the points between in centres of cells. A start or goal that the safety
    radius blocks is joined to the nearest cell that it does not. Raises ValueError for points that are not finite.
    """
    a, b = finite(np.asarray(start, dtype=float)[:2], "start", 2), finite(np.asarray(goal, dtype=float)[:2], "goal", 2)
    free = grid.inflate(options.safety_radius)
    if free.occupied.all():
        return np.empty((0, 2))
    found = astar.search(grid, _free_cell(free, a), _free_cell(free, b), options)
    if found.status != "reached":
        return np.empty((0, 2))
    cells = keep(found.cells, grid, options)
    inner = [cell for k, cell in enumerate(cells) if _between(grid, cell, k, len(cells), (a, b))]
    return np.vstack([a, grid.center_of(np.reshape(inner, (-1, 2))), b])


def _between(grid: GridMap, cell: Cells, k: int, count: int, ends: tuple[Array, Array]) -> bool:
    """Whether a cell is a point of its own: not the one that holds the start or the goal."""
    if 0 < k < count - 1:
        return True
    return bool((grid.cell_of(ends[0 if k == 0 else 1]) != cell).any())


def _free_cell(free: GridMap, point: Array) -> Cells:
    """The cell of a point, or the free one whose centre is nearest to it."""
    cell = free.cell_of(point)
    if not free.is_occupied(point):
        return cell
    cells = np.argwhere(~free.occupied)[:, ::-1]
    away = np.hypot(*(free.center_of(cells) - point).T)
    return np.asarray(cells[int(np.argmin(np.round(away, 9)))])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SubGoals:
    """The points that a path still leads through; the last one is the goal. Raises ValueError where there is none."""

    points: Array  # (n, 2) [m]
    index: int = 0  # of the one that is headed for

    def __post_init__(self) -> None:
        rows = points(self.points, "the sub-goals")
        if not 0 <= self.index < len(rows):
            raise ValueError(f"there is no sub-goal {self.index} among {len(rows)}")
        object.__setattr__(self, "points", sealed(rows.copy()))

    @property
    def current(self) -> Array:
        """The point `(2,)` [m] that is headed for."""
        return np.asarray(self.points[self.index])

    @property
    def last(self) -> bool:
        """Whether only the goal is left."""
        return self.index == len(self.points) - 1

    def next(self) -> SubGoals:
        """The same points, one further; at the goal the goal stays."""
        return self if self.last else replace(self, index=self.index + 1)


def sub_goals(path: ArrayLike) -> SubGoals:
    """The sub-goals of a path `(n, 2)`: every point but the start, which is where the robot is."""
    rows = points(path, "the path")
    return SubGoals(points=rows[1:] if len(rows) > 1 else rows)


def switched_by_radius(goals: SubGoals, pose: ArrayLike, radius: float = SWITCH_RADIUS) -> SubGoals:
    """The sub-goals after those that lie within `radius` [m] of the robot: the rule of the printed method.

    >>> switched_by_radius(sub_goals([[0, 0], [2, 0], [5, 0]]), [1.5, 0, 0]).index
    1
    """
    here = np.asarray(pose, dtype=float)[:2]
    while not goals.last and float(np.hypot(*(goals.current - here))) <= radius:
        goals = goals.next()
    return goals


def switched_by_view(
    goals: SubGoals,
    pose: ArrayLike,
    grid: GridMap | None,
    size: float,
    *,
    near: float = NEAR,
    radius: float = VIEW_RADIUS,
) -> SubGoals:
    """The sub-goals after those that are done with.

    Done with is one within `radius` [m], and one nearer than `near` [m] when a disc of radius `size` [m] can drive
    straight to the next one on the known map. Without a map nothing is in view.
    """
    here = np.asarray(pose, dtype=float)[:2]
    while not goals.last:
        away = float(np.hypot(*(goals.current - here)))
        seen = grid is not None and away < near and grid.clear_line(here, goals.points[goals.index + 1], size)
        if not (away <= radius or seen):
            break
        goals = goals.next()
    return goals


def arc_cap(pose: ArrayLike, target: ArrayLike, omega: float) -> float:
    """Speed [m/s] at which the arc from the pose through the target asks for a turn of omega [rad/s].

    The circle through both has the radius d/(2 sin e), d the way to the target and e the angle to it. Beyond 90 degrees
    the circle of 90 degrees holds: what lies behind is not to be reached in a wide bow. inf for a target ahead.

    >>> round(arc_cap([0.0, 0.0, 0.0], [0.0, 2.0], 0.35), 3)
    0.35
    """
    x, y, theta = np.asarray(pose, dtype=float)
    dx, dy = np.asarray(target, dtype=float)[:2] - (x, y)
    error = min(abs(float(wrap(np.arctan2(dy, dx) - theta))), 0.5 * np.pi)
    chord, bend = omega * float(np.hypot(dx, dy)), 2.0 * float(np.sin(error))
    return chord / bend if bend > 1e-9 * chord else float("inf")


def capped(robot: Robot, cap: float, speed: float, dt: float) -> Robot:
    """The robot with its speed [m/s] bounded by the cap, or by what one step of braking leaves of its present speed."""
    bound = max(cap, speed - robot.dec_lim_x * dt, 0.01 * robot.max_vel_x)
    return robot if bound >= robot.max_vel_x else replace(robot, max_vel_x=bound)
