"""The tracking laws and the closed loop as compiled steps.

Every law has the same shape: parameters, state, measured pose and one row of the reference give a command
and the next state. `dfl`, `rivals` and `lqr` say what each law is; here it only runs. Laws and loop stand in
one file, so that a change of one compiles all of them anew.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fuzzynav.geometry import Array
from fuzzynav.robot import TURTLEBOT2, Robot

__all__ = ["limits_of"]

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
    out[0] = s[0]
    if abs(divisor) >= p[4]:
        out[1] = (u2 * c - u1 * sn) / divisor
    else:  # near rest the turn fades over to the heading of the reference, which needs no division
        part = abs(divisor) / p[4]
        turn = row[8] + 0.5 * (p[1] + p[3]) * _wrap(row[6] - pose[2])
        out[1] = (u2 * c - u1 * sn) / (s[1] * p[4]) + (1.0 - part) * turn


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


@njit(cache=True)
def _sampled(v: float, omega: float, dt: float, out: Array) -> None:
    """Model numbers (15,) of one step: A row by row (9), then B row by row (6)."""
    a = omega * dt
    if abs(a) < 1e-3:  # series: the closed form would divide 0 by 0
        s, c1, r = 1.0 - a * a / 6.0, a / 2.0 - a**3 / 24.0, a / 6.0 - a**3 / 120.0
        q = 0.5 - a * a / 24.0
    else:
        s, c1, r = np.sin(a) / a, (1.0 - np.cos(a)) / a, (a - np.sin(a)) / (a * a)
        q = (1.0 - np.cos(a)) / (a * a)
    cos, sin, step = np.cos(a), np.sin(a), v * dt
    out[0], out[1], out[2] = cos, sin, step * c1
    out[3], out[4], out[5] = -sin, cos, step * s
    out[6], out[7], out[8] = 0.0, 0.0, 1.0
    out[9], out[10] = dt * s, step * dt * r
    out[11], out[12] = -dt * c1, step * dt * q
    out[13], out[14] = 0.0, dt


@njit(cache=True)
def _horizon(
    error: Array, last: Array, wanted: Array, dt: float, bounds: Array, numbers: Array, low: Array, high: Array
) -> None:
    """The numbers of one predictive program: model (15 N, negated) and the bounds of its rows (7 N).

    bounds: slowest, fastest and greatest change of a step, `(3, 2)`.
    """
    n = wanted.shape[0]
    for j in range(n):
        _sampled(wanted[j, 0], wanted[j, 1], dt, numbers[15 * j : 15 * j + 15])
    for r in range(3):
        fixed = 0.0
        for c in range(3):
            fixed += numbers[3 * r + c] * error[c]
        low[r], high[r] = fixed, fixed
    for j in range(n):
        for r in range(2):
            before = last[r] if j == 0 else wanted[j - 1, r]
            step, k = wanted[j, r] - before, 2 * j + r
            low[3 * n + k], high[3 * n + k] = bounds[0, r] - wanted[j, r], bounds[1, r] - wanted[j, r]
            low[5 * n + k], high[5 * n + k] = -bounds[2, r] - step, bounds[2, r] - step
    for k in range(15 * n):
        numbers[k] = -numbers[k]


def limits_of(robot: Robot) -> Array:
    """The limits `(6,)` of a robot as the kernels read them: v low, v high, omega, gain, loss of v, of omega."""
    return np.array(
        [robot.min_vel_x, robot.max_vel_x, robot.max_vel_theta, robot.acc_lim_x, robot.dec_lim_x, robot.acc_lim_theta]
    )


@njit(cache=True)
def _limit(wish: Array, last: Array, lim: Array, dt: float) -> None:
    """Limits of speed and acceleration as in robot.limit; changes `wish`."""
    v = last[0]
    gain, loss, ratio = lim[3] * dt, lim[4] * dt, lim[3] / lim[4]
    if v >= 0.0:
        up = v + gain
    else:
        up = v + loss if v + loss <= 0.0 else (v + loss) * ratio
    if v <= 0.0:
        down = v - gain
    else:
        down = v - loss if v - loss >= 0.0 else (v - loss) * ratio
    wish[0] = min(max(min(max(wish[0], lim[0]), lim[1]), down), up)
    step = lim[5] * dt
    wish[1] = min(max(min(max(wish[1], -lim[2]), lim[2]), last[1] - step), last[1] + step)


@njit(cache=True)
def _drive(
    pose: Array,
    wheels: Array,
    command: Array,
    slip: Array,
    body: Array,
    plant: Array,
    dt: float,
    euler: bool,
    driven: Array,
) -> None:
    """One step of the robot: motor lag, slip, wrong radii, exact arc or Euler. Changes pose, wheels, driven.

    body: wheel radius, track, motor lag; plant: relative radius errors right and left.
    """
    half = command[1] * body[1] / 2.0
    follow = 1.0 if body[2] == 0.0 else 1.0 - np.exp(-dt / body[2])
    wheels[0] += follow * ((command[0] + half) / body[0] - wheels[0])
    wheels[1] += follow * ((command[0] - half) / body[0] - wheels[1])
    right = wheels[0] * body[0] * (1.0 + plant[0]) * (1.0 - slip[0])
    left = wheels[1] * body[0] * (1.0 + plant[1]) * (1.0 - slip[1])
    v, turn = (right + left) / 2.0, (right - left) / body[1] * dt
    driven[0], driven[1] = v, turn / dt
    if euler:
        pose[0] += v * dt * np.cos(pose[2])
        pose[1] += v * dt * np.sin(pose[2])
    else:
        chord = v * dt if turn == 0.0 else v * dt * np.sin(turn / 2.0) / (turn / 2.0)
        pose[0] += chord * np.cos(pose[2] + turn / 2.0)
        pose[1] += chord * np.sin(pose[2] + turn / 2.0)
    pose[2] = _wrap(pose[2] + turn)


@njit(cache=True)
def _run(
    kind: int,
    p: Array,
    rows: Array,
    start: Array,
    noise: Array,
    slip: Array,
    lag_steps: int,
    body: Array,
    plant: Array,
    lim: Array,
    dt: float,
    euler: bool,
    poses: Array,
    commands: Array,
    driven: Array,
) -> None:
    """A whole run of one law; fills poses, commands, driven."""
    s, out, seen, rates = np.zeros(STATES), np.zeros(2), np.empty(3), np.full(2, np.nan)
    pose, last = start.copy(), rows[0, 7:9].copy()
    wheels = np.empty(2)
    wheels[0] = (last[0] + last[1] * body[1] / 2.0) / body[0]
    wheels[1] = (last[0] - last[1] * body[1] / 2.0) / body[0]
    first = last.copy()
    poses[0] = pose
    for k in range(commands.shape[0]):
        for i in range(3):
            seen[i] = pose[i] + noise[k, i]
        _law(kind, p, s, seen, rates, rows[k], dt, lim, out)
        _limit(out, last, lim, dt)
        last[0], last[1] = out[0], out[1]
        commands[k] = out
        acting = commands[k - lag_steps] if k >= lag_steps else first
        _drive(pose, wheels, acting, slip[k], body, plant, dt, euler, driven[k])
        poses[k + 1] = pose


def _warm() -> None:
    """Compile every law and the loop with the types used in practice."""
    row, lim = np.array([0.1, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0, 0.2, 0.0]), limits_of(TURTLEBOT2)
    for kind in range(MPC):
        p = np.ones(9)
        _law(kind, p, np.zeros(STATES), np.zeros(3), np.full(2, np.nan), row, 0.1, lim, np.zeros(2))
    rows = np.tile(row, (3, 1))
    noise, slip, body = np.zeros((2, 3)), np.zeros((2, 2)), np.array([0.035, 0.23, 0.0])
    made = np.empty((3, 3)), np.empty((2, 2)), np.empty((2, 2))
    _run(KANAYAMA, np.ones(9), rows, np.zeros(3), noise, slip, 0, body, np.zeros(2), lim, 0.1, False, *made)
    rows, numbers = np.ascontiguousarray(rows[:2, 7:9]), np.empty(30)
    _horizon(np.zeros(3), np.zeros(2), rows, 0.1, np.zeros((3, 2)), numbers, np.zeros(14), np.zeros(14))
