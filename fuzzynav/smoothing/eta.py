"""Eta-cubed splines: curves of degree seven with given position, heading, curvature and curvature rate at both ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array, cumulative_length, curvature, wrap
from fuzzynav.smoothing.measures import arc_length

__all__ = ["Chain", "Eta3", "chain", "coefficients", "coefficients_as_printed", "curvature_rate", "eta3"]

_LEAST, _MOST = 1e-9, 1e9  # lengths [m] and speeds that keep every power of them finite


def curvature_rate(first: ArrayLike, second: ArrayLike, third: ArrayLike) -> Array:
    """Change of curvature along the arc [1/m^2] from the first three derivatives `(..., 2)` of a curve.

    nan where the first derivative vanishes.

    >>> float(curvature_rate([1.0, 0.0], [0.0, 0.0], [0.0, 2.0]))      # y = x^3 / 3 at its inflection
    2.0
    """
    a, b, c = (np.asarray(d, dtype=float) for d in (first, second, third))
    squared = (a**2).sum(axis=-1)
    turn = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    twist = a[..., 0] * c[..., 1] - a[..., 1] * c[..., 0]
    cubed = squared**3
    rate: Array = (twist * squared - 3.0 * turn * (a * b).sum(axis=-1)) / np.where(cubed > 0.0, cubed, np.nan)
    return rate


@dataclass(frozen=True, eq=False)
class Eta3:
    """One curve r(u) = sum of a_i u^i for u in [0, 1]; `coefficients` `(2, 8)` are alpha and beta.

    Source: thesis eq 3.8 (errata T4: the sum runs to 7, with 6 the sixteen end conditions cannot be met).
    """

    coefficients: Array

    def __post_init__(self) -> None:
        """Take a copy that cannot be written to."""
        copy = np.array(self.coefficients, dtype=float)
        copy.setflags(write=False)
        object.__setattr__(self, "coefficients", copy)

    def derivative(self, u: ArrayLike, order: int = 0) -> Array:
        """The curve [m] for order 0, or its derivative by u, at u of any shape; `(..., 2)`."""
        rows = np.polynomial.polynomial.polyder(self.coefficients, order, axis=1) if order else self.coefficients
        values = np.polynomial.polynomial.polyval(np.asarray(u, dtype=float), rows.T)
        return np.moveaxis(values, 0, -1)

    def points(self, count: int = 101) -> Array:
        """Points `(count, 2)` [m] at equal steps of u, both ends included."""
        return self.derivative(np.linspace(0.0, 1.0, count))

    def heading(self, u: ArrayLike) -> Array:
        """Direction of travel [rad] at u."""
        d = self.derivative(u, 1)
        return np.arctan2(d[..., 1], d[..., 0])

    def curvature(self, u: ArrayLike) -> Array:
        """Signed curvature [1/m] at u."""
        return curvature(self.derivative(u, 1), self.derivative(u, 2))

    def curvature_rate(self, u: ArrayLike) -> Array:
        """Change of curvature along the arc [1/m^2] at u."""
        return curvature_rate(*(self.derivative(u, k) for k in (1, 2, 3)))

    @cached_property
    def length(self) -> float:
        """Arc length [m], to 1e-10 of it."""
        return arc_length(lambda u: self.derivative(u, 1), [0.0, 1.0])


def eta3(start: ArrayLike, end: ArrayLike, eta: ArrayLike | None = None) -> Eta3:
    """Curve between two ends (x, y, theta[, curvature[, curvature rate]]) in metres and radians.

    eta holds six numbers: speeds by u at start and end (eta_1, eta_2 > 0), tangential accelerations (eta_3, eta_4)
    and jerks (eta_5, eta_6); fewer are filled with 0, None takes the distance of the ends for both speeds.
    Raises ValueError for ends that coincide, values that are not finite, a speed that is not positive, or numbers
    outside 1e-9 to 1e9, whose powers no curve can hold.

    >>> eta3([0, 0, 0], [2, 0, 0]).derivative(0.5).round(3).tolist()
    [1.0, 0.0]
    """
    a, b = _end(start, "start"), _end(end, "end")
    gap = float(np.hypot(b[0] - a[0], b[1] - a[1]))
    if gap == 0.0:
        raise ValueError(f"start and end coincide at {a[:2].tolist()}: a curve between them has no direction")
    if not gap >= _LEAST:
        raise ValueError(f"start and end lie {gap:.3g} m apart, a curve needs {_LEAST:g} m or more")
    shape = np.zeros(6)
    given = np.array([gap, gap]) if eta is None else np.asarray(eta, dtype=float).ravel()
    if not 2 <= len(given) <= 6 or not np.isfinite(given).all():
        raise ValueError(f"eta must be two to six finite numbers, got {eta!r}")
    shape[: len(given)] = given
    if (shape[:2] <= 0.0).any():
        raise ValueError(f"eta_1 and eta_2 are speeds and must be positive, got {shape[0]} and {shape[1]}")
    if (shape[:2] < _LEAST).any() or (np.abs(shape) > _MOST).any():
        raise ValueError(
            f"eta_1 and eta_2 must lie in {_LEAST:g} to {_MOST:g}, the others within {_MOST:g}, got {eta!r}"
        )
    return Eta3(coefficients(a, b, shape))


def _end(values: ArrayLike, name: str) -> Array:
    end = np.asarray(values, dtype=float).ravel()
    if not 3 <= len(end) <= 5 or not np.isfinite(end).all():
        raise ValueError(f"{name} must be x, y, theta and perhaps curvature and its rate, finite; got {values!r}")
    if (np.abs(end) > _MOST).any():
        raise ValueError(f"{name} must be metres and radians of at most {_MOST:g}, got {values!r}")
    return np.concatenate([end, np.zeros(5 - len(end))])


def coefficients(start: ArrayLike, end: ArrayLike, eta: ArrayLike) -> Array:
    """The sixteen coefficients `(2, 8)`; ends are x, y, theta, curvature, curvature rate; eta six numbers.

    Both rows follow one formula: beta is alpha with the heading turned by -90 deg and y for x.
    Source: thesis eq 3.9 and appendix C (errata T5 to T9: eta_3 in a_2; signs and differences of beta_4 to beta_7).
    """
    a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    x = _row(a, b, b[0] - a[0], np.asarray(eta, dtype=float), 0.0)
    y = _row(a, b, b[1] - a[1], np.asarray(eta, dtype=float), np.pi / 2.0)
    x[0], y[0] = a[0], a[1]
    return np.stack([x, y])


def _row(a: Array, b: Array, gap: float, eta: Array, turn: float) -> Array:
    """Alpha for turn 0, beta for turn pi/2; the first entry is left 0."""
    e1, e2, e3, e4, e5, e6 = eta
    ka, ra, kb, rb = a[3], a[4], b[3], b[4]
    ca, sa = np.cos(a[2] - turn), np.sin(a[2] - turn)
    cb, sb = np.cos(b[2] - turn), np.sin(b[2] - turn)
    side2, side3 = e1**2 * ka, e1**3 * ra + 3.0 * e1 * e3 * ka  # normal parts of p'' and p''' at the start
    return np.array(
        [
            0.0,
            e1 * ca,
            e3 * ca / 2 - side2 * sa / 2,
            e5 * ca / 6 - side3 * sa / 6,
            35 * gap
            - (20 * e1 + 5 * e3 + 2 * e5 / 3) * ca
            + (5 * side2 + 2 * side3 / 3) * sa
            - (15 * e2 - 5 * e4 / 2 + e6 / 6) * cb
            - (5 * e2**2 * kb / 2 - e2**3 * rb / 6 - e2 * e4 * kb / 2) * sb,
            -84 * gap
            + (45 * e1 + 10 * e3 + e5) * ca
            - (10 * side2 + side3) * sa
            + (39 * e2 - 7 * e4 + e6 / 2) * cb
            + (7 * e2**2 * kb - e2**3 * rb / 2 - 3 * e2 * e4 * kb / 2) * sb,
            70 * gap
            - (36 * e1 + 15 * e3 / 2 + 2 * e5 / 3) * ca
            + (15 * side2 / 2 + 2 * side3 / 3) * sa
            - (34 * e2 - 13 * e4 / 2 + e6 / 2) * cb
            - (13 * e2**2 * kb / 2 - e2**3 * rb / 2 - 3 * e2 * e4 * kb / 2) * sb,
            -20 * gap
            + (10 * e1 + 2 * e3 + e5 / 6) * ca
            - (2 * side2 + side3 / 6) * sa
            + (10 * e2 - 2 * e4 + e6 / 6) * cb
            + (2 * e2**2 * kb - e2**3 * rb / 6 - e2 * e4 * kb / 2) * sb,
        ]
    )


def coefficients_as_printed(start: ArrayLike, end: ArrayLike, eta: ArrayLike) -> Array:
    """The coefficients `(2, 8)` as eq 3.9 and appendix C print them, letter by letter (errata T5 to T8).

    Only the bracket that alpha_7 lacks is put where it must be (errata T9).
    """
    a, b, e = (np.asarray(v, dtype=float) for v in (start, end, eta))
    return np.array([_alpha_as_printed(a, b, e), _beta_as_printed(a, b, e)])


def _alpha_as_printed(a: Array, b: Array, e: Array) -> list[float]:
    (xa, _, ta, ka, ra), (xb, _, tb, kb, rb) = a, b
    e1, e2, e3, e4, e5, e6 = e
    ca, sa, cb, sb = np.cos(ta), np.sin(ta), np.cos(tb), np.sin(tb)
    return [
        xa,
        e1 * ca,
        e2 * ca / 2 - e1**2 * ka * sa / 2,
        e5 * ca / 6 - (e1**3 * ra + 3 * e1 * e3 * ka) * sa / 6,
        35 * (xb - xa)
        - (20 * e1 + 5 * e3 + 2 / 3 * e5) * ca
        + (5 * e1**2 * ka + 2 / 3 * e1**3 * ra + 2 * e1 * e3 * ka) * sa
        - (15 * e2 - 5 / 2 * e4 + 1 / 6 * e6) * cb
        - (5 / 2 * e2**2 * kb - 1 / 6 * e2**3 * rb - 1 / 2 * e2 * e4 * kb) * sb,
        -84 * (xb - xa)
        + (45 * e1 + 10 * e3 + e5) * ca
        - (10 * e1**2 * ka + e1**3 * ra + 3 * e1 * e3 * ka) * sa
        + (39 * e2 - 7 * e4 + 1 / 2 * e6) * cb
        + (7 * e2**2 * kb - 1 / 2 * e2**3 * rb - 3 / 2 * e2 * e4 * kb) * sb,
        70 * (xb - xa)
        - (36 * e1 + 15 / 2 * e3 + 2 / 3 * e5) * ca
        + (15 / 2 * e1**2 * ka + 2 / 3 * e1**3 * ra + 2 * e1 * e3 * ka) * sa
        - (34 * e2 - 13 / 2 * e4 + 1 / 2 * e6) * cb
        - (13 / 2 * e2**2 * kb - 1 / 2 * e2**3 * rb - 3 / 2 * e2 * e4 * kb) * sb,
        -20 * (xb - xa)
        + (10 * e1 + 2 * e3 + 1 / 6 * e5) * ca
        - (2 * e1**2 * ka + 1 / 6 * e1**3 * ra + 1 / 2 * e1 * e3 * ka) * sa
        + (10 * e2 - 2 * e4 + 1 / 6 * e6) * cb
        + (2 * e2**2 * kb - 1 / 6 * e2**3 * rb - 1 / 2 * e2 * e4 * kb) * sb,
    ]


def _beta_as_printed(a: Array, b: Array, e: Array) -> list[float]:
    (xa, ya, ta, ka, ra), (xb, _, tb, kb, rb) = a, b
    e1, e2, e3, e4, e5, e6 = e
    ca, sa, cb, sb = np.cos(ta), np.sin(ta), np.cos(tb), np.sin(tb)
    return [
        ya,
        e1 * sa,
        e2 * sa / 2 + e1**2 * ka * ca / 2,
        e5 * sa / 6 + (e1**3 * ra + 3 * e1 * e3 * ka) * ca / 6,
        35 * (xb - xa)
        - (20 * e1 + 5 * e3 + 2 / 3 * e5) * sa
        - (5 * e1**2 * ka + 2 / 3 * e1**3 * ra + 2 * e1 * e3 * ka) * ca
        - (15 * e2 - 5 / 2 * e4 + 1 / 6 * e6) * sb
        + (5 / 2 * e2**2 * kb - 1 / 6 * e2**3 * rb - 1 / 2 * e2 * e4 * kb) * cb,
        -84 * (xb - xa)
        + (45 * e1 + 10 * e3 + e5) * sa
        + (10 * e1**2 * ka + e1**3 * ra + 3 * e1 * e3 * ka) * ca
        + (39 * e2 - 7 * e4 + 1 / 2 * e6) * sb
        + (7 * e2**2 * kb - 1 / 2 * e2**3 * rb - 3 / 2 * e2 * e4 * kb) * cb,
        70 * (xb - xa)
        + (36 * e1 + 15 / 2 * e3 + 2 / 3 * e5) * sa
        + (15 / 2 * e1**2 * ka + 2 / 3 * e1**3 * ra + 2 * e1 * e3 * ka) * ca
        + (34 * e2 - 13 / 2 * e4 + 1 / 2 * e6) * sb
        - (13 / 2 * e2**2 * kb - 1 / 2 * e2**3 * rb - 3 / 2 * e2 * e4 * kb) * cb,
        -20 * (xb - xa)
        + (10 * e1 + 2 * e3 + 1 / 6 * e5) * sa
        + (2 * e1**2 * ka + 1 / 6 * e1**3 * ra + 0.5 * e1 * e3 * ka) * ca
        + (10 * e2 - 2 * e4 + 1 / 6 * e6) * sb
        - (2 * e2**2 * kb - 1 / 6 * e2**3 * rb - 1 / 2 * e2 * e4 * kb) * cb,
    ]


@dataclass(frozen=True, eq=False)
class Chain:
    """Eta-cubed curves laid end to end; position, heading, curvature and curvature rate pass without a jump."""

    pieces: tuple[Eta3, ...]

    @property
    def length(self) -> float:
        """Arc length [m]."""
        return sum(piece.length for piece in self.pieces)

    def _along(self, name: str, count: int) -> Array:
        u = np.linspace(0.0, 1.0, count)
        parts = [getattr(piece, name)(u) for piece in self.pieces]
        return np.concatenate([parts[0], *(part[1:] for part in parts[1:])])

    def points(self, count: int = 101) -> Array:
        """Points `(n, 2)` [m], `count` on each piece, way-points once."""
        return self._along("derivative", count)

    def curvature(self, count: int = 101) -> Array:
        """Curvature `(n,)` [1/m] at `points(count)`."""
        return self._along("curvature", count)

    def curvature_rate(self, count: int = 101) -> Array:
        """Curvature rate `(n,)` [1/m^2] at `points(count)`."""
        return self._along("curvature_rate", count)

    def arc_length(self, count: int = 101) -> Array:
        """Arc length `(n,)` [m] at `points(count)`, along the chords."""
        return cumulative_length(self.points(count))


def chain(
    points: ArrayLike, *, start_heading: float | None = None, end_heading: float | None = None, stretch: float = 1.0
) -> Chain:
    """Eta-cubed curve through way-points `(n, 2)` [m] with continuous curvature and curvature rate.

    Ours: at a way-point the heading is that of the circle through it and its neighbours, the curvature that of this
    circle, the rate 0; at the ends curvature and rate are 0. eta_1 and eta_2 of a piece are its chord times `stretch`.
    Raises ValueError for fewer than two points, points that coincide, or a stretch that is not positive.
    """
    p = np.asarray(points, dtype=float)
    if p.ndim != 2 or p.shape[1] != 2 or len(p) < 2 or not np.isfinite(p).all():
        raise ValueError(f"a chain needs two or more finite points (n, 2), got shape {p.shape}")
    chords = np.diff(p, axis=0)
    gaps = np.hypot(chords[:, 0], chords[:, 1])
    if (gaps == 0.0).any():
        raise ValueError(f"way-points {int(np.argmin(gaps))} and {int(np.argmin(gaps)) + 1} coincide")
    if not stretch > 0.0:
        raise ValueError(f"stretch must be positive, got {stretch}")
    ends = _ends(p, chords, gaps, start_heading, end_heading)
    pieces = [eta3(a, b, [g * stretch, g * stretch]) for a, b, g in zip(ends[:-1], ends[1:], gaps, strict=True)]
    return Chain(tuple(pieces))


def _ends(
    p: Array, chords: Array, gaps: Array, start_heading: float | None, end_heading: float | None
) -> Sequence[Array]:
    """Position, heading, curvature and rate `(5,)` at each way-point."""
    angles = np.arctan2(chords[:, 1], chords[:, 0])
    ends = np.zeros((len(p), 5))
    ends[:, :2] = p
    ends[0, 2] = angles[0] if start_heading is None else start_heading
    ends[-1, 2] = angles[-1] if end_heading is None else end_heading
    span = p[2:] - p[:-2]
    turn, across = wrap(np.diff(angles)), np.hypot(span[:, 0], span[:, 1])
    first = angles[1:] - np.arctan2(span[:, 1], span[:, 0])  # between the first chord and the circle's tangent
    ends[1:-1, 2] = angles[:-1] + np.where(across > 0.0, first, turn / 2.0)
    ends[1:-1, 3] = np.divide(2.0 * np.sin(turn), across, out=np.zeros(len(across)), where=across > 0.0)
    return list(ends)
