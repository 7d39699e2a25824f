"""The differential-drive robot: its measures, its limits and how it moves."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp

from fuzzynav.geometry import Array, wrap

__all__ = [
    "PIONEER_3DX",
    "THESIS",
    "TURTLEBOT2",
    "TURTLEBOT3_BURGER",
    "Robot",
    "accelerations",
    "body_from_rims",
    "body_speeds",
    "constraints",
    "drive",
    "footprint",
    "limit",
    "motion_name",
    "motor_lag",
    "move",
    "move_midpoint",
    "pose_rate",
    "reachable",
    "respects_limits",
    "rims_from_turn",
    "rolls",
    "spin_name_as_printed",
    "state_rate",
    "turning_radius",
    "wheel_speeds",
    "yaw_rate_as_printed",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Robot:
    """Measures and limits of one differential-drive robot; SI units, ROS names where one exists.

    `track` is the full distance between the wheels. Raises ValueError if a measure or a limit
    is not positive and finite, or if min_vel_x does not lie below max_vel_x and at or below zero.
    """

    name: str
    wheel_radius: float  # [m]
    track: float  # [m] full wheel separation
    radius: float  # [m] of the disc that contains the robot
    max_vel_x: float  # [m/s]
    min_vel_x: float  # [m/s]; negative where the robot may drive backwards
    max_vel_theta: float  # [rad/s]
    acc_lim_x: float  # [m/s^2] speeding up
    dec_lim_x: float  # [m/s^2] braking, as a positive number
    acc_lim_theta: float  # [rad/s^2] speeding up and braking
    mass: float  # [kg]
    inertia: float  # [kg m^2] about the vertical axis
    source: str

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name in ("name", "source", "min_vel_x"):
                continue
            if not (np.isfinite(value) and value > 0):
                raise ValueError(f"{field.name} must be positive and finite, got {value}")
        if not (np.isfinite(self.min_vel_x) and self.min_vel_x <= 0 < self.max_vel_x):
            raise ValueError(f"min_vel_x must be finite and at most 0, so that the robot may stop: {self.min_vel_x}")


# --- wheels and body ---------------------------------------------------------------------------


def body_speeds(wheels: ArrayLike, robot: Robot) -> Array:
    """Body speeds v [m/s], omega [rad/s] from wheel rates `(..., 2)` (right, left) [rad/s].

    Source: thesis eq 5.8, which is eq 2.7 with its second factor corrected to R/L (errata T27).

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

    >>> wheel_speeds([0.35, 0.0], TURTLEBOT2).round(6).tolist()
    [10.0, 10.0]
    """
    c = np.asarray(command, dtype=float)
    half = c[..., 1] * robot.track / 2.0
    return np.stack([c[..., 0] + half, c[..., 0] - half], axis=-1) / robot.wheel_radius


def rims_from_turn(omega: ArrayLike, turn_radius: ArrayLike, robot: Robot) -> Array:
    """Rim speeds (right, left) [m/s] of a turn with omega [rad/s] about a centre turn_radius [m] to the left.

    Source: thesis eq A.2, and A.1 in their mean v = omega R (errata T30: R is the turning radius).

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
    return robot.wheel_radius / (2.0 * robot.track) * (w[..., 0] - w[..., 1])


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


# --- motion in the plane -----------------------------------------------------------------------


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
    p, c = np.asarray(pose, dtype=float), np.asarray(command, dtype=float)
    turn = c[..., 1] * dt
    chord = c[..., 0] * dt * np.sinc(turn / (2.0 * np.pi))
    middle = p[..., 2] + turn / 2.0
    x, y = p[..., 0] + chord * np.cos(middle), p[..., 1] + chord * np.sin(middle)
    return np.stack(np.broadcast_arrays(x, y, wrap(p[..., 2] + turn)), axis=-1)


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
    return np.all(np.abs(constraints(pose, rate, rims, robot)) <= tolerance, axis=-1)


# --- forces ------------------------------------------------------------------------------------


def accelerations(torques: ArrayLike, robot: Robot) -> Array:
    """Accelerations v' [m/s^2], omega' [rad/s^2] from wheel torques `(..., 2)` (right, left) [N m].

    Source: thesis eq 2.10 with the full separation: L/(2r) (errata T28).

    >>> accelerations([0.2, 0.1], TURTLEBOT2).round(4).tolist()    # 0.3/(6.3*0.035), 0.23*0.1/(2*0.1*0.035)
    [1.3605, 3.2857]
    """
    t = np.asarray(torques, dtype=float)
    forward = (t[..., 0] + t[..., 1]) / (robot.mass * robot.wheel_radius)
    turn = robot.track / (2.0 * robot.wheel_radius) * (t[..., 0] - t[..., 1]) / robot.inertia
    return np.stack([forward, turn], axis=-1)


def state_rate(state: ArrayLike, torques: ArrayLike, robot: Robot) -> Array:
    """Derivative of the state `(..., 5)` x, y, theta, v, omega under wheel torques (right, left) [N m].

    Source: thesis eq 2.12 (errata T28).
    """
    s = np.asarray(state, dtype=float)
    motion, push = pose_rate(s[..., :3], s[..., 3:]), accelerations(torques, robot)
    shape = np.broadcast_shapes(motion.shape[:-1], push.shape[:-1])
    return np.concatenate([np.broadcast_to(motion, (*shape, 3)), np.broadcast_to(push, (*shape, 2))], axis=-1)


def drive(state: ArrayLike, torques: ArrayLike, dt: float, robot: Robot) -> Array:
    """State `(5,)` after dt [s] of constant wheel torques, by SciPy's eighth-order Runge-Kutta (DOP853).

    The step adapts to a relative error of 1e-10; theta is wrapped. Raises ValueError if an input is not finite.
    """
    start, torque = np.asarray(state, dtype=float), np.asarray(torques, dtype=float)
    if start.shape != (5,) or torque.shape != (2,) or not (np.isfinite([*start, *torque, dt]).all() and dt >= 0):
        raise ValueError("drive needs a state (5,), torques (2,) and dt >= 0, all finite")
    done = solve_ivp(lambda _, s: state_rate(s, torque, robot), (0.0, dt), start, "DOP853", rtol=1e-10, atol=1e-12)
    end = done.y[:, -1]
    end[2] = wrap(end[2])
    return end


def motor_lag(speed: ArrayLike, command: ArrayLike, time_constant: float, dt: float) -> Array:
    """Speeds after dt [s] of a first-order motor that follows `command`; exact for any dt.

    Raises ValueError if the time constant [s] is not positive or dt is negative.

    >>> float(motor_lag(0.0, 1.0, 0.1, 0.1).round(3))               # 1 - 1/e
    0.632
    """
    if not (time_constant > 0 and dt >= 0):
        raise ValueError(f"time_constant must be positive and dt not negative, got {time_constant} and {dt}")
    s, c = np.asarray(speed, dtype=float), np.asarray(command, dtype=float)
    return c + (s - c) * np.exp(-dt / time_constant)


# --- limits ------------------------------------------------------------------------------------


def reachable(last: ArrayLike, robot: Robot, dt: float) -> tuple[Array, Array]:
    """Lowest and highest speeds `(..., 2)` that the acceleration limits allow dt [s] after `last` (v, omega).

    A robot that changes direction brakes to zero first and speeds up with what is left of dt. The limits
    of speed are not applied here: see `limit`.
    """
    before = np.asarray(last, dtype=float)
    v, omega = before[..., 0], before[..., 1]
    if not (dt > 0 and np.isfinite(before).all()):
        raise ValueError(f"the last command must be finite and dt positive, got {before.tolist()} and {dt}")
    gain, loss, step = robot.acc_lim_x * dt, robot.dec_lim_x * dt, robot.acc_lim_theta * dt
    ratio = robot.acc_lim_x / robot.dec_lim_x
    up = np.where(v >= 0.0, v + gain, np.where(v + loss <= 0.0, v + loss, (v + loss) * ratio))
    down = np.where(v <= 0.0, v - gain, np.where(v - loss >= 0.0, v - loss, (v - loss) * ratio))
    return np.stack([down, omega - step], axis=-1), np.stack([up, omega + step], axis=-1)


def limit(command: ArrayLike, last: ArrayLike, robot: Robot, dt: float) -> Array:
    """The command nearest to the wish `(..., 2)` that speed and acceleration limits allow from `last`.

    Where `last` itself is too fast, the speed falls as quickly as the acceleration limits allow.
    Raises ValueError if a speed is not finite or dt [s] not positive.

    >>> limit([1.0, 0.0], [0.0, 0.0], THESIS, 0.1).round(3).tolist()
    [0.02, 0.0]
    """
    wish = np.asarray(command, dtype=float)
    if not np.isfinite(wish).all():
        raise ValueError(f"a command must be finite, got {wish.tolist()}")
    low, high = reachable(last, robot, dt)
    slow, fast = (robot.min_vel_x, -robot.max_vel_theta), (robot.max_vel_x, robot.max_vel_theta)
    return np.clip(np.clip(wish, slow, fast), low, high)


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


THESIS = Robot(
    name="thesis",
    wheel_radius=0.035,
    track=0.23,
    radius=0.3,
    max_vel_x=1.0,
    min_vel_x=0.0,
    max_vel_theta=0.35,
    acc_lim_x=0.2,
    dec_lim_x=0.2,
    acc_lim_theta=0.87,
    mass=6.3,
    inertia=0.28,
    source="limits: thesis tables 3.3 and 4.1; braking as speeding up, least speed 0, measures of the TurtleBot2 "
    "and radius 0.3 m: ours; inertia: ours, of a uniform disc",
)
TURTLEBOT2 = Robot(
    name="TurtleBot2",
    wheel_radius=0.035,
    track=0.23,
    radius=0.177,
    max_vel_x=0.65,
    min_vel_x=-0.65,
    max_vel_theta=3.14,
    acc_lim_x=2.5,
    dec_lim_x=2.5,
    acc_lim_theta=3.2,
    mass=6.3,
    inertia=0.1,
    source="speeds and mass: thesis table 5.4; wheels and size: Kobuki user guide; accelerations: ROS "
    "navigation defaults (DWAPlannerROS); inertia: ours, of a uniform disc",
)
TURTLEBOT3_BURGER = Robot(
    name="TurtleBot3 Burger",
    wheel_radius=0.033,
    track=0.16,
    radius=0.105,
    max_vel_x=0.22,
    min_vel_x=-0.22,
    max_vel_theta=2.84,
    acc_lim_x=2.5,
    dec_lim_x=2.5,
    acc_lim_theta=3.2,
    mass=1.0,
    inertia=0.006,
    source="speeds, wheels and mass: ROBOTIS e-Manual; radius and accelerations: turtlebot3_navigation; "
    "inertia: ours, of a uniform disc",
)
PIONEER_3DX = Robot(
    name="Pioneer 3-DX",
    wheel_radius=0.0975,
    track=0.331,
    radius=0.267,
    max_vel_x=1.2,
    min_vel_x=-1.2,
    max_vel_theta=5.23,
    acc_lim_x=0.3,
    dec_lim_x=0.3,
    acc_lim_theta=1.75,
    mass=9.0,
    inertia=0.32,
    source="speeds and mass: thesis table 5.4; wheels and swing radius: Pioneer 3-DX data sheet; "
    "accelerations: defaults of its ARIA parameter file; inertia: ours, of a uniform disc",
)
