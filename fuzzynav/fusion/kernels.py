"""Compiled: one decision among what stands, what may move, and what is predicted to move.

All happens in the body frame. Three questions are asked of a speed (v, omega): does it stop before anything that stands
or was not seen; is it clear of every place that a mover could have reached by then, for one step and the braking after
it; and how near does it come to the movers if they keep their velocities.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fuzzynav.dwa.contact import STILL, arc_contact, near_points
from fuzzynav.dwa.kernels import SLACK, best_of, braking, end_heading, shared, stopping, window
from fuzzynav.fusion.evasion import EVASION, promises
from fuzzynav.geometry import Array
from fuzzynav.robot.kernels import LIMITS, arc

__all__ = ["ADMISSIBLE", "NO_STOP", "REACHABLE", "SETTINGS", "UNSEEN", "Ground", "decide", "least_gap", "stays_clear"]

Reasons = NDArray[np.int64]

TOUCH = 1e-4  # [m] a gap that counts as contact
LATE = 0.05  # [s] contacts nearer than this in time are equally late
ADMISSIBLE, NO_STOP, UNSEEN, REACHABLE = range(4)

SETTINGS = np.dtype(
    (
        np.record,
        [
            ("dt", "f8"),  # [s]
            ("sim_time", "f8"),  # [s] how far ahead movers are predicted
            ("aim_time", "f8"),  # [s] when the heading is looked at
            ("v_resolution", "f8"),  # [m/s]
            ("omega_resolution", "f8"),  # [rad/s]
            ("d_max", "f8"),  # [m]
            ("margin", "f8"),  # [m] kept beyond the stopping distance
            ("speed_bound", "f8"),  # [m/s] no mover is faster
            ("reserve", "f8"),  # [m] kept from movers on top, faster than creep
            ("aside", "f8"),  # [m] kept from where movers are now
            ("creep", "f8"),  # [m/s] a robot this slow counts as standing
            ("growth", "f8"),  # [m/s] of a prediction's uncertainty
            ("evades", "?"),  # the guard yields, and the promise decides
        ],
    )
)


class Ground(NamedTuple):
    """What is around the robot, in its frame. Rows of still, ends and gaps are as `near_points` gives them."""

    still: Array  # sensed, and known to stand
    ends: Array  # border of what was seen: ends of beams
    gaps: Array  # border of what was seen: gaps between beams
    hazards: Array  # (h, 3) x, y, distance of the centres at contact [m]: what may move in any direction
    tracks: Array  # (m, 5) x, y, velocity in the robot's frame, distance of the centres at contact


@njit(cache=True)
def stays_clear(
    v: float, omega: float, deceleration: float, dt: float, bound: float, hazards: Array, reserve: float
) -> bool:
    """Whether the disc stays clear of all that hazards of speed `bound` can reach while v is held for dt, then braked,
    and `reserve` [m] beyond it.

    The time advances by what the least gap allows at the speeds of that moment, so that nothing is stepped over.
    """
    if abs(v) <= STILL or hazards.shape[0] == 0:
        return True
    forward, bend, drop = np.sign(v), omega / abs(v), deceleration * dt
    last = np.ceil(abs(v) / drop - 1e-12) * dt
    t = 0.0
    while True:
        k = np.floor(t / dt + 1e-12)
        speed = max(abs(v) - k * drop, 0.0)
        way = dt * (k * abs(v) - 0.5 * drop * k * (k - 1.0)) + (t - k * dt) * speed
        x, y, _ = arc(0.0, 0.0, 0.0, forward, bend, way)
        gap = np.inf
        for i in range(hazards.shape[0]):
            gap = min(gap, np.hypot(hazards[i, 0] - x, hazards[i, 1] - y) - hazards[i, 2])
        gap -= bound * t + reserve
        if gap <= TOUCH:
            return False
        if t >= last or speed + bound <= 0.0:
            return True
        t = min(t + gap / (speed + bound), last)


@njit(cache=True)
def _nearest(x: float, y: float, dx: float, dy: float) -> tuple[float, float]:
    """Share of a straight way from (x, y) by (dx, dy) where it is nearest to the origin, and that distance squared."""
    along, squared = -(x * dx + y * dy), dx * dx + dy * dy
    u = 0.0 if along <= 0.0 else (1.0 if along >= squared else along / squared)
    return u, (x + u * dx) ** 2 + (y + u * dy) ** 2


@njit(cache=True)
def least_gap(v: float, omega: float, tracks: Array, horizon: float, step: float, growth: float) -> tuple[float, float]:
    """Least gap [m] to movers that keep their velocity while v is held, and when [s] the first contact is; inf: none.

    Between two times `step` apart the motion relative to a mover is taken as straight. The uncertainty of a
    prediction grows by `growth` [m/s], but not faster than the mover walks.
    """
    least, first = np.inf, np.inf
    if tracks.shape[0] == 0:
        return least, first
    parts = max(int(np.ceil(horizon / step - 1e-9)), 1)
    span = horizon / parts
    half = 0.5 * omega * span
    chord = v * span * (np.sin(half) / half if abs(half) > 1e-9 else 1.0)
    c, s, turn_c, turn_s = np.cos(half), np.sin(half), np.cos(2.0 * half), np.sin(2.0 * half)
    x = y = 0.0
    for p in range(parts):
        begin, way_x, way_y = p * span, chord * c, chord * s
        for i in range(tracks.shape[0]):
            ax, ay = tracks[i, 0] + begin * tracks[i, 2] - x, tracks[i, 1] + begin * tracks[i, 3] - y
            u, near = _nearest(ax, ay, span * tracks[i, 2] - way_x, span * tracks[i, 3] - way_y)
            doubt = min(growth, np.sqrt(tracks[i, 2] ** 2 + tracks[i, 3] ** 2))
            at = begin + u * span
            kept = tracks[i, 4] + doubt * at
            if near > (max(least, 0.0) + kept) ** 2:
                continue  # cannot come nearer than the least so far
            gap = np.sqrt(near) - kept
            least = min(least, gap)
            if gap <= 0.0:
                first = min(first, at)
        if first < np.inf:
            break
        x, y, c, s = x + way_x, y + way_y, turn_c * c - turn_s * s, turn_s * c + turn_c * s
    return max(least, 0.0), first


@njit(cache=True)
def _reason(v: float, free: float, unseen: float, need: float, clear: bool) -> int:
    """Why a sample is refused; ADMISSIBLE if it is not. A disc that stands or turns in place touches nothing."""
    if abs(v) <= STILL:
        return ADMISSIBLE
    if need > free:
        return NO_STOP
    if need > unseen:
        return UNSEEN
    return ADMISSIBLE if clear else REACHABLE


@njit(cache=True)
def _rate(
    samples: Array, target: Array, ground: Ground, nearest: float, lim: Any, own: Any
) -> tuple[Array, Array, Reasons]:
    """Raw scores (heading, static clearance, speed, clearance of movers), ways and the reason of refusal.

    Ways are the free one, the known one, the stopping distance [m], the least predicted gap [m] and when contact is
    predicted [s].
    """
    n = samples.shape[0]
    raw, ways, reasons = np.empty((n, 4)), np.empty((n, 5)), np.empty(n, dtype=np.int64)
    for i in range(n):
        v, omega = samples[i, 0], samples[i, 1]
        slower = braking(v, omega, lim)
        need = stopping(v, slower, own.dt)
        free, seen = arc_contact(v, omega, ground.still), arc_contact(v, omega, ground.ends)
        unseen = min(seen, max(arc_contact(v, omega, ground.gaps) - SLACK, 0.0))
        extra = own.reserve if abs(v) > own.creep else 0.0
        clear = stays_clear(v, omega, slower, own.dt, own.speed_bound, ground.hazards, extra)
        reasons[i] = _reason(v, free, unseen, need, clear)
        gap, first = least_gap(v, omega, ground.tracks, own.sim_time, 0.2, own.growth)
        ways[i, 0], ways[i, 1], ways[i, 2], ways[i, 3], ways[i, 4] = free, min(free, unseen), need, gap, first
        raw[i, 0] = end_heading(v, omega, target[0], target[1], own.aim_time)
        raw[i, 1] = min(max(nearest, 0.0) if abs(v) <= STILL else free, own.d_max)
        raw[i, 2] = max(v, 0.0)
        raw[i, 3] = min(gap, own.d_max)
    return raw, ways, reasons


@njit(cache=True)
def _eligible(reasons: Reasons, contact: Array) -> NDArray[np.bool_]:
    """Admissible samples without a predicted contact; where there is none, those whose contact comes last."""
    top, out = -np.inf, np.zeros(reasons.shape[0], dtype=np.bool_)
    for i in range(reasons.shape[0]):
        if reasons[i] == ADMISSIBLE:
            top = max(top, min(contact[i], 1e9))
    for i in range(reasons.shape[0]):
        out[i] = reasons[i] == ADMISSIBLE and contact[i] >= top - LATE
    return out


@njit(cache=True)
def _turned(pose: Array, rows: Array, radius: float) -> Array:
    """Rows x, y, ... of the world in the robot's frame; the last column, a radius, grown by the robot's."""
    c, s, out = np.cos(pose[2]), np.sin(pose[2]), rows.copy()
    for i in range(rows.shape[0]):
        dx, dy = rows[i, 0] - pose[0], rows[i, 1] - pose[1]
        out[i, 0], out[i, 1] = c * dx + s * dy, c * dy - s * dx
        if rows.shape[1] == 5:
            out[i, 2], out[i, 3] = c * rows[i, 2] + s * rows[i, 3], c * rows[i, 3] - s * rows[i, 2]
        out[i, rows.shape[1] - 1] += radius
    return out


@njit(cache=True)
def _kept(pose: Array, points: Array, wanted: Array, radius: float) -> tuple[Array, float]:
    """How far [m] the rim keeps from each point, and the distance to the nearest.

    As far as wanted, or as it is now where that is less: it may not come nearer, but leave and pass by.
    """
    out, nearest = np.empty(points.shape[0]), np.inf
    for i in range(points.shape[0]):
        away = np.hypot(points[i, 0] - pose[0], points[i, 1] - pose[1]) - radius
        out[i], nearest = min(wanted[i], away - 1e-6), min(nearest, away)
    return out, nearest


@njit(cache=True)
def _around(samples: Array, pose: Array, sensed: Any, lim: Any, own: Any) -> tuple[Ground, float]:
    """What lies within reach of the samples, in the robot's frame, and the distance to the nearest of what stands."""
    points, border, radii, holes, hazards, tracks = sensed
    fastest = 0.0
    for i in range(samples.shape[0]):
        fastest = max(fastest, abs(samples[i, 0]))
    slowest = min(lim.loss, lim.spin / lim.omega * fastest) if fastest > STILL else lim.loss
    need, time = stopping(fastest, slowest, own.dt), np.ceil(fastest / (slowest * own.dt)) * own.dt
    far = max(own.d_max, need)
    kept, nearest = _kept(pose, points, np.full(points.shape[0], own.margin), lim.radius)
    wary, _ = _kept(pose, hazards, hazards[:, 2] + own.aside, lim.radius)
    stand = np.concatenate((points, hazards[:, :2]))
    still, _ = near_points(pose, stand, np.concatenate((kept, wary)), lim.radius, far)
    covers, _ = _kept(pose, border, radii, lim.radius)
    edge = need + SLACK + 0.01  # where the seen ends matters only as far as the robot may have to go
    gaps, _ = near_points(pose, border[:holes], covers[:holes], lim.radius, edge)
    ends, _ = near_points(pose, border[holes:], covers[holes:], lim.radius, edge)
    threats, reach = _turned(pose, hazards, lim.radius), need + own.speed_bound * time + own.reserve + 0.01
    near = np.hypot(threats[:, 0], threats[:, 1]) - threats[:, 2] <= reach
    return Ground(still, ends, gaps, threats[near], _turned(pose, tracks, lim.radius)), nearest


@njit(cache=True)
def _within(samples: Array, cap: float) -> Array:
    """The samples that are not faster than the cap; of those all are, the slowest, and the emergency one always."""
    n, slowest = samples.shape[0] - 1, samples[:, 0].min()
    kept = np.ones(n + 1, dtype=np.bool_)
    for i in range(n):
        kept[i] = samples[i, 0] <= max(cap, slowest)
    return samples[kept]


@njit(cache=True)
def decide(
    velocity: Array, pose: Array, target: Array, sensed: Any, body: Any, settings: Any, weights: Array
) -> tuple[Array, Array, Array, Reasons, Array, Array, int]:
    """One decision: samples, raw scores, ways, reasons, shares, totals and the index of the best; -1 where none is.

    sensed: points, border, its radii, how many bound gaps, hazards (x, y, radius) and tracks (x, y, velocity, radius),
    all in the world; body: the robot's limits, the speed that the sub-goal allows, and how it evades.
    A robot that evades chooses by its promises, whatever the guard says.
    """
    limits, cap, evasion = body
    lim, own = limits[0], settings[0]
    samples = _within(window(velocity[0], velocity[1], lim, own), cap)
    ground, nearest = _around(samples, pose, sensed, lim, own)
    c, s, dx, dy = np.cos(pose[2]), np.sin(pose[2]), target[0] - pose[0], target[1] - pose[1]
    aim = np.array([c * dx + s * dy, c * dy - s * dx])
    raw, ways, reasons = _rate(samples, aim, ground, nearest, lim, own)
    if own.evades:
        allowed, flight = (reasons == ADMISSIBLE) | (reasons == REACHABLE), evasion[0]
        stands, _ = near_points(pose, sensed[0], np.zeros(sensed[0].shape[0]), lim.radius, lim.v_high * flight.horizon)
        totals, ways[:, 4] = promises(samples, allowed, aim, stands, ground.tracks, lim, flight)
        return samples, raw, ways, reasons, np.zeros(raw.shape), totals, best_of(totals, samples)
    shares, totals = shared(raw, _eligible(reasons, ways[:, 4]), weights)
    return samples, raw, ways, reasons, shares, totals, best_of(totals, samples)


def _warm() -> None:
    """Compile every kernel for the types used in practice."""
    limits = np.array([(0.0, 1.0, 0.35, 0.2, 0.2, 0.87, 0.3)], dtype=LIMITS)
    settings = np.array([(0.1, 3.0, 3.0, 0.02, 0.05, 2.0, 0.0, 0.5, 0.1, 0.1, 0.05, 0.0, False)], dtype=SETTINGS)
    points, row = np.array([[2.0, 1.0]]), np.array([[2.0, 1.0, 0.3, 0.0, 0.3]])
    sensed = (points, points, np.zeros(1), 0, row[:, :3].copy(), row)
    evasion = np.array([(3.0, 0.6, 0.3, 2.0, 0.3, 4.0, 0.1)], dtype=EVASION)
    decide(np.zeros(2), np.zeros(3), np.ones(2), sensed, (limits, 1.0, evasion), settings, np.ones(4))
    stays_clear(0.5, 0.1, 0.2, 0.1, 0.5, row[:, :3].copy(), 0.1)
    least_gap(0.5, 0.1, row, 3.0, 0.2, 0.0)
