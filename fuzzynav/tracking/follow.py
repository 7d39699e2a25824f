"""A tracker in closed loop with the kinematic robot, its limits and its disturbances.

The same step is used compiled, for the laws of `laws`, and from Python, for any controller; both give the same run.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array, wrap
from fuzzynav.robot import TURTLEBOT2, Robot, wheel_speeds
from fuzzynav.tracking.kernels import MPC, _drive, _limit, _run, limits_of
from fuzzynav.tracking.tracker import Tracker, seen

__all__ = ["IDEAL", "Disturbance", "Trace", "follow"]

SLIP_TIME = 1.0  # [s] a wheel's slip is drawn anew this often


@dataclass(frozen=True, slots=True, kw_only=True)
class Disturbance:
    """What stands between a law and the ideal robot; all zero is the ideal robot.

    Raises ValueError for a negative value (the two radius errors may have either sign) or slip of 1 and more.
    """

    position_noise: float = 0.0  # [m] standard deviation of each measured coordinate
    heading_noise: float = 0.0  # [rad] standard deviation of the measured heading
    slip: float = 0.0  # greatest share of its speed that a wheel loses
    delay: float = 0.0  # [s] from a command to its effect
    right_radius: float = 0.0  # relative error of the true radius of the right wheel
    left_radius: float = 0.0
    motor_lag: float = 0.0  # [s] time constant of the wheels

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            signed = field.name in ("right_radius", "left_radius")
            if not np.isfinite(value) or (value < 0 and not signed) or (signed and abs(value) >= 1):
                raise ValueError(f"{field.name} must be finite and {'below 1' if signed else 'not negative'}: {value}")
        if self.slip >= 1.0:
            raise ValueError(f"slip is the share of speed lost and must be below 1, got {self.slip}")

    def draws(self, steps: int, dt: float, rng: np.random.Generator | int) -> tuple[Array, Array]:
        """Measurement noise `(steps, 3)` and wheel slip `(steps, 2)` of one run."""
        generator = np.random.default_rng(rng)
        noise = generator.standard_normal((steps, 3))
        noise *= [self.position_noise, self.position_noise, self.heading_noise]
        hold = max(round(SLIP_TIME / dt), 1)
        slip = self.slip * generator.random((steps // hold + 1, 2))
        return noise, np.repeat(slip, hold, axis=0)[:steps]


IDEAL = Disturbance()


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """One run of n steps: entry k + 1 of the poses is where command k led."""

    t: Array  # (n + 1,) [s]
    poses: Array  # (n + 1, 3) true poses
    wanted: Array  # (n + 1, 3) poses of the reference
    commands: Array  # (n, 2) after the limits, before the disturbances
    driven: Array  # (n, 2) true body speeds
    status: str  # done, or diverged when the position left the plane of numbers

    @property
    def errors(self) -> Array:
        """Reference minus pose `(n + 1, 3)`: x [m], y [m], heading [rad] wrapped."""
        gap = self.wanted - self.poses
        return np.concatenate([gap[:, :2], wrap(gap[:, 2:])], axis=1)

    @property
    def distance(self) -> Array:
        """Distance `(n + 1,)` [m] from the reference's position."""
        return np.hypot(*self.errors[:, :2].T)

    @property
    def rms(self) -> Array:
        """Root mean square of the errors `(3,)`: x [m], y [m], heading [rad]."""
        return np.sqrt((self.errors**2).mean(axis=0))

    @property
    def rms_distance(self) -> float:
        """Root mean square distance [m] from the reference."""
        return float(np.sqrt((self.distance**2).mean()))

    @property
    def max_distance(self) -> float:
        """Largest distance [m] from the reference."""
        return float(self.distance.max())

    @property
    def length(self) -> float:
        """Length [m] of the driven path, the arcs themselves."""
        return float(np.abs(self.driven[:, 0]).sum() * (self.t[1] - self.t[0]))

    def after(self, time: float) -> Trace:
        """The part of the run from `time` [s] on."""
        k = int(np.searchsorted(self.t, time - 1e-9))
        return Trace(self.t[k:], self.poses[k:], self.wanted[k:], self.commands[k:], self.driven[k:], self.status)

    def effort(self, robot: Robot = TURTLEBOT2) -> float:
        """Root mean square acceleration [rad/s^2] asked of the wheels."""
        rates = np.diff(wheel_speeds(self.commands, robot), axis=0) / (self.t[1] - self.t[0])
        return float(np.sqrt((rates**2).mean()))


def follow(
    tracker: Tracker,
    start: ArrayLike | None = None,
    *,
    disturbance: Disturbance = IDEAL,
    rng: np.random.Generator | int = 0,
    duration: float | None = None,
    euler: bool = False,
    compiled: bool = True,
) -> Trace:
    """Drive a tracker along its reference from `start` (x, y, theta); None starts exactly on the reference.

    The robot starts with the speeds of the reference. euler: integrate as the thesis does, else along exact arcs.
    compiled False runs the same steps in Python. Raises ValueError for a start that is not finite, or a duration
    shorter than one step.
    """
    dt = tracker.dt
    span = tracker.reference.duration if duration is None else duration
    steps = min(int(np.floor(span / dt + 1e-9)), tracker.steps) if np.isfinite(span) else 0
    if steps < 1:
        raise ValueError(f"the duration must be finite and at least one step of {dt} s, got {span}")
    rows = tracker.rows[: steps + 1]
    pose: Array = rows[0, [0, 1, 6]] if start is None else np.array(start, dtype=float)
    if pose.shape != (3,) or not np.isfinite(pose).all():
        raise ValueError(f"start must be a finite pose x, y, theta, got {pose.tolist()}")
    noise, slip = disturbance.draws(steps, dt, rng)
    body = np.array([tracker.robot.wheel_radius, tracker.robot.track, disturbance.motor_lag])
    plant = np.array([disturbance.right_radius, disturbance.left_radius])
    given = (noise, slip, round(disturbance.delay / dt), body, plant, limits_of(tracker.robot), dt, euler)
    made: tuple[Array, ...] = np.empty((steps + 1, 3)), np.empty((steps, 2)), np.empty((steps, 2))
    if compiled and 0 <= tracker.kind < MPC and tracker.observer is None:
        _run(tracker.kind, tracker.vector, rows, pose, *given, *made)
    else:
        _run_in_python(tracker, rows, pose, given, made)
    fine = np.isfinite(made[0]).all() and np.abs(made[0][:, :2]).max() < 1e6
    wanted = rows[:, [0, 1, 6]]
    return Trace(dt * np.arange(steps + 1.0), made[0], wanted, made[1], made[2], "done" if fine else "diverged")


def _run_in_python(
    tracker: Tracker, rows: Array, start: Array, given: tuple[Any, ...], made: tuple[Array, ...]
) -> None:
    """The loop of `_run`, for controllers that are not compiled."""
    noise, slip, late, body, plant, lim, dt, euler = given
    poses, commands, driven = made
    tracker.reset()
    pose, last = start.copy(), rows[0, 7:9].copy()
    wheels = (last[0] + np.array([0.5, -0.5]) * last[1] * body[1]) / body[0]
    first = last.copy()
    poses[0] = pose
    for k in range(len(commands)):
        wish = tracker(seen(k * dt, pose + noise[k], last))
        _limit(wish, last, lim, dt)
        last = wish.copy()
        commands[k] = wish
        _drive(pose, wheels, commands[k - late] if k >= late else first, slip[k], body, plant, dt, euler, driven[k])
        poses[k + 1] = pose
