"""Speed of tracking blended with avoidance: one weight F, one control step of both schemes, a lap past a block."""

import time
from statistics import median

import numpy as np

from fuzzynav import blend
from fuzzynav.control import Observation
from fuzzynav.tracking.reference import FigureEight
from fuzzynav.world import World

EIGHT, TOP = FigureEight(duration=blend.LAP), np.array([0.0, 1.9, 0.2, 0.3, 0.0])


def timed(action, repeats):
    """Median seconds of an action, and its last result."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        result = action()
        times.append(time.perf_counter() - begin)
    return median(times), result


def row(task, unit, ours, peer=None, peer_name="no installed program does this", agreement=""):
    return {
        "task": task,
        "unit": unit,
        "ours": ours,
        "peer": peer,
        "peer_name": peer_name,
        "ratio": None if peer is None else peer / ours,
        "agreement": agreement,
    }


def weight_row():
    """F at one point against scikit-fuzzy, built from the same rule base."""
    from skfuzzy import control

    system = blend.table_5_1()
    simulation = control.ControlSystemSimulation(system.to_skfuzzy(), cache=False)

    def theirs():
        simulation.input["distObs"], simulation.input["thetaObs"] = 0.6, 0.2
        simulation.compute()
        return simulation.output["F"]

    ours, value = timed(lambda: system(0.6, 0.2)[0], 300)
    peer, other = timed(theirs, 30)
    return row(
        "weight F of table 5.1, one point",
        "us",
        1e6 * ours,
        1e6 * peer,
        "scikit-fuzzy",
        f"F differs by {abs(float(value) - other):.1e}",
    )


def step_row(name, law):
    """Median time of controller(observation) beside the block."""
    world, t = World(rectangles=[TOP]), np.arange(200, 300) * 0.1
    observations = []
    for now in t:
        pose = EIGHT.sample(now).pose
        ranges = world.cast(pose, blend.BEAMS, 2.0)
        at, far = pose[2] + blend.BEAMS, ranges < 2.0
        points = pose[:2] + ranges[far, None] * np.stack([np.cos(at[far]), np.sin(at[far])], axis=-1)
        observations.append(Observation(time=now, pose=pose, velocity=np.zeros(2), goal=np.zeros(2), points=points))
    feed = iter(observations * 3)
    return row(f"control step, {name}", "us", 1e6 * timed(lambda: law(next(feed)), 200)[0])


def rows():
    """One dict for each task."""
    made = [
        weight_row(),
        step_row("printed blend", blend.PrintedBlend(EIGHT)),
        step_row("safe blend", blend.SafeBlend(EIGHT)),
    ]
    for name, scheme in (("printed blend", blend.PrintedScheme(gate=np.pi / 2)), ("safe blend", blend.SafeScheme())):
        seconds, run = timed(lambda scheme=scheme: blend.drive(scheme, TOP), 10)
        made.append(
            row(
                f"one lap past a block, {name}",
                "ms",
                1e3 * seconds,
                agreement=f"{run.t[-1] / seconds:.0f} simulated seconds a second",
            )
        )
    return made
