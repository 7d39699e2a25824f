"""Answers to the exercises of chapter 04: right ones of every form, and wrong ones with the words they hear."""

import math

import numpy as np
import sympy

from fuzzynav import tracking
from fuzzynav.geometry import wrap

c, s = np.cos, np.sin


def by_derivative(theta, v):
    """The matrix from the Jacobian of the velocity."""
    t, w = sympy.symbols("t w")
    velocity = sympy.Matrix([w * sympy.cos(t), w * sympy.sin(t)])
    return velocity.jacobian([w, t]).subs({t: theta, w: v})


def gains(four=4.0, kp=lambda w, d: w**2, kd=lambda w, d: 2 * d * w, damped=True):
    def answer(damping, settling):
        w = four / (damping * settling if damped else settling)
        return kp(w, damping), kd(w, damping)

    return answer


def envelope(damping, settling):
    w = -math.log(0.02 * math.sqrt(1 - damping**2)) / (damping * settling)
    return [w**2, 2 * damping * w]


def across(u, theta):
    return u[1] * c(theta) - u[0] * s(theta)


def seen(pose, wanted, turn=-1):
    """Ahead and left of the reference, turned by minus theta."""
    z = complex(wanted[0] - pose[0], wanted[1] - pose[1]) * np.exp(1j * turn * pose[2])
    return z.real, z.imag


def heading(pose, wanted):
    return float(wrap(wanted[2] - pose[2]))


def error(pose, wanted):
    return (*seen(pose, wanted), heading(pose, wanted))


def by_matrix(pose, wanted):
    turn = np.array([[c(pose[2]), s(pose[2])], [-s(pose[2]), c(pose[2])]])
    gap = turn @ (np.array(wanted[:2]) - pose[:2])
    angle = wanted[2] - pose[2]
    while angle >= math.pi:
        angle -= 2 * math.pi
    while angle < -math.pi:
        angle += 2 * math.pi
    return np.append(gap, angle)[:, None]


RIGHT = {
    "04.1": {
        "lists": lambda theta, v: [[c(theta), -v * s(theta)], [s(theta), v * c(theta)]],
        "a product of arrays": lambda theta, v: (
            np.array([[c(theta), -s(theta)], [s(theta), c(theta)]]) @ np.diag([1, v])
        ),
        "sympy": by_derivative,
        "the package": tracking.decoupling,
    },
    "04.2": {
        "a tuple": gains(),
        "the exact 2 %": gains(math.log(50)),
        "of the envelope, a list": envelope,
        "a column": lambda damping, settling: np.array(gains()(damping, settling))[:, None],
        "sympy": lambda damping, settling: sympy.Matrix(gains()(sympy.Float(damping), sympy.Float(settling))),
    },
    "04.3": {
        "a number": lambda u, theta, most: abs(across(u, theta)) / most,
        "an array of one": lambda u, theta, most: np.array([abs(across(u, theta)) / most]),
        "a cross product": lambda u, theta, most: abs(np.linalg.det([[c(theta), s(theta)], u])) / most,
        "sympy": lambda u, theta, most: sympy.Abs(u[1] * sympy.cos(theta) - u[0] * sympy.sin(theta)) / most,
    },
    "04.4": {
        "complex numbers, a tuple": error,
        "a matrix and loops, a column": by_matrix,
        "sympy": lambda pose, wanted: sympy.Matrix(error(pose, wanted)),
        "the package": tracking.tracking_error,
    },
    "04.5": {
        "floats": (1.0, 25.0, 2.0),
        "ints": (1, 25, 2),
        "a column": np.array([[0.5], [25.0], [2.1]]),
        "another k1": [50, 25, 2],
        "sympy": sympy.Matrix([1, 25, 2]),
    },
}

WRONG = {
    "04.1": {
        "transposed": (lambda t, v: [[c(t), s(t)], [-v * s(t), v * c(t)]], "Rows and columns are swapped"),
        "no v": (lambda t, v: [[c(t), -s(t)], [s(t), c(t)]], "lacks v"),
        "to the right": (lambda t, v: [[c(t), v * s(t)], [s(t), -v * c(t)]], "points to the right"),
        "a sign": (lambda t, v: [[c(t), v * s(t)], [s(t), v * c(t)]], "minus the sine"),
        "columns": (lambda t, v: [[-v * s(t), c(t)], [v * c(t), s(t)]], "The columns are swapped"),
        "v everywhere": (lambda t, v: [[v * c(t), -v * s(t)], [v * s(t), v * c(t)]], "a v too many"),
        "the inverse": (lambda t, v: [[c(t), s(t)], [-s(t) / v, c(t) / v]], "the inverse of F"),
        "degrees": (lambda t, v: [[c(180 * t), -v * s(180 * t)], [s(180 * t), v * c(180 * t)]], "give the accel"),
        "the velocity": (lambda t, v: [v * c(t), v * s(t)], "yours has the shape (2,)"),
    },
    "04.2": {
        "swapped": (lambda *given: gains()(*given)[::-1], "The pair is swapped"),
        "half of kd": (gains(kd=lambda w, d: d * w), "Half of kd is missing"),
        "no square": (gains(kp=lambda w, d: w), "yours is w itself"),
        "no damping in w": (gains(damped=False), "as if damping were 1"),
        "5 %": (gains(3.0), "is the 5 % settling time"),
        "the sign": (gains(kd=lambda w, d: -2 * d * w), "both must be positive"),
        "twice as fast": (gains(8.0), "the poles need the real part"),
        "critically damped": (
            lambda damping, settling: ((4 / settling) ** 2 * 4, 8 / settling), "The damping ratio should be"),
        "one number": (lambda damping, settling: 1.0, "yours holds one"),
    },
    "04.3": {
        "signed": (lambda u, t, most: across(u, t) / most, "negative: take the size"),
        "the other sign": (lambda u, t, most: -across(u, t) / most, "left counts as positive"),
        "along": (lambda u, t, most: abs(u[0] * c(t) + u[1] * s(t)) / most, "The part along the heading"),
        "not turned": (lambda u, t, most: abs(u[1]) / most, "u is given in the world"),
        "all of u": (lambda u, t, most: np.hypot(*u) / most, "not all of u"),
        "multiplied": (lambda u, t, most: abs(across(u, t)) * most, "do not multiply"),
        "on its head": (lambda u, t, most: most / abs(across(u, t)), "stands on its head"),
        "turned the wrong way": (lambda u, t, most: abs(u[1] * c(t) + u[0] * s(t)) / most, "m/s eq 5.2 asks for"),
        "nan": (lambda u, t, most: np.nan, "yours is nan"),
    },
    "04.4": {
        "as it was": (
            lambda p, w: (seen(p, w)[0], s(p[2]) * (w[0] - p[0]) + c(p[2]) * (w[1] - p[1]), w[2] - p[2]),
            "The sign of the sine in the second component",
        ),
        "not wrapped": (lambda p, w: (*seen(p, w), w[2] - p[2]), "wrap it"),
        "not turned": (lambda p, w: (w[0] - p[0], w[1] - p[1], heading(p, w)), "the difference in the world"),
        "turned the other way": (lambda p, w: (*seen(p, w, 1), heading(p, w)), "Yours turns by plus theta"),
        "pose minus wanted": (lambda p, w: tuple(-v for v in error(p, w)), "yours is the other way round"),
        "swapped": (lambda p, w: (*seen(p, w)[::-1], heading(p, w)), "yours are swapped"),
        "the heading's sign": (lambda p, w: (*seen(p, w), -heading(p, w)), "yours has the other sign"),
        "the heading's size": (lambda p, w: (*seen(p, w), abs(heading(p, w))), "has lost its sign"),
        "degrees": (lambda p, w: (*seen(p, w), np.rad2deg(heading(p, w))), "yours is in degrees"),
        "modulo pi": (lambda p, w: (*seen(p, w), (w[2] - p[2]) % np.pi), "From heading"),
        "the reference's view": (lambda p, w: (*seen((p[0], p[1], w[2]), w), heading(p, w)), "m ahead and"),
        "two": (lambda p, w: seen(p, w), "yours holds two"),
    },
    "04.5": {
        "too little damping": ((1, 25, 1), "the limit is 3 mm"),
        "too slow": ((1, 9, 2.0), "the limit is 6 s"),
        "too strong": ((1, 100, 5), "the limit is 0.6"),
        "a zero": ((1, 25, 0), "must be positive"),
        "two": ((25, 2), "yours holds two"),
        "nan": ((1, 25, np.nan), "yours is nan"),
        "a dict": ({"k1": 1, "k2": 25, "k3": 2}, "not a dict"),
    },
}  # fmt: skip
