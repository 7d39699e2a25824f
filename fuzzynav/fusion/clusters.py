"""Compiled: what a scan shows of round things. Beams that belong together, a disc for each, and what was seen free.

Two neighbouring beams belong together when their hits are nearer than what one disc of radius_max can put between
them. With s = range x gap between the beams, the widest step lies at its rim, where one beam is tangent: it is
sqrt(2 radius_max s) in depth and s across.

A disc is fitted by least squares to the distances of the hits from its rim, to the two lines of sight that just pass
it (half a gap beside its outermost beams, on a side where what lies behind is further away), and to a radius known
before with its doubt. Where a nearer thing, the end of the field of view or a lost beam hides a side, the line of sight
there says nothing and is left out: the known radius then carries the fit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fuzzynav.geometry import Array
from fuzzynav.maps.kernels import Mask, Record, distance_at

__all__ = ["BEAM", "GROUP", "RULES", "Row", "Rows", "at_bearing", "fit_disc", "looked_past", "observe", "segment"]

RULES = np.dtype(
    (
        np.record,
        [
            ("range_noise", "f8"),
            ("radius_min", "f8"),
            ("radius_max", "f8"),
            ("radius_mean", "f8"),
            ("radius_spread", "f8"),
            ("misfit_max", "f8"),
            ("chart_tolerance", "f8"),
            ("free_margin", "f8"),
            ("beams_min", "i8"),
            ("bridge", "f8"),
            ("velocity_bound", "f8"),
            ("acceleration", "f8"),
            ("turn_share", "f8"),
            ("gate", "f8"),
            ("confirm", "i8"),
            ("coast", "f8"),
            ("patience", "f8"),
            ("proof_share", "f8"),
            ("proofs", "f8"),
            ("speed_min", "f8"),
            ("drift", "f8"),
            ("witnesses", "i8"),
        ],
    )
)
BEAM = np.dtype(  # a beam that measured something, if only that nothing is near: counter-clockwise, in the world frame
    (
        np.record,
        [
            ("x", "f8"),
            ("y", "f8"),
            ("range", "f8"),
            ("bearing", "f8"),
            ("turn", "f8"),  # [rad] from the first beam
            ("gap", "f8"),  # [rad] to the next beam
            ("which", "i8"),  # its place in the scan
            ("owner", "i8"),  # the track that it hit; NOBODY, or NOTHING where there is no hit to explain
        ],
    )
)
GROUP = np.dtype(  # a cluster, which is a slice of the beams, and its disc
    (
        np.record,
        [
            ("first", "i8"),
            ("count", "i8"),
            ("right_open", "i8"),
            ("left_open", "i8"),
            ("carved", "i8"),  # 1: cut out of a larger cluster where a track was expected
            ("x", "f8"),
            ("y", "f8"),
            ("radius", "f8"),
            ("xx", "f8"),  # variances of the centre [m^2]
            ("xy", "f8"),
            ("yy", "f8"),
            ("spread", "f8"),  # [m] standard deviation of the radius
            ("misfit", "f8"),  # [m] root mean square distance of the hits from the rim; inf: no disc
        ],
    )
)
NOBODY, NOTHING = -1, -2
WIDE = 0.2  # [rad] what lies in a wider gap between two beams was not seen
Rows = NDArray[np.void]  # an array of records
Row = Any  # one of them
STEPS = 8  # of Gauss and Newton at most
ENOUGH = 1e-6  # [m] after a shorter step they end
TURN = 2.0 * np.pi


@njit(cache=True)
def _counter_clockwise(ranges: Array, angles: Array) -> NDArray[np.int64]:
    """Indices of the beams that are not nan, in the order of their bearings."""
    order = np.empty(ranges.size, dtype=np.int64)
    m = 0
    rising = True
    for i in range(ranges.size):
        if not np.isnan(ranges[i]):
            rising = rising and (m == 0 or angles[i] >= angles[order[m - 1]])
            order[m] = i
            m += 1
    order = order[:m]
    if m > 1 and not (rising and angles[order[m - 1]] - angles[order[0]] < TURN):
        order = order[np.argsort(angles[order] % TURN)]
    return order


@njit(cache=True)
def _explained(x: float, y: float, occupied: Mask, field: Array, frame: Record, tolerance: float) -> bool:
    """Whether a hit lies within the tolerance of an occupied cell of the chart or of its border."""
    if occupied.shape[0] == 0:
        return False
    size = frame[0].resolution
    u, v = (x - frame[0].x) / size, (y - frame[0].y) / size
    rows, cols = occupied.shape
    if not (0.0 < u < cols and 0.0 < v < rows):
        return True
    if field[int(v), int(u)] - 0.71 > tolerance / size:
        return False
    return bool(distance_at(occupied, field, u, v, True) * size <= tolerance)


@njit(cache=True)
def _bound(one: Row, other: Row, rules: Record) -> float:
    """How far apart [m] the hits of two neighbouring beams are at most if they belong together."""
    across = min(one.range, other.range) * one.gap
    return float(np.sqrt(across * (across + 2.0 * rules[0].radius_max)) + 3.0 * rules[0].range_noise)


@njit(cache=True)
def _open_side(beams: Rows, edge: int, beside: int, limit: float, rules: Record) -> int:
    """1 where the beam beside the edge of a cluster passes it and ends further away; 0 where that side may hide."""
    k = beside % beams.size
    right = beams[k if beside < edge else edge]
    if right.gap > limit:
        return 0
    other = beams[edge if beside < edge else k]
    return 1 if beams[k].range > beams[edge].range + _bound(right, other, rules) else 0


@njit(cache=True)
def _between_tangents(nearest: float, half: float) -> float:
    """Radius [m] of the disc at this nearest range that fills this half angle [rad]."""
    sine = np.sin(min(half, 1.4))
    return float(nearest * sine / (1.0 - sine))


@njit(cache=True)
def segment(
    ranges: Array,
    angles: Array,
    pose: Array,
    range_max: float,
    occupied: Mask,
    field: Array,
    frame: Record,
    rules: Record,
) -> tuple[Rows, Rows]:
    """Beams (those that are not nan, counter-clockwise) and the clusters among them, each a slice, without discs.

    A beam without a hit ends at range_max, one that is blinded at 0. Without a chart `occupied` has no row.
    """
    rule = rules[0]
    order = _counter_clockwise(ranges, angles)
    m = order.size
    raw = np.empty(m, dtype=BEAM)
    widest = 0.0
    for j in range(m):
        i = order[j]
        beam = raw[j]
        beam.which, beam.bearing = i, pose[2] + angles[i]
        beam.gap = (angles[order[j + 1 if j + 1 < m else 0]] - angles[i]) % TURN if m > 1 else TURN
        widest = max(widest, beam.gap)
        beam.range = min(max(ranges[i], 0.0), range_max, 1e6)
        beam.x = pose[0] + beam.range * np.cos(beam.bearing)
        beam.y = pose[1] + beam.range * np.sin(beam.bearing)
        beam.owner = NOTHING
        if ranges[i] > -np.inf and ranges[i] < np.inf:
            if not _explained(beam.x, beam.y, occupied, field, frame, rule.chart_tolerance):
                beam.owner = NOBODY
    limit = rule.bridge * (TURN - widest) / max(m - 1, 1)
    joined = np.zeros(m, dtype=np.bool_)
    start = 0
    for j in range(m):
        k = j + 1 if j + 1 < m else 0
        if raw[j].owner == NOBODY and raw[k].owner == NOBODY and raw[j].gap <= limit and k != j:
            apart = (raw[j].x - raw[k].x) ** 2 + (raw[j].y - raw[k].y) ** 2
            joined[j] = apart <= _bound(raw[j], raw[k], rules) ** 2
        if start == 0 and not joined[j]:
            start = k
    beams = np.empty(m, dtype=BEAM)
    for j in range(m):
        beams[j] = raw[(start + j) % m]
        beams[j].turn = (beams[j].bearing - beams[0].bearing) % TURN
    found = np.empty(m, dtype=GROUP)
    n = first = 0
    for j in range(m):
        if j < m - 1 and joined[(start + j) % m]:
            continue
        count = j + 1 - first
        if beams[j].owner == NOBODY and count >= rule.beams_min:
            group = found[n]
            group.first, group.count, group.carved, group.misfit = first, count, 0, np.inf
            group.right_open = group.left_open = 0
            if count < m:
                group.right_open = _open_side(beams, first, first - 1, limit, rules)
                group.left_open = _open_side(beams, j, j + 1, limit, rules)
            n += 1
        first = j + 1
    return beams, found[:n]


@njit(cache=True)
def fit_disc(beams: Rows, group: Row, pose: Array, known: float, doubt: float, rules: Record) -> None:
    """Fit the disc of one cluster, whose radius is known before as `known` with the standard deviation `doubt`."""
    rule = rules[0]
    first, last = group.first, group.first + group.count - 1
    left = beams[last].bearing + 0.5 * beams[last].gap
    before = beams[first - 1 if first > 0 else beams.size - 1].gap
    right = beams[first].bearing - 0.5 * before
    nearest = np.inf
    for j in range(first, last + 1):
        nearest = min(nearest, beams[j].range)
    middle = beams[first].bearing + 0.5 * (beams[last].turn - beams[first].turn)
    radius = min(max(known, rule.radius_min), rule.radius_max)
    if group.right_open and group.left_open and doubt >= rule.radius_spread:
        half = 0.5 * (beams[last].turn - beams[first].turn) + 0.25 * (before + beams[last].gap)
        radius = min(max(_between_tangents(nearest, half), rule.radius_min), rule.radius_max)
    x, y = pose[0] + (nearest + radius) * np.cos(middle), pose[1] + (nearest + radius) * np.sin(middle)
    start_x, start_y, loose = x, y, 1.0 / rule.radius_max**2
    weight = 1.0 / rule.range_noise**2
    a = b = c = d = e = f = 0.0  # the normal equations: xx, xy, xr, yy, yr, rr
    for _ in range(STEPS):
        a, b, c, d, e, f = loose, 0.0, 0.0, loose, 0.0, 1.0 / doubt**2
        p, q, s = loose * (x - start_x), loose * (y - start_y), (radius - known) / doubt**2
        for j in range(first, last + 1):
            gx, gy = x - beams[j].x, y - beams[j].y
            away = max(np.sqrt(gx * gx + gy * gy), 1e-9)
            gx, gy = gx / away, gy / away
            miss = away - radius
            a, b, c = a + weight * gx * gx, b + weight * gx * gy, c - weight * gx
            d, e, f = d + weight * gy * gy, e - weight * gy, f + weight
            p, q, s = p + weight * gx * miss, q + weight * gy * miss, s - weight * miss
        for side in range(2):
            if (side == 0 and not group.left_open) or (side == 1 and not group.right_open):
                continue
            bearing = left if side == 0 else right
            wide = beams[last].gap * beams[last].range if side == 0 else before * beams[first].range
            sign = 1.0 if side == 0 else -1.0
            gx, gy = -sign * np.sin(bearing), sign * np.cos(bearing)
            miss = gx * (x - pose[0]) + gy * (y - pose[1]) + radius
            w = 12.0 / max(wide, rule.range_noise) ** 2  # an edge is anywhere between two beams
            a, b, c = a + w * gx * gx, b + w * gx * gy, c + w * gx
            d, e, f = d + w * gy * gy, e + w * gy, f + w
            p, q, s = p + w * gx * miss, q + w * gy * miss, s + w * miss
        det = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d)
        step_x = ((d * f - e * e) * p + (c * e - b * f) * q + (b * e - c * d) * s) / det
        step_y = ((c * e - b * f) * p + (a * f - c * c) * q + (b * c - a * e) * s) / det
        x, y = x - step_x, y - step_y
        radius -= ((b * e - c * d) * p + (b * c - a * e) * q + (a * d - b * b) * s) / det
        radius = min(max(radius, rule.radius_min), rule.radius_max)
        if abs(step_x) + abs(step_y) < ENOUGH:
            break
    total = 0.0
    for j in range(first, last + 1):
        total += (np.hypot(x - beams[j].x, y - beams[j].y) - radius) ** 2
    more = max(total * weight / max(group.count - 1, 1), 1.0)  # no disc, or a worse scanner: believe it less
    det = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d)
    group.x, group.y, group.radius = x, y, radius
    group.xx, group.xy = more * (d * f - e * e) / det, more * (c * e - b * f) / det
    group.yy, group.spread = more * (a * f - c * c) / det, np.sqrt(more * (a * d - b * b) / det)
    group.misfit = np.sqrt(total / group.count)


@njit(cache=True)
def observe(
    ranges: Array,
    angles: Array,
    pose: Array,
    range_max: float,
    occupied: Mask,
    field: Array,
    frame: Record,
    rules: Record,
) -> tuple[Rows, Rows]:
    """Beams and clusters as by `segment`, with a disc for each that is one, its radius known as by RULES only."""
    rule = rules[0]
    beams, groups = segment(ranges, angles, pose, range_max, occupied, field, frame, rules)
    for k in range(groups.size):
        first, last = groups[k].first, groups[k].first + groups[k].count - 1
        wide = np.hypot(beams[last].x - beams[first].x, beams[last].y - beams[first].y)
        if wide <= 2.0 * rule.radius_max + 6.0 * rule.range_noise:
            fit_disc(beams, groups[k], pose, rule.radius_mean, rule.radius_spread, rules)
            if not groups[k].misfit <= rule.misfit_max:
                groups[k].misfit = np.inf
    return beams, groups


@njit(cache=True)
def at_bearing(beams: Rows, bearing: float) -> int:
    """Index of the last beam that is not left of a bearing [rad], counted counter-clockwise from the first."""
    last = beams.size - 1
    turn = (bearing - beams[0].bearing) % TURN
    j = min(int(turn / max(beams[last].turn, 1e-9) * last), last)  # beams are mostly even
    while j < last and beams[j + 1].turn <= turn:
        j += 1
    while j > 0 and beams[j].turn > turn:
        j -= 1
    return j


@njit(cache=True)
def looked_past(beams: Rows, pose: Array, x: float, y: float, margin: float) -> bool:
    """Whether the scan `beams` from `pose` saw the point free: both beams beside it end further away.

    Further by `margin` [m] and half the way between the two beams there. A point in a wide gap was not seen.
    """
    if beams.size < 2:
        return False
    dx, dy = x - pose[0], y - pose[1]
    j = at_bearing(beams, np.arctan2(dy, dx))
    gap, away = beams[j].gap, np.hypot(dx, dy)
    if gap > WIDE:
        return False
    shorter = min(beams[j].range, beams[j + 1 if j + 1 < beams.size else 0].range)
    return bool(away + margin + 0.5 * gap * away < shorter)


def _warm() -> None:
    """Compile what the others call; the tracker's warming compiles the rest with its own types."""
    beams = np.zeros(2, dtype=BEAM)
    beams["gap"] = np.pi
    looked_past(beams, np.zeros(3), 1.0, 0.0, 0.05)
