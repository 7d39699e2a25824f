"""Compiled: the force of a potential field, and the walk that follows it.

An obstacle is a row x1, y1, x2, y2, radius: everything within `radius` of a segment; a disc where both ends are one
point, a point where the radius is 0 as well.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fuzzynav.fuzzy.engine import infer_one
from fuzzynav.geometry import Array

__all__ = [
    "COLLIDED", "ESCAPE", "GAINS", "LOCAL_MINIMUM", "REACHED", "TIMEOUT", "WALK", "Escaping", "force", "forces",
    "gap_to", "gaps", "walk",
]  # fmt: skip

REACHED, COLLIDED, LOCAL_MINIMUM, TIMEOUT = range(4)
LEAST = 1e-9  # [m] no gap is taken as less

GAINS = np.dtype(
    (
        np.record,
        [
            ("attract", "f8"),  # eta
            ("conic", "f8"),  # [m] beyond it the attraction grows no more
            ("repel", "f8"),  # k
            ("influence", "f8"),  # [m] rho_0
            ("exponent", "f8"),  # n of eq 8
            ("printed", "?"),  # the force as eq 4 and 9 print it, which is no gradient
        ],
    )
)
WALK = np.dtype(
    (
        np.record,
        [
            ("step", "f8"),  # [m]
            ("tolerance", "f8"),  # [m]
            ("most", "i8"),  # iterations
            ("watch", "i8"),  # iterations over which progress is looked at
            ("share", "f8"),  # of their steps that must remain as progress
            ("axes", "?"),  # each axis moves by a whole step: eq 6 as printed
        ],
    )
)
ESCAPE = np.dtype(
    (
        np.record,
        [
            ("radius", "f8"),  # [m] of the virtual target, eq 10
            ("angle", "f8"),  # [rad] that the output 1 stands for
            ("gain", "f8"),  # that the output 1 stands for
            ("strong", "f8"),  # force that counts as 1
            ("far", "f8"),  # [m] that counts as 1
            ("hold", "f8"),  # iterations for which a virtual target stands
            ("growth", "f8"),  # factor of the hold from one trap to the next without progress
            ("cycle", "i8"),  # sizes of the angle, from one trap to the next without progress; then anew
            ("goalward", "?"),  # the angle counts from the direction to the goal, not from the x axis
            ("turns", "?"),  # the side changes from one trap to the next without progress
            ("most", "i8"),  # traps without progress before it gives up
        ],
    )
)


class Escaping(NamedTuple):
    """A virtual target that stands for some iterations, and what is remembered of the traps before."""

    angle: float  # [rad]
    pull: float  # k rho of eq 11
    left: int  # iterations
    traps: int  # without progress
    best: float  # [m] least distance to the goal at a trap


@njit(cache=True)
def gap_to(x: float, y: float, row: Array, radius: float) -> tuple[float, float, float]:
    """Gap [m] between a disc at (x, y) and an obstacle, and the unit vector that leads away from it."""
    dx, dy = row[2] - row[0], row[3] - row[1]
    squared = dx * dx + dy * dy
    u = min(max(((x - row[0]) * dx + (y - row[1]) * dy) / squared, 0.0), 1.0) if squared > 0.0 else 0.0
    ax, ay = x - row[0] - u * dx, y - row[1] - u * dy
    away = np.sqrt(ax * ax + ay * ay)
    if away <= LEAST:
        return -row[4] - radius, 0.0, 0.0
    return away - row[4] - radius, ax / away, ay / away


@njit(cache=True)
def gaps(xs: Array, ys: Array, obstacles: Array, radius: float) -> Array:
    """Least gap [m] of a disc at every point of a lattice, as [row of ys, column of xs]."""
    out = np.full((ys.size, xs.size), np.inf)
    for j in range(ys.size):
        for i in range(xs.size):
            for k in range(obstacles.shape[0]):
                out[j, i] = min(out[j, i], gap_to(xs[i], ys[j], obstacles[k], radius)[0])
    return out


@njit(cache=True)
def force(
    x: float, y: float, goal: Array, obstacles: Array, radius: float, gains: Any
) -> tuple[float, float, float, float]:
    """Force (fx, fy), potential and the least gap [m] of a disc at (x, y)."""
    dx, dy = goal[0] - x, goal[1] - y
    d = np.sqrt(dx * dx + dy * dy)
    pull = gains.attract * min(1.0, gains.conic / d) if d > 0.0 else 0.0
    fx, fy = pull * dx, pull * dy
    energy = 0.5 * gains.attract * d * d if d <= gains.conic else gains.attract * gains.conic * (d - 0.5 * gains.conic)
    n, least = gains.exponent, np.inf
    scale = gains.repel * (d / (d + 1.0)) ** n if n > 0.0 else gains.repel
    slope = scale * n / (d * (d + 1.0)) if d > 0.0 else 0.0
    for i in range(obstacles.shape[0]):
        gap, ux, uy = gap_to(x, y, obstacles[i], radius)
        least = min(least, gap)
        if gap >= gains.influence:
            continue
        rho = max(gap, LEAST)
        a = 1.0 / rho - 1.0 / gains.influence
        push = scale * a if gains.printed else scale * a / (rho * rho)
        fx, fy = fx + push * ux, fy + push * uy
        energy += 0.5 * scale * a * a
        if not gains.printed and slope > 0.0:
            more = 0.5 * a * a * slope / d
            fx, fy = fx + more * dx, fy + more * dy
    return fx, fy, energy, least


@njit(cache=True)
def forces(points: Array, goal: Array, obstacles: Array, radius: float, gains: Any) -> tuple[Array, Array]:
    """Forces `(n, 2)` and potentials `(n,)` at points `(n, 2)`."""
    found, energy = np.empty(points.shape), np.empty(points.shape[0])
    for i in range(points.shape[0]):
        found[i, 0], found[i, 1], energy[i], _ = force(points[i, 0], points[i, 1], goal, obstacles, radius, gains[0])
    return found, energy


@njit(cache=True)
def _next(x: float, y: float, fx: float, fy: float, walk: Any) -> tuple[float, float]:
    """The place after one step: eq 6 as printed, a whole step on each axis, or a step along the force."""
    if walk.axes:
        return x + walk.step * np.sign(fx), y + walk.step * np.sign(fy)
    size = np.sqrt(fx * fx + fy * fy)
    return (x + walk.step * fx / size, y + walk.step * fy / size) if size > 0.0 else (x, y)


@njit(cache=True)
def _virtual(x: float, y: float, goal: Array, size: float, was: Escaping, tables: Any, own: Any) -> Escaping:
    """The virtual target of eq 10 and 11 for a robot that is trapped at (x, y), where the force has this size."""
    dx, dy = goal[0] - x, goal[1] - y
    d = np.sqrt(dx * dx + dy * dy)
    progress = d < was.best - own.radius
    traps, best = (0, d) if progress else (was.traps, was.best)
    said = np.empty(2)
    infer_one(tables, np.array([min(size / own.strong, 1.0), min(d / own.far, 1.0)]), said)
    side = -1.0 if own.turns and traps % 2 == 1 else 1.0
    hold = int(min(own.hold * own.growth**traps, 1e9))
    turn = (traps // (2 if own.turns else 1) % own.cycle + 1) / own.cycle
    return Escaping(side * turn * own.angle * said[0], own.gain * said[1] * own.radius, hold, traps + 1, best)


@njit(cache=True)
def walk(
    start: Array, goal: Array, obstacles: Array, radius: float, gains: Any, settings: Any, escape: Any
) -> tuple[Array, int, NDArray[np.int64]]:
    """Places `(m, 2)`, how it ended, and the iterations at which it was trapped.

    escape: one ESCAPE record in an array and the tables of a rule base; an empty array where a trap ends the walk.
    """
    own, kept, tables = settings[0], gains[0], escape[1]
    places, trapped, count = np.empty((own.most + 1, 2)), np.empty(own.most + 1, dtype=np.int64), 0
    places[0] = start
    state, since = Escaping(0.0, 0.0, 0, 0, np.inf), 0
    for k in range(own.most):
        x, y = places[k, 0], places[k, 1]
        if np.sqrt((goal[0] - x) ** 2 + (goal[1] - y) ** 2) <= own.tolerance:
            return places[: k + 1], REACHED, trapped[:count]
        fx, fy, _, gap = force(x, y, goal, obstacles, radius, kept)
        if gap <= 0.0:
            return places[: k + 1], COLLIDED, trapped[:count]
        if state.left == 0 and k - since >= own.watch:
            bx, by = x - places[k - own.watch, 0], y - places[k - own.watch, 1]
            if np.sqrt(bx * bx + by * by) < own.share * own.watch * own.step:
                trapped[count], count, since = k, count + 1, k
                if escape[0].size == 0 or state.traps >= escape[0][0].most:
                    return places[: k + 1], LOCAL_MINIMUM, trapped[:count]
                state = _virtual(x, y, goal, np.sqrt(fx * fx + fy * fy), state, tables, escape[0][0])
        if state.left > 0:
            at = state.angle + (np.arctan2(goal[1] - y, goal[0] - x) if escape[0][0].goalward else 0.0)
            fx, fy, since = fx + state.pull * np.cos(at), fy + state.pull * np.sin(at), k + 1
            state = Escaping(state.angle, state.pull, state.left - 1, state.traps, state.best)
        places[k + 1, 0], places[k + 1, 1] = _next(x, y, fx, fy, own)
    end = places[own.most]
    near = np.sqrt((goal[0] - end[0]) ** 2 + (goal[1] - end[1]) ** 2) <= own.tolerance
    return places, REACHED if near else TIMEOUT, trapped[:count]


def _warm() -> None:
    """Compile every kernel for the types used in practice."""
    from fuzzynav.fuzzy import FuzzySystem, Rule, RuleBlock, Variable, triangle

    f, d, a, k = (Variable(name=name, low=0, high=1, terms=(triangle("Low", 0, 0, 1),)) for name in "fdak")
    rules = RuleBlock(rules=(Rule.parse("if f is Low and d is Low then a is Low and k is Low"),))
    flat = FuzzySystem(name="warm", inputs=(f, d), outputs=(a, k), blocks=(rules,)).tables
    gains = np.array([(2.0, np.inf, 20.0, 5.0, 10.0, False)], dtype=GAINS)
    own = np.array([(0.01, 0.1, 10, 5, 0.1, True)], dtype=WALK)
    target, rows = np.array([8.0, 8.0]), np.array([[4.0, 4.1, 4.0, 4.1, 0.0]])
    forces(np.zeros((1, 2)), target, rows, 0.0, gains)
    gaps(target, target, rows, 0.0)
    none = np.empty(0, dtype=ESCAPE)
    walk(np.zeros(2), target, rows, 0.0, gains, own, (none, flat))
