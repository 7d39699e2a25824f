"""Plane geometry: angles, rigid motions, polylines and distances.

Poses are `(..., 3)` arrays of x [m], y [m], theta [rad]; points are `(..., 2)` arrays [m].
"""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

Array = NDArray[np.float64]
MOST_POINTS = 10_000_000  # that a polyline is cut into
Kind = TypeVar("Kind", bound=np.generic)

__all__ = [
    "Array",
    "compose",
    "cumulative_length",
    "curvature",
    "inverse",
    "length",
    "point_segment_distance",
    "read_only",
    "resample",
    "sealed",
    "to_body",
    "to_world",
    "wrap",
]


def sealed(array: NDArray[Kind]) -> NDArray[Kind]:
    """The same array, from now on read-only: for arrays that nobody else holds.

    >>> sealed(np.zeros(3))[0] = 1.0
    Traceback (most recent call last):
    ValueError: assignment destination is read-only
    """
    array.setflags(write=False)
    return array


def read_only(values: ArrayLike, dtype: DTypeLike = float) -> NDArray[Any]:
    """A contiguous copy that cannot be written to; what is such a copy already is handed back as it is."""
    given = np.asarray(values)
    if given.dtype == dtype and given.base is None and not given.flags.writeable and given.flags.c_contiguous:
        return given
    return sealed(np.array(given, dtype=dtype, order="C"))


def wrap(angle: ArrayLike) -> Array:
    """Angle [rad] brought to [-pi, pi), of any shape; nan stays nan.

    >>> float(np.round(wrap(4.0), 4))
    -2.2832
    """
    a = np.asarray(angle, dtype=float)
    wrapped = (a + np.pi) % (2.0 * np.pi) - np.pi
    wrapped = np.where(wrapped >= np.pi, -np.pi, wrapped)
    return np.where((a >= -np.pi) & (a < np.pi), a, wrapped)  # what is in range keeps its last digit


def compose(first: ArrayLike, second: ArrayLike) -> Array:
    """Pose `second`, given in the frame of `first`, in the frame that `first` is given in.

    >>> compose([1, 0, np.pi / 2], [2, 0, 0]).round(3).tolist()
    [1.0, 2.0, 1.571]
    """
    a, b = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    c, s = np.cos(a[..., 2]), np.sin(a[..., 2])
    x = a[..., 0] + c * b[..., 0] - s * b[..., 1]
    y = a[..., 1] + s * b[..., 0] + c * b[..., 1]
    return np.stack([x, y, wrap(a[..., 2] + b[..., 2])], axis=-1)


def inverse(pose: ArrayLike) -> Array:
    """Pose of the old frame seen from the frame of `pose`: compose(inverse(p), p) is zero.

    >>> inverse([1, 0, np.pi / 2]).round(3).tolist()
    [-0.0, 1.0, -1.571]
    """
    p = np.asarray(pose, dtype=float)
    c, s = np.cos(p[..., 2]), np.sin(p[..., 2])
    x = -c * p[..., 0] - s * p[..., 1]
    y = s * p[..., 0] - c * p[..., 1]
    return np.stack([x, y, wrap(-p[..., 2])], axis=-1)


def to_world(pose: ArrayLike, points_body: ArrayLike) -> Array:
    """Points `(n, 2)` [m] of the body frame of one pose `(3,)`, in the world frame."""
    x, y, theta = np.asarray(pose, dtype=float)
    c, s = np.cos(theta), np.sin(theta)
    found: Array = np.asarray(points_body, dtype=float) @ np.array([[c, s], [-s, c]]) + [x, y]
    return found


def to_body(pose: ArrayLike, points_world: ArrayLike) -> Array:
    """Points `(n, 2)` [m] of the world frame, in the body frame of one pose `(3,)`."""
    x, y, theta = np.asarray(pose, dtype=float)
    c, s = np.cos(theta), np.sin(theta)
    found: Array = (np.asarray(points_world, dtype=float) - [x, y]) @ np.array([[c, -s], [s, c]])
    return found


def cumulative_length(points: ArrayLike) -> Array:
    """Arc length [m] from the first point to each point of a polyline `(n, 2)`; shape `(n,)`.

    Columns after the second are not read. Raises ValueError if there is no point.
    """
    pts = np.asarray(points, dtype=float)
    if pts.ndim != 2 or pts.shape[0] < 1 or pts.shape[1] < 2:
        raise ValueError(f"a polyline is an (n, 2) array with n >= 1, got shape {pts.shape}")
    steps = np.diff(pts[:, :2], axis=0)
    return np.concatenate([[0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))])


def length(points: ArrayLike) -> float:
    """Length [m] of a polyline `(n, 2)`; 0 for a single point.

    >>> length([[0, 0], [3, 4]])
    5.0
    """
    return float(cumulative_length(points)[-1])


def resample(points: ArrayLike, spacing: float) -> Array:
    """Polyline `(n, 2)` walked in equal steps of at most `spacing` [m], both ends kept.

    Raises ValueError if spacing is not positive, or so small that more than 10 million points would come out.
    """
    if not (np.isfinite(spacing) and spacing > 0):
        raise ValueError(f"spacing must be positive and finite, got {spacing}")
    pts = np.asarray(points, dtype=float)[:, :2]
    s = cumulative_length(pts)
    if not np.isfinite(s[-1]):
        raise ValueError("the points of a polyline must be finite")
    if s[-1] > MOST_POINTS * spacing:
        raise ValueError(f"steps of {spacing} m along {s[-1]:.6g} m make over {MOST_POINTS} points: take longer steps")
    stations = np.linspace(0.0, s[-1], max(int(np.ceil(s[-1] / spacing)), 1) + 1)
    return np.stack([np.interp(stations, s, pts[:, k]) for k in range(2)], axis=-1)


def curvature(velocity: ArrayLike, acceleration: ArrayLike) -> Array:
    """Signed curvature [1/m] of a plane curve from its first and second derivative `(..., 2)`.

    Counter-clockwise is positive; nan where the first derivative vanishes.

    >>> float(curvature([0.0, 2.0], [-2.0, 0.0]))      # circle of radius 2, counter-clockwise
    0.5
    """
    d1, d2 = np.asarray(velocity, dtype=float), np.asarray(acceleration, dtype=float)
    cross = d1[..., 0] * d2[..., 1] - d1[..., 1] * d2[..., 0]
    speed = np.hypot(d1[..., 0], d1[..., 1])
    found: Array = cross / np.where(speed > 0.0, speed, np.nan) ** 3
    return found


def point_segment_distance(points: ArrayLike, start: ArrayLike, end: ArrayLike) -> Array:
    """Distance [m] from points `(..., 2)` to the segments start-end; shapes broadcast.

    >>> float(point_segment_distance([1.0, 1.0], [0, 0], [2, 0]))
    1.0
    """
    p, a, b = (np.asarray(q, dtype=float) for q in (points, start, end))
    along = b - a
    squared = np.maximum((along**2).sum(-1), np.finfo(float).tiny)
    t = np.clip(((p - a) * along).sum(-1) / squared, 0.0, 1.0)
    gap = p - (a + t[..., None] * along)
    found: Array = np.hypot(gap[..., 0], gap[..., 1])
    return found
