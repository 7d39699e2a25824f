"""Compiled loops of the dynamic window: samples, braking, scores, choice.

`limits` is the
array of max_vel_x, min_vel_x, max_vel_theta, acc_lim_x, dec_lim_x, acc_lim_theta, radius; `settings` that of
dt, sim_time, v_resolution, omega_resolution, d_max, margin, reaction.
"""

# mypy: disallow_untyped_defs = False
from __future__ import annotations

import numpy as np
from numba import njit

from fuzzynav.dwa.contact import (
    STILL,
    _arc_contact,
    _arc_pose,
    _end_clearance,
    _field_at,
    _field_contact,
    _near,
    _polygon_contact,
)

__all__: list[str] = []

TIE = 1e-9  # totals nearer than this are equal: processors differ in the last digit
ADMISSIBLE, NO_STOP, NO_TURN_STOP, PRINTED_SPEED, PRINTED_TURN = 0, 1, 2, 3, 4


@njit(cache=True)
def _span(low, high, step, add_zero):
    """Both ends, equal steps of at most `step` between them, and zero; mirrored ends give mirrored values."""
    count = max(int(np.ceil((high - low) / step - 1e-9)), 0)
    zero = add_zero and low < -1e-12 and high > 1e-12
    out = np.empty(count + 1 + int(zero))
    k = 0
    for i in range(count + 1):
        value = ((count - i) * low + i * high) / count if count > 0 else low
        if zero and value > -1e-12 and k == i:
            out[k] = 0.0
            k += 1
            if value < 1e-12:
                zero = False
                continue
        out[k] = value
        k += 1
    return out[:k]


@njit(cache=True)
def _braking(v, omega, limits):
    """Deceleration [m/s^2] along the arc: the wheel that must also stop turning may allow less than dec_lim_x."""
    b = limits[4]
    if abs(omega) * b > limits[5] * abs(v):
        b = limits[5] * abs(v) / abs(omega)
    return b


@njit(cache=True)
def _brake(v, omega, limits, dt):
    """The emergency candidate: full braking on the same arc."""
    if abs(v) <= STILL:
        step = limits[5] * dt
        return 0.0, 0.0 if abs(omega) <= step else omega - np.sign(omega) * step
    b = _braking(v, omega, limits) * dt
    if abs(v) <= b:
        return 0.0, 0.0
    slower = v - np.sign(v) * b
    return slower, omega * (slower / v)


@njit(cache=True)
def _stopping(v, deceleration, dt):
    """Distance [m] travelled by |v| held for dt and then lowered by deceleration dt in every further step."""
    v = abs(v)
    drop = deceleration * dt
    if v <= STILL or drop <= 0.0:
        return 0.0
    m = np.ceil(v / drop - 1e-12) - 1.0
    return dt * (v * (1.0 + m) - 0.5 * drop * m * (m + 1.0))


@njit(cache=True)
def _reachable(v, omega, limits, dt):
    """Ends of the window: lowest and highest v, lowest and highest omega after dt; as `robot.limit` clips."""
    gain, loss, step = limits[3] * dt, limits[4] * dt, limits[5] * dt
    ratio = limits[3] / limits[4]
    up = v + gain if v >= 0.0 else (v + loss if v + loss <= 0.0 else (v + loss) * ratio)
    down = v - gain if v <= 0.0 else (v - loss if v - loss >= 0.0 else (v - loss) * ratio)
    low, high = min(max(limits[1], down), up), min(max(limits[0], down), up)
    right = min(max(-limits[2], omega - step), omega + step)
    left = min(max(limits[2], omega - step), omega + step)
    return low, high, right, left


@njit(cache=True)
def _window(v, omega, limits, settings):
    """Samples (n, 2) of the window; the last one is the emergency candidate."""
    dt = settings[0]
    low, high, right, left = _reachable(v, omega, limits, dt)
    vs = _span(low, high, settings[2], True)
    ws = _span(right, left, settings[3], True)
    out = np.empty((vs.size * ws.size + 1, 2))
    k = 0
    for a in vs:
        for b in ws:
            out[k, 0] = a if abs(a) > STILL else 0.0
            out[k, 1] = b
            k += 1
    out[k, 0], out[k, 1] = _brake(v, omega, limits, dt)
    return out


@njit(cache=True)
def _heading(v, omega, goal_x, goal_y, sim_time):
    """180 minus the angle [deg] between the final heading and the direction to the goal."""
    x, y, turn = _arc_pose(v, omega, sim_time)
    dx, dy = goal_x - x, goal_y - y
    c, s = np.cos(turn), np.sin(turn)
    return 180.0 - abs(np.degrees(np.arctan2(c * dy - s * dx, c * dx + s * dy)))


@njit(cache=True)
def _reason(v, omega, free, end, limits, settings, printed, polygon):
    """Why a sample is refused; ADMISSIBLE if it is not."""
    if printed:
        if v > np.sqrt(2.0 * end * limits[4]):
            return PRINTED_SPEED
        return PRINTED_TURN if omega > np.sqrt(2.0 * end * limits[5]) else ADMISSIBLE
    if abs(v) <= STILL:
        return NO_TURN_STOP if polygon and _stopping(omega, limits[5], settings[0]) > free else ADMISSIBLE
    need = _stopping(v, _braking(v, omega, limits), settings[0]) + abs(v) * settings[6] + settings[5]
    return NO_STOP if need > free else ADMISSIBLE


@njit(cache=True)
def _choose(raw, reasons, samples, weights):
    """Shares of eq 3.21, totals of eq 3.17 and the index of the best admissible sample (-1: there is none)."""
    n = samples.shape[0]
    shares, totals = np.zeros((n, 3)), np.full(n, np.nan)
    best, top = -1, -np.inf
    for j in range(3):
        whole = 0.0
        for i in range(n):
            whole += raw[i, j] if reasons[i] == ADMISSIBLE else 0.0
        for i in range(n):
            if reasons[i] == ADMISSIBLE and whole > 0.0:
                shares[i, j] = raw[i, j] / whole
    for i in range(n):
        if reasons[i] == ADMISSIBLE:
            totals[i] = weights[0] * shares[i, 0] + weights[1] * shares[i, 1] + weights[2] * shares[i, 2]
            top = max(top, totals[i])
    for i in range(n):
        if reasons[i] != ADMISSIBLE or totals[i] < top - TIE:
            continue
        if (
            best < 0
            or samples[i, 0] > samples[best, 0] + TIE
            or (abs(samples[i, 0] - samples[best, 0]) <= TIE and abs(samples[i, 1]) < abs(samples[best, 1]) - TIE)
        ):
            best = i
    return shares, totals, best


@njit(cache=True)
def _rate(samples, pose, goal, near, blind, field, frame, corners, limits, settings, modes, nearest):
    """Raw scores, ways (contact, known free way, end clearance, stopping) and the reason of refusal of each sample.

    modes: [distance is END, bound is as printed]. A sample that stands still has no arc: its way to first contact is
    the clearance around it.
    """
    n = samples.shape[0]
    raw, ways, reasons = np.empty((n, 3)), np.empty((n, 4)), np.empty(n, dtype=np.int64)
    c, s = np.cos(pose[2]), np.sin(pose[2])
    gx, gy = c * (goal[0] - pose[0]) + s * (goal[1] - pose[1]), c * (goal[1] - pose[1]) - s * (goal[0] - pose[0])
    for i in range(n):
        v, omega = samples[i, 0], samples[i, 1]
        need = _stopping(v, _braking(v, omega, limits), settings[0])
        if corners.shape[0]:
            free = _polygon_contact(v, omega, near, corners)
            known = min(free, _polygon_contact(v, omega, blind, corners))
        else:
            free = _arc_contact(v, omega, near)
            known = min(free, _arc_contact(v, omega, blind))
        if field.size:
            reach = max(settings[4], need + abs(v) * settings[6] + settings[5])
            free = min(free, _field_contact(v, omega, pose, field, frame, limits[6], reach))
            known = min(known, free)
        end = np.inf
        if modes[0] or modes[1]:
            end = _end_clearance(v, omega, near, field, frame, pose, limits[6], settings[1])
        ways[i, 0], ways[i, 1], ways[i, 2], ways[i, 3] = free, known, end, need
        reasons[i] = _reason(v, omega, known, end, limits, settings, modes[1], corners.shape[0] > 0)
        raw[i, 0] = _heading(v, omega, gx, gy, settings[1])
        raw[i, 1] = min(end if modes[0] else (max(nearest, 0.0) if abs(v) <= STILL else free), settings[4])
        raw[i, 2] = max(v, 0.0)
    return raw, ways, reasons


@njit(cache=True)
def _plan(
    samples, pose, goal, points, blind_points, blind_radii, field, frame, corners, limits, settings, modes, weights
):
    """One decision: raw scores, ways, reasons, shares, totals, best index and the nearest point's distance."""
    fastest = 0.0
    for i in range(samples.shape[0]):
        fastest = max(fastest, abs(samples[i, 0]))
    size = limits[6]
    for i in range(corners.shape[0]):
        size = max(size, np.sqrt(corners[i, 0] ** 2 + corners[i, 1] ** 2))
    slowest = min(limits[4], limits[5] / limits[2] * fastest) if fastest > STILL else limits[4]
    reach = max(settings[4], _stopping(fastest, slowest, settings[0]) + fastest * settings[6] + settings[5])
    if modes[0] or modes[1]:
        reach = np.inf
    near, nearest = _near(pose, points, np.zeros(points.shape[0]), size, reach)
    blind, _ = _near(pose, blind_points, blind_radii, size, reach)
    if field.size:
        nearest = min(nearest, _field_at(pose[0], pose[1], field, frame[0], frame[1], frame[2]) - limits[6])
    raw, ways, reasons = _rate(
        samples, pose, goal, near, blind, field, frame, corners, limits, settings, modes, nearest
    )
    shares, totals, best = _choose(raw, reasons, samples, weights)
    return raw, ways, reasons, shares, totals, best, nearest


def _warm() -> None:
    """Compile every kernel for the types used in practice."""
    pose, goal, points = np.zeros(3), np.ones(2), np.array([[2.0, 1.0]])
    limits = np.array([1.0, 0.0, 0.35, 0.2, 0.2, 0.87, 0.3])
    settings = np.array([0.1, 3.0, 0.01, 0.017, 2.0, 0.0, 0.0])
    samples = _window(0.5, 0.1, limits, settings)
    _plan(
        samples,
        pose,
        goal,
        points,
        points,
        np.zeros(1),
        np.empty((0, 0)),
        np.array([1.0, 0.0, 0.0]),
        np.empty((0, 2)),
        limits,
        settings,
        np.array([False, False]),
        np.array([0.8, 0.1, 0.1]),
    )
