"""The answers to the labs of chapter 04."""

from __future__ import annotations

import numpy as np

from fuzzynav import tracking
from fuzzynav.course.answers.answer import Answer
from fuzzynav.geometry import compose
from fuzzynav.tracking.reference import FigureEight

__all__ = ["ANSWERS"]


def _largest(kp: float, kd: float, heading: float = 20.0, v0: float = 0.22) -> tuple[float, float]:
    """Largest distance [m] and yaw rate [rad/s] of the run of the lab."""
    eight = FigureEight()
    law = tracking.Dfl(kp1=kp, kp2=kp, kd1=kd, kd2=kd, v0=v0)
    start = eight.sample(0.0).pose + [0.0, 0.0, np.radians(heading)]
    trace = tracking.follow(tracking.Tracker(eight, law), start, duration=40.0)
    return float(trace.max_distance), float(np.abs(trace.commands[:, 1]).max())


def _gains() -> str:
    base, slow, back, loose = _largest(1, 0.7), _largest(1, 0.7, v0=0.02), _largest(1, 0.7, 180.0), _largest(9, 0.1)
    return f"""Damping 1 takes kd = 2 at kp = 1: both poles meet at -1 and nothing overshoots. A first speed of 0.02
    m/s costs distance, {slow[0]:.2f} in place of {base[0]:.2f} m, and yaw rate, {slow[1]:.1f} in place of
    {base[1]:.1f} rad/s: eq 5.2 divides by it. At 180 degrees the robot must turn round first, {back[0]:.2f} m off,
    with the yaw rate at its limit. Poles are not all: kp = 9, kd = 0.1 is stable on paper and {loose[0]:.2f} m off
    in the run, as the limits of the robot cut what the law asks."""


def _late(law: tracking.Law, **disturbance: float) -> float:
    """RMS distance [mm] from 20 s on, default gains, as in the lab."""
    eight = FigureEight(duration=40.0)
    start = compose(eight.sample(0.0).pose, [-0.1, 0.15, 0.3])
    told = tracking.Disturbance(**disturbance)
    trace = tracking.follow(tracking.Tracker(eight, law), start, disturbance=told, rng=5)
    return 1e3 * float(trace.after(20.0).rms_distance)


def _rivals() -> str:
    delays = [d / 10 for d in range(7)]
    worse = next(d for d in delays if _late(tracking.Dfl(), delay=d) > _late(tracking.Kanayama(), delay=d))
    noise = {"position_noise": 0.05, "heading_noise": 0.1}
    return f"""From {worse:.1f} s on: {_late(tracking.Dfl(), delay=worse):.0f} against {
        _late(
            tracking.Kanayama(), delay=worse
        ):.0f} mm, and with a tenth more DFL is lost. Of noise the sliding mode suffers most:
    {_late(tracking.Sliding(), **noise):.0f} mm at 50 mm of noise, where Kanayama's law has
    {_late(tracking.Kanayama(), **noise):.0f}. Of lag DFL: {_late(tracking.Dfl(), motor_lag=0.6):.0f} mm at 0.6 s
    against {_late(tracking.Kanayama(), motor_lag=0.6):.0f}. These are the thesis' gains; with tuned ones DFL stands
    delay and lag far better."""


ANSWERS = (Answer("04.lab1", _gains), Answer("04.lab2", _rivals))
