"""The planners of chapter 07 on common seeded scenes: how each ends, and what each ingredient is worth.

Four endings, never one: reached, hit (contact while moving), struck (a mover ran into the robot at rest), late. A case
is a text 'robot/movers/planner/seed'. A robot that has not moved for a minute counts as late.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from fuzzynav.fusion.decision import Params
from fuzzynav.fusion.guide import Planning
from fuzzynav.fusion.methods import METHODS, ours
from fuzzynav.fusion.protocol import TIMED, measure
from fuzzynav.fusion.scenes import ROBOTS, scene_task
from fuzzynav.fusion.task import Method, Task
from fuzzynav.planning.astar import ENHANCED
from fuzzynav.studies.study import Study

__all__ = [
    "BRAKES", "FEW", "FIRST", "INGREDIENTS", "PLANNERS", "REPLANNING", "SCENE_STUDIES", "SEEDS", "SOME",
    "braking_cases", "comparison_cases", "ingredient_cases", "outcome", "outcome_braking", "rival_cases", "step_times",
    "task_of", "time_cases",
]  # fmt: skip

FIRST = 20_000  # no scene from this one on was looked at before the planners were fixed
SEEDS, SOME = 1000, 300  # scenes of every planner, and of what stands beside them
FEW = 100  # scenes of each ingredient and of each brake
BRAKES = (0.2, 0.3, 0.5, 0.8, 1.2, 1.8, 2.5)  # [m/s^2]
WAIT = 60.0  # [s] at rest until a run is late
NEVER = float("inf")
REPLANNING = "A* + DWA, replanning"
INGREDIENTS: Mapping[str, Method] = {
    "the whole": ours,
    "without the guard": partial(ours, params=Params(guard=False)),
    "without prediction": partial(ours, params=Params(sim_time=0.0)),
    "without both": partial(ours, params=Params(guard=False, sim_time=0.0)),
    "without the map's additions": partial(ours, planning=Planning(enters=False)),
    "one search only": partial(ours, planning=Planning(every=NEVER, check=NEVER, patience=NEVER)),
    "no ways round movers": partial(ours, planning=Planning(patience=NEVER)),
    "no room beside movers": partial(ours, params=Params(reserve=0.0, aside=0.01)),
    "no cap of the arc": partial(ours, params=Params(cap=False)),
    "unseen may hide movers": partial(ours, params=Params(hidden=True)),
    "enhanced A* of eq 4.4": partial(ours, planning=Planning(options=ENHANCED)),
    "thesis weights": partial(ours, params=Params(weights=(0.05, 0.2, 0.3, 0.2))),
}
PLANNERS: Mapping[str, Method] = {
    **{name: method for name, method in METHODS.items() if not name.startswith("ours")},
    REPLANNING: partial(ours, params=Params(guard=False, sim_time=0.0), planning=Planning(patience=NEVER)),
    "ours": ours,
}


def task_of(case: str) -> Task:
    """The scene of a case; movers: "yield" or "blind", and "scans" where no one tells where they are."""
    robot, movers, _, seed = case.split("/")
    task = scene_task(int(seed), robot=ROBOTS[robot], ideal="scans" not in movers, courteous="yield" in movers)
    return replace(task, loop=replace(task.loop, stall_time=WAIT))


def outcome(case: str) -> dict[str, Any]:
    """How one planner ends on one scene."""
    name = case.split("/")[2]
    return _row(case, task_of(case), INGREDIENTS[name] if name in INGREDIENTS else PLANNERS[name])


def outcome_braking(case: str) -> dict[str, Any]:
    """How our planner ends with a TurtleBot2 that brakes by the third part of the case [m/s^2]; all else is its own."""
    task, brake = task_of(case), float(case.split("/")[2])
    return _row(case, replace(task, robot=replace(task.robot, dec_lim_x=brake)), ours)


def step_times(case: str) -> dict[str, Any]:
    """Median and 99th percentile [ms] of what a planner takes for one step of a run."""
    robot, movers, planner, seed = case.split("/")
    found = measure(task_of(case), PLANNERS[planner])
    return {"robot": robot, "movers": movers, "planner": planner, "seed": int(seed)} | {c: found[c] for c in TIMED}


def _row(case: str, task: Task, method: Method) -> dict[str, Any]:
    """The columns that are kept."""
    found = measure(task, method)
    robot, movers, planner, seed = case.split("/")
    kept = ("ending", "status", "time", "length", "optimum", "clearance", "steps")
    return {"robot": robot, "movers": movers, "planner": planner, "seed": int(seed)} | {
        name: _rounded(found[name]) for name in kept
    }


def _rounded(value: Any) -> Any:
    """Six digits after the point are more than any of it means."""
    return round(float(value), 6) if isinstance(value, float | np.floating) else value


def _cases(rows: list[tuple[str, str, str, int]], first: int = FIRST) -> tuple[str, ...]:
    """The cases of rows robot, movers, planner and how many scenes from the first on."""
    return tuple(f"{robot}/{movers}/{name}/{first + k}" for robot, movers, name, count in rows for k in range(count))


def rival_cases() -> tuple[str, ...]:
    """Every other planner on every scene, with either robot, movers that yield and an ideal tracker."""
    rivals = [name for name in PLANNERS if name not in ("ours", REPLANNING)]
    return _cases([(robot, "yield", name, SEEDS) for robot in ROBOTS for name in rivals])


def comparison_cases() -> tuple[str, ...]:
    """Ours on every scene, movers told or tracked; on some among blind movers, without guard and prediction."""
    rows = [(robot, movers, "ours", SEEDS) for robot in ROBOTS for movers in ("yield", "yield scans")]
    rows += [(robot, "blind", "ours", SOME) for robot in ROBOTS]
    rows += [(robot, "yield", REPLANNING, SOME) for robot in ROBOTS]
    return _cases(rows)


def ingredient_cases() -> tuple[str, ...]:
    """Each ingredient left out, on scenes of its own, with the TurtleBot2."""
    rows = [("turtlebot2", movers, "the whole", FEW) for movers in ("yield", "yield scans")]
    for name in INGREDIENTS:
        if name != "the whole":
            rows.append(("turtlebot2", "yield scans" if "hide" in name else "yield", name, FEW))
    return _cases(rows, FIRST + 2000)


def braking_cases() -> tuple[str, ...]:
    """The TurtleBot2 with other brakes, among movers that yield and among blind ones."""
    rows = [("turtlebot2", movers, str(brake), FEW) for movers in ("yield", "blind") for brake in BRAKES]
    return _cases(rows, FIRST + 3000)


def time_cases() -> tuple[str, ...]:
    """Every planner on a few scenes, for the clock."""
    rows = [("turtlebot2", "yield", name, 10) for name in PLANNERS]
    return _cases([*rows, ("turtlebot2", "yield scans", "ours", 10)], FIRST + 4000)


CHOICES = {"scenes": "edition 1", "robot radius [m]": 0.3, "speed bound [m/s]": 0.5, "t_max [s]": 300.0}
SCENE_STUDIES = (
    Study(name="fusion_rivals", experiment=outcome, cases=rival_cases(), parameters=CHOICES),
    Study(name="fusion_scenes", experiment=outcome, cases=comparison_cases(), parameters=CHOICES),
    Study(name="fusion_ingredients", experiment=outcome, cases=ingredient_cases(), parameters=CHOICES),
    Study(name="fusion_braking", experiment=outcome_braking, cases=braking_cases(), parameters=CHOICES),
    Study(name="fusion_times", experiment=step_times, cases=time_cases(), parameters=CHOICES, timed=TIMED),
)
