"""Compiled: where along an arc the robot first touches something.

Everything happens in the body frame: the robot starts at the origin and looks along x. Obstacles come as points with
a radius of their own, or as a field of distances.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from fuzzynav.geometry import Array
from fuzzynav.robot.kernels import arc

__all__ = [
    "STILL", "Chart", "arc_contact", "end_clearance", "field_at", "field_contact", "grown", "near_points",
    "polygon_contact",
]  # fmt: skip

STILL = 1e-9  # [m/s] slower than this is standing
TOUCHING = 1e-4  # [m] a clearance in a field that counts as contact


class Chart(NamedTuple):
    """A field of distances [m] from cell centres to the nearest obstacle; without values there is none."""

    values: Array  # [row, col]
    resolution: float  # [m]
    x: float  # [m] of its lower left corner
    y: float


@njit(cache=True)
def near_points(pose: Array, points: Array, radii: Array, radius: float, reach: float) -> tuple[Array, float]:
    """Points within reach of a disc, in the body frame, and the distance [m] from its rim to the nearest point.

    Rows are x, y, own radius and the power x^2 + y^2 - (radius + own radius)^2.
    """
    c, s = np.cos(pose[2]), np.sin(pose[2])
    out = np.empty((points.shape[0], 4))
    k = 0
    nearest = np.inf
    for i in range(points.shape[0]):
        dx, dy = points[i, 0] - pose[0], points[i, 1] - pose[1]
        own = radius + radii[i]
        squared = dx * dx + dy * dy
        nearest = min(nearest, np.sqrt(squared) - own)
        far = own + reach
        if squared <= far * far:
            out[k, 0], out[k, 1], out[k, 2] = c * dx + s * dy, c * dy - s * dx, radii[i]
            out[k, 3] = squared - own * own
            k += 1
    return out[:k], nearest


@njit(cache=True)
def arc_contact(v: float, omega: float, near: Array) -> float:
    """Distance [m] along the arc at which the disc first touches one of the points; inf if it never does.

    With w = tan(turn/2)/curvature the contact is a root of a w^2 - 2 x w + power/2 = 0, where a = 2 (1 - curvature y)
    + power curvature^2/2: no angle is needed for a point, and straight lines are no special case.
    """
    if abs(v) <= STILL:
        return np.inf
    forward = 1.0 if v > 0.0 else -1.0
    bend = omega / v
    first, late = np.inf, 0.0
    for i in range(near.shape[0]):
        power = near[i, 3]
        if power <= 0.0:
            return 0.0
        x = forward * near[i, 0]
        a = 2.0 - 2.0 * bend * near[i, 1] + 0.5 * power * bend * bend
        d = x * x - 0.5 * a * power
        if d < 0.0:
            continue
        root = np.sqrt(d)
        if x + root > 0.0:
            first = min(first, 0.5 * power / (x + root))
        elif a > 0.0:
            late = min(late, (x - root) / a)
    if first < np.inf:
        return 2.0 * first if abs(bend * first) < 1e-9 else 2.0 * float(np.arctan(abs(bend) * first)) / abs(bend)
    if late < 0.0 and bend != 0.0:
        return 2.0 * (np.pi + float(np.arctan(abs(bend) * late))) / abs(bend)
    return np.inf


@njit(cache=True)
def field_at(x: float, y: float, chart: Chart) -> float:
    """A lower bound of the clearance [m] at a point: the value of its cell less the way to the cell's centre.

    0 outside the field, nan where the field holds nan.
    """
    rows, cols = chart.values.shape
    i, j = int(np.floor((x - chart.x) / chart.resolution)), int(np.floor((y - chart.y) / chart.resolution))
    if i < 0 or j < 0 or i >= cols or j >= rows:
        return 0.0
    dx, dy = x - chart.x - (i + 0.5) * chart.resolution, y - chart.y - (j + 0.5) * chart.resolution
    return float(chart.values[j, i] - np.sqrt(dx * dx + dy * dy))


@njit(cache=True)
def field_contact(v: float, omega: float, pose: Array, chart: Chart, radius: float, reach: float) -> tuple[float, bool]:
    """Distance [m] along the arc that is surely free in a distance field, and whether it ends where the field is nan.

    It marches by the clearance itself; inf beyond `reach` and after a whole circle.
    """
    if abs(v) <= STILL:
        return np.inf, False
    c, s = np.cos(pose[2]), np.sin(pose[2])
    travelled = 0.0
    while travelled < reach:
        x, y, _ = arc(0.0, 0.0, 0.0, v, omega, travelled / abs(v))
        free = field_at(pose[0] + c * x - s * y, pose[1] + s * x + c * y, chart) - radius
        if np.isnan(free):
            return travelled, True
        if free < TOUCHING:
            return travelled, False
        travelled += free
        if abs(omega) * travelled > 2.0 * np.pi * abs(v):
            return np.inf, False
    return np.inf, False


@njit(cache=True)
def polygon_contact(v: float, omega: float, near: Array, corners: Array) -> float:
    """Travel until a corner-cornered footprint first touches a point: [m] along the arc, or [rad] when v = 0.

    Seen from the robot every point moves on a circle about the centre of turning, the other way round. A point with a
    radius of its own meets the footprint grown by it.
    """
    if abs(v) <= STILL and omega == 0.0:
        return np.inf
    first, shape, size = np.inf, corners, 0.0
    for i in range(near.shape[0]):
        if near[i, 2] != size:
            size = near[i, 2]
            shape = grown(corners, size)
        first = min(first, _point_contact(v, omega, near[i, 0], near[i, 1], shape))
        if first == 0.0:
            break
    return first


@njit(cache=True)
def _point_contact(v: float, omega: float, px: float, py: float, corners: Array) -> float:
    """`polygon_contact` with one point."""
    still, inside, first = abs(v) <= STILL, True, np.inf
    n = corners.shape[0]
    for k in range(n):
        ax, ay = corners[k, 0], corners[k, 1]
        bx, by = corners[(k + 1) % n, 0], corners[(k + 1) % n, 1]
        if (bx - ax) * (py - ay) - (by - ay) * (px - ax) < 0.0:
            inside = False
        if not still and abs(omega) < 1e-9 * abs(v):
            first = min(first, _line_edge(px, py, -np.sign(v), ax, ay, bx, by))
        else:
            centre = 0.0 if still else v / omega
            turn = _circle_edge(px, py - centre, ax, ay - centre, bx, by - centre, -np.sign(omega))
            first = min(first, turn if still else turn * abs(centre))
    return 0.0 if inside else first


@njit(cache=True)
def grown(corners: Array, size: float) -> Array:
    """The convex polygon with every edge moved out by `size` [m]: it holds whatever is no further away than that."""
    n = corners.shape[0]
    out = np.empty_like(corners)
    for k in range(n):
        ax, ay = corners[k, 0] - corners[k - 1, 0], corners[k, 1] - corners[k - 1, 1]
        bx, by = corners[(k + 1) % n, 0] - corners[k, 0], corners[(k + 1) % n, 1] - corners[k, 1]
        a, b = np.sqrt(ax * ax + ay * ay), np.sqrt(bx * bx + by * by)
        sine, cosine = (ax * by - ay * bx) / (a * b), (ax * bx + ay * by) / (a * b)
        along = size * (1.0 - cosine) / sine  # from the foot of the moved corner to the corner
        out[k, 0] = corners[k, 0] + size * ay / a + along * ax / a
        out[k, 1] = corners[k, 1] - size * ax / a + along * ay / a
    return out


@njit(cache=True)
def _line_edge(px: float, py: float, direction: float, ax: float, ay: float, bx: float, by: float) -> float:
    """Way along x until the point meets the edge a-b; inf if never."""
    if (ay - py) * (by - py) > 0.0 or ay == by:
        return np.inf
    x = ax + (bx - ax) * (py - ay) / (by - ay)
    way = (x - px) * direction
    return way if way >= 0.0 else np.inf


@njit(cache=True)
def _circle_edge(px: float, py: float, ax: float, ay: float, bx: float, by: float, direction: float) -> float:
    """Angle the point turns about the origin, in `direction`, until it meets the edge a-b; inf if never."""
    squared = px * px + py * py
    ex, ey = bx - ax, by - ay
    a, b, c = ex * ex + ey * ey, ax * ex + ay * ey, ax * ax + ay * ay - squared
    d = b * b - a * c
    if d < 0.0 or a == 0.0:
        return np.inf
    best = np.inf
    start = np.arctan2(py, px)
    for sign in (-1.0, 1.0):
        u = (-b + sign * np.sqrt(d)) / a
        if 0.0 <= u <= 1.0:
            turn = direction * (np.arctan2(ay + u * ey, ax + u * ex) - start)
            best = min(best, turn % (2.0 * np.pi))
    return best


@njit(cache=True)
def end_clearance(
    v: float, omega: float, near: Array, pose: Array, chart: Chart, radius: float, sim_time: float
) -> float:
    """Clearance [m] at the end of the predicted arc, as the thesis prints it; 0 where the field is nan."""
    x, y, _ = arc(0.0, 0.0, 0.0, v, omega, sim_time)
    best = np.inf
    if chart.values.size:
        c, s = np.cos(pose[2]), np.sin(pose[2])
        best = field_at(pose[0] + c * x - s * y, pose[1] + s * x + c * y, chart) - radius
        if np.isnan(best):
            return 0.0
    for i in range(near.shape[0]):
        dx, dy = near[i, 0] - x, near[i, 1] - y
        own = np.sqrt(max(near[i, 0] ** 2 + near[i, 1] ** 2 - near[i, 3], 0.0))
        best = min(best, np.sqrt(dx * dx + dy * dy) - own)
    return max(best, 0.0)


def _warm() -> None:
    """Compile every kernel for the types used in practice."""
    pose = np.zeros(3)
    near, _ = near_points(pose, np.array([[2.0, 1.0]]), np.array([0.1]), 0.3, 9.0)
    chart = Chart(np.full((2, 2), 5.0), 1.0, 0.0, 0.0)
    arc_contact(1.0, 0.1, near)
    polygon_contact(1.0, 0.1, near, np.array([[0.2, -0.2], [0.2, 0.2], [-0.2, 0.0]]))
    field_contact(1.0, 0.1, pose, chart, 0.3, 2.0)
    end_clearance(1.0, 0.1, near, pose, chart, 0.3, 3.0)
