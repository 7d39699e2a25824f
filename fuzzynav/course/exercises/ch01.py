"""Exercises of chapter 01: ticks, the factor of two, calibration, resolution and a stereo baseline."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.course.exercises.answers import close, integers, named, number, numbers
from fuzzynav.geometry import Array, wrap
from fuzzynav.robot import TURTLEBOT2, Robot, body_speeds, move, move_midpoint
from fuzzynav.sensors import odometry, wheel_travel
from fuzzynav.sensors.cameras import Stereo, disparity, stereo_sigma

__all__ = ["EXERCISES"]

Function = Callable[..., Any]
TWO_PI = 2.0 * np.pi


def _robots(seed: int, count: int) -> list[Robot]:
    """TurtleBots with other wheels."""
    rng = np.random.default_rng(seed)
    sizes = rng.uniform([0.02, 0.15], [0.12, 0.6], (count, 2))
    return [replace(TURTLEBOT2, wheel_radius=float(r), track=float(t)) for r, t in sizes]


# --- 01.1


def _check_ticks(answer: Function) -> str:
    """Seeded poses and counts against the mid-point rule, or the exact arc."""
    ahead = numbers(answer(np.zeros(3), 1000, 1000, 1000, 0.035, 0.23), 3, "The pose")
    if not close(ahead, [TWO_PI * 0.035, 0.0, 0.0]):
        _one_turn(ahead)
    rng = np.random.default_rng(11)
    for robot in _robots(11, 6):
        pose, n = np.append(rng.uniform(-2, 2, 2), rng.uniform(-3, 3)), int(rng.integers(200, 3000))
        right, left = (int(k) for k in rng.integers(-n // 4, n // 4, 2))
        told = numbers(answer(pose.copy(), right, left, n, robot.wheel_radius, robot.track), 3, "The pose")
        _compare_poses(told, pose, odometry([[0, 0], [right, left]], robot, n)[0])
    return "Ticks became a motion, and the motion a pose."


def _one_turn(ahead: Array) -> None:
    """Name what is wrong where both wheels of 0.035 m made one turn at the origin."""
    way = TWO_PI * 0.035
    named(
        ahead,
        ([0.035, 0.0, 0.0], "In one turn a wheel rolls its circumference, 2 pi times the radius, not the radius."),
        ([way / 2, 0.0, 0.0], "In one turn a wheel rolls 2 pi times its radius: yours rolls pi times, half as far."),
        ([2 * way, 0.0, 0.0], "Both wheels rolled 0.2199 m and your robot twice that: the advance is their mean."),
    )
    raise Wrong(
        f"Both wheels of 0.035 m made one turn: the pose is (0.2199, 0, 0), yours ({ahead[0]:.6g}, {ahead[1]:.6g}, "
        f"{ahead[2]:.6g})."
    )


def _compare_poses(told: Array, pose: Array, motion: Array) -> None:
    """Name what is wrong in the pose after an advance [m] and a turn [rad]."""
    wanted = [rule(pose, motion, 1.0) for rule in (move_midpoint, move)]
    if abs(wrap(told[2] - wanted[0][2])) > 1e-6:
        named(
            float(wrap(told[2] - pose[2] + motion[1])),
            (0.0, "More ticks on the right wheel turn the robot to the left: yours turns to the right."),
        )
        named(
            float(told[2] - pose[2]),
            (2.0 * motion[1], "Your robot turns twice as far as it should: divide by the full track, not by its half."),
            (
                0.5 * motion[1],
                "Your robot turns half as far as it should: divide by the track, not by twice the track.",
            ),
            (np.rad2deg(motion[1]), "The turn stays in radians: yours is in degrees."),
        )
        named(told[2], (motion[1], "The turn is added to the old heading: yours begins at heading 0."))
        raise Wrong(
            f"From heading {pose[2]:.3f} the robot turns by {motion[1]:.4f} rad, yours by "
            f"{float(wrap(told[2] - pose[2])):.4f}: it is the difference of both travels over the track."
        )
    if min(np.abs(told[:2] - w[:2]).max() for w in wanted) > 2e-6:
        named(
            told[:2],
            (_straight(pose, motion, 0.0), "The cosine and sine are taken at the old heading: take them half-way."),
            (_straight(pose, motion, 1.0), "The cosine and sine are taken at the new heading: take them half-way."),
            (wanted[0][:2] - pose[:2], "The motion is right, but it begins at (0, 0): add it to the old position."),
        )
        raise Wrong(
            f"From {np.round(pose, 3).tolist()} the robot comes to {np.round(wanted[0][:2], 4).tolist()}, "
            f"yours to {np.round(told[:2], 4).tolist()}: it goes by the advance at the heading half-way."
        )


def _straight(pose: Array, motion: Array, share: float) -> Array:
    """The place after a straight step at the heading that holds after this share of the turn."""
    heading = pose[2] + share * motion[1]
    return np.asarray(pose[:2] + motion[0] * np.array([np.cos(heading), np.sin(heading)]))


# --- 01.2


def _check_yaw_rate(answer: Function) -> str:
    """Seeded robots: the rims must move as the body does."""
    rng = np.random.default_rng(12)
    for robot in _robots(12, 6):
        right, left = rng.uniform(-10, 10, 2)
        told = number(answer(right, left, robot.wheel_radius, robot.track), "The yaw rate")
        omega = float(body_speeds([right, left], robot)[1])
        if close(told, omega):
            continue
        rims = omega * robot.track
        named(
            told,
            (
                omega / 2,
                f"Your robot turns at {told:.3f} rad/s, but its rims differ by {rims:.3f} m/s over a track of "
                f"{robot.track:.3f} m: that is {omega:.3f} rad/s, twice as much.",
            ),
            (
                -omega,
                "A faster right wheel turns the robot to the left, and left is positive: yours has the other sign.",
            ),
            (-omega / 2, "The sign is wrong, and so is the factor: right minus left, over the full track."),
            (2 * omega, "Your robot turns twice as fast as its rims allow: `track` is already the full separation."),
            (omega / robot.wheel_radius, "Without the wheel radius the wheel rates are no speeds: rad/s is not m/s."),
            (rims, "This is the difference of the rim speeds [m/s]; over the track it becomes a yaw rate."),
        )
        raise Wrong(
            f"Rates of {right:.2f} and {left:.2f} rad/s with radius {robot.wheel_radius:.3f} m and track "
            f"{robot.track:.3f} m give {omega:.3f} rad/s, yours is {told:.3f}."
        )
    return "The rims of both wheels now move as the body does."


# --- 01.3


def _check_calibrate(answer: Function) -> str:
    """Seeded robots that drove a straight line and spun on the spot, their counters a few ticks apart."""
    rng, n = np.random.default_rng(13), 2578
    for robot in _robots(13, 6):
        line = round(float(5.0 / wheel_travel(1, n, robot.wheel_radius)))
        spin = round(float(10 * np.pi * robot.track / wheel_travel(1, n, robot.wheel_radius)))
        apart, uneven = rng.permutation([-1, 1]) * int(0.04 * line), rng.permutation([-1, 1]) * int(0.04 * spin)
        lines, spins = (line + apart[0], line + apart[1]), (spin + uneven[0], -spin - uneven[1])
        told = numbers(answer(lines, 5.0, spins, 20 * np.pi, n), 2, "Radius and track")
        _compare_sizes(told, robot, lines, spins)
    return "The belief about the wheels fits both runs to within a tick."


def _compare_sizes(told: Array, robot: Robot, line: tuple[int, ...], spin: tuple[int, ...]) -> None:
    """Name what is wrong in a wheel radius and a track that were measured."""
    radius, track = robot.wheel_radius, robot.track
    near = 2e-3
    if np.abs(told / [radius, track] - 1.0).max() <= near:
        return
    mean_line, mean_spin = sum(line) / 2, (spin[0] - spin[1]) / 2
    one_line = [radius * mean_line / k for k in line]
    one_spin = [track * abs(k) / mean_spin for k in spin]
    for value, true, sentence in (
        (told[0], track, "The wheel radius comes first, then the track: yours are swapped."),
        (told[0], 2 * radius, "That is the diameter of the wheels; their radius is asked for."),
        (told[0], radius / 2, "The ticks of both wheels on the line were added up: take their mean."),
        (told[0], TWO_PI * radius, "That is the way in one turn of a wheel; over 2 pi it becomes the radius."),
        (told[0], one_line[0], "The radius fits the right counter alone; the line is the mean of both counters."),
        (told[0], one_line[1], "The radius fits the left counter alone; the line is the mean of both counters."),
        (told[1], -track, "A track is positive: the left wheel counts backwards in the spin, so subtract."),
        (told[1], track / 2, "The spin turns each wheel about the middle: its circle has the radius track / 2."),
        (told[1], 2 * track, "The track is twice what it should be: half the difference of both counters rolls it."),
        (told[1], one_spin[0], "The track fits the right counter alone; take half the difference of both."),
        (told[1], one_spin[1], "The track fits the left counter alone; take half the difference of both."),
    ):
        if abs(value / true - 1.0) <= near / 2:
            raise Wrong(sentence)
    if abs(told[0] / radius - 1.0) > near:
        off = 100 * (told[0] / radius - 1)
        raise Wrong(f"The wheel radius should be {radius:.4f} m, yours is {told[0]:.4f} m, {off:+.1f} % off.")
    off = 100 * (told[1] / track - 1)
    raise Wrong(f"The track should be {track:.4f} m, yours is {told[1]:.4f} m, {off:+.1f} % off.")


# --- 01.4


def _check_resolution(answer: Any) -> str:
    """The smallest number of ticks for a tenth of a degree."""
    ticks = integers(answer, 1, "The number of ticks a turn")[0]
    if ticks < 1:
        raise Wrong("A wheel makes at least one tick a turn.")
    named(
        ticks,
        (1096, "1096 would do if the track were half as long: the turn is the travel over the full track."),
        (137, "137 are the lines of a quadrature disc that makes 548 ticks; the ticks are asked for."),
        (3600, "3600 ticks split a turn of the wheel into tenths of a degree; the robot's turn is asked for."),
    )
    step = np.rad2deg(odometry([[0, 0], [1, 0]], TURTLEBOT2, ticks)[0, 1])
    coarser = np.rad2deg(odometry([[0, 0], [1, 0]], TURTLEBOT2, max(ticks - 1, 1))[0, 1])
    if step > 0.1:
        raise Wrong(
            f"With {ticks} ticks a turn one tick of one wheel turns the robot by {step:.4f} deg: the limit is 0.1 deg."
        )
    if coarser <= 0.1:
        raise Wrong(f"{ticks} ticks are fine enough, but one less would do as well: {coarser:.4f} deg a tick.")
    return f"One tick turns the robot by {step:.4f} deg."


# --- 01.5


def _check_baseline(answer: Any) -> str:
    """A baseline that meets the error far away and the search range near by."""
    base = number(answer, "The baseline")
    if base <= 0:
        raise Wrong("A baseline is a positive number of metres.")
    stereo = Stereo(focal=700.0, baseline=base, disparity_sigma=0.2)
    far, near = 100 * float(stereo_sigma(4.0, stereo)), float(disparity(0.6, stereo))
    if base > 1.0:
        raise Wrong(f"A baseline of {base:.4g} m is wider than the robot: it is asked for in metres.")
    if far > 4.0 + 1e-6:
        raise Wrong(f"With {base:.4f} m the depth at 4 m has a standard deviation of {far:.3f} cm: the limit is 4 cm.")
    if near > 160.0 + 1e-6:
        raise Wrong(f"With {base:.4f} m a point at 0.6 m has a disparity of {near:.2f} px: the search ends at 160 px.")
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
