"""The differential-drive robot: its measures, its limits and how it moves."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array, wrap

__all__ = [
    "PIONEER_3DX", "THESIS", "TURTLEBOT2", "TURTLEBOT3_BURGER", "Robot",
    "body_speeds", "limit", "move", "move_midpoint", "wheel_speeds",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Robot:
    """Measures and limits of one differential-drive robot; SI units, ROS names where one exists.

    `track` is the full distance between the wheels. Raises ValueError if a measure or a limit
    is not positive and finite, or if min_vel_x exceeds max_vel_x.
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
    acc_lim_theta: float  # [rad/s^2]
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
        if not (np.isfinite(self.min_vel_x) and self.min_vel_x < self.max_vel_x):
            raise ValueError(f"min_vel_x {self.min_vel_x} must lie below max_vel_x {self.max_vel_x}")


def body_speeds(wheels: ArrayLike, robot: Robot) -> Array:
    """Body speeds v [m/s], omega [rad/s] from wheel rates `(..., 2)` (right, left) [rad/s].

    Source: thesis eq 2.7 with the factor of the second form corrected to R/L (errata T27).
    """
    w = np.asarray(wheels, dtype=float)
    right, left = robot.wheel_radius * w[..., 0], robot.wheel_radius * w[..., 1]
    return np.stack([(right + left) / 2.0, (right - left) / robot.track], axis=-1)


def wheel_speeds(command: ArrayLike, robot: Robot) -> Array:
    """Wheel rates (right, left) [rad/s] for commands `(..., 2)` of v [m/s], omega [rad/s].

    Source: thesis eq 5.9.
    """
    c = np.asarray(command, dtype=float)
    half = c[..., 1] * robot.track / 2.0
    return np.stack([c[..., 0] + half, c[..., 0] - half], axis=-1) / robot.wheel_radius


def move(pose: ArrayLike, command: ArrayLike, dt: ArrayLike) -> Array:
    """Pose `(..., 3)` after driving `(v, omega)` for dt [s] along the exact arc.

    Source: thesis eq 2.8 integrated without error; shapes broadcast.
    """
    p, c = np.asarray(pose, dtype=float), np.asarray(command, dtype=float)
    turn = c[..., 1] * dt
    chord = c[..., 0] * dt * np.sinc(turn / (2.0 * np.pi))
    middle = p[..., 2] + turn / 2.0
    x, y = p[..., 0] + chord * np.cos(middle), p[..., 1] + chord * np.sin(middle)
    return np.stack(np.broadcast_arrays(x, y, wrap(p[..., 2] + turn)), axis=-1)


def move_midpoint(pose: ArrayLike, command: ArrayLike, dt: ArrayLike) -> Array:
    """Pose after one step of the midpoint rule, which takes the arc for its chord.

    Source: thesis eq 1.1 (errata T33: not exact; the chord is shorter than the arc).
    """
    p, c = np.asarray(pose, dtype=float), np.asarray(command, dtype=float)
    turn, arc = c[..., 1] * dt, c[..., 0] * dt
    middle = p[..., 2] + turn / 2.0
    x, y = p[..., 0] + arc * np.cos(middle), p[..., 1] + arc * np.sin(middle)
    return np.stack(np.broadcast_arrays(x, y, wrap(p[..., 2] + turn)), axis=-1)


def limit(command: ArrayLike, last: ArrayLike, robot: Robot, dt: float) -> Array:
    """The command nearest to the wish that speed and acceleration limits allow from `last`."""
    (v, omega), (v0, omega0) = np.asarray(command, dtype=float), np.asarray(last, dtype=float)
    up, down = (robot.acc_lim_x, robot.dec_lim_x) if v0 >= 0 else (robot.dec_lim_x, robot.acc_lim_x)
    v = np.clip(np.clip(v, v0 - down * dt, v0 + up * dt), robot.min_vel_x, robot.max_vel_x)
    step = robot.acc_lim_theta * dt
    omega = np.clip(np.clip(omega, omega0 - step, omega0 + step), -robot.max_vel_theta, robot.max_vel_theta)
    return np.array([v, omega])


THESIS = Robot(
    name="thesis", wheel_radius=0.035, track=0.23, radius=0.3,
    max_vel_x=1.0, min_vel_x=0.0, max_vel_theta=0.35,
    acc_lim_x=0.2, dec_lim_x=0.2, acc_lim_theta=0.87, mass=6.3, inertia=0.2,
    source="limits: thesis tables 3.3 and 4.1; measures: ours",
)
TURTLEBOT2 = Robot(
    name="TurtleBot2", wheel_radius=0.035, track=0.23, radius=0.177,
    max_vel_x=0.65, min_vel_x=-0.65, max_vel_theta=3.14,
    acc_lim_x=2.5, dec_lim_x=2.5, acc_lim_theta=3.2, mass=6.3, inertia=0.1,
    source="thesis table 5.4; measures: Kobuki data sheet",
)
TURTLEBOT3_BURGER = Robot(
    name="TurtleBot3 Burger", wheel_radius=0.033, track=0.16, radius=0.105,
    max_vel_x=0.22, min_vel_x=-0.22, max_vel_theta=2.84,
    acc_lim_x=2.5, dec_lim_x=2.5, acc_lim_theta=3.2, mass=1.0, inertia=0.006,
    source="ROBOTIS e-Manual",
)
PIONEER_3DX = Robot(
    name="Pioneer 3-DX", wheel_radius=0.0975, track=0.331, radius=0.2675,
    max_vel_x=1.2, min_vel_x=-1.2, max_vel_theta=5.23,
    acc_lim_x=0.3, dec_lim_x=0.3, acc_lim_theta=1.75, mass=9.0, inertia=0.3,
    source="thesis table 5.4; measures: Adept MobileRobots data sheet",
)
