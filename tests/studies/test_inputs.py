"""Printed parameters that the ledger calls inputs: changing one changes a run, and there is a test for every one."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fuzzynav import blend, potential, published, tracking
from fuzzynav.fuzzy import Rule
from fuzzynav.planning import astar
from fuzzynav.robot import PIONEER_3DX, TURTLEBOT2, Robot, accelerations
from fuzzynav.studies.blend.claims import FITTED, SIMULATION_BLOCK
from fuzzynav.studies.fuzzy import planner
from fuzzynav.studies.planning.maps import SCENES_4
from fuzzynav.studies.tracking.claims import GAINS, SIMULATION

START = np.array([0.3, -0.2, 0.4])  # off the reference, so that the gains have work


def tracked(reference: Any = SIMULATION, gains: Any = GAINS, dt: float = 0.1) -> np.ndarray:
    run = tracking.follow(tracking.Tracker(reference, gains, TURTLEBOT2, dt=dt), START, euler=True)
    return run.poses[round(3.0 / dt)]


def stretched(reference: Any, **change: float) -> np.ndarray:
    run = tracking.follow(tracking.Tracker(replace(reference, **change), GAINS, TURTLEBOT2, dt=0.1), euler=True)
    return np.append(run.poses[-1], run.t[-1])


def saturated(robot: Robot) -> np.ndarray:
    """Three metres and half a turn off: what the limits let the robot do in ten seconds."""
    law = tracking.Tracker(SIMULATION, tracking.Dfl(kp1=9.0, kp2=9.0, kd1=5.0, kd2=5.0), robot, dt=0.1)
    return tracking.follow(law, [3.0, -2.0, 2.5], duration=10.0).poses


def passed(**change: float) -> np.ndarray:
    scheme = replace(FITTED, **change)
    return blend.drive(scheme, SIMULATION_BLOCK, reference=SIMULATION, limited=False, euler=True).poses


def searched(start: tuple[int, int], goal: tuple[int, int]) -> np.ndarray:
    return astar.search(SCENES_4["M2"].grid, start, goal, astar.OPTIMAL).cells


def followed(gains: Any = None, steps: Any = None, ends: Any = ((0.0, 0.0), (8.0, 8.0))) -> np.ndarray:
    """A walk past two points that bends, and takes its iterations."""
    points = potential.discs([[4.6, 4.1], [3.6, 5.7]])
    made = potential.walk(*ends, points, gains or potential.IMPROVED, steps or potential.AS_PRINTED)
    return np.append(made.places[:: max(made.iterations // 50, 1)][:50], made.iterations)


def answer(**change: Any) -> np.ndarray:
    return np.array(replace(planner(), **change)(0.8, 0.3, 0.5))


def bounded(output: int, high: float) -> np.ndarray:
    v = planner().outputs[output]
    scale = high / v.high
    terms = tuple(replace(t, parameters=tuple(scale * p for p in t.parameters)) for t in v.terms)
    outputs = list(planner().outputs)
    outputs[output] = replace(v, high=high, terms=terms)
    return answer(outputs=tuple(outputs))


def without_a_rule() -> np.ndarray:
    block = planner().blocks[0]
    return answer(blocks=(replace(block, rules=tuple(r for r in block.rules if r is not strongest())),))


def strongest() -> Rule:
    return planner().rules[int(np.argmax(planner().evaluate(0.8, 0.3, 0.5).firing))]


def whirled(robot: Robot) -> np.ndarray:
    """Avoidance asks for a turn of 20 rad/s that the robot cannot make."""
    scheme = replace(FITTED, turn=20.0)
    return blend.drive(scheme, SIMULATION_BLOCK, reference=SIMULATION, robot=robot, limited=True).commands


def machine(robot: Robot, name: str) -> tuple[Callable[[], Any], Callable[[], Any]]:
    changed = replace(robot, **{name: 0.8 * getattr(robot, name)})
    if name == "mass":
        return lambda: accelerations([0.2, 0.1], robot), lambda: accelerations([0.2, 0.1], changed)
    if name == "max_vel_theta":
        return lambda: whirled(robot), lambda: whirled(changed)
    return lambda: saturated(robot), lambda: saturated(changed)


FIELDS = {"weight": "mass", "max_speed": "max_vel_x", "rotation_speed": "max_vel_theta"}
RUNS: dict[str, tuple[Callable[[], Any], Callable[[], Any]]] = {
    "thesis:c-5.2-dt": (tracked, lambda: tracked(dt=0.05)),
    "thesis:c-5.2-T": (lambda: stretched(SIMULATION), lambda: stretched(SIMULATION, duration=100.0)),
    "thesis:c-5.2-a": (lambda: stretched(SIMULATION), lambda: stretched(SIMULATION, amplitude=1.9)),
    **{
        f"thesis:c-5.2-{name}": (tracked, lambda name=name: tracked(gains=replace(GAINS, **{name: 1.2})))
        for name in ("kp1", "kp2", "kd1", "kd2")
    },
    **{
        f"thesis:c-5.4-{robot}-{what}": machine(model, field)
        for robot, model in (("TurtleBot2", TURTLEBOT2), ("Pioneer", PIONEER_3DX))
        for what, field in FIELDS.items()
    },
    "thesis:c-5.5rule": (passed, lambda: passed(turn=0.9)),
    "thesis:c-5-fov": (passed, lambda: passed(gate=np.pi / 4.0)),
    "thesis:c-4.4-startgoal": (lambda: searched((2, 2), (17, 18)), lambda: searched((2, 3), (17, 18))),
    **{
        f"fuzzy-apf:c-2-{name}": (
            followed,
            lambda field=field, value=value: followed(gains=replace(potential.IMPROVED, **{field: value})),
        )
        for name, field, value in (("att", "attract", 3.0), ("rep", "repel", 10.0), ("rho", "influence", 3.0))
    },
    "fuzzy-apf:c-2-step": (followed, lambda: followed(steps=replace(potential.AS_PRINTED, step=0.02))),
    "fuzzy-apf:c-2-max": (followed, lambda: followed(steps=replace(potential.AS_PRINTED, most=500))),
    "fuzzy-apf:c-2-start": (followed, lambda: followed(ends=((1.0, 0.0), (8.0, 8.0)))),
    "fuzzy-apf:c-2-end": (followed, lambda: followed(ends=((0.0, 0.0), (8.0, 7.0)))),
    "fuzzy-planner:c-sigma": (answer, lambda: np.array(planner(0.15)(0.8, 0.3, 0.5))),
    "fuzzy-planner:c-rules": (answer, without_a_rule),
    "fuzzy-planner:c-vb": (answer, lambda: bounded(0, 1.1)),
    "fuzzy-planner:c-wb": (answer, lambda: bounded(1, 80.0)),
}


def test_every_input_of_the_ledger_has_its_run() -> None:
    assert {row.claim for row in published.ledger() if row.verdict == "input"} == set(RUNS)


@pytest.mark.parametrize("claim", RUNS)
def test_changing_an_input_changes_a_run(claim: str) -> None:
    as_printed, changed = (np.asarray(run(), dtype=float) for run in RUNS[claim])
    assert np.array_equal(as_printed, np.asarray(RUNS[claim][0](), dtype=float)), "the run itself is not repeatable"
    assert as_printed.shape != changed.shape or np.abs(as_printed - changed).max() > 1e-3, claim
