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
from fuzzynav.maps.kernels import Mask, Record, distance_at, framed

__all__ = ["BEAM", "CLUSTER", "DISC", "RULES", "Row", "Rows", "discs", "fit_disc", "seen_free", "segment"]

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
        ],
    )
)
BEAM = np.dtype(  # a beam that measured something, if only that nothing is near: counter-clockwise, in the world frame
    (np.record, [("x", "f8"), ("y", "f8"), ("range", "f8"), ("bearing", "f8"), ("gap", "f8"), ("which", "i8")])
)
CLUSTER = np.dtype((np.record, [("first", "i8"), ("count", "i8"), ("right_open", "i8"), ("left_open", "i8")]))
DISC = np.dtype(
    (
        np.record,
        [
            ("x", "f8"),
            ("y", "f8"),
            ("radius", "f8"),
            ("xx", "f8"),  # variances of the centre [m^2]
            ("xy", "f8"),
            ("yy", "f8"),
            ("spread", "f8"),  # [m] standard deviation of the radius
            ("misfit", "f8"),  # [m] root mean square distance of the hits from the rim
        ],
    )
)
Rows = NDArray[np.void]  # an array of records
Row = Any  # one of them
STEPS = 5  # of Gauss and Newton; the fourth changes less than a micrometre
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
def _open_side(edge: float, beyond: float, gap: float, limit: float, bound: float) -> int:
    """1 where the beam beside a cluster passes it and ends further away; 0 where that side may be hidden."""
    return 1 if gap <= limit and beyond > edge + bound else 0


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
    """Beams (not nan, counter-clockwise, a cluster is a slice of them) and clusters of a scan.

    A beam without a hit ends at range_max, one that is blinded at 0. Without a chart `occupied` has no row.
    """
    rule = rules[0]
    order = _counter_clockwise(ranges, angles)
    m = order.size
    raw = np.empty(m, dtype=BEAM)
    usable = np.zeros(m, dtype=np.bool_)
    widest = 0.0
    for j in range(m):
        i = order[j]
        raw[j].which, raw[j].bearing = i, pose[2] + angles[i]
        after = angles[order[j + 1 if j + 1 < m else 0]]
        raw[j].gap = (after - angles[i]) % TURN if m > 1 else TURN
        widest = max(widest, raw[j].gap)
        hit = ranges[i] > -np.inf and ranges[i] < np.inf
        r = min(max(ranges[i], 0.0), range_max, 1e6)
        raw[j].range = r
        raw[j].x, raw[j].y = pose[0] + r * np.cos(raw[j].bearing), pose[1] + r * np.sin(raw[j].bearing)
        usable[j] = hit and not _explained(raw[j].x, raw[j].y, occupied, field, frame, rule.chart_tolerance)
    limit = rule.bridge * (TURN - widest) / max(m - 1, 1)
    bound = np.empty(m)
    joined = np.zeros(m, dtype=np.bool_)
    start = 0
    for j in range(m):
        k = j + 1 if j + 1 < m else 0
        near, far, gap = min(raw[j].range, raw[k].range), max(raw[j].range, raw[k].range), raw[j].gap
        s = near * gap
        bound[j] = np.sqrt(s * s + 2.0 * rule.radius_max * s) + 3.0 * rule.range_noise
        if usable[j] and usable[k] and gap <= limit and k != j:
            apart = (far - near) ** 2 + 2.0 * far * near * (1.0 - np.cos(gap))
            joined[j] = apart <= bound[j] ** 2
        if not joined[j] and start == 0:
            start = k
    beams = np.empty(m, dtype=BEAM)
    for j in range(m):
        beams[j] = raw[(start + j) % m]
    found = np.empty(m, dtype=CLUSTER)
    n = 0
    first = 0
    for j in range(m):
        here = (start + j) % m
        if j < m - 1 and joined[here]:
            continue
        count = j + 1 - first
        if usable[here] and count >= rule.beams_min:
            before = (start + first - 1) % m
            after = (here + 1) % m
            found[n].first, found[n].count = first, count
            opening = count < m
            found[n].right_open = opening and _open_side(
                beams[first].range, raw[before].range, raw[before].gap, limit, bound[before]
            )
            found[n].left_open = opening and _open_side(
                beams[j].range, raw[after].range, raw[here].gap, limit, bound[here]
            )
            n += 1
        first = j + 1
    return beams, found[:n]


@njit(cache=True)
def fit_disc(
    beams: Rows,
    cluster: Row,
    pose: Array,
    known: float,
    doubt: float,
    rules: Record,
    out: Row,
) -> None:
    """Write into `out` the disc of one cluster, its radius known before as `known` with standard deviation `doubt`."""
    rule = rules[0]
    first, last = cluster.first, cluster.first + cluster.count - 1
    left = beams[last].bearing + 0.5 * beams[last].gap
    before = beams[first - 1 if first > 0 else beams.size - 1].gap
    right = beams[first].bearing - 0.5 * before
    nearest = np.inf
    for j in range(first, last + 1):
        nearest = min(nearest, beams[j].range)
    middle = beams[first].bearing + 0.5 * ((beams[last].bearing - beams[first].bearing) % TURN)
    radius = min(max(known, rule.radius_min), rule.radius_max)
    if cluster.right_open and cluster.left_open:  # tangent to both lines of sight, touching the nearest range
        middle = right + 0.5 * ((left - right) % TURN)
        wide = np.sin(min(0.5 * ((left - right) % TURN), 1.4))
        guess = min(max(nearest * wide / (1.0 - wide), rule.radius_min), rule.radius_max)
        radius = guess if doubt >= rule.radius_spread else radius
    u, v = np.cos(middle), np.sin(middle)
    x, y = pose[0] + (nearest + radius) * u, pose[1] + (nearest + radius) * v
    start_x, start_y, loose = x, y, 1.0 / rule.radius_max**2
    weight = 1.0 / rule.range_noise**2
    a = b = c = d = e = f = 0.0  # the normal equations: xx, xy, xr, yy, yr, rr
    for _ in range(STEPS):
        a, b, c, d, e, f = loose, 0.0, 0.0, loose, 0.0, 1.0 / doubt**2
        p, q, s = loose * (x - start_x), loose * (y - start_y), (radius - known) / doubt**2
        for j in range(first, last + 1):
            gx, gy = x - beams[j].x, y - beams[j].y
            away = max(np.hypot(gx, gy), 1e-9)
            gx, gy = gx / away, gy / away
            miss = away - radius
            a, b, c = a + weight * gx * gx, b + weight * gx * gy, c - weight * gx
            d, e, f = d + weight * gy * gy, e - weight * gy, f + weight
            p, q, s = p + weight * gx * miss, q + weight * gy * miss, s - weight * miss
        for side in range(2):
            if (side == 0 and not cluster.left_open) or (side == 1 and not cluster.right_open):
                continue
            bearing = left if side == 0 else right
            gap = beams[last].gap if side == 0 else before
            reach = beams[last].range if side == 0 else beams[first].range
            sign = 1.0 if side == 0 else -1.0
            gx, gy = -sign * np.sin(bearing), sign * np.cos(bearing)
            miss = gx * (x - pose[0]) + gy * (y - pose[1]) + radius
            w = 12.0 / max(reach * gap, rule.range_noise) ** 2  # an edge is anywhere between two beams
            a, b, c = a + w * gx * gx, b + w * gx * gy, c + w * gx
            d, e, f = d + w * gy * gy, e + w * gy, f + w
            p, q, s = p + w * gx * miss, q + w * gy * miss, s + w * miss
        det = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d)
        x -= ((d * f - e * e) * p + (c * e - b * f) * q + (b * e - c * d) * s) / det
        y -= ((c * e - b * f) * p + (a * f - c * c) * q + (b * c - a * e) * s) / det
        radius -= ((b * e - c * d) * p + (b * c - a * e) * q + (a * d - b * b) * s) / det
        radius = min(max(radius, rule.radius_min), rule.radius_max)
    total = 0.0
    for j in range(first, last + 1):
        total += (np.hypot(x - beams[j].x, y - beams[j].y) - radius) ** 2
    more = max(total * weight / max(cluster.count - 1, 1), 1.0)  # no disc, or a worse scanner: believe it less
    det = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d)
    out.x, out.y, out.radius = x, y, radius
    out.xx, out.xy = more * (d * f - e * e) / det, more * (c * e - b * f) / det
    out.yy, out.spread = more * (a * f - c * c) / det, np.sqrt(more * (a * d - b * b) / det)
    out.misfit = np.sqrt(total / cluster.count)


@njit(cache=True)
def discs(beams: Rows, clusters: Rows, pose: Array, rules: Record) -> Rows:
    """A disc for each cluster, with nothing known before but radius_mean and radius_spread.

    A cluster that is wider than the largest disc, or fits none, has misfit inf.
    """
    rule = rules[0]
    out = np.empty(clusters.size, dtype=DISC)
    for k in range(clusters.size):
        first, last = clusters[k].first, clusters[k].first + clusters[k].count - 1
        out[k].misfit = np.inf
        wide = np.hypot(beams[last].x - beams[first].x, beams[last].y - beams[first].y)
        if wide > 2.0 * rule.radius_max + 6.0 * rule.range_noise:
            continue
        fit_disc(beams, clusters[k], pose, rule.radius_mean, rule.radius_spread, rules, out[k])
        if not out[k].misfit <= rule.misfit_max:
            out[k].misfit = np.inf
    return out


@njit(cache=True)
def seen_free(x: Array, y: Array, beams: Rows, pose: Array, margin: float) -> NDArray[np.bool_]:
    """Whether the scan `beams` from `pose` looked past each point: both beams beside it end further away.

    Further by `margin` [m] and half the way between the two beams there. A point in a wide gap was not seen.
    """
    out = np.zeros(x.size, dtype=np.bool_)
    m = beams.size
    if m < 2:
        return out
    base = beams[0].bearing
    for k in range(x.size):
        dx, dy = x[k] - pose[0], y[k] - pose[1]
        turn = (np.arctan2(dy, dx) - base) % TURN
        low, high = 0, m  # the last beam that is not left of the point
        while high - low > 1:
            mid = (low + high) // 2
            if (beams[mid].bearing - base) % TURN <= turn:
                low = mid
            else:
                high = mid
        gap = beams[low].gap
        if gap > 0.1:
            continue
        away = np.hypot(dx, dy)
        shorter = min(beams[low].range, beams[low + 1 if low + 1 < m else 0].range)
        out[k] = away + margin + 0.5 * gap * away < shorter
    return out


def _warm() -> None:
    """Compile every kernel with the types that the tracker hands over."""
    none, field = np.zeros((0, 0), dtype=np.bool_), np.zeros((0, 0))
    for array in (none, field):
        array.setflags(write=False)
    rules = np.array([(0.01, 0.1, 0.75, 0.35, 0.2, 0.05, 0.1, 0.05, 2, 3.5)], dtype=RULES)
    rules.setflags(write=False)
    angles, pose = np.linspace(-0.1, 0.1, 5), np.zeros(3)
    beams, found = segment(np.ones(5), angles, pose, 5.0, none, field, framed(1.0, (0.0, 0.0)), rules)
    discs(beams, found, pose, rules)
    seen_free(np.ones(1), np.zeros(1), beams, pose, 0.05)
