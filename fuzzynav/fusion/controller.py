"""The planner of chapter 07: a way over the map, sub-goals on it, and a window that keeps clear of what may move."""

from __future__ import annotations

import numpy as np

from fuzzynav.control import Observation
from fuzzynav.dwa.steps import brake
from fuzzynav.fusion.decision import Decision, Params, decide
from fuzzynav.fusion.guide import Guide, Planning
from fuzzynav.fusion.sensed import Surroundings, surroundings
from fuzzynav.fusion.tracks import Tracker, Tracks
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import Robot

__all__ = ["Navigator"]

PARAMS, PLANNING = Params(), Planning()


class Navigator:
    """The planner of chapter 07 as a controller.

    `speed_bound` [m/s] is the one thing that it is told about movers: none is faster. Where an ideal tracker tells
    their places it uses them, otherwise its scans, and `tracker` for the prediction. `keep` collects every Decision in
    `decisions`. Raises ValueError for a speed bound below 0.
    """

    def __init__(
        self,
        robot: Robot,
        *,
        speed_bound: float,
        chart: GridMap | None = None,
        params: Params = PARAMS,
        planning: Planning = PLANNING,
        tracker: Tracker | None = None,
        keep: bool = False,
    ) -> None:
        if not 0 <= speed_bound < np.inf:
            raise ValueError(f"the speed bound of movers must be 0 m/s or more, got {speed_bound}")
        self.robot, self.params, self.planning, self.speed_bound = robot, params, planning, speed_bound
        self.chart, self.tracker, self.keep = chart, tracker, keep
        self.guide = Guide(robot.radius, planning, chart, speed_bound)
        self.status: str | None = None
        self.reset()

    def reset(self) -> None:
        """Forget everything that the last run left."""
        self.guide.reset()
        if self.tracker is not None:
            self.tracker.reset()
        self.tracks: Tracks | None = None
        self.around: Surroundings | None = None
        self.decision: Decision | None = None
        self.decisions: list[Decision] = []
        self.evidence: dict[str, float] = {}

    def __call__(self, observation: Observation) -> Array:
        """Command (v [m/s], omega [rad/s]) for the next step; with faulty sensors the robot brakes."""
        if observation.faults():
            return brake(observation.velocity, self.robot, self.params.dt)
        if self.tracker is not None and observation.movers is None:
            self.tracks = self.tracker.update(observation, self.chart)
        self.around = surroundings(
            observation,
            self.robot.radius,
            self.params.thinnest,
            chart=self.chart,
            tracks=self.tracks,
            tell=self.planning.explained,
            trusts=self.params.evasion is not None,
        )
        target = self.guide.update(observation, self.around)
        made = decide(observation, target, self.around, self.robot, self.params, self.speed_bound)
        self.decision = made
        if self.keep:
            self.decisions.append(made)
        self.evidence = self._noted(made)
        return made.command

    def _noted(self, made: Decision) -> dict[str, float]:
        """Numbers of the step for the record."""
        admissible, chosen = made.reasons == 0, made.chosen
        return {
            "target_x": float(made.target[0]),
            "target_y": float(made.target[1]),
            "searches": float(self.guide.searches),
            "samples": float(len(made.samples)),
            "admissible": float(admissible.sum()),
            "braking": float(made.braking),
            "guarded": float((made.reasons == 3).sum()),
            "predicted": float(made.ways[chosen, 4]),
            "tracked": 0.0 if self.around is None else float(len(self.around.movers)),
        }
