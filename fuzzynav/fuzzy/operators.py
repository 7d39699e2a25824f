"""Fuzzy operators: conjunctions, disjunctions and hedges, each by its name.

Each is a row: its number in the compiled kernels, its NumPy function, its words in the file formats.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.fuzzy import codes
from fuzzynav.geometry import Array

__all__ = ["CONORMS", "HEDGES", "NORMS", "Operator", "conjunction", "disjunction", "hedge", "negation"]


def _product(a: Array, b: Array) -> Array:
    return a * b


def _bounded_difference(a: Array, b: Array) -> Array:
    return np.maximum(0.0, a + b - 1.0)


def _drastic(a: Array, b: Array) -> Array:
    return np.where(np.maximum(a, b) == 1.0, np.minimum(a, b), 0.0)


def _einstein(a: Array, b: Array) -> Array:
    return a * b / (2.0 - (a + b - a * b))


def _drastic_sum(a: Array, b: Array) -> Array:
    return np.where(np.minimum(a, b) == 0.0, np.maximum(a, b), 1.0)


def _hamacher(a: Array, b: Array) -> Array:
    both = a + b - a * b
    return np.where(both == 0.0, 0.0, a * b / np.where(both == 0.0, 1.0, both))


def _hamacher_sum(a: Array, b: Array) -> Array:
    gap = 1.0 - a * b  # the usual form (a + b - 2 a b) / gap loses every digit where a and b are near 1
    return np.where(gap == 0.0, 1.0, 1.0 - (1.0 - a) * (1.0 - b) / np.where(gap == 0.0, 1.0, gap))


def _nilpotent_minimum(a: Array, b: Array) -> Array:
    return np.where(a + b > 1.0, np.minimum(a, b), 0.0)


def _probabilistic_sum(a: Array, b: Array) -> Array:
    return a + b - a * b


def _bounded_sum(a: Array, b: Array) -> Array:
    return np.minimum(1.0, a + b)


def _sum(a: Array, b: Array) -> Array:
    return a + b


def _normalized_sum(a: Array, b: Array) -> Array:
    return (a + b) / np.maximum(1.0, a + b)


def _einstein_sum(a: Array, b: Array) -> Array:
    return (a + b) / (1.0 + a * b)


def _nilpotent_maximum(a: Array, b: Array) -> Array:
    return np.where(a + b < 1.0, np.maximum(a, b), 1.0)


def _not(m: Array) -> Array:
    return 1.0 - m


def _extremely(m: Array) -> Array:
    return np.where(m <= 0.5, 2.0 * m**2, 1.0 - 2.0 * (1.0 - m) ** 2)


def _seldom(m: Array) -> Array:
    low, high = np.sqrt(np.maximum(m, 0.0) / 2.0), 1.0 - np.sqrt(np.maximum(1.0 - m, 0.0) / 2.0)
    return np.where(m <= 0.5, low, high)


def _any(m: Array) -> Array:
    return np.where(np.isnan(m), np.nan, 1.0)


@dataclass(frozen=True, slots=True)
class Operator:
    """An operator: its number in the compiled kernels, its function, and its word in the file formats ("" for none)."""

    code: int
    function: Callable[..., Array]
    fll: str = ""
    fis: str = ""


NORMS: dict[str, Operator] = {
    "min": Operator(codes.MIN, np.minimum, "Minimum", "min"),
    "product": Operator(codes.PRODUCT, _product, "AlgebraicProduct", "prod"),
    "bounded difference": Operator(codes.BOUNDED_DIFFERENCE, _bounded_difference, "BoundedDifference"),
    "drastic": Operator(codes.DRASTIC, _drastic, "DrasticProduct"),
    "einstein": Operator(codes.EINSTEIN, _einstein, "EinsteinProduct"),
    "hamacher": Operator(codes.HAMACHER, _hamacher, "HamacherProduct"),
    "nilpotent minimum": Operator(codes.NILPOTENT_MINIMUM, _nilpotent_minimum, "NilpotentMinimum"),
}
"""Conjunctions (AND, implication) by name."""

CONORMS: dict[str, Operator] = {
    "max": Operator(codes.MAX, np.maximum, "Maximum", "max"),
    "probabilistic sum": Operator(codes.PROBABILISTIC_SUM, _probabilistic_sum, "AlgebraicSum", "probor"),
    "bounded sum": Operator(codes.BOUNDED_SUM, _bounded_sum, "BoundedSum"),
    "sum": Operator(codes.SUM, _sum, "UnboundedSum", "sum"),
    "normalized sum": Operator(codes.NORMALIZED_SUM, _normalized_sum, "NormalizedSum"),
    "drastic sum": Operator(codes.DRASTIC_SUM, _drastic_sum, "DrasticSum"),
    "einstein sum": Operator(codes.EINSTEIN_SUM, _einstein_sum, "EinsteinSum"),
    "hamacher sum": Operator(codes.HAMACHER_SUM, _hamacher_sum, "HamacherSum"),
    "nilpotent maximum": Operator(codes.NILPOTENT_MAXIMUM, _nilpotent_maximum, "NilpotentMaximum"),
}
"""Disjunctions (OR, aggregation) by name; 'sum' is not bounded by 1."""

HEDGES: dict[str, Operator] = {
    "not": Operator(codes.NOT, _not),
    "very": Operator(codes.VERY, np.square),
    "somewhat": Operator(codes.SOMEWHAT, np.sqrt),
    "extremely": Operator(codes.EXTREMELY, _extremely),
    "seldom": Operator(codes.SELDOM, _seldom),
    "any": Operator(codes.ANY, _any),
}
"""Hedges by name: what the word before a term does to its membership."""


def _pick(table: dict[str, Operator], name: str, what: str) -> Callable[..., Array]:
    if name not in table:
        raise ValueError(f"unknown {what} {name!r}; known: {', '.join(table)}")
    return table[name].function


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
