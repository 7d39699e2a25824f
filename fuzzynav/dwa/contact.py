"""Compiled loops of the dynamic window: where along an arc the robot first touches something.

Everything happens in the body frame: the robot starts at the origin and looks along x. Obstacles come as points with
a radius of their own, or as a field of distances.
"""

# mypy: disallow_untyped_defs = False
from __future__ import annotations

import numpy as np
from numba import njit

__all__: list[str] = []

STILL = 1e-9  # [m/s] slower than this is standing
SEAM = 0.05  # [m] between two points of the border of what was seen


@njit(cache=True)
def _near(pose, points, radii, radius, reach):
    """Points within reach of the disc in the body frame: x, y and power x^2 + y^2 - (radius + own radius)^2."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    out = np.empty((points.shape[0], 3))
    k = 0
    nearest = np.inf
    for i in range(points.shape[0]):
        dx, dy = points[i, 0] - pose[0], points[i, 1] - pose[1]
        own = radius + radii[i]
        squared = dx * dx + dy * dy
        nearest = min(nearest, np.sqrt(squared) - own)
        far = own + reach
        if squared <= far * far:
            out[k, 0], out[k, 1], out[k, 2] = c * dx + s * dy, c * dy - s * dx, squared - own * own
            k += 1
    return out[:k], nearest


@njit(cache=True)
def _arc_contact(v, omega, near):
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
        power = near[i, 2]
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
        return 2.0 * first if abs(bend * first) < 1e-9 else 2.0 * np.arctan(abs(bend) * first) / abs(bend)
    if late < 0.0 and bend != 0.0:
        return 2.0 * (np.pi + np.arctan(abs(bend) * late)) / abs(bend)
    return np.inf


@njit(cache=True)
def _arc_pose(v, omega, t):
    """Body-frame pose after driving (v, omega) for t along the exact arc."""
    half = 0.5 * omega * t
    chord = v * t * (np.sin(half) / half if abs(half) > 1e-9 else 1.0)
    return chord * np.cos(half), chord * np.sin(half), 2.0 * half


@njit(cache=True)
def _field_at(x, y, field, resolution, x0, y0):
    """A lower bound of the clearance [m] at a point: the value of its cell less the way to the cell's centre."""
    rows, cols = field.shape
    i, j = int(np.floor((x - x0) / resolution)), int(np.floor((y - y0) / resolution))
    if i < 0 or j < 0 or i >= cols or j >= rows:
        return 0.0
    dx, dy = x - x0 - (i + 0.5) * resolution, y - y0 - (j + 0.5) * resolution
    return field[j, i] - np.sqrt(dx * dx + dy * dy)


@njit(cache=True)
def _field_contact(v, omega, pose, field, frame, radius, reach):
    """Distance [m] along the arc that is surely free in a distance field; marches by the clearance itself."""
    if abs(v) <= STILL:
        return np.inf
    c, s = np.cos(pose[2]), np.sin(pose[2])
    travelled = 0.0
    while travelled < reach:
        x, y, _ = _arc_pose(v, omega, travelled / abs(v))
        free = _field_at(pose[0] + c * x - s * y, pose[1] + s * x + c * y, field, frame[0], frame[1], frame[2]) - radius
        if free < 1e-4:
            return travelled
        travelled += free
        if abs(omega) * travelled > 2.0 * np.pi * abs(v):
            return np.inf
    return np.inf


@njit(cache=True)
def _polygon_contact(v, omega, near, corners):
    """Travel until a corner-cornered footprint first touches a point: [m] along the arc, or [rad] when v = 0.

    Seen from the robot every point moves on a circle about the centre of turning, the other way round.
    """
    still = abs(v) <= STILL
    if still and omega == 0.0:
        return np.inf
    first = np.inf
    n = corners.shape[0]
    for i in range(near.shape[0]):
        px, py = near[i, 0], near[i, 1]
        inside = True
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
        if inside:
            return 0.0
    return first


@njit(cache=True)
def _line_edge(px, py, direction, ax, ay, bx, by):
    """Way along x until the point meets the edge a-b; inf if never."""
    if (ay - py) * (by - py) > 0.0 or ay == by:
        return np.inf
    x = ax + (bx - ax) * (py - ay) / (by - ay)
    way = (x - px) * direction
    return way if way >= 0.0 else np.inf


@njit(cache=True)
def _circle_edge(px, py, ax, ay, bx, by, direction):
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
def _end_clearance(v, omega, near, field, frame, pose, radius, sim_time):
    """Clearance [m] at the end of the predicted arc, as the thesis prints it."""
    x, y, _ = _arc_pose(v, omega, sim_time)
    best = np.inf
    if field.size:
        c, s = np.cos(pose[2]), np.sin(pose[2])
        wx, wy = pose[0] + c * x - s * y, pose[1] + s * x + c * y
        best = _field_at(wx, wy, field, frame[0], frame[1], frame[2]) - radius
    for i in range(near.shape[0]):
        dx, dy = near[i, 0] - x, near[i, 1] - y
        own = np.sqrt(max(near[i, 0] ** 2 + near[i, 1] ** 2 - near[i, 2], 0.0))
        best = min(best, np.sqrt(dx * dx + dy * dy) - own)
    return max(best, 0.0)


@njit(cache=True)
def _blind(ranges, angles, pose, range_max, full_circle):
    """Border of what the beams have crossed: points (n, 2) with radii (n,) that cover it.

    Between two neighbouring beams whatever is convex, has no corner under 90 degrees and is wider than the gap shows
    itself within one gap of a hit: every beam's end therefore takes the gap for its radius. A jump in range is a line
    of sight past an edge; behind it nothing is known, so points are strewn along it.
    """
    m = ranges.size
    ends, bearings = np.empty(m), np.empty(m)
    k = 0
    for i in range(m):
        if not np.isnan(ranges[i]):
            ends[k], bearings[k] = min(max(ranges[i], 0.0), range_max), pose[2] + angles[i]
            k += 1
    gaps = np.zeros(k)  # [rad] from each beam to the next
    for i in range(k):
        gaps[i] = (bearings[i + 1 if i + 1 < k else 0] - bearings[i]) % (2.0 * np.pi)
    if k > 0 and not full_circle:
        gaps[k - 1] = 0.0
    out, radii = np.empty((64 + 2 * k, 2)), np.empty(64 + 2 * k)
    size = 0
    for i in range(k):
        j = i + 1 if i + 1 < k else 0
        ax, ay = ends[i] * np.cos(bearings[i]), ends[i] * np.sin(bearings[i])
        bx, by = ends[j] * np.cos(bearings[j]), ends[j] * np.sin(bearings[j])
        way = np.sqrt((bx - ax) ** 2 + (by - ay) ** 2) if gaps[i] > 0.0 else 0.0
        parts = max(int(np.ceil(way / SEAM)), 1) if way > 1.5 * max(ends[i], ends[j]) * gaps[i] else 1
        while size + parts > radii.size:
            out = np.concatenate((out, np.empty_like(out)))
            radii = np.concatenate((radii, np.empty_like(radii)))
        for p in range(parts):
            u = p / parts
            out[size, 0], out[size, 1] = pose[0] + ax + u * (bx - ax), pose[1] + ay + u * (by - ay)
            radii[size] = (
                ends[i] * max(gaps[i], gaps[i - 1]) if p == 0 else max(gaps[i] * min(ends[i], ends[j]), 0.5 * SEAM)
            )
            size += 1
    return out[:size], radii[:size]


def _warm() -> None:
    """Compile every kernel for the types used in practice."""
    pose = np.zeros(3)
    points, radii = _blind(np.array([2.0, np.nan, 1.0]), np.array([-1.0, 0.0, 1.0]), pose, 5.0, True)
    near, _ = _near(pose, points, radii, 0.3, 9.0)
    corners = np.array([[0.2, -0.2], [0.2, 0.2], [-0.2, 0.0]])
    field, frame = np.full((2, 2), 5.0), np.array([1.0, 0.0, 0.0])
    _arc_contact(1.0, 0.1, near)
    _polygon_contact(1.0, 0.1, near, corners)
    _field_contact(1.0, 0.1, pose, field, frame, 0.3, 2.0)
    _end_clearance(1.0, 0.1, near, field, frame, pose, 0.3, 3.0)
