"""Exercises of chapter 02: a prediction, a wrapped angle, a comb, log odds, and a map that forgets and remembers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.geometry import wrap
from fuzzynav.mapping.occupancy import log_odds, probability

__all__ = ["EXERCISES"]

Function = Callable[..., Any]


def _numbers(value: Any, count: int, what: str) -> np.ndarray:
    """The answer as `count` finite numbers, or a sentence that says what was expected."""
    try:
        found = np.asarray(value, dtype=float).ravel()
    except (TypeError, ValueError):
        raise Wrong(f"{what} should be {count} number{'s' * (count > 1)}, not {type(value).__name__}.") from None
    if found.shape != (count,) or not np.isfinite(found).all():
        raise Wrong(f"{what} should be {count} finite number{'s' * (count > 1)}, not {value!r}.")
    return found


# --- 02.1


def _check_sideways(answer: Any) -> str:
    """Ten metres with two degrees of doubt in the heading."""
    told = float(_numbers(answer, 1, "The standard deviation")[0])
    right = 10.0 * np.deg2rad(2.0)
    if abs(told - 20.0) < 0.5:
        raise Wrong("20 m would be the answer if 2 were radians; the heading is off by 2 degrees, that is 0.035 rad.")
    if abs(told - right**2) < 0.01:
        raise Wrong(f"{told:.3f} is the variance in m^2; its square root is asked for.")
    if abs(told - right) > 0.01:
        raise Wrong(f"A heading off by 2 deg misses a mark 10 m ahead by 10 sin(2 deg); {told:.3f} m is not that.")
    return f"Sideways {right:.2f} m after 10 m: the doubt in the heading costs most."


# --- 02.2


def _check_innovation(answer: Function) -> str:
    """Differences of range and bearing, the bearing across the cut at pi."""
    told = _numbers(answer(np.array([5.0, 3.10]), np.array([4.8, -3.10])), 2, "The innovation")
    if abs(told[1] - 6.2) < 1e-9:
        raise Wrong(
            "A beacon expected at -3.10 rad and seen at 3.10 rad is 0.083 rad to the right of it, not 6.20 rad "
            "to the left: the filter would turn the robot once round."
        )
    rng = np.random.default_rng(22)
    for _ in range(50):
        measured, expected = (np.array([rng.uniform(0, 9), rng.uniform(-np.pi, np.pi)]) for _ in range(2))
        told = _numbers(answer(measured.copy(), expected.copy()), 2, "The innovation")
        if abs(told[0] - (measured[0] - expected[0])) > 1e-9:
            raise Wrong(
                f"Seen at {measured[0]:.2f} m, expected at {expected[0]:.2f} m: the difference of range is "
                f"{measured[0] - expected[0]:.2f} m, yours is {told[0]:.2f} m."
            )
        gap = float(wrap(measured[1] - expected[1]))
        if abs(told[1] - gap) > 1e-9 and abs(abs(gap) - np.pi) > 1e-6:
            raise Wrong(
                f"Seen at {measured[1]:.2f} rad, expected at {expected[1]:.2f} rad: the shorter way round is "
                f"{gap:.2f} rad, yours is {told[1]:.2f} rad."
            )
    return "No beacon turns the robot round any more."


# --- 02.3


def _check_comb(answer: Function) -> str:
    """Counts of the low-variance comb on seeded weights."""
    told = _indices(answer(np.array([0.1, 0.6, 0.3]), 0.5), 3)
    if sorted(told) != [1, 1, 2]:
        raise Wrong(
            "With weights 0.1, 0.6, 0.3 and u = 0.5 the teeth stand at 1/6, 3/6, 5/6: they fall on the "
            f"particles 1, 1, 2, yours on {told}."
        )
    rng = np.random.default_rng(23)
    for n in (1, 2, 7, 40, 500):
        weights = rng.dirichlet(np.full(n, 0.3))
        u = rng.uniform(0.01, 0.99)
        drawn = _indices(answer(weights.copy(), u), n)
        if not 0 <= min(drawn) <= max(drawn) < n:
            raise Wrong(f"With {n} particles indices go from 0 to {n - 1}; yours from {min(drawn)} to {max(drawn)}.")
        counts = np.bincount(drawn, minlength=n)
        k = int(np.argmax(np.abs(counts - n * weights)))
        if abs(counts[k] - n * weights[k]) >= 1.0 + 1e-9:
            raise Wrong(
                f"A particle of weight {weights[k]:.3f} among {n} must be drawn {int(n * weights[k])} or "
                f"{int(n * weights[k]) + 1} times, yours was drawn {counts[k]} times."
            )
        wanted = np.bincount(np.searchsorted(np.cumsum(weights), (np.arange(n) + u) / n).clip(0, n - 1), minlength=n)
        if not np.array_equal(counts, wanted):
            raise Wrong(f"Among {n} particles the comb that starts at u / n = {u / n:.4f} draws others than yours.")
    return "Each particle lives on as often as its weight promises, give or take one."


def _indices(value: Any, n: int) -> list[int]:
    try:
        found = np.asarray(value, dtype=float).ravel()
    except (TypeError, ValueError):
        raise Wrong(f"{n} indices were expected, not {type(value).__name__}.") from None
    if len(found) != n or not np.isfinite(found).all() or np.any(found != np.round(found)):
        raise Wrong(f"{n} weights ask for {n} whole indices; yours are {len(found)} numbers.")
    return [int(v) for v in found]


# --- 02.4


def _check_fuse(answer: Function) -> str:
    """Known chances, order, a certain sensor for a long time."""
    told = float(_numbers(answer(0.5, [0.7, 0.7]), 1, "The chance")[0])
    if abs(told - 0.7) < 1e-9:
        raise Wrong("Two sightings of 0.7 say more than one: the chance must rise above 0.7; odds multiply.")
    if abs(told - 0.49) < 1e-9:
        raise Wrong(
            "0.49 is the chance that both of two dice-like events happen; two sightings of one cell multiply "
            "their odds, not their chances."
        )
    rng = np.random.default_rng(24)
    cases = [(0.5, [0.7, 0.7]), (0.2, [0.5]), (0.3, [])]
    cases += [(rng.uniform(0.05, 0.95), rng.uniform(0.1, 0.9, 6).tolist()) for _ in range(20)]
    for prior, chances in cases:
        told = float(_numbers(answer(prior, list(chances)), 1, "The chance")[0])
        right = float(probability(log_odds(prior) + sum(float(log_odds(p)) for p in chances)))
        if abs(told - right) > 1e-9:
            raise Wrong(
                f"From {prior:.2f}, sightings {np.round(chances, 2).tolist()} lead to {right:.4f}, yours to {told:.4f}."
            )
    for chance in (0.9, 0.1):
        told = float(_numbers(answer(0.5, [chance] * 1000), 1, "After a thousand sightings the chance")[0])
        if abs(told - round(chance)) > 1e-9:
            raise Wrong(f"A thousand sightings of {chance} leave no doubt; yours gives {told:.4f}: add logarithms.")
    return "Sightings add, in any order, and a thousand of them do no harm."


# --- 02.5


def _check_forget(answer: Any) -> str:
    """A visitor must fade within ten scans, a chair leg that two scans of five miss must stay."""
    hit, miss = (float(v) for v in _numbers(answer, 2, "(hit, miss)"))
    if not 0.12 < miss < 0.5 < hit < 0.97:
        raise Wrong(f"Chances must rise as 0.12 < miss < 0.5 < hit < 0.97, got hit {hit:.2f} and miss {miss:.2f}.")
    up, down, low, high = (float(v) for v in log_odds([hit, miss, 0.12, 0.97]))
    odds = min(5 * up, high)
    scans = next((k for k in range(1, 1000) if max(odds + k * down, low) < float(log_odds(0.196))), 1000)
    if scans > 10:
        raise Wrong(f"The visitor's cell takes {scans} scans to read as free: the limit is 10. A miss must weigh more.")
    share = _kept(up, down, low, high)
    if share < 0.95:
        raise Wrong(
            f"The chair leg is kept in {100 * share:.0f} % of the runs: the limit is 95 %. A hit must weigh "
            "more, or a miss less."
        )
    return f"The visitor is forgotten after {scans} scans, the chair leg kept in {100 * share:.0f} % of the runs."


def _kept(up: float, down: float, low: float, high: float) -> float:
    """Share of 2000 seeded runs of 60 scans, 60 % of them hits, that end above 0.65."""
    hits = np.random.default_rng(25).random((60, 2000)) < 0.6
    odds = np.zeros(2000)
    for row in hits:
        odds = np.clip(odds + np.where(row, up, down), low, high)
    return float((odds > float(log_odds(0.65))).mean())


EXERCISES = (
    Exercise(
        "02.1",
        "What a heading costs",
        1,
        (
            "Where is the mark 10 m ahead, seen by a robot whose heading is off by a small angle?",
            "Sideways = distance times angle, with the angle in radians: 10 m times 2 pi / 180.",
        ),
        _check_sideways,
    ),
    Exercise(
        "02.2",
        "Find the bug in the innovation",
        2,
        (
            "Try a beacon right behind the robot: bearings of 3.10 and -3.10 rad lie next to each other.",
            "The difference of two angles must be wrapped to [-pi, pi): geometry.wrap does it.",
        ),
        _check_innovation,
    ),
    Exercise(
        "02.3",
        "Low-variance resampling",
        3,
        (
            "Lay the weights end to end on [0, 1]. A comb with teeth at (k + u) / n falls on the particles to draw.",
            "np.cumsum gives the ends of the stretches; np.searchsorted finds the stretch of each tooth.",
            "A tooth beyond the last end, by rounding, belongs to the last particle: np.minimum(..., n - 1).",
        ),
        _check_comb,
    ),
    Exercise(
        "02.4",
        "Fuse what a cell was told",
        2,
        (
            "Odds are p / (1 - p). Independent sightings multiply the odds.",
            "Products of a thousand odds overflow: add logarithms, and turn back once at the end.",
            "p = 1 / (1 + exp(-log odds)).",
        ),
        _check_fuse,
    ),
    Exercise(
        "02.5",
        "A map that forgets visitors and keeps chair legs",
        2,
        (
            "With hit 0.7 and miss 0.4 a visitor of 5 scans takes 13 scans to fade: which number must move?",
            "Five hits reach the ceiling 0.97 (3.48). Ten misses must bring it under -1.41: 0.49 or more each.",
            "Then weigh the hits: 60 % of them against 40 % misses must drift up clearly. Try 0.8 for a hit.",
        ),
        _check_forget,
    ),
)
