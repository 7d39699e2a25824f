"""Compiled: when the robot on its arc first touches a point that moves at a constant velocity.

Everything happens in the body frame at time 0, as in `dwa.contact`. Robot and point may both move, so contact is found
in time, by steps that are surely free. For a disc: within h [s] the way of the point past the robot leaves a straight
line by at most A h^2/2, where A bounds the robot's acceleration, so what stays that much further away than the radius
on the straight line stays free. A straight line has A = 0 and its contact is a root of a quadratic.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from fuzzynav.geometry import Array
from fuzzynav.robot.kernels import arc

__all__ = ["Moving", "moving_contact", "moving_end", "near_moving"]

TOUCHING = 1e-6  # [m] nearer than this is contact
SHARE = 0.1  # of the gap that one step leaves for the bend of the way
MOST_STEPS = 200  # after so many the time that is surely free counts as contact


class Moving(NamedTuple):
    """Points that move, in the body frame, and discs around neighbours of one velocity: who misses a disc misses all.

    Rows of both begin with x, y, velocity and the radius at which the robot's centre touches.
    """

    rows: Array  # (n, 5)
    groups: Array  # (m, 7), then the first row of the group and the first that belongs to it no more


@njit(cache=True)
def near_moving(
    pose: Array, points: Array, drift: Array, radius: float, way: float, horizon: float
) -> tuple[Array, Moving, float]:
    """Points that stand; those that a disc may meet within `horizon` [s] and `way` [m]; how near [m] these are.

    The disc is the robot, or holds its footprint.
    """
    c, s = np.cos(pose[2]), np.sin(pose[2])
    still, rows = np.empty_like(points), np.empty((points.shape[0], 5))
    n = k = 0
    nearest = np.inf
    for i in range(points.shape[0]):
        ux, uy = drift[i, 0], drift[i, 1]
        if ux == 0.0 and uy == 0.0:
            still[n] = points[i]
            n += 1
            continue
        dx, dy = points[i, 0] - pose[0], points[i, 1] - pose[1]
        gap = np.sqrt(dx * dx + dy * dy) - radius
        nearest = min(nearest, gap)
        if gap <= way + np.sqrt(ux * ux + uy * uy) * horizon:
            rows[k, 0], rows[k, 1] = c * dx + s * dy, c * dy - s * dx
            rows[k, 2], rows[k, 3], rows[k, 4] = c * ux + s * uy, c * uy - s * ux, radius
            k += 1
    return still[:n], Moving(rows[:k], _groups(rows[:k])), nearest


@njit(cache=True)
def _groups(rows: Array) -> Array:
    """Discs around runs of rows that have one velocity."""
    out, count, i = np.empty((rows.shape[0], 7)), 0, 0
    while i < rows.shape[0]:
        j = i + 1
        while j < rows.shape[0] and rows[j, 2] == rows[i, 2] and rows[j, 3] == rows[i, 3]:
            j += 1
        x, y, wide = rows[i:j, 0].mean(), rows[i:j, 1].mean(), 0.0
        for k in range(i, j):
            wide = max(wide, np.hypot(rows[k, 0] - x, rows[k, 1] - y) + rows[k, 4])
        out[count, 0], out[count, 1], out[count, 2], out[count, 3] = x, y, rows[i, 2], rows[i, 3]
        out[count, 4], out[count, 5], out[count, 6] = wide + TOUCHING, i, j
        count, i = count + 1, j
    return out[:count]


@njit(cache=True)
def _clock(t: float, v: float, hold: float, loss: float) -> tuple[float, float]:
    """Time [s] at full speed that leads as far as t, braking after `hold`; and the share of the speed that is left."""
    if t <= hold or loss <= 0.0:
        return t, 1.0
    late = min(t - hold, abs(v) / loss)
    return hold + late - 0.5 * loss * late * late / abs(v), 1.0 - loss * late / abs(v)


@njit(cache=True)
def _meets(x: float, y: float, wx: float, wy: float, size: float) -> float:
    """Time [s] until a point at (x, y) with velocity w enters the circle of radius `size`; inf if never."""
    inward, power, square = -(x * wx + y * wy), x * x + y * y - size * size, wx * wx + wy * wy
    if power <= 0.0:
        return 0.0
    d = inward * inward - square * power
    return power / (inward + np.sqrt(d)) if inward > 0.0 and d >= 0.0 else np.inf


@njit(cache=True)
def _disc_time(
    v: float, omega: float, row: Array, size: float, hold: float, loss: float, start: float, until: float
) -> float:
    """`moving_contact` with one point, when it first comes within `size` [m] of the robot's centre after `start`."""
    ux, uy, t, bend = row[2], row[3], start, abs(v * omega) + loss
    if np.sqrt(row[0] * row[0] + row[1] * row[1]) - size > (abs(v) + np.sqrt(ux * ux + uy * uy)) * until:
        return np.inf
    for _ in range(MOST_STEPS):
        full, share = _clock(t, v, hold, loss)
        cx, cy, turn = arc(0.0, 0.0, 0.0, v, omega, full)
        x, y = row[0] + ux * t - cx, row[1] + uy * t - cy
        wx, wy = ux - share * v * np.cos(turn), uy - share * v * np.sin(turn)
        gap, left = np.sqrt(x * x + y * y) - size, until - t
        if gap <= TOUCHING:
            return t
        rise = 0.5 * bend * left * left
        step = 0.0
        if rise < gap:
            step = _meets(x, y, wx, wy, size + rise)
            if step >= left:
                return np.inf
        if bend > 0.0:
            short = min(np.sqrt(2.0 * SHARE * gap / bend), left)
            step = max(step, min(_meets(x, y, wx, wy, size + 0.5 * bend * short * short), short))
        t += step
        if t >= until:
            return np.inf
    return t


@njit(cache=True)
def _outside(x: float, y: float, corners: Array) -> float:
    """Distance [m] from a point to a convex polygon, 0 inside."""
    n, best, inside = corners.shape[0], np.inf, True
    for k in range(n):
        ax, ay = corners[k, 0], corners[k, 1]
        ex, ey = corners[(k + 1) % n, 0] - ax, corners[(k + 1) % n, 1] - ay
        px, py = x - ax, y - ay
        inside = inside and ex * py - ey * px >= 0.0
        u = min(max((px * ex + py * ey) / (ex * ex + ey * ey), 0.0), 1.0)
        best = min(best, np.sqrt((px - u * ex) ** 2 + (py - u * ey) ** 2))
    return 0.0 if inside else best


@njit(cache=True)
def _polygon_time(
    v: float, omega: float, row: Array, corners: Array, hold: float, loss: float, until: float, more: float
) -> float:
    """`moving_contact` of a footprint with one point: steps by the gap over the greatest speed of approach."""
    reach = 0.0
    for k in range(corners.shape[0]):
        reach = max(reach, np.hypot(corners[k, 0], corners[k, 1]))
    fastest = abs(v) + abs(omega) * reach + np.hypot(row[2], row[3])
    more = min(more, max(_outside(row[0], row[1], corners) - 2.0 * TOUCHING, 0.0))
    t = 0.0
    for _ in range(MOST_STEPS):
        full, _ = _clock(t, v, hold, loss)
        cx, cy, turn = arc(0.0, 0.0, 0.0, v, omega, full)
        x, y, c, s = row[0] + row[2] * t - cx, row[1] + row[3] * t - cy, np.cos(turn), np.sin(turn)
        gap = _outside(c * x + s * y, c * y - s * x, corners) - more
        if gap <= TOUCHING:
            return t
        t += gap / fastest
        if t >= until:
            return np.inf
    return t


@njit(cache=True)
def moving_contact(
    v: float, omega: float, moving: Moving, corners: Array, hold: float, loss: float, until: float, more: float
) -> float:
    """Time [s] of the first contact, before `until`, with the points that move; inf if there is none.

    Of a robot that brakes it is the time of some contact.

    moving as from `near_moving`; corners of the footprint, none for the disc. The robot drives v and omega for `hold`
    [s] (inf: for ever), then brakes on its arc by `loss` [m/s^2]. `more` [m] is kept free around it; to a point that is
    nearer already, the gap that there is.
    """
    first, (rows, groups) = until, moving
    for g in range(groups.shape[0]):
        low, high = int(groups[g, 5]), int(groups[g, 6])
        start = 0.0
        if high > low + 1:
            start = _disc_time(v, omega, groups[g], groups[g, 4] + more, hold, loss, 0.0, first)
        if start >= first:
            continue
        for i in range(low, high):
            if corners.shape[0]:
                time = _polygon_time(v, omega, rows[i], corners, hold, loss, first, more)
            else:
                gap = np.sqrt(rows[i, 0] * rows[i, 0] + rows[i, 1] * rows[i, 1]) - rows[i, 4]
                size = rows[i, 4] + min(more, max(gap - 2.0 * TOUCHING, 0.0))
                time = _disc_time(v, omega, rows[i], size, hold, loss, start, first)
            first = min(first, time)
            if first == 0.0 or (first < until and loss > 0.0):
                return first
    return first if first < until else np.inf


@njit(cache=True)
def moving_end(v: float, omega: float, moving: Moving, time: float) -> float:
    """Clearance [m] to the points that move at the end of the predicted arc, when they are there."""
    x, y, _ = arc(0.0, 0.0, 0.0, v, omega, time)
    best, rows = np.inf, moving.rows
    for i in range(rows.shape[0]):
        dx, dy = rows[i, 0] + rows[i, 2] * time - x, rows[i, 1] + rows[i, 3] * time - y
        best = min(best, np.sqrt(dx * dx + dy * dy) - rows[i, 4])
    return max(best, 0.0)


def _warm() -> None:
    """Compile every kernel for the types used in practice."""
    points = np.array([[2.0, 1.0]])
    _, moving, _ = near_moving(np.zeros(3), points, points, 0.3, 3.0, 3.0)
    for corners in (np.empty((0, 2)), np.array([[0.2, -0.2], [0.2, 0.2], [-0.2, 0.0]])):
        moving_contact(1.0, 0.1, moving, corners, np.inf, 0.0, 3.0, 0.0)
    moving_end(1.0, 0.1, moving, 3.0)
