"""Answers to the exercises of chapter 03: right ones of every form, and wrong ones with the words they hear."""

from dataclasses import replace

import numpy as np
import sympy

from fuzzynav.fuzzy import Rule
from fuzzynav.fuzzy.defuzzify import centroid
from fuzzynav.studies.fuzzy import SpeedSets

# --- 03.2


def vectorised(x, mu):
    area = np.trapezoid(mu, x)
    return np.trapezoid(x * mu, x) / area if area > 0 else np.nan


def loop(x, mu):
    area = moment = 0.0
    for k in range(len(x) - 1):
        step = x[k + 1] - x[k]
        area += step * (mu[k] + mu[k + 1]) / 2
        moment += step * (x[k] * mu[k] + x[k + 1] * mu[k + 1]) / 2
    return moment / area if area else float("nan")


def from_trapezoids(x, mu):
    """Area and moment of each trapezoid, exactly."""
    return centroid(x, mu, "exact")


def by_sympy(x, mu):
    value = vectorised(x, mu)
    return sympy.nan if np.isnan(value) else sympy.Float(float(value))


def simpson(x, mu):
    from scipy.integrate import simpson

    return simpson(x * mu, x=x) / simpson(mu, x=x) if mu.max() > 0 else np.nan


def guarded(rule):
    return lambda x, mu: rule(x, mu) if mu.max() > 0 else np.nan


# --- 03.3


def joined(join):
    """A dict of all strengths by conclusion, joined."""

    def answer(firing, conclusions):
        groups = {}
        for f, c in zip(firing, conclusions):
            groups.setdefault(c, []).append(f)
        return {c: join(g) for c, g in groups.items()}

    return answer


def as_array(firing, conclusions):
    names = np.array(conclusions)
    return {str(name): np.array([firing[names == name].max()]) for name in np.unique(names)}


# --- 03.5

THEN = {
    "Close": "alpha is Low and beta is High and gamma is Low",
    "Medium": "alpha is Medium and beta is Low and gamma is Medium",
    "Far": "alpha is High and beta is Low and gamma is High",
}
PRINTED = [("Little", "Slow"), ("More", "Normal"), ("Lots", "Fast")]


def rules(then=THEN, skip=PRINTED):
    return [
        f"if headGoal is {h} and distObs is {d} and velRob is {v} then {what}"
        for d, what in then.items()
        for h in ("Little", "More", "Lots")
        for v in ("Slow", "Normal", "Fast")
        if (h, v) not in skip
    ]


ALL = rules()

RIGHT = {
    "03.1": {
        "a tuple": (0.75, 0.25, 0, 2 / 3),
        "a rounded list": [0.75, 0.25, 0.0, 0.67],
        "a column": np.array([[0.75], [0.25], [0.0], [0.666]]),
        "sympy": sympy.Matrix([sympy.Rational(3, 4), sympy.Rational(1, 4), 0, sympy.Rational(2, 3)]),
    },
    "03.2": {
        "vectorised": vectorised,
        "a loop": loop,
        "exact trapezoids": from_trapezoids,
        "an array of one": lambda x, mu: np.array([vectorised(x, mu)]),
        "sympy": by_sympy,
    },
    "03.3": {
        "joined by max": joined(max),
        "arrays of one": as_array,
        "sympy": joined(lambda g: sympy.Max(*g)),
        "ints kept as dict of floats": joined(lambda g: float(sorted(g)[-1])),
    },
    "03.4": {
        "near and medium": replace(SpeedSets(), near_end=2.5, medium_left=0.8),
        "ints": replace(SpeedSets(), near_end=3, medium_left=1),
        "slow and wide": SpeedSets(near_end=2.5, medium_left=0.7, slow_end=0.25),
    },
    "03.5": {
        "a list": ALL,
        "a tuple": tuple(ALL),
        "rule objects": [Rule.parse(text) for text in ALL],
        "an array of texts": np.array(ALL),
        "capitals": [t.replace("if ", "IF ").replace(" then ", " THEN ") for t in ALL],
    },
}

WRONG = {
    "03.1": {
        "the product": ((0.75, 0.25 / 3, 0, 2 / 3), "not their product"),
        "OR": ((0.75, 1 / 3, 1 / 3, 2 / 3), "the greater membership would be OR"),
        "the error swapped": ((0.75, 0.25, 0, 1 / 3), "Small and Large are swapped"),
        "Near turned round": ((0.25, 0.25, 0, 2 / 3), "most of it is left"),
        "Far from 0": ((0.75, 0.25, 0.125, 2 / 3), "nothing is far"),
        "rule 1": ((0.5, 0.25, 0, 2 / 3), "Rule 1 does not fire with 0.50"),
        "rule 2": ((0.75, 0.5, 0, 2 / 3), "Rule 2 does not fire with 0.50"),
        "rule 3": ((0.75, 0.25, 0.5, 2 / 3), "Rule 3 does not fire with 0.50"),
        "rule 4": ((0.75, 0.25, 0, 0.6), "Rule 4 does not fire with 0.60"),
        "percent": ((75, 25, 0, 67), "0.75 for 75 %"),
        "the sign": ((0.75, 0.25, -0.5, 0.67), "never negative"),
        "nan": ((0.75, 0.25, 0, np.nan), "yours is nan"),
        "three": ((0.75, 0.25, 0.67), "yours holds three"),
    },
    "03.2": {
        "plain sums": (guarded(lambda x, mu: (x * mu).sum() / mu.sum()), "Plain sums"),
        "x left out": (guarded(lambda x, mu: np.trapezoid(x * mu) / np.trapezoid(mu)), "all samples as equally far"),
        "the moment": (guarded(lambda x, mu: np.trapezoid(x * mu, x)), "This is the moment"),
        "the area": (guarded(lambda x, mu: np.trapezoid(mu, x)), "This is the area"),
        "the peak": (guarded(lambda x, mu: x[np.argmax(mu)]), "the greatest degree"),
        "the mean": (guarded(lambda x, mu: x.mean()), "the mean of the samples"),
        "Simpson's rule": (simpson, "A set from"),
        "a constant in the middle": (
            lambda x, mu: vectorised(x, mu) + (0.1 if abs(x[0]) < 1e-9 and mu.max() > 0 else 0.0),
            "symmetric about 0.5 m/s",
        ),
        "0 for the empty set": (lambda x, mu: vectorised(x, mu) if mu.max() > 0 else 0.0, "nothing to balance"),
        "None for the empty set": (
            lambda x, mu: vectorised(x, mu) if mu.max() > 0 else None,
            "The centroid of the empty set should be one number, not None",
        ),
        "always nan": (lambda x, mu: np.nan, "nan for a set that is not empty"),
        "the samples": (lambda x, mu: x * mu, "should be one number; yours holds"),
    },
    "03.3": {
        "the last wins": (lambda firing, conclusions: dict(zip(conclusions, firing)), "The last rule wins"),
        "the first wins": (joined(lambda g: g[0]), "The first rule wins"),
        "the weakest": (joined(min), "The weakest rule wins"),
        "the sum": (joined(sum), "would become certain"),
        "the capped sum": (joined(lambda g: min(sum(g), 1.0)), "without adding"),
        "the mean": (joined(np.mean), "takes the mean"),
        "like chances": (joined(lambda g: 1 - np.prod(1 - np.array(g))), "joins like chances"),
        "the product": (joined(np.prod), "the clip is at"),
        "a list": (lambda firing, conclusions: list(zip(conclusions, firing)), "not a list"),
        "only one": (lambda firing, conclusions: {conclusions[0]: max(firing)}, "is missing in your dict"),
        "all strengths": (joined(list), "should be one number; yours"),
    },
    "03.4": {
        "as it was": (SpeedSets(), "m to stop"),
        "crawling": (replace(SpeedSets(), near_end=4.0, medium_left=1.9, fast_start=0.0), "crawls at"),
        "a wide gap": (
            replace(SpeedSets(), near_end=2, slow_end=0.1, medium_left=2.5, medium_peak=2.7, far_start=3),
            "At 2.000 m no rule fires",
        ),
        "a gap of a centimetre": (
            replace(SpeedSets(), near_end=2, slow_end=0.1, medium_left=0.5, medium_right=3.005, far_start=3.015),
            "At 3.005 m no rule fires",
        ),
        "a gap close by": (
            replace(SpeedSets(), near_end=0.1, medium_left=0.2, middle_peak=0.1, middle_right=0.2, far_start=0.5,
                    fast_start=0.2),
            "At 0.100 m no rule fires",
        ),
        "a dict": ({"near_end": 2.5}, "give such sets"),
    },
    "03.5": {
        "one missing": (ALL[:-1], "One combination is still without a rule"),
        "half": (ALL[:9], "9 combinations are still"),
        "none": ([], "The list is empty"),
        "no gamma": ([t.rpartition(" and ")[0] for t in ALL], "says anything about gamma"),
        "any": (
            ["if distObs is Close then alpha is Low and beta is High and gamma is Low",
             "if distObs is Medium then alpha is Medium and beta is Low and gamma is High",
             "if distObs is Far then alpha is High and beta is Low and gamma is High"],
            "alone should speak",
        ),
        "into the obstacle": (
            rules({**THEN, "Close": "alpha is High and beta is Low and gamma is Low"}),
            "drive into it",
        ),
        "a typing error": ([*ALL[:-1], ALL[-1].replace("Far", "Fare")], "A rule cannot be used"),
        "one text": ("\n".join(ALL), "Give a list of rules"),
    },
}  # fmt: skip
