"""The contract between a robot and whoever drives it: what a controller is told, and what it answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numba import njit
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array

__all__ = ["FAULTS", "Controller", "Observation"]

FAULTS: tuple[str, ...] = ("the pose is not finite", "a point is not finite", "the scanner's range is no length")
MOVER = 5  # numbers of one mover
_NONE = np.empty(0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observation:
    """What a controller is told at one moment.

    points are sensed obstacle points in the world frame as believed; the scan fields are there where a scan was made.
    """

    time: float  # [s]
    pose: Array  # (3,) x [m], y [m], theta [rad], as believed
    velocity: Array  # (2,) v [m/s], omega [rad/s], as measured
    goal: Array  # (2,) [m]
    points: Array  # (n, 2) [m]
    point_velocities: Array | None = None  # (n, 2) [m/s]
    movers: Array | None = None  # (m, 5) x, y [m], their velocity [m/s] and radius [m]: told by an ideal tracker
    ranges: Array | None = None  # (k,) [m]
    angles: Array | None = None  # (k,) [rad], body frame
    range_max: float = np.inf  # [m]

    def faults(self) -> str:
        """The sensor fault, one of FAULTS, that makes the observation worthless; empty where there is none.

        A beam that reads nan is none: beams drop out. Raises ValueError for what no sensor can have said: shapes that
        do not fit, a measured speed, a goal or a beam's angle that is not finite.
        """
        pose, velocity = np.asarray(self.pose, dtype=float), np.asarray(self.velocity, dtype=float)
        goal, points = np.asarray(self.goal, dtype=float), np.ascontiguousarray(self.points, dtype=float)
        if pose.shape != (3,) or velocity.shape != (2,) or goal.shape != (2,):
            raise ValueError(
                "pose, velocity and goal must be 3, 2 and 2 numbers, got arrays of shape "
                f"{pose.shape}, {velocity.shape} and {goal.shape}"
            )
        if points.size and (points.ndim != 2 or points.shape[1] != 2):
            raise ValueError(f"points must be rows of x and y, got an array of shape {points.shape}")
        if self.movers is not None:
            self._told_movers()
        ranges, angles, reach = _NONE, _NONE, 1.0
        if self.ranges is not None or self.angles is not None:
            ranges, angles = self._beams()
            reach = float(self.range_max)
        found = _fault(pose, velocity, goal, points.reshape(-1), ranges, angles, reach)
        if found < 0:
            name, value = (("velocity", velocity), ("goal", goal), ("angles", angles))[-found - 1]
            raise ValueError(f"{name} must be finite, got {value.tolist()}")
        return FAULTS[found - 1] if found else ""

    def _told_movers(self) -> None:
        """Refuse rows of movers that no tracker can have told."""
        rows = np.asarray(self.movers, dtype=float)
        if rows.size and (rows.ndim != 2 or rows.shape[1] != MOVER or not np.isfinite(rows).all()):
            raise ValueError(f"movers must be finite rows of x, y, their velocity and radius, got {rows.tolist()}")

    def _beams(self) -> tuple[Array, Array]:
        """Ranges and angles of the scan, of one length."""
        if self.ranges is None or self.angles is None:
            raise ValueError("a scan needs both ranges and angles")
        ranges = np.ascontiguousarray(self.ranges, dtype=float)
        angles = np.ascontiguousarray(self.angles, dtype=float)
        if ranges.ndim != 1 or ranges.shape != angles.shape:
            raise ValueError(f"a scan needs one range for each angle, got shapes {ranges.shape} and {angles.shape}")
        return ranges, angles


@njit(cache=True)
def _fault(
    pose: Array, velocity: Array, goal: Array, points: Array, ranges: Array, angles: Array, range_max: float
) -> int:
    """Number of the fault in FAULTS, from 1; 0: none; -1, -2, -3: velocity, goal, angles are not finite."""
    if not (np.isfinite(velocity[0]) and np.isfinite(velocity[1])):
        return -1
    if not (np.isfinite(goal[0]) and np.isfinite(goal[1])):
        return -2
    for i in range(angles.size):
        if not np.isfinite(angles[i]):
            return -3
    if not (np.isfinite(pose[0]) and np.isfinite(pose[1]) and np.isfinite(pose[2])):
        return 1
    for i in range(points.size):
        if not np.isfinite(points[i]):
            return 2
    return 0 if range_max > 0.0 else 3


class Controller(Protocol):
    """What drives a robot: called once every step, reset before every run.

    `status` and `evidence` may be plain attributes. A class that has neither inherits from this one: no reason to end
    the run, nothing to record.
    """

    @property
    def status(self) -> str | None:
        """A named reason to end the run; None while there is none."""
        return None

    @property
    def evidence(self) -> Mapping[str, Any]:
        """Numbers of the last call that the run shall record."""
        return {}

    def __call__(self, observation: Observation) -> ArrayLike:
        """Command (v [m/s], omega [rad/s]) for the next step."""
        ...

    def reset(self) -> None:
        """Forget the run before."""
        ...


def _warm() -> None:
    """Compile the check for the types used in practice."""
    for rows in (np.zeros((0, 2)), np.zeros((1, 2))):
        still, scan = np.zeros(2), np.zeros(1)
        Observation(
            time=0.0, pose=np.zeros(3), velocity=still, goal=still, points=rows, ranges=scan, angles=scan
        ).faults()
