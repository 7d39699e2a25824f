"""What every check asks first: is this a number, a row of n numbers, a whole number, yes or no."""

from __future__ import annotations

import math
from collections.abc import Set
from typing import Any

import numpy as np

from fuzzynav.course.exercise import Wrong
from fuzzynav.geometry import Array

__all__ = ["array", "close", "how_many", "integers", "named", "number", "numbers", "truth"]

WORDS = ("no", "one", "two", "three", "four", "five", "six")
KINDS = {"U": "a text", "S": "a text", "b": "True or False", "c": "a complex number", "M": "a date", "m": "a duration"}


def number(value: Any, what: str, *, silent: bool = False) -> float:
    """The answer as one real number; `silent` allows nan. Raises Wrong with a sentence that begins with `what`.

    Ints, numpy scalars, arrays and lists of one number and sympy numbers are taken.
    """
    return float(_row(value, 1, what, silent=silent)[0])


def numbers(value: Any, count: int, what: str) -> Array:
    """The answer as `count` finite numbers `(count,)`: a tuple, list, row, column or sympy matrix; -1 for any count."""
    return _row(value, count, what)


def array(value: Any, shape: tuple[int, ...], what: str) -> Array:
    """The answer as finite numbers of this shape; -1 stands for any length."""
    found = _real(value, what, f"an array of shape {_shape(shape)}")
    fits = found.ndim == len(shape) and all(s in (-1, n) for s, n in zip(shape, found.shape, strict=True))
    if not fits:
        raise Wrong(f"{what} should be an array of shape {_shape(shape)}, yours has the shape {_shape(found.shape)}.")
    _finite(found, what)
    return found


def integers(value: Any, count: int, what: str) -> list[int]:
    """The answer as `count` whole numbers; `count` -1 takes any number of them."""
    found = _real(value, what, "whole numbers").ravel() if count < 0 else _row(value, count, what)
    _finite(found, what)
    if np.any(found != np.round(found)):
        raise Wrong(f"{what} should be whole, yours {'is' if found.size == 1 else 'holds'} {_fraction(found):g}.")
    return [int(v) for v in found]


def truth(value: Any, what: str) -> bool:
    """The answer as True or False: Python's, numpy's, 0 or 1, also in an array of one entry."""
    found = np.asarray(value)
    if found.size == 1 and found.dtype.kind in "biuf" and found.reshape(-1)[0] in (0, 1):
        return bool(found.reshape(-1)[0])
    if found.size == 1 and found.dtype == object and str(value) in ("True", "False"):  # sympy's true and false
        return str(value) == "True"
    raise Wrong(f"{what} should be True or False, not {_kind(value)}.")


def close(told: Any, right: Any, atol: float = 1e-6) -> bool:
    """Whether all numbers agree to `atol`, or to a millionth of themselves: rounding to six digits is no mistake."""
    return bool(np.allclose(told, right, rtol=1e-6, atol=atol))


def named(told: Any, *mistakes: tuple[Any, str]) -> None:
    """Raise Wrong with the sentence of the first known mistake `(what it gives, sentence)` that gives what was told.

    With rows for several cases a mistake is named only if it explains them all.
    """
    for value, sentence in mistakes:
        if np.shape(told) == np.shape(value) and close(told, value):
            raise Wrong(sentence)


def how_many(count: int) -> str:
    """The count in words up to six, and 'number' or 'numbers'; -1 for any count.

    >>> how_many(1), how_many(3)
    ('one number', 'three numbers')
    """
    if count < 0:
        return "numbers"
    return f"{WORDS[count] if count < len(WORDS) else count} number{'s' * (count != 1)}"


def _row(value: Any, count: int, what: str, *, silent: bool = False) -> Array:
    found = _real(value, what, how_many(count)).ravel()
    if count >= 0 and found.size != count:
        raise Wrong(f"{what} should be {how_many(count)}; yours holds {how_many(found.size)}.")
    _finite(found, what, silent=silent)
    return found


def _real(value: Any, what: str, wanted: str) -> Array:
    """Real numbers of any shape, nan and infinity among them."""
    if isinstance(value, Set) and len(value) > 1:
        raise Wrong(f"{what} should be {wanted}; a set has no order, so give a tuple or a list.")
    plain = list(value) if hasattr(value, "__iter__") and not hasattr(value, "__array__") else value
    found = None if isinstance(value, dict) else _floats(plain)
    if found is None:
        raise Wrong(f"{what} should be {wanted}, not {_kind(value)}.")
    return found


def _floats(value: Any) -> Array | None:
    """The value as floats, or None where that cannot be."""
    try:
        found = np.asarray(value)
        if found.dtype.kind in "fiu":
            return found.astype(float)
        return np.array([float(v) for v in found.ravel()]).reshape(found.shape) if found.dtype == object else None
    except (TypeError, ValueError):
        return None


def _finite(found: Array, what: str, *, silent: bool = False) -> None:
    if np.isinf(found).any() or (np.isnan(found).any() and not silent):
        strange = "nan, no number" if np.isnan(found).any() else "infinite"
        raise Wrong(f"{what} should be finite; yours is {strange}.")


def _kind(value: Any) -> str:
    """What a value is, in words."""
    if isinstance(value, (dict, type(None))):
        return "a dict" if value is not None else "None"
    if callable(value):
        return "a function"
    try:
        known = KINDS.get(np.asarray(value).dtype.kind)
    except ValueError:
        return "rows of different lengths"
    return known or f"a value of the kind {type(value).__name__}"


def _shape(shape: tuple[int, ...]) -> str:
    return "(" + ", ".join("n" if n < 0 else str(n) for n in shape) + ("," if len(shape) == 1 else "") + ")"


def _fraction(found: Array) -> float:
    return next(float(v) for v in found if not math.isclose(v, round(float(v)), rel_tol=0.0, abs_tol=0.0))
