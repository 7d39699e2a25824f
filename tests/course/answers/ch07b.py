"""Answers to the exercises of chapter 07b: right ones of every form, and wrong ones with the words they hear."""

from fractions import Fraction
from itertools import permutations

import numpy as np
import sympy
from scipy.optimize import linear_sum_assignment

# --- 07b.1


def parts(v, bound, brake, dt, gain):
    """The way to a stop, what the walker walks meanwhile, and one period."""
    return v**2 / (2 * brake), bound * v / brake, (gain / brake + 1) * (gain * dt**2 / 2 + dt * (v + bound))


def by_motion(v, bound, brake, dt, gain):
    """Drive a period at full gain, then brake to a stop: both ways and both times, added up."""
    fast = v + gain * dt
    way = v * dt + gain * dt**2 / 2 + fast**2 / (2 * brake)
    return way + bound * (dt + fast / brake)


def by_sympy(*given):
    v, bound, brake, dt, gain = sympy.symbols("v V b e A", positive=True)
    whole = v**2 / (2 * brake) + bound * v / brake + (gain / brake + 1) * (gain / 2 * dt**2 + dt * (v + bound))
    return whole.subs(dict(zip((v, bound, brake, dt, gain), given, strict=True)))


# --- 07b.5


def by_trying(cost):
    n = len(cost)
    return min(permutations(range(n)), key=lambda p: sum(cost[i, p[i]] for i in range(n)))


def by_matrix(cost):
    rows, columns = linear_sum_assignment(cost)
    return columns[np.argsort(rows)]


def by_recursion(cost, row=0, taken=()):
    if row == len(cost):
        return []
    ways = [[j, *by_recursion(cost, row + 1, (*taken, j))] for j in range(len(cost)) if j not in taken]
    return min(ways, key=lambda w: sum(cost[row + i, j] for i, j in enumerate(w)))


def greedy(cost):
    left, out = set(range(len(cost))), []
    for row in cost:
        out.append(min(left, key=lambda j: row[j]))
        left.remove(out[-1])
    return out


def cheapest_first(cost):
    cost, out = cost.astype(float), [0] * len(cost)
    for _ in out:
        i, j = np.unravel_index(np.argmin(cost), cost.shape)
        out[i] = int(j)
        cost[i], cost[:, j] = np.inf, np.inf
    return out


def dearest(cost):
    return linear_sum_assignment(cost, maximize=True)[1]


RIGHT = {
    "07b.1": {
        "the sum": lambda *given: sum(parts(*given)),
        "by motion": by_motion,
        "an array of one": lambda *given: np.array([sum(parts(*given))]),
        "sympy": by_sympy,
    },
    "07b.2": {
        "a number": 0.6,
        "a fraction": Fraction(3, 5),
        "an array": np.array([0.2 * 3]),
        "sympy": sympy.Rational(1, 5) * 3,
    },
    "07b.3": {
        "a tuple": (True, False, True, False),
        "a list of 1 and 0": [1, 0, 1, 0],
        "an array": np.array([True, False, True, False]),
    },
    "07b.4": {
        "a tuple": (3.6, 5.1, 2.9, 6.0, 0.4),
        "a list": [2.4, 2.8, 3.9, 5.9, 0.5],
        "an array": np.array([3.6, 4.5, 3.5, 6.3, 0.4]),
    },
    "07b.5": {
        "all pairings": by_trying,
        "SciPy": by_matrix,
        "recursion": by_recursion,
        "a column": lambda cost: np.array(by_trying(cost))[:, None],
    },
}

WRONG = {
    "07b.1": {
        "no period": (lambda *given: sum(parts(*given)[:2]), "the last term is missing"),
        "no walker": (lambda *given: parts(*given)[0] + parts(*given)[2], "that way is missing"),
        "no stop": (lambda *given: sum(parts(*given)[1:]), "v²/2b, is missing"),
        "twice the stop": (lambda *given: sum(parts(*given)) + parts(*given)[0], "half of v²/b"),
        "walker for a period": (
            lambda v, bound, brake, dt, gain: sum(parts(v, bound, brake, dt, gain)) - bound * v / brake + bound * dt,
            "not for one period only",
        ),
        "no factor": (
            lambda v, bound, b, dt, gain: v**2 / (2 * b) + bound * v / b + gain * dt**2 / 2 + dt * (v + bound),
            "the factor A/b + 1",
        ),
        "walker rests": (
            lambda v, bound, b, dt, gain: v**2 / (2 * b) + bound * v / b + (gain / b + 1) * (gain * dt**2 / 2 + dt * v),
            "v + V, not v",
        ),
        "one percent": (lambda *given: 1.01 * sum(parts(*given)), "the separation is"),
        "three parts": (parts, "yours holds three"),
    },
    "07b.2": {
        "the top speed": (1.0, "two more than the prediction"),
        "time over deceleration": (15.0, "not time over"),
        "the mean": (0.3, "the mean speed"),
        "by the way": (np.sqrt(1.2), "time and way"),
        "a way": (0.9, "is a way"),
        "another": (0.5, "that loses 0.2 m/s"),
        "a text": ("0.6 m/s", "not a text"),
    },
    "07b.3": {
        "moving": ((False, False, True, False), "sentence 1"),
        "never": ((True, True, True, False), "sentence 2"),
        "courtesy": ((True, False, False, False), "sentence 3"),
        "brakes": ((True, False, True, True), "sentence 4"),
        "three": ((True, False, True), "want four answers"),
        "words": (("yes", "no", "yes", "no"), "not a text"),
    },
    "07b.4": {
        "too fast": ((2.1, 3.1, 2.6, 5.1, 0.9), "nobody is faster"),
        "a point": ((3.0, 5.0, 3.0, 5.1, 0.3), "nearly one"),
        "through the pocket": ((5.5, 6.5, 5.5, 4.0, 0.3), "walks through a wall"),
        "at the start": ((1.5, 3.0, 1.5, 5.0, 0.3), "Keep 1 m away"),
        "out of the way": ((10.5, 7.0, 11.3, 7.0, 0.3), "this run ends as"),
        "four": ((2.1, 3.1, 2.6, 5.1), "yours holds four"),
    },
    "07b.5": {
        "each the cheapest": (lambda cost: cost.argmin(axis=1), "each column once"),
        "asked in reverse": (lambda cost: cost.argmin(axis=0), "asks each cluster"),
        "row by row": (greedy, "what the second needs more"),
        "cheapest first": (cheapest_first, "a dear one for the end"),
        "the dearest": (dearest, "the dearest pairing"),
        "rows": (lambda cost: np.argsort(by_trying(cost)), "a row for each column"),
        "in order": (lambda cost: range(len(cost)), "there is a pairing"),
        "all the first": (lambda cost: [0] * len(cost), "one cluster to two tracks"),
        "from 1": (lambda cost: np.array(by_trying(cost)) + 1, "Columns count from 0"),
    },
}
