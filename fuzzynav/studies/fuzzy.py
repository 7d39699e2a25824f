"""Thesis 2.4: the example systems of notebook 03, which are ours, and the worked example.

The thesis prints no number in section 2.4. The one printed number that its methods can be held against is the worked
example of the 27-rule planner.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from fuzzynav.data import folder
from fuzzynav.fuzzy import FuzzySystem, Rule, RuleBlock, Variable, constant, linear, trapezoid, triangle
from fuzzynav.studies.reproduction import Reproduction

__all__ = ["REPRODUCTIONS", "SpeedSets", "arrangements", "planner", "rule_base", "speed_system", "sugeno_speed"]

FOLDER = folder("fuzzy")


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedSets:
    """Breakpoints of the sets of `speed_system`: distance [m], heading error [deg], speed [m/s]."""

    near_end: float = 2.0
    medium_left: float = 0.0
    medium_peak: float = 2.0
    medium_right: float = 4.0
    far_start: float = 2.0
    small_end: float = 90.0
    large_start: float = 0.0
    slow_end: float = 0.3
    middle_left: float = 0.0
    middle_peak: float = 0.3
    middle_right: float = 0.6
    fast_start: float = 0.3


SPEED_RULES = (
    "if distance is Near then speed is Slow",
    "if distance is Medium and error is Small then speed is Middle",
    "if distance is Far and error is Small then speed is Fast",
    "if error is Large then speed is Slow",
)


def speed_system(chosen: SpeedSets | None = None) -> FuzzySystem:
    """Speed [m/s] from the distance of an obstacle [m] and the heading error [deg]: four rules, triangles, ours.

    The universe of `distance`, 0 to 4 m with Near, Medium and Far, is the example that the thesis prints.

    >>> round(speed_system()(1.5, 30.0)[0], 3)
    0.284
    """
    s = chosen or SpeedSets()
    distance = Variable(
        name="distance",
        low=0.0,
        high=4.0,
        unit="m",
        terms=(
            triangle("Near", 0.0, 0.0, s.near_end),
            triangle("Medium", s.medium_left, s.medium_peak, s.medium_right),
            triangle("Far", s.far_start, 4.0, 4.0),
        ),
    )
    error = Variable(
        name="error",
        low=0.0,
        high=90.0,
        unit="deg",
        terms=(triangle("Small", 0.0, 0.0, s.small_end), triangle("Large", s.large_start, 90.0, 90.0)),
    )
    speed = Variable(
        name="speed",
        low=0.0,
        high=0.6,
        unit="m/s",
        terms=(
            triangle("Slow", 0.0, 0.0, s.slow_end),
            triangle("Middle", s.middle_left, s.middle_peak, s.middle_right),
            triangle("Fast", s.fast_start, 0.6, 0.6),
        ),
    )
    return FuzzySystem(
        name="speed",
        inputs=(distance, error),
        outputs=(speed,),
        blocks=(RuleBlock(name="rules", rules=_speed_rules()),),
        description="ours, to learn with",
    )


@cache
def _speed_rules() -> tuple[Rule, ...]:
    return tuple(Rule.parse(text) for text in SPEED_RULES)


def sugeno_speed() -> FuzzySystem:
    """Speed [m/s] from the distance [m] of an obstacle by three Takagi-Sugeno rules: 0.1, 0.15 distance, 0.6; ours.

    >>> round(sugeno_speed()(1.0)[0], 3)
    0.125
    """
    distance = speed_system().inputs[0]
    terms = (
        constant("Crawl", 0.1),
        linear("Follow", 0.15, 0.0),
        constant("Cruise", 0.6),
    )
    speed = Variable(name="speed", low=0.0, high=0.6, unit="m/s", terms=terms, defuzzifier="weighted average")
    pairs = (("Near", "Crawl"), ("Medium", "Follow"), ("Far", "Cruise"))
    rules = tuple(Rule.parse(f"if distance is {a} then speed is {b}") for a, b in pairs)
    return FuzzySystem(
        name="sugeno",
        inputs=(distance,),
        outputs=(speed,),
        blocks=(RuleBlock(name="rules", rules=rules),),
        description="ours, to learn with",
    )


def arrangements() -> dict[str, Variable]:
    """Three ways to lay three sets over the distance [m]: symmetric, too little overlap, too much; ours."""
    corners = {
        "symmetric, crossing at 0.5": ((0, 0, 0, 2), (0, 2, 2, 4), (2, 4, 4, 4)),
        "too little overlap: gaps": ((0, 0, 0, 0.8), (1.2, 2, 2, 2.8), (3.2, 4, 4, 4)),
        "too much overlap: at full height": ((0, 0, 1.6, 3.2), (0.4, 1.2, 2.8, 3.6), (0.8, 2.4, 4, 4)),
    }
    names = ("Near", "Medium", "Far")
    return {
        title: Variable(
            name="distance",
            low=0.0,
            high=4.0,
            unit="m",
            terms=tuple(trapezoid(n, *c) for n, c in zip(names, rows, strict=True)),
        )
        for title, rows in corners.items()
    }


@cache
def rule_base(name: str) -> FuzzySystem:
    """A rule base of `data/fuzzy` by its file name without the ending. Raises FileNotFoundError."""
    return FuzzySystem.load(FOLDER / f"{name}.fll")


def planner(sigma: float | None = None) -> FuzzySystem:
    """The 27-rule planner; `sigma` replaces the printed width of the input and output sets (as part of their range)."""
    system = rule_base("fuzzy_planner_table_i")
    if sigma is None:
        return system
    changed = {
        (variable.name, term.name): (term.parameters[0], sigma * (variable.high - variable.low))
        for variable in (*system.inputs, *system.outputs)
        for term in variable.terms
    }
    return system.with_terms(changed)


def _example(output: int) -> float:
    return float(planner()(0.8, 0.3, 0.5)[output])


def _closer_is_slower_and_turns_more() -> bool:
    """Whether v never rises and omega never falls from nothing near to an obstacle at the robot, the others at 0.5."""
    v, omega = planner()(0.5, 0.5, np.linspace(1.0, 0.0, 101))
    return bool((np.diff(v) <= 1e-9).all() and (np.diff(omega) >= -1e-9).all())


def _sugeno_is_cheaper() -> bool:
    """Operations behind the rules' strengths for one output of the planner: a sampled union's centroid, or sums."""
    rules, samples = len(planner().rules), planner().outputs[0].resolution
    mamdani = 2 * rules * samples + 3 * samples  # cut and unite every rule's set, then two sums and the product of one
    sugeno = 3 * rules  # a product and two sums for every rule
    return sugeno < mamdani


def _sigma() -> float:
    widths = {round(term.parameters[1] / (v.high - v.low), 6) for v in (*planner().inputs, *planner().outputs)
              for term in v.terms}  # fmt: skip
    return widths.pop() if len(widths) == 1 else float("nan")


_ONE = "1 reading: every rule and set is printed but the operators"

REPRODUCTIONS: tuple[Reproduction, ...] = (
    Reproduction(
        claim="fuzzy-planner:c-ex-v", measure=lambda: _example(0), tolerance=0.0005,
        because="rounding of three decimals", free="centres of the sets 0, 0.5, 1; min, max, centroid (not printed)",
        holds_for=_ONE,
    ),
    Reproduction(
        claim="fuzzy-planner:c-ex-w", measure=lambda: _example(1), tolerance=0.05,
        because="rounding of one decimal", free="output sets scaled by 90 deg/s; min, max, centroid (not printed)",
        holds_for=_ONE,
    ),
    Reproduction(
        claim="fuzzy-planner:c-rules", measure=lambda: len(planner().rules), tolerance=0.0, shows="input",
        because="a count; rule 27 is read as Far where it prints For",
    ),
    Reproduction(
        claim="fuzzy-planner:c-sigma", measure=_sigma, tolerance=0.00005, shows="input",
        because="the width that the shipped rule base has in every set, as part of its range",
    ),
    Reproduction(
        claim="fuzzy-planner:c-vb", measure=lambda: planner().outputs[0].high, tolerance=0.0, shows="input",
        because="the range of the output; the centroid itself stays between 0.149 and 0.851 m/s",
    ),
    Reproduction(
        claim="fuzzy-planner:c-wb", measure=lambda: planner().outputs[1].high, tolerance=0.0, shows="input",
        because="the range of the output; the centroid itself stays between 13.4 and 76.6 deg/s",
    ),
    Reproduction(
        claim="fuzzy-planner:c-mono", measure=_closer_is_slower_and_turns_more, holds_for=_ONE,
        because="omega rises throughout; v falls from 0.851 to 0.797 m/s at D_obs 0.75, rises again to 0.851 at 0.5 "
        "while the obstacle comes nearer, and falls to 0.149 at 0",
    ),
    Reproduction(
        claim="thesis:c-extra-6", measure=_sugeno_is_cheaper, shows="by definition",
        free="cost counted in operations behind the rules' strengths, for a centroid on sampled sets",
        because="27 rules: 81 operations against 5757; how long they take is the engine's affair, and ours takes no "
        "longer for sets than for constants", holds_for="every rule base, by the count",
    ),
)  # fmt: skip
