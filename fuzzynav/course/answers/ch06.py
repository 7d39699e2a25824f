"""The answers to the labs of chapter 06."""

from __future__ import annotations

import numpy as np

from fuzzynav import dwa, simulate
from fuzzynav.course.answers.answer import Answer
from fuzzynav.dwa.decision import Field
from fuzzynav.dwa.fast import drive
from fuzzynav.dwa.steps import Params
from fuzzynav.robot import THESIS
from fuzzynav.studies.dwa.comparison import GOAL, START, random_map
from fuzzynav.studies.fuzzy import rule_base
from fuzzynav.world import Mover, World

__all__ = ["ANSWERS"]


def _weights() -> str:
    grid = random_map("0.05/40004")
    world, field = World(grid=grid), Field.of(grid)

    def run(*weights: float) -> tuple[str, float, float]:
        made = drive(world, START, GOAL, Params(weights=weights), field=field, t_max=60.0)  # type: ignore[arg-type]
        return made.status, made.length, made.min_clearance

    stuck, fast, freed = run(0.5, 0.1, 0.1), run(0.8, 0.1, 1.0), run(0.8, 0.2, 0.1)
    return f"""With beta and gamma at 0.1 the robot stands from alpha = 0.5 on ('{stuck[0]}' after {stuck[1]:.1f}
    m): it looks at the goal, and every turn away costs more than it gains. Gamma does not free it ('{fast[0]}' even
    at 1.0). Beta does: 0.2 is enough, '{freed[0]}' after {freed[1]:.1f} m. It costs no length here;
    what it does not buy is room: the least clearance is {100 * freed[2]:.0f} cm, because the distance is scored
    along the arc and not at its end."""


def _sets() -> str:
    table = rule_base("thesis_table_3_2")
    gaps = table.uncovered(n=31)
    return f"""Not by peaks: as long as each set ends at its neighbour's peak a reach of 1 leaves
    {len(gaps.missing)} of 27 combinations without a rule, and at heading 0 and full speed nobody speaks, wherever
    the peaks stand. A reach above 1 removes the black, but then a rule for another combination answers there,
    however weakly it fires. What is missing is knowledge, not width: exercise 06.3 adds rules."""


def _obstacle() -> str:
    slowest = float(dwa.window([0.6, 0.0], THESIS)[:, 0].min())
    way = [float(dwa.stopping_distance([[v, 0.0]], THESIS, 0.1)[0]) for v in (slowest, 0.6)]
    return f"""At x = 1.45 m nearly all, and at 1.40 m all samples are refused. Take off both radii of 0.3 m, the
    robot's and the obstacle's, and about {1.45 - 0.6:.2f} m of way are left. The formula for 0.6 m/s says
    {way[1]:.2f} m; but the window also holds slower speeds, and its slowest, {slowest:.2f} m/s, stops within
    {way[0]:.2f} m. It agrees for the slowest speed that can be reached: as long as that one is admissible,
    something is."""


def _window() -> str:
    yard = World(
        discs=np.array([[5.0, 4.4, 0.8], [9.0, 10.2, 0.7], [12.0, 10.6, 0.6]]),
        rectangles=np.array([[8.0, 6.0, 1.5, 1.0, 0.4]]),
        bounds=(0, 16, 0, 16),
        movers=(Mover.patrol([(11, 7), (6, 12)], 0.4, 0.3, yield_distance=1.5),),
    )
    driver = dwa.Controller(THESIS, dwa.TABLE_4_1, keep=True)
    run = simulate.run(yard, THESIS, driver, (1, 1), (14, 14), rng=1)
    refused = np.array([1.0 - float(np.mean(plan.admissible)) for plan in driver.plans])
    slower = np.flatnonzero(np.diff(run.commands[:, 0]) < -1e-6) + 1
    near = slower[refused[slower] > 0.5]
    near = near[near < near[0] + 30]  # later ones belong to the wall behind the goal
    return f"""Between {run.t[near[0]]:.0f} and {run.t[near[-1]]:.0f} s most of the window is refused,
    {100 * refused[near].mean():.0f} % in the mean of these steps against
    {100 * np.delete(refused, near).mean():.0f} % in all others: the walker is in the way. What is left are slow
    samples and those that turn away, and the best of them is slower than now; the robot brakes before it must.
    Where it slows although little is refused the scores ask for it: a slower sample points better at the goal or
    keeps more room."""


ANSWERS = (
    Answer("06.lab1", _weights),
    Answer("06.lab2", _sets),
    Answer("06.lab3", _obstacle),
    Answer("06.lab4", _window),
)
