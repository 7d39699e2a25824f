"""The answers to the labs of chapter 01."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fuzzynav.course.answers.answer import Answer
from fuzzynav.robot import TURTLEBOT2
from fuzzynav.sensors import Encoders, Laser, dead_reckon, laser_scan
from fuzzynav.sensors.cameras import Stereo, stereo_sigma
from fuzzynav.studies.sensors import believed_run, room, square_motions

__all__ = ["ANSWERS"]


def _gap(clockwise: bool = False, **faults: float) -> float:
    """Distance [m] between belief and truth after two laps."""
    motions = square_motions(laps=2) * [1.0, -1.0 if clockwise else 1.0]
    told = believed_run(motions, TURTLEBOT2, Encoders(**faults))  # type: ignore[arg-type]
    return float(np.hypot(*(told[-1] - dead_reckon(np.zeros(3), motions)[-1])[:2]))


def _wheels() -> str:
    here, back = (_gap(way, right_radius_error=0.006, track_error=0.049) for way in (False, True))
    return f"""Three pairs. Both wheels and the track longer by the same share, 2 % say: every turn is right again,
    and after two laps {_gap(right_radius_error=0.02, left_radius_error=0.02, track_error=0.02):.2f} m are left,
    though every side is wrong by 2 %; a straight run of measured length shows it. The right wheel 0.6 % larger with
    the track 4.9 % longer: {here:.2f} m; driven clockwise the same robot is {back:.2f} m off,
    which is why one drives both ways round. Slip of 1 % with both wheels 1 % larger: {
        _gap(
            right_radius_error=0.01, left_radius_error=0.01, slip=0.01
        ):.2f} m, on any run: no run tells these two apart, and none needs to."""


def _fewest(beams: int) -> int:
    """Fewest beams on the person in the ten seconds of the lab."""
    world, pose, rng = room(), np.array([3.2, 1.6, 0.6]), np.random.default_rng(1)
    laser, mover = Laser(field_of_view=2.0 * np.pi, range_max=6.0, noise=0.0, beams=beams), world.movers[0]
    least = beams
    for time in np.arange(0.0, 10.05, 0.1):
        at = np.add(mover.start, np.multiply(mover.velocity, time))
        points = laser_scan(world, pose, laser, rng, at[None]).world_points(pose)
        least = min(least, int((np.hypot(*(points - at).T) < mover.radius + 0.02).sum()))
    return least


def _laser() -> str:
    enough = next(n for n in range(181, 362, 10) if all(_fewest(k) >= 5 for k in (n, n + 2, n + 4)))
    return f"""About {enough}: the person is farthest at the beginning, 3.7 m away, and a circle of 0.25 m there is
    7.7 degrees wide, so that neighbouring beams must stand 1.5 degrees apart or less; with 91 beams it is only
    {_fewest(91)} at the worst moment. Nothing in this room stands in between. What takes the person out of the scan
    is the range, once it is shorter than the way to the person; dropout only thins the points."""


def _stereo() -> str:
    base = Stereo(focal=525.0, baseline=0.12, disparity_sigma=0.3)
    here, wide, near = (
        100 * float(stereo_sigma(z, s)) for z, s in ((4.0, base), (4.0, replace(base, baseline=0.24)), (2.0, base))
    )
    return f"""Halving the distance: the standard deviation grows with its square. At 4 m it is {here:.0f} cm, with
    twice the baseline {wide:.0f} cm, at half the distance {near:.0f} cm. Far points scatter more beyond the line
    because depth is f B over the disparity: a disparity that is too small by some amount puts the point farther
    away than one that is too large by the same amount brings it nearer."""


ANSWERS = (
    Answer("01.lab1", _wheels),
    Answer("01.lab2", _laser),
    Answer(
        "01.lab3",
        """At half the cone plus the largest angle of an echo, with the first values 15 + 25 = 40 degrees. Up to 15
        degrees the ray that meets the wall at a right angle lies in the cone and is the nearest; beyond that the
        edge of the cone is, and once that edge meets the wall by more than 25 degrees off its normal no ray returns
        and the largest range is read.""",
    ),
    Answer("01.lab4", _stereo),
)
