"""The answer to the lab of chapter 07a."""

from __future__ import annotations

import numpy as np

from fuzzynav.course.answers.answer import Answer
from fuzzynav.plot.labs.fusion import orbit_path

__all__ = ["ANSWERS"]


def _orbit() -> str:
    target, turn = (2.0, 2.0), 0.35
    speeds = np.arange(0.1, 1.001, 0.05)
    reached = [float(v) for v in speeds if orbit_path(target, float(v), turn)[1]]
    fastest = max(reached)
    held, capped = (orbit_path(target, v, turn, cap=c)[0] for v, c in ((fastest, False), (1.0, True)))
    return f"""Up to {fastest:.2f} m/s, where the circle has a radius of {fastest / turn:.2f} m. The arc through the
    sub-goal itself has the radius 2.00 m, which is {2.0 * turn:.2f} m/s; faster ones still pass within the 0.5 m that
    count as reached. With the cap the slider may stand at 1.00 m/s: the robot slows down by itself and is there after
    {0.1 * (len(capped) - 1):.1f} s, {0.1 * (len(held) - 1):.1f} s with the fastest speed that could be held."""


ANSWERS = (Answer("07a.lab1", _orbit),)
