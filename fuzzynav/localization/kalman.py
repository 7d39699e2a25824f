"""Where am I: dead reckoning with its growing doubt, the extended Kalman filter, and the test of their honesty.

A belief is a mean pose and a covariance. The particle filter stands in `particles`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray
from scipy.stats import chi2

from fuzzynav.geometry import Array, read_only, sealed, wrap
from fuzzynav.robot import move

__all__ = [
    "Belief",
    "Correction",
    "LandmarkSensor",
    "MotionNoise",
    "Track",
    "correct",
    "dead_reckoning",
    "ellipse",
    "expected",
    "motion_jacobians",
    "nees",
    "nees_bounds",
    "predict",
    "sample_motions",
    "see_landmarks",
    "track",
    "trilaterate",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionNoise:
    """Variance that driving adds, in proportion to the way driven, so that the length of a step does not matter.

    Raises ValueError for a negative or infinite value.
    """

    travel_per_metre: float = 1e-4  # [m^2 / m]
    travel_per_radian: float = 1e-5  # [m^2 / rad]
    turn_per_metre: float = 4e-4  # [rad^2 / m]
    turn_per_radian: float = 4e-4  # [rad^2 / rad]

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (np.isfinite(value) and value >= 0):
                raise ValueError(f"MotionNoise.{field.name} must be finite and not negative, got {value}")

    def variances(self, motion: ArrayLike) -> Array:
        """Variance `(..., 2)` of the advance [m^2] and of the turn [rad^2] of a motion `(..., 2)` [m, rad]."""
        way = np.abs(np.asarray(motion, dtype=float))
        travel = self.travel_per_metre * way[..., 0] + self.travel_per_radian * way[..., 1]
        return np.stack([travel, self.turn_per_metre * way[..., 0] + self.turn_per_radian * way[..., 1]], axis=-1)


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """A Gaussian over poses: mean `(3,)` [m, m, rad] and covariance `(3, 3)`.

    Both are read-only copies. Raises ValueError if a number is not finite or the covariance is not symmetric and
    non-negative.
    """

    mean: Array
    covariance: Array

    def __post_init__(self) -> None:
        mean, cov = np.array(self.mean, dtype=float), np.array(self.covariance, dtype=float)
        if mean.shape != (3,) or cov.shape != (3, 3) or not (np.isfinite(mean).all() and np.isfinite(cov).all()):
            raise ValueError("a belief is a finite mean (3,) and a finite covariance (3, 3)")
        scale = max(float(np.abs(cov).max()), 1e-300)
        if np.abs(cov - cov.T).max() > 1e-9 * scale or np.linalg.eigvalsh(cov)[0] < -1e-9 * scale:
            raise ValueError("the covariance of a belief must be symmetric and without negative variance")
        mean[2] = wrap(mean[2])
        object.__setattr__(self, "mean", sealed(mean))
        object.__setattr__(self, "covariance", sealed((cov + cov.T) / 2.0))


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """Beliefs along a run: means `(n, 3)` and covariances `(n, 3, 3)`, read-only."""

    means: Array
    covariances: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "means", read_only(self.means))
        object.__setattr__(self, "covariances", read_only(self.covariances))


# --- dead reckoning ----------------------------------------------------------------------------


def motion_jacobians(pose: ArrayLike, motion: ArrayLike) -> tuple[Array, Array]:
    """Derivatives of the exact arc by the pose `(..., 3, 3)` and by the motion `(..., 3, 2)` (advance, turn).

    >>> motion_jacobians([0, 0, 0], [1.0, 0.0])[0].tolist()        # a wrong heading moves the end sideways
    [[1.0, 0.0, -0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]]
    """
    p, m = np.asarray(pose, dtype=float), np.asarray(motion, dtype=float)
    theta, advance, turn = np.broadcast_arrays(p[..., 2], m[..., 0], m[..., 1])
    ratio = np.sinc(turn / (2.0 * np.pi))  # chord over arc
    half = turn / 2.0
    small = np.abs(turn) < 1e-3
    safe = np.where(small, 1.0, half)
    slope = np.where(small, -turn / 12.0 + turn**3 / 480.0, (np.cos(safe) - np.sin(safe) / safe) / (2.0 * safe))
    c, s = np.cos(theta + half), np.sin(theta + half)
    chord = advance * ratio
    by_pose = np.zeros((*chord.shape, 3, 3))
    by_pose[..., [0, 1, 2], [0, 1, 2]] = 1.0
    by_pose[..., 0, 2], by_pose[..., 1, 2] = -chord * s, chord * c
    by_motion = np.zeros((*chord.shape, 3, 2))
    by_motion[..., 0, 0], by_motion[..., 1, 0] = ratio * c, ratio * s
    by_motion[..., 0, 1] = advance * (slope * c - ratio * s / 2.0)
    by_motion[..., 1, 1] = advance * (slope * s + ratio * c / 2.0)
    by_motion[..., 2, 1] = 1.0
    return by_pose, by_motion


def predict(belief: Belief, motion: ArrayLike, noise: MotionNoise) -> Belief:
    """The belief after a motion (advance [m], turn [rad]): the mean along the exact arc, the doubt by its Jacobians."""
    moved = np.asarray(motion, dtype=float)
    if moved.shape != (2,) or not np.isfinite(moved).all():
        raise ValueError(f"a motion is a finite advance and turn, got {moved.tolist()}")
    by_pose, by_motion = motion_jacobians(belief.mean, moved)
    added = (by_motion * noise.variances(moved)) @ by_motion.T
    return Belief(move(belief.mean, moved, 1.0), by_pose @ belief.covariance @ by_pose.T + added)


def dead_reckoning(start: Belief, motions: ArrayLike, noise: MotionNoise) -> Track:
    """Beliefs before and after each of the motions `(n, 2)`, from odometry alone."""
    beliefs = [start]
    for motion in np.asarray(motions, dtype=float).reshape(-1, 2):
        beliefs.append(predict(beliefs[-1], motion, noise))
    return track(beliefs)


def track(beliefs: list[Belief]) -> Track:
    """A list of beliefs as arrays."""
    return Track(np.array([b.mean for b in beliefs]), np.array([b.covariance for b in beliefs]))


def sample_motions(motions: ArrayLike, noise: MotionNoise, rng: Generator) -> Array:
    """Motions `(..., 2)` as they might have been driven: the given ones with their noise added."""
    m = np.asarray(motions, dtype=float)
    return m + np.sqrt(noise.variances(m)) * rng.standard_normal(m.shape)


def ellipse(mean: ArrayLike, covariance: ArrayLike, probability: float = 0.95, n: int = 73) -> Array:
    """Closed line `(n, 2)` [m] round the positions that hold this probability of a Gaussian.

    `mean` and `covariance` may be of a pose; its x and y are used. Raises ValueError for a probability outside (0, 1).
    """
    if not 0 < probability < 1:
        raise ValueError(f"probability must lie between 0 and 1, got {probability}")
    values, vectors = np.linalg.eigh(np.asarray(covariance, dtype=float)[:2, :2])
    t = np.linspace(0.0, 2.0 * np.pi, n)
    circle = np.sqrt(chi2.ppf(probability, 2)) * np.stack([np.cos(t), np.sin(t)])
    found: Array = (
        np.asarray(mean, dtype=float)[:2] + (vectors @ (np.sqrt(np.maximum(values, 0.0))[:, None] * circle)).T
    )
    return found


# --- landmarks and the extended Kalman filter --------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class LandmarkSensor:
    """A sensor that names landmarks and measures their range and bearing.

    Raises ValueError if a standard deviation or a limit is not positive.
    """

    sigma_range: float = 0.1  # [m]
    sigma_bearing: float = 0.03  # [rad]
    range_max: float = 8.0  # [m]
    field_of_view: float = 2.0 * np.pi  # [rad], centred ahead

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (np.isfinite(value) and value > 0):
                raise ValueError(f"LandmarkSensor.{field.name} must be finite and positive, got {value}")


@dataclass(frozen=True, slots=True, eq=False)
class Correction:
    """What a sighting did: the new belief, the innovations `(k, 2)` (range [m], bearing [rad]) and their NIS.

    NIS is the squared innovation over its covariance; with an honest filter it has a chi-square distribution
    with 2k degrees of freedom.
    """

    belief: Belief
    innovations: Array
    nis: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "innovations", read_only(self.innovations))


def expected(pose: ArrayLike, landmarks: ArrayLike) -> Array:
    """Range [m] and bearing [rad] `(k, 2)` of landmarks `(k, 2)` [m] as seen from a pose.

    >>> expected([1, 1, np.pi / 2], [[1, 3], [2, 1]]).round(4).tolist()
    [[2.0, 0.0], [1.0, -1.5708]]
    """
    x, y, theta = np.asarray(pose, dtype=float)
    d = np.asarray(landmarks, dtype=float).reshape(-1, 2) - [x, y]
    return np.stack([np.hypot(d[:, 0], d[:, 1]), wrap(np.arctan2(d[:, 1], d[:, 0]) - theta)], axis=-1)


def see_landmarks(
    pose: ArrayLike, landmarks: ArrayLike, sensor: LandmarkSensor, rng: Generator
) -> tuple[NDArray[np.int64], Array]:
    """Which landmarks are seen from the true pose `(k,)`, and their noisy range and bearing `(k, 2)`."""
    ideal = expected(pose, landmarks)
    seen = (ideal[:, 0] <= sensor.range_max) & (np.abs(ideal[:, 1]) <= sensor.field_of_view / 2.0)
    noisy = ideal + [sensor.sigma_range, sensor.sigma_bearing] * rng.standard_normal(ideal.shape)
    noisy[:, 0], noisy[:, 1] = np.abs(noisy[:, 0]), wrap(noisy[:, 1])
    return np.flatnonzero(seen), noisy[seen]


def _sighting_jacobian(pose: Array, landmarks: Array) -> Array:
    """Derivative `(2k, 3)` of the stacked ranges and bearings by the pose."""
    d = landmarks - pose[:2]
    q = (d**2).sum(axis=1)
    r = np.sqrt(q)
    rows = np.zeros((len(d), 2, 3))
    rows[:, 0, 0], rows[:, 0, 1] = -d[:, 0] / r, -d[:, 1] / r
    rows[:, 1, 0], rows[:, 1, 1], rows[:, 1, 2] = d[:, 1] / q, -d[:, 0] / q, -1.0
    return rows.reshape(-1, 3)


def _sighting_residual(a: Array, b: Array) -> Array:
    """Difference of stacked sightings with the bearings wrapped."""
    gap = a - b
    gap[1::2] = wrap(gap[1::2])
    return gap


def correct(
    belief: Belief, ids: ArrayLike, measured: ArrayLike, landmarks: ArrayLike, sensor: LandmarkSensor
) -> Correction:
    """The belief after seeing landmarks `ids` (k,) at range and bearing `measured` `(k, 2)`, by filterpy's EKF.

    All sightings are used in one step; without one the belief is unchanged and NIS is nan.
    Raises ValueError if a sighting is not finite, names no landmark, or lies on the robot itself.
    """
    which, z = np.asarray(ids, dtype=np.int64).ravel(), np.asarray(measured, dtype=float).reshape(-1, 2)
    marks = np.asarray(landmarks, dtype=float).reshape(-1, 2)
    if len(which) != len(z) or not np.isfinite(z).all() or np.any((which < 0) | (which >= len(marks))):
        raise ValueError(f"finite sightings, one for each id 0 to {len(marks) - 1}, expected; got ids {which.tolist()}")
    if len(which) == 0:
        return Correction(belief, np.empty((0, 2)), float("nan"))
    seen = marks[which]
    if np.any(np.hypot(*(seen - belief.mean[:2]).T) < 1e-9):
        raise ValueError("a landmark lies on the believed position: its bearing is undefined")
    ekf = ExtendedKalmanFilter(dim_x=3, dim_z=z.size)
    ekf.x, ekf.P = belief.mean.copy(), belief.covariance.copy()
    ekf.R = np.diag(np.tile([sensor.sigma_range**2, sensor.sigma_bearing**2], len(z)))
    ekf.update(
        z.ravel(),
        _sighting_jacobian,
        lambda x, m: expected(x, m).ravel(),
        args=(seen,),
        hx_args=(seen,),
        residual=_sighting_residual,
    )
    return Correction(Belief(ekf.x, ekf.P), ekf.y.reshape(-1, 2), float(ekf.y @ ekf.SI @ ekf.y))


def trilaterate(anchors: ArrayLike, ranges: ArrayLike) -> Array:
    """Position (2,) [m] from measured distances `(n,)` [m] to known anchors `(n, 2)` [m], by least squares.

    This is what a GPS receiver does with its ranges, and it is trilateration: no angle is measured (errata T68).
    Raises ValueError for fewer than three ranges, or anchors on one line.

    >>> trilaterate([[0, 0], [4, 0], [0, 3]], [2.5, 2.5, 2.5]).round(6).tolist()
    [2.0, 1.5]
    """
    a, r = np.asarray(anchors, dtype=float).reshape(-1, 2), np.asarray(ranges, dtype=float).ravel()
    if len(a) < 3 or r.shape != (len(a),) or not (np.isfinite(a).all() and np.isfinite(r).all() and np.all(r >= 0)):
        raise ValueError(f"at least three finite anchors with a distance each expected, got {len(a)} and {len(r)}")
    if np.linalg.matrix_rank(a - a.mean(axis=0), tol=1e-9 * np.abs(a).max()) < 2:
        raise ValueError("the anchors lie on one line: the position could be on either side of it")
    right = (a[1:] ** 2).sum(axis=1) - (a[0] ** 2).sum() - r[1:] ** 2 + r[0] ** 2
    at = np.linalg.lstsq(2.0 * (a[1:] - a[0]), right, rcond=None)[0]  # the circles' common chords
    for _ in range(20):
        gap = at - a
        far = np.maximum(np.hypot(gap[:, 0], gap[:, 1]), 1e-12)
        at = at + np.linalg.lstsq(gap / far[:, None], r - far, rcond=None)[0]
    return np.asarray(at)


# --- honesty -----------------------------------------------------------------------------------


def nees(truth: ArrayLike, means: ArrayLike, covariances: ArrayLike) -> Array:
    """Normalised estimation error squared `(...)` of poses `(..., 3)`: e^T P^-1 e, the heading error wrapped.

    An honest filter has the mean 3. Raises ValueError where a covariance cannot be inverted.

    >>> nees([[0.2, 0.0, 6.2831853]], [[0.0, 0.0, 0.0]], [np.diag([0.01, 0.01, 0.01])]).round(3).tolist()
    [4.0]
    """
    error = np.asarray(truth, dtype=float) - np.asarray(means, dtype=float)
    error[..., 2] = wrap(error[..., 2])
    cov = np.asarray(covariances, dtype=float)
    if np.any(np.linalg.matrix_rank(cov) < error.shape[-1]):
        raise ValueError("a covariance is singular: start from a belief with some doubt in x, y and heading")
    found: Array = np.einsum("...i,...i->...", error, np.linalg.solve(cov, error[..., None])[..., 0])
    return found


def nees_bounds(runs: int, probability: float = 0.95, dimensions: int = 3) -> tuple[float, float]:
    """Interval that holds, with this probability, the NEES of an honest filter averaged over independent runs.

    >>> [round(b, 2) for b in nees_bounds(50)]
    [2.36, 3.72]
    """
    if runs < 1 or not 0 < probability < 1:
        raise ValueError(f"runs must be at least 1 and probability in (0, 1), got {runs} and {probability}")
    tails = [(1.0 - probability) / 2.0, (1.0 + probability) / 2.0]
    low, high = chi2.ppf(tails, runs * dimensions) / runs
    return float(low), float(high)
