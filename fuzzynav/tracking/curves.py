"""Curves by their arc length, and how far along them a robot shall be at each time.

Curves and speed profiles give exact derivatives up to the third; `reference.Along` joins the two.
"""

from __future__ import annotations

import itertools
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline, PPoly, make_interp_spline

from fuzzynav.checks import positive
from fuzzynav.geometry import Array

NODES, WEIGHTS = np.polynomial.legendre.leggauss(6)

__all__ = ["CircleCurve", "Curve", "LineCurve", "SpeedProfile", "SplineCurve", "chain"]


class SpeedProfile:
    """Distance travelled along a curve over time, from speeds [m/s] given at times [s].

    Between two times the speed changes by a quintic step, so that speed and acceleration are continuous and
    smooth; equal speeds give constant speed, a negative speed drives backwards, two zeros in a row stand still.
    Raises ValueError unless times start at 0 and increase, and some speed differs from 0.
    """

    def __init__(self, times: ArrayLike, speeds: ArrayLike) -> None:
        t, v = np.asarray(times, dtype=float), np.asarray(speeds, dtype=float)
        if t.ndim != 1 or t.shape != v.shape or len(t) < 2 or not np.isfinite(np.stack([t, v])).all():
            raise ValueError("a speed profile needs two or more finite times and as many speeds")
        if t[0] != 0.0 or (np.diff(t) <= 0).any():
            raise ValueError("the times of a speed profile must start at 0 and increase")
        if not np.abs(v).max() > 0.0:
            raise ValueError("the reference has zero speed throughout: nothing to track; give a speed other than 0")
        self.times, self.speeds, self.duration = t, v, float(t[-1])
        self._distance = self._polynomial()
        self._rates = [self._distance.derivative(k) for k in (1, 2, 3)]

    @classmethod
    def rest_to_rest(cls, length: float, cruise: float, ramp: float = 2.0) -> SpeedProfile:
        """From rest over `length` [m] to rest, at most at `cruise` [m/s]; speeding up takes `ramp` [s]."""
        positive(length=length, cruise=cruise, ramp=ramp)
        if length <= cruise * ramp:  # too short to reach the cruising speed
            return cls([0.0, ramp, 2.0 * ramp], [0.0, length / ramp, 0.0])
        plateau = length / cruise - ramp
        return cls([0.0, ramp, ramp + plateau, 2.0 * ramp + plateau], [0.0, cruise, cruise, 0.0])

    def _polynomial(self) -> PPoly:
        step = np.diff(self.times)
        rise = np.diff(self.speeds)
        coefficients = np.zeros((7, len(step)))
        coefficients[0], coefficients[1], coefficients[2] = rise / step**5, -3.0 * rise / step**4, 2.5 * rise / step**3
        coefficients[5] = self.speeds[:-1]
        gained = step * (self.speeds[:-1] + self.speeds[1:]) / 2.0
        coefficients[6] = np.concatenate([[0.0], np.cumsum(gained)])[:-1]
        return PPoly(coefficients, self.times)

    def __call__(self, t: ArrayLike) -> Array:
        """Distance [m], speed, acceleration and jerk at times t [s], shape `(..., 4)`."""
        times = np.asarray(t, dtype=float)
        return np.stack([self._distance(times), *(rate(times) for rate in self._rates)], axis=-1)

    @property
    def extent(self) -> tuple[float, float]:
        """Least and greatest distance [m] along the curve that the profile reaches."""
        s = self._distance(np.linspace(0.0, self.duration, 2001))
        return float(s.min()), float(s.max())


class Curve(ABC):
    """A curve by its arc length s [m]; `derivatives` has shape `(..., 4, 2)` like `Reference.flat`."""

    length: float

    @abstractmethod
    def derivatives(self, s: ArrayLike) -> Array:
        """Position and its derivatives with respect to arc length, `(..., 4, 2)`."""


@dataclass(frozen=True, slots=True)
class LineCurve(Curve):
    """The straight line from `start` (2,) along `heading` [rad]."""

    start: tuple[float, float]
    heading: float
    length: float = np.inf

    def derivatives(self, s: ArrayLike) -> Array:
        """Position and derivatives `(..., 4, 2)`."""
        unit = np.array([np.cos(self.heading), np.sin(self.heading)])
        position = np.asarray(self.start) + np.asarray(s, dtype=float)[..., None] * unit
        zero = np.zeros_like(position)
        return np.stack([position, zero + unit, zero, zero], axis=-2)


@dataclass(frozen=True, slots=True)
class CircleCurve(Curve):
    """The circle about `center`, driven counter-clockwise from `angle` [rad]; clockwise if radius < 0."""

    center: tuple[float, float]
    radius: float
    angle: float = 0.0
    length: float = np.inf

    def derivatives(self, s: ArrayLike) -> Array:
        """Position and derivatives `(..., 4, 2)`."""
        k = 1.0 / self.radius
        a = self.angle + k * np.asarray(s, dtype=float)
        out, along = np.stack([np.cos(a), np.sin(a)], -1), np.stack([-np.sin(a), np.cos(a)], -1)
        position = np.asarray(self.center) + abs(self.radius) * out
        sign = np.sign(self.radius)
        return np.stack([position, sign * along, -abs(k) * out, -sign * k**2 * along], axis=-2)


class SplineCurve(Curve):
    """Interpolating spline of degree 5 (less for few points) through way-points `(n, 2)`, by arc length.

    Raises ValueError for fewer than two points, points that are not finite, two equal neighbours, or a curve that
    turns back on itself within a point, where it has no curvature.
    """

    def __init__(self, points: ArrayLike) -> None:
        p = np.asarray(points, dtype=float)
        if p.ndim != 2 or p.shape[1] != 2 or len(p) < 2 or not np.isfinite(p).all():
            raise ValueError(f"a spline needs two or more finite way-points of shape (n, 2), got shape {p.shape}")
        chords = np.hypot(*np.diff(p, axis=0).T)
        if not (chords > 0).all():
            raise ValueError(f"way-points {int(chords.argmin())} and {int(chords.argmin()) + 1} coincide")
        u = np.concatenate([[0.0], np.cumsum(chords)])
        self._curve: BSpline = make_interp_spline(u, p, k=min(5, len(p) - 1))
        self._stations = np.unique(np.concatenate([np.linspace(a, b, 41) for a, b in itertools.pairwise(u)]))
        rate = np.hypot(*self._curve(np.linspace(0.0, u[-1], 200 * len(u)), nu=1).T)
        if rate.min() < 0.1:
            where = p[max(int(np.searchsorted(u, u[-1] * rate.argmin() / len(rate), side="right")) - 1, 0)]
            raise ValueError(f"the curve turns back on itself near way-point {where.tolist()}: move it or add one")
        pieces = self._arc(self._stations[:-1], self._stations[1:])
        self._lengths = np.concatenate([[0.0], np.cumsum(pieces)])
        self.length = float(self._lengths[-1])

    def _arc(self, start: Array, end: Array) -> Array:
        """Arc length [m] between parameters `(...)` of one short piece, by Gauss-Legendre quadrature."""
        half = (end - start)[..., None] / 2.0
        d1 = self._curve(start[..., None] + half * (NODES + 1.0), nu=1)
        return np.asarray((np.hypot(d1[..., 0], d1[..., 1]) * WEIGHTS * half).sum(axis=-1))

    def _parameter(self, s: Array) -> Array:
        """The spline's parameter at arc length s, by Newton steps from the table."""
        k = np.clip(np.searchsorted(self._lengths, s, side="right") - 1, 0, len(self._stations) - 2)
        first, base = self._stations[k], self._lengths[k]
        u = first + (s - base) / (self._lengths[k + 1] - base) * (self._stations[k + 1] - first)
        for _ in range(5):
            d1 = self._curve(u, nu=1)
            u = u - (base + self._arc(first, u) - s) / np.hypot(d1[..., 0], d1[..., 1])
        return np.asarray(u)

    def derivatives(self, s: ArrayLike) -> Array:
        """Position and derivatives `(..., 4, 2)`; s is held at the ends of the curve."""
        u = self._parameter(np.clip(np.asarray(s, dtype=float), 0.0, self.length))
        outer = np.stack([self._curve(u, nu=k) for k in range(4)], axis=-2)
        q1, q2, q3 = (outer[..., k, :] for k in (1, 2, 3))
        n2, g = (q1**2).sum(axis=-1), (q1 * q2).sum(axis=-1)
        change = (q2**2).sum(axis=-1) + (q1 * q3).sum(axis=-1)
        u3 = (4.0 * g**2 / n2**3 - change / n2**2) / np.sqrt(n2)
        return chain(outer, np.stack([u, n2**-0.5, -g / n2**2, u3], axis=-1))


def chain(outer: Array, inner: Array) -> Array:
    """Derivatives of q(u(t)) from those of q `(..., 4, 2)` and of u `(..., 4)`: the rule of Faa di Bruno."""
    u1, u2, u3 = (inner[..., k, None] for k in (1, 2, 3))
    q0, q1, q2, q3 = (outer[..., k, :] for k in range(4))
    return np.stack([q0, q1 * u1, q2 * u1**2 + q1 * u2, q3 * u1**3 + 3.0 * q2 * u1 * u2 + q1 * u3], axis=-2)
