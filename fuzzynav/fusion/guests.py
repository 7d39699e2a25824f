"""Guests: three well-known ways among moving discs, by the library navground; they must be told where the movers are.

ORCA (optimal reciprocal collision avoidance), HL (human-like) and HRVO (hybrid reciprocal velocity obstacles) plan
for a disc that sees other discs and their velocities. What stands is given to them as a small disc for each point of
the scan. They know no map: with one, they still head straight for the goal.
"""

from __future__ import annotations

import importlib
from functools import partial
from typing import Any

import numpy as np

from fuzzynav.control import Controller, Observation
from fuzzynav.fusion.task import Method, Task
from fuzzynav.geometry import Array

__all__ = ["GUESTS", "Guest", "guest"]

# chosen on the dynamic worlds that are kept for tuning
SIGHT, NEAR = 10.0, 3.0  # [m] movers farther away, and what stands farther away, are left out
DOT, THIN = 0.02, 0.1  # [m] radius of the disc that stands for a point of the scan, and how near the next one is
MARGIN = 0.1  # [m] that a guest keeps from everything
TURN_TIME = 0.1  # [s] in which it turns to where it wants to go


class Guest(Controller):
    """A behaviour of navground that drives one task."""

    def __init__(self, task: Task, name: str) -> None:
        self.task, self.name = task, name
        self.core = importlib.import_module("navground.core")
        self.reset()

    def reset(self) -> None:
        """Make the behaviour anew, with the robot's limits."""
        robot = self.task.robot
        rim = robot.max_vel_x + 0.5 * robot.track * robot.max_vel_theta
        back = -robot.min_vel_x
        wheels = self.core.kinematics.TwoWheelsDifferentialDriveKinematics(
            rim, robot.track, robot.max_vel_theta, robot.max_vel_x, back
        )
        self.behavior = getattr(self.core.behaviors, f"{self.name}Behavior")(wheels, robot.radius)
        self.behavior.optimal_speed, self.behavior.horizon = robot.max_vel_x, SIGHT
        self.behavior.safety_margin, self.behavior.rotation_tau = MARGIN, TURN_TIME
        self.behavior.target = self.core.Target.Point(self.task.goal, 0.5 * self.task.loop.goal_tolerance)

    def __call__(self, observation: Observation) -> Array:
        """Command (v [m/s], omega [rad/s]) for the next step."""
        core, state = self.core, self.behavior.environment_state
        x, y, theta = observation.pose
        v, omega = observation.velocity
        self.behavior.pose = core.Pose2((x, y), theta)
        self.behavior.twist = core.Twist2((v * np.cos(theta), v * np.sin(theta)), omega)
        rows: Any = observation.movers
        state.neighbors = [core.Neighbor(row[:2], row[4], row[2:4], k) for k, row in enumerate(rows)]
        near = observation.points[np.hypot(*(observation.points - observation.pose[:2]).T) < NEAR]
        state.static_obstacles = [core.Disc(point, DOT) for point in _standing(near, rows)]
        command = self.behavior.compute_cmd(self.task.dt, core.Frame.relative)
        return np.array([command.velocity[0], command.angular_speed], dtype=float)


def _standing(points: Array, movers: Array) -> Array:
    """Points of the scan that lie on no mover, to 5 cm; of those in one square of THIN [m], one."""
    gaps = np.linalg.norm(points[:, None] - movers[None, :, :2], axis=2) - movers[None, :, 4]
    still = points[(np.abs(gaps) > 0.05).all(axis=1)]
    return np.asarray(still[np.unique(np.floor(still / THIN), axis=0, return_index=True)[1]])


def guest(task: Task, name: str) -> Guest:
    """The guest that drives a task. Raises ValueError where the movers are not told, or navground is not installed."""
    if not task.ideal:
        raise ValueError(f"{name} must be told where the movers are: ask for ideal tracking")
    try:
        return Guest(task, name)
    except ModuleNotFoundError:
        raise ValueError(f"{name} is a guest from navground: pip install navground") from None


GUESTS: dict[str, Method] = {name: partial(guest, name=name) for name in ("ORCA", "HL", "HRVO")}
