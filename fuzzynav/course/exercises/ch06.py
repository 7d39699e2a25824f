"""Exercises of chapter 06: braking distance, the missing window end, a gap at cruise, tuning, the last safe speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from fuzzynav import dwa
from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.dwa.decision import Field, Params
from fuzzynav.dwa.fast import RULES, drive
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.fuzzy.variable import RuleBlock
from fuzzynav.robot import THESIS, Robot
from fuzzynav.studies.dwa.comparison import GOAL, START, random_map
from fuzzynav.world import World

__all__ = ["CLEARANCE", "EXERCISES", "MAPS", "STEPS", "with_rules"]

Function = Callable[..., Any]
MAPS = ("0.05/40001", "0.05/40004", "0.05/40010")
CLEARANCE, STEPS = 0.3, 400


def _number(value: Any, what: str) -> float:
    """The answer as one finite number, or a sentence."""
    found = np.asarray(value)
    if found.size != 1 or found.dtype.kind not in "fiu" or not np.isfinite(found).all():
        raise Wrong(f"{what} should be one finite number, not {value!r}.")
    return float(found.reshape(-1)[0])


# --- 06.1


def _check_braking(answer: Function) -> str:
    """Seeded speeds against the sum of the steps."""
    rng = np.random.default_rng(61)
    if abs(_number(answer(0.0, 0.2, 0.1), "The distance at rest")) > 1e-12:
        raise Wrong("A robot at rest needs no way to stop: the distance at v = 0 is 0.")
    for _ in range(12):
        a, dt = float(rng.choice([0.2, 0.5, 1.0])), float(rng.choice([0.05, 0.1, 0.2]))
        v = float(rng.integers(1, 12)) * a * dt
        robot = replace(THESIS, dec_lim_x=a, max_vel_x=5.0)
        need = float(dwa.stopping_distance([[v, 0.0]], robot, dt)[0])
        told = _number(answer(v, a, dt), "The distance")
        if abs(told - v * v / (2 * a)) < 1e-9:
            raise Wrong(
                f"v^2/2a = {told:.4f} m forgets that {v:.2f} m/s is driven for {dt:g} s before braking shows: "
                f"the way is {need:.4f} m."
            )
        if abs(told - need) > 1e-6:
            raise Wrong(
                f"From {v:.2f} m/s with {a:g} m/s^2 in steps of {dt:g} s the robot stops after {need:.4f} m, "
                f"not {told:.4f}."
            )
    return "The robot stops where you say."


# --- 06.2


def _check_window(answer: Function) -> str:
    """Both ends, zero where it lies inside, and no gap wider than the step."""
    rng = np.random.default_rng(62)
    for _ in range(30):
        low, step = float(rng.uniform(-0.3, 0.9)), float(rng.choice([0.005, 0.01, 0.017, 0.1]))
        high = low + float(rng.uniform(0.0, 0.2))
        values = np.asarray(answer(low, high, step), dtype=float)
        if values.ndim != 1 or values.size == 0 or not np.isfinite(values).all():
            raise Wrong("The samples should be a row of finite speeds with at least one in it.")
        if abs(values.max() - high) > 1e-9:
            raise Wrong(
                f"The window reaches {high:.4f} m/s, your fastest sample is {values.max():.4f}: "
                "this robot never drives its top speed."
            )
        if abs(values.min() - low) > 1e-9:
            raise Wrong(
                f"The window starts at {low:.4f} m/s, your slowest sample is {values.min():.4f}: "
                "this robot cannot brake fully."
            )
        if low < 0.0 < high and np.abs(values).min() > 1e-12:
            raise Wrong(f"Between {low:.3f} and {high:.3f} m/s lies 0, and standing still is not among your samples.")
        if np.diff(np.sort(values)).max(initial=0.0) > step + 1e-9:
            widest = np.diff(np.sort(values)).max()
            raise Wrong(f"Two of your samples lie {widest:.4f} m/s apart; the step is {step:g}.")
    return "Both ends, zero, and no gap."


# --- 06.3


def with_rules(texts: Any) -> FuzzySystem:
    """The rule base of table 3.2 with more rules; raises Wrong where one cannot be read."""
    system = FuzzySystem.load(RULES / "thesis_table_3_2.fll")
    if isinstance(texts, str) or not all(isinstance(t, str) for t in texts):
        raise Wrong("Give a list of rules, each a text like those of table 3.2.")
    block = system.blocks[0]
    joined: FuzzySystem | str = ""
    try:
        joined = replace(
            system,
            blocks=(
                RuleBlock(
                    rules=(*block.rules, *texts),
                    name=block.name,
                    conjunction=block.conjunction,
                    disjunction=block.disjunction,
                    implication=block.implication,
                ),
            ),
        )
    except ValueError as error:
        joined = str(error)
    if isinstance(joined, str):
        raise Wrong(f"A rule cannot be read: {joined}")
    return joined


def _check_gap(answer: Any) -> str:
    """No silent state at cruise, and weights that make sense there."""
    system = with_rules(answer)
    for head in (0.0, 5.0, 20.0):
        for distance in (0.5, 4.0, 12.0):
            for speed in (0.8, 0.95, 1.0):
                found = system.evaluate(head, distance, speed)
                if not float(np.max(found.firing)) > 0.0:
                    raise Wrong(
                        f"At {head:.0f} deg from the goal, {distance:g} m from an obstacle and {speed:g} m/s "
                        "no rule fires: the robot cruises on the default weights."
                    )
    near, far = (np.array([float(v) for v in system(0.0, d, 1.0)]) for d in (0.3, 14.0))
    if near[1] <= far[1]:
        raise Wrong(
            f"At full speed beta is {near[1]:.2f} close to an obstacle and {far[1]:.2f} far from it: clearance "
            "should count more when something is near."
        )
    return f"At cruise, close to an obstacle, beta is now {near[1]:.2f}, far from it {far[1]:.2f}."


# --- 06.4


@cache
def _scene(case: str) -> tuple[World, Field]:
    grid = random_map(case)
    return World(grid=grid), Field.of(grid)


def _check_tuning(answer: Any) -> str:
    """Three maps: arrive, keep the clearance, and in time."""
    weights = np.asarray(answer, dtype=float).ravel()
    if weights.shape != (3,) or not np.isfinite(weights).all() or weights.min() < 0 or weights.max() <= 0:
        raise Wrong("Give three weights, alpha, beta, gamma: none negative, not all zero.")
    params = Params(weights=tuple(float(w) for w in weights), distance="end")  # type: ignore[arg-type]
    least, longest = np.inf, 0
    for k, case in enumerate(MAPS, start=1):
        world, field = _scene(case)
        made = drive(world, START, GOAL, params, field=field)
        if made.status != "reached":
            x, y = made.poses[-1, :2]
            raise Wrong(f"On map {k} the run ends '{made.status}' at ({x:.1f}, {y:.1f}) m.")
        if made.min_clearance < CLEARANCE:
            raise Wrong(
                f"On map {k} the robot passes {made.min_clearance:.2f} m from a wall; the limit is {CLEARANCE} m."
            )
        if made.iterations > STEPS:
            raise Wrong(f"On map {k} the robot takes {made.iterations} steps; the limit is {STEPS}.")
        least, longest = min(least, made.min_clearance), max(longest, made.iterations)
    return f"Least clearance {least:.2f} m, at most {longest} steps."


# --- 06.5


def _check_speed(answer: Any) -> str:
    """The fastest speed that still stops 0.8 m before a wall."""
    told = _number(answer, "The speed")
    robot: Robot = THESIS
    speeds = np.linspace(0.0, 1.0, 10001)
    need = dwa.stopping_distance(np.column_stack([speeds, np.zeros_like(speeds)]), robot, 0.1)
    limit = float(speeds[need <= 0.8].max())
    if told > limit + 0.005:
        way = float(dwa.stopping_distance([[told, 0.0]], robot, 0.1)[0])
        raise Wrong(f"At 0.8 m from the wall {told:.3f} m/s cannot stop, it needs {way:.3f} m: the limit is lower.")
    if told < limit - 0.005:
        raise Wrong(f"{told:.3f} m/s stops with room to spare: a little more is still safe.")
    return f"The limit is {limit:.3f} m/s; sqrt(2 d a) = {np.sqrt(2 * 0.8 * 0.2):.3f} would run into the wall."


EXERCISES: tuple[Exercise, ...] = (
    Exercise(
        "06.1",
        "The way to a stop, in steps",
        2,
        (
            "In the first dt the robot still drives v.",
            "Then v - a dt, v - 2 a dt, ... until nothing is left: add them up, each times dt.",
        ),
        _check_braking,
    ),
    Exercise(
        "06.2",
        "The missing end of the window",
        2,
        (
            "np.arange leaves out its upper end.",
            "np.linspace keeps both ends: how many intervals make the step small enough? Then put 0.0 in its place.",
        ),
        _check_window,
    ),
    Exercise(
        "06.3",
        "A rule for cruise",
        2,
        (
            "Which combination of terms describes a robot that heads for the goal at full speed?",
            "'if headGoal is Little and distObs is Far and velRob is Fast then ...', also with Medium and Close.",
        ),
        _check_gap,
    ),
    Exercise(
        "06.4",
        "Weights for a clearance",
        3,
        (
            "Use the lab of the weights: too much alpha stalls, too much beta dawdles.",
            "Try alpha near 0.2 and share the rest between beta and gamma.",
        ),
        _check_tuning,
    ),
    Exercise(
        "06.5",
        "Predict: 0.8 m before a wall",
        1,
        (
            "v^2/2a + v dt/2 is the way to a stop.",
            "Solve the quadratic equation for v with a = 0.2 and dt = 0.1.",
        ),
        _check_speed,
    ),
)
