"""Answers to the exercises of chapter 06: right ones of every form, and wrong ones with the words they hear."""

import math

import numpy as np
import sympy

from fuzzynav.fuzzy import Rule

# --- 06.1


def by_loop(v, a, dt):
    way = 0.0
    while v > 1e-12:
        way += v * dt
        v -= a * dt
    return way


def vectorised(v, a, dt):
    return np.maximum(v - a * dt * np.arange(math.ceil(v / (a * dt) - 1e-9)), 0.0).sum() * dt


def by_sympy(v, a, dt):
    x, b, t = sympy.symbols("x b t")
    return (x**2 / (2 * b) + x * t / 2).subs({x: v, b: a, t: dt})


# --- 06.2


def window(low, high, step):
    count = max(math.ceil((high - low) / step), 1)
    speeds = np.linspace(low, high, count + 1)
    return np.union1d(speeds, 0.0) if low < 0 < high else speeds


def window_loop(low, high, step):
    speeds, v = [], low
    while v < high - 1e-12:
        speeds.append(v)
        v += step
    if low < 0 < high:
        speeds.append(0)
    return speeds + [high]


# --- 06.3

IF = "if headGoal is Little and velRob is Fast and distObs is"
CRUISE = [
    f"{IF} Close then alpha is Low and beta is High and gamma is Low",
    f"{IF} Medium then alpha is Medium and beta is Low and gamma is Low",
    f"{IF} Far then alpha is High and beta is Low and gamma is High",
]
BOLD = [
    f"{IF} Close then alpha is High and beta is Low and gamma is High",
    f"{IF} Medium then alpha is Medium and beta is Low and gamma is Low",
    f"{IF} Far then alpha is Low and beta is High and gamma is Low",
]

RIGHT = {
    "06.1": {
        "a loop": by_loop,
        "vectorised": vectorised,
        "the formula": lambda v, a, dt: v * v / (2 * a) + v * dt / 2,
        "an array of one": lambda v, a, dt: np.array([by_loop(v, a, dt)]),
        "sympy": by_sympy,
    },
    "06.2": {
        "linspace": window,
        "a loop, a list, unsorted": window_loop,
        "a column": lambda *given: window(*given)[:, None],
        "a tuple, falling, twice": lambda *given: (*window(*given)[::-1], given[0]),
        "sympy": lambda *given: sympy.Matrix(window(*given)),
    },
    "06.3": {
        "a list": CRUISE,
        "a tuple": tuple(CRUISE),
        "rule objects": [Rule.parse(text) for text in CRUISE],
        "without the heading": [t.replace("headGoal is Little and ", "") for t in CRUISE],
    },
    "06.4": {
        "a tuple": (0.2, 0.4, 0.4),
        "ints, a list": [1, 2, 2],
        "a column": np.array([[0.2], [0.4], [0.4]]),
        "sympy": sympy.Matrix([sympy.Rational(1, 5), sympy.Rational(2, 5), sympy.Rational(2, 5)]),
    },
    "06.5": {
        "the root": (-0.05 + math.sqrt(0.05**2 + 4 * 2.5 * 0.8)) / 5,
        "rounded to the safe side": 0.55,
        "three digits": np.float64(0.555),
        "sympy": (-sympy.Rational(1, 20) + sympy.sqrt(sympy.Rational(1, 400) + 8)) / 5,
        "a list": [0.5557],
    },
}

WRONG = {
    "06.1": {
        "no reaction": (lambda v, a, dt: v * v / (2 * a), "v^2/2a forgets"),
        "a whole step": (lambda v, a, dt: v * v / (2 * a) + v * dt, "v dt whole is too much"),
        "braking at once": (lambda v, a, dt: v * v / (2 * a) - v * dt / 2, "brakes in the very first step"),
        "one step": (lambda v, a, dt: v * dt, "the first step alone"),
        "the time": (lambda v, a, dt: v / a, "in seconds"),
        "full speed": (lambda v, a, dt: v * v / a, "the mean speed is half"),
        "not at rest": (lambda v, a, dt: by_loop(v, a, dt) + v * 0 + dt, "A robot at rest"),
        "twice": (lambda v, a, dt: 2 * by_loop(v, a, dt), "the robot stops after"),
        "never": (lambda v, a, dt: math.inf if v else 0, "yours is infinite"),
        "a list": (lambda v, a, dt: [v, v - a * dt] if v else 0, "yours holds two"),
    },
    "06.2": {
        "as it was": (lambda low, high, step: np.append(low, np.arange(low, high, step)), "never drives its top speed"),
        "nothing": (lambda low, high, step: [], "there is no sample at all"),
        "one step further": (lambda low, high, step: np.append(window(low, high, step), high + step), "lies beyond"),
        "the start a little late": (
            lambda low, high, step: window(low, high, step) if high == low else window(low + step / 2, high, step),
            "cannot brake fully"),
        "below the start": (lambda low, high, step: np.append(window(low, high, step), low - step), "lies below"),
        "no zero": (
            lambda low, high, step: np.linspace(low, high, 2 * math.ceil((high - low) / step) + 2), "standing still"),
        "steps too wide": (lambda low, high, step: window(low, high, 2 * step), "apart; the step is"),
        "a set": (lambda low, high, step: {low, high + 1}, "a set has no order"),
        "nan": (lambda low, high, step: [low, np.nan], "yours is nan"),
    },
    "06.3": {
        "none": ([], "The list is empty"),
        "no rule when far": (CRUISE[:2], "15 m from an obstacle"),
        "no rule when close": (CRUISE[1:], "0 m from an obstacle and 0.8 m/s no rule fires"),
        "no gamma": ([t.rpartition(" and ")[0] for t in CRUISE], "says anything about gamma"),
        "bold when close": (BOLD, "when something is near"),
        "a typing error": ([CRUISE[0].replace("Fast", "Quick"), *CRUISE[1:]], "A rule cannot be used"),
        "one text": (CRUISE[0], "Give a list of rules"),
    },
    "06.4": {
        "as printed": ((0.8, 0.1, 0.1), "the run ends 'stalled'"),
        "too near": ((0.3, 0.3, 0.4), "from a wall; the limit"),
        "too slow": ((0.2, 0.7, 0.1), "steps; the limit"),
        "negative": ((0.5, -0.1, 0.6), "not negative"),
        "zeros": ((0, 0, 0), "All weights are 0"),
        "two": ((0.2, 0.8), "yours holds two"),
        "a dict": ({"alpha": 0.2}, "not a dict"),
    },
    "06.5": {
        "no reaction": (math.sqrt(2 * 0.8 * 0.2), "forgets the step"),
        "rounded up": (0.56, "0.56 m/s cannot stop"),
        "a whole step of reaction": (-0.02 + math.sqrt(0.0004 + 0.32), "With v dt whole"),
        "the other root": ((-0.05 - math.sqrt(0.05**2 + 8)) / 5, "the other root"),
        "there in one step": (8.0, "it does not stop"),
        "no root": (0.16, "is no speed"),
        "careful": (0.5, "0.5 m/s stops with room"),
        "backwards": (-0.1, "is positive"),
        "nan": (float("nan"), "yours is nan"),
    },
}  # fmt: skip
