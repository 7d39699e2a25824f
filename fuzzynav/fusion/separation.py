"""How far a robot must be from movers of bounded speed, so that it never touches one while it moves.

Passive safety: a mover may run into a robot that stands, a robot that moves runs into nothing. The closed form holds
for any arc and was proved by machine; the condition on the arc that is really driven is weaker, exact, and what the
planner uses. Both ask the same: whatever the movers do within their speed bound, the robot can still stop.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.checks import finite, points
from fuzzynav.dwa.kernels import braking
from fuzzynav.fusion import kernels
from fuzzynav.geometry import Array, to_body
from fuzzynav.robot import Robot, limits_of

__all__ = ["passive_separation", "reached_by_then", "static_separation", "stays_clear"]


def static_separation(v: ArrayLike, robot: Robot, dt: float) -> Array:
    """Distance [m] to what stands at which a new arc may be chosen: `passive_separation` for movers of speed 0."""
    return passive_separation(v, 0.0, robot, dt)


def passive_separation(v: ArrayLike, speed_bound: ArrayLike, robot: Robot, dt: float) -> Array:
    """Distance [m] to a mover at which a robot of speed v [m/s] may choose any arc, and never touches it while moving.

    v^2/2b + V v/b + (A/b + 1)(A e^2/2 + e (v + V)): the way to a stop and what the mover, no faster than V, walks
    meanwhile, after a period e in which the robot still speeds up. It is counted from rim to rim, along x or along y.
    A, b and e are acc_lim_x, dec_lim_x and dt. Raises ValueError for speeds below 0 and a dt that is not positive.

    Source: Mitsch, Ghorbal, Vogelbacher and Platzer, Int. J. Robotics Research 36 (2017), passive safety.

    >>> from fuzzynav.robot import THESIS, TURTLEBOT2
    >>> passive_separation([1.0, 0.2], 0.5, THESIS, 0.1).round(2).tolist()
    [5.3, 0.74]
    >>> float(passive_separation(0.65, 0.5, TURTLEBOT2, 0.1).round(2))
    0.47
    """
    speed, bound = np.asarray(v, dtype=float), np.asarray(speed_bound, dtype=float)
    if not ((speed >= 0).all() and (bound >= 0).all() and 0 < dt < np.inf):
        raise ValueError(f"speeds must be 0 m/s or more and dt positive, got {speed}, {bound} and {dt}")
    gain, loss = robot.acc_lim_x, robot.dec_lim_x
    during = (gain / loss + 1.0) * (0.5 * gain * dt**2 + dt * (speed + bound))
    return np.asarray(speed**2 / (2.0 * loss) + bound * speed / loss + during)


def reached_by_then(sample: ArrayLike, speed_bound: float, robot: Robot, dt: float) -> float:
    """Distance [m] that a mover can walk until the robot stands that drives (v, omega) for dt [s] and then brakes.

    >>> from fuzzynav.robot import TURTLEBOT2
    >>> round(reached_by_then([0.65, 0.0], 0.5, TURTLEBOT2, 0.1), 3)
    0.15
    """
    v, omega = finite(sample, "the sample", 2)
    slower = braking(v, omega, limits_of(robot)[0])
    return float(speed_bound * np.ceil(abs(v) / (slower * dt) - 1e-12) * dt) if v != 0.0 else 0.0


def stays_clear(
    pose: ArrayLike, sample: ArrayLike, hazards: ArrayLike, speed_bound: float, robot: Robot, dt: float
) -> bool:
    """Whether (v, omega), driven for dt [s] and braked on its arc, meets no place that a mover can have reached.

    hazards: rows x, y, radius [m] of the movers, which walk no faster than `speed_bound` [m/s] in any direction.
    Exact: time advances by what the least gap allows. A robot that stands or turns in place always stays clear.

    >>> from fuzzynav.robot import TURTLEBOT2
    >>> ahead = [[1.2, 0.0, 0.3]]
    >>> [stays_clear([0, 0, 0], [v, 0], ahead, 0.5, TURTLEBOT2, 0.1) for v in (0.0, 0.65)]
    [True, True]
    >>> stays_clear([0, 0, 0], [0.65, 0], [[0.7, 0.0, 0.3]], 0.5, TURTLEBOT2, 0.1)
    False
    """
    rows = points(hazards, "hazards", 3)
    v, omega = finite(sample, "the sample", 2)
    turned = np.column_stack([to_body(pose, rows[:, :2]), rows[:, 2] + robot.radius])
    slower = braking(v, omega, limits_of(robot)[0])
    return bool(kernels.stays_clear(v, omega, slower, dt, speed_bound, turned, 0.0))
