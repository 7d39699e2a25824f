"""The dynamic window in a loop: one plan every step, and a way out when the robot is stuck."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from fuzzynav.control import Observation
from fuzzynav.dwa.contact import STILL, Chart, field_at
from fuzzynav.dwa.decision import Field, Plan, plan, prepared, rated
from fuzzynav.dwa.steps import TABLE_3_3, Params
from fuzzynav.geometry import Array
from fuzzynav.robot import Robot

__all__ = ["Controller", "Stuck", "nearest_of"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Stuck:
    """When a robot counts as stuck, and how often it may turn (or back off) until the way ahead is free, and escape."""

    after: float = 3.0  # [s] without leaving a circle of `distance`
    distance: float = 0.1  # [m]
    tries: int = 0  # 0: no recovery
    clear: float = 1.5  # [m] of free way ahead that end the turn; so does a whole turn
    escape: float = 5.0  # [s] without regard for the goal after the turn
    blind: float = 3.0  # [s] of standing because nothing around was seen, until the run ends as blind


class Controller:
    """The dynamic window in a loop: one plan every call, evidence of it, and a way out when stuck.

    `weigh(observation, nearest)` gives the three weights of a step and whether its rule base covered the state; without
    it those of the parameters hold. `keep` collects every Plan in `plans`; `on_command` builds the window on the last
    command instead of the measured speed, which may be noisy. Recovery chooses among the admissible
    samples, so it is as safe as the plan; when its tries are used up, `status` is local_minimum. Where it has stood for
    `stuck.blind` seconds because its sensors told it too little (see `Plan.blind`), `status` is blind.
    """

    def __init__(
        self,
        robot: Robot,
        params: Params = TABLE_3_3,
        *,
        weigh: Callable[[Observation, float], tuple[Array, bool]] | None = None,
        field: Field | None = None,
        stuck: Stuck | None = None,
        keep: bool = False,
        on_command: bool = False,
    ) -> None:
        self.robot, self.params, self.weigh, self.field = robot, params, weigh, field
        self.stuck, self.keep, self.on_command = stuck or Stuck(), keep, on_command
        self.reset()

    def reset(self) -> None:
        """Forget everything that the last run left."""
        self.plans: list[Plan] = []
        self.evidence: dict[str, float] = {}
        self.status: str | None = None
        self._anchor: Array | None = None
        self._since = 0.0
        self._tries = 0
        self._phase: Literal["drive", "turn", "escape"] = "drive"
        self._side = 1.0
        self._until = 0.0
        self._last: Array | None = None
        self._blind_since: float | None = None

    def __call__(self, observation: Observation) -> Array:
        """Command (v [m/s], omega [rad/s]) for the next step."""
        if self.on_command and self._last is not None:
            observation = replace(observation, velocity=self._last)
        weights, covered = np.asarray(self.params.weights, dtype=float), True
        faulty = bool(observation.faults())
        if self.weigh is not None and not faulty:
            weights, covered = self.weigh(observation, nearest_of(observation, self.robot, self.field))
        if self.stuck.tries and not faulty:
            self._watch(observation)
        if self._phase == "escape":
            weights = np.array([0.0, 0.5, 0.5])
        made = plan(observation, self.robot, self.params, weights=weights, field=self.field)
        command = self._turned(made) if self._phase == "turn" else made.command
        self._last = command
        self._stand(made, command, observation.time)
        if self.keep:
            self.plans.append(made)
        self.evidence = {
            "alpha": float(weights[0]),
            "beta": float(weights[1]),
            "gamma": float(weights[2]),
            "uncovered": float(not covered),
            "samples": float(len(made.samples)),
            "nearest": made.nearest,
            "admissible": float(made.admissible.sum()),
            "braking": float(made.braking),
            "recovering": float(self._phase != "drive"),
        }
        return command

    def _stand(self, made: Plan, command: Array, now: float) -> None:
        """Name the run blind when the robot has stood long enough for want of sight."""
        if abs(command[0]) > STILL or abs(command[1]) > STILL or not made.blind:
            self._blind_since = None
        elif self._blind_since is None:
            self._blind_since = now
        elif now - self._blind_since >= self.stuck.blind - 1e-9:
            self.status = "blind"

    def _watch(self, observation: Observation) -> None:
        """Follow the phases: drive, and when stuck turn, escape, drive again."""
        now, here = observation.time, np.asarray(observation.pose, dtype=float)
        if self._anchor is None or np.hypot(*(here - self._anchor)[:2]) > self.stuck.distance:
            self._anchor, self._since = here, now
        if self._phase != "drive":
            turned = self._phase == "turn" and self._way(observation, 0.0) >= self.stuck.clear
            if turned or now >= self._until:
                self._phase = "escape" if self._phase == "turn" else "drive"
                self._until, self._since = now + self.stuck.escape, now
        elif now - self._since >= self.stuck.after:
            self._tries += 1
            if self._tries > self.stuck.tries:
                self.status = "local_minimum"
                return
            left, right = self._way(observation, 1.0), self._way(observation, -1.0)
            self._side = (1.0 if left >= right else -1.0) * (1.0 if self._tries % 2 else -1.0)
            self._phase, self._since = "turn", now
            self._until = now + 2.0 * np.pi / self.robot.max_vel_theta

    def _way(self, observation: Observation, bend: float) -> float:
        """Free way [m] of an arc: straight ahead (0), or the tightest at half speed to the left (1) or right (-1)."""
        sample = np.array([[0.5 * self.robot.max_vel_x, bend * self.robot.max_vel_theta]])
        return float(rated(observation, prepared(self.robot, self.params), sample, np.ones(3), self.field).free[0])

    def _turned(self, made: Plan) -> Array:
        """The admissible sample nearest to turning in place to the chosen side, backing off where the robot can."""
        if made.braking:
            return made.command
        v, omega = made.samples[made.admissible].T
        wish = max(self.robot.min_vel_x, -0.1)
        cost = np.abs(v - wish) / self.robot.max_vel_x + np.abs(omega - self._side * self.robot.max_vel_theta)
        k = int(np.argmin(np.round(cost, 9)))
        return np.array([v[k], omega[k]])


def nearest_of(observation: Observation, robot: Robot, field: Field | None = None) -> float:
    """Distance [m] from the robot's rim to the nearest sensed point or to the field's obstacles; inf if none."""
    here = np.asarray(observation.pose, dtype=float)
    points = np.asarray(observation.points, dtype=float).reshape(-1, 2)
    near = float(np.hypot(*(points - here[:2]).T).min(initial=np.inf))
    if field is not None:
        near = min(near, field_at(here[0], here[1], Chart(field.values, field.resolution, *field.origin)))
    return near - robot.radius
