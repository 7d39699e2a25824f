"""The fusion of thesis chapter 4 as it is printed: a path, sub-goals by their distance, an objective of end points.

Printed are the steps (section 4.4), the objective (eq 4.15), what is admissible (eq 4.13) and table 4.1. Unknown
obstacles are met by the window alone: the text lets the robot avoid them and go on along the path, it plans once. Not
printed, and ours: the radius that ends a sub-goal, delta, d_max, dt, and that a robot with nothing admissible brakes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.checks import positive
from fuzzynav.control import Observation
from fuzzynav.dwa.steps import TABLE_4_1, Params, admissible_as_printed, arcs, window
from fuzzynav.fusion.objective import WEIGHTS, checked_weights, clearances_at, improved_objective, terms
from fuzzynav.fusion.subgoals import (
    SWITCH_RADIUS,
    SubGoals,
    arc_cap,
    capped,
    sub_goals,
    switched_by_radius,
    switched_by_view,
)
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import Robot

__all__ = ["PRINTED", "Cured", "Printed", "PrintedParams", "PrintedPlan", "told_apart"]

MOVES = 1e-6  # [m/s] what is told to be faster than this moves
TIE = 1e-9  # totals nearer than this are equal: processors differ in the last digit


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedParams:
    """Parameters of the printed fusion. Raises ValueError for weights below zero or all zero, or a bad radius."""

    weights: tuple[float, float, float, float] = WEIGHTS
    window: Params = TABLE_4_1  # its horizon, dt, resolutions and d_max; resolution 0.01 m/s (errata T31)
    switch: float = SWITCH_RADIUS  # [m]

    def __post_init__(self) -> None:
        object.__setattr__(self, "weights", tuple(checked_weights(self.weights).tolist()))
        positive(switch=self.switch)


PRINTED = PrintedParams()


@dataclass(frozen=True, slots=True, eq=False)
class PrintedPlan:
    """One decision with all its evidence; row k of every array belongs to sample k, the last of which brakes."""

    command: Array  # (2,)
    samples: Array  # (n, 2)
    terms: Array  # (n, 4) PHead [deg], dist_s [m], vel [m/s], dist_d [m]
    totals: Array  # (n,) nan where refused
    admissible: NDArray[np.bool_]  # (n,)
    target: Array  # (2,) [m] the sub-goal
    chosen: int
    braking: bool  # nothing was admissible


class Printed:
    """The printed fusion in a loop: it follows the sub-goals of `path` `(n, 2)` [m] and never plans again.

    ideal: the velocities that an ideal tracker tells for points set what moves apart from what stands; without them all
    that is seen stands. An empty path ends the run as no_path. `keep` collects every plan in `plans`.
    """

    def __init__(
        self, robot: Robot, path: ArrayLike, params: PrintedParams = PRINTED, *, ideal: bool = False, keep: bool = False
    ) -> None:
        self.robot, self.params, self.ideal, self.keep = robot, params, ideal, keep
        self.path = np.asarray(path, dtype=float).reshape(-1, 2)
        self.reset()

    def reset(self) -> None:
        """Head for the first sub-goal again, and forget the run before."""
        self.plans: list[PrintedPlan] = []
        self.evidence: dict[str, float] = {}
        self.status: str | None = None if len(self.path) else "no_path"
        self.goals = sub_goals(self.path) if len(self.path) else None

    def __call__(self, observation: Observation) -> Array:
        """Command (v [m/s], omega [rad/s]) for the next step."""
        if self.goals is None:
            return np.zeros(2)
        faulty = bool(observation.faults())
        if not faulty:
            self.goals = self._followed(self.goals, observation)
        made = self._plan(observation, self.goals.current, faulty)
        if self.keep:
            self.plans.append(made)
        self.evidence = {
            "subgoal": float(self.goals.index),
            "target_x": float(made.target[0]),
            "target_y": float(made.target[1]),
            "samples": float(len(made.samples)),
            "admissible": float(made.admissible.sum()),
            "braking": float(made.braking),
        }
        return made.command

    def _followed(self, goals: SubGoals, observation: Observation) -> SubGoals:
        """The sub-goals that are left."""
        return switched_by_radius(goals, observation.pose, self.params.switch)

    def _body(self, observation: Observation, target: Array) -> Robot:
        """The robot with the limits that hold in this step."""
        return self.robot

    def _plan(self, observation: Observation, target: Array, faulty: bool) -> PrintedPlan:
        """Rate the samples of the window and take the best; without one, or without senses, brake on the arc."""
        params = self.params.window
        samples = window(observation.velocity, self.robot if faulty else self._body(observation, target), params)
        found, ok = np.full((len(samples), 4), np.nan), np.zeros(len(samples), dtype=bool)
        totals = np.full(len(samples), np.nan)
        if not faulty:
            pose = np.asarray(observation.pose, dtype=float)
            ends = arcs(pose, samples, [params.sim_time])[:, 0, :2]
            standing, moving = told_apart(observation, self.ideal)
            clear = clearances_at(ends, standing, self.robot.radius), clearances_at(ends, moving, self.robot.radius)
            ok = admissible_as_printed(samples, np.minimum(*clear), self.robot)
            found = terms(pose, samples, target, clear, params.sim_time, params.d_max)
            totals[ok] = improved_objective(found[ok], self.params.weights)
        chosen = _best(samples, totals) if ok.any() else len(samples) - 1
        return PrintedPlan(samples[chosen].copy(), samples, found, totals, ok, target, chosen, not ok.any())


class Cured(Printed):
    """The printed fusion without the orbit: the next sub-goal is taken in clear view, and the arcs are capped."""

    def __init__(
        self,
        robot: Robot,
        path: ArrayLike,
        chart: GridMap,
        params: PrintedParams = PRINTED,
        *,
        ideal: bool = False,
        keep: bool = False,
    ) -> None:
        self.chart = chart
        super().__init__(robot, path, params, ideal=ideal, keep=keep)

    def _followed(self, goals: SubGoals, observation: Observation) -> SubGoals:
        return switched_by_view(goals, observation.pose, self.chart, self.robot.radius)

    def _body(self, observation: Observation, target: Array) -> Robot:
        cap = arc_cap(observation.pose, target, self.robot.max_vel_theta)
        return capped(self.robot, cap, float(observation.velocity[0]), self.params.window.dt)


def told_apart(observation: Observation, ideal: bool = True) -> tuple[Array, Array]:
    """The sensed points `(n, 2)` that stand and those that move, as far as their velocities were told."""
    points = np.asarray(observation.points, dtype=float).reshape(-1, 2)
    moves = np.zeros(len(points), dtype=bool)
    if ideal and observation.point_velocities is not None:
        speeds = np.asarray(observation.point_velocities, dtype=float).reshape(-1, 2)
        moves = np.hypot(speeds[:, 0], speeds[:, 1]) > MOVES
    return points[~moves], points[moves]


def _best(samples: Array, totals: Array) -> int:
    """The sample of the largest total; among equal ones the fastest, then the one that turns least."""
    near = np.flatnonzero(totals >= np.nanmax(totals) - TIE)
    order = np.lexsort((np.round(np.abs(samples[near, 1]), 9), -np.round(samples[near, 0], 9)))
    return int(near[order[0]])
