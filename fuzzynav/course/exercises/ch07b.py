"""Exercises of chapter 07b: the fastest safe speed, horizon, what is promised, a walker who turns, who is who."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import permutations
from typing import Any

import numpy as np

from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.course.exercises.answers import close, integers, named, number, numbers, truth
from fuzzynav.fusion.decision import Params
from fuzzynav.fusion.hall import HALL, START, hall_task
from fuzzynav.fusion.methods import ours
from fuzzynav.fusion.protocol import measure
from fuzzynav.fusion.scenes import SPEED_BOUND
from fuzzynav.geometry import Array, point_segment_distance
from fuzzynav.robot import THESIS
from fuzzynav.world import World

__all__ = ["EXERCISES", "LONE_PREDICTION"]

Function = Callable[..., Any]
LONE_PREDICTION = Params(guard=False)  # where movers are if they go on as now, and nothing else


# --- 07b.1


def _fastest(need: Array, bend: Array, brake: Array) -> Array:
    """The root v >= 0 of v^2/2b + bend v = need; 0 where there is none."""
    return np.asarray(np.maximum(brake * (np.sqrt(np.maximum(bend**2 + 2 * need / brake, 0.0)) - bend), 0.0))


def _check_fastest(answer: Function) -> str:
    """Seeded distances, bounds, brakes and periods; in the second row a walker is nearer than any speed allows."""
    rng = np.random.default_rng(71)
    rows = [[2.0, 0.5, 0.2, 0.1, 0.2], [0.05, 0.5, 0.2, 0.1, 0.2]]
    rows += rng.uniform([0.5, 0.1, 0.2, 0.05, 0.3], [8, 2, 3, 0.15, 3], (20, 5)).tolist()
    told = np.array([number(answer(*row), "The speed") for row in rows])
    away, bound, brake, dt, gain = np.array(rows).T
    more = gain / brake + 1.0
    fixed, bend = more * (0.5 * gain * dt**2 + dt * bound), bound / brake + more * dt
    right = _fastest(away - fixed, bend, brake)
    if close(told, right):
        return f"2 m from a walker the thesis's robot may drive {right[0]:.2f} m/s; nearer than {fixed[0]:.2f} m, none."
    spread = np.sqrt(np.maximum(bend**2 + 2 * (away - fixed) / brake, 0.0))
    named(
        told,
        (
            brake * (spread - bend),
            "Nearer than what one period alone needs, no speed is safe: there the answer is 0, not below it.",
        ),
        (-brake * (spread + bend), "The other root is below 0."),
        (np.sqrt(2 * brake * away), "From that speed it stops in time for a walker who stands: V is missing."),
        (_fastest(away, bound / brake, brake), "Between two decisions the robot may speed up: the period is missing."),
        (
            _fastest(away - 0.5 * gain * dt**2 - dt * bound, bound / brake + dt, brake),
            "What is gained in a period must be braked away again: the factor A/b + 1 is missing.",
        ),
        (_fastest(away - fixed, more * dt, brake), "While the robot brakes, for v/b, a walker goes on at V."),
        (
            _fastest(away - more * 0.5 * gain * dt**2, bend, brake),
            "In the period the walker goes on too: V belongs to it.",
        ),
    )
    k = int(np.argmax(np.abs(told - right)))
    raise Wrong(
        f"At d = {away[k]:.2f}, V = {bound[k]:.2f}, b = {brake[k]:.2f}, A = {gain[k]:.2f} and a period of {dt[k]:.2f} "
        f"s(v) = d at v = {right[k]:.3f} m/s; yours is {told[k]:.3f} m/s."
    )


# --- 07b.2


def _check_horizon(answer: Any) -> str:
    """The fastest speed of the thesis's robot from which it stands within the horizon of 3 s."""
    told = number(answer, "The speed")
    if abs(told - 0.6) <= 0.002:
        return "Above it the robot still moves when its prediction ends: the thesis's 1 m/s needs 5 s."
    for value, sentence in (
        (1.0, "From 1 m/s with 0.2 m/s² the robot stands after 5 s, two more than the prediction sees."),
        (3.0 / 0.2, "Speed is deceleration times time, not time over deceleration."),
        (0.3, "0.3 m/s is the mean speed while it brakes from the right one."),
        (np.sqrt(1.2), "That mixes up time and way: v = a t, while v² = 2 a d."),
        (0.9, "0.2 m/s² for 3 s, squared and halved, is a way: 0.9 m."),
    ):
        if abs(told - value) <= 0.002:
            raise Wrong(sentence)
    raise Wrong(
        f"From {told:.2f} m/s a robot that loses 0.2 m/s in every second stands after {told / 0.2:.1f} s, not 3."
    )


# --- 07b.3


def _check_promises(answer: Any) -> str:
    """Which of four sentences passive safety promises."""
    given = list(answer) if hasattr(answer, "__iter__") and not isinstance(answer, str) else [answer]
    if len(given) != 4:
        raise Wrong(f"Four sentences want four answers, True or False; yours are {len(given)}.")
    told = [truth(one, "Each answer") for one in given]
    for k, (right, sentence) in enumerate(
        (
            (True, "1: this is what the guard ensures, as long as no walker is faster than V."),
            (False, "2: a robot that stands cannot make room by itself; a walker who does not look walks into it."),
            (True, "3: it stands before anyone can be there, and they stop: nobody is left to touch it."),
            (False, "4: stronger brakes make it drive more often, but no brake moves a robot out of the way."),
        )
    ):
        if told[k] != right:
            raise Wrong(f"Think again about sentence {sentence}")
    return "Passive safety answers for the robot's own motion; the rest is courtesy, theirs or yours."


# --- 07b.4


def _check_turner(answer: Any) -> str:
    """A walker who is hit by prediction alone, and not with the guard."""
    row = numbers(answer, 5, "Two places and a speed")
    ends, speed = row[:4].reshape(2, 2), float(row[4])
    if not 0.05 <= speed <= SPEED_BOUND:
        raise Wrong(f"A walker of {speed:.2f} m/s: the robot was told that nobody is faster than {SPEED_BOUND} m/s.")
    if np.hypot(*(ends[1] - ends[0])) < 0.2:
        raise Wrong("The two places are nearly one: such a walker turns round in every step, or never walks.")
    inside = World(grid=HALL).clearance(ends[0] + np.linspace(0.0, 1.0, 41)[:, None] * (ends[1] - ends[0]))
    if not inside.min() > 0.3:
        raise Wrong("A walker has a radius of 0.3 m and walks on free ground: this one walks through a wall.")
    if point_segment_distance(np.array(START[:2]), ends[0], ends[1]) < 1.0:
        raise Wrong("Keep 1 m away from the start (1, 4): the robot has not yet chosen anything there.")
    task = hall_task(walkers=[row], robot=THESIS, courtesy=0.0)
    bold = measure(task, partial(ours, params=LONE_PREDICTION))
    if bold["ending"] != "hit":
        raise Wrong(
            f"With prediction alone this run ends as '{bold['ending']}': asked is a walker whom the moving robot hits."
        )
    safe = measure(task, ours)["ending"]
    return f"Prediction alone drives into the walker after {bold['time']:.1f} s; with the guard the run ends: {safe}."


# --- 07b.5


def _costs() -> list[Array]:
    """Square cost matrices on which greedy choices lose."""
    rng = np.random.default_rng(75)
    first = [np.array([[1.0, 2.0], [2.0, 9.0]]), np.array([[4.0, 1.0, 3.0], [2.0, 0.0, 5.0], [3.0, 2.0, 2.0]])]
    return first + [rng.uniform(0.0, 10.0, (n, n)).round(2) for n in (2, 3, 3, 4, 4, 4, 5, 5)]


def _best(cost: Array, sign: float = 1.0) -> Array:
    """The assignment of least cost (or greatest, with sign -1), by trying all."""
    n = len(cost)
    return np.array(min(permutations(range(n)), key=lambda p: sign * cost[range(n), p].sum()))


def _greedy(cost: Array) -> Array:
    """Row by row the cheapest column that is left."""
    left, out = list(range(len(cost))), []
    for row in cost:
        out.append(min(left, key=lambda j: row[j]))
        left.remove(out[-1])
    return np.array(out)


def _cheapest_first(cost: Array) -> Array:
    """Pair after pair, the cheapest of all that are left."""
    open_, out = cost.copy(), np.zeros(len(cost), dtype=int)
    for _ in range(len(cost)):
        i, j = np.unravel_index(int(np.argmin(open_)), cost.shape)
        out[i] = j
        open_[i], open_[:, j] = np.inf, np.inf
    return out


def _check_assign(answer: Function) -> str:
    """Matrices of 2 to 5 tracks and clusters."""
    costs = _costs()
    found = [np.array(integers(answer(cost.copy()), len(cost), "The columns")) for cost in costs]
    for cost, columns in zip(costs, found, strict=True):
        if columns.min() < 0 or columns.max() >= len(cost):
            raise Wrong(f"Columns count from 0 to {len(cost) - 1}; yours holds {columns.tolist()}.")
    told = np.concatenate(found)
    named(
        told,
        (np.concatenate([c.argmin(axis=1) for c in costs]), "Two tracks may want the same cluster: each column once."),
        (
            np.concatenate([c.argmin(axis=0) for c in costs]),
            "That asks each cluster for its track; asked is the reverse.",
        ),
        (np.concatenate([_greedy(c) for c in costs]), "Row by row the first track takes what the second needs more."),
        (
            np.concatenate([_cheapest_first(c) for c in costs]),
            "The cheapest pair first can leave a dear one for the end.",
        ),
        (np.concatenate([_best(c, -1.0) for c in costs]), "Yours finds the dearest pairing: costs are to be small."),
        (np.concatenate([np.argsort(_best(c)) for c in costs]), "Yours is a row for each column; asked are columns."),
    )
    for cost, columns in zip(costs, found, strict=True):
        if len(set(columns.tolist())) < len(cost):
            raise Wrong(f"{columns.tolist()} gives one cluster to two tracks.")
        best, own = cost[range(len(cost)), _best(cost)].sum(), cost[range(len(cost)), columns].sum()
        if own > best + 1e-9:
            raise Wrong(f"{columns.tolist()} costs {own:.2f}; there is a pairing of {len(cost)} that costs {best:.2f}.")
    return "Nobody is counted twice, and no other pairing is nearer in the sum."


EXERCISES: tuple[Exercise, ...] = (
    Exercise(
        "07b.1",
        "The fastest safe speed",
        2,
        (
            "Set s(v) = d and sort by powers of v: a quadratic equation.",
            "v²/2b + (V/b + k e) v + k (A e²/2 + e V) - d = 0 with k = A/b + 1; one root is the answer, if it is not "
            "below 0.",
        ),
        _check_fastest,
    ),
    Exercise(
        "07b.2",
        "Horizon against braking time",
        1,
        (
            "How long does a robot brake from v, if it loses 0.2 m/s in every second?",
            "v/b = 3 s.",
        ),
        _check_horizon,
    ),
    Exercise(
        "07b.3",
        "What is promised?",
        1,
        (
            "Passive safety speaks of a robot that moves.",
            "Who could touch a robot that stands, and what would it take to avoid that?",
        ),
        _check_promises,
    ),
    Exercise(
        "07b.4",
        "Break the prediction",
        2,
        (
            "Let somebody walk away from the robot's way, and turn round when it comes.",
            "In the first metres the robot turns aside: let somebody walk across its way at x = 3 m.",
        ),
        _check_turner,
    ),
    Exercise(
        "07b.5",
        "Who is who?",
        2,
        (
            "Up to five tracks: itertools.permutations tries all pairings.",
            "The cost of a pairing p is the sum of cost[i, p[i]]; take the p with the least.",
        ),
        _check_assign,
    ),
)
