"""Exercises of chapter 04: decoupling, poles, the singularity, an error that must not jump, a tuned law."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fuzzynav import tracking
from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.geometry import Array, compose, wrap
from fuzzynav.tracking.reference import line

__all__ = ["EXERCISES"]

Function = Callable[..., Any]


def _numbers(value: Any, shape: tuple[int, ...], what: str) -> Array:
    """The answer as finite numbers of this shape, or a sentence that says what was expected."""
    words = " by ".join(str(n) for n in shape)
    try:
        found = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise Wrong(f"{what} should be {words} numbers, not {type(value).__name__}.") from None
    if found.shape != shape or not np.isfinite(found).all():
        raise Wrong(f"{what} should be {words} finite numbers.")
    return found


# --- 04.1


def _acceleration(theta: float, v: float, push: float, omega: float) -> Array:
    """Acceleration of a robot by differences of its velocity: no matrix is used."""
    h = 1e-6
    speeds = [(v + s * push) * np.array([np.cos(theta + s * omega), np.sin(theta + s * omega)]) for s in (h, -h)]
    return np.asarray((speeds[0] - speeds[1]) / (2.0 * h))


def _check_decoupling(answer: Function) -> str:
    """Seeded headings and speeds: the matrix must turn (dv/dt, omega) into the acceleration that differences show."""
    rng = np.random.default_rng(41)
    for theta, v, push, omega in rng.uniform([-3, 0.1, -0.5, -1], [3, 0.6, 0.5, 1], (8, 4)):
        matrix = _numbers(answer(theta, v), (2, 2), "F(theta, v)")
        wanted, told = _acceleration(theta, v, push, omega), matrix @ [push, omega]
        if np.abs(told - wanted).max() > 1e-6:
            raise Wrong(
                f"At heading {theta:.2f} rad and v = {v:.2f} m/s, dv/dt = {push:.2f} m/s² and omega = {omega:.2f} "
                f"rad/s give the acceleration ({wanted[0]:.3f}, {wanted[1]:.3f}) m/s², "
                f"yours ({told[0]:.3f}, {told[1]:.3f})."
            )
    return "The first column pushes along the heading, the second across it, in proportion to v."


# --- 04.2


def _check_gains(answer: Function) -> str:
    """The poles of s^2 + kd s + kp must have the damping ratio and the real part that were asked for."""
    rng = np.random.default_rng(42)
    for damping, settling in np.vstack([[0.35, 4.0 / 0.35], rng.uniform([0.2, 2.0], [0.95, 15.0], (8, 2))]):
        kp, kd = _numbers(answer(damping, settling), (2,), "The pair kp, kd")
        if kp <= 0 or kd <= 0:
            raise Wrong(f"kp = {kp:.3g} and kd = {kd:.3g}: both must be positive, or the error grows.")
        pole = np.roots([1.0, kd, kp])[0]
        if abs(-pole.real - 4.0 / settling) > 1e-6:
            raise Wrong(
                f"To settle in {settling:.2f} s the poles need the real part {-4 / settling:.3f} 1/s, "
                f"yours have {pole.real:.3f}."
            )
        if abs(-pole.real / abs(pole) - damping) > 1e-6:
            raise Wrong(f"The damping ratio should be {damping:.3f}, yours is {-pole.real / abs(pole):.3f}.")
    return "The thesis' gains, 1 and 0.7, are the case damping 0.35, settling 11.4 s."


# --- 04.3


def _check_least_speed(answer: Function) -> str:
    """At the speed told the yaw rate of eq 5.2 must just reach the limit."""
    rng = np.random.default_rng(43)
    for ux, uy, theta, most in rng.uniform([-0.2, -0.2, -3, 0.5], [0.2, 0.2, 3, 4], (10, 4)):
        told = float(_numbers(answer((ux, uy), theta, most), (), "The least speed"))
        if told < 0:
            raise Wrong("A speed limit cannot be negative: take the size of the sideways demand.")
        omega = abs(float(tracking.yaw_rate_unguarded([ux, uy], theta, max(told, 1e-12))))
        if abs(omega - most) > 1e-6 * most:
            raise Wrong(f"At {told:.4f} m/s eq 5.2 asks for {omega:.3f} rad/s; the limit is {most:.3f} rad/s.")
    return "Below this speed the robot cannot turn as the law asks: the singularity begins before v = 0."


# --- 04.4


def _check_error(answer: Function) -> str:
    """The error must not change with the frame of the whole scene nor with full turns, and must point the right way."""
    ahead = _numbers(answer((0.0, 0.0, np.pi / 2), (0.0, 1.0, np.pi / 2)), (3,), "The error")
    if np.abs(ahead - [1.0, 0.0, 0.0]).max() > 1e-9:
        raise Wrong(
            f"The reference is 1 m straight ahead of a robot that looks along y: the error is (1, 0, 0), "
            f"yours ({ahead[0]:.2f}, {ahead[1]:.2f}, {ahead[2]:.2f})."
        )
    near = _numbers(answer((0.0, 0.0, 3.1), (0.0, 0.0, -3.1)), (3,), "The error")[2]
    if abs(near) > 1.0:
        raise Wrong(f"From 3.1 rad to -3.1 rad is a turn of 0.083 rad to the left, yours is {near:.3f} rad: wrap it.")
    rng = np.random.default_rng(44)
    for _ in range(10):
        pose, wanted, motion = (np.append(rng.uniform(-2, 2, 2), rng.uniform(-3, 3)) for _ in range(3))
        told = _numbers(answer(tuple(pose), tuple(wanted)), (3,), "The error")
        moved = _numbers(answer(tuple(compose(motion, pose)), tuple(compose(motion, wanted))), (3,), "The error")
        if np.abs(moved[:2] - told[:2]).max() > 1e-9 or abs(wrap(moved[2] - told[2])) > 1e-9:
            raise Wrong("Turning and shifting robot and reference together must not change the error, yours changes.")
        if np.abs(told - tracking.tracking_error(pose, wanted)).max() > 1e-9:
            right = tracking.tracking_error(pose, wanted)
            scene = f"pose {np.round(pose, 2).tolist()} and reference {np.round(wanted, 2).tolist()}"
            raise Wrong(f"At {scene} the error is {np.round(right, 3).tolist()}, yours {np.round(told, 3).tolist()}.")
    return "Ahead, left and heading: what the robot itself sees of the reference."


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
    k1, k2, k3 = _numbers(answer, (3,), "The gains k1, k2, k3")
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
