"""Avoidance beside tracking, as compiled steps: the printed blend, the safe one, and the loop round both.

Obstacles are points x, y, vx, vy, rows of an array (n, 4): seen, remembered, and moving where that is known.
Parameters P and state M of the safe blend are vectors; `fusion` names their entries.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from fuzzynav.blend.points import MEMORY, _closest, _gap, _nearest_on, _remember, _sight
from fuzzynav.fuzzy.engine import infer_one
from fuzzynav.geometry import Array
from fuzzynav.robot import TURTLEBOT2
from fuzzynav.tracking.kernels import DFL, STATES, _clip, _law, _limit, _wrap, limits_of

__all__: list[str] = []

(
    ENTER,
    LEAVE,
    FOLLOW,
    ENTER_TIME,
    LEAVE_TIME,
    CRUISE,
    CREEP,
    GAIN,
    FLOOR,
    CEILING,
    AHEAD,
    STRETCH,
    LOOK,
    RATE,
    GUARD,
    FADE,
    RANGE,
    RADIUS,
    MOVING,
) = range(19)
(INDEX, LATCHED, SIDE, WEIGHT, RELEASED, LATCHES, FUZZY, GOAL, BRAKED, PREDICTED) = range(10)


@njit(cache=True)
def _weight(tables: Any, distance: float, bearing: float) -> float:
    """F of a rule base for one distance [m] and bearing [rad]; 0 where no rule fires."""
    point, value = np.array([distance, bearing]), np.empty(1)
    infer_one(tables, point, value)
    return 0.0 if np.isnan(value[0]) else _clip(value[0], 0.0, 1.0)


@njit(cache=True)
def _printed(scheme: Array, tables: Any, points: Array, n: int, pose: Array, track: Array, out: Array) -> float:
    """The printed blend for one step; scheme: half gate, d0, share of v_t in v_a, turn, hard. Returns F."""
    d, bearing = _closest(points, n, pose)
    out[0], out[1] = track[0], track[1]
    if d > scheme[1] or (scheme[4] == 0.0 and abs(bearing) > scheme[0]):
        return 0.0
    f = _weight(tables, d, bearing)
    turn = scheme[3] if bearing <= 0.0 else -scheme[3]
    if scheme[4] > 0.0:  # the hard switch: the fuzzy command alone
        out[0], out[1] = (1.0 - f) * track[0], f * turn
    else:
        out[0] = (1.0 - f) * track[0] + f * scheme[2] * track[0]
        out[1] = (1.0 - f) * track[1] + f * turn
    return f


@njit(cache=True)
def _forecast(
    p: Array,
    s: Array,
    k: int,
    rows: Array,
    pose: Array,
    last: Array,
    points: Array,
    n: int,
    time: float,
    dt: float,
    lim: Array,
) -> float:
    """Least distance [m] of the centre to the points if tracking alone drove for `time` [s]."""
    state, at, before, rates, out = s.copy(), pose.copy(), last.copy(), np.full(2, np.nan), np.zeros(2)
    least = np.inf
    for i in range(int(time / dt)):
        _law(DFL, p, state, at, rates, rows[min(k + i, rows.shape[0] - 1)], dt, lim, out)
        _limit(out, before, lim, dt)
        before[0], before[1] = out[0], out[1]
        _step(at, out, dt)
        least = min(least, _gap(points, n, at[0], at[1], (i + 1) * dt))
    return least


@njit(cache=True)
def _step(pose: Array, command: Array, dt: float) -> None:
    """The exact arc; changes pose."""
    turn, way = command[1] * dt, command[0] * dt
    chord = way if turn == 0.0 else way * np.sin(turn / 2.0) / (turn / 2.0)
    pose[0] += chord * np.cos(pose[2] + turn / 2.0)
    pose[1] += chord * np.sin(pose[2] + turn / 2.0)
    pose[2] = _wrap(pose[2] + turn)


@njit(cache=True)
def _project(rows: Array, k: int, most: int, pose: Array) -> int:
    """Index from k to k + most at which the reference is nearest to the robot."""
    best, at = np.inf, k
    for i in range(k, min(k + most, rows.shape[0] - 1) + 1):
        d = (rows[i, 0] - pose[0]) ** 2 + (rows[i, 1] - pose[1]) ** 2
        if d < best:
            best, at = d, i
    return at


@njit(cache=True)
def _rejoin(P: Array, rows: Array, k: int, points: Array, n: int, dt: float) -> int:
    """First index beyond the blocked stretch from which the reference stays clear for a while."""
    need, arc, free, first = P[RADIUS] + P[LEAVE], 0.0, 0.0, -1
    i = k
    while i < rows.shape[0] - 1 and arc < P[LOOK] + P[STRETCH]:
        if arc >= P[AHEAD] and _gap(points, n, rows[i, 0], rows[i, 1], 0.0) > need:
            first = i if first < 0 else first
            free += abs(rows[i, 7]) * dt
            if free >= P[STRETCH]:
                return first
        else:
            first, free = -1, 0.0
        arc += abs(rows[i, 7]) * dt
        i += 1
    return first if first >= 0 else i


@njit(cache=True)
def _tangent(P: Array, points: Array, n: int, pose: Array, side: float) -> float:
    """World direction that passes the points on one side (+1: they stay on the right) at the follow margin."""
    d0, bearing = _closest(points, n, pose)
    middle = _wrap(pose[2] + bearing)
    rho = P[RADIUS] + P[FOLLOW]
    most = -np.inf
    for i in range(n):
        dx, dy = points[i, 0] - pose[0], points[i, 1] - pose[1]
        d = np.hypot(dx, dy)
        if d > d0 + 1.0:
            continue
        edge = np.pi / 2.0 + min((rho - d) / 0.1, 1.0) * np.pi / 4.0 if d < rho else np.arcsin(rho / d)
        most = max(most, side * _wrap(np.arctan2(dy, dx) - middle) + edge)
    return _wrap(middle + side * most)


@njit(cache=True)
def _way_is_free(P: Array, points: Array, n: int, pose: Array, x: float, y: float) -> bool:
    """Whether the straight line to a place keeps the follow margin."""
    rho = P[RADIUS] + P[FOLLOW] - 0.005
    ux, uy = x - pose[0], y - pose[1]
    length = max(np.hypot(ux, uy), 1e-9)
    ux, uy = ux / length, uy / length
    for i in range(n):
        dx, dy = points[i, 0] - pose[0], points[i, 1] - pose[1]
        along = _clip(dx * ux + dy * uy, 0.0, length)
        if np.hypot(dx - along * ux, dy - along * uy) < rho and dx * ux + dy * uy > 0.0:
            return False
    return True


@njit(cache=True)
def _choose(P: Array, points: Array, n: int, pose: Array, row: Array) -> float:
    """The side whose boundary is the shorter way to the rejoin point; in a tie the smaller turn, then left."""
    wish = np.arctan2(row[1] - pose[1], row[0] - pose[0])
    cost = np.empty(2)
    for j in range(2):
        way = _tangent(P, points, n, pose, 1.0 - 2.0 * j)
        cost[j] = abs(_wrap(way - wish)) + 0.5 * abs(_wrap(way - pose[2]))
    return 1.0 if cost[0] <= cost[1] + 1e-6 else -1.0


@njit(cache=True)
def _guard(P: Array, points: Array, n: int, pose: Array, out: Array, away: float, lim: Array, dt: float) -> bool:
    """Brake where the arc of the next step and of braking comes too near; turn towards free ground instead."""
    start = _gap(points, n, pose[0], pose[1], 0.0)
    need = P[RADIUS] + P[GUARD]
    if P[MOVING] > 0.0:
        return _evade(points, n, pose, out, need + 0.05)
    if _ahead(points, n, pose, out[0], out[1], max(out[0], 0.0) / lim[4] + 2.0 * dt) < min(need, start - 1e-6):
        out[0] = 0.0
        out[1] = _clip(2.0 * _wrap(away - pose[2]), -lim[2], lim[2])
        return True
    return False


@njit(cache=True)
def _ahead(points: Array, n: int, pose: Array, v: float, omega: float, time: float) -> float:
    """Least distance of the centre to the points while one command is held for `time` [s]."""
    at, command, least = pose.copy(), np.array([v, omega]), np.inf
    steps = 4 if time < 1.0 else 10
    for i in range(steps):
        _step(at, command, time / steps)
        least = min(least, _gap(points, n, at[0], at[1], (i + 1) * time / steps))
    return least


@njit(cache=True)
def _evade(points: Array, n: int, pose: Array, out: Array, need: float) -> bool:
    """Where the command would let a moving point come too near within 2 s, take the motion that keeps most room."""
    best = _ahead(points, n, pose, out[0], out[1], 2.0)
    if best >= need:
        return False
    v0, w0 = out[0], out[1]
    best += 0.01  # what is wanted anyway wins a tie
    for i in range(-3, 4):
        for j in range(-2, 3):
            room = _ahead(points, n, pose, 0.12 * i, 0.7 * j, 2.0)
            room = min(room, need + 0.1) - 0.01 * abs(0.12 * i - v0) - 0.002 * abs(0.7 * j - w0)
            if room > best:
                best, out[0], out[1] = room, 0.12 * i, 0.7 * j
    return True


@njit(cache=True)
def _avoid(P: Array, M: Array, points: Array, n: int, pose: Array, row: Array, lim: Array, out: Array) -> float:
    """Command along the boundary of the inflated points, or straight to the rejoin point; returns the direction."""
    if _way_is_free(P, points, n, pose, row[0], row[1]):
        way = np.arctan2(row[1] - pose[1], row[0] - pose[0])
    else:
        way = _tangent(P, points, n, pose, M[SIDE])
    wrong = _wrap(way - pose[2])
    speed = P[CRUISE] * (1.0 - M[FUZZY]) + P[CREEP] * M[FUZZY]
    free = max(_gap(points, n, pose[0], pose[1], 0.0) - P[RADIUS] - P[GUARD], 0.0)
    out[0] = min(speed, np.sqrt(2.0 * lim[4] * free)) * max(np.cos(wrong), 0.0) ** 2
    out[1] = _clip(P[GAIN] * (1.0 + M[FUZZY]) * wrong, -lim[2], lim[2])
    return way


@njit(cache=True)
def _safe(
    P: Array,
    M: Array,
    p: Array,
    s: Array,
    tables: Any,
    rows: Array,
    points: Array,
    n: int,
    pose: Array,
    last: Array,
    time: float,
    dt: float,
    lim: Array,
    out: Array,
) -> None:
    """One step of the safe blend: changes its state M, the tracker's state s and the command out."""
    k, rates, aside = int(M[INDEX]), np.full(2, np.nan), np.zeros(2)
    if M[LATCHED] > 0.0:
        k = _project(rows, k, int(P[RATE]), pose)
        s[0] = _clip(last[0], p[4], lim[1])  # the integrator knows what was sent: nothing winds up
    d, bearing = _closest(points, n, pose)
    M[FUZZY], M[PREDICTED] = 0.0, np.inf
    if n > 0:
        raw = _weight(tables, d, bearing)
        M[FUZZY] = _clip((raw - P[FLOOR]) / max(P[CEILING] - P[FLOOR], 1e-9), 0.0, 1.0)
        span = P[LEAVE_TIME] if M[LATCHED] > 0.0 else P[ENTER_TIME]
        M[PREDICTED] = _forecast(p, s, k, rows, pose, last, points, n, span, dt, lim) - P[RADIUS]
    if M[LATCHED] > 0.0 and M[PREDICTED] > P[LEAVE]:
        M[LATCHED], M[RELEASED] = 0.0, time
    elif M[LATCHED] == 0.0 and M[PREDICTED] < P[ENTER]:
        M[GOAL] = _rejoin(P, rows, k, points, n, dt)
        if M[SIDE] == 0.0 or time - M[RELEASED] > 3.0:
            M[SIDE] = _choose(P, points, n, pose, rows[int(M[GOAL])])
        M[LATCHED] = 1.0
        M[LATCHES] += 1.0
    _law(DFL, p, s, pose, rates, rows[k], dt, lim, out)
    rise = dt / P[FADE]
    M[WEIGHT] = _clip(max(M[WEIGHT] + rise, M[FUZZY]) if M[LATCHED] > 0.0 else M[WEIGHT] - rise, 0.0, 1.0)
    M[BRAKED] = 0.0
    if n > 0:
        M[GOAL] = _rejoin(P, rows, k, points, n, dt)
        way = _avoid(P, M, points, n, pose, rows[int(M[GOAL])], lim, aside)
        w = M[WEIGHT]
        out[0] = (1.0 - w) * out[0] + w * aside[0]
        out[1] = (1.0 - w) * out[1] + w * aside[1]
        if _guard(P, points, n, pose, out, way, lim, dt):
            M[BRAKED] = 1.0
    M[INDEX] = k if M[LATCHED] > 0.0 else k + 1


@njit(cache=True)
def _drive(
    safe: bool,
    P: Array,
    scheme: Array,
    p: Array,
    tables: Any,
    rows: Array,
    start: Array,
    block: Array,
    until: int,
    angles: Array,
    radius: float,
    dt: float,
    lim: Array,
    limited: bool,
    euler: bool,
    poses: Array,
    commands: Array,
    log: Array,
) -> int:
    """A whole run round one block that is there while the reference's index is below `until`; returns the steps.

    log: index, weight, F, latched, braked, clearance, predicted clearance. Ends at a contact or at the last row.
    """
    s, M, out, track = np.zeros(STATES), np.zeros(10), np.zeros(2), np.zeros(2)
    M[RELEASED] = -1e9
    rates, memory, one, count = np.full(2, np.nan), np.empty((MEMORY, 4)), np.empty((1, 4)), 0
    pose, last = start.copy(), rows[0, 7:9].copy()
    poses[0] = pose
    for i in range(commands.shape[0]):
        k = int(M[INDEX])
        if k >= rows.shape[0] - 1:
            return i
        there = k < until
        if safe:
            seen = _sight(block, pose, angles, P[RANGE]) if there else np.empty((0, 4))
            if count > 0 or seen.shape[0] > 0:
                count = _remember(memory, count, seen, pose, P[RANGE], P[MOVING] > 0.0)
            _safe(P, M, p, s, tables, rows, memory, count, pose, last, i * dt, dt, lim, out)
        else:
            _nearest_on(block, pose[0], pose[1], one[0])
            _law(DFL, p, s, pose, rates, rows[k], dt, lim, track)
            M[FUZZY] = _printed(scheme, tables, one, 1 if there else 0, pose, track, out)
            M[WEIGHT], M[INDEX] = M[FUZZY], k + 1
            M[LATCHED] = 1.0 if M[FUZZY] > 0.0 else 0.0
        if limited:
            _limit(out, last, lim, dt)
        last[0], last[1] = out[0], out[1]
        commands[i] = out
        middle = pose.copy()
        if euler:
            pose[0] += out[0] * dt * np.cos(pose[2])
            pose[1] += out[0] * dt * np.sin(pose[2])
            pose[2] = _wrap(pose[2] + out[1] * dt)
        else:
            _step(pose, out, dt)
        poses[i + 1] = pose
        gap = np.inf
        if there:
            middle[0], middle[1] = 0.5 * (middle[0] + pose[0]), 0.5 * (middle[1] + pose[1])
            gap = min(_nearest_on(block, pose[0], pose[1], one[0]), _nearest_on(block, middle[0], middle[1], one[0]))
            gap -= radius
        log[i, 0], log[i, 1], log[i, 2], log[i, 3] = k, M[WEIGHT], M[FUZZY], M[LATCHED]
        log[i, 4], log[i, 5], log[i, 6] = M[BRAKED], gap, M[PREDICTED]
        if gap <= 0.0:
            return i + 1
    return commands.shape[0]


def _warm() -> None:
    """Compile both schemes and their loop with the types used in practice."""
    from fuzzynav.fuzzy import FuzzySystem, Rule, RuleBlock, Variable, triangle

    d, b, f = (Variable(name=name, low=0, high=1, terms=(triangle("Low", 0, 0, 1),)) for name in "dbf")
    rules = RuleBlock(rules=(Rule.parse("if d is Low and b is Low then f is Low"),))
    flat = FuzzySystem(name="warm", inputs=(d, b), outputs=(f,), blocks=(rules,)).tables
    rows = np.tile(np.array([0.1, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0, 0.2, 0.0]), (3, 1))
    P, p, scheme, lim = np.ones(19), np.ones(9), np.ones(5), limits_of(TURTLEBOT2)
    block, start, angles = np.array([1.0, 0.0, 0.2, 0.3, 0.0]), np.zeros(3), np.linspace(-3.0, 3.0, 9)
    made = np.empty((3, 3)), np.empty((2, 2)), np.empty((2, 7))
    for safe in (True, False):
        _drive(safe, P, scheme, p, flat, rows, start, block, 5, angles, 0.2, 0.1, lim, True, False, *made)
    memory, points, out = np.empty((MEMORY, 4)), np.ones((2, 4)), np.zeros(2)
    count = _remember(memory, 0, points, start, 2.0, False)
    _safe(P, np.zeros(10), p, np.zeros(STATES), flat, rows, memory, count, start, out, 0.0, 0.1, lim, out.copy())
    _printed(scheme, flat, points, 2, start, out, out.copy())
