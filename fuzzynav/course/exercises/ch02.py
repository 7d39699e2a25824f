"""Exercises of chapter 02: a prediction, a wrapped angle, a comb, log odds, and a map that forgets and remembers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.course.exercises.answers import close, integers, named, number, numbers
from fuzzynav.geometry import Array, wrap
from fuzzynav.mapping.occupancy import log_odds, probability

__all__ = ["EXERCISES"]

Function = Callable[..., Any]
Counts = NDArray[np.int_]


# --- 02.1


def _check_sideways(answer: Any) -> str:
    """Ten metres with two degrees of doubt in the heading."""
    told = number(answer, "The standard deviation")
    right = 10.0 * np.deg2rad(2.0)
    if abs(told - right) <= 0.0035:
        return f"Sideways {right:.2f} m after 10 m: the doubt in the heading costs most."
    if told < 0:
        raise Wrong("A standard deviation is never negative.")
    for value, near, sentence in (
        (20.0, 0.5, "20 m would be the answer if 2 were radians; the heading is off by 2 degrees, that is 0.035 rad."),
        (right**2, 0.01, f"{told:.3f} is the variance in m^2; its square root is asked for."),
        (np.deg2rad(2.0), 0.001, f"{told:.3f} rad is the doubt in the heading; after 10 m it becomes metres sideways."),
        (2 * right, 0.01, f"{told:.3f} m are two standard deviations; one is asked for."),
        (10 * np.cos(np.deg2rad(2.0)), 0.1, "That is how far it comes ahead; sideways it is the sine of the angle."),
        (100 * right, 0.5, "That is in centimetres; metres are asked for."),
    ):
        if abs(told - value) <= near:
            raise Wrong(sentence)
    raise Wrong(f"A heading off by 2 deg misses a mark 10 m ahead by 10 sin(2 deg); {told:.3g} m is not that.")


# --- 02.2


def _check_innovation(answer: Function) -> str:
    """Differences of range and bearing, the bearing across the cut at pi."""
    rng = np.random.default_rng(22)
    measured = np.vstack([[5.0, 3.10], [5.0, -3.10], rng.uniform([0, -3.1], [9, 3.1], (50, 2))])
    expected = np.vstack([[4.8, -3.10], [4.8, 3.10], rng.uniform([0, -3.1], [9, 3.1], (50, 2))])
    cases = zip(measured, expected, strict=True)
    told = np.array([numbers(answer(m.copy(), e.copy()), 2, "The innovation") for m, e in cases])
    away, plain = (measured - expected).T
    gap = wrap(plain)
    if not close(told[:, 0], away):
        _name_ranges(told[:, 0], away)
    told_gap = np.where(np.pi - np.abs(gap) < 1e-3, gap, told[:, 1])  # exactly behind, both signs are right
    if not close(told_gap, gap):
        _name_bearings(told_gap, gap, plain)
    return "No beacon turns the robot round any more."


def _name_ranges(told: Array, away: Array) -> None:
    named(
        told,
        (-away, "Innovation is measured minus expected: yours is expected minus measured."),
        (wrap(away), "Only the bearing is an angle: yours wraps the range too."),
        (np.abs(away), "The sign of the range difference is lost: nearer than expected is negative."),
    )
    raise Wrong(f"The difference of range is {away[0]:.2f} m where it was measured as 5.0 m; yours is {told[0]:.2f} m.")


def _name_bearings(told: Array, gap: Array, plain: Array) -> None:
    named(
        told,
        (
            plain,
            "A beacon expected at -3.10 rad and seen at 3.10 rad is 0.083 rad to the right of it, not 6.20 rad "
            "to the left: yours takes the long way round.",
        ),
        (-gap, "The bearing has the wrong sign: it is measured minus expected."),
        (np.abs(gap), "A beacon to the right of where it was expected has a negative innovation: yours has no sign."),
        (plain % (2 * np.pi), "Modulo 2 pi gives 0 to 2 pi: a beacon a little to the right is then far to the left."),
        (plain % np.pi, "Modulo pi makes ahead and behind the same: whole turns are 2 pi."),
        (plain - 2 * np.pi, "Taking off 2 pi always mends one side and spoils the rest: wrap to [-pi, pi)."),
        (np.arcsin(np.sin(gap)), "The arcsine knows no angle beyond 90 degrees: use sine and cosine, or wrap."),
    )
    k = int(np.argmax(np.abs(told - gap) > 1e-6))
    raise Wrong(f"The shorter way from the expected to the measured bearing is {gap[k]:.2f} rad, yours {told[k]:.2f}.")


# --- 02.3


def _check_comb(answer: Function) -> str:
    """Counts of the low-variance comb on seeded weights, and a tooth that rounding puts beyond the last end."""
    rng = np.random.default_rng(23)
    cases = [(np.array([0.1, 0.6, 0.3]), 0.5), (np.array([0.2, 0.2, 0.6]), 0.1)]
    cases += [(rng.dirichlet(np.full(n, 0.3)), float(rng.uniform(0.01, 0.99))) for n in (1, 2, 7, 40, 500)]
    counts = []
    for weights, u in cases:
        n = len(weights)
        told = integers(answer(weights.copy(), u), -1, "Indices")
        if len(told) != n:
            raise Wrong(f"{n} weights ask for {n} indices; yours are {len(told)}.")
        if not 0 <= min(told) <= max(told) < n:
            raise Wrong(f"With {n} particles indices go from 0 to {n - 1}; yours from {min(told)} to {max(told)}.")
        counts.append(np.bincount(told, minlength=n))
    _compare_counts(counts, cases)
    last = integers(answer(np.full(10, 0.1), 1.0 - 1e-16), -1, "Indices")
    if max(last, default=0) > 9:
        raise Wrong(
            f"Ten weights of 0.1 add up to less than 1 by rounding; the tooth at 1 - 1e-17 asked for particle "
            f"{max(last)} of 0 to 9: a tooth beyond the last end belongs to the last."
        )
    return "Each particle lives on as often as its weight promises, give or take one."


def _drawn(weights: Array, teeth: Array, edges: Array | None = None) -> Counts:
    """How often a comb draws each particle."""
    n = len(weights)
    edges = np.cumsum(weights) if edges is None else edges
    return np.bincount(np.searchsorted(edges, teeth).clip(0, n - 1), minlength=n)


def _compare_counts(counts: list[Counts], cases: list[tuple[Array, float]]) -> None:
    """Name what is wrong in the numbers of copies that were drawn."""
    told = np.concatenate(counts)
    sets = [(w, (np.arange(len(w)) + u) / len(w), u) for w, u in cases]
    if np.array_equal(told, np.concatenate([_drawn(w, teeth) for w, teeth, _ in sets])):
        return
    for copies, sentence in (
        ([_drawn(w, teeth + (1 - u) / len(w)) for w, teeth, u in sets], "Your teeth ignore u: u moves the whole comb."),
        ([_drawn(w, (teeth + u) % 1) for w, teeth, u in sets], "The first tooth stands at u / n: yours beyond it."),
        (
            [_drawn(w, teeth, np.cumsum(np.sort(w))) for w, teeth, _ in sets],
            "Sorted weights belong to other particles.",
        ),
        (
            [_drawn(w, teeth, w) for w, teeth, _ in sets],
            "Compare teeth with ends of stretches: add the weights up first.",
        ),
        ([np.eye(len(w))[np.argmax(w)] * len(w) for w, *_ in sets], "All are copies of the heaviest: the cloud dies."),
        (
            [np.roll(_drawn(w, teeth), 1) for w, teeth, _ in sets],
            "Your indices are one too high: the first particle is 0.",
        ),
    ):
        named(told, (np.concatenate(copies), sentence))
    for count, (w, u) in zip(counts, cases, strict=True):
        n = len(w)
        k = int(np.argmax(np.abs(count - n * w)))
        if abs(count[k] - n * w[k]) >= 1.0 + 1e-9:
            raise Wrong(
                f"A particle of weight {w[k]:.3f} among {n} must be drawn {int(n * w[k])} or {int(n * w[k]) + 1} "
                f"times, yours was drawn {count[k]} times (u = {u:.2f})."
            )
    raise Wrong("Each particle is drawn about as often as it should, but not by the comb that starts at u / n.")


# --- 02.4


def _check_fuse(answer: Function) -> str:
    """Known chances, order, a certain sensor for a long time."""
    rng = np.random.default_rng(24)
    cases: list[tuple[float, list[float]]] = [(0.5, [0.7, 0.7]), (0.2, [0.5]), (0.3, [])]
    cases += [(float(rng.uniform(0.05, 0.95)), rng.uniform(0.1, 0.9, 6).tolist()) for _ in range(20)]
    told = np.array([number(answer(prior, list(chances)), "The chance") for prior, chances in cases])
    _compare_chances(told, cases)
    for chance in (0.9, 0.1):
        sure = number(answer(0.5, [chance] * 1000), "The chance after a thousand sightings", silent=True)
        if np.isnan(sure):
            raise Wrong("A thousand odds multiplied overflow, and the chance becomes nan: add logarithms instead.")
        if abs(sure - round(chance)) > 1e-6:
            raise Wrong(f"A thousand sightings of {chance} leave no doubt; yours gives {sure:.4f}.")
    return "Sightings add, in any order, and a thousand of them do no harm."


def _compare_chances(told: Array, cases: list[tuple[float, list[float]]]) -> None:
    """Name what is wrong in the chances after sightings; the first case is two sightings of 0.7 from 0.5."""
    start = np.array([float(log_odds(prior)) for prior, _ in cases])
    seen = np.array([sum(float(log_odds(p)) for p in chances) for _, chances in cases])
    count = np.array([len(chances) for _, chances in cases])
    if close(told, probability(start + seen)):
        return
    named(
        told,
        (probability(seen), "The prior is left out: what was believed before counts like one more sighting."),
        (
            probability(start + seen - count * start),
            "Each chance is what one sighting says to somebody who knew nothing (0.5): no prior is in it to take off.",
        ),
        (start + seen, "These are log odds; turn them back into a chance."),
        (np.exp(start + seen), "These are odds; a chance is odds / (1 + odds)."),
        (probability(-start - seen), "This is the chance that the cell is free: mind the sign of the log odds."),
    )
    named(
        float(told[0]),
        (0.7, "Two sightings of 0.7 say more than one: the chance must rise above 0.7; odds multiply."),
        (0.49, "0.49 is the chance that two unrelated things both happen; of one cell multiply the odds."),
        (0.91, "0.91 says that one of both is right; a sighting of below 0.5 could then never lower the chance."),
    )
    k = int(np.argmax(np.abs(told - probability(start + seen)) > 1e-6))
    prior, chances = cases[k]
    raise Wrong(f"From {prior:.2f}, sightings {np.round(chances, 2).tolist()} do not lead to {told[k]:.4f}.")


# --- 02.5


def _check_forget(answer: Any) -> str:
    """A visitor must fade within ten scans, a chair leg that two scans of five miss must stay."""
    hit, miss = (float(v) for v in numbers(answer, 2, "(hit, miss)"))
    if max(hit, miss) > 1.0:
        raise Wrong(f"Chances lie between 0 and 1, not {max(hit, miss):g}: write 0.7 for 70 %.")
    if hit < 0.5 < miss:
        raise Wrong(f"A hit must raise the chance and a miss lower it; yours are swapped: {hit:.2f} and {miss:.2f}.")
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
            "p = 1 / (1 + exp(-L)) with L the log odds; (1 + tanh(L / 2)) / 2 is the same and never overflows.",
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
