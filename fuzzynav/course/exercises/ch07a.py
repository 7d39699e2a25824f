"""Exercises of chapter 07a: the orbit, a speed for an arc, sub-goals that are done, a cell that forgets, a block."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.course.exercises.answers import close, integers, named, number, numbers
from fuzzynav.fusion.hall import HALL, hall_task
from fuzzynav.fusion.methods import METHODS
from fuzzynav.fusion.protocol import measure
from fuzzynav.geometry import Array

__all__ = ["EXERCISES"]

Function = Callable[..., Any]


# --- 07a.1


def _check_orbit(answer: Any) -> str:
    """Radius of the circle at 1 m/s and 0.35 rad/s, and the least distance to a sub-goal at (2, 2)."""
    told = numbers(answer, 2, "Radius and least distance")
    turn = 1.0 / 0.35
    inside = float(np.hypot(2.0, 2.0 - turn))
    least = turn - inside
    if np.abs(told - [turn, least]).max() <= 0.01:
        return "More than the 0.5 m at which it would be reached: the robot orbits for ever, or until it slows down."
    for value, sentence in (
        ((least, turn), "The radius comes first, then the distance: yours are swapped."),
        ((0.35, least), "0.35 is omega v; the radius of a circle driven at v with omega is v/omega."),
        (
            (turn, inside),
            "That is how far the sub-goal is from the centre; the circle itself is a radius away from it.",
        ),
        ((turn, np.hypot(2.0, 2.0)), "That is the distance at the start; the robot comes nearer before it turns away."),
        ((turn, turn - 2.0), "The sub-goal is not straight beside the robot: its x of 2 m counts too."),
        ((turn, 0.0), "The sub-goal lies inside the circle, not on it: the robot passes it by."),
    ):
        if np.abs(told - value).max() <= 0.01:
            raise Wrong(sentence)
    if abs(told[0] - turn) > 0.01:
        raise Wrong(f"A turn of 0.35 rad/s at 1 m/s is no circle of radius {told[0]:.2f} m.")
    raise Wrong(f"On the circle around (0, {turn:.2f}) the robot is never {told[1]:.2f} m from (2, 2) at its nearest.")


# --- 07a.2


def _check_cap(answer: Function) -> str:
    """Seeded distances, angles and yaw rates; the first turns by 90 degrees."""
    rng = np.random.default_rng(72)
    rows = [[2.0, 0.5 * np.pi, 0.35], *rng.uniform([0.5, 0.2, 0.2], [6.0, 1.5, 3.0], (20, 3)).tolist()]
    told = np.array([number(answer(*row), "The speed") for row in rows])
    d, e, omega = np.array(rows).T
    right = omega * d / (2.0 * np.sin(e))
    if close(told, right):
        return "At that speed and full yaw rate the robot arrives on the one arc that leads there."
    named(
        told,
        (omega * d, "That is a circle of radius d; the chord of a circle of radius R is 2 R sin e."),
        (omega * d / np.sin(e), "The chord spans an angle of 2e at the centre: the 2 is missing."),
        (omega * d / (2.0 * e), "e for sin e holds for small angles only."),
        (omega * d / (2.0 * np.cos(e)), "Straight ahead, e = 0, any speed is allowed: it is the sine, not the cosine."),
        (omega * d / (2.0 * np.tan(e)), "At 90 degrees yours forbids to move; there the circle has the radius d/2."),
        (d / (2.0 * np.sin(e)), "That is the radius; the speed is radius times yaw rate."),
        (d / (2.0 * np.sin(e) * omega), "Speed is radius times yaw rate, not radius over yaw rate."),
        (omega * d * np.sin(e) / 2.0, "The further the target lies aside, the slower: sin e belongs below the line."),
    )
    k = int(np.argmax(np.abs(told - right)))
    raise Wrong(
        f"With {told[k]:.3f} m/s and {omega[k]:.2f} rad/s the circle has the radius {told[k] / omega[k]:.2f} m; "
        f"the one through a target {d[k]:.2f} m away, {np.degrees(e[k]):.0f} degrees aside, has "
        f"{right[k] / omega[k]:.2f} m."
    )


# --- 07a.3


def _check_switch(answer: Function) -> str:
    """Robots at places along a path whose sub-goals lie near each other, some within the radius of several."""
    points = np.array([[1.0, 0.0], [1.6, 0.3], [2.0, 0.5], [4.0, 1.0], [4.5, 1.2]])
    last, rng = len(points) - 1, np.random.default_rng(73)
    spots = [[0.0, 0.0], [1.5, 0.2], [4.4, 1.1], [2.0, -0.5], *rng.uniform([0.0, -0.5], [5.0, 1.7], (30, 2)).tolist()]
    cases = [(int(k), np.array(p)) for p in spots for k in (0, 1, last)]
    told = np.array([integers(answer(k, p.copy(), points.copy(), 0.8), 1, "The index")[0] for k, p in cases])

    def passed(k: int, p: Array, *, most: int = 9, bound: int = last) -> int:
        at = k
        while at < bound and at - k < most and np.hypot(*(points[at] - p)) <= 0.8:
            at += 1
        return at

    right = np.array([passed(k, p) for k, p in cases])
    if np.array_equal(told, right):
        return "All that lies within the radius is done with, and the goal is never left."
    near = [np.flatnonzero(np.hypot(*(points - p).T) <= 0.8) for _, p in cases]
    start = np.array([k for k, _ in cases])
    named(
        told,
        (
            np.array([passed(k, p, most=1) for k, p in cases]),
            "Two sub-goals may lie within the radius: go on while so.",
        ),
        (np.array([passed(k, p, bound=last + 1) for k, p in cases]), "The goal has no next one: its index must stay."),
        (
            np.array([max(k, int(n[-1]) + 1 if len(n) else 0) for k, n in zip(start, near, strict=True)]).clip(
                max=last
            ),
            "Yours jumps over sub-goals that were not reached, to one near by on a later part of the path.",
        ),
        (np.array([int(np.argmin(np.hypot(*(points - p).T))) for _, p in cases]), "The nearest one may be behind."),
        (start, "Yours never goes on: compare the distance of the current sub-goal with the radius."),
        (np.minimum(start + 1, last), "Yours goes on at every call, wherever the robot is."),
        (right - start, "That is how many are done with; asked is the index of the one to head for."),
    )
    j = int(np.argmax(told != right))
    x, y = cases[j][1]
    raise Wrong(f"At ({x:.2f}, {y:.2f}), heading for {start[j]}, the next index is {right[j]}, not {told[j]}.")


# --- 07a.4


def _check_cell(answer: Function) -> str:
    """A cell that is hit, looked over, both and neither, in a seeded order."""
    rng = np.random.default_rng(74)
    events = [(True, False)] * 4 + [(False, True)] * 12 + [(True, True), (False, False)]
    events += [(bool(a), bool(b)) for a, b in rng.integers(0, 2, (30, 2))]
    value, told, rows = 0, [], []
    for ended, crossed in events:
        told.append(integers(answer(value, ended, crossed), 1, "The evidence")[0])
        rows.append((value, ended, crossed))
        value = _evidence(value, ended, crossed)
    said = np.array(told)
    right = np.array([_evidence(*row) for row in rows])
    if np.array_equal(said, right):
        return "One hit outweighs two looks over the cell, and nine looks free even the surest one."

    def otherwise(rule: Callable[[int, bool, bool], int]) -> Array:
        return np.array([rule(*row) for row in rows])

    named(
        said,
        (otherwise(lambda n, a, b: max(n - b, 0) + 3 * a), "Evidence ends at 9: a block that was there for an hour "
         "could not be forgotten."),
        (otherwise(lambda n, a, b: min(n - b + 3 * a, 9)), "Evidence ends at 0 as well: yours owes the next "
         "block a debt."),
        (otherwise(lambda n, a, b: min(n + 3 * a, 9)), "Yours never forgets: a beam that passes over weakens by 1."),
        (otherwise(lambda n, a, b: min(max(n - b, 0) + a, 9)), "A beam that ends in the cell counts 3, not 1."),
        (otherwise(lambda n, a, b: min(max(n - 3 * b, 0) + a, 9)), "Yours has 3 and 1 exchanged: it forgets too soon."),
        (otherwise(lambda n, a, b: 0 if b and not a else min(n + 3 * a, 9)), "One beam that looks over must not erase: "
         "a cell may be hit at its edge only."),
        (otherwise(lambda n, a, b: 9 if a else max(n - b, 0)), "One hit is not full evidence: it adds 3."),
    )  # fmt: skip
    j = int(np.argmax(said != right))
    n, ended, crossed = rows[j]
    words = f"{'is hit' if ended else 'is not hit'} and {'looked over' if crossed else 'not looked over'}"
    raise Wrong(f"A cell of evidence {n} that {words} has {right[j]} afterwards, not {said[j]}.")


def _evidence(value: int, ended: bool, crossed: bool) -> int:
    """What is right: first the beams that pass over, then those that end."""
    return min(max(value - crossed, 0) + 3 * ended, 9)


# --- 07a.5


def _check_block(answer: Any) -> str:
    """A block that traps who plans once, and not who plans again."""
    x, y = numbers(answer, 2, "The centre of the block")
    if not (0.4 <= x <= 11.6 and 0.4 <= y <= 7.6):
        raise Wrong(f"A block of 0.8 m at ({x:.2f}, {y:.2f}) sticks in the hall's walls: it is 12 m long and 8 m wide.")
    if min(np.hypot(x - 1.0, y - 4.0), np.hypot(x - 11.0, y - 4.0)) < 1.0:
        raise Wrong("Keep 1 m away from the start (1, 4) and from the goal (11, 4): neither planner could do anything.")
    corners = np.array([[x + a, y + b] for a in (-0.39, 0.0, 0.39) for b in (-0.39, 0.0, 0.39)])
    if HALL.is_occupied(corners).any():
        raise Wrong(f"A block at ({x:.2f}, {y:.2f}) overlaps the pocket, which the map shows already.")
    task = hall_task(blocks=[(float(x), float(y))])
    once = measure(task, METHODS["A* + DWA"])["ending"]
    again = measure(task, METHODS["ours"])["ending"]
    if once == "reached" or again != "reached":
        raise Wrong(
            f"With the block at ({x:.2f}, {y:.2f}) the way planned once ends as '{once}', the one planned again as "
            f"'{again}': asked is a block that stops the first only."
        )
    return f"Planned once, the run ends {once}; with the block entered into the map, it reaches the goal."


EXERCISES: tuple[Exercise, ...] = (
    Exercise(
        "07a.1",
        "The orbit by hand",
        1,
        (
            "The robot drives on a circle of radius v/omega whose centre lies straight to its left.",
            "Distance of the sub-goal from that centre, and the rest to the circle.",
        ),
        _check_orbit,
    ),
    Exercise(
        "07a.2",
        "As fast as the arc allows",
        2,
        (
            "Draw the circle that is tangent to the heading and passes through the target: d is a chord.",
            "The chord and the tangent enclose e, so the chord spans 2e at the centre: d = 2 R sin e.",
        ),
        _check_cap,
    ),
    Exercise(
        "07a.3",
        "Sub-goals that are done",
        2,
        (
            "Go on while the current sub-goal lies within the radius, one by one.",
            "Stop at the last: it is the goal.",
        ),
        _check_switch,
    ),
    Exercise(
        "07a.4",
        "A cell that forgets",
        2,
        (
            "First take off what looked over (not below 0), then add what ended there (not above 9).",
            "True counts as 1 in Python: max(evidence - crossed, 0).",
        ),
        _check_cell,
    ),
    Exercise(
        "07a.5",
        "A block that traps who plans once",
        2,
        (
            "Where does the way planned once lead? Draw it, or look at the first picture.",
            "In the passage above the pocket, so that it stands on the way and leaves a gap beside it.",
        ),
        _check_block,
    ),
)
