"""Compiled: when the robot on its arc first touches a point that moves at a constant velocity.

Everything happens in the body frame at time 0, as in `dwa.contact`. Robot and point may both move, so contact is found
in time, by steps that are surely free. For a disc: within h [s] the way of the point past the robot leaves a straight
line by at most A h^2/2, where A bounds the robot's acceleration, so what stays that much further away than the radius
on the straight line stays free. A straight line has A = 0 and its contact is a root of a quadratic.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fuzzynav.geometry import Array
from fuzzynav.robot.kernels import arc

__all__ = ["moving_contact", "moving_end", "near_moving"]

TOUCHING = 1e-6  # [m] nearer than this is contact
SHARE = 0.1  # of the gap that one step leaves for the bend of the way
MOST_STEPS = 200  # after so many the time that is surely free counts as contact


@njit(cache=True)
def near_moving(
    pose: Array, points: Array, drift: Array, radius: float, way: float, horizon: float
) -> tuple[Array, Array, float]:
    """Points that stand, rows of those that a disc may meet within `horizon` [s] and `way` [m], how near they are.

    Rows are x, y, velocity in the body frame and the radius [m]; the last is the distance [m] from the rim to the
    nearest point that moves.
    """
    c, s = np.cos(pose[2]), np.sin(pose[2])
    still, moving = np.empty_like(points), np.empty((points.shape[0], 5))
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
            moving[k, 0], moving[k, 1] = c * dx + s * dy, c * dy - s * dx
            moving[k, 2], moving[k, 3], moving[k, 4] = c * ux + s * uy, c * uy - s * ux, radius
            k += 1
    return still[:n], moving[:k], nearest


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
def _disc_time(v: float, omega: float, row: Array, hold: float, loss: float, until: float, more: float) -> float:
    """`moving_contact` of a disc with one point."""
    ux, uy, t, bend = row[2], row[3], 0.0, abs(v * omega) + loss
    x, y, wx, wy = row[0], row[1], row[2] - v, row[3]
    away = np.sqrt(x * x + y * y)
    size = row[4] + min(more, max(away - row[4] - 2.0 * TOUCHING, 0.0))
    for _ in range(MOST_STEPS):
        gap, left = away - size, until - t
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
        full, share = _clock(t, v, hold, loss)
        cx, cy, turn = arc(0.0, 0.0, 0.0, v, omega, full)
        x, y = row[0] + ux * t - cx, row[1] + uy * t - cy
        wx, wy = ux - share * v * np.cos(turn), uy - share * v * np.sin(turn)
        away = np.sqrt(x * x + y * y)
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
    v: float, omega: float, moving: Array, corners: Array, hold: float, loss: float, until: float, more: float
) -> float:
    """Time [s] of the first contact, before `until`, with the points that move; inf if there is none.

    moving as from `near_moving`; corners of the footprint, none for the disc. The robot drives v and omega for `hold`
    [s] (inf: for ever), then brakes on its arc by `loss` [m/s^2]. `more` [m] is kept free around it; to a point that is
    nearer already, the gap that there is.
    """
    first = until
    for i in range(moving.shape[0]):
        if corners.shape[0]:
            first = min(first, _polygon_time(v, omega, moving[i], corners, hold, loss, first, more))
        else:
            first = min(first, _disc_time(v, omega, moving[i], hold, loss, first, more))
        if first == 0.0:
            break
    return first if first < until else np.inf


@njit(cache=True)
def moving_end(v: float, omega: float, moving: Array, time: float) -> float:
    """Clearance [m] to the points that move at the end of the predicted arc, when they are there."""
    x, y, _ = arc(0.0, 0.0, 0.0, v, omega, time)
    best = np.inf
    for i in range(moving.shape[0]):
        dx, dy = moving[i, 0] + moving[i, 2] * time - x, moving[i, 1] + moving[i, 3] * time - y
        best = min(best, np.sqrt(dx * dx + dy * dy) - moving[i, 4])
    return max(best, 0.0)


def _warm() -> None:
    """Compile every kernel for the types used in practice."""
    points = np.array([[2.0, 1.0]])
    _, moving, _ = near_moving(np.zeros(3), points, points, 0.3, 3.0, 3.0)
    for corners in (np.empty((0, 2)), np.array([[0.2, -0.2], [0.2, 0.2], [-0.2, 0.0]])):
        moving_contact(1.0, 0.1, moving, corners, np.inf, 0.0, 3.0, 0.0)
    moving_end(1.0, 0.1, moving, 3.0)
