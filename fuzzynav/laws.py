"""The tracking laws as compiled steps, and the controller object that carries one of them.

Every law has the same shape: parameters, state, measured pose and one row of the reference give a command
and the next state. `dfl`, `rivals` and `lqr` say what each law is; here it only runs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array
from fuzzynav.observers import Observer
from fuzzynav.reference import Reference
from fuzzynav.robot import TURTLEBOT2, Robot

if TYPE_CHECKING:
    from fuzzynav.world import Observation

__all__ = ["Tracker", "limits_of"]

DFL, FLATNESS, KANAYAMA, PID, LQR, SLIDING, MPC = range(7)
STATES = 6  # room that the largest state needs
REST = 1e-9  # [m/s] as in reference: slower has no direction


@njit(cache=True)
def _wrap(angle: float) -> float:
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


@njit(cache=True)
def _clip(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


@njit(cache=True)
def _sense(v: float, before: float) -> float:
    """Direction of travel of the reference, +1 or -1; at rest the one before."""
    if v > REST:
        return 1.0
    if v < -REST:
        return -1.0
    return 1.0 if before == 0.0 else before


@njit(cache=True)
def _flat_law(
    p: Array, s: Array, pose: Array, rates: Array, row: Array, dt: float, lim: Array, linear: bool, out: Array
) -> None:
    """p: kp1, kd1, kp2, kd2, v_min, rest_radius, v0; s: compensator speed, direction, started."""
    if s[2] == 0.0:
        s[0] = row[7] if np.isnan(p[6]) else p[6]
        s[2] = 1.0
    s[1] = _sense(row[7], s[1])
    c, sn = np.cos(pose[2]), np.sin(pose[2])
    dx, dy = s[0] * c, s[0] * sn
    if not np.isnan(rates[0]):
        dx, dy = rates[0], rates[1]
    if abs(row[7]) <= REST and row[4] ** 2 + row[5] ** 2 <= REST**2:
        if np.hypot(row[0] - pose[0], row[1] - pose[1]) <= p[5]:
            s[0] = 0.0
            out[0], out[1] = 0.0, 0.0
            return
    u1 = row[4] + p[0] * (row[0] - pose[0]) + p[1] * (row[2] - dx)
    u2 = row[5] + p[2] * (row[1] - pose[1]) + p[3] * (row[3] - dy)
    if linear:
        c, sn = np.cos(row[6]), np.sin(row[6])
    gain, loss = (lim[3], lim[4]) if s[0] >= 0.0 else (lim[4], lim[3])
    zeta = _clip(u1 * c + u2 * sn, -loss, gain)
    if s[1] > 0.0:
        s[0] = _clip(s[0] + dt * zeta, max(lim[0], 0.0), lim[1])
    else:
        s[0] = _clip(s[0] + dt * zeta, lim[0], 0.0)
    divisor = row[7] if linear else s[0]
    if abs(divisor) < p[4]:
        divisor = s[1] * p[4]
    out[0] = s[0]
    out[1] = (u2 * c - u1 * sn) / divisor


@njit(cache=True)
def _error(pose: Array, row: Array, e: Array) -> None:
    """Tracking error in the robot's frame: ahead, left, heading."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    dx, dy = row[0] - pose[0], row[1] - pose[1]
    e[0], e[1], e[2] = c * dx + s * dy, -s * dx + c * dy, _wrap(row[6] - pose[2])


@njit(cache=True)
def _kanayama(p: Array, e: Array, row: Array, out: Array) -> None:
    """p: k1, k2, k3."""
    out[0] = row[7] * np.cos(e[2]) + p[0] * e[0]
    out[1] = row[8] + p[1] * row[7] * e[1] + p[2] * np.sin(e[2])


@njit(cache=True)
def _pid(p: Array, s: Array, e: Array, row: Array, dt: float, lim: Array, out: Array) -> None:
    """p: kp, ki, kd of v, kp, ki, kd of omega, k_y, feed-forward 0 or 1; s: 2 integrals, 2 errors, started, sense."""
    s[5] = _sense(row[7], s[5])
    errors = (e[0], e[2] + s[5] * p[6] * e[1])
    bounds = ((lim[0], lim[1]), (-lim[2], lim[2]))
    for k in range(2):
        now = errors[k]
        rate = (now - s[2 + k]) / dt if s[4] != 0.0 else 0.0
        total = s[k] + dt * now
        base = p[7] * row[7 + k] + p[3 * k] * now + p[3 * k + 2] * rate
        value = base + p[3 * k + 1] * total
        if bounds[k][0] <= value <= bounds[k][1] or (value - base) * now < 0.0:
            s[k] = total
        out[k] = base + p[3 * k + 1] * s[k]
        s[2 + k] = now
    s[4] = 1.0


@njit(cache=True)
def _lqr(p: Array, pose: Array, row: Array, out: Array) -> None:
    """p: number of speeds n, first speed, step, then n gain matrices row by row; error in the reference's frame."""
    n = int(p[0])
    position = _clip((abs(row[7]) - p[1]) / p[2], 0.0, n - 1.0)
    k = min(int(position), n - 2) if n > 1 else 0
    part = position - k if n > 1 else 0.0
    c, s = np.cos(row[6]), np.sin(row[6])
    dx, dy = pose[0] - row[0], pose[1] - row[1]
    sense = 1.0 if row[7] >= 0.0 else -1.0
    e = (c * dx + s * dy, -s * dx + c * dy, _wrap(pose[2] - row[6]))
    for i in range(2):
        total = 0.0
        for j in range(3):
            low = p[3 + 6 * k + 3 * i + j]
            gain = low + part * (p[3 + 6 * (k + 1) + 3 * i + j] - low) if n > 1 else low
            # driving backwards mirrors the plane: the gain from sideways error to yaw rate changes sign
            total += (sense if i == 1 and j == 1 else 1.0) * gain * e[j]
        out[i] = row[7 + i] - total


@njit(cache=True)
def _sliding(p: Array, e: Array, row: Array, out: Array) -> None:
    """p: k1, phi1, k2, phi2, c."""
    sense = 1.0 if row[7] >= 0.0 else -1.0
    slope = sense * p[4] / (1.0 + (p[4] * e[1]) ** 2)
    s2 = _wrap(e[2] + sense * np.arctan(p[4] * e[1]))
    reach = row[8] + slope * row[7] * np.sin(e[2]) + p[2] * _clip(s2 / p[3], -1.0, 1.0)
    out[1] = reach / max(1.0 + slope * e[0], 0.2)
    out[0] = row[7] * np.cos(e[2]) + out[1] * e[1] + p[0] * _clip(e[0] / p[1], -1.0, 1.0)


@njit(cache=True)
def _law(
    kind: int, p: Array, s: Array, pose: Array, rates: Array, row: Array, dt: float, lim: Array, out: Array
) -> None:
    """One step of law `kind`: changes the state s and the command out."""
    e = np.empty(3)
    _error(pose, row, e)
    if kind == DFL or kind == FLATNESS:
        _flat_law(p, s, pose, rates, row, dt, lim, kind == FLATNESS, out)
    elif kind == KANAYAMA:
        _kanayama(p, e, row, out)
    elif kind == PID:
        _pid(p, s, e, row, dt, lim, out)
    elif kind == LQR:
        _lqr(p, pose, row, out)
    elif kind == SLIDING:
        _sliding(p, e, row, out)
    out[0] = _clip(out[0], lim[0], lim[1])
    out[1] = _clip(out[1], -lim[2], lim[2])


def limits_of(robot: Robot) -> Array:
    """The limits `(6,)` of a robot as the kernels read them: v low, v high, omega, gain, loss of v, of omega."""
    return np.array([robot.min_vel_x, robot.max_vel_x, robot.max_vel_theta,
                     robot.acc_lim_x, robot.dec_lim_x, robot.acc_lim_theta])


NO_RATES = np.full(2, np.nan)


class Tracker:
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


def _warm() -> None:
    """Compile every law with the types used in practice."""
    row, lim = np.array([0.1, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0, 0.2, 0.0]), limits_of(TURTLEBOT2)
    for kind in range(MPC):
        p = np.ones(9)
        _law(kind, p, np.zeros(STATES), np.zeros(3), NO_RATES, row, 0.1, lim, np.zeros(2))
