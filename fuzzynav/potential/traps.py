"""Seeded traps: scenes in which a robot that follows the improved field stands still before the goal.

All choices are ours; the paper prints pictures without places. A trap counts only if the field alone ends in it, and if
the robot's disc can get to the goal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from fuzzynav.geometry import Array, sealed
from fuzzynav.potential import kernels
from fuzzynav.potential.fields import IMPROVED
from fuzzynav.potential.obstacles import discs, walls
from fuzzynav.potential.walks import Steps, walk

__all__ = ["KINDS", "RADIUS", "Trap", "solvable", "trap"]

KINDS: tuple[str, ...] = ("wall", "cup", "near the goal", "two discs", "room")
START, GOAL = (0.0, 0.0), (8.0, 8.0)  # [m] table 2
RADIUS = 0.3  # [m] of the robot
THICK = 0.1  # [m] half a wall
LATTICE = 0.05  # [m] on which a way is sought
AROUND = 4.0  # [m] of ground around start and goal
CLOSE = 0.4  # [m] that start and goal keep from everything


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trap:
    """One scene, from `start` to `goal` [m] among `obstacles` (n, 5)."""

    kind: str
    obstacles: Array
    start: Array
    goal: Array


def trap(seed: int) -> Trap:
    """Trap number `seed`; the kinds take turns. Raises ValueError for a negative seed."""
    if seed < 0:
        raise ValueError(f"a trap has a number of 0 or more, got {seed}")
    rng, kind = np.random.default_rng([9, seed]), KINDS[seed % len(KINDS)]
    start, goal = np.array(START), np.array(GOAL)
    while True:
        rows = _DRAWN[kind](rng)
        gaps = [kernels.gap_to(p[0], p[1], row, RADIUS)[0] for p in (start, goal) for row in rows]
        if min(gaps) < CLOSE - RADIUS or not solvable(rows, start, goal, RADIUS):
            continue
        if walk(start, goal, rows, IMPROVED, Steps(), radius=RADIUS).status == "local_minimum":
            return Trap(kind=kind, obstacles=sealed(rows), start=sealed(start), goal=sealed(goal))


def solvable(obstacles: Array, start: Array, goal: Array, radius: float) -> bool:
    """Whether a disc of `radius` [m] can get from start to goal on a lattice of 5 cm, 4 m around both; True is a proof.

    A step of the lattice is free where the gap at its ends leaves half a step more.
    """
    low, high = np.minimum(start, goal) - AROUND, np.maximum(start, goal) + AROUND
    xs, ys = (np.arange(low[k], high[k] + LATTICE, LATTICE) for k in (0, 1))
    free = kernels.gaps(xs, ys, obstacles, radius) > 0.5 * LATTICE
    regions, _ = ndimage.label(free)
    cells = [regions[tuple(np.round((p[::-1] - low[::-1]) / LATTICE).astype(int))] for p in (start, goal)]
    return bool(cells[0] > 0 and cells[0] == cells[1])


def _placed(points: Array, turn: float, at: Array) -> Array:
    """Points of a frame whose x axis leads to the goal, turned by `turn` [rad] and moved to `at`."""
    angle = turn + np.pi / 4.0
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]) + at)


def _wall(rng: np.random.Generator) -> Array:
    half, aside = rng.uniform(0.5, 2.0), rng.uniform(-0.4, 0.4)
    line = np.array([[0.0, aside * half - half], [0.0, aside * half + half]])
    return walls(_placed(line, rng.uniform(-0.3, 0.3), np.full(2, rng.uniform(2.5, 5.5))), THICK)


def _cup(rng: np.random.Generator) -> Array:
    """A U that opens towards the start."""
    half, depth, aside = rng.uniform(0.8, 1.8), rng.uniform(0.5, 2.0), rng.uniform(-0.3, 0.3)
    line = np.array([[-depth, -half], [0.0, -half], [0.0, half], [-depth, half]]) + [0.0, aside]
    return walls(_placed(line, rng.uniform(-0.4, 0.4), np.full(2, rng.uniform(3.0, 5.5))), THICK)


def _near_goal(rng: np.random.Generator) -> Array:
    """Two or three discs around the goal."""
    count = int(rng.integers(2, 4))
    angles = rng.uniform(0, 2 * np.pi) + np.cumsum(rng.uniform(0.8, 2.0, count))
    away = rng.uniform(0.9, 1.6, count)
    places = np.array(GOAL) + away[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    return discs(np.column_stack([places, rng.uniform(0.2, 0.4, count)]))


def _two_discs(rng: np.random.Generator) -> Array:
    """Two discs on both sides of the way."""
    half, radii = rng.uniform(0.6, 1.5), rng.uniform(0.2, 0.5, 2)
    line = np.array([[0.0, -half], [0.0, half]])
    return discs(np.column_stack([_placed(line, rng.uniform(-0.2, 0.2), np.full(2, rng.uniform(2.5, 5.5))), radii]))


def _room(rng: np.random.Generator) -> Array:
    """A room around the goal, with a door in one of its walls."""
    half, door = rng.uniform(1.6, 2.6), rng.uniform(0.5, 0.9)
    corner = np.array([[-half, -half], [half, -half], [half, half], [-half, half], [-half, -half]])
    which, at = int(rng.integers(4)), rng.uniform(-1.0, 1.0) * (half - door - 0.1)
    a, b = corner[which], corner[which + 1]
    along, middle = (b - a) / np.hypot(*(b - a)), 0.5 * (a + b)
    rest = np.vstack([corner[which + 1 :], corner[1 : which + 1]])
    line = np.vstack([middle + (at + door) * along, rest, middle + (at - door) * along])
    return walls(_placed(line, rng.uniform(-0.4, 0.4), np.array(GOAL)), THICK)


_DRAWN = dict(zip(KINDS, (_wall, _cup, _near_goal, _two_discs, _room), strict=True))
