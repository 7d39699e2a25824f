"""Compiled: the samples of a window, what they need to stop, their scores, and the choice among them.

`lim` is one record of `robot.kernels.LIMITS`, `settings` one of SETTINGS.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fuzzynav.dwa.contact import (
    STILL,
    Chart,
    arc_contact,
    end_clearance,
    field_at,
    field_contact,
    near_points,
    polygon_contact,
)
from fuzzynav.dwa.moving import Moving, moving_contact, moving_end, near_moving
from fuzzynav.geometry import Array
from fuzzynav.robot.kernels import LIMITS, arc, clip, reach

__all__ = [
    "ADMISSIBLE",
    "NO_STOP",
    "NO_TURN_STOP",
    "NUMBERS",
    "PRINTED_SPEED",
    "PRINTED_TURN",
    "SETTINGS",
    "UNSEEN",
    "best_of",
    "brake",
    "braking",
    "decide",
    "end_heading",
    "is_blind",
    "shared",
    "stopping",
    "window",
]  # fmt: skip

Reasons = NDArray[np.int64]

SLACK = 0.01  # [m], [rad] a way into the unseen is this much shorter: no creeping through the skin, step by step
TIE = 1e-9  # totals nearer than this are equal: processors differ in the last digit
ADMISSIBLE, NO_STOP, NO_TURN_STOP, PRINTED_SPEED, PRINTED_TURN, UNSEEN = range(6)

SETTINGS = np.dtype(
    (
        np.record,
        [
            ("dt", "f8"),  # [s]
            ("sim_time", "f8"),  # [s]
            ("v_resolution", "f8"),  # [m/s]
            ("omega_resolution", "f8"),  # [rad/s]
            ("d_max", "f8"),  # [m]
            ("margin", "f8"),  # [m]
            ("reaction", "f8"),  # [s]
            ("thinnest", "f8"),  # [m]
            ("at_end", "?"),  # scored is the clearance at the end of the arc
            ("as_printed", "?"),  # admissible is what eq 3.15 says as printed
            ("blind", "?"),  # what no beam has crossed counts as occupied
        ],
    )
)

NUMBERS = (
    "dt", "sim_time", "v_resolution", "omega_resolution", "d_max", "margin", "reaction", "thinnest",
)  # fmt: skip  # the settings that are fields of Params


class Ground(NamedTuple):
    """What is in the way of a robot at `pose`; rows of points as `near_points` gives them, in the body frame."""

    pose: Array
    near: Array  # what was sensed, and stands
    moving: Moving  # what was sensed and moves
    ends: Array  # border of what was seen: ends of beams and lines of sight past edges
    gaps: Array  # border of what was seen: gaps between beams
    chart: Chart
    nearest: float  # [m] from the rim to what was sensed or charted


class Way(NamedTuple):
    """How far one sample may go [m]; [rad] for a footprint that turns in place."""

    free: float  # to the first contact with what was sensed or charted
    seen: float  # to the end of what the beams have crossed
    unseen: float  # to ground that no beam came near
    end: float  # [m] clearance at the end of the arc, where it is asked for
    need: float  # [m] to a stop
    struck: bool  # something that moves meets the robot while it brakes


@njit(cache=True)
def _span(low: float, high: float, step: float) -> Array:
    """Both ends, equal steps of at most `step` between them, and zero; mirrored ends give mirrored values."""
    count = max(int(np.ceil((high - low) / step - 1e-9)), 0)
    zero = low < -1e-12 and high > 1e-12
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
def braking(v: float, omega: float, lim: Any) -> float:
    """Deceleration [m/s^2] along the arc: the wheel that must also stop turning may allow less than the full one."""
    b = lim.loss
    if abs(omega) * b > lim.spin * abs(v):
        b = lim.spin * abs(v) / abs(omega)
    return float(b)


@njit(cache=True)
def brake(v: float, omega: float, lim: Any, dt: float) -> tuple[float, float]:
    """The emergency candidate: full braking on the same arc."""
    if abs(v) <= STILL:
        step = lim.spin * dt
        return 0.0, 0.0 if abs(omega) <= step else omega - np.sign(omega) * step
    b = braking(v, omega, lim) * dt
    if abs(v) <= b:
        return 0.0, 0.0
    slower = v - np.sign(v) * b
    return slower, omega * (slower / v)


@njit(cache=True)
def stopping(v: float, deceleration: float, dt: float) -> float:
    """Distance [m] travelled by |v| held for dt and then lowered by deceleration dt in every further step."""
    v = abs(v)
    drop = deceleration * dt
    if v <= STILL or drop <= 0.0:
        return 0.0
    m = np.ceil(v / drop - 1e-12) - 1.0
    return float(dt * (v * (1.0 + m) - 0.5 * drop * m * (m + 1.0)))


@njit(cache=True)
def window(v: float, omega: float, lim: Any, settings: Any) -> Array:
    """Samples (n, 2) of the window; the last one is the emergency candidate."""
    down, up, right, left = reach(v, omega, lim, settings.dt)
    vs = _span(clip(lim.v_low, down, up), clip(lim.v_high, down, up), settings.v_resolution)
    ws = _span(clip(-lim.omega, right, left), clip(lim.omega, right, left), settings.omega_resolution)
    out = np.empty((vs.size * ws.size + 1, 2))
    k = 0
    for a in vs:
        for b in ws:
            out[k, 0] = a if abs(a) > STILL else 0.0
            out[k, 1] = b
            k += 1
    out[k, 0], out[k, 1] = brake(v, omega, lim, settings.dt)
    return out


@njit(cache=True)
def end_heading(v: float, omega: float, goal_x: float, goal_y: float, sim_time: float) -> float:
    """180 minus the angle [deg] between the final heading and the direction to the goal."""
    x, y, turn = arc(0.0, 0.0, 0.0, v, omega, sim_time)
    dx, dy = goal_x - x, goal_y - y
    c, s = np.cos(turn), np.sin(turn)
    return 180.0 - abs(float(np.degrees(np.arctan2(c * dy - s * dx, c * dx + s * dy))))


@njit(cache=True)
def _reason(v: float, omega: float, way: Way, lim: Any, settings: Any, polygon: bool) -> int:
    """Why a sample is refused; ADMISSIBLE if it is not."""
    if settings.as_printed:
        if v > np.sqrt(2.0 * way.end * lim.loss):
            return PRINTED_SPEED
        return PRINTED_TURN if omega > np.sqrt(2.0 * way.end * lim.spin) else ADMISSIBLE
    if abs(v) <= STILL:
        need = stopping(omega, lim.spin, settings.dt) if polygon else 0.0
        if need > min(way.free, way.seen):
            return NO_TURN_STOP
        return UNSEEN if need > way.unseen else ADMISSIBLE
    need = way.need + abs(v) * settings.reaction + settings.margin
    if need > min(way.free, way.seen) or way.struck:
        return NO_STOP
    return UNSEEN if need > way.unseen else ADMISSIBLE


@njit(cache=True)
def is_blind(samples: Array, reasons: Reasons) -> bool:
    """Whether every sample that drives (every sample, where none does) is refused because too little was told."""
    drives, told = False, False
    for i in range(samples.shape[0]):
        if abs(samples[i, 0]) > STILL:
            drives = True
            if reasons[i] < UNSEEN:
                return False
        told = told or reasons[i] < UNSEEN
    return drives or not told


@njit(cache=True)
def shared(raw: Array, rated: NDArray[np.bool_], weights: Array) -> tuple[Array, Array]:
    """Shares (eq 3.21) and totals (eq 3.17, 4.15) of the samples that are rated; 0 and nan for the others."""
    n, terms = raw.shape
    shares, totals = np.zeros((n, terms)), np.full(n, np.nan)
    for j in range(terms):
        whole = 0.0
        for i in range(n):
            whole += raw[i, j] if rated[i] else 0.0
        for i in range(n):
            if rated[i] and whole > 0.0:
                shares[i, j] = raw[i, j] / whole
    for i in range(n):
        if rated[i]:
            totals[i] = 0.0
            for j in range(terms):
                totals[i] += weights[j] * shares[i, j]
    return shares, totals


@njit(cache=True)
def best_of(totals: Array, samples: Array) -> int:
    """Index of the greatest total, of equal ones the fastest and then the straightest; -1 where all are nan."""
    top, best = -np.inf, -1
    for i in range(totals.size):
        if totals[i] > top:
            top = totals[i]
    for i in range(totals.size):
        if not totals[i] >= top - TIE:
            continue
        if (
            best < 0
            or samples[i, 0] > samples[best, 0] + TIE
            or (abs(samples[i, 0] - samples[best, 0]) <= TIE and abs(samples[i, 1]) < abs(samples[best, 1]) - TIE)
        ):
            best = i
    return best


@njit(cache=True)
def _contact(v: float, omega: float, near: Array, corners: Array) -> float:
    """Travel until the robot, a polygon or the disc, first touches one of the points."""
    return polygon_contact(v, omega, near, corners) if corners.shape[0] else arc_contact(v, omega, near)


@njit(cache=True)
def _meet(v: float, omega: float, moving: Moving, corners: Array, lim: Any, settings: Any) -> tuple[float, bool]:
    """When [s] the robot first meets something that moves if it holds its speed, and whether it does while it brakes.

    What counts is the horizon, or the time to a stop where that is longer. A speed that falls once every dt stays
    within loss dt^2/4 of one that falls evenly from dt/2 on.
    """
    loss = braking(v, omega, lim) if abs(v) > STILL else 0.0
    hold = 0.5 * settings.dt + settings.reaction
    stop = hold + abs(v) / loss if loss > 0.0 else 0.0
    until = max(settings.sim_time, stop)
    time = moving_contact(v, omega, moving, corners, np.inf, 0.0, until, 0.0)
    if loss == 0.0:
        return time, False
    more = settings.margin + 0.25 * loss * settings.dt * settings.dt
    return time, moving_contact(v, omega, moving, corners, hold, loss, stop, more) < np.inf


@njit(cache=True)
def _rate(
    samples: Array, goal: Array, ground: Ground, corners: Array, lim: Any, settings: Any
) -> tuple[Array, Array, Reasons]:
    """Raw scores, ways (contact, known free way, end clearance, stopping) and the reason of refusal of each sample.

    A sample that stands still has no arc: its way to first contact is the clearance around it.
    """
    n = samples.shape[0]
    raw, ways, reasons = np.empty((n, 3)), np.empty((n, 4)), np.empty(n, dtype=np.int64)
    pose, near, moving, ends, gaps, chart, nearest = ground
    c, s = np.cos(pose[2]), np.sin(pose[2])
    gx, gy = c * (goal[0] - pose[0]) + s * (goal[1] - pose[1]), c * (goal[1] - pose[1]) - s * (goal[0] - pose[0])
    for i in range(n):
        v, omega = samples[i, 0], samples[i, 1]
        need = stopping(v, braking(v, omega, lim), settings.dt)
        free, seen = _contact(v, omega, near, corners), _contact(v, omega, ends, corners)
        unseen = max(_contact(v, omega, gaps, corners) - SLACK, 0.0)
        if chart.values.size:
            far = max(settings.d_max, need + abs(v) * settings.reaction + settings.margin)
            charted, uncharted = field_contact(v, omega, pose, chart, lim.radius, far)
            if uncharted:
                unseen = min(unseen, charted)
            else:
                free = min(free, charted)
        end = np.inf
        if settings.at_end or settings.as_printed:
            end = end_clearance(v, omega, near, pose, chart, lim.radius, settings.sim_time)
            end = min(end, moving_end(v, omega, moving, settings.sim_time))
        time, struck, stands = np.inf, False, free
        if moving.rows.shape[0]:
            time, struck = _meet(v, omega, moving, corners, lim, settings)
            free = min(free, abs(v) * time) if abs(v) > STILL else free
        ways[i, 0], ways[i, 1], ways[i, 2], ways[i, 3] = free, min(free, seen, unseen), end, need
        way = Way(stands, seen, unseen, end, need, struck)
        reasons[i] = _reason(v, omega, way, lim, settings, corners.shape[0] > 0)
        raw[i, 0] = end_heading(v, omega, gx, gy, settings.sim_time)
        clear = max(nearest, 0.0) if abs(v) <= STILL else free
        clear = 0.0 if abs(v) <= STILL and time < np.inf else clear
        raw[i, 1] = min(end if settings.at_end else clear, settings.d_max)
        raw[i, 2] = max(v, 0.0)
    return raw, ways, reasons


@njit(cache=True)
def _around(samples: Array, pose: Array, sensed: Any, chart: Chart, corners: Array, lim: Any, settings: Any) -> Ground:
    """What lies within reach: what the fastest sample could meet before it stands, or what could be scored.

    sensed: points, their velocities (none: they stand), border of what was seen, its radii, number of gaps' ones.
    """
    points, drift, border, radii, holes = sensed
    fastest = 0.0
    for i in range(samples.shape[0]):
        fastest = max(fastest, abs(samples[i, 0]))
    size = lim.radius
    for i in range(corners.shape[0]):
        size = max(size, np.sqrt(corners[i, 0] ** 2 + corners[i, 1] ** 2))
    slowest = min(lim.loss, lim.spin / lim.omega * fastest) if fastest > STILL else lim.loss
    far = max(settings.d_max, stopping(fastest, slowest, settings.dt) + fastest * settings.reaction + settings.margin)
    if settings.at_end or settings.as_printed:
        far = np.inf
    moving, beside = Moving(np.empty((0, 5)), np.empty((0, 7))), np.inf
    if drift.shape[0]:
        horizon = settings.sim_time if far < np.inf else np.inf
        for i in range(samples.shape[0]):
            v, omega = samples[i, 0], samples[i, 1]
            stop = abs(v) / braking(v, omega, lim) if abs(v) > STILL else 0.0
            horizon = max(horizon, settings.dt + settings.reaction + stop)
        way = fastest * horizon + settings.margin + lim.loss * settings.dt * settings.dt
        points, moving, beside = near_moving(pose, points, drift, size, way, horizon)
    near, nearest = near_points(pose, points, np.zeros(points.shape[0]), size, far)
    nearest = min(nearest, beside)
    gaps, _ = near_points(pose, border[:holes], radii[:holes], size, far)
    ends, _ = near_points(pose, border[holes:], radii[holes:], size, far)
    if chart.values.size:
        nearest = min(nearest, field_at(pose[0], pose[1], chart) - lim.radius)
    return Ground(pose, near, moving, ends, gaps, chart, nearest)


@njit(cache=True)
def decide(
    samples: Array, pose: Array, goal: Array, sensed: Any, charted: Any, body: Any, settings: Any, weights: Array
) -> tuple[Array, Array, Reasons, Array, Array, int, float]:
    """One decision: raw scores, ways, reasons, shares, totals, best index and the nearest point's distance.

    sensed as for the ground around; charted: values and (resolution, x, y) of a field; body: the robot's limits and
    the corners of its footprint.
    """
    values, frame = charted
    limits, corners = body
    lim, chosen = limits[0], settings[0]
    chart = Chart(values, frame[0], frame[1], frame[2])
    ground = _around(samples, pose, sensed, chart, corners, lim, chosen)
    raw, ways, reasons = _rate(samples, goal, ground, corners, lim, chosen)
    shares, totals = shared(raw, reasons == ADMISSIBLE, weights)
    best = best_of(totals, samples)
    return raw, ways, reasons, shares, totals, best, ground.nearest


def _warm() -> None:
    """Compile every kernel for the types used in practice."""
    limits = np.array([(0.0, 1.0, 0.35, 0.2, 0.2, 0.87, 0.3)], dtype=LIMITS)
    settings = np.array([(0.1, 3.0, 0.01, 0.017, 2.0, 0.0, 0.0, 0.2, False, False, True)], dtype=SETTINGS)
    none, points = np.empty((0, 2)), np.array([[2.0, 1.0]])
    samples = window(0.5, 0.1, limits[0], settings[0])
    stopping(0.5, braking(0.5, 0.1, limits[0]), 0.1)
    charted, weights = (np.empty((0, 0)), np.array([1.0, 0.0, 0.0])), np.ones(3)
    sensed = (points, none, points, np.zeros(1), 0)
    decide(samples, np.zeros(3), np.ones(2), sensed, charted, (limits, none), settings, weights)
