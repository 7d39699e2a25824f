"""The differential-drive robot: its measures, its limits, and the four robots of the course."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fuzzynav import checks
from fuzzynav.geometry import Array
from fuzzynav.robot.kernels import LIMITS

__all__ = ["PIONEER_3DX", "THESIS", "TURTLEBOT2", "TURTLEBOT3_BURGER", "Robot", "limits_of"]


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
        checks.positive_fields(self, leave=("name", "source", "min_vel_x"))
        number = isinstance(self.min_vel_x, int | float | np.integer | np.floating)
        if not (number and np.isfinite(self.min_vel_x) and self.min_vel_x <= 0 < self.max_vel_x):
            raise ValueError(f"min_vel_x must be finite and at most 0, so that the robot may stop: {self.min_vel_x}")


def limits_of(robot: Robot) -> Array:
    """The robot's limits as every compiled loop reads them: an array of one LIMITS record.

    >>> limits_of(THESIS)["gain"].item()
    0.2
    """
    values = (
        robot.min_vel_x,
        robot.max_vel_x,
        robot.max_vel_theta,
        robot.acc_lim_x,
        robot.dec_lim_x,
        robot.acc_lim_theta,
        robot.radius,
    )
    return np.array([values], dtype=LIMITS)


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
