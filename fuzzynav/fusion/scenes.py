"""Seeded scenes of chapter 07: a map, squares that it does not show, and movers, all near the shortest way.

All choices are ours; the thesis shows two pictures and prints no positions.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fuzzynav.fusion.task import Task
from fuzzynav.geometry import Array, resample
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import visibility
from fuzzynav.robot import THESIS, TURTLEBOT2, Robot
from fuzzynav.simulate.loop import IDEAL_LASER, Loop
from fuzzynav.world import Mover, World

__all__ = ["EDITION", "GOAL", "ROBOTS", "SPEED_BOUND", "START", "scene_task"]

EDITION = 1  # of the scenes: another number, other scenes
RADIUS = 0.3  # [m] of the robot and of the movers
ROBOTS = {"thesis": THESIS, "turtlebot2": replace(TURTLEBOT2, radius=RADIUS)}
SPEED_BOUND = 0.5  # [m/s] no mover is faster
START, GOAL = (1.5, 1.5), (18.5, 18.5)  # [m]
SIZE, DENSITY = 20, 0.12  # cells of 1 m along a side; share of blocks
UNKNOWN, MOVERS = 3, 4
NOISY_LASER = replace(IDEAL_LASER, noise=0.01)
KEEP = 3.0  # [m] around start and goal without unknown squares and movers
LEAST_WALK = 2.0  # [m] of a patrol


def scene_task(
    seed: int, *, robot: Robot = ROBOTS["turtlebot2"], ideal: bool = True, courteous: bool = True, movers: int = MOVERS
) -> Task:
    """Scene number `seed`: 20 x 20 m, 12 % blocks, three squares that the map lacks and movers, all near the shortest
    way among everything that stands.

    The movers patrol at 0.15 to 0.5 m/s on ground that is free for their disc; courteous ones stop 0.1 m before a robot
    that stands. Where no one tells where they are (`ideal` False), the scanner's ranges are noisy by 1 cm. Scenes
    without a way for the robot's disc are drawn anew. Raises ValueError for a negative seed.
    """
    if seed < 0:
        raise ValueError(f"a scene has a number of 0 or more, got {seed}")
    rng = np.random.default_rng([EDITION, seed])
    while True:
        known, full = _squares(rng)
        best = visibility.shortest(full, START, GOAL, robot.radius)
        walkers = None if best.status != "reached" else _walkers(rng, full, best.points, movers, courteous)
        if walkers is not None:
            break
    hidden = np.argwhere(full.occupied & ~known.occupied)[:, ::-1] + 0.5
    squares = np.column_stack([hidden, np.ones((len(hidden), 2)), np.zeros(len(hidden))])
    first = best.points[1] - best.points[0]
    return Task(
        name=f"scene {seed}",
        world=World(grid=known, unknown_rectangles=squares, movers=walkers),
        robot=robot,
        start=np.array([*START, np.arctan2(first[1], first[0])]),
        goal=np.array(GOAL),
        speed_bound=SPEED_BOUND,
        optimum=best.length,
        chart=known,
        ideal=ideal,
        laser=IDEAL_LASER if ideal else NOISY_LASER,
        loop=Loop(stall_time=np.inf, standing=0.05, end_when_struck=True),
    )


def _squares(rng: np.random.Generator) -> tuple[GridMap, GridMap]:
    """The map, and the map with the squares that it lacks: they stand on or beside the shortest way."""
    while True:
        blocks = rng.random((SIZE, SIZE)) < DENSITY
        for x, y in (START, GOAL):
            blocks[int(y) - 1 : int(y) + 2, int(x) - 1 : int(x) + 2] = False
        way = visibility.shortest(GridMap(blocks), START, GOAL, RADIUS)
        if way.status == "reached":
            break
    full, line = blocks.copy(), resample(way.points, 0.1)
    while (full ^ blocks).sum() < UNKNOWN:
        place = line[rng.integers(len(line))] + rng.uniform(-1.0, 1.0, 2)
        col, row = np.clip(np.floor(place).astype(int), 0, SIZE - 1)
        if _far_from_ends(np.array([col + 0.5, row + 0.5])):
            full[row, col] = True
    return GridMap(blocks), GridMap(full)


def _far_from_ends(place: Array) -> bool:
    return bool(min(np.hypot(*(place - START)), np.hypot(*(place - GOAL))) > KEEP)


def _walkers(
    rng: np.random.Generator, full: GridMap, way: Array, count: int, courteous: bool
) -> tuple[Mover, ...] | None:
    """Movers that patrol over places on or beside the way; None where 1000 draws do not find room for them."""
    line, found = resample(way, 0.1), list[Mover]()
    for _ in range(1000):
        if len(found) == count:
            break
        middle = line[rng.integers(len(line))] + rng.uniform(-0.5, 0.5, 2)
        heading, half, speed = rng.uniform(-np.pi, np.pi), rng.uniform(1.0, 3.0), rng.uniform(0.15, SPEED_BOUND)
        ends = middle + np.outer([-half, half], [np.cos(heading), np.sin(heading)])
        if _far_from_ends(middle) and _walkable(full, ends) and all(_far_from_ends(e) for e in ends):
            found.append(Mover.patrol(ends, speed, RADIUS, courtesy=0.1 if courteous else 0.0))
    return tuple(found) if len(found) == count else None


def _walkable(full: GridMap, ends: NDArray[np.float64]) -> bool:
    """Whether a mover's disc can walk straight from end to end on free ground."""
    inside = bool((ends > RADIUS).all() and (ends < SIZE - RADIUS).all())
    return inside and full.clear_line(ends[0], ends[1], RADIUS)
