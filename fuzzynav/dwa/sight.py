"""Compiled: how far the ground is known, and the border that a robot may not cross unseen.

What is known free, in one scan:

- the ground that the robot stands on;
- between two neighbouring living beams everything nearer than both their ends, as long as the beams are near enough to
  each other there. An obstacle that no beam hits lies between two beams. One that holds a disc of diameter t (the
  thinnest obstacle of `Params.thinnest`) fits between beams a gap g apart from t/2 / sin(g/2) on, and is convex with
  corners of 90 degrees or more, so it reaches back to (t/2) (1/sin(g/2) - sqrt 2) at most; one that is hit on both
  sides of the gap shows a corner that reaches back to (cos - sin)(g/2) of that. Nearer than the product of both the
  sector is known, further out it is not, whatever its two beams say: that is `sight`.

Everything else is unknown: beyond the ends of the beams, behind an edge (a jump in range is a line of sight past it),
in wide gaps between living beams (dropped beams read nan and count as none), outside a limited field of view, which is
a gap like any other, and all around when no beam lives. The border of the known ground comes as points with radii that
cover it: a disc or a polygon that moves without touching them has left it nowhere. What adjoins the robot itself in
directions that were not seen is a border SKIN away from its rim: any motion that pushes the rim that way is refused at
once, motion along it or away from it is not. So a disc may turn in place when it sees nothing at all; it may drive
straight with a view of 180 degrees (less 10 for the skin). A narrower view does not show the ground that the rim sweeps
beside its apex: an obstacle may stand there after a turn in place. Such a robot only turns, and ends as blind, unless
it is told that it may drive (`Params.blind`) or knows a map. A robot that brakes on an arc that was known when it chose
the arc stays on known ground, whatever it sees on the way.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fuzzynav.geometry import Array

__all__ = ["SEAM", "SKIN", "border", "known_sectors", "sight"]

SEAM = 0.05  # [m] between two points of the border of what was seen
SPREAD = 0.04  # the same along a line of sight, as a share of the distance, where that is more
SKIN = 0.001  # [m] between the rim and unseen ground that adjoins it
FAR = 200.0  # [m] no beam is believed further


@njit(cache=True)
def sight(gap: float, thinnest: float) -> float:
    """How far [m] the ground between two beams `gap` [rad] apart is known, when both of them reach further."""
    if gap >= 0.5 * np.pi:
        return 0.0
    half = 0.5 * gap
    if half <= 0.0:
        return np.inf
    far: float = 0.5 * thinnest * (1.0 / np.sin(half) - np.sqrt(2.0))
    return max(far, 0.0) * float(np.cos(half) - np.sin(half))


@njit(cache=True)
def _living(ranges: Array, angles: Array, heading: float, range_max: float) -> tuple[Array, Array, Array]:
    """Ends [m], bearings [rad] and gaps [rad] to the next of the beams that read something, counter-clockwise.

    The gaps add up to one turn.
    """
    ends, bearings = np.empty(ranges.size), np.empty(ranges.size)
    k = 0
    for i in range(ranges.size):
        if not np.isnan(ranges[i]):
            ends[k], bearings[k] = min(max(ranges[i], 0.0), range_max, FAR), heading + angles[i]
            k += 1
    ends, bearings = ends[:k], bearings[:k]
    rising = True
    for i in range(1, k):
        rising = rising and bearings[i] >= bearings[i - 1]
    if k > 0 and not (rising and bearings[k - 1] - bearings[0] < 2.0 * np.pi):
        order = np.argsort(bearings % (2.0 * np.pi))
        ends, bearings = ends[order], bearings[order]
    gaps = np.zeros(k)
    for i in range(k):
        gaps[i] = (bearings[i + 1 if i + 1 < k else 0] - bearings[i]) % (2.0 * np.pi)
    if k > 0 and gaps.sum() < np.pi:  # all beams look the same way
        gaps[k - 1] = 2.0 * np.pi
    return ends, bearings, gaps


@njit(cache=True)
def known_sectors(
    ranges: Array, angles: Array, heading: float, range_max: float, thinnest: float
) -> tuple[Array, Array, Array, Array]:
    """Ends [m], bearings [rad], gaps [rad] to the next, and how far [m] each gap is known: inf as far as its ends."""
    ends, bearings, gaps = _living(ranges, angles, heading, range_max)
    known = np.full(ends.size, np.inf)
    for i in range(ends.size):
        far = sight(gaps[i], thinnest)
        if min(ends[i], ends[i + 1 if i + 1 < ends.size else 0]) > far:
            known[i] = far
    return ends, bearings, gaps, known


@njit(cache=True)
def _room(rows: Array, size: int, more: int) -> Array:
    """The same rows, with room for `more` after the first `size`."""
    while size + more > rows.shape[0]:
        rows = np.concatenate((rows, np.empty_like(rows)))
    return rows


@njit(cache=True)
def _rim(bearing: float, radius: float, corners: Array) -> float:
    """Distance [m] from the robot's centre to its rim in a direction of its own frame."""
    if corners.shape[0] == 0:
        return radius
    c, s = np.cos(bearing), np.sin(bearing)
    away = np.inf
    for k in range(corners.shape[0]):
        ax, ay = corners[k - 1, 0], corners[k - 1, 1]
        nx, ny = corners[k, 1] - ay, ax - corners[k, 0]  # outward
        across = nx * c + ny * s
        if across > 0.0:
            away = min(away, (nx * ax + ny * ay) / across)
    return away


@njit(cache=True)
def _along(rows: Array, count: int, bearing: float, first: float, last: float, size: float) -> tuple[Array, int]:
    """Border along one beam from `first` to `last` [m]; within `size`, beside a polygon, without radius."""
    at = first
    while at < last:
        step = min(max(SEAM, SPREAD * at), last - at)
        rows = _room(rows, count, 1)
        rows[count, 0], rows[count, 1] = bearing, at + 0.5 * step
        rows[count, 2] = 0.5 * step if at >= size else 0.0
        count += 1
        at += step
    return rows, count


@njit(cache=True)
def _across(
    rows: Array, count: int, bearing: float, gap: float, known: float, size: float, corners: Array, heading: float
) -> tuple[Array, int]:
    """Border between two beams at `known` [m], or at the robot's own rim where that is further out."""
    parts = max(int(np.ceil(gap * max(known, size) / SEAM)), 1)
    rows = _room(rows, count, parts + 1)
    for p in range(parts + 1):
        at = bearing + gap * p / parts
        rows[count, 0], rows[count, 1] = at, max(known, _rim(at - heading, size, corners) + SKIN)
        rows[count, 2] = min(0.5 * gap * known / parts, max(known - size - SKIN, 0.0))
        count += 1
    return rows, count


@njit(cache=True)
def _holes(
    ends: Array, bearings: Array, gaps: Array, known: Array, size: float, corners: Array, heading: float
) -> Array:
    """Border (bearing, distance, radius) of every gap that is known less far than its beams reach.

    known: [m] of each gap, inf where the beams' own ends bound it.
    """
    k = ends.size
    rows, count = np.empty((64, 3)), 0
    if k == 0:
        rows, count = _across(rows, count, 0.0, 2.0 * np.pi, 0.0, size, corners, heading)
    for i in range(k):
        if known[i] == np.inf:
            continue
        rows, count = _across(rows, count, bearings[i], gaps[i], known[i], size, corners, heading)
        j = i + 1 if i + 1 < k else 0
        for beam, beside in ((i, i - 1), (j, j)):  # the beams of the gap, and the gaps on their other sides
            first = max(known[i], _rim(bearings[beam] - heading, size, corners) + SKIN)
            rows, count = _along(rows, count, bearings[beam], first, min(ends[beam], known[beside]), size)
    return rows[:count]


@njit(cache=True)
def border(
    ranges: Array, angles: Array, pose: Array, range_max: float, size: float, corners: Array, thinnest: float
) -> tuple[Array, Array, int]:
    """Border of the known ground: points (n, 2) with radii (n,), and how many of them, the first, bound gaps.

    `size` is the radius of the disc around the robot; `corners` (m, 2) its footprint, empty for the disc itself. The
    others stand at the ends of the beams: between two neighbouring beams whatever is convex, has no corner under 90
    degrees and is wider than the gap shows itself within one gap of a hit, so that every end takes the gap for its
    radius. A jump in range is a line of sight past an edge; behind it nothing is known, so points are strewn along it.
    """
    ends, bearings, gaps, known = known_sectors(ranges, angles, pose[2], range_max, thinnest)
    k = ends.size
    rows = _holes(ends, bearings, gaps, known, size, corners, pose[2])
    holes = rows.shape[0]
    out = np.empty((64 + 2 * k + holes, 3))
    for i in range(holes):
        out[i, 0] = pose[0] + rows[i, 1] * np.cos(rows[i, 0])
        out[i, 1] = pose[1] + rows[i, 1] * np.sin(rows[i, 0])
        out[i, 2] = rows[i, 2]
    count = holes
    for i in range(k):
        j = i + 1 if i + 1 < k else 0
        whole, before = known[i] == np.inf, known[i - 1] == np.inf
        if not (whole or before):
            continue
        ax, ay = ends[i] * np.cos(bearings[i]), ends[i] * np.sin(bearings[i])
        bx, by = ends[j] * np.cos(bearings[j]), ends[j] * np.sin(bearings[j])
        way = np.sqrt((bx - ax) ** 2 + (by - ay) ** 2) if whole and gaps[i] > 0.0 else 0.0
        parts = max(int(np.ceil(way / SEAM)), 1) if way > 1.5 * max(ends[i], ends[j]) * gaps[i] else 1
        out = _room(out, count, parts)
        for p in range(parts):
            u = p / parts
            out[count, 0], out[count, 1] = pose[0] + ax + u * (bx - ax), pose[1] + ay + u * (by - ay)
            if p == 0:
                out[count, 2] = ends[i] * max(gaps[i] if whole else 0.0, gaps[i - 1] if before else 0.0)
            else:
                out[count, 2] = max(gaps[i] * min(ends[i], ends[j]), 0.5 * SEAM)
            count += 1
    return out[:count, :2].copy(), out[:count, 2].copy(), holes


def _warm() -> None:
    """Compile every kernel for the types used in practice."""
    angles = np.array([-1.0, 0.0, 1.0])
    for corners in (np.empty((0, 2)), np.array([[0.2, -0.2], [0.2, 0.2], [-0.2, 0.0]])):
        border(np.array([2.0, np.nan, 1.0]), angles, np.zeros(3), 5.0, 0.3, corners, 0.2)
