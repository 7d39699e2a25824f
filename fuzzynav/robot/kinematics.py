"""How wheels move a body: wheel and body speeds, motion in the plane, and when wheels roll."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.geometry import Array, wrap
from fuzzynav.robot import kernels
from fuzzynav.robot.model import Robot

__all__ = [
    "body_from_rims",
    "body_speeds",
    "constraints",
    "footprint",
    "motion_name",
    "move",
    "move_midpoint",
    "pose_rate",
    "rims_from_turn",
    "rolls",
    "spin_name_as_printed",
    "turning_radius",
    "wheel_speeds",
    "yaw_rate_as_printed",
]


def body_speeds(wheels: ArrayLike, robot: Robot) -> Array:
    """Body speeds v [m/s], omega [rad/s] from wheel rates `(..., 2)` (right, left) [rad/s].

    Source: thesis eq 5.8, which is eq 2.7 with its second factor corrected to R/L (errata T27).

    >>> from fuzzynav.robot import TURTLEBOT2
    >>> body_speeds([10.0, 5.0], TURTLEBOT2).round(4).tolist()     # 0.035 * 15 / 2, 0.035 * 5 / 0.23
    [0.2625, 0.7609]
    """
    return body_from_rims(robot.wheel_radius * np.asarray(wheels, dtype=float), robot)


def body_from_rims(rims: ArrayLike, robot: Robot) -> Array:
    """Body speeds v [m/s], omega [rad/s] from rim speeds `(..., 2)` (right, left) [m/s].

    Source: thesis eq 3.13 (errata T29: the speeds are linear), A.4 and A.7.
    """
    rim = np.asarray(rims, dtype=float)
    right, left = rim[..., 0], rim[..., 1]
    return np.stack([(right + left) / 2.0, (right - left) / robot.track], axis=-1)


def wheel_speeds(command: ArrayLike, robot: Robot) -> Array:
    """Wheel rates (right, left) [rad/s] for commands `(..., 2)` of v [m/s], omega [rad/s].

    The inverse of `body_speeds`.

    >>> from fuzzynav.robot import TURTLEBOT2
    >>> wheel_speeds([0.35, 0.0], TURTLEBOT2).round(6).tolist()
    [10.0, 10.0]
    """
    c = np.asarray(command, dtype=float)
    half = c[..., 1] * robot.track / 2.0
    return np.stack([c[..., 0] + half, c[..., 0] - half], axis=-1) / robot.wheel_radius


def rims_from_turn(omega: ArrayLike, turn_radius: ArrayLike, robot: Robot) -> Array:
    """Rim speeds (right, left) [m/s] of a turn with omega [rad/s] about a centre turn_radius [m] to the left.

    Source: thesis eq A.2, and A.1 in their mean v = omega R (errata T30: R is the turning radius).

    >>> from fuzzynav.robot import TURTLEBOT2
    >>> rims_from_turn(0.5, 1.0, TURTLEBOT2).tolist()
    [0.5575, 0.4425]
    """
    w, r = np.asarray(omega, dtype=float), np.asarray(turn_radius, dtype=float)
    half = robot.track / 2.0
    return np.stack([w * (r + half), w * (r - half)], axis=-1)


def turning_radius(rims: ArrayLike, robot: Robot) -> Array:
    """Signed distance [m] from the robot's centre to its turning centre; inf on a straight line, nan at rest.

    Positive to the left. Source: thesis eq A.3.
    """
    rim = np.asarray(rims, dtype=float)
    total, difference = rim[..., 0] + rim[..., 1], rim[..., 0] - rim[..., 1]
    straight = difference == 0.0
    value = robot.track / 2.0 * total / np.where(straight, 1.0, difference)
    return np.where(straight, np.where(total == 0.0, np.nan, np.inf), value)


def yaw_rate_as_printed(wheels: ArrayLike, robot: Robot) -> Array:
    """Yaw rate [rad/s] by the second form of eq 2.7 as printed, R/(2L): half of what it should be (errata T27)."""
    w = np.asarray(wheels, dtype=float)
    return np.asarray(robot.wheel_radius / (2.0 * robot.track) * (w[..., 0] - w[..., 1]))


def motion_name(v_right: float, v_left: float, tolerance: float = 1e-9) -> str:
    """What the robot does at these wheel speeds, in words; speeds within `tolerance` count as equal.

    The table of thesis section 5.3.2, with the two spins exchanged (errata T64) and its gaps filled.
    Raises ValueError if a speed is not finite.

    >>> motion_name(0.2, -0.2)
    'spin counter-clockwise'
    """
    if not (np.isfinite(v_right) and np.isfinite(v_left)):
        raise ValueError(f"wheel speeds must be finite, got {v_right} and {v_left}")
    forward, turn = v_right + v_left, v_right - v_left
    along = 0 if abs(forward) <= tolerance else int(np.sign(forward))
    left = 0 if abs(turn) <= tolerance else int(np.sign(turn))
    if along == 0:
        return ("rest", "spin counter-clockwise", "spin clockwise")[left]
    course = "forward" if along > 0 else "backward"
    return f"{course}, " + ("straight", "heading turns left", "heading turns right")[left]


def spin_name_as_printed(v_right: float, v_left: float) -> str:
    """Direction of a spin in place by the words of thesis section 5.3.2 as printed: exchanged (errata T64)."""
    return "spin counter-clockwise" if v_right < v_left else "spin clockwise"


def pose_rate(pose: ArrayLike, command: ArrayLike) -> Array:
    """Time derivative `(..., 3)` of a pose driven at `(v, omega)`: x' [m/s], y' [m/s], theta' [rad/s].

    Source: thesis eq 2.8, 2.11, 3.14 and 5.7, which are the same.
    """
    p, c = np.asarray(pose, dtype=float), np.asarray(command, dtype=float)
    x, y = c[..., 0] * np.cos(p[..., 2]), c[..., 0] * np.sin(p[..., 2])
    return np.stack(np.broadcast_arrays(x, y, c[..., 1]), axis=-1)


def move(pose: ArrayLike, command: ArrayLike, dt: ArrayLike) -> Array:
    """Pose `(..., 3)` after driving `(v, omega)` for dt [s] along the exact arc; shapes broadcast.

    The integral of `pose_rate` for constant speeds, without error at any step.

    >>> move([0, 0, 0], [np.pi, np.pi], 0.5).round(6).tolist()     # a quarter of a circle of radius 1
    [1.0, 1.0, 1.570796]
    """
    p, c, t = np.asarray(pose, dtype=float), np.asarray(command, dtype=float), np.asarray(dt, dtype=float)
    shape = np.broadcast_shapes(p.shape[:-1], c.shape[:-1], t.shape)
    out = np.empty((*shape, 3))
    starts = np.broadcast_to(p, (*shape, 3)).reshape(-1, 3)
    speeds = np.broadcast_to(c, (*shape, 2)).reshape(-1, 2)
    kernels.arcs(starts, speeds, np.broadcast_to(t, shape).reshape(-1), out.reshape(-1, 3))
    return out


def move_midpoint(pose: ArrayLike, command: ArrayLike, dt: ArrayLike) -> Array:
    """Pose after one step of the mid-point rule, which lays the length of the arc along its chord.

    Source: thesis eq 1.1 (errata T33: not exact; the chord is shorter than the arc).
    """
    p, c = np.asarray(pose, dtype=float), np.asarray(command, dtype=float)
    turn, arc = c[..., 1] * dt, c[..., 0] * dt
    middle = p[..., 2] + turn / 2.0
    x, y = p[..., 0] + arc * np.cos(middle), p[..., 1] + arc * np.sin(middle)
    return np.stack(np.broadcast_arrays(x, y, wrap(p[..., 2] + turn)), axis=-1)


def footprint(pose: ArrayLike, robot: Robot, n: int = 36) -> Array:
    """Points `(n, 2)` [m] on the edge of the disc that contains the robot, the first one straight ahead."""
    x, y, theta = np.asarray(pose, dtype=float)
    angle = theta + np.linspace(0.0, 2.0 * np.pi, n, endpoint=False)
    return np.stack([x + robot.radius * np.cos(angle), y + robot.radius * np.sin(angle)], axis=-1)


def constraints(pose: ArrayLike, rate: ArrayLike, rims: ArrayLike, robot: Robot) -> Array:
    """Slip speeds `(..., 3)` [m/s]: sideways, of the right and of the left wheel; all zero when the wheels roll.

    `rate` is the derivative of the pose, `rims` are the rim speeds (right, left) [m/s].
    Source: thesis eq 2.9.
    """
    p, q, rim = (np.asarray(a, dtype=float) for a in (pose, rate, rims))
    c, s = np.cos(p[..., 2]), np.sin(p[..., 2])
    along, half = q[..., 0] * c + q[..., 1] * s, robot.track / 2.0 * q[..., 2]
    slips = (q[..., 1] * c - q[..., 0] * s, along + half - rim[..., 0], along - half - rim[..., 1])
    return np.stack(np.broadcast_arrays(*slips), axis=-1)


def rolls(
    pose: ArrayLike, rate: ArrayLike, rims: ArrayLike, robot: Robot, tolerance: float = 1e-9
) -> NDArray[np.bool_]:
    """Whether a motion neither slides sideways nor slips at a wheel, to within tolerance [m/s]; shape `(...)`."""
    return np.asarray(np.all(np.abs(constraints(pose, rate, rims, robot)) <= tolerance, axis=-1))
