"""A tracker in closed loop with the kinematic robot, its limits and its disturbances.

The laws of the course run compiled; any other law, and whatever has an observer, runs in the loop of the course,
`simulate.run`. Both take the same steps.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav import simulate
from fuzzynav.geometry import Array
from fuzzynav.simulate import UNDISTURBED, Disturbance, Run
from fuzzynav.simulate.loop import FAR
from fuzzynav.tracking import kernels
from fuzzynav.tracking.dfl import Dfl, Flatness
from fuzzynav.tracking.laws import Kanayama, Pid, Sliding
from fuzzynav.tracking.lqr import Lqr
from fuzzynav.tracking.records import POSE, Given, Made
from fuzzynav.tracking.tracker import Tracker
from fuzzynav.world import World

__all__ = ["UNDISTURBED", "Disturbance", "follow"]

COMPILED: dict[type, int] = {
    Dfl: kernels.DFL,
    Flatness: kernels.FLATNESS,
    Kanayama: kernels.KANAYAMA,
    Pid: kernels.PID,
    Lqr: kernels.LQR,
    Sliding: kernels.SLIDING,
}


def follow(
    tracker: Tracker,
    start: ArrayLike | None = None,
    *,
    disturbance: Disturbance = UNDISTURBED,
    rng: np.random.Generator | int = 0,
    duration: float | None = None,
    euler: bool = False,
    compiled: bool = True,
) -> Run:
    """Drive a tracker along its reference from `start` (x, y, theta); None starts exactly on the reference.

    The robot starts with the speeds of the reference. euler: integrate as the thesis does, else along exact arcs.
    compiled False takes
    the loop of the course for every law. Raises ValueError for a start that is not finite, or a duration
    shorter than one step.
    """
    dt = tracker.dt
    span = tracker.reference.duration if duration is None else duration
    steps = min(int(np.floor(span / dt + 1e-9)), tracker.steps) if np.isfinite(span) else 0
    if steps < 1:
        raise ValueError(f"the duration must be finite and at least one step of {dt} s, got {span}")
    wanted = np.stack([tracker.rows[name] for name in POSE], axis=-1)
    pose = wanted[0] if start is None else np.array(start, dtype=float)
    if pose.shape != (3,) or not np.isfinite(pose).all():
        raise ValueError(f"start must be a finite pose x, y, theta, got {pose.tolist()}")
    code = COMPILED.get(type(tracker.law)) if compiled and tracker.observer is None else None
    if code is None:
        run = _in_the_loop(tracker, pose, steps, disturbance, rng, euler)
    else:
        given = Given(*disturbance.draws(steps, dt, rng), round(disturbance.delay / dt), euler)
        run = _compiled(code, tracker, pose, disturbance.plant(tracker.robot), given)
    return replace(run, log={**run.log, "wanted": wanted[: len(run.t)]})


def _compiled(code: int, tracker: Tracker, start: Array, plant: NDArray[Any], given: Given) -> Run:
    """The run of a compiled law."""
    steps, state = len(given.noise), tracker.start()
    made = Made(np.empty((steps + 1, 3)), np.empty((steps, 2)), np.empty((steps, 2)))
    made.poses[0] = start
    kernels.run(code, state.gains, state.memory.copy(), tracker.rows, plant, given, made)
    fine = np.isfinite(made.poses).all() and np.abs(made.poses[:, :2]).max() < FAR
    return Run(
        t=tracker.dt * np.arange(steps + 1.0),
        poses=made.poses,
        commands=made.commands,
        clearance=np.full(steps, np.inf),
        log={"driven": made.driven},
        status="done" if fine else "diverged",
        radius=tracker.robot.radius,
    )


def _in_the_loop(
    tracker: Tracker, start: Array, steps: int, disturbance: Disturbance, rng: np.random.Generator | int, euler: bool
) -> Run:
    """The same run in the loop of the course, in an empty world, nothing scanned."""
    velocity = float(tracker.rows[0].v), float(tracker.rows[0].omega)
    run = simulate.run(
        World(),
        tracker.robot,
        tracker,
        start,
        dt=tracker.dt,
        t_max=steps * tracker.dt,
        rng=rng,
        laser=None,
        disturbance=disturbance,
        loop=simulate.Loop(stall_time=np.inf, velocity=velocity, by_euler=euler),
    )
    return replace(run, status="done") if run.status == "timeout" else run
