"""The answers to the labs of chapter 02."""

from __future__ import annotations

import numpy as np

from fuzzynav.course.answers.answer import Answer
from fuzzynav.geometry import Array
from fuzzynav.localization.kalman import Belief, LandmarkSensor, MotionNoise, dead_reckoning
from fuzzynav.studies import localization as study

__all__ = ["ANSWERS"]


def _axes(travel: float, turn: float, share: float = 1.0) -> Array:
    """Standard deviations [m] across and along the ellipse after a share of one lap."""
    noise = MotionNoise(
        travel_per_metre=(travel / 100) ** 2,
        travel_per_radian=0.0,
        turn_per_metre=np.deg2rad(turn) ** 2,
        turn_per_radian=0.0,
    )
    track = dead_reckoning(Belief(np.array([5.0, 1.5, 0.0]), np.zeros((3, 3))), study.lap(), noise)
    last = round((len(track.means) - 1) * share)
    return np.asarray(np.sqrt(np.linalg.eigvalsh(track.covariances[last][:2, :2])))


def _doubt() -> str:
    return f"""The heading, by far: alone, 3 cm per root of a metre leave a standard deviation of
    {_axes(3, 0)[1]:.2f} m along the long axis after the lap, 3 degrees leave {_axes(0, 3)[1]:.2f} m, because an
    error of the heading is multiplied by all the way that follows. The long axis is {_axes(3, 3, 0.75)[1]:.2f} m
    after three quarters of the lap and {_axes(3, 3)[1]:.2f} m after the whole: an old error of the heading turns
    the path about the place where it was made, and as the robot comes back near that place it moves its end less."""


def _honesty(trust: float, beacons: int) -> tuple[float, float]:
    """RMS error [m] and mean NEES of the filter of the lab."""
    sensor = LandmarkSensor(sigma_range=0.1, sigma_bearing=np.deg2rad(2.0), range_max=5.0)
    truth, found, nees = study.ekf_run(sensor, trust=trust, beacons=study.BEACONS[:beacons])
    return float(np.sqrt(np.mean(np.sum((found.means - truth)[:, :2] ** 2, axis=1)))), float(nees.mean())


def _trust() -> str:
    honest, sure = _honesty(1.0, 5), _honesty(0.3, 5)
    few = [f"{_honesty(1.0, n)[0]:.2f} m" for n in (1, 2, 3)]
    return f"""With a factor of 0.3 the RMS error goes from {honest[0]:.2f} to {sure[0]:.2f} m, but the mean NEES
    from {honest[1]:.0f} to {sure[1]:.0f}, where 3 is honest: the filter claims an accuracy that it does not have.
    Three beacons hold the path here; the first one, two, three alone leave an RMS error of {few[0]}, {few[1]},
    {few[2]}. A beacon helps only while it is in reach, so with one the robot drives most of the lap blind."""


def _found(particles: int, lost: bool) -> int | None:
    """The first scan of the story from which on the estimate stays within half a metre, or None."""
    errors = np.asarray(study.chase(particles, lost=lost, kidnap=False, recovery=True).errors)
    wrong = np.flatnonzero(errors > 0.5)
    last = int(wrong[-1]) + 1 if len(wrong) else 0
    return None if last >= len(errors) else last + 1


def _swarm() -> str:
    scans = {n: _found(n, True) for n in (100, 300, 1000)}
    words = ", ".join(f"with {n} {'never' if s is None else f'from scan {s} on'}" for n, s in scans.items())
    known = max(_found(100, False) or 0, 1)
    return f"""When the start is known 100 are plenty: the estimate is right from scan {known} on. When it is not,
    some particle must lie near the robot with nearly its heading, by luck: here {words}. It is one draw of the
    dice; another seed gives other scans, and of a dozen seeds even 1000 particles miss the robot at first in a few.
    Count runs, not one run."""


ANSWERS = (
    Answer("02.lab1", _doubt),
    Answer("02.lab2", _trust),
    Answer("02.lab3", _swarm),
    Answer(
        "02.lab4",
        """Both, in different ways. Noise of the range blurs a wall over a few cells about its true place; every
        scan errs anew, so that scanning on sharpens it: the mean doubt falls. Drift puts one wall at several
        places: the doubt falls as well, but about a wrong map, in which walls stand twice or are wiped out by the
        rays of another pass. More scanning heals noise, and it does not heal drift. Only better poses do: the pose
        graph above.""",
    ),
)
