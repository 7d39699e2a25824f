"""The answers to the labs of chapter 07b."""

from __future__ import annotations

from collections import Counter

import numpy as np

from fuzzynav import fusion
from fuzzynav.course.answers.answer import Answer
from fuzzynav.plot.labs.fusion import LAYERS, guard_run
from fuzzynav.robot import THESIS, Robot

__all__ = ["ANSWERS"]


def _hall() -> str:
    """The side on which a robot passes the pocket, for blocks along x = 6 m."""
    above, below, early = list[float](), list[float](), 0
    for y in (0.6, 1.0, 1.4, 1.8, 6.2, 6.6, 7.0, 7.4):
        driven, moments = fusion.watch(fusion.hall_task(blocks=[(6.0, y)], robot=THESIS))
        assert driven.run is not None
        k = int(np.argmin(np.abs(driven.run.poses[:, 0] - 6.0)))
        (above if driven.run.poses[k, 1] > 4.0 else below).append(y)
        early += bool(moments[0].entered.any())
    return f"""By the map alone both sides are equally long. The robot passes above with the block at y =
    {", ".join(f"{y:.1f}" for y in above)} m, below at {", ".join(f"{y:.1f}" for y in below)} m: the block decides,
    and it does so at the start, because in {early} of 8 places the first scan shows it.
    Give the walkers speed, and look when the way
    changes: after 3 s without progress they count as obstacles too."""


def _layers() -> str:
    found: dict[str, Counter[str]] = {name: Counter() for name in LAYERS}
    for robot in fusion.ROBOTS:
        for gamma in (0.2, 0.6, 1.0):
            for name in LAYERS:
                _, made = guard_run((0.4, 0.1, gamma, 0.1), 0.15, name, robot)
                found[name][made.row["ending"]] += 1
    told = "; ".join(
        f"{name}: " + ", ".join(f"{count} {ending}" for ending, count in sorted(found[name].items())) for name in LAYERS
    )
    return f"""Over both robots and gamma 0.2, 0.6 and 1.0, six runs each: {told}. With the guard nothing is hit while
    the robot moves, whatever the weights; without it the weights decide. What it costs is seen too: these walkers do
    not yield, and a robot that stands before them is struck."""


def _bound() -> str:
    bounds = np.arange(0.0, 2.001, 0.05)
    walker = [[2.6, 0.0, 0.3]]

    def allowed(robot: Robot, v: float) -> tuple[float, float]:
        """The largest V at which v straight ahead passes: on the arc, and by the theorem."""
        arc = [b for b in bounds if fusion.stays_clear([0, 0, 0], [v, 0.0], walker, float(b), robot, 0.1)]
        law = [b for b in bounds if fusion.passive_separation(v, float(b), robot, 0.1) <= 2.0]
        return float(max(arc)), float(max(law, default=np.nan))

    slow, quick = allowed(THESIS, 0.5), allowed(fusion.ROBOTS["turtlebot2"], 0.5)
    return f"""With the thesis's brakes up to V = {slow[0]:.2f} m/s; the theorem, which allows for speeding up in any
    direction, only up to {slow[1]:.2f} m/s. With the TurtleBot2's brakes up to {quick[0]:.2f} m/s on the slider
    ({quick[1]:.2f} by the theorem): it stands after 0.2 s, and nobody gets far in that time."""


ANSWERS = (Answer("07b.lab1", _hall), Answer("07b.lab2", _layers), Answer("07b.lab3", _bound))
