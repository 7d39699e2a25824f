"""Thesis 4 among unknown and moving obstacles: the printed fusion for hundreds of ways to place them.

Table 4.3 gives one length for each map. Where the two unknown squares and the movers of figures 4.8 and 4.9 stood,
how large and how fast they were, is not printed. Ours: two squares of 1 m and two movers of radius 0.5 m, both near the
path of the enhanced A*, drawn from a seed. A case is a text 'map/seed'.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from fuzzynav import simulate
from fuzzynav.control import Controller
from fuzzynav.dwa.controller import Controller as Window
from fuzzynav.fusion.objective import WEIGHTS
from fuzzynav.fusion.printed import PRINTED, Cured, Printed
from fuzzynav.fusion.subgoals import global_path, pruned
from fuzzynav.fusion.task import Task
from fuzzynav.geometry import Array, cumulative_length
from fuzzynav.planning import astar
from fuzzynav.robot import THESIS
from fuzzynav.sensors import Laser
from fuzzynav.simulate.record import Run
from fuzzynav.studies.fusion.settings import AS_PRINTED
from fuzzynav.studies.planning.maps import SCENES_4
from fuzzynav.world import Mover, World

__all__ = [
    "CASES",
    "EQUAL",
    "MAPS",
    "METHODS",
    "PLACEMENTS",
    "drive",
    "one_placement",
    "path_on",
    "placed",
    "planner",
    "task_of",
]

MAPS = {"M1": ("M1", "M1 Manhattan"), "M2": ("M2", "M2 cut")}  # our versions of the two printed maps
PLACEMENTS = 250  # on each version, 500 on each printed map
CASES = tuple(f"{name}/{seed}" for names in MAPS.values() for name in names for seed in range(PLACEMENTS))
EQUAL = (0.2, 0.2, 0.2, 0.2)
METHODS = ("fusion", "fusion, no orbit", "fusion, no orbit, equal", "TDWA")  # the last but one: all weights EQUAL
HALF = 0.5  # [m] half a side of an unknown square, radius of a mover
SPEEDS = (0.2, 0.35)  # [m/s] of the movers
WAYS = (2.0, 4.0)  # [m] that a mover walks to and fro
KEPT = 1.5  # [m] around start and goal stays free of them
SEES = Laser(beams=120, field_of_view=2.0 * np.pi, range_min=0.0, range_max=10.0, noise=0.0)
TIME_LIMIT = 120.0  # [s]


@cache
def path_on(name: str) -> Array:
    """The path `(n, 2)` [m] of the enhanced A* on one of our maps, its key nodes in the centres of cells."""
    scene = SCENES_4[name]
    start, goal = scene.grid.center_of([scene.start, scene.goal])
    return global_path(scene.grid, start, goal, replace(astar.ENHANCED, safety_radius=scene.safety_radius), pruned)


def placed(case: str) -> World:
    """The world of one placement: two unknown squares and two movers near the path of the enhanced A*."""
    name, seed = case.split("/")
    grid, rng = SCENES_4[name].grid, np.random.default_rng([sum(map(ord, name)), int(seed)])
    squares: list[Array] = []
    while len(squares) < 2:
        spot = _beside(path_on(name), rng, 1.0)
        center = grid.center_of(grid.cell_of(spot))
        taken = any((center == other).all() for other in squares)
        if not (taken or grid.is_occupied(center) or _at_an_end(name, center)):
            squares.append(center)
    movers: list[Mover] = []
    while len(movers) < 2:
        spot, turn, way = _beside(path_on(name), rng, 0.5), rng.uniform(-np.pi, np.pi), rng.uniform(*WAYS)
        walk = spot + 0.5 * way * np.outer([-1.0, 1.0], [np.cos(turn), np.sin(turn)])
        speed = float(rng.uniform(*SPEEDS))
        if not any(_at_an_end(name, point) for point in np.linspace(walk[0], walk[1], 9)):
            movers.append(Mover.patrol(walk, speed, HALF))
    rows = [[*center, 2.0 * HALF, 2.0 * HALF, 0.0] for center in squares]
    return World(grid=grid, unknown_rectangles=np.array(rows), movers=tuple(movers))


def _beside(path: Array, rng: np.random.Generator, spread: float) -> Array:
    """A random point [m] beside a path."""
    along = cumulative_length(path)
    at = rng.uniform(0.0, along[-1])
    return np.array([np.interp(at, along, path[:, k]) for k in (0, 1)]) + rng.normal(0.0, spread, 2)


def _at_an_end(name: str, point: Array) -> bool:
    """Whether something of HALF around a point would stand on the start or the goal."""
    ends = path_on(name)[[0, -1]]
    return bool((np.hypot(*(ends - point).T) < KEPT + HALF).any())


def task_of(case: str) -> Task:
    """One placement as a task, with an ideal tracker: the movers are told apart from what stands."""
    name, world = case.split("/")[0], placed(case)
    path = path_on(name)
    heading = np.arctan2(*(path[1] - path[0])[::-1])
    return Task(
        name=case,
        world=world,
        robot=THESIS,
        start=np.append(path[0], heading),
        goal=path[-1],
        speed_bound=SPEEDS[1],
        chart=world.grid,
        laser=SEES,
        ideal=True,
        t_max=TIME_LIMIT,
    )


def drive(task: Task, controller: Controller) -> Run:
    """The run of one task, with ideal tracking."""
    return simulate.run(
        task.world, task.robot, controller, task.start, task.goal, dt=task.dt, t_max=task.t_max, laser=task.laser,
        track_movers=task.ideal, loop=task.loop,
    )  # fmt: skip


def planner(case: str, method: str, keep: bool = False) -> Controller:
    """A planner for one placement, by its name in METHODS."""
    name = case.split("/")[0]
    if method == "TDWA":
        return Window(THESIS, AS_PRINTED, keep=keep)
    params = replace(PRINTED, weights=EQUAL if method.endswith("equal") else WEIGHTS)
    if method == "fusion":
        return Printed(THESIS, path_on(name), params, ideal=True, keep=keep)
    return Cured(THESIS, path_on(name), SCENES_4[name].grid, params, ideal=True, keep=keep)


def one_placement(case: str) -> list[dict[str, Any]]:
    """A row for each of METHODS on one placement; traditional DWA is told of no velocity."""
    task = task_of(case)
    told = {name: replace(task, ideal=name != "TDWA") for name in METHODS}
    return [
        {"map": case.split("/")[0], "method": name, **_row(drive(told[name], planner(case, name)))} for name in METHODS
    ]


def _row(run: Run) -> dict[str, Any]:
    """What is kept of a run."""
    v, omega = run.variation if run.iterations > 1 else (0.0, 0.0)
    return {
        "success": int(run.success),
        "status": run.status,
        "length": round(run.length, 3),
        "time": round(run.duration, 1),
        "clearance": round(run.min_clearance, 3),
        "struck": run.contacts_standing,
        "variation_v": round(float(v), 3),
        "variation_omega": round(float(omega), 3),
    }
