"""Answers to the exercises of chapter 08: right ones of every form, and wrong ones with the words they hear."""

from fractions import Fraction

import numpy as np
import sympy

# --- 08.2


def by_solve(pull, push):
    f = sympy.Symbol("f")
    return sympy.solveset((1 - f) * pull + f * push, f, domain=sympy.S.Reals)


# --- 08.4


def wait(k, place, curve, most):
    part = curve[k : k + most + 1]
    return k + int(np.argmin(np.hypot(part[:, 0] - place[0], part[:, 1] - place[1])))


def wait_loop(k, place, curve, most):
    best, found = float("inf"), k
    for j in range(k, min(k + most, len(curve) - 1) + 1):
        gap = (curve[j][0] - place[0]) ** 2 + (curve[j][1] - place[1]) ** 2
        if gap < best:
            best, found = gap, j
    return found


def nearest(curve, place):
    return int(np.argmin(np.hypot(*(curve - place).T)))


def back_and_on(k, place, curve, most):
    low = max(k - most, 0)
    return low + nearest(curve[low : k + most + 1], place)


# --- 08.5


def speed(free, f, cruise, creep, brake):
    return min((1 - f) * cruise + f * creep, np.sqrt(2 * brake * free))


def careful(free, f, cruise, creep, brake, dt=0.1):
    """One step of reaction before the brakes: -b dt + sqrt((b dt)^2 + 2 b free)."""
    return min((1 - f) * cruise + f * creep, -brake * dt + np.sqrt((brake * dt) ** 2 + 2 * brake * free))


def limit(free, brake):
    return np.sqrt(2 * brake * free)


RIGHT = {
    "08.1": {
        "fractions": (Fraction(1, 6), Fraction(5, 6)),
        "rounded, a list": [0.167, 0.833],
        "a column": np.array([[1 / 6], [5 / 6]]),
        "sympy": (sympy.Rational(1, 6), sympy.Rational(5, 6)),
    },
    "08.2": {
        "a number": lambda pull, push: -pull / (push - pull),
        "with sizes": lambda pull, push: abs(pull) / (abs(pull) + abs(push)),
        "an array of one": lambda pull, push: np.array([pull / (pull - push)]),
        "sympy, a set of one": by_solve,
        "a linear system": lambda pull, push: np.linalg.solve([[push - pull]], [[-pull]]),
    },
    "08.3": {
        "a sentence": lambda was, d, enter, leave: d < enter or (was and d <= leave),
        "where, an array": lambda was, d, enter, leave: np.where(was, d <= leave, d < enter),
        "1 and 0": lambda was, d, enter, leave: int(d < (leave if was else enter)),
        "numpy": lambda was, d, enter, leave: np.bool_(d < enter) | (np.bool_(was) & np.bool_(d <= leave)),
        "sympy": lambda was, d, enter, leave: sympy.Or(d < enter, sympy.And(was, d <= leave)),
    },
    "08.4": {
        "a slice": wait,
        "a loop": wait_loop,
        "a float": lambda *given: float(wait(*given)),
        "an array of one": lambda *given: np.array([wait(*given)]),
    },
    "08.5": {
        "the smaller": speed,
        "an array of one": lambda *given: np.array([speed(*given)]),
        "with a step of reaction": careful,
        "sympy": lambda free, f, cruise, creep, brake: sympy.Min(
            cruise + f * (creep - cruise), sympy.sqrt(2 * brake * free)
        ),
    },
}

WRONG = {
    "08.1": {
        "the edges": ((0, 1), "F reaches neither 0 nor 1"),
        "swapped": ((5 / 6, 1 / 6), "yours are swapped"),
        "the middle": ((0.25, 0.75), "of a rectangle"),
        "from the far end": ((1 / 3, 2 / 3), "not from the far end"),
        "the floor": ((0.1, 5 / 6), "(0, 0, 0.5) of Little"),
        "the ceiling": ((1 / 6, 0.9), "(0.5, 1, 1) of Lots"),
        "texts": (("1/6", "5/6"), "not a text"),
        "one": (1 / 6, "yours holds one"),
    },
    "08.2": {
        "the share of tracking": (lambda pull, push: push / (push - pull), "the share of tracking"),
        "the sign": (lambda pull, push: pull / (push - pull), "A weight is not negative"),
        "the ratio": (lambda pull, push: -pull / push, "the ratio of both rates"),
        "the sum": (lambda pull, push: -pull / (push + pull), "the sum of both sizes"),
        "half": (lambda pull, push: 0.5, "Half and half"),
        "the square": (lambda pull, push: (pull / (push - pull)) ** 2, "leave a turn of"),
        "the turn": (lambda pull, push: (pull, push), "yours holds two"),
    },
    "08.3": {
        "no memory": (lambda was, d, enter, leave: d < enter, "Yours has no memory"),
        "leave only": (lambda was, d, enter, leave: d <= leave, "Yours opens below leave"),
        "inverted": (lambda was, d, enter, leave: not (d < enter or (was and d <= leave)), "avoids where it"),
        "never shut": (lambda was, d, enter, leave: was or d < enter, "Yours never shuts"),
        "never changed": (lambda was, d, enter, leave: was, "Yours never changes"),
        "never opened": (lambda was, d, enter, leave: was and d <= leave, "Yours never opens"),
        "margins swapped": (lambda was, d, enter, leave: d < leave if not was else d <= enter, "avoidance must be"),
        "a margin": (lambda was, d, enter, leave: d, "should be True or False"),
    },
    "08.4": {
        "the whole curve": (lambda k, p, curve, most: nearest(curve, p), "may be far ahead"),
        "its answer clipped": (
            lambda k, p, curve, most: int(np.clip(nearest(curve, p), k, min(k + most, len(curve) - 1))),
            "clip the search, not its answer"),
        "back, too": (back_and_on, "Yours may go back"),
        "a slice too short": (lambda k, p, curve, most: k + nearest(curve[k : k + most], p), "A slice ends before"),
        "counted from k": (lambda k, p, curve, most: nearest(curve[k : k + most + 1], p), "counted from k"),
        "as far as it may": (lambda k, p, curve, most: min(k + most, len(curve) - 1), "the robot would be left behind"),
        "never": (lambda k, p, curve, most: k, "stands still for ever"),
        "one by one": (lambda k, p, curve, most: min(k + 1, len(curve) - 1), "goes on one by one"),
        "along x only": (
            lambda k, p, curve, most: k + int(np.argmin(abs(curve[k : k + most + 1, 0] - p[0]))), "nearest of the ind"),
        "between": (lambda k, p, curve, most: wait(k, p, curve, most) + 0.4, "should be whole"),
        "past the end": (lambda k, p, curve, most: np.argmin([np.hypot(*(curve[k + j] - p)) for j in range(most + 1)]),
                         "it asked for an entry that is not there"),
    },
    "08.5": {
        "no brakes": (lambda free, f, a, b, brake: (1 - f) * a + f * b, "forgets the brakes"),
        "no pace": (lambda free, f, a, b, brake: limit(free, brake), "forgets the pace"),
        "no F": (lambda free, f, a, b, brake: min(a, limit(free, brake)), "F has no effect"),
        "always creeping": (lambda free, f, a, b, brake: min(b, limit(free, brake)), "always creeps"),
        "F turned round": (lambda free, f, a, b, brake: min(f * a + (1 - f) * b, limit(free, brake)), "wrong way"),
        "written in": (lambda free, f, a, b, brake: min(0.2 * (1 - f) + 0.08 * f, limit(free, brake)), "written in"),
        "no 2": (lambda free, f, a, b, brake: min((1 - f) * a + f * b, np.sqrt(brake * free)), "the 2 is missing"),
        "the larger": (lambda free, f, a, b, brake: max((1 - f) * a + f * b, limit(free, brake)), "take the smaller"),
        "the mean": (lambda free, f, a, b, brake: ((1 - f) * a + f * b + limit(free, brake)) / 2, "m from the margin"),
        "half": (lambda *given: 0.5 * speed(*given), "the speed should be"),
        "both": (lambda *given: (0.2, 0.08), "yours holds two"),
    },
}  # fmt: skip
