"""Compiled work on output sets: clipping, joining, and the way back to a number.

The readable versions are in `defuzzify`; tests hold the two together.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from fuzzynav.fuzzy import codes
from fuzzynav.fuzzy.compiled import Codes, Parts
from fuzzynav.fuzzy.kernels import conorm, inverse_member, norm
from fuzzynav.geometry import Array

__all__ = ["aggregate", "exact_centroid", "max_min_centroid", "of_samples", "weighted"]


@njit(cache=True)
def _clip(a: Array, b: Array, c: Array, m: Array, w: Array, wx: Array, area: Array, moment: Array) -> None:
    """Add four samples of max(min(a, m[0]), min(b, m[1]), min(c, m[2])) to the area and the moment."""
    a0, a1, a2, a3 = m[0, 0], m[0, 1], m[0, 2], m[0, 3]
    b0, b1, b2, b3 = m[1, 0], m[1, 1], m[1, 2], m[1, 3]
    c0, c1, c2, c3 = m[2, 0], m[2, 1], m[2, 2], m[2, 3]
    w0, w1, w2, w3 = w[0], w[1], w[2], w[3]
    x0, x1, x2, x3 = wx[0], wx[1], wx[2], wx[3]
    for p in range(a.size):
        ap, bp, cp = a[p], b[p], c[p]
        u0 = ap if ap < a0 else a0
        v = bp if bp < b0 else b0
        u0 = u0 if u0 > v else v
        v = cp if cp < c0 else c0
        u0 = u0 if u0 > v else v
        u1 = ap if ap < a1 else a1
        v = bp if bp < b1 else b1
        u1 = u1 if u1 > v else v
        v = cp if cp < c1 else c1
        u1 = u1 if u1 > v else v
        u2 = ap if ap < a2 else a2
        v = bp if bp < b2 else b2
        u2 = u2 if u2 > v else v
        v = cp if cp < c2 else c2
        u2 = u2 if u2 > v else v
        u3 = ap if ap < a3 else a3
        v = bp if bp < b3 else b3
        u3 = u3 if u3 > v else v
        v = cp if cp < c3 else c3
        u3 = u3 if u3 > v else v
        area[p] += (w0 * u0 + w1 * u1) + (w2 * u2 + w3 * u3)
        moment[p] += (x0 * u0 + x1 * u1) + (x2 * u2 + x3 * u3)


@njit(cache=True)
def _clip_many(h: Array, used: Codes, n: int, m: Array, w: Array, wx: Array, area: Array, moment: Array) -> None:
    for p in range(h.shape[1]):
        for j in range(4):
            u = 0.0
            for k in range(n):
                v = min(h[used[k], p], m[k, j])
                u = u if u > v else v
            area[p] += w[j] * u
            moment[p] += wx[j] * u


@njit(cache=True)
def _one_by_one(h: Array, rows: Array, sampled: Array, area: Array, moment: Array) -> None:
    """As `max_min_centroid`, for the few points that do not fill a vector register."""
    for p in range(h.shape[1]):
        total, turn = 0.0, 0.0
        for s in range(rows.shape[1]):
            u = 0.0
            for k in range(h.shape[0]):
                v = h[k, p] if h[k, p] < rows[k, s] else rows[k, s]
                u = u if u > v else v
            total += sampled[codes.WEIGHTS, s] * u
            turn += sampled[codes.WEIGHTS, s] * sampled[codes.PLACES, s] * u
        area[p], moment[p] = total, turn


@njit(cache=True)
def max_min_centroid(h: Array, rows: Array, sampled: Array, area: Array, moment: Array) -> None:
    """Area and moment (width,) of the max of the sets `rows` (n, samples) clipped at h (n, width)."""
    if area.size < 4:
        _one_by_one(h, rows, sampled, area, moment)
        return
    samples, sets = rows.shape[1], h.shape[0]
    used, m = np.zeros(sets + 3, np.int64), np.zeros((sets + 3, 4))
    w, wx = np.zeros(4), np.zeros(4)
    for p in range(area.size):
        area[p], moment[p] = 0.0, 0.0
    for s in range(0, samples, 4):
        count = min(4, samples - s)
        for j in range(4):
            w[j] = sampled[codes.WEIGHTS, s + j] if j < count else 0.0
            wx[j] = w[j] * sampled[codes.PLACES, s + j] if j < count else 0.0
        n = 0
        for k in range(sets):
            top = 0.0
            for j in range(count):
                m[n, j] = rows[k, s + j]
                top = max(top, m[n, j])
            if top > 0.0:
                used[n] = k
                n += 1
        for k in range(n, 3):
            for j in range(4):
                m[k, j] = 0.0
        if 0 < n <= 3:
            _clip(h[used[0]], h[used[1]], h[used[2]], m, w, wx, area, moment)
        elif n > 3:
            _clip_many(h, used, n, m, w, wx, area, moment)


@njit(cache=True)
def aggregate(h: Array, rows: Array, implied: Codes, code: int, mu: Array) -> None:
    """Aggregated set mu (width, samples) of the sets `rows`, implied with h, joined with conorm `code`."""
    for p in range(mu.shape[0]):
        here = mu[p]
        for s in range(here.size):
            here[s] = 0.0
        for k in range(h.shape[0]):
            strength, implication = h[k, p], implied[k]
            if not strength > 0.0:
                continue
            if code == codes.MAX and implication == codes.PRODUCT:
                for s in range(here.size):
                    u = rows[k, s] * strength
                    here[s] = here[s] if here[s] > u else u
            else:
                for s in range(here.size):
                    here[s] = conorm(code, here[s], norm(implication, strength, rows[k, s]))


@njit(cache=True)
def _nearest_half(x: Array, w: Array, mu: Array, total: float) -> float:
    """Mean of the samples at which the area so far is nearest to half of the total."""
    done, best, places, count = 0.0, math.inf, 0.0, 0
    for s in range(mu.size):
        done += w[s] * mu[s]
        miss = abs(done / total - 0.5)
        if miss < best - 1e-12:
            best, places, count = miss, 0.0, 0
        if miss <= best + 1e-12:
            places += x[s]
            count += 1
    return places / count


@njit(cache=True)
def _bisector(x: Array, w: Array, mu: Array, quadrature: int) -> float:
    """The x that halves the area of the set mu: on the polyline (trapezoid), at the sample nearest to half, as
    FuzzyLite (midpoints), or at the first sample past half, as MATLAB (plain sum)."""
    n = mu.size
    total = 0.0
    for s in range(n):
        total += w[s] * mu[s]
    if total == 0.0:
        return math.nan
    if quadrature == codes.MIDPOINTS:
        return _nearest_half(x, w, mu, total)
    step = x[1] - x[0]
    done = 0.0
    for s in range(n):
        if quadrature == codes.TRAPEZOID_RULE:
            if s == n - 1:
                break
            a, b = mu[s], mu[s + 1]
            part = 0.5 * (a + b)
        else:
            a, b, part = mu[s], mu[s], mu[s] * w[s]
        if part > 0.0 and done + part >= 0.5 * total:
            need = 0.5 * total - done
            if quadrature == codes.PLAIN_SUM:
                return float(x[s])
            return float(x[s] + step * 2.0 * need / (a + math.sqrt(max(a * a + 2.0 * (b - a) * need, 0.0))))
        done += part
    return float(x[n - 1])


@njit(cache=True)
def of_samples(defuzzifier: int, quadrature: int, sampled: Array, mu: Array) -> float:
    """Crisp value of one aggregated set; nan when it is empty."""
    x, w = sampled[codes.PLACES], sampled[codes.WEIGHTS]
    if defuzzifier == codes.BISECTOR:
        return _bisector(x, w, mu, quadrature)
    area, moment, top = 0.0, 0.0, 0.0
    for s in range(mu.size):
        area += w[s] * mu[s]
        moment += w[s] * x[s] * mu[s]
        top = max(top, mu[s])
    if defuzzifier == codes.CENTROID:
        return moment / area if area > 0.0 else math.nan
    if not top > 0.0:
        return math.nan
    first, last, total, count = -1, -1, 0.0, 0
    for s in range(mu.size):
        if mu[s] >= top * (1.0 - 1e-12):
            first = s if first < 0 else first
            last = s
            total += x[s]
            count += 1
    if defuzzifier == codes.MEAN_OF_MAXIMUM:
        return total / count
    return float(x[first] if defuzzifier == codes.SMALLEST_OF_MAXIMUM else x[last])


@njit(cache=True)
def weighted(average: bool, h: Array, slots: Codes, t: Parts, x: Array) -> float:
    """Sum of strength times consequent over the rules, divided by the strengths if `average`; nan if none fires."""
    terms, lists, numbers = t.terms, t.lists, t.numbers
    total, weight = 0.0, 0.0
    for k in range(h.size):
        if h[k] > 0.0:
            term = slots[k, codes.SLOT_TERM]
            if terms[term, codes.SHAPE] == codes.LINEAR:
                first = terms[term, codes.FIRST]
                z = lists[first + x.size]
                for i in range(x.size):
                    z += lists[first + i] * x[i]
            else:
                z = inverse_member(terms[term, codes.SHAPE], numbers[term], h[k])
            total += h[k] * z
            weight += h[k]
    if weight == 0.0:
        return math.nan
    return total / weight if average else total


@njit(cache=True)
def _cuts(h: Array, implied: Codes, summed: bool, left: Array, right: Array, out: Array) -> int:
    """Where, in [0, 1], the aggregate of the lines may bend: written to `out`, sorted; returns how many."""
    n = h.size
    count = 1
    out[0] = 0.0
    for i in range(n):
        slope = right[i] - left[i]
        for j in range(n):
            if slope != 0.0 and implied[j] == codes.MIN and (i == j or not summed):
                t = (h[j] - left[i]) / slope
                if 0.0 < t < 1.0:
                    out[count] = t
                    count += 1
        for j in range(0 if summed else i):
            a, b = left[i] - left[j], right[i] - right[j]
            if a * b < 0.0:
                out[count] = a / (a - b)
                count += 1
    out[count] = 1.0
    for i in range(1, count):
        t, j = out[i], i
        while out[j - 1] > t:
            out[j] = out[j - 1]
            j -= 1
        out[j] = t
    return count + 1


@njit(cache=True)
def exact_centroid(knots: Array, lines: Array, h: Array, implied: Codes, summed: bool) -> float:
    """Centroid of the max (or sum) of clipped or scaled polygonal sets; nan when their area is 0.

    `knots` (m,) cut the range where a set bends; `lines` (m - 1, n, 2) holds each set at both ends of each piece, seen
    from inside the piece; `h` (n,) are the strengths; a set is clipped where `implied` (n,) is MIN, scaled where it is
    PRODUCT.
    """
    n = h.size
    cuts = np.empty(2 * n * n + n + 2)
    left, right = np.empty(n), np.empty(n)
    area, moment = 0.0, 0.0
    for piece in range(knots.size - 1):
        for k in range(n):
            scale = h[k] if implied[k] == codes.PRODUCT else 1.0
            left[k], right[k] = scale * lines[piece, k, 0], scale * lines[piece, k, 1]
        count = _cuts(h, implied, summed, left, right, cuts)
        width = knots[piece + 1] - knots[piece]
        before = 0.0
        for c in range(count):
            f = 0.0
            for k in range(n):
                g = left[k] + cuts[c] * (right[k] - left[k])
                if implied[k] == codes.MIN:
                    g = min(h[k], g)
                f = f + g if summed else max(f, g)
            if c > 0:
                dx = (cuts[c] - cuts[c - 1]) * width
                strip = 0.5 * dx * (before + f)
                area += strip
                moment += strip * (knots[piece] + cuts[c - 1] * width) + dx * dx * (before + 2.0 * f) / 6.0
            before = f
    return moment / area if area > 0.0 else math.nan


def _warm() -> None:
    h, implied, mu = np.full((1, 1), 0.5), np.zeros(1, np.int64), np.ones((1, 2))
    rows, sampled = np.ones((2, 3))[:1, :2], np.array([[0.0, 1.0, 2.0], [1.0, 1.0, 1.0]])[:, :2]
    aggregate(h, rows, implied, codes.MAX, mu)
    of_samples(codes.CENTROID, codes.TRAPEZOID_RULE, sampled, mu[0])
    max_min_centroid(h, rows, sampled, np.zeros(1), np.zeros(1))
    exact_centroid(np.array([0.0, 1.0]), np.ones((1, 1, 2)), h[0], implied, False)
