"""Compiled twins of the operators and the membership functions.

Everything is reached by codes and flat tables (see `compiled`), so that no system costs a compilation. The readable
versions are in `membership` and `operators`; tests hold the two together.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from fuzzynav.fuzzy import codes
from fuzzynav.geometry import Array

__all__ = ["conorm", "gaussian_row", "hedged", "inverse_member", "member", "norm"]


@njit(cache=True)
def norm(code: int, a: float, b: float) -> float:
    """Conjunction number `code` of `operators.NORMS`."""
    if code == codes.MIN:
        return a if a < b else b
    if code == codes.PRODUCT:
        return a * b
    if code == codes.BOUNDED_DIFFERENCE:
        return max(0.0, a + b - 1.0)
    if code == codes.DRASTIC:
        return min(a, b) if max(a, b) == 1.0 else 0.0
    if code == codes.EINSTEIN:
        return a * b / (2.0 - (a + b - a * b))
    if code == codes.HAMACHER:
        both = a + b - a * b
        return 0.0 if both == 0.0 else a * b / both
    return min(a, b) if a + b > 1.0 else 0.0


@njit(cache=True)
def conorm(code: int, a: float, b: float) -> float:
    """Disjunction number `code` of `operators.CONORMS`."""
    if code == codes.MAX:
        return a if a > b else b
    if code == codes.PROBABILISTIC_SUM:
        return a + b - a * b
    if code == codes.BOUNDED_SUM:
        return min(1.0, a + b)
    if code == codes.SUM:
        return a + b
    if code == codes.NORMALIZED_SUM:
        return (a + b) / max(1.0, a + b)
    if code == codes.DRASTIC_SUM:
        return max(a, b) if min(a, b) == 0.0 else 1.0
    if code == codes.EINSTEIN_SUM:
        return (a + b) / (1.0 + a * b)
    if code == codes.HAMACHER_SUM:
        gap = 1.0 - a * b
        return 1.0 if gap == 0.0 else 1.0 - (1.0 - a) * (1.0 - b) / gap
    return max(a, b) if a + b < 1.0 else 1.0


@njit(cache=True)
def hedged(code: int, m: float) -> float:
    """Membership m after hedge number `code` of `operators.HEDGES`."""
    if code == codes.NOT:
        return 1.0 - m
    if code == codes.VERY:
        return m * m
    if code == codes.SOMEWHAT:
        return math.sqrt(m)
    if code == codes.EXTREMELY:
        return 2.0 * m * m if m <= 0.5 else 1.0 - 2.0 * (1.0 - m) ** 2
    if code == codes.SELDOM:
        return math.sqrt(m / 2.0) if m <= 0.5 else 1.0 - math.sqrt(max(1.0 - m, 0.0) / 2.0)
    return 1.0


@njit(cache=True)
def _rise(x: float, a: float, b: float) -> float:
    if x >= b:
        return 1.0
    if a == b:
        return 0.0
    if math.isinf(a):
        return 1.0
    return 0.0 if x <= a else (x - a) / (b - a)


@njit(cache=True)
def _s(x: float, start: float, end: float) -> float:
    t = _rise(x, start, end)
    return 2.0 * t * t if t < 0.5 else 1.0 - 2.0 * (1.0 - t) ** 2


@njit(cache=True)
def _ramp(x: float, start: float, end: float) -> float:
    return _rise(x, start, end) if start <= end else _rise(-x, -start, -end)


@njit(cache=True)
def _gauss(x: float, mean: float, sigma: float) -> float:
    return math.exp(-((x - mean) ** 2) / (2.0 * sigma**2))


@njit(cache=True)
def _sigmoid(x: float, inflection: float, slope: float) -> float:
    power = -slope * (x - inflection)
    return 0.0 if power > 709.0 else 1.0 / (1.0 + math.exp(power))


@njit(cache=True)
def _concave(x: float, i: float, e: float) -> float:
    if i <= e:
        return (e - i) / (2.0 * e - i - x) if x < e else 1.0
    return (i - e) / (i - 2.0 * e + x) if x > e else 1.0


@njit(cache=True)
def _discrete(x: float, table: Array, at: int, n: int) -> float:
    if x < table[at]:
        return float(table[at + 1])
    for k in range(1, n):
        x1, y1 = table[at + 2 * k], table[at + 2 * k + 1]
        if x < x1:
            x0, y0 = table[at + 2 * k - 2], table[at + 2 * k - 1]
            return float(y0 + (y1 - y0) * ((x - x0) / (x1 - x0)))
    return float(table[at + 2 * n - 1])


@njit(cache=True)
def _other_member(code: int, p: Array, x: float, table: Array, at: int, n: int) -> float:
    if code == codes.RECTANGLE:
        return 1.0 if p[0] <= x <= p[1] else 0.0
    if code == codes.SINGLETON:
        return 1.0 if x == p[0] else 0.0
    if code == codes.BINARY:
        return 1.0 if (x >= p[0] if p[1] > 0.0 else x <= p[0]) else 0.0
    if code == codes.CONSTANT:
        return float(p[0])
    if code == codes.DISCRETE:
        return _discrete(x, table, at, n)
    if code == codes.SPIKE:
        return math.exp(-abs(10.0 / p[1] * (x - p[0])))
    if code == codes.COSINE:
        inside = abs(x - p[0]) <= p[1] / 2.0
        return 0.5 * (1.0 + math.cos(2.0 * math.pi / p[1] * (x - p[0]))) if inside else 0.0
    if code == codes.CONCAVE:
        return _concave(x, p[0], p[1])
    if code == codes.ARC:
        t = _ramp(x, p[0], p[1])
        return math.sqrt(max(1.0 - (1.0 - t) ** 2, 0.0))
    t = (x - 0.5 * (p[0] + p[1])) / (0.5 * (p[1] - p[0]))
    return math.sqrt(max(1.0 - t * t, 0.0))


@njit(cache=True)
def member(code: int, p: Array, x: float, table: Array, at: int, n: int) -> float:
    """Membership of x in the shape number `code` of `SHAPES`, with parameters p[:4] and height p[codes.HEIGHT].

    A discrete set has its n pairs in `table` from index `at` on.
    """
    if math.isnan(x):
        return math.nan
    if code == codes.TRIANGLE:
        m = min(_rise(x, p[0], p[1]), _rise(-x, -p[2], -p[1]))
    elif code == codes.TRAPEZOID:
        m = min(_rise(x, p[0], p[1]), _rise(-x, -p[3], -p[2]))
    elif code == codes.GAUSSIAN:
        m = _gauss(x, p[0], p[1])
    elif code == codes.TWO_SIDED_GAUSSIAN:
        m = (_gauss(x, p[0], p[1]) if x < p[0] else 1.0) * (_gauss(x, p[2], p[3]) if x > p[2] else 1.0)
    elif code == codes.BELL:
        m = 1.0 / (1.0 + abs((x - p[0]) / p[1]) ** (2.0 * p[2]))
    elif code == codes.SIGMOID:
        m = _sigmoid(x, p[0], p[1])
    elif code == codes.SIGMOID_DIFFERENCE:
        m = abs(_sigmoid(x, p[0], p[1]) - _sigmoid(x, p[3], p[2]))
    elif code == codes.SIGMOID_PRODUCT:
        m = _sigmoid(x, p[0], p[1]) * _sigmoid(x, p[3], p[2])
    elif code == codes.Z:
        m = _s(-x, -p[1], -p[0])
    elif code == codes.S:
        m = _s(x, p[0], p[1])
    elif code == codes.PI:
        m = _s(x, p[0], p[1]) * _s(-x, -p[3], -p[2])
    elif code == codes.RAMP:
        m = _ramp(x, p[0], p[1])
    else:
        m = _other_member(code, p, x, table, at, n)
        if code == codes.CONSTANT:
            return m
    return float(p[codes.HEIGHT] * m)


@njit(cache=True)
def gaussian_row(x: Array, p: Array, bits: Array, out: Array) -> None:
    """Gaussian memberships of x (n,) written to out (n,), four at a time: the exponential is spelt out.

    exp(u) = 2^k exp(r), with k the integer nearest to u / ln 2 and a polynomial for |r| < 0.35. Adding 1.5 * 2^52
    rounds to an integer and leaves it in the low bits, of which the power of two is made. Below exp(-708) it is 0.
    """
    mean, scale, height = p[0], -0.5 / (p[1] * p[1]), p[codes.HEIGHT]
    for i in range(x.size):
        u = (x[i] - mean) * (x[i] - mean) * scale
        u = -708.0 if u < -708.0 else u
        shifted = u * 1.4426950408889634 + 6755399441055744.0
        k = shifted - 6755399441055744.0
        r = u - k * 6.93147180369123816490e-01
        r = r - k * 1.90821492927058770002e-10
        q = r * (1.0 / 6227020800.0) + 1.0 / 479001600.0
        q = q * r + 1.0 / 39916800.0
        q = q * r + 1.0 / 3628800.0
        q = q * r + 1.0 / 362880.0
        q = q * r + 1.0 / 40320.0
        q = q * r + 1.0 / 5040.0
        q = q * r + 1.0 / 720.0
        q = q * r + 1.0 / 120.0
        q = q * r + 1.0 / 24.0
        q = q * r + 1.0 / 6.0
        q = q * r + 0.5
        q = q * r + 1.0
        out[i] = height * (q * r + 1.0) if u > -708.0 or u != u else 0.0
        bits[i] = shifted
    power = bits.view(np.int64)
    for i in range(x.size):
        power[i] = (power[i] + 1023) << 52
    for i in range(x.size):
        out[i] *= bits[i]


@njit(cache=True)
def inverse_member(code: int, p: Array, strength: float) -> float:
    """The x at which a monotone shape has the membership `strength`, or the position or value of a crisp one."""
    if code == codes.SINGLETON or code == codes.CONSTANT:
        return float(p[0])
    w = min(strength / p[codes.HEIGHT], 1.0)
    if code == codes.SIGMOID:
        return p[0] - math.log(1.0 / w - 1.0) / p[1] if w < 1.0 else math.copysign(math.inf, p[1])
    if code == codes.CONCAVE:
        return float(2.0 * p[1] - p[0] - (p[1] - p[0]) / w)
    t = w
    if code == codes.Z or code == codes.S:
        t = math.sqrt(w / 2.0) if w < 0.5 else 1.0 - math.sqrt((1.0 - w) / 2.0)
    elif code == codes.ARC:
        t = 1.0 - math.sqrt(1.0 - w * w)
    return float(p[1] - t * (p[1] - p[0]) if code == codes.Z else p[0] + t * (p[1] - p[0]))


def _warm() -> None:
    p, table, x = np.array([0.0, 0.0, 1.0, 1.0, 1.0]), np.zeros(2), np.zeros(1)
    norm(codes.MIN, 0.5, 0.5), conorm(codes.MAX, 0.5, 0.5), hedged(codes.NOT, 0.5)
    member(codes.TRAPEZOID, p, 0.5, table, 0, 1), inverse_member(codes.CONSTANT, p, 0.5)
    gaussian_row(x, np.array([0.0, 1.0, 0.0, 0.0, 1.0]), x.copy(), x.copy())
