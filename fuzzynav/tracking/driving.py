"""A tracker in closed loop with the kinematic robot, its limits and its disturbances.

The laws of the course run compiled, along the same steps that the loop in Python takes for any other law.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array
from fuzzynav.robot import limits_of
from fuzzynav.robot.kernels import drive, limit
from fuzzynav.simulate.disturbance import UNDISTURBED, Disturbance
from fuzzynav.simulate.record import Run
from fuzzynav.tracking import kernels
from fuzzynav.tracking.dfl import Dfl, Flatness
from fuzzynav.tracking.laws import Kanayama, Pid, Sliding
from fuzzynav.tracking.lqr import Lqr
from fuzzynav.tracking.records import POSE, Given, Made
from fuzzynav.tracking.tracker import Tracker, seen

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
    compiled False runs the same steps in Python. Raises ValueError for a start that is not finite, or a duration
    shorter than one step.
    """
    dt = tracker.dt
    span = tracker.reference.duration if duration is None else duration
    steps = min(int(np.floor(span / dt + 1e-9)), tracker.steps) if np.isfinite(span) else 0
    if steps < 1:
        raise ValueError(f"the duration must be finite and at least one step of {dt} s, got {span}")
    wanted = np.stack([tracker.rows[name][: steps + 1] for name in POSE], axis=-1)
    pose = wanted[0] if start is None else np.array(start, dtype=float)
    if pose.shape != (3,) or not np.isfinite(pose).all():
        raise ValueError(f"start must be a finite pose x, y, theta, got {pose.tolist()}")
    given = Given(*disturbance.draws(steps, dt, rng), round(disturbance.delay / dt), euler)
    made = Made(np.empty((steps + 1, 3)), np.empty((steps, 2)), np.empty((steps, 2)))
    made.poses[0] = pose
    code, plant = COMPILED.get(type(tracker.law)), disturbance.plant(tracker.robot)
    if compiled and code is not None and tracker.observer is None:
        state = tracker.start()
        kernels.run(code, state.gains, state.memory.copy(), tracker.rows, plant, given, made)
    else:
        _run(tracker, plant, given, made)
    fine = np.isfinite(made.poses).all() and np.abs(made.poses[:, :2]).max() < 1e6
    return Run(
        t=dt * np.arange(steps + 1.0),
        poses=made.poses,
        commands=made.commands,
        clearance=np.full(steps, np.inf),
        log={"wanted": wanted, "driven": made.driven},
        status="done" if fine else "diverged",
        radius=tracker.robot.radius,
    )


def _run(tracker: Tracker, plant: Array, given: Given, made: Made) -> None:
    """The loop of `kernels.run`, for laws that are not compiled."""
    lim, robot, dt = limits_of(tracker.robot)[0], plant[0], tracker.dt
    tracker.reset()
    pose, last = made.poses[0].copy(), np.array([tracker.rows[0].v, tracker.rows[0].omega])
    wheels = (last[0] + np.array([0.5, -0.5]) * last[1] * robot.track) / robot.wheel_radius
    first = last.copy()
    for k in range(len(made.commands)):
        wish = tracker(seen(k * dt, pose + given.noise[k], last))
        last = np.array(limit(wish[0], wish[1], last[0], last[1], lim, dt))
        made.commands[k] = last
        acting = made.commands[k - given.late] if k >= given.late else first
        drive(pose, wheels, acting, given.slip[k], robot, dt, given.euler, made.driven[k])
        made.poses[k + 1] = pose
