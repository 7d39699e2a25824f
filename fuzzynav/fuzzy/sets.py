"""The notions of fuzzy set theory on samples: x (n,) ascending places, mu (..., n) memberships."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.fuzzy.membership import Term
from fuzzynav.fuzzy.operators import NORMS, conjunction
from fuzzynav.geometry import Array

__all__ = ["alpha_cut", "cardinality", "core", "height", "is_normal", "match", "places", "relation",
           "rule_relation", "singleton", "support"]  # fmt: skip


def cardinality(mu: ArrayLike) -> Array:
    """Sum of the memberships (..., n) over the universe: (...).

    Source: thesis eq 2.28

    >>> float(cardinality([0.0, 0.5, 1.0, 0.5]))
    2.0
    """
    result: Array = np.asarray(mu, dtype=float).sum(-1)
    return result


def support(x: ArrayLike, mu: ArrayLike) -> Array:
    """The places that belong to the set at all: (m,).

    Source: thesis eq 2.29

    >>> support([0.0, 1.0, 2.0], [0.0, 0.5, 1.0]).tolist()
    [1.0, 2.0]
    """
    return np.asarray(x, dtype=float)[np.asarray(mu, dtype=float) > 0.0]


def core(x: ArrayLike, mu: ArrayLike) -> Array:
    """The places that belong to the set wholly: (m,), empty when there are none.

    Source: thesis eq 2.30

    >>> core([0.0, 1.0, 2.0], [0.0, 0.5, 1.0]).tolist()
    [2.0]
    """
    result: Array = np.asarray(x, dtype=float)[np.asarray(mu, dtype=float) == 1.0]
    return result


def height(mu: ArrayLike) -> Array:
    """Greatest membership (...) of a set (..., n)."""
    result: Array = np.asarray(mu, dtype=float).max(-1)
    return result


def is_normal(mu: ArrayLike) -> bool:
    """Whether the core of a set (n,) is not the empty set (printed: not 0; errata T46).

    >>> is_normal([0.0, 0.5, 0.9])
    False
    """
    return bool((np.asarray(mu, dtype=float) == 1.0).any())


def alpha_cut(x: ArrayLike, mu: ArrayLike, alpha: float) -> Array:
    """The places (m,) whose membership is at least alpha. Raises ValueError unless 0 <= alpha <= 1.

    Source: thesis eq 2.31

    >>> alpha_cut([0.0, 1.0, 2.0], [0.0, 0.5, 1.0], 0.5).tolist()
    [1.0, 2.0]
    """
    if not 0.0 <= alpha <= 1.0:
        raise ValueError(f"alpha must be from 0 to 1, got {alpha}")
    return np.asarray(x, dtype=float)[np.asarray(mu, dtype=float) >= alpha]


def singleton(x: ArrayLike, x0: float) -> Array:
    """A crisp reading x0 as a set over the universe x: 1 at x0, 0 elsewhere.

    Source: thesis eq 2.39

    >>> singleton([0.0, 0.5, 1.0], 0.5).tolist()
    [0.0, 1.0, 0.0]
    """
    result: Array = (np.asarray(x, dtype=float) == x0).astype(float)
    return result


_WIDTHS = {"gaussian": 6.0, "bell": 6.0, "spike": 1.0, "cosine": 0.5}


def places(reading: Term, low: float, high: float) -> Array:
    """Places in [low, high] at which to compare an uncertain reading: 1001 over the range, and 1001 over the reading
    itself, so that a narrow one is not lost between two samples. Raises ValueError for an endless range.

    >>> 3.25 in places(Term(name="r", shape="singleton", parameters=(3.25,)), 0.0, 100.0)
    True
    """
    if not np.isfinite([low, high]).all():
        raise ValueError(f"an uncertain reading needs an input with a finite range, got {low:g} to {high:g}")
    p = reading.parameters
    if reading.shape in _WIDTHS:
        near = [p[0] - _WIDTHS[reading.shape] * p[1], p[0], p[0] + _WIDTHS[reading.shape] * p[1]]
    elif reading.shape == "two-sided gaussian":
        near = [p[0] - 6.0 * p[1], p[0], p[2], p[2] + 6.0 * p[3]]
    else:
        near = list(p[0::2] if reading.shape == "discrete" else p)
    inside = [float(np.clip(x, low, high)) for x in near if np.isfinite(x)] or [low]
    return np.unique(np.concatenate(
        [np.linspace(low, high, 1001), np.linspace(min(inside), max(inside), 1001), inside]
    ))  # fmt: skip


def match(term: ArrayLike, reading: ArrayLike, norm: str = "min") -> Array:
    """Degree (...) to which an uncertain reading (..., n) is a term (..., n): the supremum of their intersection.

    `norm` "min" gives sup-min, "product" sup-product. Both are sets over the same samples.

    Source: thesis eq 2.40

    >>> float(match([0.0, 0.5, 1.0], [0.4, 1.0, 0.4]))
    0.5
    """
    result: Array = conjunction(term, reading, norm).max(-1)
    return result


def relation(premise: ArrayLike, conclusion: ArrayLike, implication: str = "min") -> Array:
    """The rule 'if x is A then y is B' as a fuzzy relation (n_x, n_y) from sampled A (n_x,) and B (n_y,).

    The thesis leaves the operator open; a control rule uses a conjunction: min (Mamdani) or product (Larsen).

    Source: thesis eq 2.37

    >>> relation([0.5, 1.0], [0.2, 0.8]).tolist()
    [[0.2, 0.5], [0.2, 0.8]]
    """
    a, b = np.asarray(premise, dtype=float), np.asarray(conclusion, dtype=float)
    return conjunction(a[:, None], b[None, :], implication)


def rule_relation(
    premises: list[Array], conclusions: list[Array], norm: str = "min", implication: str = "min"
) -> Array:
    """A rule with several premises and conclusions as a relation over all their universes, one axis for each.

    Raises ValueError for an unknown operator.

    Source: thesis eq 2.38

    >>> rule_relation([np.array([0.5, 1.0]), np.array([0.7])], [np.array([0.6])]).shape
    (2, 1, 1)
    """
    if norm not in NORMS or implication not in NORMS:
        raise ValueError(f"unknown operator {norm!r} or {implication!r}; known: {', '.join(NORMS)}")
    before, after = _outer(premises, norm), _outer(conclusions, norm)
    return conjunction(before.reshape(*before.shape, *[1] * after.ndim), after, implication)


def _outer(sets: list[Array], norm: str) -> Array:
    result = np.asarray(sets[0], dtype=float)
    for mu in sets[1:]:
        result = conjunction(result[..., None], np.asarray(mu, dtype=float), norm)
    return result
