"""The dynamic window approach: which speeds can be reached, which can stop in time, and which is best.

`plan` makes one decision and keeps all its evidence; `Controller` makes them in a loop and knows when it is stuck.
The steps themselves stand in `dwa_steps`, one function for each equation, and are known here by the same names.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.control import Observation
from fuzzynav.dwa import kernels
from fuzzynav.dwa.contact import _blind
from fuzzynav.dwa.steps import (
    CHAPTER_3,
    CHAPTER_4,
    Params,
    admissible,
    admissible_as_printed,
    arcs,
    brake,
    distance_score,
    end_clearance,
    free_distance,
    heading_score,
    limits_of,
    normalise,
    objective,
    speed_score,
    step,
    step_as_printed,
    stopping_distance,
    window,
    window_as_printed,
)
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import Robot

__all__ = [
    "CHAPTER_3",
    "CHAPTER_4",
    "REASONS",
    "Controller",
    "Field",
    "Params",
    "Plan",
    "Stuck",
    "admissible",
    "admissible_as_printed",
    "arcs",
    "blind_spots",
    "brake",
    "distance_score",
    "end_clearance",
    "free_distance",
    "heading_score",
    "limits_of",
    "nearest_of",
    "normalise",
    "objective",
    "plan",
    "speed_score",
    "step",
    "step_as_printed",
    "stopping_distance",
    "window",
    "window_as_printed",
]

REASONS: tuple[str, ...] = (
    "admissible",
    "cannot stop before contact",
    "cannot stop turning before contact",
    "above the printed speed bound",
    "above the printed turn bound",
)
NO_POINTS, NO_RADII = np.empty((0, 2)), np.empty(0)
NO_FIELD, NO_FRAME = np.empty((0, 0)), np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True, slots=True, eq=False)
class Field:
    """Distances [m] from cell centres to the nearest obstacle: the other way to tell `plan` what is in the way."""

    values: Array  # [row, col]
    resolution: float
    origin: tuple[float, float] = (0.0, 0.0)

    @classmethod
    def of(cls, grid: GridMap, resolution: float = 0.05) -> Field:
        """The field of a map, on cells of about `resolution` [m]: the finer, the nearer to the truth from below."""
        parts = max(int(np.ceil(grid.resolution / resolution - 1e-9)), 1)
        cells = np.kron(grid.occupied, np.ones((parts, parts), dtype=bool))
        fine = GridMap(cells, grid.resolution / parts, grid.origin)
        return cls(np.ascontiguousarray(fine.distance_field()), fine.resolution, fine.origin)


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """One decision with all its evidence; row k of every array belongs to sample k.

    The last sample is the emergency candidate. `chosen` is the sample driven; `braking` says that it is the emergency
    candidate because nothing was admissible.
    """

    command: Array  # (2,)
    samples: Array  # (n, 2)
    scores: Array  # (n, 3) shares of heading, distance and speed; 0 where refused
    raw: Array  # (n, 3) before normalising: [deg], [m], [m/s]
    totals: Array  # (n,) nan where refused
    admissible: NDArray[np.bool_]  # (n,)
    reasons: NDArray[np.int64]  # (n,) index into REASONS
    free: Array  # (n,) [m] along the arc to first contact with what was sensed; inf if none within reach
    known: Array  # (n,) [m] along the arc inside what the beams have crossed; never more than free
    stopping: Array  # (n,) [m]
    weights: Array  # (3,)
    chosen: int
    braking: bool
    nearest: float  # [m] from the rim to the nearest sensed point; inf if there is none


def blind_spots(observation: Observation) -> tuple[Array, Array]:
    """Border of what the beams have crossed: points `(n, 2)` [m] and their radii `(n,)` [m]; empty without a scan.

    Whoever stays inside it meets no standing obstacle, seen or unseen, that is wider than the gap between two beams.
    """
    if observation.ranges is None or observation.angles is None:
        return NO_POINTS, NO_RADII
    angles = np.ascontiguousarray(observation.angles, dtype=float)
    step = abs(angles[1] - angles[0]) if len(angles) > 1 else 0.0
    full = bool(len(angles) > 2 and len(angles) * step > 2.0 * np.pi - 1.5 * step)
    ranges = np.ascontiguousarray(observation.ranges, dtype=float)
    points, radii = _blind(ranges, angles, np.asarray(observation.pose), float(observation.range_max), full)
    return points, radii


def plan(
    observation: Observation,
    robot: Robot,
    params: Params = CHAPTER_3,
    *,
    weights: ArrayLike | None = None,
    field: Field | None = None,
) -> Plan:
    """The best admissible speeds for the next step; with none admissible the robot brakes on the arc it is on.

    Obstacles are the observation's points, a distance field, or both. `weights` overrides those of the parameters.

    Source: thesis eq 3.16.
    """
    v, omega = observation.velocity
    ready = _prepared(robot, params)
    if params.sampling == "closed":
        samples = kernels._window(float(v), float(omega), ready.limits, ready.settings)
    else:
        samples = np.vstack([window_as_printed((v, omega), robot, params), brake((v, omega), robot, params.dt)])
    return _rated(observation, ready, samples, weights, field)


@dataclass(frozen=True, slots=True, eq=False)
class _Prepared:
    """What the kernels need of one robot and its parameters."""

    robot: Robot
    params: Params
    limits: Array
    settings: Array
    modes: NDArray[np.bool_]
    corners: Array
    weights: Array


_PREPARED: dict[tuple[int, int], _Prepared] = {}


def _prepared(robot: Robot, params: Params) -> _Prepared:
    """The arrays of a robot and its parameters, kept by identity: both are frozen, and held here meanwhile."""
    key = (id(robot), id(params))
    found = _PREPARED.get(key)
    if found is None:
        if len(_PREPARED) > 256:
            _PREPARED.clear()
        found = _Prepared(
            robot,
            params,
            limits_of(robot),
            params.settings,
            np.array([params.distance == "end", params.bound == "as_printed"]),
            NO_POINTS if params.footprint is None else np.array(params.footprint, dtype=float),
            np.array(params.weights, dtype=float),
        )
        _PREPARED[key] = found
    return found


def _rated(
    observation: Observation, ready: _Prepared, samples: Array, weights: ArrayLike | None, field: Field | None
) -> Plan:
    """Rate samples, of which the last is the emergency candidate, and choose."""
    w = ready.weights
    if weights is not None:
        w = np.asarray(weights, dtype=float)
        if w.shape != (3,) or not min(w.tolist()) >= 0:
            raise ValueError(f"weights must be three numbers, none negative, got {w.tolist()}")
    border, radii = blind_spots(observation) if ready.params.blind else (NO_POINTS, NO_RADII)
    values = NO_FIELD if field is None else field.values
    frame = NO_FRAME if field is None else np.array([field.resolution, *field.origin])
    points = np.ascontiguousarray(observation.points, dtype=float).reshape(-1, 2)
    raw, ways, reasons, shares, totals, best, nearest = kernels._plan(
        samples,
        np.asarray(observation.pose, dtype=float),
        np.asarray(observation.goal, dtype=float),
        points,
        border,
        radii,
        values,
        frame,
        ready.corners,
        ready.limits,
        ready.settings,
        ready.modes,
        w,
    )
    chosen = len(samples) - 1 if best < 0 else best
    return Plan(
        command=samples[chosen].copy(),
        samples=samples,
        scores=shares,
        raw=raw,
        totals=totals,
        admissible=reasons == kernels.ADMISSIBLE,
        reasons=reasons,
        free=ways[:, 0],
        known=ways[:, 1],
        stopping=ways[:, 3],
        weights=w.copy(),
        chosen=chosen,
        braking=best < 0,
        nearest=float(nearest),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Stuck:
    """When a robot counts as stuck, and how often it may turn (or back off) until the way ahead is free, and escape."""

    after: float = 3.0  # [s] without leaving a circle of `distance`
    distance: float = 0.1  # [m]
    tries: int = 0  # 0: no recovery
    clear: float = 1.5  # [m] of free way ahead that end the turn; so does a whole turn
    escape: float = 5.0  # [s] without regard for the goal after the turn


class Controller:
    """The dynamic window in a loop: one plan every call, evidence of it, and a way out when stuck.

    `weigh(observation, nearest)` gives the three weights of a step and whether its rule base covered the state; without
    it those of the parameters hold. `keep` collects every Plan in `plans`; `on_command` builds the window on the last
    command instead of the measured speed, which may be noisy. Recovery chooses among the admissible
    samples, so it is as safe as the plan; when its tries are used up, `status` is local_minimum.
    """

    def __init__(
        self,
        robot: Robot,
        params: Params = CHAPTER_3,
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

    def __call__(self, observation: Observation) -> Array:
        """Command (v [m/s], omega [rad/s]) for the next step."""
        if self.on_command and self._last is not None:
            observation = replace(observation, velocity=self._last)
        weights, covered = np.asarray(self.params.weights, dtype=float), True
        if self.weigh is not None:
            weights, covered = self.weigh(observation, nearest_of(observation, self.robot, self.field))
        if self.stuck.tries:
            self._watch(observation)
        if self._phase == "escape":
            weights = np.array([0.0, 0.5, 0.5])
        made = plan(observation, self.robot, self.params, weights=weights, field=self.field)
        command = self._turned(made) if self._phase == "turn" else made.command
        self._last = command
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
        return float(_rated(observation, _prepared(self.robot, self.params), sample, (1, 1, 1), self.field).free[0])

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
        frame = (field.resolution, *field.origin)
        near = min(near, kernels._field_at(here[0], here[1], field.values, *frame))
    return near - robot.radius
