"""Compiled: how near the robot's rim came to anything while it drove one step."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from fuzzynav.geometry import Array
from fuzzynav.robot.kernels import arc
from fuzzynav.world.kernels import GROUND, Fleet, Scene, between, clearance

__all__ = ["SHARES", "Walk", "least_clearance"]

SHARES = (0.2, 0.4, 0.6, 0.8)  # of a step, where a closer look is taken
NEAR = 0.05  # [m] more than what robot and movers went: no closer look


class Walk(NamedTuple):
    """Where the movers were before and after a step, and what they had walked."""

    old: Array  # (m, 2) [m]
    new: Array
    before: Array  # (m,)
    after: Array


@njit(cache=True)
def _clear(scene: Scene, fleet: Fleet, movers: Array, x: float, y: float) -> float:
    """Distance [m] from a point to the nearest surface, movers included."""
    discs, at = np.empty((movers.shape[0], 3)), np.empty((1, 2))
    discs[:, :2], discs[:, 2] = movers, fleet.radii
    at[0, 0], at[0, 1] = x, y
    return float(clearance(scene, discs, at)[0])


@njit(cache=True)
def least_clearance(
    scene: Scene, fleet: Fleet, walk: Walk, start: Array, end: Array, driven: Array, dt: float, radius: float
) -> float:
    """Least clearance [m] of the rim on the way from `start` to `end`; a closer look where the step could matter."""
    least = _clear(scene, fleet, walk.new, end[0], end[1]) - radius
    way = 0.0
    for k in range(walk.old.shape[0]):
        way = max(way, np.hypot(walk.new[k, 0] - walk.old[k, 0], walk.new[k, 1] - walk.old[k, 1]))
    if least > abs(driven[0]) * dt + way + NEAR:
        return least
    for share in SHARES:
        x, y, _ = arc(start[0], start[1], start[2], driven[0], driven[1], share * dt)
        movers = between(fleet, walk.old, walk.new, walk.before, walk.after, share)
        least = min(least, _clear(scene, fleet, movers, x, y) - radius)
    return least


def _warm() -> None:
    """Compile for the types that a World hands over: all arrays of a scene are read-only."""
    none, zero, one, count = np.empty((0, 0)), np.zeros((1, 2)), np.ones(1), np.ones(1, dtype=np.int64)
    ground = np.array([(1.0, 0.0, 0.0, 0.0, 3.0, 0.0, 3.0)], dtype=GROUND)
    shapes = np.empty((0, 3)), np.empty((0, 5))
    scene = Scene(none.astype(np.bool_), none.copy(), none.astype(np.uint8), ground, *shapes)
    for array in scene:
        array.flags.writeable = False
    way, frames = np.array([[[0.0, 0.0], [1.0, 0.0]]]), np.array([[[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]])
    fleet = Fleet(count, one, zero, one, way, frames, count + 1, one, one)
    walk = Walk(zero, zero, np.zeros(1), np.zeros(1))
    least_clearance(scene, fleet, walk, np.zeros(3), np.zeros(3), np.zeros(2), 0.1, 0.3)
