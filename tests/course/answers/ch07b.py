"""Answers to the exercises of chapter 07b: right ones of every form, and wrong ones with the words they hear."""

from fractions import Fraction
from itertools import permutations

import numpy as np
import sympy
from scipy.optimize import linear_sum_assignment

# --- 07b.1


def terms(away, bound, brake, dt, gain):
    """What the separation needs without v, with v, and with v^2."""
    more = gain / brake + 1
    return more * (gain * dt**2 / 2 + dt * bound) - away, bound / brake + more * dt, 1 / (2 * brake)


def root(need, bend, brake):
    return max(brake * (np.sqrt(bend**2 + 2 * need / brake) - bend), 0.0) if need > 0 else 0.0


def by_formula(away, bound, brake, dt, gain):
    c, b, _ = terms(away, bound, brake, dt, gain)
    return root(-c, b, brake)


def by_halves(away, bound, brake, dt, gain):
    """Bisection on the motion itself: a period at full gain, then braking, and a walker who comes all the time."""
    low, high = 0.0, 50.0
    for _ in range(80):
        v = (low + high) / 2
        fast = v + gain * dt
        need = v * dt + gain * dt**2 / 2 + fast**2 / (2 * brake) + bound * (dt + fast / brake)
        low, high = (v, high) if need <= away else (low, v)
    return low


def by_roots(*given):
    c, b, a = terms(*given)
    return max(0.0, *np.roots([a, b, c]).real)


def by_sympy(*given):
    v = sympy.symbols("v", real=True)
    c, b, a = (sympy.Float(float(t), 30) for t in terms(*given))
    return max([0, *sympy.Poly(a * v**2 + b * v + c, v).nroots()], key=lambda r: r.as_real_imag()[0] if r != 0 else 0)


def quadratic(sign, *given):
    c, b, a = terms(*given)
    return (-b + sign * np.sqrt(max(b * b - 4 * a * c, 0.0))) / (2 * a)


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
        "the formula": by_formula,
        "bisection of the motion": by_halves,
        "an array of one": lambda *given: np.array([by_formula(*given)]),
        "numpy's roots": by_roots,
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
        "below zero": (lambda *given: quadratic(1.0, *given), "there the answer is 0"),
        "the other root": (lambda *given: quadratic(-1.0, *given), "is below 0."),
        "a walker who stands": (lambda d, bound, b, dt, gain: np.sqrt(2 * b * d), "V is missing"),
        "no period": (lambda d, bound, b, dt, gain: root(d, bound / b, b), "the period is missing"),
        "no factor": (
            lambda d, bound, b, dt, gain: root(d - gain * dt**2 / 2 - dt * bound, bound / b + dt, b),
            "the factor A/b + 1",
        ),
        "walker rests while it brakes": (
            lambda d, bound, b, dt, gain: root(-terms(d, bound, b, dt, gain)[0], (gain / b + 1) * dt, b),
            "a walker goes on at V",
        ),
        "walker rests in the period": (
            lambda d, bound, b, dt, gain: root(
                d - (gain / b + 1) * gain * dt**2 / 2, terms(d, bound, b, dt, gain)[1], b
            ),
            "V belongs to it",
        ),
        "the separation": (lambda d, bound, b, dt, gain: sum(terms(0.0, bound, b, dt, gain)), "s(v) = d at"),
        "three parts": (terms, "yours holds three"),
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
