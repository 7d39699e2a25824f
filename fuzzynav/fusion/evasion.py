"""Compiled: what a speed promises among movers that do not yield.

A speed is held for a moment, then another one of a few until the horizon: the best of these goes counts. What counts is
the way that it gains towards the target, most of all the way of the first moment, and how near it comes to the movers,
soon rather than late. All happens in the robot's frame; movers keep their velocities.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fuzzynav.dwa.contact import STILL, arc_contact
from fuzzynav.geometry import Array
from fuzzynav.robot.kernels import LIMITS, arc

__all__ = ["EVASION", "promises"]

STEP = 0.1  # [s] between two looks at the movers, at most
SPACING = 0.2  # [m] between the points of what stands that are looked at
FAR = 6.0  # [scales] gaps beyond it count alike: exp(-6) is next to nothing

EVASION = np.dtype(
    (
        np.record,
        [
            ("horizon", "f8"),  # [s]
            ("hold", "f8"),  # [s] until another speed may follow
            ("early", "f8"),  # share of the first moment in the gain of way
            ("dread", "f8"),  # weight of nearness
            ("scale", "f8"),  # [m] in which nearness falls by e
            ("fade", "f8"),  # [s] in which it does
            ("growth", "f8"),  # [m/s] of a prediction's uncertainty
        ],
    )
)


class Ahead(NamedTuple):
    """What the robot will meet: times, the movers' places at them, and what stands."""

    times: Array  # (k,) [s]
    places: Array  # (k, m, 3) x, y, distance of the centres at contact, grown by the uncertainty of that time
    still: Array  # (n, 4) rows of `near_points`


@njit(cache=True)
def _thinned(still: Array, far: float) -> Array:
    """Rows no further than `far` [m] of which no two that follow each other are nearer than SPACING."""
    kept, x, y = np.zeros(still.shape[0], dtype=np.bool_), np.inf, np.inf
    for i in range(still.shape[0]):
        if np.hypot(still[i, 0], still[i, 1]) > far or np.hypot(still[i, 0] - x, still[i, 1] - y) < SPACING:
            continue
        kept[i], x, y = True, still[i, 0], still[i, 1]
    return still[kept]


@njit(cache=True)
def _ahead(still: Array, tracks: Array, lim: Any, own: Any) -> tuple[Ahead, int]:
    """What lies ahead of a robot that holds its speed and then takes another, and how many times belong to holding."""
    holds, rest = max(int(np.ceil(own.hold / STEP)), 1), max(int(np.ceil((own.horizon - own.hold) / STEP)), 1)
    times = np.empty(holds + rest)
    for k in range(holds):
        times[k] = (k + 1) * own.hold / holds
    for k in range(rest):
        times[holds + k] = own.hold + (k + 1) * (own.horizon - own.hold) / rest
    places = np.empty((times.size, tracks.shape[0], 3))
    for k in range(times.size):
        for i in range(tracks.shape[0]):
            places[k, i, 0] = tracks[i, 0] + times[k] * tracks[i, 2]
            places[k, i, 1] = tracks[i, 1] + times[k] * tracks[i, 3]
            places[k, i, 2] = tracks[i, 4] + own.growth * times[k]
    reach = max(lim.v_high, -lim.v_low) * own.horizon + lim.radius
    return Ahead(times, places, _thinned(still, reach)), holds


@njit(cache=True)
def _moved(pose: tuple[float, float, float], still: Array) -> Array:
    """What stands, in the frame of a pose."""
    out, c, s = still.copy(), np.cos(pose[2]), np.sin(pose[2])
    for i in range(still.shape[0]):
        dx, dy = still[i, 0] - pose[0], still[i, 1] - pose[1]
        squared = still[i, 0] * still[i, 0] + still[i, 1] * still[i, 1] - still[i, 3]
        out[i, 0], out[i, 1], out[i, 3] = c * dx + s * dy, c * dy - s * dx, dx * dx + dy * dy - squared
    return out


@njit(cache=True)
def _drive(
    pose: tuple[float, float, float], speed: tuple[float, float], span: tuple[int, int], ahead: Ahead, own: Any
) -> tuple[float, float]:
    """Greatest nearness of a mover while a speed is held over the times of the span, and the first contact [s]."""
    first, last = span
    begin = ahead.times[first - 1] if first > 0 else 0.0
    stop, near = np.inf, 0.0
    if abs(speed[0]) > STILL:
        stop = begin + arc_contact(speed[0], speed[1], ahead.still) / abs(speed[0])
    for k in range(first, last):
        time = ahead.times[k]
        if time >= stop:
            return near, stop
        x, y, _ = arc(pose[0], pose[1], pose[2], speed[0], speed[1], time - begin)
        gap = FAR * own.scale
        for i in range(ahead.places.shape[1]):
            dx, dy, reach = ahead.places[k, i, 0] - x, ahead.places[k, i, 1] - y, ahead.places[k, i, 2]
            if dx * dx + dy * dy < (reach + gap) ** 2:
                gap = np.sqrt(dx * dx + dy * dy) - reach
        if gap <= 0.0:
            return 1.0, time
        near = max(near, np.exp(-gap / own.scale - time / own.fade))
    return near, np.inf


@njit(cache=True)
def _choices(lim: Any) -> Array:
    """The speeds (n, 2) that may follow: reverse, none, half and full, each with five turns."""
    out, k = np.empty((20, 2)), 0
    for v in (lim.v_low, 0.0, 0.5 * lim.v_high, lim.v_high):
        for turn in range(-2, 3):
            out[k, 0], out[k, 1] = v, 0.5 * turn * lim.omega
            k += 1
    return out


@njit(cache=True)
def _promise(
    speed: tuple[float, float], target: Array, ahead: Ahead, holds: int, choices: Array, lim: Any, own: Any
) -> tuple[float, float]:
    """Of one speed: its promise, and when contact is predicted [s]."""
    whole, gone = np.hypot(target[0], target[1]), lim.v_high * own.horizon
    near, contact = _drive((0.0, 0.0, 0.0), speed, (0, holds), ahead, own)
    pose = arc(0.0, 0.0, 0.0, speed[0], speed[1], own.hold)
    gain = (whole - np.hypot(target[0] - pose[0], target[1] - pose[1])) / (lim.v_high * own.hold)
    if contact < np.inf:
        return own.early * gain - own.dread * near - 2.0 + contact / own.horizon, contact
    best, latest = -np.inf, 0.0
    later = Ahead(ahead.times, ahead.places, _moved(pose, ahead.still))
    for c in range(-1, choices.shape[0]):
        v, omega = speed if c < 0 else (choices[c, 0], choices[c, 1])
        x, y, _ = arc(pose[0], pose[1], pose[2], v, omega, own.horizon - own.hold)
        total = (whole - np.hypot(target[0] - x, target[1] - y)) / gone
        worth = own.early * gain + (1.0 - own.early) * total
        if worth - own.dread * near <= best:
            continue
        risk, contact = _drive(pose, (v, omega), (holds, ahead.times.size), later, own)
        worth -= own.dread * max(risk, near)
        if contact < np.inf:
            worth -= 2.0 - contact / own.horizon
        if worth > best:
            best, latest = worth, contact
    return best, latest


@njit(cache=True)
def promises(
    samples: Array, allowed: NDArray[np.bool_], target: Array, still: Array, tracks: Array, lim: Any, own: Any
) -> tuple[Array, Array]:
    """The promise of each allowed sample, nan for the others, and when [s] contact is predicted; inf: never.

    A contact costs more than any way can gain, and the more the sooner it is.
    """
    n = samples.shape[0]
    out, contact = np.full(n, np.nan), np.zeros(n)
    ahead, holds = _ahead(still, tracks, lim, own)
    choices = _choices(lim)
    for i in range(n):
        if allowed[i]:
            out[i], contact[i] = _promise((samples[i, 0], samples[i, 1]), target, ahead, holds, choices, lim, own)
    return out, contact


def _warm() -> None:
    """Compile every kernel for the types used in practice."""
    limits = np.array([(0.0, 1.0, 0.35, 0.2, 0.2, 0.87, 0.3)], dtype=LIMITS)
    own = np.array([(3.0, 0.6, 0.3, 2.0, 0.3, 4.0, 0.1)], dtype=EVASION)
    samples, still = np.array([[0.5, 0.1], [0.0, 0.0]]), np.array([[2.0, 1.0, 0.0, 4.9]])
    tracks = np.array([[2.0, 1.0, 0.3, 0.0, 0.3]])
    promises(samples, np.ones(2, dtype=np.bool_), np.ones(2), still, tracks, limits[0], own[0])
