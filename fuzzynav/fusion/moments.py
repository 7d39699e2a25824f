"""What the planner of chapter 07 knew and decided at every step of a run, for pictures and exercises."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzynav.control import Controller, Observation
from fuzzynav.fusion.controller import Navigator
from fuzzynav.fusion.decision import Decision, Params
from fuzzynav.fusion.guide import Planning
from fuzzynav.fusion.methods import OURS, PLANNING, ours
from fuzzynav.fusion.protocol import Driven, drive
from fuzzynav.fusion.sensed import Surroundings
from fuzzynav.fusion.task import Task
from fuzzynav.fusion.tracks import Tracks
from fuzzynav.geometry import Array

__all__ = ["Moment", "Witness", "watch"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Moment:
    """One step of a run as the planner saw it."""

    observation: Observation
    around: Surroundings
    decision: Decision
    tracks: Tracks | None
    way: Array  # (n, 2) [m] over the map, from where it was sought
    searches: int  # so far
    entered: NDArray[np.bool_]  # cells of the remembered map that the scanner filled


class Witness(Controller):
    """Drives as its planner does, and keeps a Moment of every step in `moments`."""

    def __init__(self, planner: Navigator) -> None:
        self.planner = planner
        self.moments: list[Moment] = []

    @property
    def status(self) -> str | None:
        """The planner's."""
        return self.planner.status

    @property
    def evidence(self) -> dict[str, float]:
        """The planner's."""
        return self.planner.evidence

    def reset(self) -> None:
        """Forget the run before."""
        self.planner.reset()
        self.moments = []

    def __call__(self, observation: Observation) -> Array:
        """The planner's command (v [m/s], omega [rad/s])."""
        command, planner = self.planner(observation), self.planner
        if planner.decision is not None and planner.around is not None:
            way = planner.guide.way
            self.moments.append(
                Moment(
                    observation=observation,
                    around=planner.around,
                    decision=planner.decision,
                    tracks=planner.tracks,
                    way=np.empty((0, 2)) if way is None else way.points,
                    searches=planner.guide.searches,
                    entered=planner.guide.memory.evidence > 0,
                )
            )
        return command


def watch(
    task: Task, params: Params = OURS, planning: Planning = PLANNING, seed: int = 0
) -> tuple[Driven, list[Moment]]:
    """The planner of this chapter driven through a task, and a Moment for every step of its run."""
    made: list[Witness] = []

    def method(given: Task) -> Witness:
        made.append(Witness(ours(given, params, planning)))
        return made[-1]

    driven = drive(task, method, seed=seed)
    return driven, made[-1].moments if made else []
