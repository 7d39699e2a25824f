"""Exercises of chapter 08: reach of F, who wins, a gate with memory, a reference that waits, a speed that can stop."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fuzzynav.blend import reach_of, table_5_1
from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.course.exercises.answers import close, integers, named, number, numbers, truth
from fuzzynav.geometry import Array

__all__ = ["EXERCISES"]

Function = Callable[..., Any]


# --- 08.1


def _check_reach(answer: Any) -> str:
    """The centroids of the outer sets."""
    told = numbers(answer, 2, "Floor and ceiling of F")
    floor, ceiling = reach_of(table_5_1())
    if np.abs(told - [floor, ceiling]).max() <= 0.004:
        return f"Without a gate a robot far from everything would drive at {100 * (1 - floor):.0f} % of its speed."
    for value, sentence in (
        ((0.0, 1.0), "A centroid lies inside its set, never on its edge: F reaches neither 0 nor 1."),
        ((ceiling, floor), "The floor comes first, then the ceiling: yours are swapped."),
        ((0.25, 0.75), "The middle of the base is the balance of a rectangle; a triangle is heavier towards its peak."),
        ((1 / 3, 2 / 3), "The centroid lies a third of the base from the side of the peak, not from the far end."),
    ):
        if np.abs(told - value).max() <= 0.004:
            raise Wrong(sentence)
    if abs(told[0] - floor) > 0.004:
        raise Wrong(f"The triangle (0, 0, 0.5) of Little does not balance at {told[0]:.3f}.")
    raise Wrong(f"The triangle (0.5, 1, 1) of Lots does not balance at {told[1]:.3f}.")


# --- 08.2


def _check_balance(answer: Function) -> str:
    """Seeded pairs of yaw rates that pull in opposite directions."""
    rng = np.random.default_rng(82)
    pull, push = -rng.uniform(0.2, 5.0, 8), rng.uniform(0.3, 2.0, 8)
    told = np.array([number(answer(float(a), float(b)), "The weight") for a, b in zip(pull, push, strict=True)])
    if close(told, -pull / (push - pull)):
        return "Tracking that pulls at 5 rad/s outweighs avoidance at 1 rad/s up to F = 5/6, the ceiling of table 5.1."
    named(
        told,
        (push / (push - pull), "That is the share of tracking, 1 - F; F is the weight of avoidance."),
        (pull / (push - pull), "A weight is not negative: mind the sign of the pull."),
        (-pull / push, "That is the ratio of both rates; the weights F and 1 - F add up to 1."),
        (-pull / (push + pull), "The pull is negative: the sum of both sizes is push - pull."),
        (0 * pull + 0.5, "Half and half balances only where both rates are equally large."),
    )
    k = int(np.argmax(np.abs(told + pull / (push - pull))))
    net = (1.0 - told[k]) * pull[k] + told[k] * push[k]
    raise Wrong(
        f"With F = {told[k]:.3f} tracking at {pull[k]:.2f} rad/s and avoidance at {push[k]:.2f} rad/s leave a turn "
        f"of {net:.3f} rad/s; at the balance it is 0."
    )


# --- 08.3


def _check_gate(answer: Function) -> str:
    """Forecasts that fall, hover between both margins, and rise."""
    rng = np.random.default_rng(83)
    rows, told = [], []
    for enter, leave in ((0.10, 0.12), (0.05, 0.2)):
        state = False
        for d in np.concatenate([[1.0, leave - 0.01, enter - 0.01], rng.uniform(0.0, 0.3, 60)]).tolist():
            told.append(truth(answer(state, d, enter, leave), "The gate"))
            rows.append((state, d, enter, leave))
            state = d < enter or (state and d <= leave)
    was = np.array([row[0] for row in rows])
    forecast, low, high = np.array([row[1:] for row in rows]).T
    wanted = (forecast < low) | (was & (forecast <= high))
    said = np.array(told)
    if np.array_equal(said, wanted):
        return "The gate opens on a bad forecast, stays open in between, and shuts on a good one."
    named(
        said,
        (forecast < low, "Yours has no memory: between both margins it must stay as it was."),
        (forecast <= high, "Yours opens below leave already: only below enter may it open."),
        (~wanted, "Yours avoids where it should track, and tracks where it should avoid."),
        (was | (forecast < low), "Yours never shuts again: above leave the robot must go back to tracking."),
        (was, "Yours never changes: the forecast has no effect."),
        (was & (forecast <= high), "Yours never opens: a forecast below enter must open it."),
    )
    k = int(np.argmax(said != wanted))
    before, after = "avoided" if was[k] else "tracked", "on" if wanted[k] else "off"
    raise Wrong(
        f"The robot {before}, and the forecast of tracking is {forecast[k]:.3f} m (enter {low[k]} m, leave "
        f"{high[k]} m): avoidance must be {after}."
    )


# --- 08.4


def _eight() -> tuple[Array, list[tuple[int, Array, str]]]:
    """A figure eight, and a robot at places beside it, also near the crossing and the end."""
    t = np.linspace(0.2, 0.2 + 2 * np.pi, 400)
    curve = 2.0 * np.column_stack([np.sin(t), np.sin(t) * np.cos(t)])
    first, second = (int(np.argmin(np.hypot(*curve[a:b].T))) + a for a, b in ((50, 300), (300, 400)))  # the crossing
    cases = [
        (60, curve[60] * 1.3, "beside the curve"),
        (60, curve[40], "behind the reference"),
        (60, curve[62] * 0.95, "a little ahead"),
        (60, curve[160], "far ahead"),
        (first + 3, curve[second + 2], "near the crossing, on the other branch"),
        (398, curve[399], "at the end"),
    ]
    rng = np.random.default_rng(84)
    cases += [(int(k), curve[k + 2] + rng.normal(0, 0.05, 2), "beside the curve") for k in rng.integers(0, 390, 30)]
    return curve, cases


def _check_wait(answer: Function) -> str:
    """The next index of the reference, on a figure eight."""
    curve, cases = _eight()
    most, end = 3, len(curve) - 1
    told = np.array([integers(answer(k, p.copy(), curve.copy(), most), 1, "The index")[0] for k, p, _ in cases])
    start = np.array([k for k, _, _ in cases])
    whole = np.array([int(np.argmin(np.hypot(*(curve - p).T))) for _, p, _ in cases])

    def nearest(low: int, high: int) -> Array:
        spans = [np.arange(max(k + low, 0), min(k + high, end) + 1) for k in start]
        return np.array([s[np.argmin(np.hypot(*(curve[s] - p).T))] for s, (_, p, _) in zip(spans, cases, strict=True)])

    wanted = nearest(0, most)
    if np.array_equal(told, wanted):
        return "The reference waits beside the robot, and no error grows while it drives round the block."
    named(
        told,
        (whole, "The nearest point of the whole curve may be far ahead, or behind: look only at k to k + most."),
        (
            np.clip(whole, start, np.minimum(start + most, end)),
            "At the crossing the nearest of the whole curve lies on the other branch: clip the search, not its answer.",
        ),
        (nearest(-most, most), "Yours may go back: time never runs back, begin at k."),
        (nearest(0, most - 1), "A slice ends before its last index: k + most itself is allowed."),
        (wanted - start, "That is counted from k: add k to the place within the slice."),
        (np.minimum(start + most, end), "Yours always goes on as far as it may: the robot would be left behind."),
        (start, "Yours stands still for ever: it must follow a robot that goes on."),
        (np.minimum(start + 1, end), "Yours goes on one by one, wherever the robot is."),
    )
    j = int(np.argmax(told != wanted))
    k, last = int(start[j]), min(int(start[j]) + most, end)
    raise Wrong(f"With the robot {cases[j][2]} the nearest of the indices {k} to {last} is {wanted[j]}, not {told[j]}.")


# --- 08.5


def _check_speed(answer: Function) -> str:
    """Seeded rooms, weights, paces and brakes."""
    rng = np.random.default_rng(85)
    rows = [[10.0, 0.0, 0.2, 0.08, 1.0], [10.0, 1.0, 0.2, 0.08, 1.0], [0.0, 0.3, 0.2, 0.08, 1.0]]
    rows += rng.uniform([0.0, 0.0, 0.15, 0.02, 0.2], [0.02, 1.0, 0.4, 0.1, 2.5], (24, 5)).tolist()
    told = np.array([number(answer(*row), "The speed") for row in rows])
    free, f, cruise, creep, brake = np.array(rows).T
    limit, wish = np.sqrt(2.0 * brake * free), (1.0 - f) * cruise + f * creep
    if close(told, np.minimum(limit, wish)) or _reacts(told, free, brake, wish):
        return "F sets the pace, the braking distance has the last word."
    named(
        told,
        (wish, "Yours forgets the brakes: before the margin the blended pace may be too fast to stop."),
        (limit, "Yours forgets the pace: with room enough the robot would drive as fast as it can stop."),
        (np.minimum(limit, cruise), "F has no effect in yours: it fades the pace from cruise to creep."),
        (np.minimum(limit, creep), "Yours always creeps: with F = 0 the pace is cruise."),
        (np.minimum(limit, f * cruise + (1 - f) * creep), "F is the wrong way round: F = 1 means creep."),
        (np.minimum(limit, 0.2 * (1 - f) + 0.08 * f), "cruise and creep are given; yours has 0.2 and 0.08 written in."),
        (np.minimum(np.sqrt(brake * free), wish), "From v the way to a stop is v²/(2a): the 2 is missing."),
        (np.maximum(limit, wish), "The larger of both is the one that cannot stop: take the smaller."),
    )
    k = int(np.argmax(told - limit))
    if told[k] > limit[k] + 1e-9:
        raise Wrong(
            f"At {free[k]:.4f} m from the margin {told[k]:.3f} m/s cannot stop with {brake[k]:.2f} m/s²: the limit is "
            f"{limit[k]:.3f} m/s."
        )
    k = int(np.argmax(np.abs(told - np.minimum(limit, wish))))
    raise Wrong(
        f"With F = {f[k]:.2f} and {free[k]:.4f} m free the speed should be {min(limit[k], wish[k]):.3f} m/s, yours is "
        f"{told[k]:.3f}."
    )


def _reacts(told: Array, free: Array, brake: Array, wish: Array) -> bool:
    """Whether the speeds brake after one and the same time of reaction, at most 0.2 s: more careful than asked."""
    slow = (told < wish - 1e-9) & (told > 0)
    if not slow.any():
        return False
    dt = float(np.median((free[slow] - told[slow] ** 2 / (2.0 * brake[slow])) / told[slow]))
    reach = np.sqrt((brake * dt) ** 2 + 2.0 * brake * free) - brake * dt
    return 0.0 <= dt <= 0.2 and close(told, np.minimum(reach, wish))


EXERCISES: tuple[Exercise, ...] = (
    Exercise(
        "08.1",
        "Floor and ceiling of F",
        1,
        (
            "Far from everything only rules 4 to 6 fire, and all conclude Little.",
            "The centroid of a right triangle lies a third of its base from the right angle.",
        ),
        _check_reach,
    ),
    Exercise(
        "08.2",
        "Who wins the blend?",
        1,
        (
            "At the balance (1 - F) pull + F push = 0.",
            "Solve for F: the pull is negative, the push positive.",
        ),
        _check_balance,
    ),
    Exercise(
        "08.3",
        "Repair the gate",
        2,
        (
            "The printed gate asks only where the block is now. Ask what tracking would do next, and remember it.",
            "Two margins: below enter it opens, above leave it shuts, in between it stays as it was.",
        ),
        _check_gate,
    ),
    Exercise(
        "08.4",
        "Let the reference wait",
        2,
        (
            "Look only at the indices k to k + most.",
            "numpy.argmin of the distances, plus k; mind the end of the curve.",
        ),
        _check_wait,
    ),
    Exercise(
        "08.5",
        "A speed that can stop",
        2,
        (
            "Stopping from v with deceleration a takes v²/(2a).",
            "The smaller of the blended pace and sqrt(2 a free).",
        ),
        _check_speed,
    ),
)
