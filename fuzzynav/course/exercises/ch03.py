"""Exercises of chapter 03: strengths by hand, the centroid, a merging bug, a safe speed, a full rule base."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.fuzzy import FuzzySystem, RuleBlock
from fuzzynav.fuzzy.defuzzify import centroid
from fuzzynav.studies.fuzzy import SpeedSets, rule_base, speed_system

__all__ = ["EXERCISES"]

Function = Callable[..., Any]
BRAKE = 0.04  # m/s^2, the slippery floor of exercise 03.4
TERMS = ("Low", "Medium", "High")


def _number(value: Any, what: str) -> float:
    """The answer as one number, nan allowed, or a sentence that says what was expected."""
    try:
        return float(np.asarray(value, dtype=float).reshape(()))
    except (TypeError, ValueError):
        raise Wrong(f"{what} should be one number, not {value!r:.60}.") from None


# --- 03.1


def _check_strengths(answer: Any) -> str:
    """Four strengths at 0.5 m and 60 deg against the compiled inference."""
    try:
        told = np.asarray(answer, dtype=float).ravel()
    except (TypeError, ValueError):
        raise Wrong("The answer should be four numbers, one for each rule.") from None
    if told.shape != (4,) or not np.isfinite(told).all():
        raise Wrong(f"There are four rules, so four numbers are needed, not {told.size}.")
    if (told < 0).any() or (told > 1).any():
        raise Wrong("A strength lies between 0 and 1.")
    right = speed_system().evaluate(0.5, 60.0).firing
    why = (
        "Near falls from 1 at 0 m to 0 at 2 m",
        "AND takes the smaller of two memberships",
        "Far begins at 2 m",
        "Large rises from 0 at 0 deg to 1 at 90 deg",
    )
    for k in range(4):
        if abs(told[k] - right[k]) > 0.006:
            raise Wrong(f"Rule {k + 1} does not fire with {told[k]:.2f} at 0.5 m and 60 deg: {why[k]}.")
    return "You did what the fuzzifier and the rules do."


# --- 03.2


def _check_centroid(answer: Function) -> str:
    """Seeded output sets: known triangle, scaled height, shifted range, and an empty set."""
    x = np.linspace(0.0, 1.0, 101)
    middle = _number(answer(x, np.minimum(0.6, 1.0 - np.abs(2.0 * x - 1.0))), "The centroid")
    if not abs(middle - 0.5) < 1e-9:
        raise Wrong(f"A set that is symmetric about 0.5 m/s balances there, yours at {middle:.4f}.")
    rng = np.random.default_rng(32)
    for _ in range(6):
        low, high = np.sort(rng.uniform(-2.0, 3.0, 2))
        grid = np.linspace(low, high, int(rng.integers(21, 80)))
        mu = rng.random(grid.size) * (rng.random(grid.size) > 0.3)
        told, wanted = _number(answer(grid, mu), "The centroid"), float(centroid(grid, mu))
        if abs(told - wanted) > 1e-9:
            plain = float(centroid(grid, mu, "sum"))
            hint = "the first and last sample count half" if abs(told - plain) < 1e-9 else "divide x mu by mu"
            raise Wrong(f"A set from {grid[0]:.2f} to {grid[-1]:.2f} balances at {wanted:.4f}, not {told:.4f}: {hint}.")
        if abs(_number(answer(grid, 0.5 * mu), "The centroid") - wanted) > 1e-9:
            raise Wrong("Half the height moves no balance point: the centroid must stay.")
    if not np.isnan(_number(answer(x, np.zeros(101)), "The centroid of the empty set")):
        raise Wrong("Where no rule fires there is nothing to balance: the answer must be nan, not a number.")
    return "Your centroid balances every set, and says nan where there is none."


# --- 03.3


def _check_merged(answer: Function) -> str:
    """Strengths of the conclusions for seeded rules in two orders."""
    rng = np.random.default_rng(33)
    for _ in range(8):
        n = int(rng.integers(2, 9))
        firing, conclusions = rng.random(n).round(2), [str(t) for t in rng.choice(TERMS, n)]
        wanted = {t: float(max((f for f, c in zip(firing, conclusions, strict=True) if c == t))) for t in conclusions}
        order = rng.permutation(n)
        for k in (np.arange(n), order):
            told = answer(firing[k], [conclusions[i] for i in k])
            if not isinstance(told, dict):
                raise Wrong(f"The answer should be a dict from conclusion to strength, not {type(told).__name__}.")
            for term, strength in wanted.items():
                found = _number(told.get(term, np.nan), f"The strength of {term}")
                if not abs(found - strength) < 1e-12:
                    rules = [float(f) for f, c in zip(firing[k], np.array(conclusions)[k], strict=True) if c == term]
                    raise Wrong(
                        f"Rules with the strengths {rules} conclude {term}: the clip is at {strength:.2f}, "
                        f"yours at {found:.2f}. A weak rule must not lower what a strong one said."
                    )
    return "The strongest rule counts, in any order."


# --- 03.4


def _check_speed_sets(answer: Any) -> str:
    """The speed must allow a stop before the obstacle, without crawling far from it, and without a gap."""
    if not isinstance(answer, SpeedSets):
        raise Wrong(
            f"The answer should be a SpeedSets, such as replace(SpeedSets(), near_end=...), "
            f"not {type(answer).__name__}."
        )
    distance = np.linspace(0.3, 4.0, 75)
    speed = speed_system(answer)(distance, 0.0)[0]
    silent = np.flatnonzero(np.isnan(speed))
    if silent.size:
        raise Wrong(f"At {distance[silent[0]]:.2f} m no rule fires: the robot has no speed at all there.")
    limit = np.sqrt(2.0 * BRAKE * distance)
    k = int(np.argmax(speed - limit))
    if speed[k] > limit[k]:
        raise Wrong(
            f"At {distance[k]:.2f} m the robot drives {speed[k]:.3f} m/s and needs "
            f"{speed[k] ** 2 / (2.0 * BRAKE):.2f} m to stop: the limit there is {limit[k]:.3f} m/s."
        )
    far = float(speed_system(answer)(2.5, 0.0)[0])
    if far < 0.30:
        raise Wrong(f"At 2.5 m the way is free, yet the robot crawls at {far:.3f} m/s: 0.300 are asked for.")
    return f"It stops in time everywhere from 0.3 m on, and drives {far:.2f} m/s at 2.5 m."


# --- 03.5


def _extended(answer: Any) -> FuzzySystem:
    """Table 3.2 with the rules of the learner added."""
    if isinstance(answer, str) or not isinstance(answer, (list, tuple)):
        raise Wrong("The answer should be a list of rule texts.")
    table = rule_base("thesis_table_3_2")
    try:
        added = RuleBlock(rules=tuple(answer)).rules
        return replace(table, blocks=(replace(table.blocks[0], rules=(*table.rules, *added)),))
    except (TypeError, ValueError) as error:
        raise Wrong(f"A rule could not be used: {error}.") from None


def _check_full(answer: Any) -> str:
    """No gap is left, the nine printed cases keep their answers, and a close obstacle keeps its weight."""
    full, table = _extended(answer), rule_base("thesis_table_3_2")
    gaps = full.uncovered(n=21)
    if gaps.missing:
        raise Wrong(
            f"{len(gaps.missing)} combinations are still without a rule, such as {' and '.join(gaps.missing[0])}."
        )
    if len(gaps):
        raise Wrong(f"At heading, distance, speed {gaps.points[0].round(2).tolist()} some weight hears no rule.")
    for k in range(9):
        point = (90.0 * (k % 3), 7.5 * (k // 3), 0.5 * (k % 3))
        before, after = np.array(table(*point)), np.array(full(*point))
        if np.abs(before - after).max() > 1e-9:
            raise Wrong(
                f"At {point} the printed rule {k + 1} alone should speak: alpha was {before[0]:.2f}, "
                f"now it is {after[0]:.2f}. One of your rules fires there too."
            )
    corners = [(h, v) for h in (0.0, 90.0, 180.0) for v in (0.0, 0.5, 1.0)]
    for heading, speed in corners:
        alpha, beta, _ = full(heading, 0.0, speed)
        if beta <= alpha:
            raise Wrong(
                f"With an obstacle at 0 m, heading {heading:g} deg and {speed:g} m/s the clearance weighs "
                f"{beta:.2f} and the heading {alpha:.2f}: the robot would drive into it."
            )
    return f"{len(answer)} rules added, no gap left, the nine printed cases unchanged."


EXERCISES: tuple[Exercise, ...] = (
    Exercise("03.1", "Strengths by hand", 1, (
        "First the memberships: Near(0.5 m), Medium(0.5 m), Far(0.5 m), Small(60 deg), Large(60 deg).",
        "Each triangle is a straight line: Near(0.5) = (2 - 0.5) / 2. AND takes the smaller of the two.",
    ), _check_strengths),
    Exercise("03.2", "A centroid that can say nan", 2, (
        "The trapezoid rule weighs all samples alike, except the first and the last, which count half.",
        "np.trapezoid(y, x) does it. Test the area before you divide by it.",
    ), _check_centroid),
    Exercise("03.3", "Find the bug: the last rule wins", 2, (
        "What does the dict hold when a strong rule is followed by a weak one with the same conclusion?",
        "Keep the greater of the old and the new strength: max(found.get(name, 0.0), strength).",
    ), _check_merged),
    Exercise("03.4", "Tune the sets to a floor", 3, (
        "Move the sets in the lab first. Which set makes the robot fast at 0.5 m, and where does it begin?",
        "Medium must not speak close to the obstacle: raise medium_left. Near must still cover what it leaves: raise "
        "near_end.",
    ), _check_speed_sets),
    Exercise("03.5", "Close the gaps of table 3.2", 3, (
        "18 combinations are missing: all with another pairing of headGoal and velRob than the nine rules have.",
        "Loop over the three distances and the six other pairings, and write one rule text for each. A rule with 'any' "
        "also fires where a printed rule should speak alone.",
    ), _check_full),
)  # fmt: skip
