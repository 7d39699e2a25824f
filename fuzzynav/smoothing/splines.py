"""From a path of nodes to a curve that a robot can follow: cubic B-splines, and one that keeps clear of obstacles."""

from __future__ import annotations

from dataclasses import dataclass
from math import comb, factorial

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array, curvature
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.smoothing.eta import curvature_rate
from fuzzynav.smoothing.measures import SPACING, arc_length, is_free

__all__ = [
    "Smooth",
    "Spline",
    "bspline",
    "cox_de_boor",
    "cubic_basis",
    "free_bspline",
    "segment",
    "segment_as_printed",
    "uniform_basis",
    "uniform_basis_as_printed",
]

_MATRIX = np.array([[1.0, 4.0, 1.0, 0.0], [-3.0, 0.0, 3.0, 0.0], [3.0, -6.0, 3.0, 0.0], [-1.0, 3.0, -3.0, 1.0]]) / 6.0


def cubic_basis(t: ArrayLike) -> Array:
    """The four cubic polynomials of the uniform B-spline at t in [0, 1]; shape `(..., 4)`, sum 1.

    Source: thesis eq 4.9.

    >>> (6 * cubic_basis(0.0)).tolist()
    [1.0, 4.0, 1.0, 0.0]
    """
    t = np.asarray(t, dtype=float)
    return (
        np.stack(
            [
                -(t**3) + 3 * t**2 - 3 * t + 1,
                3 * t**3 - 6 * t**2 + 4,
                -3 * t**3 + 3 * t**2 + 3 * t + 1,
                t**3,
            ],
            axis=-1,
        )
        / 6.0
    )


def uniform_basis(i: int, degree: int, t: ArrayLike) -> Array:
    """Function i of the uniform basis of a degree, at t in [0, 1].

    Source: thesis eq 3.11 (errata T2: the sum runs to degree - i).

    >>> float(uniform_basis(1, 3, 0.0))
    0.6666666666666666
    """
    return _power_sum(i, degree, t, degree - i)


def uniform_basis_as_printed(i: int, degree: int, t: ArrayLike) -> Array:
    """Eq 3.11 with the printed upper limit degree - 1 (errata T2): right for i = 1 alone."""
    return _power_sum(i, degree, t, degree - 1)


def _power_sum(i: int, degree: int, t: ArrayLike, last: int) -> Array:
    t = np.asarray(t, dtype=float)
    terms = [(-1) ** j * comb(degree + 1, j) * (t + degree - i - j) ** degree for j in range(last + 1)]
    total: Array = np.sum(terms, axis=0) / factorial(degree)
    return total


def segment(controls: ArrayLike, t: ArrayLike) -> Array:
    """One span of the uniform cubic B-spline from four control points `(4, d)`, at t in [0, 1].

    Source: thesis eq 3.12 (errata T1: the last row is -1 3 -3 1).

    >>> segment([[0], [1], [2], [3]], 0.25).tolist()
    [1.25]
    """
    points: Array = _powers(t) @ _MATRIX @ np.asarray(controls, dtype=float)
    return points


def segment_as_printed(controls: ArrayLike, t: ArrayLike) -> Array:
    """Eq 3.12 with its printed last row -1 3 3 1 (errata T1): spans do not join, the curve depends on the origin."""
    wrong = _MATRIX.copy()
    wrong[3] = np.array([-1.0, 3.0, 3.0, 1.0]) / 6.0
    points: Array = _powers(t) @ wrong @ np.asarray(controls, dtype=float)
    return points


def _powers(t: ArrayLike) -> Array:
    return np.asarray(t, dtype=float)[..., None] ** np.arange(4)


def cox_de_boor(i: int, order: int, knots: ArrayLike, t: ArrayLike) -> Array:
    """Basis function i of an order (degree + 1) on any knots, at t; 0/0 counts 0.

    The last interval is closed. Source: thesis eq 4.7 (errata T3: k is the order, a cubic has k = 4).

    >>> float(cox_de_boor(0, 4, [0, 1, 2, 3, 4], 2.0))
    0.6666666666666666
    """
    k, t = np.asarray(knots, dtype=float), np.asarray(t, dtype=float)
    if order == 1:
        closed = (t == k[i + 1]) & (k[i + 1] == k[-1]) & (k[i] < k[i + 1])
        return np.where(((k[i] <= t) & (t < k[i + 1])) | closed, 1.0, 0.0)
    left, right = k[i + order - 1] - k[i], k[i + order] - k[i + 1]
    value = np.zeros(t.shape)
    if left > 0.0:
        value = value + (t - k[i]) / left * cox_de_boor(i, order - 1, k, t)
    if right > 0.0:
        value = value + (k[i + order] - t) / right * cox_de_boor(i + 1, order - 1, k, t)
    return value


@dataclass(frozen=True, eq=False)
class Spline:
    """A cubic B-spline: control points `(n, 2)` [m] on knots `(n + 4,)`."""

    controls: Array
    knots: Array

    def __post_init__(self) -> None:
        """Take copies that cannot be written to."""
        for name in ("controls", "knots"):
            copy = np.array(getattr(self, name), dtype=float)
            copy.setflags(write=False)
            object.__setattr__(self, name, copy)

    @property
    def span(self) -> tuple[float, float]:
        """First and last value of the parameter."""
        return float(self.knots[3]), float(self.knots[-4])

    def derivative(self, t: ArrayLike, order: int = 0) -> Array:
        """The curve [m] for order 0, or its derivative by the parameter, at t; `(..., 2)`."""
        controls, knots, degree = self.controls, self.knots, 3
        for _ in range(order):
            gaps = (knots[degree + 1 : -1] - knots[1 : -degree - 1])[:, None]
            controls = degree * np.diff(controls, axis=0) / gaps
            knots, degree = knots[1:-1], degree - 1
        return _de_boor(controls, knots, degree, np.asarray(t, dtype=float))

    def parameters(self, count: int) -> Array:
        """`count` values of the parameter at equal steps, both ends included."""
        return np.linspace(*self.span, count)

    def points(self, count: int = 201) -> Array:
        """Points `(count, 2)` [m] at equal steps of the parameter."""
        return self.derivative(self.parameters(count))

    def curvature(self, t: ArrayLike) -> Array:
        """Signed curvature [1/m] at t; continuous along the curve."""
        return curvature(self.derivative(t, 1), self.derivative(t, 2))

    def curvature_rate(self, t: ArrayLike) -> Array:
        """Change of curvature along the arc [1/m^2] at t; it jumps at the knots."""
        return curvature_rate(*(self.derivative(t, k) for k in (1, 2, 3)))

    @property
    def length(self) -> float:
        """Arc length [m], to 1e-10 of it."""
        return arc_length(lambda t: self.derivative(t, 1), np.unique(self.knots[3:-3]))


def _de_boor(controls: Array, knots: Array, degree: int, t: Array) -> Array:
    """Value of a B-spline at t of any shape, by de Boor's scheme for all t at once."""
    flat = t.ravel()
    span = np.clip(np.searchsorted(knots, flat, side="right") - 1, degree, len(controls) - 1)
    work = [controls[span - degree + j] for j in range(degree + 1)]
    for r in range(1, degree + 1):
        for j in range(degree, r - 1, -1):
            low, high = knots[span - degree + j], knots[span + 1 + j - r]
            share = ((flat - low) / (high - low))[:, None]
            work[j] = (1.0 - share) * work[j - 1] + share * work[j]
    return work[degree].reshape(*t.shape, controls.shape[1])


def bspline(points: ArrayLike, ends: str = "clamped") -> Spline:
    """Uniform cubic B-spline on control points `(n, 2)` [m], n >= 4.

    ends: "clamped" repeats the end knots, so that the curve starts on the first and stops on the last point;
    "free" is the thesis' form, which starts at (P_0 + 4 P_1 + P_2) / 6 and misses both (errata T10).
    Raises ValueError for fewer than four points, points that coincide with the one before, or values not finite.
    Source: thesis eq 3.10, eq 4.6 and eq 4.8 (errata T3: n is one less than the number of points).
    """
    p = np.asarray(points, dtype=float)
    if p.ndim != 2 or p.shape[1] != 2 or not np.isfinite(p).all():
        raise ValueError(f"control points must be finite numbers (n, 2), got shape {p.shape}")
    if len(p) < 4:
        raise ValueError(f"a cubic B-spline needs four control points or more, got {len(p)}")
    same = np.flatnonzero((np.diff(p, axis=0) == 0.0).all(axis=1))
    if len(same):
        raise ValueError(f"control points {same[0]} and {same[0] + 1} coincide at {p[same[0]].tolist()}")
    if ends == "free":
        return Spline(p, np.arange(-3.0, len(p) + 1.0))
    if ends != "clamped":
        raise ValueError(f"ends must be 'clamped' or 'free', got {ends!r}")
    return Spline(p, np.concatenate([np.zeros(3), np.arange(len(p) - 2.0), np.full(3, len(p) - 3.0)]))


@dataclass(frozen=True, slots=True, kw_only=True)
class Smooth:
    """A curve along a path, and how many rounds of added control points it took.

    status "free": the curve keeps the radius; "blocked": it does not, after the last round.
    """

    status: str
    spline: Spline
    rounds: int


def free_bspline(points: ArrayLike, grid: GridMap, radius: float = 0.0, rounds: int = 6) -> Smooth:
    """Clamped B-spline along a free polyline `(n, 2)` [m] that is free itself.

    Where the curve overlaps an obstacle, the legs nearby get control points in their middle, which draws it to the
    polyline; a path of two or three nodes gets them at once. Raises ValueError for fewer than two points, rounds below
    0, or a polyline that is not free: no curve can be promised then.
    """
    if rounds != int(rounds) or rounds < 0:
        raise ValueError(f"rounds must be a whole number, 0 or more, got {rounds}")
    p = np.asarray(points, dtype=float)
    if p.ndim != 2 or p.shape[1] != 2 or len(p) < 2 or not np.isfinite(p).all():
        raise ValueError(f"a path needs two or more finite points (n, 2), got shape {p.shape}")
    if not is_free(p, grid, radius):
        raise ValueError(f"the path is not free at radius {radius} m: prune or plan with this radius first")
    while len(p) < 4:
        p = _halve(p, np.ones(len(p) - 1, dtype=bool))
    for done in range(rounds + 1):
        spline = bspline(p)
        samples = _dense(spline)
        blocked = _blocked_spans(spline, samples, grid, radius)
        if not blocked.any() or done == rounds:
            break
        p = _halve(p, blocked)
    return Smooth(status="blocked" if blocked.any() else "free", spline=spline, rounds=done)


def _halve(p: Array, chosen: Array) -> Array:
    """The polyline with a point in the middle of each chosen leg."""
    middle = (p[:-1] + p[1:])[chosen] / 2.0
    return np.insert(p, np.flatnonzero(chosen) + 1, middle, axis=0)


def _dense(spline: Spline) -> Array:
    """Parameters `(m,)` at which neighbouring points of the curve are at most about SPACING apart."""
    return spline.parameters(max(int(np.ceil(1.5 * spline.length / SPACING)), 8 * len(spline.controls)))


def _blocked_spans(spline: Spline, t: Array, grid: GridMap, radius: float) -> Array:
    """Which legs `(n - 1,)` of the control polygon shape a stretch of the curve that is not free."""
    points = spline.derivative(t)
    chords = np.hypot(*np.diff(points, axis=0).T)
    near = np.flatnonzero(grid.distance(points[:-1]) < radius + chords)
    hit = [k for k in near if not grid.clear_line(points[k], points[k + 1], radius, "permissive")]
    spans = np.clip(np.floor(t[hit]).astype(int), 0, len(spline.controls) - 4)
    legs = np.zeros(len(spline.controls) - 1, dtype=bool)
    for k in range(3):  # span s of the curve has the control points s .. s + 3
        legs[spans + k] = True
    return legs
