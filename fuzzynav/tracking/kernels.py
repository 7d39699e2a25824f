"""The tracking laws and their closed loop as compiled steps.

Every law has the same shape: gains, memory, measured pose and one row of the reference give a command and the next
memory. `dfl`, `laws` and `lqr` say what each law is; here it only runs. The records are named in `records`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from fuzzynav.geometry import Array
from fuzzynav.robot.kernels import PLANT, clip, drive, limit, wrap
from fuzzynav.tracking.records import GAINS, MEMORY, ROW, Given, Made, Records

__all__ = ["horizon", "law", "run", "sampled", "step"]

DFL, FLATNESS, KANAYAMA, PID, LQR, SLIDING = range(6)
REST = 1e-9  # [m/s] as in reference: slower has no direction
LEAST_DIVISOR = 0.2  # of the sliding law, where omega would have no effect on its second surface


@njit(cache=True)
def _direction(v: float, before: float) -> float:
    """Direction of travel of the reference, +1 or -1; at rest the one before."""
    if v > REST:
        return 1.0
    if v < -REST:
        return -1.0
    return 1.0 if before == 0.0 else before


@njit(cache=True)
def _error(pose: Array, row: Any) -> tuple[float, float, float]:
    """Tracking error in the robot's frame: ahead [m], left [m], heading [rad]."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    dx, dy = row.x - pose[0], row.y - pose[1]
    return c * dx + s * dy, -s * dx + c * dy, wrap(row.theta - pose[2])


@njit(cache=True)
def _at_rest(gains: Any, pose: Array, row: Any) -> bool:
    """Whether reference and robot stand: no speed, no acceleration, and the robot within the rest radius."""
    if abs(row.v) > REST or row.ddx**2 + row.ddy**2 > REST**2:
        return False
    return bool(np.hypot(row.x - pose[0], row.y - pose[1]) <= gains.rest_radius)


@njit(cache=True)
def _compensated(speed: float, push: float, memory: Any) -> float:
    """The compensator's next speed [m/s] under a push [m/s^2], within the limits and never against the reference."""
    lim = memory.lim
    gain, loss = (lim.gain, lim.loss) if speed >= 0.0 else (lim.loss, lim.gain)
    moved = speed + memory.dt * clip(push, -loss, gain)
    return clip(moved, max(lim.v_low, 0.0), lim.v_high) if memory.sense > 0.0 else clip(moved, lim.v_low, 0.0)


@njit(cache=True)
def _flat_law(gains: Any, memory: Any, pose: Array, row: Any, linear: bool) -> tuple[float, float]:
    """Virtual inputs from the errors, then the compensator; linear: decoupled with the reference's heading and v."""
    if not memory.started:
        memory.speed = row.v if np.isnan(gains.v0) else gains.v0
        memory.started = True
    memory.sense = _direction(row.v, memory.sense)
    c, s = np.cos(pose[2]), np.sin(pose[2])
    dx, dy = memory.speed * c, memory.speed * s
    if not np.isnan(memory.rate_x):
        dx, dy = memory.rate_x, memory.rate_y
    if _at_rest(gains, pose, row):
        memory.speed = 0.0
        return 0.0, 0.0
    u1 = row.ddx + gains.kp1 * (row.x - pose[0]) + gains.kd1 * (row.dx - dx)
    u2 = row.ddy + gains.kp2 * (row.y - pose[1]) + gains.kd2 * (row.dy - dy)
    if linear:
        c, s = np.cos(row.theta), np.sin(row.theta)
    memory.speed = _compensated(memory.speed, u1 * c + u2 * s, memory)
    across, divisor = u2 * c - u1 * s, row.v if linear else memory.speed
    if abs(divisor) >= gains.v_min:
        return memory.speed, across / divisor
    # near rest the turn fades over to the heading of the reference, which needs no division
    part = abs(divisor) / gains.v_min
    turn = row.omega + 0.5 * (gains.kd1 + gains.kd2) * wrap(row.theta - pose[2])
    return memory.speed, across / (memory.sense * gains.v_min) + (1.0 - part) * turn


@njit(cache=True)
def _kanayama(gains: Any, pose: Array, row: Any) -> tuple[float, float]:
    ahead, left, heading = _error(pose, row)
    v = row.v * np.cos(heading) + gains.k1 * ahead
    return v, row.omega + gains.k2 * row.v * left + gains.k3 * np.sin(heading)


@njit(cache=True)
def _sum(held: float, base: float, ki: float, error: float, dt: float, low: float, high: float) -> float:
    """Integral after this error; it stops growing while the output is at the limit."""
    total = held + dt * error
    value = base + ki * total
    return total if low <= value <= high or (value - base) * error < 0.0 else held


@njit(cache=True)
def _pid(gains: Any, memory: Any, pose: Array, row: Any) -> tuple[float, float]:
    """Two channels: the error ahead gives v, the heading error and k_y times the error left give omega."""
    memory.sense = _direction(row.v, memory.sense)
    ahead, left, heading = _error(pose, row)
    turn, dt, lim = heading + memory.sense * gains.k_y * left, memory.dt, memory.lim
    rate_v = (ahead - memory.error_v) / dt if memory.started else 0.0
    rate_omega = (turn - memory.error_omega) / dt if memory.started else 0.0
    v = gains.feed_forward * row.v + gains.kp_v * ahead + gains.kd_v * rate_v
    omega = gains.feed_forward * row.omega + gains.kp_omega * turn + gains.kd_omega * rate_omega
    memory.sum_v = _sum(memory.sum_v, v, gains.ki_v, ahead, dt, lim.v_low, lim.v_high)
    memory.sum_omega = _sum(memory.sum_omega, omega, gains.ki_omega, turn, dt, -lim.omega, lim.omega)
    memory.error_v, memory.error_omega, memory.started = ahead, turn, True
    return v + gains.ki_v * memory.sum_v, omega + gains.ki_omega * memory.sum_omega


@njit(cache=True)
def _lqr(schedule: Any, pose: Array, row: Any) -> tuple[float, float]:
    """u = u_ref - K(v) e, the gain between the two nearest of its speeds; error in the reference's frame."""
    n, table = schedule.count, schedule.table
    position = clip((abs(row.v) - schedule.first) / schedule.step, 0.0, n - 1.0)
    k = min(int(position), n - 2) if n > 1 else 0
    part, other = (position - k, k + 1) if n > 1 else (0.0, 0)
    c, s = np.cos(row.theta), np.sin(row.theta)
    dx, dy = pose[0] - row.x, pose[1] - row.y
    # driving backwards mirrors the plane: the gain from sideways error to yaw rate changes sign
    sense = 1.0 if row.v >= 0.0 else -1.0
    e = (c * dx + s * dy, -s * dx + c * dy, wrap(pose[2] - row.theta))
    v, omega = 0.0, 0.0
    for j in range(3):
        v += (table[k, 0, j] + part * (table[other, 0, j] - table[k, 0, j])) * e[j]
        gain = table[k, 1, j] + part * (table[other, 1, j] - table[k, 1, j])
        omega += (sense if j == 1 else 1.0) * gain * e[j]
    return row.v - v, row.omega - omega


@njit(cache=True)
def _sliding(gains: Any, pose: Array, row: Any) -> tuple[float, float]:
    ahead, left, heading = _error(pose, row)
    sense = 1.0 if row.v >= 0.0 else -1.0
    slope = sense * gains.c / (1.0 + (gains.c * left) ** 2)
    surface = wrap(heading + sense * np.arctan(gains.c * left))
    reach = row.omega + slope * row.v * np.sin(heading) + gains.k2 * clip(surface / gains.phi2, -1.0, 1.0)
    omega = reach / max(1.0 + slope * ahead, LEAST_DIVISOR)
    return row.v * np.cos(heading) + omega * left + gains.k1 * clip(ahead / gains.phi1, -1.0, 1.0), omega


@njit(cache=True)
def law(code: int, gains: Any, memory: Any, pose: Array, row: Any) -> tuple[float, float]:
    """Command of law `code`, within the limits of speed; changes its memory."""
    v, omega = 0.0, 0.0
    if code == DFL or code == FLATNESS:
        v, omega = _flat_law(gains.dfl, memory, pose, row, code == FLATNESS)
    elif code == KANAYAMA:
        v, omega = _kanayama(gains.kanayama, pose, row)
    elif code == PID:
        v, omega = _pid(gains.pid, memory, pose, row)
    elif code == LQR:
        v, omega = _lqr(gains.lqr, pose, row)
    elif code == SLIDING:
        v, omega = _sliding(gains.sliding, pose, row)
    return clip(v, memory.lim.v_low, memory.lim.v_high), clip(omega, -memory.lim.omega, memory.lim.omega)


@njit(cache=True)
def step(code: int, gains: Records, memory: Records, after: Records, pose: Array, row: Records, out: Array) -> None:
    """One step from Python: arrays of one record, the row of no dimension; fills the memory after it and out (2,)."""
    after[0] = memory[0]
    out[0], out[1] = law(code, gains[0], after[0], pose, row[()])


@njit(cache=True)
def run(code: int, gains: Records, memory: Records, rows: Records, plant: Records, given: Given, made: Made) -> None:
    """A whole run of one law along its rows; fills poses (the first is the start), commands and driven."""
    mine, mind, robot, poses, commands = gains[0], memory[0], plant[0], made.poses, made.commands
    pose, seen, first, wheels = poses[0].copy(), np.empty(3), np.empty(2), np.empty(2)
    first[0], first[1] = rows[0].v, rows[0].omega
    wheels[0] = (first[0] + first[1] * robot.track / 2.0) / robot.wheel_radius
    wheels[1] = (first[0] - first[1] * robot.track / 2.0) / robot.wheel_radius
    v, omega = first[0], first[1]
    for k in range(commands.shape[0]):
        for i in range(3):
            seen[i] = pose[i] + given.noise[k, i]
        wish_v, wish_omega = law(code, mine, mind, seen, rows[k])
        v, omega = limit(wish_v, wish_omega, v, omega, mind.lim, mind.dt)
        commands[k, 0], commands[k, 1] = v, omega
        acting = commands[k - given.late] if k >= given.late else first
        drive(pose, wheels, acting, given.slip[k], robot, mind.dt, given.euler, made.driven[k])
        poses[k + 1] = pose


@njit(cache=True)
def sampled(v: float, omega: float, dt: float, out: Array) -> None:
    """Model numbers (15,) of one step: A row by row (9), then B row by row (6)."""
    a = omega * dt
    if abs(a) < 1e-3:  # series: the closed form would divide 0 by 0
        s, c1, r = 1.0 - a * a / 6.0, a / 2.0 - a**3 / 24.0, a / 6.0 - a**3 / 120.0
        q = 0.5 - a * a / 24.0
    else:
        s, c1, r = np.sin(a) / a, (1.0 - np.cos(a)) / a, (a - np.sin(a)) / (a * a)
        q = (1.0 - np.cos(a)) / (a * a)
    cos, sin, way = np.cos(a), np.sin(a), v * dt
    out[0], out[1], out[2] = cos, sin, way * c1
    out[3], out[4], out[5] = -sin, cos, way * s
    out[6], out[7], out[8] = 0.0, 0.0, 1.0
    out[9], out[10] = dt * s, way * dt * r
    out[11], out[12] = -dt * c1, way * dt * q
    out[13], out[14] = 0.0, dt


@njit(cache=True)
def horizon(
    error: Array, last: Array, wanted: Array, dt: float, bounds: Array, numbers: Array, low: Array, high: Array
) -> None:
    """The numbers of one predictive program: model (15 N, negated) and the bounds of its rows (7 N).

    bounds: slowest, fastest and greatest change of a step, `(3, 2)`.
    """
    n = wanted.shape[0]
    for j in range(n):
        sampled(wanted[j, 0], wanted[j, 1], dt, numbers[15 * j : 15 * j + 15])
    for r in range(3):
        fixed = 0.0
        for c in range(3):
            fixed += numbers[3 * r + c] * error[c]
        low[r], high[r] = fixed, fixed
    for j in range(n):
        for r in range(2):
            before = last[r] if j == 0 else wanted[j - 1, r]
            change, k = wanted[j, r] - before, 2 * j + r
            low[3 * n + k], high[3 * n + k] = bounds[0, r] - wanted[j, r], bounds[1, r] - wanted[j, r]
            low[5 * n + k], high[5 * n + k] = -bounds[2, r] - change, bounds[2, r] - change
    for k in range(15 * n):
        numbers[k] = -numbers[k]


def _warm() -> None:
    """Compile every law and the loop with the types used in practice."""
    gains, memory, rows, plant = np.ones(1, GAINS), np.ones(1, MEMORY), np.ones(3, ROW), np.ones(1, PLANT)
    gains["lqr"]["count"] = 1
    step(KANAYAMA, gains, memory, memory.copy(), np.zeros(3), np.asarray(rows[0]), np.zeros(2))
    given = Given(np.zeros((2, 3)), np.zeros((2, 2)), 0, False)
    run(KANAYAMA, gains, memory, rows, plant, given, Made(np.zeros((3, 3)), np.zeros((2, 2)), np.zeros((2, 2))))
    numbers, bounds = np.empty(30), np.zeros((3, 2))
    horizon(np.zeros(3), np.zeros(2), np.ones((2, 2)), 0.1, bounds, numbers, np.zeros(14), np.zeros(14))
