"""The few checks of what is handed in, each with one clear sentence."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array

__all__ = ["finite", "not_negative", "one_of", "points", "pose", "positive", "positive_fields", "share"]


def positive(**values: float) -> None:
    """Raise ValueError for the first value that is not a positive, finite number.

    >>> positive(dt=0.0)
    Traceback (most recent call last):
    ValueError: dt must be positive and finite, got 0.0
    """
    for name, value in values.items():
        if not (_is_number(value) and np.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be positive and finite, got {value}")


def not_negative(**values: float) -> None:
    """Raise ValueError for the first value that is negative or not a finite number."""
    for name, value in values.items():
        if not (_is_number(value) and np.isfinite(value) and value >= 0):
            raise ValueError(f"{name} must be finite and not negative, got {value}")


def share(**values: float) -> None:
    """Raise ValueError for the first value that does not lie in 0 to 1."""
    for name, value in values.items():
        if not (_is_number(value) and 0.0 <= value <= 1.0):
            raise ValueError(f"{name} is a share and must lie in 0 to 1, got {value}")


def positive_fields(record: Any, *, may_be_zero: tuple[str, ...] = (), leave: tuple[str, ...] = ()) -> None:
    """Check every field of a dataclass but those in `leave` and truth values: positive, or not negative."""
    for field in fields(record):
        value = getattr(record, field.name)
        if field.name in leave or isinstance(value, bool):
            continue
        (not_negative if field.name in may_be_zero else positive)(**{field.name: value})


def one_of(known: tuple[str, ...], **values: str) -> None:
    """Raise ValueError for the first value that is not among the known words."""
    for name, value in values.items():
        if value not in known:
            raise ValueError(f"{name} must be one of {', '.join(known)}, got {value!r}")


def finite(values: ArrayLike, name: str, *shape: int) -> Array:
    """The values as an array of floats of this shape, all finite; raises ValueError otherwise."""
    found = np.asarray(values, dtype=float)
    if found.shape != shape or not np.isfinite(found).all():
        raise ValueError(f"{name} must be {' x '.join(map(str, shape))} finite numbers, got {found.tolist()}")
    return found


def points(values: ArrayLike, name: str, width: int = 2) -> Array:
    """The values as finite rows `(n, width)`; an empty list is no row. Raises ValueError otherwise."""
    found = np.asarray(values, dtype=float)
    if found.size == 0:
        return np.empty((0, width))
    if found.ndim != 2 or found.shape[1] != width or not np.isfinite(found).all():
        raise ValueError(f"{name} must be rows of {width} finite numbers, got an array of shape {found.shape}")
    return found


def pose(values: ArrayLike, name: str = "the pose") -> Array:
    """A finite pose `(3,)`: x [m], y [m], theta [rad]; raises ValueError otherwise."""
    return finite(values, f"{name} (x, y, theta)", 3)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
