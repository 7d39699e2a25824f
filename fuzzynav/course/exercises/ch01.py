"""Exercises of chapter 01: ticks, the factor of two, calibration, resolution and a stereo baseline."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.geometry import wrap
from fuzzynav.robot import TURTLEBOT2, Robot, body_speeds, move, move_midpoint
from fuzzynav.sensors import odometry, wheel_travel
from fuzzynav.sensors.cameras import Stereo, disparity, stereo_sigma

__all__ = ["EXERCISES"]

Function = Callable[..., Any]


def _numbers(value: Any, count: int, what: str) -> np.ndarray:
    """The answer as `count` finite numbers, or a sentence that says what was expected."""
    try:
        found = np.asarray(value, dtype=float).ravel()
    except (TypeError, ValueError):
        raise Wrong(f"{what} should be {count} number{'s' * (count > 1)}, not {type(value).__name__}.") from None
    if found.shape != (count,) or not np.isfinite(found).all():
        raise Wrong(f"{what} should be {count} finite number{'s' * (count > 1)}.")
    return found


def _robots(seed: int, count: int) -> list[Robot]:
    """TurtleBots with other wheels."""
    rng = np.random.default_rng(seed)
    sizes = rng.uniform([0.02, 0.15], [0.12, 0.6], (count, 2))
    return [replace(TURTLEBOT2, wheel_radius=float(r), track=float(t)) for r, t in sizes]


# --- 01.1


def _check_ticks(answer: Function) -> str:
    """Seeded poses and counts against the mid-point rule, or the exact arc."""
    start = np.zeros(3)
    ahead = _numbers(answer(start, 1000, 1000, 1000, 0.035, 0.23), 3, "The pose")
    turn = 2 * np.pi * 0.035
    if abs(ahead[0] - turn) > 1e-9 or abs(ahead[1]) > 1e-9:
        raise Wrong(f"Both wheels of 0.035 m made one turn: the robot is {turn:.4f} m ahead, yours at {ahead[0]:.4f}.")
    left = _numbers(answer(start, 120, 100, 1000, 0.035, 0.23), 3, "The pose")
    if left[2] <= 0:
        raise Wrong("More ticks on the right wheel turn the robot to the left: the heading must grow.")
    rng = np.random.default_rng(11)
    for robot in _robots(11, 6):
        pose, n = np.append(rng.uniform(-2, 2, 2), rng.uniform(-3, 3)), int(rng.integers(200, 3000))
        right_ticks, left_ticks = (int(k) for k in rng.integers(-n // 4, n // 4, 2))
        told = _numbers(answer(pose, right_ticks, left_ticks, n, robot.wheel_radius, robot.track), 3, "The pose")
        _compare_poses(told, pose, odometry([[0, 0], [right_ticks, left_ticks]], robot, n)[0])
    return "Ticks became a motion, and the motion a pose."


def _compare_poses(told: np.ndarray, pose: np.ndarray, motion: np.ndarray) -> None:
    wanted = [rule(pose, motion, 1.0) for rule in (move_midpoint, move)]
    if abs(wrap(told[2] - wanted[0][2])) > 1e-9:
        raise Wrong(
            f"From heading {pose[2]:.3f} the robot turns by {motion[1]:.4f} rad, "
            f"yours by {float(wrap(told[2] - pose[2])):.4f}: check the track and the order of the wheels."
        )
    if min(np.abs(told[:2] - w[:2]).max() for w in wanted) > 1e-9:
        raise Wrong(
            f"From {np.round(pose, 3).tolist()} the robot comes to {np.round(wanted[0][:2], 4).tolist()}, "
            f"yours to {np.round(told[:2], 4).tolist()}: check the heading half-way."
        )


# --- 01.2


def _check_yaw_rate(answer: Function) -> str:
    """Seeded robots: the rims must move as the body does."""
    rng = np.random.default_rng(12)
    for robot in _robots(12, 6):
        right, left = rng.uniform(-10, 10, 2)
        told = _numbers(answer(right, left, robot.wheel_radius, robot.track), 1, "The yaw rate")[0]
        omega = body_speeds([right, left], robot)[1]
        if abs(told - omega / 2) < 1e-9 * abs(omega):
            rims = omega * robot.track
            raise Wrong(
                f"Your robot turns at {told:.3f} rad/s, but its rims differ by {rims:.3f} m/s over a track of "
                f"{robot.track:.3f} m: that is {omega:.3f} rad/s, twice as much."
            )
        if abs(told - omega) > 1e-9 * max(abs(omega), 1.0):
            raise Wrong(
                f"Rates of {right:.2f} and {left:.2f} rad/s with radius {robot.wheel_radius:.3f} m and track "
                f"{robot.track:.3f} m give {omega:.3f} rad/s, yours is {told:.3f}."
            )
    return "The rims of both wheels now move as the body does."


# --- 01.3


def _check_calibrate(answer: Function) -> str:
    """Seeded robots that drove a straight line and spun on the spot."""
    n = 2578
    for robot in _robots(13, 6):
        line = int(5.0 / wheel_travel(1, n, robot.wheel_radius))
        spin = int(10 * np.pi * robot.track / wheel_travel(1, n, robot.wheel_radius))
        told = _numbers(answer((line, line), 5.0, (spin, -spin), 20 * np.pi, n), 2, "Radius and track")
        for name, value, true in zip(("wheel radius", "track"), told, (robot.wheel_radius, robot.track), strict=True):
            if abs(value / true - 1.0) > 2e-3:
                off = 100 * (value / true - 1)
                raise Wrong(f"The {name} should be {true:.4f} m, yours is {value:.4f} m, {off:+.1f} % off.")
    return "The belief about the wheels fits both runs to within a tick."


# --- 01.4


def _check_resolution(answer: Any) -> str:
    """The smallest number of ticks for a tenth of a degree."""
    ticks = _numbers(answer, 1, "The number of ticks")[0]
    if ticks != int(ticks) or ticks < 1:
        raise Wrong("A wheel makes a whole number of ticks a turn.")
    step = np.rad2deg(odometry([[0, 0], [1, 0]], TURTLEBOT2, int(ticks))[0, 1])
    coarser = np.rad2deg(odometry([[0, 0], [1, 0]], TURTLEBOT2, max(int(ticks) - 1, 1))[0, 1])
    if step > 0.1:
        raise Wrong(
            f"With {int(ticks)} ticks a turn one tick of one wheel turns the robot by {step:.4f} deg: "
            "the limit is 0.1 deg."
        )
    if coarser <= 0.1:
        raise Wrong(f"{int(ticks)} ticks are fine enough, but one less would do as well: {coarser:.4f} deg a tick.")
    return f"One tick turns the robot by {step:.4f} deg."


# --- 01.5


def _check_baseline(answer: Any) -> str:
    """A baseline that meets the error far away and the search range near by."""
    base = float(_numbers(answer, 1, "The baseline")[0])
    if base <= 0:
        raise Wrong("A baseline is a positive number of metres.")
    stereo = Stereo(focal=700.0, baseline=base, disparity_sigma=0.2)
    far, near = 100 * float(stereo_sigma(4.0, stereo)), float(disparity(0.6, stereo))
    if far > 4.0:
        raise Wrong(f"With {base:.3f} m the depth at 4 m has a standard deviation of {far:.1f} cm: the limit is 4 cm.")
    if near > 160.0:
        raise Wrong(f"With {base:.3f} m a point at 0.6 m has a disparity of {near:.0f} px: the search ends at 160 px.")
    return f"At 4 m the standard deviation is {far:.1f} cm, at 0.6 m the disparity is {near:.0f} px."


EXERCISES = (
    Exercise(
        "01.1",
        "From ticks to a pose",
        3,
        (
            "Three steps: ticks to wheel travel (eq 1.3), travel to advance and turn, then eq 1.1.",
            "Advance is the mean of the two travels; turn is right minus left, over the full wheel separation.",
            "In eq 1.1 the cosine and sine are taken half-way, at theta + turn / 2.",
        ),
        _check_ticks,
    ),
    Exercise(
        "01.2",
        "Find the factor",
        1,
        (
            "Compute the speed of each rim: wheel radius times wheel rate. How much do the rims differ?",
            "A body that turns with omega moves its right rim faster by omega L, with L the full wheel separation.",
        ),
        _check_yaw_rate,
    ),
    Exercise(
        "01.3",
        "Calibrate a robot",
        3,
        (
            "On the straight run both wheels rolled the measured distance: solve eq 1.3 for the radius.",
            "On the spot each wheel rolls a circle whose diameter is the track: angle times track / 2.",
            "Use the mean of both counters on the line, and half of their difference in the spin.",
        ),
        _check_calibrate,
    ),
    Exercise(
        "01.4",
        "How fine an encoder?",
        1,
        (
            "One tick of one wheel is a travel of 2 pi R / N. By what angle does that turn the robot?",
            "Turn = travel / L. Set it to 0.1 degrees and solve for N; then round so that the limit holds.",
        ),
        _check_resolution,
    ),
    Exercise(
        "01.5",
        "Design a stereo camera",
        2,
        (
            "Two demands pull apart: a long baseline is precise far away, a short one keeps near points findable.",
            "Standard deviation = depth^2 sigma / (f B); disparity = f B / depth. Solve each for B: you get a smallest "
            "and a largest baseline.",
        ),
        _check_baseline,
    ),
)
