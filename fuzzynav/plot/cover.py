"""The picture of README: one run in a cluttered world, and the velocities of one of its decisions."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fuzzynav import dwa, simulate
from fuzzynav.plot.base import draw_path, draw_robot
from fuzzynav.plot.blit import Blit
from fuzzynav.plot.dwa import arc_mark, draw_window
from fuzzynav.plot.runs import draw_run
from fuzzynav.robot import THESIS
from fuzzynav.world import World

__all__ = ["save_cover"]

DISCS = np.array([[3.0, 2.2, 0.6], [5.2, 3.8, 0.5], [4.0, 5.6, 0.6], [7.0, 2.4, 0.7], [7.6, 5.6, 0.6], [9.6, 4.0, 0.5]])


def save_cover(path: Path, moment: int = 95) -> Path:
    """Drive through a few discs, draw the run and the decision of step `moment`, and write it as a PNG."""
    world = World(discs=DISCS, bounds=(0.0, 12.0, 0.0, 7.0))
    controller = dwa.Controller(THESIS, dwa.TABLE_4_1, keep=True)
    run = simulate.run(world, THESIS, controller, [0.7, 0.7, 0.5], [11.2, 6.2], t_max=60.0)
    blit = Blit((9.0, 3.8))
    left, right = blit.figure.subplots(1, 2, width_ratios=[1.6, 1.0])
    draw_run(left, world, run, title=f"{run.status} after {run.duration:.1f} s and {run.length:.1f} m")
    arcs = arc_mark(left, dwa.TABLE_4_1.sim_time)
    arcs.place(controller.plans[moment], run.poses[moment])
    draw_robot(left, run.poses[moment], THESIS.radius)
    draw_path(left, run.poses[: moment + 1])
    speeds = np.vstack([np.zeros(2), run.commands])
    draw_window(right, controller.plans[moment], speeds[moment], THESIS, dwa.TABLE_4_1)
    right.set_title("the speeds it weighed at that moment")
    path.write_bytes(blit.png(None, level=9))
    return path
