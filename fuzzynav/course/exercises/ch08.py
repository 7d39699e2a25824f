"""Exercises of chapter 08: reach of F, who wins, a gate with memory, a reference that waits, a speed that can stop."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fuzzynav.blend import reach_of, table_5_1
from fuzzynav.course.exercise import Exercise, Wrong

__all__ = ["EXERCISES"]

Function = Callable[..., Any]


def _numbers(value: Any, count: int, what: str) -> np.ndarray:
    """The answer as `count` finite numbers, or a sentence that says what was expected."""
    try:
        found = np.asarray(value, dtype=float).ravel()
    except (TypeError, ValueError):
        raise Wrong(f"{what} should be {count} number{'s' * (count > 1)}, not {type(value).__name__}.") from None
    if found.shape != (count,) or not np.isfinite(found).all():
        raise Wrong(f"{what} should be {count} finite number{'s' * (count > 1)}.")
    return found


# --- 08.1


def _check_reach(answer: Any) -> str:
    """The centroids of the outer sets."""
    low, high = _numbers(answer, 2, "Floor and ceiling of F")
    floor, ceiling = reach_of(table_5_1())
    if abs(low) < 1e-9 or abs(high - 1.0) < 1e-9:
        raise Wrong("A centroid lies inside its set, never on its edge: F reaches neither 0 nor 1.")
    if abs(low - floor) > 0.004:
        raise Wrong(f"The centroid of Little, the triangle (0, 0, 0.5), is {floor:.3f}; yours is {low:.3f}.")
    if abs(high - ceiling) > 0.004:
        raise Wrong(f"The centroid of Lots, the triangle (0.5, 1, 1), is {ceiling:.3f}; yours is {high:.3f}.")
    return f"Without a gate a robot far from everything would drive at {100 * (1 - floor):.0f} % of its speed."


# --- 08.2


def _check_balance(answer: Function) -> str:
    """Seeded pairs of yaw rates that pull in opposite directions."""
    rng = np.random.default_rng(82)
    for _ in range(8):
        pull, push = -rng.uniform(0.2, 5.0), rng.uniform(0.3, 2.0)
        f = _numbers(answer(pull, push), 1, "The weight")[0]
        net = (1.0 - f) * pull + f * push
        if abs(net) > 1e-6:
            raise Wrong(
                f"With F = {f:.3f} tracking at {pull:.2f} rad/s and avoidance at {push:.2f} rad/s leave a turn "
                f"of {net:.3f} rad/s; at the balance it is 0."
            )
    return "Tracking that pulls at 5 rad/s outweighs avoidance at 1 rad/s up to F = 5/6, the ceiling of table 5.1."


# --- 08.3


def _check_gate(answer: Function) -> str:
    """Forecasts that fall, hover between both margins, and rise."""
    rng = np.random.default_rng(83)
    for enter, leave in ((0.10, 0.12), (0.05, 0.2)):
        state = False
        for forecast in np.concatenate([[1.0, leave, enter - 0.01], rng.uniform(0.0, 0.3, 60)]):
            told, was = answer(state, float(forecast), enter, leave), state
            state = forecast < enter or (was and forecast <= leave)
            if not isinstance(told, bool | np.bool_):
                raise Wrong(f"The gate is open or shut: return True or False, not {type(told).__name__}.")
            if bool(told) != state:
                before = "avoided" if was else "tracked"
                raise Wrong(
                    f"The robot {before}, and the forecast of tracking is {forecast:.3f} m (enter {enter} m, "
                    f"leave {leave} m): avoidance must be {'on' if state else 'off'}."
                )
    return "The gate opens on a bad forecast, stays open in between, and shuts on a good one."


# --- 08.4


def _check_wait(answer: Function) -> str:
    """A robot beside, behind, ahead of a sampled circle."""
    angle = np.linspace(0.0, 4.0, 400)
    curve = np.column_stack([np.cos(angle), np.sin(angle)])
    cases = [
        (50, curve[50] * 1.4, "beside the curve"),
        (50, curve[20], "behind the reference"),
        (50, curve[52] * 0.7, "a little ahead"),
        (50, curve[300], "far ahead"),
        (398, curve[399], "at the end"),
    ]
    for k, place, where in cases:
        told = int(_numbers(answer(k, place, curve, 3), 1, "The index")[0])
        last = min(k + 3, len(curve) - 1)
        wanted = k + int(np.argmin(np.hypot(*(curve[k : last + 1] - place).T)))
        if told < k:
            raise Wrong(f"With the robot {where} the reference went back from {k} to {told}: time never runs back.")
        if told > last:
            raise Wrong(f"With the robot {where} the reference jumped from {k} to {told}: at most to {last}.")
        if told != wanted:
            raise Wrong(f"With the robot {where} the nearest of the indices {k} to {last} is {wanted}, not {told}.")
    return "The reference waits beside the robot, and no error grows while it drives round the block."


# --- 08.5


def _check_speed(answer: Function) -> str:
    """Seeded rooms, weights and brakes."""
    rng = np.random.default_rng(85)
    for free, f in [(10.0, 0.0), (10.0, 1.0), (0.0, 0.3), *rng.uniform([0.0, 0.0], [0.02, 1.0], (10, 2))]:
        brake = float(rng.uniform(0.2, 2.5))
        v = _numbers(answer(float(free), float(f), 0.2, 0.08, brake), 1, "The speed")[0]
        limit, wish = np.sqrt(2.0 * brake * free), 0.2 * (1.0 - f) + 0.08 * f
        if v > limit + 1e-9:
            raise Wrong(
                f"At {free:.4f} m from the margin {v:.3f} m/s cannot stop with {brake:.2f} m/s²: the limit is "
                f"{limit:.3f} m/s."
            )
        if abs(v - min(limit, wish)) > 1e-9:
            raise Wrong(
                f"With F = {f:.2f} and {free:.4f} m free the speed should be {min(limit, wish):.3f} m/s, yours "
                f"is {v:.3f}: blend cruise and creep by F, then respect the brakes."
            )
    return "F sets the pace, the braking distance has the last word."


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
