"""Exercises of chapter 04: decoupling, poles, the singularity, an error that must not jump, a tuned law."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fuzzynav import tracking
from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.course.exercises.answers import array, close, named, number, numbers
from fuzzynav.geometry import Array
from fuzzynav.tracking.reference import line

__all__ = ["EXERCISES"]

Function = Callable[..., Any]


# --- 04.1


def _acceleration(theta: float, v: float, push: float, omega: float) -> Array:
    """Acceleration of a robot by differences of its velocity: no matrix is used."""
    h = 1e-6
    speeds = [(v + s * push) * np.array([np.cos(theta + s * omega), np.sin(theta + s * omega)]) for s in (h, -h)]
    return np.asarray((speeds[0] - speeds[1]) / (2.0 * h))


def _check_decoupling(answer: Function) -> str:
    """Seeded headings and speeds: the matrix must turn (dv/dt, omega) into the acceleration that differences show."""
    cases = np.random.default_rng(41).uniform([-3, 0.1, -0.5, -1], [3, 0.6, 0.5, 1], (8, 4))
    told = np.array([array(answer(theta, v), (2, 2), "F(theta, v)") for theta, v, _, _ in cases])
    wanted = np.array([_acceleration(*case) for case in cases])
    found = np.einsum("kij,kj->ki", told, cases[:, 2:])
    if np.abs(found - wanted).max() > 1e-5:
        _name_matrix(told, cases[:, 0], cases[:, 1])
        k = int(np.argmax(np.abs(found - wanted).max(axis=1)))
        theta, v, push, omega = cases[k]
        raise Wrong(
            f"At heading {theta:.2f} rad and v = {v:.2f} m/s, dv/dt = {push:.2f} m/s² and omega = {omega:.2f} "
            f"rad/s give the acceleration ({wanted[k, 0]:.3f}, {wanted[k, 1]:.3f}) m/s², "
            f"yours ({found[k, 0]:.3f}, {found[k, 1]:.3f})."
        )
    return "The first column pushes along the heading, the second across it, in proportion to v."


def _name_matrix(told: Array, theta: Array, v: Array) -> None:
    c, s = np.cos(theta), np.sin(theta)

    def rows(*entries: Array) -> Array:
        return np.stack(entries, axis=-1).reshape(-1, 2, 2)

    named(
        told,
        (rows(c, s, -v * s, v * c), "Rows and columns are swapped: the first column belongs to dv/dt."),
        (rows(c, -s, s, c), "The second column lacks v: a robot that stands does not accelerate when it turns."),
        (rows(c, v * s, s, -v * c), "The second column points to the right: a positive omega turns the velocity left."),
        (rows(c, v * s, s, v * c), "The derivative of the cosine is minus the sine: mind the sign in the upper row."),
        (rows(-v * s, c, v * c, s), "The columns are swapped: dv/dt comes first, then omega."),
        (
            rows(v * c, -v * s, v * s, v * c),
            "The first column has a v too many: dv/dt pushes along the heading by itself.",
        ),
        (rows(c, s, -s / v, c / v), "This is the inverse of F: it turns accelerations into (dv/dt, omega)."),
    )


# --- 04.2


def _check_gains(answer: Function) -> str:
    """The poles of s^2 + kd s + kp must have the damping ratio and the real part that were asked for."""
    asked = np.vstack([[0.35, 4.0 / 0.35], np.random.default_rng(42).uniform([0.2, 2.0], [0.95, 15.0], (8, 2))])
    told = np.array([numbers(answer(damping, settling), 2, "The pair kp, kd") for damping, settling in asked])
    damping, settling = asked.T
    # the common rule of thumb, the time constant's exact 2 %, and the exact 2 % of the envelope
    fours = (np.full(9, 4.0), np.full(9, np.log(50.0)), -np.log(0.02 * np.sqrt(1.0 - damping**2)))
    if any(close(told, _gains(four / (damping * settling), damping)) for four in fours):
        return "The thesis' gains, 1 and 0.7, are the case damping 0.35, settling 11.4 s."
    if (told <= 0).any():
        kp, kd = told[int(np.argmax((told <= 0).any(axis=1)))]
        raise Wrong(f"kp = {kp:.3g} and kd = {kd:.3g}: both must be positive, or the error grows.")
    w = 4.0 / (damping * settling)
    named(
        told,
        (_gains(w, damping)[:, ::-1], "The pair is swapped: kp comes first, then kd."),
        (np.stack([w**2, damping * w], axis=1), "Half of kd is missing: the polynomial has 2 damping w before s."),
        (np.stack([w, 2 * damping * w], axis=1), "kp is the square of w: yours is w itself."),
        (
            _gains(4.0 / settling, damping),
            "The envelope falls with damping times w: yours settles as if damping were 1.",
        ),
        (
            _gains(3.0 / (damping * settling), damping),
            "A 3 in place of the 4 is the 5 % settling time; 2 % is asked for.",
        ),
    )
    k = int(np.argmax(np.abs(told - _gains(w, damping)).max(axis=1)))
    pole = np.roots([1.0, told[k, 1], told[k, 0]])[0]
    if abs(-pole.real - 4.0 / settling[k]) > 1e-6:
        raise Wrong(
            f"To settle in {settling[k]:.2f} s the poles need the real part {-4 / settling[k]:.3f} 1/s, "
            f"yours have {pole.real:.3f}."
        )
    raise Wrong(f"The damping ratio should be {damping[k]:.3f}, yours is {-pole.real / abs(pole):.3f}.")


def _gains(w: Array, damping: Array) -> Array:
    """kp and kd of these natural frequencies and damping ratios."""
    return np.stack([w**2, 2.0 * damping * w], axis=1)


# --- 04.3


def _check_least_speed(answer: Function) -> str:
    """At the speed told the yaw rate of eq 5.2 must just reach the limit."""
    cases = np.random.default_rng(43).uniform([-0.2, -0.2, -3, 0.5], [0.2, 0.2, 3, 4], (10, 4))
    told = np.array([number(answer((ux, uy), theta, most), "The least speed") for ux, uy, theta, most in cases])
    ux, uy, theta, most = cases.T
    across = uy * np.cos(theta) - ux * np.sin(theta)
    if close(told, np.abs(across) / most, 1e-8):
        return "Below this speed the robot cannot turn as the law asks: the singularity begins before v = 0."
    named(
        told,
        (across / most, "A speed limit cannot be negative: take the size of the sideways demand."),
        (-across / most, "A speed limit cannot be negative, and left counts as positive: take the size."),
        (
            np.abs(ux * np.cos(theta) + uy * np.sin(theta)) / most,
            "The part along the heading changes the speed, not the turn.",
        ),
        (np.abs(uy) / most, "u is given in the world: turn it into the robot's view first."),
        (np.hypot(ux, uy) / most, "Only the part of u across the heading asks for a turn, not all of u."),
        (np.abs(across) * most, "A robot that may turn faster can be slower: divide by omega_max, do not multiply."),
        (most / np.abs(across), "Your fraction stands on its head: the demand over the limit is a speed."),
    )
    k = int(np.argmax(np.abs(told - np.abs(across) / most)))
    omega = abs(float(tracking.yaw_rate_unguarded(cases[k, :2], theta[k], max(float(told[k]), 1e-12))))
    raise Wrong(f"At {told[k]:.4f} m/s eq 5.2 asks for {omega:.3f} rad/s; the limit is {most[k]:.3f} rad/s.")


# --- 04.4


def _check_error(answer: Function) -> str:
    """The error as the robot sees it, on seeded poses and where the heading passes half a turn."""
    rng = np.random.default_rng(44)
    poses = np.vstack([[0.0, 0.0, np.pi / 2], [0.0, 0.0, 3.1], rng.uniform([-2, -2, -3], [2, 2, 3], (10, 3))])
    goals = np.vstack([[0.0, 1.0, np.pi / 2], [0.0, 0.0, -3.1], rng.uniform([-2, -2, -3], [2, 2, 3], (10, 3))])
    cases = zip(poses.tolist(), goals.tolist(), strict=True)
    told = np.array([numbers(answer(tuple(p), tuple(g)), 3, "The error") for p, g in cases])
    right = np.array([tracking.tracking_error(p, g) for p, g in zip(poses, goals, strict=True)])
    if not close(told, right):
        _name_errors(told, right, poses, goals)
    return "Ahead, left and heading: what the robot itself sees of the reference."


def _name_errors(told: Array, right: Array, poses: Array, goals: Array) -> None:
    (dx, dy, turn), (c, s) = (goals - poses).T, (np.cos(poses[:, 2]), np.sin(poses[:, 2]))
    if not close(told[:, :2], right[:, :2]):
        named(
            told[:, :2],
            (
                np.stack([c * dx + s * dy, s * dx + c * dy], axis=1),
                "The sign of the sine in the second component is wrong.",
            ),
            (np.stack([dx, dy], axis=1), "This is the difference in the world; turn it into the robot's view."),
            (
                np.stack([c * dx - s * dy, s * dx + c * dy], axis=1),
                "Yours turns by plus theta: the robot's view needs minus.",
            ),
            (-right[:, :2], "The error points from the robot to the reference: yours is the other way round."),
            (right[:, 1::-1], "Ahead comes first, then left: yours are swapped."),
        )
        k = int(np.argmax(np.abs(told - right)[:, :2].max(axis=1)))
        raise Wrong(
            f"From the pose {np.round(poses[k], 2).tolist()} the reference at {np.round(goals[k], 2).tolist()} is "
            f"{right[k, 0]:.2f} m ahead and {right[k, 1]:.2f} m to the left, "
            f"yours ({told[k, 0]:.2f}, {told[k, 1]:.2f})."
        )
    named(
        told[:, 2],
        (turn, "From 3.1 rad to -3.1 rad is a turn of 0.083 rad to the left, yours is -6.200 rad: wrap it."),
        (-right[:, 2], "The heading error is wanted minus pose: yours has the other sign."),
        (np.abs(right[:, 2]), "The heading error has lost its sign: left is positive, right is negative."),
        (np.rad2deg(right[:, 2]), "The heading error stays in radians: yours is in degrees."),
    )
    k = int(np.argmax(np.abs(told - right)[:, 2]))
    raise Wrong(
        f"From heading {poses[k, 2]:.2f} to {goals[k, 2]:.2f} rad is {right[k, 2]:.2f} rad, yours {told[k, 2]:.2f}."
    )


# --- 04.5


def _step_response(law: tracking.Kanayama) -> tuple[float, float, float]:
    """Overshoot [m], settling time [s] and largest yaw rate [rad/s] after a sideways error of 0.1 m at 0.2 m/s."""
    run = tracking.follow(tracking.Tracker(line((0.0, 0.0), 0.0, 0.2, 20.0), law), [0.0, 0.1, 0.0])
    y = run.poses[:, 1]
    outside = np.flatnonzero(np.abs(y) > 0.005)
    settled = float(run.t[min(int(outside[-1]) + 1, len(y) - 1)]) if len(outside) else 0.0
    return float(max(-y.min(), 0.0)), settled, float(np.abs(run.commands[:, 1]).max())


def _check_tuning(answer: Any) -> str:
    """The three gains of eq 5.10 against overshoot, settling time and yaw rate on a straight line."""
    k1, k2, k3 = numbers(answer, 3, "The gains k1, k2, k3")
    if min(k1, k2, k3) <= 0:
        raise Wrong(f"All three gains must be positive, the least of yours is {min(k1, k2, k3):.3g}.")
    overshoot, settled, turn = _step_response(tracking.Kanayama(k1=float(k1), k2=float(k2), k3=float(k3)))
    if overshoot > 0.003:
        raise Wrong(f"The robot passes the line by {1e3 * overshoot:.1f} mm: the limit is 3 mm; damp it with k3.")
    if settled > 6.0:
        raise Wrong(f"The robot is within 5 mm of the line after {settled:.1f} s: the limit is 6 s.")
    if turn > 0.6:
        raise Wrong(f"The largest yaw rate is {turn:.2f} rad/s: the limit is 0.6; lower k2.")
    return f"Overshoot {1e3 * overshoot:.1f} mm, settled after {settled:.1f} s, at most {turn:.2f} rad/s."


EXERCISES: tuple[Exercise, ...] = (
    Exercise(
        "04.1",
        "The decoupling matrix",
        2,
        (
            "Differentiate v cos(theta) and v sin(theta) with the product rule.",
            "What stands before dv/dt is the first column, what stands before theta' = omega is the second.",
            "First column: (cos, sin). Second column: v (-sin, cos).",
        ),
        _check_decoupling,
    ),
    Exercise(
        "04.2",
        "Gains for a wanted response",
        2,
        (
            "The error follows s² + kd s + kp = s² + 2 damping w s + w².",
            "The real part of the poles is -damping w; the 2 % settling time is about 4 / (damping w).",
            "w = 4 / (damping settling); then kp = w² and kd = 2 damping w.",
        ),
        _check_gains,
    ),
    Exercise(
        "04.3",
        "Where the singularity begins",
        2,
        (
            "Only the part of u across the heading asks for a turn.",
            "Across the heading: u2 cos(theta) - u1 sin(theta). Eq 5.2 divides it by v.",
            "The speed at which |u2 cos - u1 sin| / v equals the limit.",
        ),
        _check_least_speed,
    ),
    Exercise(
        "04.4",
        "An error that must not jump",
        2,
        (
            "Try a robot at heading 3.1 rad and a reference at -3.1 rad.",
            "The first two components are the difference of positions turned by minus theta.",
            "Check the sign of sin in the second component, and wrap the third with geometry.wrap.",
        ),
        _check_error,
    ),
    Exercise(
        "04.5",
        "Tune the law of eq 5.10",
        2,
        (
            "Near a straight line the sideways error follows e'' + k3 e' + k2 v² e = 0.",
            "No overshoot needs k3² of about 4 k2 v² or more; here v is 0.2 m/s.",
            "Choose w = 1 rad/s: k2 = w² / v² = 25 and k3 = 2 w. k1 plays no part here.",
        ),
        _check_tuning,
    ),
)
