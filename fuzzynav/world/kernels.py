"""Compiled loops of the world: distances, rays, rasters and the steps of the movers.

A frame is resolution, x, y of a grid; an empty mask stands for no grid. Shapes are rows as in World.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fuzzynav.geometry import Array
from fuzzynav.maps.kernels import Bytes, Cells, Mask, distance_at, ray_length

__all__: list[str] = []


@njit(cache=True)
def _clearance(
    mask: Mask,
    field: Array,
    frame: Array,
    bounds: Array,
    discs: Array,
    rectangles: Array,
    movers: Array,
    points: Array,
) -> Array:
    """Distance [m] from points `(n, 2)` to the nearest surface."""
    out = np.empty(points.shape[0])
    cosine, sine = np.cos(rectangles[:, 4]), np.sin(rectangles[:, 4])
    for n in range(points.shape[0]):
        x, y = points[n, 0], points[n, 1]
        best = min(min(x - bounds[0], bounds[1] - x), min(y - bounds[2], bounds[3] - y))
        for k in range(discs.shape[0]):
            best = min(best, np.hypot(x - discs[k, 0], y - discs[k, 1]) - discs[k, 2])
        for k in range(movers.shape[0]):
            best = min(best, np.hypot(x - movers[k, 0], y - movers[k, 1]) - movers[k, 2])
        for k in range(rectangles.shape[0]):
            u, v = x - rectangles[k, 0], y - rectangles[k, 1]
            across = abs(cosine[k] * u + sine[k] * v) - 0.5 * rectangles[k, 2]
            up = abs(cosine[k] * v - sine[k] * u) - 0.5 * rectangles[k, 3]
            best = min(best, np.hypot(max(across, 0.0), max(up, 0.0)) + min(max(across, up), 0.0))
        if mask.shape[0] > 0 and best > 0.0:
            best = min(
                best, frame[0] * distance_at(mask, field, (x - frame[1]) / frame[0], (y - frame[2]) / frame[0], False)
            )
        out[n] = best
    return out


@njit(cache=True)
def _spacing(angles: Array) -> float:
    """Step [rad] of evenly rising angles that do not go round more than once; 0 for any others."""
    n = len(angles)
    step = (angles[n - 1] - angles[0]) / (n - 1) if n > 1 else 0.0
    if step <= 0.0 or step * (n - 1) > 2.0 * np.pi:
        return 0.0
    for k in range(n):
        if abs(angles[k] - angles[0] - k * step) > 0.01 * step:
            return 0.0
    return step


@njit(cache=True)
def _window(u: float, v: float, r: float, first: float, step: float, n: int) -> tuple[int, int, int]:
    """Beams that may meet a disc of radius r at (u, v) from the scanner: low .. high, and 0 .. second.

    `first` is the heading of beam 0, `step` as from `_spacing`. Errs by a beam to either side, never the other way.
    """
    away = np.hypot(u, v)
    if step == 0.0 or away <= r * (1.0 + 1e-9):
        return 0, n - 1, -1
    half = np.arcsin(r / away)
    begin = (np.arctan2(v, u) - half - first) % (2.0 * np.pi)
    low, high = int(begin / step) - 1, int((begin + 2.0 * half) / step) + 1
    second = int((begin + 2.0 * half - 2.0 * np.pi) / step) + 1 if begin + 2.0 * half + step >= 2.0 * np.pi else -1
    return max(low, 0), min(high, n - 1), min(second, low - 1, n - 1)


@njit(cache=True)
def _disc_hits(
    discs: Array,
    first_label: int,
    x: float,
    y: float,
    beams: Array,
    step: float,
    ranges: Array,
    labels: Cells,
) -> None:
    """Shorten the beams from (x, y) that meet a disc; `beams` (3, n) holds heading, cosine, sine.

    A first label of 0 or more numbers the discs; below 0 the label is -1.
    """
    count, reach = ranges.shape[0], ranges.max()
    for k in range(discs.shape[0]):
        u, v, r = discs[k, 0] - x, discs[k, 1] - y, discs[k, 2]
        away = u * u + v * v
        if away > (reach + r) * (reach + r):
            continue
        inside = away <= r * r
        label = first_label + k if first_label >= 0 else -1
        low, high, second = _window(u, v, r, beams[0, 0], step, count)
        for part in range(2):
            begin, end = (low, high) if part == 0 else (0, second)
            for n in range(begin, end + 1):
                aside = u * beams[2, n] - v * beams[1, n]
                if abs(aside) > r and not inside:
                    continue
                t = 0.0 if inside else u * beams[1, n] + v * beams[2, n] - np.sqrt(r * r - aside * aside)
                if 0.0 <= t < ranges[n]:
                    ranges[n], labels[n] = t, label


@njit(cache=True)
def _rectangle_hits(rectangles: Array, x: float, y: float, beams: Array, step: float, ranges: Array) -> None:
    """Shorten the beams from (x, y) that meet a rectangle; `beams` as for discs."""
    count, reach = ranges.shape[0], ranges.max()
    for k in range(rectangles.shape[0]):
        u, v = rectangles[k, 0] - x, rectangles[k, 1] - y
        half_x, half_y = 0.5 * rectangles[k, 2], 0.5 * rectangles[k, 3]
        around = np.hypot(half_x, half_y) * (1.0 + 1e-12)
        if u * u + v * v > (reach + around) * (reach + around):
            continue
        c, s = np.cos(rectangles[k, 4]), np.sin(rectangles[k, 4])
        px, py = -(c * u + s * v), -(c * v - s * u)
        low, high, second = _window(u, v, around, beams[0, 0], step, count)
        for part in range(2):
            begin, end = (low, high) if part == 0 else (0, second)
            for n in range(begin, end + 1):
                dx, dy = c * beams[1, n] + s * beams[2, n], c * beams[2, n] - s * beams[1, n]
                ranges[n] = _slabs(px, py, dx, dy, half_x, half_y, ranges[n])


@njit(cache=True)
def _slabs(px: float, py: float, dx: float, dy: float, half_x: float, half_y: float, reach: float) -> float:
    """Length of the ray from (px, py) along (dx, dy) to the rectangle about the origin; `reach` if it is further."""
    low, high = 0.0, reach
    if dx != 0.0:
        first, second = (-half_x - px) / dx, (half_x - px) / dx
        low, high = max(low, min(first, second)), min(high, max(first, second))
    elif abs(px) > half_x:
        return reach
    if dy != 0.0:
        first, second = (-half_y - py) / dy, (half_y - py) / dy
        low, high = max(low, min(first, second)), min(high, max(first, second))
    elif abs(py) > half_y:
        return reach
    return low if low <= high else reach


@njit(cache=True)
def _scan(
    mask: Mask,
    skip: Bytes,
    frame: Array,
    bounds: Array,
    discs: Array,
    rectangles: Array,
    movers: Array,
    poses: Array,
    angles: Array,
    range_max: float,
) -> tuple[Array, Cells]:
    """Ranges [m] `(m, n)` from poses `(m, 3)`, and the index of the mover each beam met or -1."""
    out = np.full((poses.shape[0], angles.shape[0]), range_max)
    labels = np.full((poses.shape[0], angles.shape[0]), -1, dtype=np.int64)
    if angles.shape[0] == 0:
        return out, labels
    step, beams = _spacing(angles), np.empty((3, angles.shape[0]))
    for m in range(poses.shape[0]):
        x, y = poses[m, 0], poses[m, 1]
        beams[0] = poses[m, 2] + angles
        beams[1], beams[2] = np.cos(beams[0]), np.sin(beams[0])
        _disc_hits(discs, -1, x, y, beams, step, out[m], labels[m])
        _rectangle_hits(rectangles, x, y, beams, step, out[m])
        _disc_hits(movers, 0, x, y, beams, step, out[m], labels[m])
        px, py = (x - frame[1]) / frame[0], (y - frame[2]) / frame[0]
        for n in range(angles.shape[0]):
            t = _to_wall(bounds, x, y, beams[1, n], beams[2, n])
            if mask.shape[0] > 0 and t > 0.0:
                reach = min(t, out[m, n]) / frame[0]
                t = min(t, frame[0] * ray_length(mask, skip, px, py, beams[1, n], beams[2, n], reach, False))
            if t < out[m, n]:
                out[m, n], labels[m, n] = t, -1
    return out, labels


@njit(cache=True)
def _to_wall(bounds: Array, x: float, y: float, dx: float, dy: float) -> float:
    """Length of the ray inside the bounds; 0 outside them."""
    if x < bounds[0] or x > bounds[1] or y < bounds[2] or y > bounds[3]:
        return 0.0
    t = np.inf
    if dx != 0.0:
        t = ((bounds[1] if dx > 0.0 else bounds[0]) - x) / dx
    if dy != 0.0:
        t = min(t, ((bounds[3] if dy > 0.0 else bounds[2]) - y) / dy)
    return max(t, 0.0)


@njit(cache=True)
def _overlaps(rectangle: Array, x: float, y: float, step: float) -> bool:
    """Whether a turned rectangle overlaps the square with centre (x, y) and side `step`, by separating axes."""
    c, s = np.cos(rectangle[4]), np.sin(rectangle[4])
    u, v = x - rectangle[0], y - rectangle[1]
    half, a, b = 0.5 * step - 1e-12, 0.5 * rectangle[2], 0.5 * rectangle[3]
    wide = abs(c) + abs(s)
    return (
        abs(u) < half + a * abs(c) + b * abs(s)
        and abs(v) < half + a * abs(s) + b * abs(c)
        and abs(c * u + s * v) < a + half * wide
        and abs(c * v - s * u) < b + half * wide
    )


@njit(cache=True)
def _raster(
    mask: Mask,
    frame: Array,
    target: Array,
    rows: int,
    cols: int,
    discs: Array,
    rectangles: Array,
) -> Mask:
    """Cells of the grid `target` (resolution, x, y) that a cell of the mask, a disc or a rectangle overlaps."""
    out = np.zeros((rows, cols), dtype=np.bool_)
    step, left, low = target[0], target[1], target[2]
    for j in range(rows):
        for i in range(cols):
            x, y = left + (i + 0.5) * step, low + (j + 0.5) * step
            hit = False
            for k in range(discs.shape[0]):
                away_x = max(abs(x - discs[k, 0]) - 0.5 * step, 0.0)
                away_y = max(abs(y - discs[k, 1]) - 0.5 * step, 0.0)
                hit = hit or away_x * away_x + away_y * away_y < discs[k, 2] * discs[k, 2]
            for k in range(rectangles.shape[0]):
                hit = hit or _overlaps(rectangles[k], x, y, step)
            if mask.shape[0] > 0 and not hit:
                first_x = (x - 0.5 * step - frame[1]) / frame[0] + 1e-9
                first_y = (y - 0.5 * step - frame[2]) / frame[0] + 1e-9
                last_x, last_y = first_x + step / frame[0] - 2e-9, first_y + step / frame[0] - 2e-9
                for v in range(int(max(first_y, 0.0)), min(int(last_y) + 1, mask.shape[0])):
                    for u in range(int(max(first_x, 0.0)), min(int(last_x) + 1, mask.shape[1])):
                        hit = hit or mask[v, u]
            out[j, i] = hit
    return out


@njit(cache=True)
def _along(way: Array, count: int, travelled: float) -> tuple[float, float, float, float]:
    """Position and unit direction after walking `travelled` [m] to and fro on a polyline."""
    total = 0.0
    for k in range(count - 1):
        total += np.hypot(way[k + 1, 0] - way[k, 0], way[k + 1, 1] - way[k, 1])
    s = travelled % (2.0 * total)
    back = s >= total
    s = 2.0 * total - s if back else s
    sign = -1.0 if back else 1.0
    for k in range(count - 1):
        dx, dy = way[k + 1, 0] - way[k, 0], way[k + 1, 1] - way[k, 1]
        leg = np.hypot(dx, dy)
        last = k == count - 2
        if leg > 0.0 and (s < leg or (back and s <= leg) or last):
            return way[k, 0] + dx * s / leg, way[k, 1] + dy * s / leg, sign * dx / leg, sign * dy / leg
        s -= leg
    return way[0, 0], way[0, 1], 0.0, 0.0


@njit(cache=True)
def _advance(
    kinds: Cells,
    radii: Array,
    velocity: Array,
    speeds: Array,
    way: Array,
    corners: Cells,
    yields: Array,
    positions: Array,
    targets: Array,
    travelled: Array,
    dt: float,
    robot: Array,
) -> tuple[Array, Array, Array, Mask]:
    """Positions, velocities and distances walked after `dt`, and who has reached its random target."""
    count = len(kinds)
    new, speed_out, walked = positions.copy(), np.zeros((count, 2)), travelled.copy()
    arrived = np.zeros(count, dtype=np.bool_)
    for k in range(count):
        speed, dx, dy, left = speeds[k], 0.0, 0.0, np.inf
        if kinds[k] == 0:
            speed = np.hypot(velocity[k, 0], velocity[k, 1])
            dx, dy = velocity[k, 0] / max(speed, 1e-300), velocity[k, 1] / max(speed, 1e-300)
        elif kinds[k] == 1:
            _, _, dx, dy = _along(way[k], corners[k], travelled[k])
        else:
            dx, dy = targets[k, 0] - positions[k, 0], targets[k, 1] - positions[k, 1]
            left = np.hypot(dx, dy)
            dx, dy = dx / max(left, 1e-300), dy / max(left, 1e-300)
        away_x, away_y = robot[0] - positions[k, 0], robot[1] - positions[k, 1]
        if yields[k] > 0.0 and np.isfinite(away_x) and dx * away_x + dy * away_y > 0.0:
            gap = np.hypot(away_x, away_y) - radii[k]
            speed *= min(max(2.0 * gap / yields[k] - 1.0, 0.0), 1.0)
        step = min(speed * dt, left)
        walked[k] += step
        new[k, 0], new[k, 1] = positions[k, 0] + step * dx, positions[k, 1] + step * dy
        if kinds[k] == 1:
            new[k, 0], new[k, 1], dx, dy = _along(way[k], corners[k], walked[k])
        arrived[k] = kinds[k] == 2 and dt > 0.0 and step >= left
        speed_out[k, 0], speed_out[k, 1] = speed * dx, speed * dy
    return new, speed_out, walked, arrived


def _warm() -> None:
    """Compile every kernel with the types that World hands over."""
    frame, bounds = np.array([1.0, 0.0, 0.0]), np.array([0.0, 3.0, 0.0, 3.0])
    discs, rectangles = np.array([[1.0, 1.0, 0.2]]), np.array([[2.0, 2.0, 0.2, 0.2, 0.1]])
    mask, field = np.zeros((3, 3), dtype=np.bool_), np.full((3, 3), 5.0)
    static = (mask, field, frame, bounds, discs, rectangles)
    _clearance(*static, discs, np.array([[0.5, 0.5]]))
    _scan(mask, field.astype(np.uint8), *static[2:], discs, np.array([[0.5, 0.5, 0.0]]), np.zeros(1), 5.0)
    _raster(mask, frame, frame, 3, 3, discs, rectangles)
    one, zero = np.ones(1), np.zeros((1, 2))
    _advance(
        np.ones(1, dtype=np.int64),
        one,
        zero,
        one,
        np.array([[[0.0, 0.0], [1.0, 0.0]]]),
        np.full(1, 2, dtype=np.int64),
        one,
        zero,
        zero,
        np.zeros(1),
        0.1,
        np.zeros(2),
    )
