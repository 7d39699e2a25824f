"""The eight steps on a grid and the distances that guide a search; the search itself is in `kernels`."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.geometry import Array
from fuzzynav.planning.kernels import kept

__all__ = ["STEPS", "bearing", "distance_scale", "enhanced", "euclidean", "kept_directions", "manhattan", "octile"]

# x, y of the eight steps: N, NE, E, SE, S, SW, W, NW
STEPS = np.array([(0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1)])


def euclidean(offset: ArrayLike) -> Array:
    """Straight-line distance of offsets `(..., 2)`.

    Source: thesis eq 3.3 and eq 4.3.

    >>> float(euclidean([3, 4]))
    5.0
    """
    d = np.asarray(offset, dtype=float)
    length: Array = np.hypot(d[..., 0], d[..., 1])
    return length


def manhattan(offset: ArrayLike) -> Array:
    """Sum of the absolute offsets `(..., 2)`: too long for eight neighbours, a diagonal step of 1.414 counts 2.

    Source: thesis eq 3.5 (errata T14).

    >>> float(manhattan([3, -4]))
    7.0
    """
    total: Array = np.abs(np.asarray(offset, dtype=float)).sum(axis=-1)
    return total


def octile(offset: ArrayLike) -> Array:
    """Length of the shortest eight-connected path across an empty grid, for offsets `(..., 2)`.

    >>> round(float(octile([3, 4])), 4)
    5.2426
    """
    d = np.abs(np.asarray(offset, dtype=float))
    length: Array = d.max(axis=-1) + (np.sqrt(2.0) - 1.0) * d.min(axis=-1)
    return length


def distance_scale(offset: ArrayLike, total: ArrayLike) -> Array:
    """P: Manhattan distance from the node to the goal over that from the start, clipped to [0, 1].

    Source: thesis eq 3.6 (errata T15: unclipped it exceeds 1 behind the start).

    >>> float(distance_scale([7, 7], [5, 5]))
    1.0
    """
    rest, whole = manhattan(offset), manhattan(total)
    return np.clip(np.divide(rest, whole, out=np.zeros(np.shape(rest)), where=whole > 0), 0.0, 1.0)


def enhanced(offset: ArrayLike, total: ArrayLike, base: float = 10.0) -> Array:
    """(1 + H/D) log(H + 1) H with H [m] the straight line to the goal and D [m] that from the start.

    It overestimates far from the goal and falls to 0 times H near it, and it depends on the unit of length.
    Source: thesis eq 4.4 (errata T17; the base of lg is not settled).

    >>> round(float(enhanced([15, 16], [15, 16]) / euclidean([15, 16])), 4)
    2.7209
    """
    h, whole = euclidean(offset), euclidean(total)
    ratio = np.divide(h, whole, out=np.zeros(np.shape(h)), where=whole > 0)
    value: Array = (1.0 + ratio) * np.log1p(h) / np.log(base) * h
    return value


def bearing(offset: ArrayLike) -> Array:
    """Direction [rad] of offsets `(..., 2)`, clockwise from north (positive y), in [0, 2 pi).

    Source: thesis eq 3.4 (errata T12: the printed arctan measures from east and divides by zero).

    >>> float(np.degrees(bearing([1, 0])))
    90.0
    """
    d = np.asarray(offset, dtype=float)
    angle: Array = np.arctan2(d[..., 0], d[..., 1]) % (2.0 * np.pi)
    return angle


def kept_directions(offset: ArrayLike) -> NDArray[np.int64]:
    """The five of STEPS, by index in compass order, that Table 3.1 keeps when the goal lies at `offset` (2,).

    >>> kept_directions([0, 5]).tolist()
    [0, 1, 2, 6, 7]
    """
    x, y = np.asarray(offset, dtype=float)
    return np.array([d for d in range(8) if kept(x, y, d)])
