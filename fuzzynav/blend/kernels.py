"""Avoidance beside tracking, as compiled steps: the printed blend, the safe one, and the loop round both.

Obstacles are points x, y, vx, vy, rows of an array (n, 4): seen, remembered, and moving where that is known.
Schemes and minds are records, named in `records`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from fuzzynav.blend.points import MEMORY, closest, gap, nearest_on, remember, sight
from fuzzynav.blend.records import LOG, MIND, PRINTED, SAFE, Made, Scene, Track
from fuzzynav.fuzzy.engine import infer_one
from fuzzynav.geometry import Array
from fuzzynav.robot.kernels import arc, clip, euler, limit, wrap
from fuzzynav.tracking import records
from fuzzynav.tracking.kernels import DFL, law
from fuzzynav.tracking.records import Records

__all__ = ["forecast", "guard", "lap", "printed", "printed_step", "safe", "safe_step", "weight"]

NEAR = 1.0  # [m] further behind the nearest point a point does not bend the way round
STEEP = 0.1  # [m] so far inside the margin the way leads straight off
SLACK = 0.005  # [m] by which the straight way may be nearer than the margin
SWING = 0.5  # share of the turn now in the price of a side, beside the detour
TIE = 0.01  # [m] of room by which another motion must be better


@njit(cache=True)
def weight(tables: Any, distance: float, bearing: float) -> float:
    """F of a rule base for one distance [m] and bearing [rad]; 0 where no rule fires."""
    point, value = np.array([distance, bearing]), np.empty(1)
    infer_one(tables, point, value)
    return 0.0 if np.isnan(value[0]) else clip(value[0], 0.0, 1.0)


# --- the printed blend


@njit(cache=True)
def printed(scheme: Any, tables: Any, points: Array, pose: Array, v: float, omega: float) -> tuple[float, float, float]:
    """The printed blend of the tracking command (v, omega): its command, and F."""
    d, bearing = closest(points, pose)
    if d > scheme.d0 or (not scheme.hard and abs(bearing) > scheme.gate):
        return v, omega, 0.0
    f = weight(tables, d, bearing)
    turn = scheme.turn if bearing <= 0.0 else -scheme.turn
    if scheme.hard:  # the hard switch: the fuzzy command alone
        return (1.0 - f) * v, f * turn, f
    return (1.0 - f) * v + f * scheme.keep_speed * v, (1.0 - f) * omega + f * turn, f


@njit(cache=True)
def printed_step(scheme: Records, tables: Any, points: Array, pose: Array, command: Array) -> float:
    """One printed step from Python: changes the tracking command; returns F."""
    command[0], command[1], f = printed(scheme[0], tables, points, pose, command[0], command[1])
    return f


# --- the safe blend: what lies ahead


@njit(cache=True)
def forecast(track: Track, k: int, pose: Array, mind: Any, points: Array, time: float) -> float:
    """Least distance [m] of the centre to the points if tracking alone drove for `time` [s]."""
    memory, at, last = track.memory.copy(), pose.copy(), track.rows.shape[0] - 1
    v, omega, least, dt = mind.v, mind.omega, np.inf, track.memory[0].dt
    for i in range(int(time / dt)):
        wish_v, wish_omega = law(DFL, track.gains, memory[0], at, track.rows[min(k + i, last)])
        v, omega = limit(wish_v, wish_omega, v, omega, memory[0].lim, dt)
        at[0], at[1], at[2] = arc(at[0], at[1], at[2], v, omega, dt)
        least = min(least, gap(points, at[0], at[1], (i + 1) * dt))
    return least


@njit(cache=True)
def _project(rows: Records, k: int, most: int, pose: Array) -> int:
    """Index from k to k + most at which the reference is nearest to the robot."""
    best, at = np.inf, k
    for i in range(k, min(k + most, rows.shape[0] - 1) + 1):
        d = (rows[i].x - pose[0]) ** 2 + (rows[i].y - pose[1]) ** 2
        if d < best:
            best, at = d, i
    return at


@njit(cache=True)
def _rejoin(scheme: Any, track: Track, k: int, points: Array) -> int:
    """First index beyond the blocked stretch from which the reference stays clear for a while."""
    rows, dt, need = track.rows, track.memory[0].dt, scheme.radius + scheme.leave
    way, free, first, i = 0.0, 0.0, -1, k
    while i < rows.shape[0] - 1 and way < scheme.look + scheme.stretch:
        if way >= scheme.ahead and gap(points, rows[i].x, rows[i].y, 0.0) > need:
            first = i if first < 0 else first
            free += abs(rows[i].v) * dt
            if free >= scheme.stretch:
                return first
        else:
            first, free = -1, 0.0
        way += abs(rows[i].v) * dt
        i += 1
    return first if first >= 0 else i


@njit(cache=True)
def _tangent(scheme: Any, points: Array, pose: Array, side: float) -> float:
    """World direction that passes the points on one side (+1: they stay on the right) at the follow margin."""
    d0, bearing = closest(points, pose)
    middle = wrap(pose[2] + bearing)
    rho = scheme.radius + scheme.follow
    most = -np.inf
    for i in range(points.shape[0]):
        dx, dy = points[i, 0] - pose[0], points[i, 1] - pose[1]
        d = np.hypot(dx, dy)
        if d > d0 + NEAR:
            continue
        edge = np.pi / 2.0 + min((rho - d) / STEEP, 1.0) * np.pi / 4.0 if d < rho else np.arcsin(rho / d)
        most = max(most, side * wrap(np.arctan2(dy, dx) - middle) + edge)
    return wrap(middle + side * most)


@njit(cache=True)
def _way_is_free(scheme: Any, points: Array, pose: Array, x: float, y: float) -> bool:
    """Whether the straight line to a place keeps the follow margin."""
    rho = scheme.radius + scheme.follow - SLACK
    ux, uy = x - pose[0], y - pose[1]
    length = max(np.hypot(ux, uy), 1e-9)
    ux, uy = ux / length, uy / length
    for i in range(points.shape[0]):
        dx, dy = points[i, 0] - pose[0], points[i, 1] - pose[1]
        along = clip(dx * ux + dy * uy, 0.0, length)
        if np.hypot(dx - along * ux, dy - along * uy) < rho and dx * ux + dy * uy > 0.0:
            return False
    return True


@njit(cache=True)
def _choose(scheme: Any, points: Array, pose: Array, x: float, y: float) -> float:
    """The side whose boundary is the shorter way to the rejoin point; in a tie the smaller turn, then left."""
    wish = np.arctan2(y - pose[1], x - pose[0])
    cost = np.empty(2)
    for j in range(2):
        way = _tangent(scheme, points, pose, 1.0 - 2.0 * j)
        cost[j] = abs(wrap(way - wish)) + SWING * abs(wrap(way - pose[2]))
    return 1.0 if cost[0] <= cost[1] + 1e-6 else -1.0


# --- the safe blend: the last filter


@njit(cache=True)
def _ahead(points: Array, pose: Array, v: float, omega: float, time: float) -> float:
    """Least distance of the centre to the points while one command is held for `time` [s]."""
    x, y, theta, least = pose[0], pose[1], pose[2], np.inf
    steps = 4 if time < 1.0 else 10
    for i in range(steps):
        x, y, theta = arc(x, y, theta, v, omega, time / steps)
        least = min(least, gap(points, x, y, (i + 1) * time / steps))
    return least


@njit(cache=True)
def _evade(scheme: Any, points: Array, pose: Array, v: float, omega: float) -> tuple[float, float, bool]:
    """Where the command would let a moving point come too near, the motion that keeps most room instead."""
    need, time = scheme.radius + scheme.guard + scheme.evade_margin, scheme.evade_time
    best, best_v, best_omega = _ahead(points, pose, v, omega, time), v, omega
    if best >= need:
        return v, omega, False
    best += TIE  # what is wanted anyway wins a tie
    for i in range(-3, 4):
        for j in range(-2, 3):
            other_v, other_omega = scheme.evade_speed * i, scheme.evade_turn * j
            room = min(_ahead(points, pose, other_v, other_omega, time), need + 0.1)
            room = room - 0.01 * abs(other_v - v) - 0.002 * abs(other_omega - omega)
            if room > best:
                best, best_v, best_omega = room, other_v, other_omega
    return best_v, best_omega, True


@njit(cache=True)
def guard(
    scheme: Any, memory: Any, points: Array, pose: Array, v: float, omega: float, away: float
) -> tuple[float, float, bool]:
    """Brake where the arc of the next step and of braking comes too near; turn towards free ground instead."""
    if scheme.moving:
        return _evade(scheme, points, pose, v, omega)
    lim, start, need = memory.lim, gap(points, pose[0], pose[1], 0.0), scheme.radius + scheme.guard
    if _ahead(points, pose, v, omega, max(v, 0.0) / lim.loss + 2.0 * memory.dt) < min(need, start - 1e-6):
        return 0.0, clip(scheme.guard_turn * wrap(away - pose[2]), -lim.omega, lim.omega), True
    return v, omega, False


# --- the safe blend: one step


@njit(cache=True)
def _avoid(scheme: Any, mind: Any, points: Array, pose: Array, row: Any, lim: Any) -> tuple[float, float, float]:
    """Command along the boundary of the inflated points, or straight to the rejoin point; and its direction."""
    if _way_is_free(scheme, points, pose, row.x, row.y):
        way = np.arctan2(row.y - pose[1], row.x - pose[0])
    else:
        way = _tangent(scheme, points, pose, mind.side)
    wrong = wrap(way - pose[2])
    speed = scheme.cruise * (1.0 - mind.fuzzy) + scheme.creep * mind.fuzzy
    free = max(gap(points, pose[0], pose[1], 0.0) - scheme.radius - scheme.guard, 0.0)
    v = min(speed, np.sqrt(2.0 * lim.loss * free)) * max(np.cos(wrong), 0.0) ** 2
    return v, clip(scheme.gain * (1.0 + mind.fuzzy) * wrong, -lim.omega, lim.omega), way


@njit(cache=True)
def _judge(scheme: Any, mind: Any, track: Track, tables: Any, points: Array, pose: Array, k: int) -> None:
    """F and the forecast of tracking; with them whether avoidance takes over, or hands back."""
    mind.fuzzy, mind.predicted = 0.0, np.inf
    if points.shape[0] > 0:
        d, bearing = closest(points, pose)
        raw = weight(tables, d, bearing)
        mind.fuzzy = clip((raw - scheme.floor) / max(scheme.ceiling - scheme.floor, 1e-9), 0.0, 1.0)
        span = scheme.leave_time if mind.latched else scheme.enter_time
        mind.predicted = forecast(track, k, pose, mind, points, span) - scheme.radius
        mind.goal = _rejoin(scheme, track, k, points)
    if mind.latched and mind.predicted > scheme.leave:
        mind.latched, mind.released = False, mind.time
    elif not mind.latched and mind.predicted < scheme.enter:
        if mind.side == 0.0 or mind.time - mind.released > scheme.same_side:
            mind.side = _choose(scheme, points, pose, track.rows[mind.goal].x, track.rows[mind.goal].y)
        mind.latched = True


@njit(cache=True)
def safe(scheme: Any, mind: Any, track: Track, tables: Any, points: Array, pose: Array) -> tuple[float, float]:
    """Command of one step of the safe blend, before the limits; changes its mind and the tracker's memory."""
    memory, k = track.memory[0], mind.index
    if mind.latched:
        k = _project(track.rows, k, scheme.rate, pose)
        # the integrator knows what was sent: nothing winds up
        memory.speed = clip(mind.v, track.gains.dfl.v_min, memory.lim.v_high)
    _judge(scheme, mind, track, tables, points, pose, k)
    v, omega = law(DFL, track.gains, memory, pose, track.rows[k])
    rise = memory.dt / scheme.fade
    w = max(mind.weight + rise, mind.fuzzy) if mind.latched else mind.weight - rise
    mind.weight, mind.braked = clip(w, 0.0, 1.0), False
    if points.shape[0] > 0:
        aside_v, aside_omega, way = _avoid(scheme, mind, points, pose, track.rows[mind.goal], memory.lim)
        w = mind.weight
        v, omega = (1.0 - w) * v + w * aside_v, (1.0 - w) * omega + w * aside_omega
        v, omega, mind.braked = guard(scheme, memory, points, pose, v, omega, way)
    mind.index = k if mind.latched else k + 1
    return v, omega


@njit(cache=True)
def safe_step(
    scheme: Records,
    mind: Records,
    gains: Records,
    memory: Records,
    rows: Records,
    tables: Any,
    points: Array,
    pose: Array,
) -> None:
    """One safe step from Python, limits included: the command is left in the mind."""
    track, m, law_memory = Track(gains[0], memory, rows), mind[0], memory[0]
    v, omega = safe(scheme[0], m, track, tables, points, pose)
    m.v, m.omega = limit(v, omega, m.v, m.omega, law_memory.lim, law_memory.dt)


# --- a whole run


@njit(cache=True)
def _sense(scene: Scene, scheme: Any, pose: Array, there: bool, known: Array, count: int) -> int:
    """Points known after this moment: the ends of the beams, or the exact nearest point for the printed scheme."""
    if not scene.safe:
        nearest_on(scene.block, pose[0], pose[1], known[0])
        return 1 if there else 0
    seen = sight(scene.block, pose, scene.angles, scheme.reach) if there else np.empty((0, 4))
    if count > 0 or seen.shape[0] > 0:
        return remember(known, count, seen, pose, scheme.reach, scheme.moving)
    return count


@njit(cache=True)
def _decide(
    scene: Scene, schemes: Any, mind: Any, track: Track, tables: Any, points: Array, pose: Array
) -> tuple[float, float]:
    """Command of either scheme, before the limits; changes the mind."""
    if scene.safe:
        return safe(schemes[0][0], mind, track, tables, points, pose)
    v, omega = law(DFL, track.gains, track.memory[0], pose, track.rows[mind.index])
    v, omega, f = printed(schemes[1][0], tables, points, pose, v, omega)
    mind.fuzzy, mind.weight, mind.latched, mind.index = f, f, f > 0.0, mind.index + 1
    return v, omega


@njit(cache=True)
def _move(pose: Array, v: float, omega: float, dt: float, by_euler: bool, middle: Array) -> None:
    """Drive for dt [s]: changes the pose; middle (2,) is half way between both positions."""
    x, y = pose[0], pose[1]
    if by_euler:
        pose[0], pose[1], pose[2] = euler(x, y, pose[2], v, omega, dt)
    else:
        pose[0], pose[1], pose[2] = arc(x, y, pose[2], v, omega, dt)
    middle[0], middle[1] = 0.5 * (x + pose[0]), 0.5 * (y + pose[1])


@njit(cache=True)
def lap(
    schemes: Any, minds: Records, gains: Records, memory: Records, rows: Records, tables: Any, scene: Scene, made: Made
) -> int:
    """A whole run round one block; fills what is made and returns the steps.

    schemes: the safe one and the printed one. Ends at a contact or at the last row.
    """
    track, mind, dt, lim = Track(gains[0], memory, rows), minds[0], memory[0].dt, memory[0].lim
    known, one, middle, count = np.empty((MEMORY, 4)), np.empty(4), np.empty(2), 0
    pose = made.poses[0].copy()
    for i in range(made.commands.shape[0]):
        k = mind.index
        if k >= rows.shape[0] - 1:
            return i
        there, mind.time = k < scene.until, i * dt
        count = _sense(scene, schemes[0][0], pose, there, known, count)
        v, omega = _decide(scene, schemes, mind, track, tables, known[:count], pose)
        if scene.limited:
            v, omega = limit(v, omega, mind.v, mind.omega, lim, dt)
        mind.v, mind.omega = v, omega
        _move(pose, v, omega, dt, scene.euler, middle)
        made.poses[i + 1], made.commands[i, 0], made.commands[i, 1] = pose, v, omega
        clearance = np.inf
        if there:
            end = nearest_on(scene.block, pose[0], pose[1], one)
            clearance = min(end, nearest_on(scene.block, middle[0], middle[1], one)) - lim.radius
        log = made.log[i]
        log.index, log.weight, log.F, log.avoiding = k, mind.weight, mind.fuzzy, mind.latched
        log.braked, log.clearance, log.predicted = mind.braked, clearance, mind.predicted
        if clearance <= 0.0:
            return i + 1
    return len(made.commands)


def _warm() -> None:
    """Compile both schemes and their loop with the types used in practice."""
    from fuzzynav.fuzzy import FuzzySystem, Rule, RuleBlock, Variable, triangle

    d, b, f = (Variable(name=name, low=0, high=1, terms=(triangle("Low", 0, 0, 1),)) for name in "dbf")
    rules = RuleBlock(rules=(Rule.parse("if d is Low and b is Low then f is Low"),))
    flat = FuzzySystem(name="warm", inputs=(d, b), outputs=(f,), blocks=(rules,)).tables
    gains, memory, rows = np.ones(1, records.GAINS), np.ones(1, records.MEMORY), np.ones(3, records.ROW)
    schemes, minds, pose = (np.ones(1, SAFE), np.ones(1, PRINTED)), np.zeros(1, MIND), np.zeros(3)
    block, angles = np.array([9.0, 0.0, 0.2, 0.3, 0.0]), np.linspace(-3.0, 3.0, 9)
    made = Made(np.zeros((3, 3)), np.empty((2, 2)), np.empty(2, LOG))
    lap(schemes, minds, gains, memory, rows, flat, Scene(block, 5, angles, True, True, False), made)
    points = np.ones((2, 4))
    safe_step(schemes[0], np.zeros(1, MIND), gains, memory, rows, flat, points, pose)
    printed_step(schemes[1], flat, points, pose, np.ones(2))
