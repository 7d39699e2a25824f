"""Exercises of chapter 03: strengths by hand, the centroid, a merging bug, a safe speed, a full rule base."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import astuple, replace
from typing import Any

import numpy as np

from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.course.exercises.answers import close, named, number, numbers
from fuzzynav.fuzzy import FuzzySystem, RuleBlock
from fuzzynav.fuzzy.defuzzify import centroid
from fuzzynav.geometry import Array
from fuzzynav.studies.fuzzy import SpeedSets, rule_base, speed_system

__all__ = ["EXERCISES", "with_rules"]

Function = Callable[..., Any]
BRAKE = 0.04  # m/s^2, the weak brake of exercise 03.4
TERMS = ("Low", "Medium", "High")


# --- 03.1


def _check_strengths(answer: Any) -> str:
    """Four strengths at 0.5 m and 60 deg against the compiled inference."""
    told = numbers(answer, 4, "The strengths")
    right = speed_system().evaluate(0.5, 60.0).firing
    if np.abs(told - right).max() <= 0.006:
        return "You did what the fuzzifier and the rules do."
    if (told < 0).any():
        raise Wrong("A strength is never negative.")
    if (told > 1).any():
        raise Wrong("A strength lies between 0 and 1: write 0.75 for 75 %.")
    for value, sentence in (
        (
            (0.75, 1 / 12, 0.0, 2 / 3),
            "Rule 2 joins with AND, and AND takes the smaller of two memberships, not their product.",
        ),
        ((0.75, 1 / 3, 1 / 3, 2 / 3), "Rules 2 and 3 join with AND: the greater membership would be OR."),
        (
            (0.75, 0.25, 0.0, 1 / 3),
            "Small and Large are swapped: at 60 deg the error is more Large (2/3) than Small (1/3).",
        ),
        ((0.25, 0.25, 0.0, 2 / 3), "Near is 1 at 0 m and falls to 0 at 2 m: at 0.5 m most of it is left."),
        ((0.75, 0.25, 0.125, 2 / 3), "Far begins at 2 m: at 0.5 m nothing is far, and a rule with AND is silent."),
    ):
        if np.abs(told - value).max() <= 0.006:
            raise Wrong(sentence)
    why = (
        "Near falls from 1 at 0 m to 0 at 2 m",
        "Medium rises from 0 at 0 m to 1 at 2 m, and AND takes the smaller of two memberships",
        "Far begins at 2 m",
        "Large rises from 0 at 0 deg to 1 at 90 deg",
    )
    k = int(np.argmax(np.abs(told - right) > 0.006))
    raise Wrong(f"Rule {k + 1} does not fire with {told[k]:.2f} at 0.5 m and 60 deg: {why[k]}.")


# --- 03.2


def _check_centroid(answer: Function) -> str:
    """Seeded output sets on uneven samples: the trapezoid rule, or straight lines between the samples; an empty set."""
    rng = np.random.default_rng(32)
    even, sets = np.linspace(0.0, 1.0, 101), []
    for size in rng.integers(21, 80, 6):
        low, high = np.sort(rng.uniform(-2.0, 3.0, 2))
        grid = low + (high - low) * np.sort(np.append([0.0, 1.0], rng.random(int(size)))) ** 2
        sets.append((grid, rng.random(grid.size) * (rng.random(grid.size) > 0.3)))
    told = np.array([number(answer(x.copy(), mu.copy()), "The centroid", silent=True) for x, mu in sets])
    if np.isnan(told).any():
        raise Wrong("Yours says nan for a set that is not empty.")
    _compare_centroids(told, sets)
    middle = number(answer(even, np.minimum(0.6, 1.0 - np.abs(2.0 * even - 1.0))), "The centroid", silent=True)
    if not abs(middle - 0.5) < 1e-6:
        raise Wrong(f"A set that is symmetric about 0.5 m/s balances there, yours at {middle:.6g}.")
    if not np.isnan(number(answer(even, np.zeros(101)), "The centroid of the empty set", silent=True)):
        raise Wrong("Where no rule fires there is nothing to balance: the answer must be nan, not a number.")
    return "Your centroid balances every set, and says nan where there is none."


def _compare_centroids(told: Array, sets: list[tuple[Array, Array]]) -> None:
    """Name what is wrong in the balance points of these sets."""
    wanted = np.array([float(centroid(x, mu)) for x, mu in sets])
    if close(told, wanted) or close(told, [float(centroid(x, mu, "exact")) for x, mu in sets]):
        return
    area = np.array([np.trapezoid(mu, x) for x, mu in sets])
    named(
        told,
        ([float((x * mu).sum() / mu.sum()) for x, mu in sets], "Plain sums weigh a sample alike wherever it stands."),
        (
            [float(np.trapezoid(x * mu) / np.trapezoid(mu)) for x, mu in sets],
            "Without x the rule takes all samples as equally far apart; here they are not: give x to the rule too.",
        ),
        (wanted * area, "This is the moment, the integral of x mu; divide it by the area."),
        (area, "This is the area; the integral of x mu over it is the balance point."),
        (
            [float(x[np.argmax(mu)]) for x, mu in sets],
            "This is the place of the greatest degree, not the balance point.",
        ),
        ([float(x.mean()) for x, mu in sets], "This is the mean of the samples, whatever their degrees are."),
    )
    k = int(np.argmax(np.abs(told - wanted)))
    x = sets[k][0]
    raise Wrong(f"A set from {x[0]:.2f} to {x[-1]:.2f} balances at {wanted[k]:.5g}, not {told[k]:.5g}.")


# --- 03.3


def _check_merged(answer: Function) -> str:
    """Strengths of the conclusions for seeded rules in two orders."""
    rng = np.random.default_rng(33)
    told: list[float] = []
    groups: list[list[float]] = []
    for _ in range(8):
        n = int(rng.integers(4, 9))
        firing, conclusions = rng.uniform(0.05, 0.95, n).round(2), [str(t) for t in rng.choice(TERMS, n)]
        for k in (np.arange(n), rng.permutation(n)):
            said = answer(firing[k], [conclusions[i] for i in k])
            if not isinstance(said, dict):
                raise Wrong(f"The answer should be a dict from conclusion to strength, not a {type(said).__name__}.")
            for term in dict.fromkeys(conclusions):
                if term not in said:
                    raise Wrong(f"A rule concludes {term}, but {term} is missing in your dict.")
                told.append(number(said[term], f"The strength of {term}"))
                groups.append([float(firing[i]) for i in k if conclusions[i] == term])
    _compare_strengths(np.array(told), groups)
    return "The strongest rule counts, in any order."


def _compare_strengths(told: Array, groups: list[list[float]]) -> None:
    """Name what is wrong in the clips of conclusions that several rules draw."""
    wanted = np.array([max(group) for group in groups])
    if close(told, wanted):
        return
    named(
        told,
        (
            [g[-1] for g in groups],
            "The last rule wins in yours: a weak one that comes later lowers what a strong one said.",
        ),
        ([g[0] for g in groups], "The first rule wins in yours, though a later one may be stronger."),
        (
            [min(g) for g in groups],
            "The weakest rule wins in yours: that is AND; rules with one conclusion join with OR.",
        ),
        ([sum(g) for g in groups], "Yours adds the strengths up: two half-sure rules would become certain, or more."),
        ([min(sum(g), 1.0) for g in groups], "Yours adds up to 1; max-min joins by the greatest, without adding."),
        ([sum(g) / len(g) for g in groups], "Yours takes the mean: a weak rule then lowers what a strong one said."),
        (
            [1.0 - float(np.prod([1.0 - f for f in g])) for g in groups],
            "Yours joins like chances (a + b - ab), which raises the clip above the strongest rule.",
        ),
    )
    k = int(np.argmax(np.abs(told - wanted)))
    raise Wrong(
        f"Rules of strength {groups[k]} share a conclusion: the clip is at {wanted[k]:.2f}, yours {told[k]:.2f}."
    )


# --- 03.4


def _check_speed_sets(answer: Any) -> str:
    """The speed must allow a stop before the obstacle, without crawling far from it, and without a gap."""
    if not isinstance(answer, SpeedSets):
        raise Wrong("The answer should be made with replace(study.SpeedSets(), near_end=..., ...): give such sets.")
    system = speed_system(answer)
    edges = np.unique(np.clip(astuple(answer)[:5], 0.0, 4.0))
    distance = np.unique(np.concatenate([np.linspace(0.0, 4.0, 801), edges, 0.5 * (edges[1:] + edges[:-1])]))
    speed = system(distance, 0.0)[0]
    silent = np.flatnonzero(np.isnan(speed))
    if silent.size:
        raise Wrong(f"At {distance[silent[0]]:.3f} m no rule fires: the robot has no speed at all there.")
    distance, speed = distance[distance >= 0.3], speed[distance >= 0.3]
    limit = np.sqrt(2.0 * BRAKE * distance)
    k = int(np.argmax(speed - limit))
    if speed[k] > limit[k]:
        raise Wrong(
            f"At {distance[k]:.2f} m the robot drives {speed[k]:.3f} m/s and needs "
            f"{speed[k] ** 2 / (2.0 * BRAKE):.2f} m to stop: the limit there is {limit[k]:.3f} m/s."
        )
    far = float(system(2.5, 0.0)[0])
    if far < 0.30:
        raise Wrong(f"At 2.5 m the way is free, yet the robot crawls at {far:.3f} m/s: 0.300 are asked for.")
    return f"It stops in time everywhere from 0.3 m on, and drives {far:.2f} m/s at 2.5 m."


# --- 03.5


def with_rules(texts: Any) -> FuzzySystem:
    """Table 3.2 with the rules of the learner added; raises Wrong where one cannot be used."""
    if isinstance(texts, str) or not hasattr(texts, "__iter__") or isinstance(texts, dict):
        raise Wrong("Give a list of rules, each a text like those of table 3.2.")
    table, rules = rule_base("thesis_table_3_2"), list(texts)
    if not rules:
        raise Wrong("The list is empty: write at least one rule.")
    try:
        added = RuleBlock(rules=tuple(rules)).rules
        return replace(table, blocks=(replace(table.blocks[0], rules=(*table.rules, *added)),))
    except (TypeError, ValueError, AttributeError) as error:
        raise Wrong(f"A rule cannot be used: {error}.") from None


def _check_full(answer: Any) -> str:
    """No gap is left, the nine printed cases keep their answers, and a close obstacle keeps its weight."""
    full, table = with_rules(answer), rule_base("thesis_table_3_2")
    gaps = full.uncovered(n=21)
    _name_gaps(full, gaps.missing)
    for k in range(9):
        point = (90.0 * (k % 3), 7.5 * (k // 3), 0.5 * (k % 3))
        before, after = np.array(table(*point)), np.array(full(*point))
        if np.abs(before - after).max() > 1e-9:
            raise Wrong(
                f"At {point} the printed rule {k + 1} alone should speak: alpha, beta, gamma were {_three(before)}, "
                f"now they are {_three(after)}. One of your rules fires there too."
            )
    corners = [(h, v) for h in (0.0, 90.0, 180.0) for v in (0.0, 0.5, 1.0)]
    for heading, speed in corners:
        alpha, beta, _ = full(heading, 0.0, speed)
        if beta <= alpha:
            raise Wrong(
                f"With an obstacle at 0 m, heading {heading:g} deg and {speed:g} m/s the clearance weighs "
                f"{beta:.2f} and the heading {alpha:.2f}: the robot would drive into it."
            )
    return f"{len(list(answer))} rules added, no gap left, the nine printed cases unchanged."


def _name_gaps(full: FuzzySystem, missing: tuple[tuple[str, ...], ...]) -> None:
    """Say which combinations hear no rule at all, and which lack one of the three weights."""
    for names in missing:
        peaks = [v.term(n).parameters[1] for v, n in zip(full.inputs, names, strict=True)]
        heard = [o.name for o in full.outputs if max(full.evaluate(*peaks).conclusions(o.name).values()) > 0]
        where = " and ".join(names)
        if heard:
            lacking = " and ".join(o.name for o in full.outputs if o.name not in heard)
            raise Wrong(
                f"For {where} a rule speaks, but none says anything about {lacking}: conclude all three weights."
            )
        count = "One combination is" if len(missing) == 1 else f"{len(missing)} combinations are"
        raise Wrong(f"{count} still without a rule, such as {where}.")


def _three(weights: Array) -> str:
    return ", ".join(f"{w:.2f}" for w in weights)


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
        "Which set makes the robot fast at 0.5 m with heading error 0, and where does it begin? Lab 1 shows it.",
        "Medium must not speak close to the obstacle: raise medium_left. Near must still cover what it leaves: raise "
        "near_end.",
    ), _check_speed_sets),
    Exercise("03.5", "Close the gaps of table 3.2", 3, (
        "18 combinations are missing: all with another pairing of headGoal and velRob than the nine rules have.",
        "Loop over the three distances and the six other pairings, and write one rule text for each. A rule with 'any' "
        "also fires where a printed rule should speak alone.",
    ), _check_full),
)  # fmt: skip
