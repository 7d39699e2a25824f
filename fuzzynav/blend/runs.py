"""A whole compiled run of a blend past one block, and what is read off it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.blend import kernels
from fuzzynav.blend.controllers import fresh_mind, weight_tables
from fuzzynav.blend.points import nearest_on
from fuzzynav.blend.records import LOG, PRINTED, SAFE, Made, Scene
from fuzzynav.blend.rules import table_5_1
from fuzzynav.blend.schemes import PrintedScheme, SafeScheme
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.geometry import Array
from fuzzynav.robot import TURTLEBOT2, Robot
from fuzzynav.simulate.record import Run
from fuzzynav.tracking.dfl import Dfl
from fuzzynav.tracking.records import POSE
from fuzzynav.tracking.reference import FigureEight, Reference
from fuzzynav.tracking.tracker import Tracker

__all__ = ["BEAMS", "LAP", "avoidance_times", "delay", "drive", "last_avoidance"]

LAP = 40.0 * np.pi  # [s] one lap of the figure eight
BEAMS = np.linspace(-np.pi, np.pi, 360, endpoint=False)  # [rad]
LATEST = 120.0  # [s] by which a detour may delay a run at most


def drive(
    scheme: PrintedScheme | SafeScheme,
    block: ArrayLike,
    *,
    reference: Reference | None = None,
    law: Dfl | None = None,
    system: FuzzySystem | None = None,
    robot: Robot = TURTLEBOT2,
    laps_with_block: float = 1.0,
    laps: float = 1.0,
    dt: float = 0.1,
    limited: bool = True,
    euler: bool = False,
) -> Run:
    """Drive a scheme round the reference past one block (x, y, width, height, theta), sensed ideally.

    A lap is 40 pi s; the block is taken away after `laps_with_block`. The printed scheme is told the exact nearest
    point of the block, the safe one sees the ends of 360 beams. The log holds `wanted`, and for each step `weight`
    (share of avoidance in the command), `F`, `avoiding`, `braked`, `predicted` clearance [m] and `index` of the
    reference. Raises ValueError for a block that touches the start.
    """
    shape = np.asarray(block, dtype=float)
    if shape.shape != (5,) or not (np.isfinite(shape).all() and (shape[2:4] > 0).all()):
        raise ValueError(f"a block is x, y, width, height, theta with positive sizes, got {shape.tolist()}")
    known = system or table_5_1()
    tables = weight_tables(known)
    tracker = Tracker(reference or FigureEight(duration=laps * LAP), law or Dfl(), robot, dt)
    wanted = np.stack([tracker.rows[name] for name in POSE], axis=-1)
    if nearest_on(shape, wanted[0, 0], wanted[0, 1], np.empty(4)) <= robot.radius:
        raise ValueError(f"the block at ({shape[0]:g}, {shape[1]:g}) touches the robot at its start")
    safe = isinstance(scheme, SafeScheme)
    most = tracker.steps + (int(LATEST / dt) if safe else 0)
    made = Made(np.empty((most + 1, 3)), np.empty((most, 2)), np.zeros(most, LOG))
    made.poses[0] = wanted[0]
    scene = Scene(shape, round(laps_with_block * LAP / dt), BEAMS, safe, limited, euler)
    schemes = (
        scheme.record(known, robot.radius) if isinstance(scheme, SafeScheme) else np.zeros(1, SAFE),
        scheme.record if isinstance(scheme, PrintedScheme) else np.zeros(1, PRINTED),
    )
    mind, state = fresh_mind(tracker), tracker.start()
    n = kernels.lap(schemes, mind, state.gains, state.memory.copy(), tracker.rows, tables, scene, made)
    return _run(tracker, wanted, made, n, int(mind["index"][0]))


def _run(tracker: Tracker, wanted: Array, made: Made, n: int, after: int) -> Run:
    """The first n steps of what was made, as a Run; `after` is the reference's index behind the last."""
    log = made.log[:n]
    collided = bool(log["clearance"][-1] <= 0.0)
    index = np.append(log["index"], min(after, tracker.steps))
    return Run(
        t=tracker.dt * np.arange(n + 1.0),
        poses=made.poses[: n + 1],
        commands=made.commands[:n],
        clearance=log["clearance"].copy(),
        log={
            "wanted": wanted[index],
            **{name: log[name].copy() for name in ("weight", "F", "avoiding", "braked", "predicted", "index")},
        },
        status="collided" if collided else "done" if index[-2] >= tracker.steps - 1 else "timeout",
        radius=tracker.robot.radius,
        contacts_moving=int(collided),
    )


def delay(run: Run) -> float:
    """Time [s] by which the reference lags behind the clock at the end of a run of `drive`."""
    index = run.log["index"]
    return float((len(index) - 1 - index[-1]) * run.dt)


def avoidance_times(run: Run) -> Array:
    """Times `(m,)` [s] of the steps in whose command avoidance had a part."""
    return run.t[:-1][run.log["weight"] > 0.0]


def last_avoidance(run: Run) -> float:
    """Time [s] after which avoidance had no more part in a command; 0 if it never had."""
    active = avoidance_times(run)
    return float(active[-1] + run.dt) if len(active) else 0.0
