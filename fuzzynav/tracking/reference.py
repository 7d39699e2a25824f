"""Reference trajectories with exact derivatives up to the third, and the flat map between them and the robot.

A trajectory is a function of time: `flat(t)` has shape `(..., 4, 2)`, the position [m] and its first, second
and third derivative. What the robot must do to drive it, heading, speed and yaw rate, follows from these
without any integration: position is a flat output of the unicycle.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import make_interp_spline, make_splrep

from fuzzynav.checks import positive
from fuzzynav.geometry import Array, wrap
from fuzzynav.tracking.curves import CircleCurve, Curve, LineCurve, SpeedProfile, SplineCurve, chain
from fuzzynav.tracking.records import ROW, Records

__all__ = [
    "Along",
    "CircleCurve",
    "FigureEight",
    "FlatState",
    "LineCurve",
    "Moved",
    "Recorded",
    "Reference",
    "Sample",
    "SpeedProfile",
    "SplineCurve",
    "circle",
    "flat_of_pose",
    "line",
    "pose_of_flat",
    "spline",
]

LONGEST = 1e5  # [s] over which a length is summed at most: a day
REST = 1e-9  # [m/s] a slower reference has no direction of travel


@dataclass(frozen=True, slots=True)
class FlatState:
    """Pose `(..., 3)` with v, dv/dt, d2v/dt2, omega, domega/dt `(...)`: the robot's side of the flat map."""

    pose: Array
    v: Array
    v_dot: Array
    v_ddot: Array
    omega: Array
    omega_dot: Array


def pose_of_flat(flat: ArrayLike, direction: ArrayLike = 1.0) -> FlatState:
    """Heading, speed and yaw rate that drive the flat outputs `(..., 4, 2)`; direction -1 drives backwards.

    Where the speed is below 1e-9 m/s the heading is that of the acceleration, the limit just after a
    reversal; where that vanishes too, heading and yaw rate are nan: rest has no direction.

    >>> state = pose_of_flat([[0, 0], [2, 0], [0, 1], [0, 0]])
    >>> float(state.v), float(state.omega)
    (2.0, 0.5)
    """
    f = np.asarray(flat, dtype=float)
    sign = np.asarray(direction, dtype=float)
    d1, d2, d3 = f[..., 1, :], f[..., 2, :], f[..., 3, :]
    speed = np.hypot(d1[..., 0], d1[..., 1])
    resting = speed < REST
    tangent = np.where(resting[..., None], d2, d1)
    size = np.hypot(tangent[..., 0], tangent[..., 1])
    unit = sign[..., None] * tangent / np.where(size < REST, np.nan, size)[..., None]
    v = np.where(resting, 0.0, sign * speed)
    a_along, a_across = _project(unit, d2)
    j_along, j_across = _project(unit, d3)
    with np.errstate(divide="ignore", invalid="ignore"):
        omega = np.where(resting, j_across / (2.0 * a_along), a_across / v)
        omega_dot = np.where(resting, np.nan, (j_across - 2.0 * a_along * omega) / v)
    theta = wrap(np.arctan2(unit[..., 1], unit[..., 0]))
    pose = np.stack([f[..., 0, 0], f[..., 0, 1], theta], axis=-1)
    return FlatState(pose, v, a_along, j_along + v * omega**2, omega, omega_dot)


def _project(unit: Array, vector: Array) -> tuple[Array, Array]:
    """Components of `vector` along the unit vector and to its left."""
    along = unit[..., 0] * vector[..., 0] + unit[..., 1] * vector[..., 1]
    return along, unit[..., 0] * vector[..., 1] - unit[..., 1] * vector[..., 0]


def flat_of_pose(state: FlatState) -> Array:
    """Flat outputs `(..., 4, 2)` of a moving robot: the inverse of `pose_of_flat` wherever v is not 0.

    Source: thesis eq 2.14, 2.15 and their derivative.
    """
    c, s = np.cos(state.pose[..., 2]), np.sin(state.pose[..., 2])
    forward, left = np.stack([c, s], axis=-1), np.stack([-s, c], axis=-1)
    d1 = state.v[..., None] * forward
    d2 = state.v_dot[..., None] * forward + (state.v * state.omega)[..., None] * left
    j_along = state.v_ddot - state.v * state.omega**2
    j_across = 2.0 * state.v_dot * state.omega + state.v * state.omega_dot
    d3 = j_along[..., None] * forward + j_across[..., None] * left
    return np.stack([state.pose[..., :2], d1, d2, d3], axis=-2)


@dataclass(frozen=True, slots=True)
class Sample:
    """A reference at times `t` `(...)`: position and derivatives `(..., 2)`, heading, speed, yaw rate `(...)`."""

    t: Array
    position: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    theta: Array
    v: Array
    omega: Array

    @property
    def pose(self) -> Array:
        """Pose `(..., 3)` of a robot that is exactly on the reference."""
        return np.concatenate([self.position, self.theta[..., None]], axis=-1)


class Reference(ABC):
    """A trajectory from time 0 to `duration` [s]; before and after it is held at its ends."""

    duration: float

    @abstractmethod
    def flat(self, t: ArrayLike) -> Array:
        """Position [m] and its three derivatives at times t [s], `(..., 4, 2)`."""

    def motion(self, t: ArrayLike, flat: Array) -> tuple[Array, Array, Array]:
        """Heading [rad], signed speed [m/s] and yaw rate [rad/s]; at rest the heading next to it is held."""
        state = pose_of_flat(flat)
        theta, omega = np.asarray(state.pose[..., 2]).copy(), np.asarray(state.omega).copy()
        for step in (1e-3, -1e-3, 0.1, -0.1):
            lost = np.isnan(theta)
            if not lost.any():
                break
            near = pose_of_flat(self.flat(np.clip(np.asarray(t, dtype=float) + step, 0.0, self.duration)))
            theta = np.where(lost, near.pose[..., 2], theta)
        return theta, state.v, np.where(np.isnan(omega), 0.0, omega)

    def sample(self, t: ArrayLike) -> Sample:
        """The reference at times t [s], held at its ends outside 0 to duration."""
        times = np.clip(np.asarray(t, dtype=float), 0.0, self.duration)
        flat = self.flat(times)
        theta, v, omega = self.motion(times, flat)
        return Sample(times, flat[..., 0, :], flat[..., 1, :], flat[..., 2, :], flat[..., 3, :], theta, v, omega)

    def rows(self, t: ArrayLike) -> Records:
        """The reference at times `(n,)` as records with x, y, dx, dy, ddx, ddy, theta, v and omega.

        >>> float(line((0.0, 0.0), 0.0, 0.3, 10.0).rows([2.0])[0].x)
        0.6
        """
        s = self.sample(t)
        made = np.empty(len(s.t), ROW)
        for (first, second), pair in (
            (("x", "y"), s.position),
            (("dx", "dy"), s.velocity),
            (("ddx", "ddy"), s.acceleration),
        ):
            made[first], made[second] = pair[..., 0], pair[..., 1]
        made["theta"], made["v"], made["omega"] = s.theta, s.v, s.omega
        return made

    def length(self, until: float | None = None) -> float:
        """Arc length [m] from time 0 to `until` [s] (the end if None), by Gauss-Legendre quadrature.

        Raises ValueError for an end before 0 or after 1e5 s.

        >>> round(FigureEight().length(), 4)
        18.934
        """
        end = self.duration if until is None else until
        if not 0.0 <= end <= LONGEST:
            raise ValueError(f"a length is summed from 0 s to at most {LONGEST:g} s, not to {end:g} s")
        nodes, weights = np.polynomial.legendre.leggauss(8)
        edges = np.linspace(0.0, end, max(int(np.ceil(end / 0.25)), 1) + 1)
        half = np.diff(edges)[:, None] / 2.0
        t = edges[:-1, None] + half * (nodes + 1.0)
        d1 = self.flat(t)[..., 1, :]
        return float((np.hypot(d1[..., 0], d1[..., 1]) * weights * half).sum())

    def moved(self, pose: ArrayLike) -> Moved:
        """The same trajectory turned and shifted as a rigid body by `pose` x [m], y [m], theta [rad]."""
        return Moved(self, np.asarray(pose, dtype=float))


class Moved(Reference):
    """A reference seen in another frame: turned and shifted by a pose."""

    def __init__(self, inner: Reference, pose: Array) -> None:
        self.inner, self.pose, self.duration = inner, pose, inner.duration

    def flat(self, t: ArrayLike) -> Array:
        """Position and derivatives `(..., 4, 2)` of the moved trajectory."""
        c, s = np.cos(self.pose[2]), np.sin(self.pose[2])
        turned = np.asarray(self.inner.flat(t) @ np.array([[c, s], [-s, c]]))
        turned[..., 0, :] += self.pose[:2]
        return turned

    def motion(self, t: ArrayLike, flat: Array) -> tuple[Array, Array, Array]:
        """Heading, speed and yaw rate: those of the inner reference, the heading turned."""
        theta, v, omega = self.inner.motion(t, self.inner.flat(t))
        return wrap(theta + self.pose[2]), v, omega


@dataclass(frozen=True, slots=True, kw_only=True)
class FigureEight(Reference):
    """The thesis' trajectory x = a sin(t/10), y = a sin(t/20); one lap takes 40 pi = 125.66 s.

    Source: thesis eq 5.11, defaults of table 5.2. Raises ValueError unless both values are positive.
    """

    amplitude: float = 2.0  # [m]
    duration: float = 126.0  # [s]

    def __post_init__(self) -> None:
        positive(amplitude=self.amplitude, duration=self.duration)

    def flat(self, t: ArrayLike) -> Array:
        """Position and derivatives `(..., 4, 2)`."""
        rates = np.array([0.1, 0.05])
        angle = np.asarray(t, dtype=float)[..., None] * rates
        s, c = np.sin(angle), np.cos(angle)
        return np.asarray(self.amplitude * np.stack([s, rates * c, -(rates**2) * s, -(rates**3) * c], axis=-2))


class Along(Reference):
    """A curve driven with a speed profile: the heading is the curve's own, so stops and reversals are defined."""

    def __init__(self, curve: Curve, profile: SpeedProfile) -> None:
        low, high = profile.extent
        if np.isfinite(curve.length) and (low < -1e-6 or high > curve.length + 1e-6):
            raise ValueError(f"the profile runs from {low:.3g} to {high:.3g} m, the curve from 0 to {curve.length:.3g}")
        self.curve, self.profile, self.duration = curve, profile, profile.duration

    def flat(self, t: ArrayLike) -> Array:
        """Position and derivatives `(..., 4, 2)`."""
        s = self.profile(t)
        return chain(self.curve.derivatives(s[..., 0]), s)

    def motion(self, t: ArrayLike, flat: Array) -> tuple[Array, Array, Array]:
        """Heading of the curve, signed speed of the profile, yaw rate = curvature times speed."""
        s = self.profile(t)
        q = self.curve.derivatives(s[..., 0])
        size = np.hypot(q[..., 1, 0], q[..., 1, 1])
        curvature = (q[..., 1, 0] * q[..., 2, 1] - q[..., 1, 1] * q[..., 2, 0]) / size**3
        v = s[..., 1] * size
        return wrap(np.arctan2(q[..., 1, 1], q[..., 1, 0])), v, curvature * v


def line(start: tuple[float, float], heading: float, speed: float, duration: float) -> Along:
    """Straight line from `start` [m] along `heading` [rad] at constant speed [m/s] for duration [s]."""
    return Along(LineCurve(start, heading), SpeedProfile([0.0, duration], [speed, speed]))


def circle(radius: float, speed: float, duration: float, *, center: tuple[float, float] = (0.0, 0.0)) -> Along:
    """Circle driven counter-clockwise (clockwise for radius < 0) at constant speed [m/s] for duration [s]."""
    if radius == 0.0 or not np.isfinite(radius):
        raise ValueError(f"the radius of a circle must be finite and not 0, got {radius}")
    return Along(CircleCurve(center, radius), SpeedProfile([0.0, duration], [speed, speed]))


def spline(points: ArrayLike, cruise: float, ramp: float = 2.0) -> Along:
    """Spline through way-points `(n, 2)` [m], from rest to rest at most at `cruise` [m/s]."""
    curve = SplineCurve(points)
    return Along(curve, SpeedProfile.rest_to_rest(curve.length, cruise, ramp))


class Recorded(Reference):
    """A recorded path: times `(n,)` [s] and points `(n, 2)` [m] as a spline of degree 5.

    smoothing: the sum of squares [m^2] by which the spline may miss the points of one coordinate; 0 interpolates.
    Raises ValueError for fewer than 6 points, times that do not increase, values that are not finite, a path that
    never moves, or a jump that would need more than `max_speed` [m/s].
    """

    def __init__(self, times: ArrayLike, points: ArrayLike, *, smoothing: float = 0.0, max_speed: float = 3.0) -> None:
        t, p = np.asarray(times, dtype=float), np.asarray(points, dtype=float)[:, :2]
        if len(t) < 6 or len(t) != len(p):
            raise ValueError(f"a recorded path needs 6 or more times and as many points, got {len(t)} and {len(p)}")
        if not (np.isfinite(t).all() and np.isfinite(p).all() and (np.diff(t) > 0).all()):
            raise ValueError("a recorded path needs finite points and times that increase")
        speed = np.hypot(*np.diff(p, axis=0).T) / np.diff(t)
        if speed.max() > max_speed:
            k = int(speed.argmax())
            jump = float(np.hypot(*(p[k + 1] - p[k])))
            where = f"by {jump:.3g} m at t = {t[k]:.3g} s"
            raise ValueError(f"the recorded path jumps {where}: that needs more than {max_speed} m/s")
        if speed.max() < REST:
            raise ValueError("the recorded path never moves: nothing to track")
        self.duration = float(t[-1] - t[0])
        if smoothing > 0.0:
            self._splines = [make_splrep(t - t[0], p[:, k], k=5, s=smoothing) for k in range(2)]
        else:
            self._splines = [make_interp_spline(t - t[0], p[:, k], k=5) for k in range(2)]

    def flat(self, t: ArrayLike) -> Array:
        """Position and derivatives `(..., 4, 2)`."""
        times = np.asarray(t, dtype=float)
        by_axis = [np.stack([s(times, nu=k) for k in range(4)], axis=-1) for s in self._splines]
        return np.stack(by_axis, axis=-1)
