"""Compiled loops of the world: distances, rays, rasters and the steps of the movers.

An empty mask stands for no grid. Shapes are rows as in World.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from fuzzynav.geometry import Array
from fuzzynav.maps.kernels import Bytes, Cells, Mask, distance_at, ray_length
from fuzzynav.world.timed import frame_at, nearest_on_frames, nearest_on_line

__all__ = ["GROUND", "Fleet", "Scene", "advance", "between", "clearance", "raster", "rectangle_hits", "scan", "spacing"]

GROUND = np.dtype(
    (
        np.record,
        [
            ("resolution", "f8"),  # [m] of the grid, and where its corner lies
            ("x", "f8"),
            ("y", "f8"),
            ("xmin", "f8"),  # [m] walls
            ("xmax", "f8"),
            ("ymin", "f8"),
            ("ymax", "f8"),
        ],
    )
)


class Scene(NamedTuple):
    """What stands still in a world: a grid with its distances and its leaps for rays, the walls, and the shapes."""

    mask: Mask
    field: Array  # [cells]
    skip: Bytes  # [cells] that a ray may leap
    ground: Any  # one GROUND record
    discs: Array
    rectangles: Array


class Fleet(NamedTuple):
    """The movers of a world, one entry each; kinds: 0 constant, 1 patrol, 2 wander, 3 timed."""

    kinds: Cells
    radii: Array
    velocity: Array
    speeds: Array
    way: Array
    frames: Array
    corners: Cells  # of the way, or rows of the frames
    yields: Array
    courtesy: Array


@njit(cache=True)
def clearance(scene: Scene, movers: Array, points: Array) -> Array:
    """Distance [m] from points `(n, 2)` to the nearest surface."""
    out, ground, discs, rectangles = np.empty(points.shape[0]), scene.ground[0], scene.discs, scene.rectangles
    cosine, sine = np.cos(rectangles[:, 4]), np.sin(rectangles[:, 4])
    for n in range(points.shape[0]):
        x, y = points[n, 0], points[n, 1]
        best = min(min(x - ground.xmin, ground.xmax - x), min(y - ground.ymin, ground.ymax - y))
        for k in range(discs.shape[0]):
            best = min(best, np.hypot(x - discs[k, 0], y - discs[k, 1]) - discs[k, 2])
        for k in range(movers.shape[0]):
            best = min(best, np.hypot(x - movers[k, 0], y - movers[k, 1]) - movers[k, 2])
        for k in range(rectangles.shape[0]):
            u, v = x - rectangles[k, 0], y - rectangles[k, 1]
            across = abs(cosine[k] * u + sine[k] * v) - 0.5 * rectangles[k, 2]
            up = abs(cosine[k] * v - sine[k] * u) - 0.5 * rectangles[k, 3]
            best = min(best, np.hypot(max(across, 0.0), max(up, 0.0)) + min(max(across, up), 0.0))
        if scene.mask.shape[0] > 0 and best > 0.0:
            u, v = (x - ground.x) / ground.resolution, (y - ground.y) / ground.resolution
            best = min(best, ground.resolution * distance_at(scene.mask, scene.field, u, v, False))
        out[n] = best
    return out


@njit(cache=True)
def spacing(angles: Array) -> float:
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

    `first` is the heading of beam 0, `step` as from `spacing`. Errs by a beam to either side, never the other way.
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
def rectangle_hits(rectangles: Array, x: float, y: float, beams: Array, step: float, ranges: Array) -> None:
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
def scan(scene: Scene, movers: Array, poses: Array, angles: Array, range_max: float) -> tuple[Array, Cells]:
    """Ranges [m] `(m, n)` from poses `(m, 3)`, and the index of the mover each beam met or -1."""
    out = np.full((poses.shape[0], angles.shape[0]), range_max)
    labels = np.full((poses.shape[0], angles.shape[0]), -1, dtype=np.int64)
    if angles.shape[0] == 0:
        return out, labels
    step, beams, ground = spacing(angles), np.empty((3, angles.shape[0])), scene.ground[0]
    for m in range(poses.shape[0]):
        x, y = poses[m, 0], poses[m, 1]
        beams[0] = poses[m, 2] + angles
        beams[1], beams[2] = np.cos(beams[0]), np.sin(beams[0])
        _disc_hits(scene.discs, -1, x, y, beams, step, out[m], labels[m])
        rectangle_hits(scene.rectangles, x, y, beams, step, out[m])
        _disc_hits(movers, 0, x, y, beams, step, out[m], labels[m])
        px, py = (x - ground.x) / ground.resolution, (y - ground.y) / ground.resolution
        for n in range(angles.shape[0]):
            t = _to_wall(ground, x, y, beams[1, n], beams[2, n])
            if scene.mask.shape[0] > 0 and t > 0.0:
                reach = min(t, out[m, n]) / ground.resolution
                cells = ray_length(scene.mask, scene.skip, px, py, beams[1, n], beams[2, n], reach, False)
                t = min(t, ground.resolution * cells)
            if t < out[m, n]:
                out[m, n], labels[m, n] = t, -1
    return out, labels


@njit(cache=True)
def _to_wall(ground: Any, x: float, y: float, dx: float, dy: float) -> float:
    """Length of the ray inside the walls; 0 outside them."""
    if x < ground.xmin or x > ground.xmax or y < ground.ymin or y > ground.ymax:
        return 0.0
    t = np.inf
    if dx != 0.0:
        t = ((ground.xmax if dx > 0.0 else ground.xmin) - x) / dx
    if dy != 0.0:
        t = min(t, ((ground.ymax if dy > 0.0 else ground.ymin) - y) / dy)
    return max(t, 0.0)


@njit(cache=True)
def _overlaps(rectangle: Array, x: float, y: float, step: float) -> bool:
    """Whether a turned rectangle overlaps the square with centre (x, y) and side `step`, by separating axes."""
    c, s = np.cos(rectangle[4]), np.sin(rectangle[4])
    u, v = x - rectangle[0], y - rectangle[1]
    half, a, b = 0.5 * step - 1e-12, 0.5 * rectangle[2], 0.5 * rectangle[3]
    wide = abs(c) + abs(s)
    return bool(
        abs(u) < half + a * abs(c) + b * abs(s)
        and abs(v) < half + a * abs(s) + b * abs(c)
        and abs(c * u + s * v) < a + half * wide
        and abs(c * v - s * u) < b + half * wide
    )


@njit(cache=True)
def raster(scene: Scene, discs: Array, rectangles: Array, step: float, left: float, low: float, out: Mask) -> None:
    """Mark the cells of a grid from (left, low) that a cell of the scene's mask, a disc or a rectangle overlaps."""
    for j in range(out.shape[0]):
        for i in range(out.shape[1]):
            x, y = left + (i + 0.5) * step, low + (j + 0.5) * step
            hit = scene.mask.shape[0] > 0 and _mask_hits(scene, x, y, step)
            for k in range(discs.shape[0]):
                away_x = max(abs(x - discs[k, 0]) - 0.5 * step, 0.0)
                away_y = max(abs(y - discs[k, 1]) - 0.5 * step, 0.0)
                hit = hit or away_x * away_x + away_y * away_y < discs[k, 2] * discs[k, 2]
            for k in range(rectangles.shape[0]):
                hit = hit or _overlaps(rectangles[k], x, y, step)
            out[j, i] = hit


@njit(cache=True)
def _mask_hits(scene: Scene, x: float, y: float, step: float) -> bool:
    """Whether an occupied cell of the mask overlaps the square with centre (x, y) and side `step`."""
    ground, mask = scene.ground[0], scene.mask
    first_x = (x - 0.5 * step - ground.x) / ground.resolution + 1e-9
    first_y = (y - 0.5 * step - ground.y) / ground.resolution + 1e-9
    last_x, last_y = first_x + step / ground.resolution - 2e-9, first_y + step / ground.resolution - 2e-9
    for v in range(int(max(first_y, 0.0)), min(int(last_y) + 1, mask.shape[0])):
        for u in range(int(max(first_x, 0.0)), min(int(last_x) + 1, mask.shape[1])):
            if mask[v, u]:
                return True
    return False


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
def _course(fleet: Fleet, k: int, position: Array, target: Array, walked: float) -> tuple[float, float, float, float]:
    """Speed, direction and way left of a mover; a timed one walks seconds at speed 1, its direction is its velocity."""
    if fleet.kinds[k] == 0:
        speed = np.hypot(fleet.velocity[k, 0], fleet.velocity[k, 1])
        return speed, fleet.velocity[k, 0] / max(speed, 1e-300), fleet.velocity[k, 1] / max(speed, 1e-300), np.inf
    if fleet.kinds[k] == 1:
        _, _, dx, dy = _along(fleet.way[k], fleet.corners[k], walked)
        return fleet.speeds[k], dx, dy, np.inf
    if fleet.kinds[k] == 3:
        _, _, dx, dy = frame_at(fleet.frames[k], fleet.corners[k], walked)
        return 1.0, dx, dy, np.inf
    dx, dy = target[0] - position[0], target[1] - position[1]
    left = np.hypot(dx, dy)
    return fleet.speeds[k], dx / max(left, 1e-300), dy / max(left, 1e-300), left


@njit(cache=True)
def _crowds(fleet: Fleet, k: int, old: Array, new: Array, walked: float, step: float, robot: Array) -> bool:
    """Whether a courteous mover would come within its courtesy of a robot (x, y, radius), and nearer than it is."""
    if fleet.kinds[k] == 3:
        nearest = nearest_on_frames(fleet.frames[k], fleet.corners[k], walked, step, robot[0], robot[1])
    else:
        nearest = nearest_on_line(old[0], old[1], new[0], new[1], robot[0], robot[1])
    here = np.hypot(old[0] - robot[0], old[1] - robot[1])
    return bool(nearest < here and nearest < robot[2] + fleet.radii[k] + fleet.courtesy[k])


@njit(cache=True)
def advance(
    fleet: Fleet, positions: Array, targets: Array, travelled: Array, dt: float, robot: Array, stands: bool
) -> tuple[Array, Array, Array, Mask]:
    """Positions, velocities and what was walked after `dt`, and who has reached its random target.

    robot: x, y and radius; `stands` says that courteous movers wait for it.
    """
    count = len(fleet.kinds)
    new, speed_out, walked = positions.copy(), np.zeros((count, 2)), travelled.copy()
    arrived = np.zeros(count, dtype=np.bool_)
    for k in range(count):
        speed, dx, dy, left = _course(fleet, k, positions[k], targets[k], travelled[k])
        away_x, away_y = robot[0] - positions[k, 0], robot[1] - positions[k, 1]
        if fleet.yields[k] > 0.0 and np.isfinite(away_x) and dx * away_x + dy * away_y > 0.0:
            gap = np.hypot(away_x, away_y) - fleet.radii[k]
            speed *= min(max(2.0 * gap / fleet.yields[k] - 1.0, 0.0), 1.0)
        step = min(speed * dt, left)
        walked[k] += step
        new[k, 0], new[k, 1] = positions[k, 0] + step * dx, positions[k, 1] + step * dy
        if fleet.kinds[k] == 1:
            new[k, 0], new[k, 1], dx, dy = _along(fleet.way[k], fleet.corners[k], walked[k])
        elif fleet.kinds[k] == 3:
            new[k, 0], new[k, 1], dx, dy = frame_at(fleet.frames[k], fleet.corners[k], walked[k])
        if stands and fleet.courtesy[k] > 0.0:
            if _crowds(fleet, k, positions[k], new[k], travelled[k], step, robot):
                new[k], walked[k], speed, step = positions[k], travelled[k], 0.0, 0.0
        arrived[k] = fleet.kinds[k] == 2 and dt > 0.0 and step >= left
        speed_out[k, 0], speed_out[k, 1] = speed * dx, speed * dy
    return new, speed_out, walked, arrived


@njit(cache=True)
def between(fleet: Fleet, old: Array, new: Array, before: Array, after: Array, share: float) -> Array:
    """Positions at a share of a step from `old` to `new`; before, after: what was walked. Timed movers may jump."""
    out = old + share * (new - old)
    for k in range(len(fleet.kinds)):
        if fleet.kinds[k] == 3:
            walked = before[k] + share * (after[k] - before[k])
            out[k, 0], out[k, 1], _, _ = frame_at(fleet.frames[k], fleet.corners[k], walked)
    return out


def _warm() -> None:
    """Compile every kernel with the types that a World hands over: all arrays of a scene are read-only."""
    discs, rectangles = np.array([[1.0, 1.0, 0.2]]), np.array([[2.0, 2.0, 0.2, 0.2, 0.1]])
    ground = np.array([(1.0, 0.0, 0.0, 0.0, 3.0, 0.0, 3.0)], dtype=GROUND)
    mask, field = np.zeros((3, 3), dtype=np.bool_), np.full((3, 3), 5.0)
    scene = Scene(mask, field, field.astype(np.uint8), ground, discs, rectangles)
    for array in scene:
        array.flags.writeable = False
    movers, zero = np.array([[1.0, 1.0, 0.2]]), np.zeros((1, 2))
    clearance(scene, movers, zero + 0.5)
    scan(scene, movers, np.array([[0.5, 0.5, 0.0]]), np.zeros(1), 5.0)
    raster(scene, discs, rectangles, 1.0, 0.0, 0.0, np.zeros((3, 3), dtype=np.bool_))
    one, count = np.ones(1), np.ones(1, dtype=np.int64)
    frames = np.array([[[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]])
    fleet = Fleet(count, one, zero, one, np.array([[[0.0, 0.0], [1.0, 0.0]]]), frames, count + 1, one, one)
    new, _, walked, _ = advance(fleet, zero, zero, np.zeros(1), 0.1, np.zeros(3), True)
    between(fleet, zero, new, np.zeros(1), walked, 0.5)
