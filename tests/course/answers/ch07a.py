"""Answers to the exercises of chapter 07a: right ones of every form, and wrong ones with the words they hear."""

from fractions import Fraction

import numpy as np
import sympy

TURN = 1 / 0.35
INSIDE = np.hypot(2.0, 2.0 - TURN)


# --- 07a.2


def by_geometry(d, e, omega):
    """The centre lies at (0, R); the target at d (cos e, sin e) is as far from it: solve for R."""
    x, y = d * np.cos(e), d * np.sin(e)
    return omega * (x * x + y * y) / (2 * y)


def by_sympy(d, e, omega):
    r = sympy.Symbol("r", positive=True)
    return sympy.solve(2 * r * sympy.sin(e) - d, r)[0] * omega


# --- 07a.3


def switch(index, here, points, radius):
    while index < len(points) - 1 and np.hypot(*(points[index] - here)) <= radius:
        index += 1
    return index


def switch_mask(index, here, points, radius):
    far = np.flatnonzero(np.hypot(*(points[index:-1] - here).T) > radius)
    return index + far[0] if len(far) else len(points) - 1


def switch_for(index, here, points, radius):
    for k in range(index, len(points)):
        if (points[k][0] - here[0]) ** 2 + (points[k][1] - here[1]) ** 2 > radius**2:
            return k
    return len(points) - 1


def switch_once(index, here, points, radius):
    near = np.hypot(*(points[index] - here)) <= radius
    return index + 1 if near and index < len(points) - 1 else index


def switch_beyond(index, here, points, radius):
    while index < len(points) and np.hypot(*(points[index] - here)) <= radius:
        index += 1
    return index


def switch_jump(index, here, points, radius):
    near = np.flatnonzero(np.hypot(*(points - here).T) <= radius)
    return min(max(index, near[-1] + 1 if len(near) else 0), len(points) - 1)


# --- 07a.4


def cell(evidence, ended, crossed):
    return min(max(evidence - crossed, 0) + 3 * ended, 9)


def cell_words(evidence, ended, crossed):
    if crossed and evidence > 0:
        evidence = evidence - 1
    if ended:
        evidence = evidence + 3
    return evidence if evidence < 9 else 9


RIGHT = {
    "07a.1": {
        "numbers": (TURN, TURN - INSIDE),
        "rounded, a list": [2.86, 0.68],
        "a column": np.array([[2.857], [0.681]]),
        "fractions and sympy": (
            Fraction(20, 7),
            sympy.Rational(20, 7) - sympy.sqrt(4 + (2 - sympy.Rational(20, 7)) ** 2),
        ),
    },
    "07a.2": {
        "the chord": lambda d, e, omega: omega * d / (2 * np.sin(e)),
        "by coordinates": by_geometry,
        "sympy": by_sympy,
        "an array of one": lambda d, e, omega: np.array([0.5 * omega * d / np.sin(e)]),
    },
    "07a.3": {
        "while": switch,
        "a mask": switch_mask,
        "for": switch_for,
        "a float": lambda *given: float(switch(*given)),
    },
    "07a.4": {
        "min and max": cell,
        "in words": cell_words,
        "clip": lambda n, ended, crossed: np.clip(np.clip(n - int(crossed), 0, 9) + 3 * int(ended), 0, 9),
        "sympy": lambda n, ended, crossed: sympy.Min(sympy.Max(n - crossed, 0) + 3 * ended, 9),
    },
    "07a.5": {
        "a tuple": (5.1, 6.4),
        "a list": [5.0, 6.4],
        "an array": np.array([[5.1], [6.5]]),
    },
}

WRONG = {
    "07a.1": {
        "swapped": ((TURN - INSIDE, TURN), "yours are swapped"),
        "the product": ((0.35, TURN - INSIDE), "0.35 is omega v"),
        "to the centre": ((TURN, INSIDE), "from the centre"),
        "at the start": ((TURN, np.sqrt(8)), "the distance at the start"),
        "beside": ((TURN, TURN - 2), "not straight beside"),
        "zero": ((TURN, 0), "inside the circle, not on it"),
        "another radius": ((5.0, 0.5), "is no circle of radius"),
        "another distance": ((TURN, 1.5), "is never 1.50 m"),
        "one": (TURN, "yours holds one"),
    },
    "07a.2": {
        "radius d": (lambda d, e, omega: omega * d, "a circle of radius d;"),
        "without 2": (lambda d, e, omega: omega * d / np.sin(e), "the 2 is missing"),
        "small angles": (lambda d, e, omega: omega * d / (2 * e), "small angles only"),
        "cosine": (lambda d, e, omega: omega * d / (2 * np.cos(e)), "not the cosine"),
        "tangent": (lambda d, e, omega: omega * d / (2 * np.tan(e)), "forbids to move"),
        "the radius": (lambda d, e, omega: d / (2 * np.sin(e)), "That is the radius;"),
        "over omega": (lambda d, e, omega: d / (2 * np.sin(e) * omega), "not radius over yaw rate"),
        "sine above": (lambda d, e, omega: omega * d * np.sin(e) / 2, "below the line"),
        "one percent": (lambda d, e, omega: 0.99 * omega * d / (2 * np.sin(e)), "the one through a target"),
    },
    "07a.3": {
        "if for while": (switch_once, "go on while so"),
        "beyond": (switch_beyond, "The goal has no next one"),
        "jumps": (switch_jump, "jumps over"),
        "nearest": (lambda k, here, points, r: np.argmin(np.hypot(*(points - here).T)), "may be behind"),
        "never": (lambda k, here, points, r: k, "never goes on"),
        "always": (lambda k, here, points, r: min(k + 1, len(points) - 1), "at every call"),
        "how many": (lambda k, *given: switch(k, *given) - k, "how many are done with"),
        "twice the radius": (lambda k, here, points, r: switch(k, here, points, 2 * r), "the next index is"),
        "half": (lambda k, here, points, r: k + 0.5, "should be whole"),
    },
    "07a.4": {
        "no upper end": (lambda n, a, b: max(n - b, 0) + 3 * a, "Evidence ends at 9"),
        "no lower end": (lambda n, a, b: min(n - b + 3 * a, 9), "owes the next block"),
        "never forgets": (lambda n, a, b: min(n + 3 * a, 9), "Yours never forgets"),
        "one for a hit": (lambda n, a, b: min(max(n - b, 0) + a, 9), "counts 3, not 1"),
        "exchanged": (lambda n, a, b: min(max(n - 3 * b, 0) + a, 9), "3 and 1 exchanged"),
        "erases": (lambda n, a, b: 0 if b and not a else min(n + 3 * a, 9), "must not erase"),
        "full": (lambda n, a, b: 9 if a else max(n - b, 0), "One hit is not full"),
        "ends at 8": (lambda n, a, b: min(max(n - b, 0) + 3 * a, 8), "has 9 afterwards"),
        "half": (lambda n, a, b: 0.5, "should be whole"),
    },
    "07a.5": {
        "outside": ((13.0, 4.0), "sticks in the hall's walls"),
        "at the start": ((1.5, 4.0), "Keep 1 m away"),
        "in the pocket's wall": ((6.7, 4.0), "overlaps the pocket"),
        "out of the way": ((10.0, 1.0), "stops the first only"),
        "one": (5.6, "yours holds one"),
        "a text": ("above the pocket", "not a text"),
    },
}
