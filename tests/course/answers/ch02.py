"""Answers to the exercises of chapter 02: right ones of every form, and wrong ones with the words they hear."""

import math

import numpy as np
import sympy

from fuzzynav import geometry
from fuzzynav.localization import particles
from fuzzynav.mapping import occupancy

TURN = 2 * np.pi


def gap(change):
    """An answer to 02.2 whose bearing is a function of the plain difference."""
    return lambda measured, expected: (measured[0] - expected[0], change(measured[1] - expected[1]))


def by_hand(measured, expected):
    z = measured - expected
    while z[1] >= np.pi:
        z[1] -= TURN
    while z[1] < -np.pi:
        z[1] += TURN
    return z


def comb_loop(weights, u):
    n, drawn, k, end = len(weights), [], 0, weights[0]
    for tooth in range(n):
        while (tooth + u) / n > end and k < n - 1:
            k += 1
            end += weights[k]
        drawn.append(k)
    return drawn


def comb(edges=np.cumsum, teeth=lambda n, u: (np.arange(n) + u) / n, last=lambda k, n: np.minimum(k, n - 1)):
    """An answer to 02.3 with one mistake in it, or none."""

    def answer(weights, u):
        n = len(weights)
        return last(np.searchsorted(edges(weights), teeth(n, u)), n)

    return answer


class Fixed:
    """A generator that draws what it is told."""

    def __init__(self, u):
        self.u = u

    def random(self):
        return self.u


def recursive(prior, chances):
    p = prior
    for z in chances:
        p = p * z / (p * z + (1 - p) * (1 - z))
    return p


def odds_of(prior, chances, minus=0.0):
    return np.log(prior / (1 - prior)) + sum(np.log(p / (1 - p)) - minus for p in chances)


def by_sympy(prior, chances):
    odds = sympy.log(sympy.nsimplify(prior) / (1 - sympy.nsimplify(prior)))
    odds += sum(math.log(p / (1 - p)) for p in chances)
    return 1 / (1 + sympy.exp(-sympy.N(odds)))


def product_of_odds(prior, chances):
    with np.errstate(all="ignore"):
        odds = np.prod([prior / (1 - prior), *(np.float64(p) / (1 - p) for p in chances)])
        return odds / (1 + odds)


def chance(odds):
    return (1 + np.tanh(odds / 2)) / 2


RIGHT = {
    "02.1": {
        "small angle": 10 * np.deg2rad(2),
        "tangent": 10 * math.tan(math.radians(2)),
        "rounded": 0.35,
        "sympy": 10 * sympy.sin(sympy.pi / 90),
        "a list": [0.349],
        "numpy": np.float32(0.349),
    },
    "02.2": {
        "wrap": gap(geometry.wrap),
        "arctangent, a list": lambda m, e: [m[0] - e[0], math.atan2(math.sin(m[1] - e[1]), math.cos(m[1] - e[1]))],
        "a loop, in place": by_hand,
        "complex, a column": lambda m, e: np.array([[m[0] - e[0]], [np.angle(np.exp(1j * (m[1] - e[1])))]]),
        "modulo": gap(lambda d: (d + np.pi) % TURN - np.pi),
    },
    "02.3": {
        "searchsorted": comb(),
        "a loop, a list": comb_loop,
        "a column": lambda weights, u: comb()(weights, u)[:, None],
        "shuffled, floats": lambda weights, u: comb()(weights, u)[::-1].astype(float),
        "the package": lambda weights, u: particles.low_variance_resample(weights, Fixed(u)),
    },
    "02.4": {
        "log odds": lambda prior, chances: chance(odds_of(prior, chances)),
        "Bayes, one by one": recursive,
        "an array of one": lambda prior, chances: np.array([recursive(prior, chances)]),
        "sympy": by_sympy,
        "the package": lambda prior, chances: occupancy.probability(
            occupancy.log_odds(prior) + sum(occupancy.log_odds(p) for p in chances)
        ),
    },
    "02.5": {
        "a tuple": (0.8, 0.37),
        "a list": [0.7, 0.35],
        "a column": np.array([[0.8], [0.37]]),
        "sympy": sympy.Matrix([sympy.Rational(4, 5), sympy.Rational(37, 100)]),
    },
}

WRONG = {
    "02.1": {
        "radians": (20.0, "if 2 were radians"),
        "the variance": ((10 * np.deg2rad(2)) ** 2, "the variance in m^2"),
        "the angle": (np.deg2rad(2), "the doubt in the heading; after 10 m"),
        "two sigma": (0.698, "are two standard deviations"),
        "the cosine": (10 * math.cos(math.radians(2)), "how far it comes ahead"),
        "centimetres": (34.9, "in centimetres"),
        "the sign": (-0.349, "never negative"),
        "rounded up": (0.36, "0.36 m is not that"),
        "a text": ("0.349", "not a text"),
    },
    "02.2": {
        "as it was": (lambda m, e: m - e, "yours takes the long way round"),
        "expected minus measured": (lambda m, e: (e[0] - m[0], geometry.wrap(e[1] - m[1])), "yours is expected minus"),
        "the bearing turned round": (
            lambda m, e: (m[0] - e[0], geometry.wrap(e[1] - m[1])),
            "bearing has the wrong sign",
        ),
        "both wrapped": (lambda m, e: geometry.wrap(m - e), "wraps the range too"),
        "sizes of both": (lambda m, e: (abs(m[0] - e[0]), geometry.wrap(m[1] - e[1])), "sign of the range difference"),
        "the size": (gap(lambda d: abs(geometry.wrap(d))), "yours has no sign"),
        "modulo 2 pi": (gap(lambda d: d % TURN), "gives 0 to 2 pi"),
        "modulo pi": (gap(lambda d: d % np.pi), "ahead and behind the same"),
        "always minus 2 pi": (gap(lambda d: d - TURN), "mends one side"),
        "arcsine": (gap(lambda d: np.arcsin(np.sin(d))), "beyond 90 degrees"),
        "cut off at pi": (gap(lambda d: np.clip(d, -np.pi, np.pi)), "The shorter way from"),
        "the sum": (lambda m, e: (m[0] + e[0], 0.0), "The difference of range is"),
        "the bearing only": (lambda m, e: geometry.wrap(m[1] - e[1]), "yours holds one"),
    },
    "02.3": {
        "dice": (lambda w, u: np.random.default_rng(0).choice(len(w), len(w), p=w), "must be drawn"),
        "u not over n": (comb(teeth=lambda n, u: ((np.arange(n) + u) / n + u) % 1), "yours beyond it"),
        "u ignored": (comb(teeth=lambda n, u: (np.arange(n) + 1) / n), "u moves the whole comb"),
        "no sums": (comb(edges=lambda w: w), "add the weights up first"),
        "sorted": (comb(edges=lambda w: np.cumsum(np.sort(w))), "belong to other particles"),
        "the heaviest": (lambda w, u: [int(np.argmax(w))] * len(w), "the cloud dies"),
        "one too high": (lambda w, u: (comb()(w, u) + 1) % len(w), "one too high: the first"),
        "from 1": (lambda w, u: comb()(w, u) + 1, "indices go from 0 to"),
        "each once": (lambda w, u: np.unique(comb()(w, u)), "indices; yours are"),
        "weights": (lambda w, u: w, "Indices should be whole"),
        "no last": (comb(last=lambda k, n: k), "belongs to the last"),
        "half a tooth on": (comb(teeth=lambda n, u: (np.arange(n) + (u + 0.5) % 1) / n), "but not by the comb"),
    },
    "02.4": {
        "the mean": (lambda prior, chances: float(np.mean([prior, *chances, *chances][1:] or prior)), "rise above 0.7"),
        "the product": (lambda prior, chances: float(np.prod(chances)), "two unrelated things"),
        "one of them": (lambda prior, chances: 1 - np.prod(1 - np.array(chances)), "could then never lower"),
        "the prior left out": (lambda prior, chances: chance(odds_of(0.5, chances)), "The prior is left out"),
        "the prior taken off": (
            lambda prior, chances: chance(odds_of(prior, chances, np.log(prior / (1 - prior)))),
            "to somebody who knew nothing",
        ),
        "log odds": (odds_of, "These are log odds"),
        "odds": (lambda prior, chances: np.exp(odds_of(prior, chances)), "These are odds;"),
        "free": (lambda prior, chances: chance(-odds_of(prior, chances)), "the cell is free"),
        "odds multiplied": (product_of_odds, "overflow, and the chance becomes nan"),
        "clipped": (lambda prior, chances: np.clip(chance(odds_of(prior, chances)), 0.0001, 0.9999), "leave no doubt"),
        "the last only": (
            lambda prior, chances: recursive(prior, chances[-1:]) if len(chances) > 2 else recursive(prior, chances),
            "do not lead to",
        ),
        "exp overflows": (
            lambda prior, chances: 1 / (1 + math.exp(odds_of(0.5, [1 - c for c in chances]) - odds_of(prior, []))),
            "it stopped (OverflowError",
        ),
    },
    "02.5": {
        "as in the text": ((0.7, 0.4), "A miss must weigh more"),
        "a miss too strong": ((0.6, 0.37), "A hit must weigh more"),
        "swapped": ((0.37, 0.8), "yours are swapped"),
        "percent": ((80, 37), "write 0.7 for 70 %"),
        "certain": ((0.99, 0.1), "must rise as"),
        "one": (0.8, "yours holds one"),
    },
}
