"""From a fuzzy output set, given by its samples, to one number; and the crisp average of Takagi-Sugeno systems.

All functions take the sample places x (n,), ascending, and memberships mu (..., n), and return (...) values: nan where
the set is empty.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array

__all__ = ["bisector", "centroid", "largest_of_maximum", "linear_consequent", "maximisers", "mean_of_maximum",
           "smallest_of_maximum", "weighted_average"]  # fmt: skip


def _samples(x: ArrayLike, mu: ArrayLike) -> tuple[Array, Array]:
    places, degrees = np.asarray(x, dtype=float), np.asarray(mu, dtype=float)
    if places.ndim != 1 or places.size < 2 or degrees.shape[-1:] != places.shape:
        raise ValueError(f"x must be (n,) with n >= 2 and mu (..., n), got {places.shape} and {degrees.shape}")
    if not (np.diff(places) > 0.0).all():
        raise ValueError("x must ascend")
    return places, degrees


def _divide(numerator: Array, denominator: Array) -> Array:
    """Quotient, nan where the denominator is 0 (or nan)."""
    empty = ~(denominator > 0.0)
    return np.where(empty, np.nan, numerator / np.where(empty, 1.0, denominator))


def centroid(x: ArrayLike, mu: ArrayLike, quadrature: str = "trapezoid") -> Array:
    """Centre of gravity of the set: the integral of x mu over the integral of mu.

    `quadrature`: "trapezoid" rule; "midpoint" and "sum", which weigh all samples alike; "exact" takes straight lines
    between the samples. Raises ValueError for another name.

    Source: thesis eq 2.41 (errata T51)

    >>> float(centroid([0.0, 1.0, 2.0], [0.0, 1.0, 1.0], "sum"))
    1.5
    """
    places, degrees = _samples(x, mu)
    if quadrature in ("midpoint", "sum"):
        return _divide((places * degrees).sum(-1), degrees.sum(-1))
    middle = 0.5 * (places[0] + places[-1])
    step, a, b = np.diff(places), degrees[..., :-1], degrees[..., 1:]
    left, right = places[:-1] - middle, places[1:] - middle
    area = (0.5 * step * (a + b)).sum(-1)
    if quadrature == "trapezoid":
        moment = (0.5 * step * (left * a + right * b)).sum(-1)
    elif quadrature == "exact":
        moment = (step * (left * (2.0 * a + b) + right * (a + 2.0 * b)) / 6.0).sum(-1)
    else:
        raise ValueError(f"unknown quadrature {quadrature!r}; known: trapezoid, midpoint, sum, exact")
    result: Array = middle + _divide(moment, area)
    return result


def bisector(x: ArrayLike, mu: ArrayLike) -> Array:
    """The x that halves the area of the set, with straight lines between the samples.

    >>> float(bisector([0.0, 1.0, 2.0], [1.0, 1.0, 1.0]))
    1.0
    """
    places, degrees = _samples(x, mu)
    flat = np.array([_halve(places, row) for row in degrees.reshape(-1, places.size)])
    return flat.reshape(degrees.shape[:-1])


def _halve(x: Array, mu: Array) -> float:
    areas = 0.5 * np.diff(x) * (mu[:-1] + mu[1:])
    total = areas.sum()
    if not total > 0.0:
        return np.nan
    k = int(np.flatnonzero((np.cumsum(areas) >= 0.5 * total) & (areas > 0.0))[0])
    need = (0.5 * total - areas[:k].sum()) / (x[k + 1] - x[k])
    a, slope = mu[k], mu[k + 1] - mu[k]
    t = 2.0 * need / (a + np.sqrt(max(a * a + 2.0 * slope * need, 0.0)))
    return float(x[k] + t * (x[k + 1] - x[k]))


def maximisers(mu: ArrayLike) -> Array:
    """Which samples (..., n) reach the greatest membership (to a part in 1e12); none in an empty set.

    Source: thesis eq 2.42

    >>> maximisers([0.0, 0.5, 0.5]).tolist()
    [False, True, True]
    """
    degrees = np.asarray(mu, dtype=float)
    top = degrees.max(-1, keepdims=True)
    result: Array = (degrees >= top * (1.0 - 1e-12)) & (top > 0.0)
    return result


def mean_of_maximum(x: ArrayLike, mu: ArrayLike) -> Array:
    """Mean of the samples of greatest membership: finitely many, as the printed formula needs.

    Source: thesis eq 2.43 (errata T50)

    >>> float(mean_of_maximum([0.0, 1.0, 2.0], [0.1, 0.5, 0.5]))
    1.5
    """
    places, degrees = _samples(x, mu)
    chosen = maximisers(degrees)
    return _divide((places * chosen).sum(-1), chosen.sum(-1).astype(float))


def smallest_of_maximum(x: ArrayLike, mu: ArrayLike) -> Array:
    """The first sample of greatest membership."""
    places, degrees = _samples(x, mu)
    chosen = maximisers(degrees)
    return np.where(chosen.any(-1), places[chosen.argmax(-1)], np.nan)


def largest_of_maximum(x: ArrayLike, mu: ArrayLike) -> Array:
    """The last sample of greatest membership."""
    places, degrees = _samples(x, mu)
    chosen = maximisers(degrees)[..., ::-1]
    return np.where(chosen.any(-1), places[::-1][chosen.argmax(-1)], np.nan)


def linear_consequent(coefficients: ArrayLike, inputs: ArrayLike) -> Array:
    """Conclusion y = c1 x1 + ... + cn xn + c0 of a Takagi-Sugeno rule, for inputs (..., n) and coefficients (n + 1,).

    Source: thesis eq 2.45

    >>> float(linear_consequent([2.0, -1.0, 0.5], [1.0, 3.0]))
    -0.5
    """
    c = np.asarray(coefficients, dtype=float)
    result: Array = np.asarray(inputs, dtype=float) @ c[:-1] + c[-1]
    return result


def weighted_average(strengths: ArrayLike, conclusions: ArrayLike) -> Array:
    """Average (...) of the rules' conclusions (..., n), weighted with their strengths (..., n); nan if none fires.

    Source: thesis eq 2.46 (errata T51)

    >>> float(weighted_average([0.25, 0.75], [0.0, 4.0]))
    3.0
    """
    w = np.asarray(strengths, dtype=float)
    return _divide((w * np.asarray(conclusions, dtype=float)).sum(-1), w.sum(-1))
