"""Fuzzy operators: conjunctions, disjunctions and hedges, each by its name.

The order of the names is the code by which the compiled kernels know them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array

__all__ = ["CONORMS", "HEDGES", "NORMS", "conjunction", "disjunction", "hedge", "negation"]

_Operator = Callable[[Array, Array], Array]


def _drastic(a: Array, b: Array) -> Array:
    return np.where(np.maximum(a, b) == 1.0, np.minimum(a, b), 0.0)


def _drastic_sum(a: Array, b: Array) -> Array:
    return np.where(np.minimum(a, b) == 0.0, np.maximum(a, b), 1.0)


def _hamacher(a: Array, b: Array) -> Array:
    both = a + b - a * b
    return np.where(both == 0.0, 0.0, a * b / np.where(both == 0.0, 1.0, both))


def _hamacher_sum(a: Array, b: Array) -> Array:
    gap = 1.0 - a * b  # the usual form (a + b - 2 a b) / gap loses every digit where a and b are near 1
    return np.where(gap == 0.0, 1.0, 1.0 - (1.0 - a) * (1.0 - b) / np.where(gap == 0.0, 1.0, gap))


NORMS: dict[str, _Operator] = {
    "min": np.minimum,
    "product": lambda a, b: a * b,
    "bounded difference": lambda a, b: np.maximum(0.0, a + b - 1.0),
    "drastic": _drastic,
    "einstein": lambda a, b: a * b / (2.0 - (a + b - a * b)),
    "hamacher": _hamacher,
    "nilpotent minimum": lambda a, b: np.where(a + b > 1.0, np.minimum(a, b), 0.0),
}
"""Conjunctions (AND, implication) by name."""

CONORMS: dict[str, _Operator] = {
    "max": np.maximum,
    "probabilistic sum": lambda a, b: a + b - a * b,
    "bounded sum": lambda a, b: np.minimum(1.0, a + b),
    "sum": lambda a, b: a + b,
    "normalized sum": lambda a, b: (a + b) / np.maximum(1.0, a + b),
    "drastic sum": _drastic_sum,
    "einstein sum": lambda a, b: (a + b) / (1.0 + a * b),
    "hamacher sum": _hamacher_sum,
    "nilpotent maximum": lambda a, b: np.where(a + b < 1.0, np.maximum(a, b), 1.0),
}
"""Disjunctions (OR, aggregation) by name; 'sum' is not bounded by 1."""

HEDGES: dict[str, Callable[[Array], Array]] = {
    "not": lambda m: 1.0 - m,
    "very": lambda m: m**2,
    "somewhat": np.sqrt,
    "extremely": lambda m: np.where(m <= 0.5, 2.0 * m**2, 1.0 - 2.0 * (1.0 - m) ** 2),
    "seldom": lambda m: np.where(
        m <= 0.5, np.sqrt(np.maximum(m, 0.0) / 2.0), 1.0 - np.sqrt(np.maximum(1.0 - m, 0.0) / 2.0)
    ),
    "any": lambda m: np.where(np.isnan(m), np.nan, 1.0),
}
"""Hedges by name: what the word before a term does to its membership."""


def _pick(table: dict[str, Callable[..., Array]], name: str, what: str) -> Callable[..., Array]:
    if name not in table:
        raise ValueError(f"unknown {what} {name!r}; known: {', '.join(table)}")
    return table[name]


def conjunction(a: ArrayLike, b: ArrayLike, norm: str = "min") -> Array:
    """Degree to which both a AND b hold, element by element; shapes broadcast.

    >>> float(conjunction(0.3, 0.8)), float(conjunction(0.3, 0.8, "bounded difference").round(3))
    (0.3, 0.1)
    """
    return np.asarray(_pick(NORMS, norm, "conjunction")(np.asarray(a, dtype=float), np.asarray(b, dtype=float)))


def disjunction(a: ArrayLike, b: ArrayLike, conorm: str = "max") -> Array:
    """Degree to which a OR b holds, element by element; shapes broadcast.

    >>> float(disjunction(0.3, 0.8)), float(disjunction(0.3, 0.8, "probabilistic sum").round(3))
    (0.8, 0.86)
    """
    return np.asarray(_pick(CONORMS, conorm, "disjunction")(np.asarray(a, dtype=float), np.asarray(b, dtype=float)))


def negation(a: ArrayLike) -> Array:
    """Degree to which a does NOT hold. With `conjunction` min and `disjunction` max this is the thesis's triple.

    Source: thesis eq 2.36

    >>> float(negation(0.25))
    0.75
    """
    return 1.0 - np.asarray(a, dtype=float)


def hedge(name: str, degree: ArrayLike) -> Array:
    """Degree after the hedge `name`: not, very, somewhat, extremely, seldom or any.

    >>> float(hedge("very", 0.5)), float(hedge("somewhat", 0.25))
    (0.25, 0.5)
    """
    return np.asarray(_pick(HEDGES, name, "hedge")(np.asarray(degree, dtype=float)))
