"""The two blends as controllers: as printed, and the safe form of it. The compiled steps stand in `kernels`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fuzzynav.blend import kernels
from fuzzynav.blend.points import MEMORY, remember
from fuzzynav.blend.records import MIND
from fuzzynav.blend.rules import table_5_1
from fuzzynav.blend.schemes import PrintedScheme, SafeScheme
from fuzzynav.control import Controller, Observation
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.fuzzy.compiled import Tables
from fuzzynav.geometry import Array
from fuzzynav.robot import TURTLEBOT2, Robot
from fuzzynav.tracking.dfl import Dfl
from fuzzynav.tracking.records import Records
from fuzzynav.tracking.reference import Reference
from fuzzynav.tracking.tracker import Tracker

__all__ = ["PrintedBlend", "SafeBlend"]


def weight_tables(system: FuzzySystem) -> Tables:
    """The rule base as the kernels read it. Raises ValueError unless it has two inputs and one output."""
    if len(system.inputs) != 2 or len(system.outputs) != 1:
        raise ValueError("the weight needs a rule base with two inputs, distance and bearing, and one output F")
    return system.tables


def fresh_mind(tracker: Tracker) -> Records:
    """The mind before the first step, an array of one record: no detour yet, the speeds of the reference."""
    mind, first = np.zeros(1, MIND), tracker.rows[0]
    mind["released"], mind["v"], mind["omega"] = -np.inf, first.v, first.omega
    return mind


def _points(observation: Observation) -> Array:
    """Sensed points (n, 4) with their velocities, 0 where unknown. Raises ValueError for a pose of nan."""
    if not np.isfinite(observation.pose).all():
        raise ValueError(f"the measured pose is not finite: {np.asarray(observation.pose).tolist()}")
    out = np.zeros((len(observation.points), 4))
    out[:, :2] = observation.points
    if observation.point_velocities is not None:
        out[:, 2:] = observation.point_velocities
    return out


class PrintedBlend(Controller):
    """The thesis' controller: DFL, the turn of eq 5.5 inside the gate, both blended by F; as it is printed."""

    def __init__(
        self,
        reference: Reference,
        scheme: PrintedScheme | None = None,
        *,
        law: Dfl | None = None,
        system: FuzzySystem | None = None,
        robot: Robot = TURTLEBOT2,
        dt: float = 0.1,
    ) -> None:
        self.tracker = Tracker(reference, law or Dfl(), robot, dt)
        self.scheme = scheme or PrintedScheme()
        self.parameters = self.scheme.record
        self.tables = weight_tables(system or table_5_1())
        self.reset()

    def reset(self) -> None:
        """Forget the run before."""
        self.tracker.reset()
        self._evidence: dict[str, float] = {}

    @property
    def status(self) -> str | None:
        """'done' at the end of the reference."""
        return self.tracker.status

    @property
    def evidence(self) -> Mapping[str, Any]:
        """F of the last step."""
        return self._evidence

    def __call__(self, observation: Observation) -> Array:
        """Command for this observation."""
        points, command = _points(observation), self.tracker(observation)
        pose = np.asarray(observation.pose, dtype=float)
        f = kernels.printed_step(self.parameters, self.tables, points, pose, command)
        self._evidence = {"F": f}
        return command


class SafeBlend(Controller):
    """DFL and avoidance, switched by a forecast with memory and weighted by F; the reference waits meanwhile.

    Avoidance takes over when tracking alone would come too near to a sensed point, and hands back when tracking
    would not: both questions are answered by driving the tracking law ahead in thought. Meanwhile the time of the
    reference follows the robot's progress along the curve, and the tracker's integrator follows the speed sent.
    """

    def __init__(
        self,
        reference: Reference,
        scheme: SafeScheme | None = None,
        *,
        law: Dfl | None = None,
        system: FuzzySystem | None = None,
        robot: Robot = TURTLEBOT2,
        dt: float = 0.1,
    ) -> None:
        self.tracker = Tracker(reference, law or Dfl(), robot, dt)
        self.scheme, known = scheme or SafeScheme(), system or table_5_1()
        self.tables = weight_tables(known)
        self.parameters = self.scheme.record(known, robot.radius)
        self.reset()

    def reset(self) -> None:
        """Forget the run before."""
        self.tracker.reset()
        self.memory, self.count, self._mind = np.empty((MEMORY, 4)), 0, fresh_mind(self.tracker)
        self._evidence: dict[str, float] = {}

    @property
    def mind(self) -> Any:
        """What the blend knows, a record: mind.index, .latched, .weight, ... (see `records.MIND`)."""
        return self._mind[0]

    @property
    def status(self) -> str | None:
        """'done' at the end of the reference."""
        return "done" if self.mind.index >= self.tracker.steps else None

    @property
    def evidence(self) -> Mapping[str, Any]:
        """F, weight, avoiding and reference time [s] of the last step."""
        return self._evidence

    def __call__(self, observation: Observation) -> Array:
        """Command for this observation."""
        pose, seen = np.asarray(observation.pose, dtype=float), _points(observation)
        mind, tracker, reach = self.mind, self.tracker, self.scheme.reach
        k = int(mind.index)
        if k >= tracker.steps:
            return np.zeros(2)
        seen = seen[np.hypot(seen[:, 0] - pose[0], seen[:, 1] - pose[1]) < reach]
        self.count = remember(self.memory, self.count, seen, pose, reach, self.scheme.moving)
        state, points = tracker.state, self.memory[: self.count]
        mind.time = observation.time
        kernels.safe_step(
            self.parameters, self._mind, state.gains, state.memory, tracker.rows, self.tables, points, pose
        )
        self._evidence = {
            "F": float(mind.fuzzy),
            "weight": float(mind.weight),
            "avoiding": float(mind.latched),
            "reference_time": k * tracker.dt,
        }
        return np.array([mind.v, mind.omega])
