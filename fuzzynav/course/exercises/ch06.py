"""Exercises of chapter 06: braking distance, the missing window end, a gap at cruise, tuning, the last safe speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from fuzzynav import dwa
from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.course.exercises.answers import close, named, number, numbers
from fuzzynav.course.exercises.ch03 import with_rules
from fuzzynav.dwa.decision import Field
from fuzzynav.dwa.fast import drive
from fuzzynav.dwa.steps import Params
from fuzzynav.robot import THESIS
from fuzzynav.studies.dwa.comparison import GOAL, START, random_map
from fuzzynav.world import World

__all__ = ["CLEARANCE", "EXERCISES", "MAPS", "STEPS"]

Function = Callable[..., Any]
MAPS = ("0.05/40001", "0.05/40004", "0.05/40010")
CLEARANCE, STEPS = 0.3, 400


# --- 06.1


def _check_braking(answer: Function) -> str:
    """Seeded speeds against the sum of the steps."""
    rng = np.random.default_rng(61)
    a, dt = rng.choice([0.2, 0.5, 1.0], 12), rng.choice([0.05, 0.1, 0.2], 12)
    v = rng.integers(1, 12, 12) * a * dt
    if abs(number(answer(0.0, 0.2, 0.1), "The distance at rest")) > 1e-9:
        raise Wrong("A robot at rest needs no way to stop: the distance at v = 0 is 0.")
    told = np.array([number(answer(*map(float, case)), "The distance") for case in zip(v, a, dt, strict=True)])
    need = np.array([_stop(v[k], a[k], dt[k]) for k in range(12)])
    if close(told, need):
        return "The robot stops where you say."
    named(
        told,
        (
            v * v / (2 * a),
            f"v^2/2a forgets that v is driven for one step before braking shows: from {v[0]:.2f} m/s the way is "
            f"{need[0]:.4f} m, not {v[0] ** 2 / (2 * a[0]):.4f} m.",
        ),
        (
            v * v / (2 * a) + v * dt,
            "v dt whole is too much: in every step the robot already brakes from the second on.",
        ),
        (v * v / (2 * a) - v * dt / 2, "Yours brakes in the very first step: v is still driven for one dt."),
        (v * dt, "That is the way of the first step alone."),
        (v / a, "v/a is the time until it stands, in seconds; the way is asked for."),
        (v * v / a, "v^2/a is the way at full speed all the time; while braking the mean speed is half."),
    )
    k = int(np.argmax(np.abs(told - need)))
    raise Wrong(
        f"From {v[k]:.2f} m/s with {a[k]:g} m/s^2 in steps of {dt[k]:g} s the robot stops after {need[k]:.4f} m, "
        f"not {told[k]:.4f}."
    )


def _stop(v: float, a: float, dt: float) -> float:
    robot = replace(THESIS, dec_lim_x=float(a), max_vel_x=5.0)
    return float(dwa.stopping_distance([[float(v), 0.0]], robot, float(dt))[0])


# --- 06.2


def _check_window(answer: Function) -> str:
    """Both ends, zero where it lies inside, and no gap wider than the step."""
    rng = np.random.default_rng(62)
    cases = [(0.5, 0.5, 0.01), (-0.05, 0.05, 0.02)]
    for _ in range(30):
        low, step = float(rng.uniform(-0.3, 0.9)), float(rng.choice([0.005, 0.01, 0.017, 0.1]))
        cases.append((low, low + float(rng.uniform(0.0, 0.2)), step))
    for low, high, step in cases:
        values = np.sort(numbers(answer(low, high, step), -1, "The samples"))
        if values.size == 0:
            raise Wrong(f"From {low:.3f} to {high:.3f} m/s there is no sample at all: the robot could choose nothing.")
        if values[-1] < high - 1e-9:
            raise Wrong(
                f"The window reaches {high:.4f} m/s, your fastest sample is {values[-1]:.4f}: "
                "this robot never drives its top speed."
            )
        if values[-1] > high + 1e-9:
            raise Wrong(
                f"Your fastest sample, {values[-1]:.4f} m/s, lies beyond the window: {high:.4f} m/s can be reached."
            )
        if values[0] > low + 1e-9:
            raise Wrong(
                f"The window starts at {low:.4f} m/s, your slowest sample is {values[0]:.4f}: "
                "this robot cannot brake fully."
            )
        if values[0] < low - 1e-9:
            raise Wrong(
                f"Your slowest sample, {values[0]:.4f} m/s, lies below the window, which starts at {low:.4f} m/s."
            )
        if low < 0.0 < high and np.abs(values).min() > 1e-12:
            raise Wrong(f"Between {low:.3f} and {high:.3f} m/s lies 0, and standing still is not among your samples.")
        widest = float(np.diff(values).max(initial=0.0))
        if widest > step + 1e-9:
            raise Wrong(f"Two of your samples lie {widest:.4f} m/s apart; the step is {step:g}.")
    return "Both ends, zero, and no gap."


# --- 06.3


def _check_gap(answer: Any) -> str:
    """Every weight hears a rule at cruise, at every distance, and the weights make sense there."""
    system = with_rules(answer)
    for head in (0.0, 5.0, 20.0):
        for distance in (0.0, 0.5, 4.0, 7.5, 12.0, 15.0):
            for speed in (0.8, 0.95, 1.0):
                where = f"At {head:.0f} deg from the goal, {distance:g} m from an obstacle and {speed:g} m/s"
                found = system.evaluate(head, distance, speed)
                heard = [float(max(found.conclusions(o.name).values())) > 0.0 for o in system.outputs]
                if not any(heard):
                    raise Wrong(f"{where} no rule fires: the robot cruises on the default weights.")
                if not all(heard):
                    lacking = " and ".join(o.name for o, h in zip(system.outputs, heard, strict=True) if not h)
                    raise Wrong(f"{where} no rule says anything about {lacking}: conclude all three weights.")
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
    alpha, beta, gamma = (float(w) for w in numbers(answer, 3, "The weights alpha, beta, gamma"))
    if min(alpha, beta, gamma) < 0:
        raise Wrong("A weight may be 0 but not negative: it would look for the worst.")
    if max(alpha, beta, gamma) == 0:
        raise Wrong("All weights are 0: every speed is then as good as any other.")
    params = Params(weights=(alpha, beta, gamma), distance="end")
    least, longest = np.inf, 0
    for k, case in enumerate(MAPS, start=1):
        world, field = _scene(case)
        made = drive(world, START, GOAL, params, field=field)
        if made.status != "reached":
            x, y = made.poses[-1, :2]
            raise Wrong(f"On map {k} the run ends '{made.status}' at ({x:.1f}, {y:.1f}) m.")
        if made.min_clearance < CLEARANCE:
            raise Wrong(
                f"On map {k} the robot passes {made.min_clearance:.3f} m from a wall; the limit is {CLEARANCE} m."
            )
        if made.iterations > STEPS:
            raise Wrong(f"On map {k} the robot takes {made.iterations} steps; the limit is {STEPS}.")
        least, longest = min(least, made.min_clearance), max(longest, made.iterations)
    return f"Least clearance {least:.2f} m, at most {longest} steps."


# --- 06.5


def _check_speed(answer: Any) -> str:
    """The fastest speed that still stops 0.8 m before a wall, never one that does not."""
    told = number(answer, "The speed")
    speeds = np.linspace(0.0, 1.0, 10001)
    need = dwa.stopping_distance(np.column_stack([speeds, np.zeros_like(speeds)]), THESIS, 0.1)
    limit = float(speeds[need <= 0.8 + 1e-9].max())
    if limit - 0.006 <= told <= limit + 1e-4:
        return f"The limit is {limit:.3f} m/s; sqrt(2 d a) = {np.sqrt(2 * 0.8 * 0.2):.3f} would run into the wall."
    for value, near, sentence in (
        (
            np.sqrt(2 * 0.8 * 0.2),
            2e-3,
            "sqrt(2 d a) forgets the step that is driven before braking shows: it hits the wall.",
        ),
        (0.5460, 4e-4, "With v dt whole in place of v dt / 2 the robot stops with room to spare."),
        (-0.5757, 5e-3, "That is the other root of the quadratic equation, a speed backwards."),
        (8.0, 0.1, "0.8 m in one step of 0.1 s is 8 m/s: there it arrives, it does not stop."),
        (0.16, 5e-3, "d times a is no speed: its unit is m^2/s^2; a root is missing, and a 2."),
    ):
        if abs(told - value) <= near:
            raise Wrong(sentence)
    if told > limit:
        way = float(dwa.stopping_distance([[told, 0.0]], THESIS, 0.1)[0])
        raise Wrong(f"At 0.8 m from the wall {told:.4g} m/s cannot stop, it needs {way:.3f} m: the limit is lower.")
    if told < 0:
        raise Wrong("A speed straight at the wall is positive.")
    raise Wrong(f"{told:.4g} m/s stops with room to spare: more is still safe.")


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
            "Too much alpha stalls before a wall, too much beta dawdles: the check tells which, and on which map.",
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
