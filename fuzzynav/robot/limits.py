"""The limits of speed and acceleration, and what they leave of a command."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array
from fuzzynav.robot import kernels
from fuzzynav.robot.model import Robot, limits_of

__all__ = ["limit", "reachable", "respects_limits"]


def reachable(last: ArrayLike, robot: Robot, dt: float) -> tuple[Array, Array]:
    """Lowest and highest speeds `(..., 2)` that the acceleration limits allow dt [s] after `last` (v, omega).

    A robot that changes direction brakes to zero first and speeds up with what is left of dt. The limits
    of speed are not applied here: see `limit`.
    """
    before = np.asarray(last, dtype=float)
    if not (dt > 0 and np.isfinite(before).all()):
        raise ValueError(f"the last command must be finite and dt positive, got {before.tolist()} and {dt}")
    low, high = np.empty(before.shape), np.empty(before.shape)
    kernels.reaches(before.reshape(-1, 2), limits_of(robot), dt, low.reshape(-1, 2), high.reshape(-1, 2))
    return low, high


def limit(command: ArrayLike, last: ArrayLike, robot: Robot, dt: float) -> Array:
    """The command nearest to the wish `(..., 2)` that speed and acceleration limits allow from `last`.

    Where `last` itself is too fast, the speed falls as quickly as the acceleration limits allow.
    Raises ValueError if a speed is not finite or dt [s] not positive.

    >>> from fuzzynav.robot import THESIS
    >>> limit([1.0, 0.0], [0.0, 0.0], THESIS, 0.1).round(3).tolist()
    [0.02, 0.0]
    """
    wish, before = np.asarray(command, dtype=float), np.asarray(last, dtype=float)
    if not np.isfinite(wish).all():
        raise ValueError(f"a command must be finite, got {wish.tolist()}")
    if not (dt > 0 and np.isfinite(before).all()):
        raise ValueError(f"the last command must be finite and dt positive, got {before.tolist()} and {dt}")
    out = np.array(np.broadcast_to(wish, np.broadcast_shapes(wish.shape, before.shape)))
    kernels.limits(out.reshape(-1, 2), np.broadcast_to(before, out.shape).reshape(-1, 2), limits_of(robot), dt)
    return out


def respects_limits(commands: ArrayLike, dt: float, robot: Robot, tolerance: float = 1e-9) -> bool:
    """Whether commands `(n, 2)`, one every dt [s], keep the limits of speed and of acceleration.

    The first command is judged by its speed alone: prepend the speed before it to judge its step.
    """
    c = np.asarray(commands, dtype=float).reshape(-1, 2)
    if not np.isfinite(c).all():
        return False
    slow, fast = (robot.min_vel_x, -robot.max_vel_theta), (robot.max_vel_x, robot.max_vel_theta)
    inside = np.all((c >= np.subtract(slow, tolerance)) & (c <= np.add(fast, tolerance)))
    low, high = reachable(c[:-1], robot, dt)
    return bool(inside and np.all((c[1:] >= low - tolerance) & (c[1:] <= high + tolerance)))
