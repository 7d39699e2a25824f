"""Compiled: movers that walk by a clock, along rows of t [s], x, y [m] that repeat with the last time as period.

At the end a mover jumps back to the first row; before the time of the first row it stands there.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fuzzynav.geometry import Array

__all__ = ["frame_at", "nearest_on_frames", "nearest_on_line"]


@njit(cache=True)
def frame_at(frames: Array, count: int, walked: float) -> tuple[float, float, float, float]:
    """Place and velocity after `walked` [s] on the first `count` rows; a single row stands still."""
    late = walked % frames[count - 1, 0] if count > 1 else 0.0
    if count == 1 or late < frames[0, 0]:
        return frames[0, 1], frames[0, 2], 0.0, 0.0
    k = 0
    while k < count - 2 and late >= frames[k + 1, 0]:
        k += 1
    span = frames[k + 1, 0] - frames[k, 0]
    vx, vy = (frames[k + 1, 1] - frames[k, 1]) / span, (frames[k + 1, 2] - frames[k, 2]) / span
    late -= frames[k, 0]
    return frames[k, 1] + vx * late, frames[k, 2] + vy * late, vx, vy


@njit(cache=True)
def nearest_on_line(ax: float, ay: float, bx: float, by: float, x: float, y: float) -> float:
    """Distance [m] from (x, y) to the line from a to b."""
    dx, dy = bx - ax, by - ay
    square, along = dx * dx + dy * dy, (x - ax) * dx + (y - ay) * dy
    u = min(max(along / square, 0.0), 1.0) if square > 0.0 else 0.0
    return float(np.hypot(ax + u * dx - x, ay + u * dy - y))


@njit(cache=True)
def nearest_on_frames(frames: Array, count: int, walked: float, dt: float, x: float, y: float) -> float:
    """Distance [m] from (x, y) to the nearest place passed within dt [s]; a jump passes nothing but where it lands."""
    px, py, vx, vy = frame_at(frames, count, walked + dt)
    best = float(np.hypot(px - x, py - y))
    if count == 1:
        return best
    late, left = walked % frames[count - 1, 0], min(dt, frames[count - 1, 0])
    while left > 0.0:
        k = 0
        while k < count - 1 and frames[k, 0] <= late:
            k += 1
        px, py, vx, vy = frame_at(frames, count, late)
        step = min(frames[k, 0] - late, left)
        best = min(best, nearest_on_line(px, py, px + vx * step, py + vy * step, x, y))
        left -= step
        late = frames[k, 0] if k < count - 1 else 0.0
    return best


def _warm() -> None:
    """Compile every kernel for the types used in practice."""
    frames = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]])
    frame_at(frames, 2, 0.5)
    nearest_on_frames(frames, 2, 0.5, 1.0, 2.0, 2.0)
