"""Answers to the exercises of chapter 01: right ones of every form, and wrong ones with the words they hear."""

from dataclasses import replace

import numpy as np
import sympy

from fuzzynav import robot


def pose_of(travel_right, travel_left, track, pose, share=0.5):
    """The mid-point rule, or the rule of the old (share 0) or the new heading (share 1)."""
    advance, turn = (travel_right + travel_left) / 2, (travel_right - travel_left) / track
    at = pose[2] + share * turn
    return pose[0] + advance * np.cos(at), pose[1] + advance * np.sin(at), pose[2] + turn


def ticks(way=2 * np.pi, wide=1.0, share=0.5, factor=1.0, swap=False):
    """An answer to 01.1 with one mistake in it, or none."""

    def answer(pose, right, left, n, radius, track):
        if swap:
            right, left = left, right
        told = pose_of(way * radius * right / n, way * radius * left / n, wide * track, pose, share)
        return pose[0] + factor * (told[0] - pose[0]), pose[1] + factor * (told[1] - pose[1]), told[2]

    return answer


def arc(pose, right, left, n, radius, track):
    a, b = (2 * np.pi * radius * k / n for k in (right, left))
    advance, turn = (a + b) / 2, (a - b) / track
    return np.array([[v] for v in robot.move(pose, [advance, turn], 1.0)])  # a column


def in_place(pose, right, left, n, radius, track):
    pose[:] = pose_of(2 * np.pi * radius * right / n, 2 * np.pi * radius * left / n, track, pose)
    return pose


def rounded(pose, right, left, n, radius, track):
    return [round(float(v), 6) for v in ticks()(pose, right, left, n, radius, track)]


def by_sympy(pose, right, left, n, radius, track):
    a, b = (2 * sympy.pi * radius * int(k) / n for k in (right, left))
    at = float(pose[2]) + (a - b) / track / 2
    x, y = float(pose[0]) + (a + b) / 2 * sympy.cos(at), float(pose[1]) + (a + b) / 2 * sympy.sin(at)
    return sympy.Matrix([x, y, float(pose[2]) + (a - b) / track])


def from_the_origin(pose, right, left, n, radius, track):
    x, y, heading = ticks()(pose, right, left, n, radius, track)
    return x - pose[0], y - pose[1], heading


def heading_zero(pose, right, left, n, radius, track):
    return ticks()((pose[0], pose[1], 0.0), right, left, n, radius, track)


def degrees(pose, right, left, n, radius, track):
    x, y, heading = ticks()(pose, right, left, n, radius, track)
    return x, y, pose[2] + np.rad2deg(heading - pose[2])


def unturned(pose, right, left, n, radius, track):
    x, y, heading = ticks()((0, 0, 0), right, left, n, radius, track)
    return pose[0] + x, pose[1] + y, pose[2] + heading


def calibrated(line, distance, spin, angle, n):
    radius = distance * n / (2 * np.pi * np.mean(line))
    return radius, radius * 2 * np.pi * (spin[0] - spin[1]) / n / angle


def by_loop(line, distance, spin, angle, n):
    total = 0
    for k in line:
        total += abs(k)
    radius, rolled = 2 * distance * n / (2 * np.pi * total), 0
    for k in spin:
        rolled += abs(k) * 2 * np.pi * radius / n
    return [[radius], [rolled / angle]]


def by_equations(line, distance, spin, angle, n):
    r, t = sympy.symbols("r t", positive=True)
    way = sympy.Rational(int(line[0]) + int(line[1]), 2) * 2 * sympy.pi * r / n - distance
    turn = (int(spin[0]) - int(spin[1])) * 2 * sympy.pi * r / n - angle * t
    found = sympy.solve([way, turn], [r, t])
    return sympy.N(found[r]), sympy.N(found[t])


def sizes(radius=1.0, track=1.0):
    return lambda *given: tuple(np.array(calibrated(*given)) * [radius, track])


def one_counter(which, run):
    def answer(line, distance, spin, angle, n):
        if run == "line":
            line = (line[which], line[which])
            return distance * n / (2 * np.pi * line[0]), calibrated(line, distance, spin, angle, n)[1]
        radius = calibrated(line, distance, spin, angle, n)[0]
        return radius, radius * 2 * np.pi * 2 * abs(spin[which]) / n / angle

    return answer


RIGHT = {
    "01.1": {
        "the mid-point rule, a tuple": ticks(),
        "the exact arc, a column": arc,
        "changed in place": in_place,
        "a list, rounded to six digits": rounded,
        "sympy": by_sympy,
    },
    "01.2": {
        "a number": lambda right, left, radius, track: radius * (right - left) / track,
        "an array of one": lambda right, left, radius, track: np.array([radius / track * (right - left)]),
        "the package": lambda right, left, radius, track: robot.body_speeds(
            [right, left], replace(robot.TURTLEBOT2, wheel_radius=radius, track=track)
        )[1],
        "sympy": lambda right, left, radius, track: sympy.Float(radius) * (right - left) / track,
    },
    "01.3": {
        "a tuple": calibrated,
        "a loop, a column": by_loop,
        "sympy": by_equations,
        "an array": lambda *given: np.array(calibrated(*given)),
    },
    "01.4": {"an int": 548, "a float": 548.0, "a list": [548], "numpy": np.int64(548), "sympy": sympy.Integer(548)},
    "01.5": {
        "rounded": 0.12,
        "the lower end": sympy.Rational(16, 140),
        "the upper end, a list": [160 * 0.6 / 700],
        "numpy": np.float32(0.125),
    },
}

WRONG = {
    "01.1": {
        "the old heading": (ticks(share=0.0), "taken at the old heading"),
        "the new heading": (ticks(share=1.0), "taken at the new heading"),
        "wheels swapped": (ticks(swap=True), "yours turns to the right"),
        "half the track": (ticks(wide=0.5), "divide by the full track"),
        "twice the track": (ticks(wide=2.0), "not by twice the track"),
        "no 2 pi": (ticks(way=1.0), "not the radius"),
        "the diameter for the radius, halved": (ticks(way=np.pi), "yours rolls pi times"),
        "the sum of both travels": (ticks(factor=2.0), "the advance is their mean"),
        "degrees": (degrees, "yours is in degrees"),
        "the motion only": (from_the_origin, "it begins at (0, 0)"),
        "heading 0": (heading_zero, "yours begins at heading 0"),
        "a motion in the robot's frame": (unturned, "at the heading half-way"),
        "the difference for the mean": (
            lambda pose, right, left, n, radius, track: (pose[0] + right - left, pose[1], pose[2]),
            "the pose is (0.2199, 0, 0)",
        ),
        "the turn over the wheel radius": (
            lambda pose, r, l, n, radius, track: pose_of(*(2 * np.pi * radius * k / n for k in (r, l)), radius, pose),
            "the difference of both travels over the track",
        ),
        "no heading": (lambda pose, *rest: (pose[0], pose[1]), "three numbers; yours holds two"),
        "a text": (lambda *given: "1, 2, 3", "not a text"),
        "nan": (lambda pose, *rest: (np.nan, 0, 0), "yours is nan"),
    },
    "01.2": {
        "as printed": (lambda right, left, radius, track: radius / (2 * track) * (right - left), "twice as much"),
        "the sign": (lambda right, left, radius, track: radius / track * (left - right), "has the other sign"),
        "both": (lambda right, left, radius, track: radius / (2 * track) * (left - right), "and so is the factor"),
        "half the track": (lambda right, left, radius, track: 2 * radius / track * (right - left), "already the full"),
        "no radius": (lambda right, left, radius, track: (right - left) / track, "are no speeds"),
        "no track": (lambda right, left, radius, track: radius * (right - left), "difference of the rim speeds"),
        "the mean": (lambda right, left, radius, track: radius / track * (right + left) / 2, "yours is"),
        "v and omega": (lambda right, left, radius, track: (0.1, 0.2), "one number; yours holds two"),
    },
    "01.3": {
        "swapped": (lambda *given: calibrated(*given)[::-1], "yours are swapped"),
        "the diameter": (sizes(2, 1), "the diameter of the wheels"),
        "the sum on the line": (sizes(0.5, 1), "were added up"),
        "no 2 pi": (sizes(2 * np.pi, 1), "the way in one turn of a wheel"),
        "the right counter of the line": (one_counter(0, "line"), "radius fits the right counter alone"),
        "the left counter of the line": (one_counter(1, "line"), "radius fits the left counter alone"),
        "the right counter of the spin": (one_counter(0, "spin"), "track fits the right counter alone"),
        "the left counter of the spin": (one_counter(1, "spin"), "track fits the left counter alone"),
        "the sign of the spin": (sizes(1, -1), "counts backwards"),
        "half the track": (sizes(1, 0.5), "about the middle"),
        "twice the track": (sizes(1, 2), "half the difference of both counters rolls it"),
        "degrees": (sizes(1, np.pi / 180), "The track should be"),
        "millimetres": (sizes(1000, 1), "The wheel radius should be"),
        "three numbers": (lambda *given: (1, 2, 3), "yours holds three"),
    },
    "01.4": {
        "rounded down": (547, "With 547 ticks"),
        "not whole": (547.8, "yours is 547.8"),
        "one too many": (549, "549 ticks are fine enough"),
        "half the track": (1096, "if the track were half as long"),
        "lines, not ticks": (137, "lines of a quadrature disc"),
        "the wheel for the robot": (3600, "split a turn of the wheel"),
        "the sign": (-548, "at least one tick"),
        "nan": (float("nan"), "yours is nan"),
    },
    "01.5": {
        "just too short": (0.114, "the limit is 4 cm"),
        "too long": (0.15, "the search ends at 160 px"),
        "centimetres": (12.5, "wider than the robot"),
        "the sign": (-0.12, "a positive number"),
        "both ends": ((0.1143, 0.1371), "yours holds two"),
        "a text": ("0.12", "not a text"),
    },
}
