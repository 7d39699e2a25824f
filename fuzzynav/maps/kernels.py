"""Compiled loops of the occupancy grid: distance transform, ray casting, lines, nearest square.

All kernels work in cell units: x in [0, columns], y in [0, rows], cell (i, j) is the closed square [i, i+1] x [j, j+1].
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fuzzynav.geometry import Array

__all__: list[str] = []

Mask = NDArray[np.bool_]
Cells = NDArray[np.int64]
Bytes = NDArray[np.uint8]

Record = NDArray[np.void]

EDGE = 1e-9  # [cells] two things nearer than this touch
FRAME = np.dtype((np.record, [("resolution", "f8"), ("x", "f8"), ("y", "f8")]))


def framed(resolution: float, origin: tuple[float, float]) -> Record:
    """Where cells lie in the world: side [m] and lower left corner [m], as the one read-only record kernels take."""
    frame = np.array([(resolution, *origin)], dtype=FRAME)
    frame.setflags(write=False)
    return frame


@njit(cache=True)
def _columns(occupied: Mask, border: bool) -> Cells:
    """Distance, in half cells, from each cell centre to the nearest occupied square of its own column."""
    rows, cols = occupied.shape
    far = 4 * (rows + cols)
    down = np.empty((rows, cols), dtype=np.int64)
    for x in range(cols):
        last = 1 if border else far
        for y in range(rows):
            last = 0 if occupied[y, x] else last
            down[y, x] = last
            last = min(far, last + 2 if last > 0 else 1)
    for x in range(cols):
        last = 1 if border else far
        for y in range(rows - 1, -1, -1):
            last = 0 if occupied[y, x] else last
            down[y, x] = min(down[y, x], last)
            last = min(far, last + 2 if last > 0 else 1)
    return down


@njit(cache=True)
def distance_field(occupied: Mask, border: bool) -> Array:
    """Distance [cells] from each cell centre to the nearest occupied square; inf where there is none.

    The nearest point of a square, seen from a centre, lies on the half-cell lattice: the lower envelope of the
    parabolas over the lattice sites of a row is therefore exact.
    """
    rows, cols = occupied.shape
    column = _columns(occupied, border)
    far = 4 * (rows + cols)
    out = np.empty((rows, cols))
    sites = np.empty(2 * cols + 1, dtype=np.int64)
    starts = np.empty(2 * cols + 1)
    heights = np.empty(2 * cols + 1)
    for y in range(rows):
        top = -1
        for s in range(2 * cols + 1):
            best = column[y, (s - 1) // 2] if s > 0 else (0 if border else far)
            right = column[y, s // 2] if s < 2 * cols else (0 if border else far)
            best = min(best, right)
            if best >= far:
                continue
            height = float(best) * best
            start = -np.inf
            while top >= 0:
                q = sites[top]
                start = (height + s * s - heights[top] - q * q) / (2.0 * (s - q))
                if start > starts[top]:
                    break
                top -= 1
            top += 1
            sites[top], heights[top], starts[top] = s, height, start if top > 0 else -np.inf
        k = 0
        for x in range(cols):
            if top < 0:
                out[y, x] = np.inf
                continue
            q = 2 * x + 1
            while k < top and starts[k + 1] < q:
                k += 1
            out[y, x] = 0.5 * np.sqrt(heights[k] + (q - sites[k]) ** 2)
    return out


@njit(cache=True)
def ray_length(
    occupied: Mask, skip: Bytes, x: float, y: float, dx: float, dy: float, reach: float, border: bool
) -> float:
    """Length [cells] of the ray from (x, y) along the unit vector (dx, dy) to the first occupied square.

    `skip`, if it has a size, lets the ray jump over empty ground: the distance field [cells], rounded down and at most
    255, in bytes, so that a large map stays in the cache. Without it the ray walks cell by cell. A ray that runs along
    the line between two rows or columns belongs to the upper or right one.

    The walk ends: a jump takes the ray on by more than a cell and never to a cell behind it, any other step takes it
    to the next column or row, so that it has left the map after at most 2 (rows + columns) + 2 of both.
    """
    rows, cols = occupied.shape
    i, j = int(np.floor(x)), int(np.floor(y))
    if i < 0 or j < 0 or i >= cols or j >= rows:
        return 0.0 if border else reach
    if occupied[j, i]:
        return 0.0
    jump = skip.shape[0] > 0
    step_x, step_y = 1 if dx > 0.0 else -1, 1 if dy > 0.0 else -1
    face_x, face_y = (1.0 if dx > 0.0 else 0.0) - x, (1.0 if dy > 0.0 else 0.0) - y
    inv_x = 1.0 / dx if dx != 0.0 else 1e300
    inv_y = 1.0 / dy if dy != 0.0 else 1e300
    t = 0.0
    for _ in range(2 * (rows + cols) + 2):
        if jump and skip[j, i] >= 2:
            t += skip[j, i] - 0.72  # a point of the cell is at most 0.7072 from the centre
            px, py = x + t * dx, y + t * dy
            if t >= reach or not (0.0 <= px < cols and 0.0 <= py < rows):
                return reach
            u, v = int(px), int(py)
            i = max(i, u) if step_x > 0 else min(i, u)
            j = max(j, v) if step_y > 0 else min(j, v)
            continue
        tx = (i + face_x) * inv_x if dx != 0.0 else np.inf
        ty = (j + face_y) * inv_y if dy != 0.0 else np.inf
        if tx < ty - EDGE:
            t = max(t, tx)
            i += step_x
        elif ty < tx - EDGE:
            t = max(t, ty)
            j += step_y
        else:  # through a corner: either side cell stops the ray
            t = max(t, min(tx, ty))
            i, j = i + step_x, j + step_y
            if t < reach and (
                (0 <= i < cols and occupied[j - step_y, i]) or (0 <= j < rows and occupied[j, i - step_x])
            ):
                return t
        if t >= reach:
            return reach
        if i < 0 or j < 0 or i >= cols or j >= rows:
            return t if border else reach
        if occupied[j, i]:
            return t
    return reach


@njit(cache=True)
def cast_rays(
    occupied: Mask, skip: Bytes, frame: Record, poses: Array, angles: Array, range_max: float, border: bool
) -> Array:
    """Ranges [m] `(m, n)` of the beams `angles` [rad, body frame] from `poses` `(m, 3)`; `frame` as from `framed`."""
    out = np.empty((poses.shape[0], angles.shape[0]))
    resolution = frame[0].resolution
    for m in range(poses.shape[0]):
        x, y = (poses[m, 0] - frame[0].x) / resolution, (poses[m, 1] - frame[0].y) / resolution
        for n in range(angles.shape[0]):
            heading = poses[m, 2] + angles[n]
            length = ray_length(occupied, skip, x, y, np.cos(heading), np.sin(heading), range_max / resolution, border)
            out[m, n] = min(length * resolution, range_max)
    return out


@njit(cache=True)
def _segment_square(ax: float, ay: float, bx: float, by: float, i: int, j: int) -> float:
    """Distance [cells] between the segment a-b and the closed square (i, j)."""
    low, high = 0.0, 1.0
    for k in range(2):
        start, along, left = (ax, bx - ax, i) if k == 0 else (ay, by - ay, j)
        if along == 0.0:
            if start < left or start > left + 1:
                high = -1.0
        else:
            first, second = (left - start) / along, (left + 1 - start) / along
            low, high = max(low, min(first, second)), min(high, max(first, second))
    if low <= high:
        return 0.0
    best = min(_point_square(ax, ay, i, j), _point_square(bx, by, i, j))
    squared = (bx - ax) ** 2 + (by - ay) ** 2
    for k in range(4):
        px, py = float(i + k % 2), float(j + k // 2)
        t = ((px - ax) * (bx - ax) + (py - ay) * (by - ay)) / squared if squared > 0.0 else 0.0
        t = min(max(t, 0.0), 1.0)
        best = min(best, np.hypot(px - ax - t * (bx - ax), py - ay - t * (by - ay)))
    return best


@njit(cache=True)
def _point_square(x: float, y: float, i: int, j: int) -> float:
    """Distance [cells] from a point to the closed square (i, j)."""
    return float(np.hypot(max(max(i - x, x - i - 1), 0.0), max(max(j - y, y - j - 1), 0.0)))


@njit(cache=True)
def _span(ax: float, ay: float, bx: float, by: float, i: int, margin: float) -> tuple[float, float]:
    """Lowest and highest y [cells] of the part of a-b within `margin` of column i; empty when low > high."""
    low, high = 0.0, 1.0
    if ax != bx:
        first, second = (i - margin - ax) / (bx - ax), (i + 1 + margin - ax) / (bx - ax)
        low, high = max(0.0, min(first, second)), min(1.0, max(first, second))
    elif ax < i - margin or ax > i + 1 + margin:
        high = -1.0
    if low > high:
        return np.inf, -np.inf
    first, second = ay + low * (by - ay), ay + high * (by - ay)
    return min(first, second), max(first, second)


@njit(cache=True)
def disc_passes(occupied: Mask, ax: float, ay: float, bx: float, by: float, radius: float, touching: bool) -> bool:
    """Whether a disc of `radius` [cells] moves along a-b without meeting an occupied square or leaving the map.

    `touching` (for radius 0) says whether contact with an edge or corner counts as meeting.
    """
    rows, cols = occupied.shape
    reach = radius - EDGE if radius > 0.0 else 0.0
    margin = reach if radius > 0.0 else (EDGE if touching else -EDGE)
    if min(ax, bx) < reach or max(ax, bx) > cols - reach or min(ay, by) < reach or max(ay, by) > rows - reach:
        return False
    for i in range(int(np.ceil(min(ax, bx) - 1 - margin)), int(np.floor(max(ax, bx) + margin)) + 1):
        low, high = _span(ax, ay, bx, by, i, margin)
        if low > high or i < 0 or i >= cols:
            continue
        for j in range(max(int(np.ceil(low - 1 - margin)), 0), min(int(np.floor(high + margin)), rows - 1) + 1):
            if occupied[j, i] and (radius <= 0.0 or _segment_square(ax, ay, bx, by, i, j) < reach):
                return False
    return True


@njit(cache=True)
def crossed_cells(ax: float, ay: float, bx: float, by: float, margin: float) -> Cells:
    """Cells `(n, 2)` x, y whose squares, grown by `margin`, meet the segment a-b."""
    cells = [(0, 0)]
    cells.pop()
    for i in range(int(np.ceil(min(ax, bx) - 1 - margin)), int(np.floor(max(ax, bx) + margin)) + 1):
        low, high = _span(ax, ay, bx, by, i, margin)
        if low <= high:
            for j in range(int(np.ceil(low - 1 - margin)), int(np.floor(high + margin)) + 1):
                cells.append((i, j))
    out = np.empty((len(cells), 2), dtype=np.int64)
    for n in range(len(cells)):
        out[n, 0], out[n, 1] = cells[n]
    return out


@njit(cache=True)
def distance_at(occupied: Mask, field: Array, x: float, y: float, border: bool) -> float:
    """Distance [cells] from any point (x, y) to the nearest occupied square; 0 inside one.

    `field` is `distance_field` with the same `border`. The answer lies within the distance of the point from its cell's
    centre of the field there, so that a ring of squares is enough.
    """
    rows, cols = occupied.shape
    best = np.inf
    if border:
        best = max(min(min(x, cols - x), min(y, rows - y)), 0.0)
    i, j = min(max(int(np.floor(x)), 0), cols - 1), min(max(int(np.floor(y)), 0), rows - 1)
    away = np.hypot(x - i - 0.5, y - j - 0.5)
    if field[j, i] == np.inf or best <= 0.0:
        return best
    best = min(best, field[j, i] + away)
    inner = max(int((field[j, i] - 2.0 * away) * 0.7071) - 1, 0)
    ring = inner
    while ring - 0.5 - 0.7072 <= best + away and ring <= rows + cols:
        for v in range(max(j - ring, 0), min(j + ring, rows - 1) + 1):
            step = 1 if abs(v - j) == ring else max(2 * ring, 1)
            for u in range(i - ring, i + ring + 1, step):
                if 0 <= u < cols and occupied[v, u]:
                    best = min(best, _point_square(x, y, u, v))
        ring += 1
    return float(best)


@njit(cache=True)
def distances_at(occupied: Mask, field: Array, points: Array, border: bool) -> Array:
    """`distance_at` for points `(n, 2)`."""
    out = np.empty(points.shape[0])
    for n in range(points.shape[0]):
        out[n] = distance_at(occupied, field, points[n, 0], points[n, 1], border)
    return out


def _warm() -> None:
    """Compile every kernel with the types that GridMap hands over: its arrays are read-only."""
    occupied = np.eye(3, dtype=np.bool_)
    occupied.setflags(write=False)
    field = distance_field(occupied, True)
    skip = field.astype(np.uint8)
    pose, angles = np.array([[0.5, 1.5, 0.0]]), np.zeros(1)
    for shared in (field, skip, pose, angles):
        shared.setflags(write=False)
    cast_rays(occupied, skip, framed(1.0, (0.0, 0.0)), pose, angles, 5.0, True)
    disc_passes(occupied, 0.5, 0.5, 1.5, 2.5, 0.1, True)
    crossed_cells(0.5, 0.5, 1.5, 2.5, EDGE)
    distances_at(occupied, field, np.array([[0.5, 1.5]]), True)
