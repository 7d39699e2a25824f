"""A small hall to try planners in: a pocket that its map shows, blocks that it does not, and people who walk."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.fusion.scenes import NOISY_LASER, ROBOTS, SPEED_BOUND
from fuzzynav.fusion.task import Task
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import visibility
from fuzzynav.robot import Robot
from fuzzynav.simulate.loop import IDEAL_LASER, Loop
from fuzzynav.world import Mover, World

__all__ = ["HALL", "hall_task"]

CELL = 0.5  # [m]
START, GOAL = (1.0, 4.0, 0.0), (11.0, 4.0)  # [m], [rad]
BLOCK, WALKER = 0.8, 0.3  # [m] side of an unknown block, radius of a walker


def _drawn() -> GridMap:
    """12 x 8 m with a pocket that opens towards the start."""
    cells = np.zeros((16, 24), dtype=np.bool_)
    cells[5:11, 13] = True
    cells[[5, 10], 9:14] = True
    return GridMap(cells, CELL)


HALL = _drawn()


def hall_task(
    *,
    blocks: ArrayLike = (),
    walkers: ArrayLike = (),
    robot: Robot = ROBOTS["turtlebot2"],
    ideal: bool = True,
    courtesy: float = 0.1,
    t_max: float = 60.0,
) -> Task:
    """From the left end of the hall to the right one, past blocks `(n, 2)` [m] that the map does not show.

    walkers: rows x1, y1, x2, y2 [m], speed [m/s] of people who walk to and fro between two places, and stop `courtesy`
    [m] before a robot that stands. Without an `ideal` tracker ranges are noisy by 1 cm. Raises ValueError for a walker
    faster than SPEED_BOUND.

    >>> round(hall_task().optimum, 2)
    10.83
    """
    centres = np.asarray(blocks, dtype=float).reshape(-1, 2)
    rows = np.asarray(walkers, dtype=float).reshape(-1, 5)
    if (rows[:, 4] > SPEED_BOUND).any():
        raise ValueError(f"no walker is faster than {SPEED_BOUND} m/s, got {rows[:, 4].tolist()}")
    sides = np.tile([BLOCK, BLOCK, 0.0], (len(centres), 1))
    people = tuple(_walker(row, courtesy) for row in rows)
    return Task(
        name="hall",
        world=World(grid=HALL, unknown_rectangles=np.hstack([centres, sides]), movers=people),
        robot=robot,
        start=np.array(START),
        goal=np.array(GOAL),
        speed_bound=SPEED_BOUND,
        optimum=visibility.shortest(HALL, START[:2], GOAL, robot.radius).length,
        chart=HALL,
        ideal=ideal,
        laser=IDEAL_LASER if ideal else NOISY_LASER,
        t_max=t_max,
        loop=Loop(stall_time=np.inf, standing=0.05, end_when_struck=True),
    )


def _walker(row: Array, courtesy: float) -> Mover:
    """One walker."""
    return Mover.patrol(row[:4].reshape(2, 2), float(row[4]), WALKER, courtesy=courtesy)
