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
    above, changes = [], 0
    for y in np.arange(0.6, 7.5, 0.4):
        if 2.1 < y < 5.9:
            continue  # it would touch the pocket
        driven, moments = fusion.watch(fusion.hall_task(blocks=[(6.0, float(y))]))
        assert driven.run is not None
        k = int(np.argmin(np.abs(driven.run.poses[:, 0] - 6.0)))
        if driven.run.poses[k, 1] > 4.0:
            above.append(float(y))
        changes += len(moments) > 0 and bool(moments[-1].searches > 1)
    return f"""Only where it stands in the way. The map alone makes both sides equal; the block takes the side that it
    stands on: at y = {', '.join(f'{y:.1f}' for y in above)} m the robot passes above the pocket, else below. The first
    scan shows the block in nearly every place, so the choice is made at the start; the searches every 2 s find
    nothing new. Give the walkers speed, and the way changes while they stand in it."""


def _layers() -> str:
    found: dict[str, Counter[str]] = {name: Counter() for name in LAYERS}
    for robot in fusion.ROBOTS:
        for gamma in (0.1, 0.2, 0.4, 0.6, 0.8, 1.0):
            for name in LAYERS:
                _, made = guard_run((0.4, 0.1, gamma, 0.1), 0.15, name, robot)
                found[name][made.row["ending"]] += 1
    told = "; ".join(
        f"{name}: " + ", ".join(f"{count} {ending}" for ending, count in sorted(found[name].items())) for name in LAYERS
    )
    return f"""Over both robots and gamma from 0.1 to 1.0, twelve runs each: {told}. With the guard nothing is hit while
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
