"""The controller object that carries a tracking law and its reference."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.control import Controller, Observation
from fuzzynav.geometry import Array
from fuzzynav.robot import TURTLEBOT2, Robot
from fuzzynav.tracking.kernels import REST, STATES, _law, limits_of
from fuzzynav.tracking.observers import Observer
from fuzzynav.tracking.reference import Reference

__all__ = ["Tracker", "seen"]

NO_RATES = np.full(2, np.nan)
NOWHERE, NOTHING = np.full(2, np.nan), np.empty((0, 2))


def seen(time: float, pose: Array, velocity: Array) -> Observation:
    """What a tracker needs of an observation: time [s], pose (3,), v and omega (2,); no goal and no obstacles."""
    return Observation(time=time, pose=pose, velocity=velocity, goal=NOWHERE, points=NOTHING)


class Tracker(Controller):
    """A controller that follows a reference: `tracker(observation)` is the command, `reset()` forgets the run.

    The reference is tabulated once at the control step dt [s]; after its end the command is zero. Beneath lies
    the pure `step(state, pose, row)`. Raises ValueError for a dt that is not positive, and for a reference that
    jumps, that is not finite, or that never moves.
    """

    kind: int = -1  # a law of one's own overrides `step` and keeps this
    observer: Observer | None = None  # estimates derivatives where a law wants them

    def __init__(self, reference: Reference, vector: ArrayLike, robot: Robot = TURTLEBOT2, dt: float = 0.1) -> None:
        if not (np.isfinite(dt) and dt > 0):
            raise ValueError(f"dt must be positive and finite, got {dt}")
        self.reference, self.robot, self.dt = reference, robot, float(dt)
        self.vector = np.asarray(vector, dtype=float)
        self.limits = limits_of(robot)
        self.steps = int(np.floor(reference.duration / dt + 1e-9))
        self.rows = reference.rows(np.arange(self.steps + 1) * dt)
        _smooth(self.rows, dt)
        self.state = self.start()

    def start(self) -> Array:
        """The state before the first step."""
        return np.zeros(STATES)

    def reset(self) -> None:
        """Forget the run before."""
        self.state = self.start()

    def row(self, t: float) -> Array:
        """The reference at time t [s] as the laws read it: x, y, dx, dy, ddx, ddy, theta, v, omega."""
        k = round(t / self.dt)
        if 0 <= k <= self.steps and abs(t - k * self.dt) < 1e-9:
            return self.rows[k]
        return self.reference.rows(np.array([t]))[0]

    def step(self, state: Array, pose: ArrayLike, row: Array, rates: Array = NO_RATES) -> tuple[Array, Array]:
        """Command (2,) and next state from a state, a pose and a row of the reference; nothing is kept.

        rates: estimated dx/dt, dy/dt [m/s] for the laws that feed them back; nan lets them use their own speed.
        """
        s, out = state.copy(), np.zeros(2)
        _law(self.kind, self.vector, s, np.asarray(pose, dtype=float), rates, row, self.dt, self.limits, out)
        return out, s

    def __call__(self, observation: Observation) -> Array:
        """Command (v [m/s], omega [rad/s]) for this observation; raises ValueError for a pose that is not finite."""
        pose = np.asarray(observation.pose, dtype=float)
        if not np.isfinite(pose).all():
            raise ValueError(f"the measured pose is not finite: {pose.tolist()}")
        if observation.time > self.reference.duration + 1e-9:
            return np.zeros(2)
        command, self.state = self.step(self.state, pose, self.row(observation.time))
        return command


def _smooth(rows: Array, dt: float) -> None:
    """Raise ValueError for a reference that is not finite, never moves or jumps between two steps."""
    if not np.isfinite(rows).all():
        raise ValueError(f"the reference is not finite at t = {dt * np.argwhere(~np.isfinite(rows))[0, 0]:.3g} s")
    speed = np.abs(rows[:, 7])
    if not speed.max() > REST:
        raise ValueError("the reference has zero speed throughout: there is nothing to track")
    gap = np.hypot(*np.diff(rows[:, :2], axis=0).T)
    excess = gap - 2.0 * dt * np.maximum(speed[:-1], speed[1:]) - 0.01
    if len(gap) and excess.max() > 0:
        k = int(excess.argmax())
        raise ValueError(f"the reference jumps by {gap[k]:.3g} m at t = {dt * k:.3g} s, where v = {speed[k]:.3g} m/s")
