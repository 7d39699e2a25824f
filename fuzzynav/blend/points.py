"""Obstacle points as compiled steps: what a scan of a block gives, what is remembered of it, how near it is.

Points are rows x, y, vx, vy of an array (n, 4) in the world frame.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fuzzynav.geometry import Array
from fuzzynav.robot.kernels import clip, wrap
from fuzzynav.world.kernels import rectangle_hits, spacing

__all__ = ["MEMORY", "closest", "gap", "nearest_on", "remember", "sight"]

MEMORY = 512  # points that are remembered at most
THIN = 0.02  # [m] points nearer to one another are one
BEHIND = 0.05  # [m] a beam that ends so far behind a point has passed through it
BESIDE = 0.03  # [rad] a beam further aside says nothing of a point


@njit(cache=True)
def nearest_on(block: Array, x: float, y: float, out: Array) -> float:
    """Nearest point of a rectangle x, y, width, height, theta; the signed distance to its edge is returned."""
    x0, y0, wide, high = block[0], block[1], 0.5 * block[2], 0.5 * block[3]
    c, s = np.cos(block[4]), np.sin(block[4])
    u, v = c * (x - x0) + s * (y - y0), c * (y - y0) - s * (x - x0)
    a, b = clip(u, -wide, wide), clip(v, -high, high)
    out[0], out[1], out[2], out[3] = x0 + c * a - s * b, y0 + s * a + c * b, 0.0, 0.0
    across, up = abs(u) - wide, abs(v) - high
    return float(np.hypot(max(across, 0.0), max(up, 0.0)) + min(max(across, up), 0.0))


@njit(cache=True)
def closest(points: Array, pose: Array) -> tuple[float, float]:
    """Distance from the robot's centre to the nearest point, and its bearing; inf and 0 without points."""
    best, at = np.inf, -1
    for i in range(points.shape[0]):
        d = (points[i, 0] - pose[0]) ** 2 + (points[i, 1] - pose[1]) ** 2
        if d < best:
            best, at = d, i
    if at < 0:
        return np.inf, 0.0
    return np.sqrt(best), wrap(np.arctan2(points[at, 1] - pose[1], points[at, 0] - pose[0]) - pose[2])


@njit(cache=True)
def gap(points: Array, x: float, y: float, t: float) -> float:
    """Distance [m] from a place to the nearest point, t seconds from now."""
    best = np.inf
    for i in range(points.shape[0]):
        dx, dy = points[i, 0] + t * points[i, 2] - x, points[i, 1] + t * points[i, 3] - y
        best = min(best, dx * dx + dy * dy)
    return float(np.sqrt(best))


@njit(cache=True)
def remember(memory: Array, count: int, seen: Array, pose: Array, reach: float, moving: bool) -> int:
    """Points remembered after this scan: those that a beam now passes through go, new ones come."""
    kept = 0
    bearings, ranges = np.empty(seen.shape[0]), np.empty(seen.shape[0])
    for j in range(seen.shape[0]):
        dx, dy = seen[j, 0] - pose[0], seen[j, 1] - pose[1]
        bearings[j], ranges[j] = np.arctan2(dy, dx), np.hypot(dx, dy)
    for i in range(0 if moving else count):
        dx, dy = memory[i, 0] - pose[0], memory[i, 1] - pose[1]
        r, b = np.hypot(dx, dy), np.arctan2(dy, dx)
        stays = r > reach - BEHIND
        for j in range(seen.shape[0]):
            if stays:
                break
            stays = ranges[j] < r + BEHIND and abs(wrap(bearings[j] - b)) < BESIDE
        if stays:
            memory[kept] = memory[i]
            kept += 1
    for j in range(seen.shape[0]):
        new = kept < memory.shape[0]
        for i in range(kept):
            if abs(memory[i, 0] - seen[j, 0]) < THIN and abs(memory[i, 1] - seen[j, 1]) < THIN:
                new = False
                break
        if new:
            memory[kept] = seen[j]
            kept += 1
    return kept


@njit(cache=True)
def sight(block: Array, pose: Array, angles: Array, reach: float) -> Array:
    """Points (n, 4) of a resting rectangle that beams of one scan meet."""
    if np.hypot(block[0] - pose[0], block[1] - pose[1]) > reach + 0.5 * np.hypot(block[2], block[3]):
        return np.empty((0, 4))
    beams = np.empty((3, angles.shape[0]))
    beams[0] = pose[2] + angles
    beams[1], beams[2] = np.cos(beams[0]), np.sin(beams[0])
    ranges = np.full(angles.shape[0], reach)
    rectangle_hits(block.reshape(1, 5), pose[0], pose[1], beams, spacing(angles), ranges)
    out, n = np.zeros((angles.shape[0], 4)), 0
    for i in range(angles.shape[0]):
        if ranges[i] < reach:
            out[n, 0], out[n, 1] = pose[0] + ranges[i] * beams[1, i], pose[1] + ranges[i] * beams[2, i]
            n += 1
    return out[:n]


def _warm() -> None:
    """Compile with the types used in practice."""
    block, pose, out = np.array([1.0, 0.0, 0.2, 0.3, 0.0]), np.zeros(3), np.empty(4)
    points = sight(block, pose, np.linspace(-1.0, 1.0, 9), 2.0)
    memory = np.empty((MEMORY, 4))
    n = remember(memory, 0, points, pose, 2.0, False)
    nearest_on(block, 0.0, 0.0, out)
    closest(memory[:n], pose)
    gap(memory[:n], 0.0, 0.0, 0.0)
