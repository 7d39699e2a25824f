"""The controller object that carries a tracking law along its reference."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.checks import positive
from fuzzynav.control import Controller, Observation
from fuzzynav.geometry import Array
from fuzzynav.robot import TURTLEBOT2, Robot
from fuzzynav.tracking.dfl import FlatGains
from fuzzynav.tracking.kernels import REST
from fuzzynav.tracking.law import Law, Setting
from fuzzynav.tracking.observers import Observer
from fuzzynav.tracking.records import Records
from fuzzynav.tracking.reference import Reference

__all__ = ["Tracker", "seen"]

NOWHERE, NOTHING = np.full(2, np.nan), np.empty((0, 2))
MOST_STEPS = 1_000_000  # a day at ten steps a second
MOVES = ("dx", "dy", "ddx", "ddy", "v", "omega")  # what is zero of a reference that stands


def seen(time: float, pose: Array, velocity: Array) -> Observation:
    """What a tracker needs of an observation: time [s], pose (3,), v and omega (2,); no goal and no obstacles."""
    return Observation(time=time, pose=pose, velocity=velocity, goal=NOWHERE, points=NOTHING)


class Tracker(Controller):
    """A controller that follows a reference by a law: `tracker(observation)` is the command, `reset()` forgets.

    The reference is tabulated once at the control step dt [s]; after its end the command is zero and the status
    'done'. Beneath lies the pure `step(state, pose, row)`. A law is any object with `command(state, pose, row)`:

    >>> from fuzzynav.tracking import tracking_error
    >>> class Chase:
    ...     def command(self, state, pose, row):
    ...         ahead, left, turn = tracking_error(pose, [row.x, row.y, row.theta])
    ...         return [row.v + ahead, row.omega + 2.0 * left + turn], state
    >>> from fuzzynav.tracking.reference import FigureEight
    >>> tracker = Tracker(FigureEight(), Chase())
    >>> tracker.step(tracker.start(), [0.0, 0.0, 0.0], tracker.row(0.0))[0].round(3).tolist()
    [0.224, 0.464]

    observer: estimates the derivatives that `Dfl` and `Flatness` feed back. Raises ValueError for a dt that is not
    positive, a reference that jumps, is not finite, never moves or has over a million steps, and what a law refuses.
    """

    def __init__(
        self,
        reference: Reference,
        law: Law,
        robot: Robot = TURTLEBOT2,
        dt: float = 0.1,
        *,
        observer: Observer | None = None,
    ) -> None:
        positive(dt=dt, duration=reference.duration)
        if not callable(getattr(law, "command", None)):
            raise ValueError(f"a law has a method command(state, pose, row), got {law!r}")
        if reference.duration / dt > MOST_STEPS:
            raise ValueError(
                f"a reference of {reference.duration:g} s has over {MOST_STEPS:,} steps of {dt:g} s: shorten it"
            )
        if observer is not None and not isinstance(law, FlatGains):
            raise ValueError(f"an observer serves Dfl and Flatness, which feed derivatives back, not {law}")
        self.reference, self.law, self.robot, self.dt = reference, law, robot, float(dt)
        self.steps = int(np.floor(reference.duration / dt + 1e-9))
        self.rows = reference.rows(np.arange(self.steps + 1) * dt)
        _smooth(self.rows, dt)
        self.horizon: int | None = getattr(law, "horizon", None)
        self._ahead = np.concatenate([self.rows, _held(np.repeat(self.rows[-1:], self.horizon or 0))])
        begin = getattr(law, "start", None)
        self._first = None if begin is None else begin(Setting(self.rows, robot, self.dt))
        self.observer = observer
        self.reset()

    def start(self) -> Any:
        """The state before the first step."""
        return self._first

    def reset(self) -> None:
        """Forget the run before, and what the observer knew."""
        self.state = self.start()
        self._status: str | None = None
        self._last_v: float | None = None  # [m/s] of the last command
        if self.observer is not None:
            self.observer.reset()

    @property
    def status(self) -> str | None:
        """'done' at the end of the reference."""
        return self._status

    @property
    def evidence(self) -> Mapping[str, Any]:
        """What the law's state tells of its last step."""
        told: Mapping[str, Any] = getattr(self.state, "evidence", {})
        return told

    def row(self, t: float) -> Any:
        """The reference at time t [s] as laws read it: one record, or as many rows as the law's horizon."""
        k = round(t / self.dt)
        on_grid = 0 <= k <= self.steps and abs(t - k * self.dt) < 1e-9
        if self.horizon is None:
            return self.rows[k] if on_grid else self.reference.rows(np.array([t]))[0]
        if on_grid:
            return self._ahead[k : k + self.horizon]
        times = t + np.arange(self.horizon) * self.dt
        rows = self.reference.rows(times)
        rows[times > self.reference.duration] = _held(rows[times > self.reference.duration])
        return rows

    def step(self, state: Any, pose: ArrayLike, row: Any) -> tuple[Array, Any]:
        """Command (2,) and next state from a state, a pose and a row of the reference; nothing is kept."""
        command, after = self.law.command(state, np.asarray(pose, dtype=float), row)
        return np.asarray(command, dtype=float), after

    def __call__(self, observation: Observation) -> Array:
        """Command (v [m/s], omega [rad/s]) for this observation; raises ValueError for a pose that is not finite."""
        pose, time = np.asarray(observation.pose, dtype=float), observation.time
        if not np.isfinite(pose).all():
            raise ValueError(f"the measured pose is not finite: {pose.tolist()}")
        self._status = "done" if time > (self.steps - 1) * self.dt - 1e-9 else None  # the last step begins
        if time > self.reference.duration + 1e-9:
            return np.zeros(2)
        if self.observer is not None:
            return self._observed(pose, self.row(time), self.observer)
        command, self.state = self.step(self.state, pose, self.row(time))
        return command

    def _observed(self, pose: Array, row: Any, observer: Observer) -> Array:
        """Command from measured positions and the observer's estimate alone."""
        z = observer.update(pose[:2], np.array([row.dx, row.dy]))
        state = self.state.with_rates(z[[1, 3]])
        command, self.state = self.step(state, np.array([z[0], z[2], pose[2]]), row)
        before = row.v if self._last_v is None else self._last_v
        # what the limits left of the demand is the acceleration that the observer must expect
        push, turn, speed = (command[0] - before) / self.dt, command[1], command[0]
        c, s = np.cos(pose[2]), np.sin(pose[2])
        observer.push(np.array([push * c - speed * turn * s, push * s + speed * turn * c]))
        self._last_v = float(command[0])
        return command


def _held(rows: Records) -> Records:
    """The rows of a reference that stands where they are."""
    still = rows.copy()
    for name in MOVES:
        still[name] = 0.0
    return still


def _smooth(rows: Records, dt: float) -> None:
    """Raise ValueError for a reference that is not finite, never moves or jumps between two steps."""
    fine = np.all([np.isfinite(rows[name]) for name in rows.dtype.names or ()], axis=0)
    if not fine.all():
        raise ValueError(f"the reference is not finite at t = {dt * int(np.argmin(fine)):.3g} s")
    speed = np.abs(rows["v"])
    if not speed.max() > REST:
        raise ValueError("the reference has zero speed throughout: there is nothing to track")
    gap = np.hypot(np.diff(rows["x"]), np.diff(rows["y"]))
    excess = gap - 2.0 * dt * np.maximum(speed[:-1], speed[1:]) - 0.01
    if len(gap) and excess.max() > 0:
        k = int(excess.argmax())
        raise ValueError(f"the reference jumps by {gap[k]:.3g} m at t = {dt * k:.3g} s, where v = {speed[k]:.3g} m/s")
