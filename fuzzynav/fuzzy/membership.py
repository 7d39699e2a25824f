"""Membership functions: every shape as a readable NumPy function, and `Term`, a named one.

`SHAPES` lists the shapes with the names of their parameters, in order. The compiled twin of each function is in
`kernels`; tests hold the two together.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array

__all__ = ["POLYGONAL", "SHAPES", "Term", "breakpoints", "check_name", "membership"]

SHAPES: dict[str, tuple[str, ...]] = {
    "triangle": ("a", "b", "c"),
    "trapezoid": ("a", "b", "c", "d"),
    "gaussian": ("mean", "sigma"),
    "two-sided gaussian": ("mean_a", "sigma_a", "mean_b", "sigma_b"),
    "bell": ("center", "width", "slope"),
    "sigmoid": ("inflection", "slope"),
    "sigmoid difference": ("left", "rising", "falling", "right"),
    "sigmoid product": ("left", "rising", "falling", "right"),
    "z": ("start", "end"),
    "s": ("start", "end"),
    "pi": ("bottom_left", "top_left", "top_right", "bottom_right"),
    "ramp": ("start", "end"),
    "rectangle": ("start", "end"),
    "singleton": ("position",),
    "binary": ("start", "direction"),
    "constant": ("value",),
    "linear": ("coefficients",),
    "discrete": ("pairs",),
    "spike": ("center", "width"),
    "cosine": ("center", "width"),
    "concave": ("inflection", "end"),
    "arc": ("start", "end"),
    "semi-ellipse": ("start", "end"),
}
"""Shape -> names of its parameters. `discrete` takes x1, y1, x2, y2, ...; `linear` one coefficient for each input and
then the constant; the direction of `binary` is inf (1 from start upwards) or -inf."""

POLYGONAL = frozenset({"triangle", "trapezoid", "ramp", "rectangle", "discrete", "binary"})
"""Shapes made of straight lines, for which the quadrature 'exact' is exact."""

_KEYWORDS = frozenset({"if", "is", "then", "and", "or", "with"})
_ORDERED = {"triangle", "trapezoid", "z", "s", "pi", "rectangle"}
_POSITIVE = {"gaussian": (1,), "two-sided gaussian": (1, 3), "spike": (1,), "cosine": (1,)}
_MAY_BE_INFINITE = {"triangle", "trapezoid", "binary", "rectangle"}


def _rise(x: Array, a: float, b: float) -> Array:
    """0 up to a, straight up to 1 at b; a step up at b when a == b, and 1 everywhere when a is -inf."""
    if a == b:
        return (x >= b).astype(float)
    if math.isinf(a):
        return np.ones_like(x)
    return np.clip((x - a) / (b - a), 0.0, 1.0)


def _triangle(x: Array, a: float, b: float, c: float) -> Array:
    """Triangle with feet a, c and peak b; a == b and b == c are shoulders.

    Source: thesis eq 2.32 (errata T49)
    """
    return np.minimum(_rise(x, a, b), _rise(-x, -c, -b))


def _trapezoid(x: Array, a: float, b: float, c: float, d: float) -> Array:
    """Trapezoid with feet a, d and top from b to c; a == b and c == d are shoulders.

    Source: thesis eq 2.33 (errata T49)
    """
    return np.minimum(_rise(x, a, b), _rise(-x, -d, -c))


def _gaussian(x: Array, mean: float, sigma: float) -> Array:
    """Bell curve of height 1 at the mean.

    Source: thesis eq 2.34
    """
    return np.exp(-((x - mean) ** 2) / (2.0 * sigma**2))


def _two_sided_gaussian(x: Array, mean_a: float, sigma_a: float, mean_b: float, sigma_b: float) -> Array:
    left = np.where(x < mean_a, _gaussian(x, mean_a, sigma_a), 1.0)
    return left * np.where(x > mean_b, _gaussian(x, mean_b, sigma_b), 1.0)


def _bell(x: Array, center: float, width: float, slope: float) -> Array:
    with np.errstate(over="ignore", divide="ignore"):
        return 1.0 / (1.0 + np.abs((x - center) / width) ** (2.0 * slope))


def _sigmoid(x: Array, inflection: float, slope: float) -> Array:
    with np.errstate(over="ignore"):
        return 1.0 / (1.0 + np.exp(-slope * (x - inflection)))


def _sigmoid_difference(x: Array, left: float, rising: float, falling: float, right: float) -> Array:
    return np.abs(_sigmoid(x, left, rising) - _sigmoid(x, right, falling))


def _sigmoid_product(x: Array, left: float, rising: float, falling: float, right: float) -> Array:
    return _sigmoid(x, left, rising) * _sigmoid(x, right, falling)


def _s(x: Array, start: float, end: float) -> Array:
    t = _rise(x, start, end)
    return np.where(t < 0.5, 2.0 * t**2, 1.0 - 2.0 * (1.0 - t) ** 2)


def _z(x: Array, start: float, end: float) -> Array:
    return _s(-x, -end, -start)


def _pi(x: Array, bottom_left: float, top_left: float, top_right: float, bottom_right: float) -> Array:
    return _s(x, bottom_left, top_left) * _z(x, top_right, bottom_right)


def _ramp(x: Array, start: float, end: float) -> Array:
    return _rise(x, start, end) if start <= end else _rise(-x, -start, -end)


def _rectangle(x: Array, start: float, end: float) -> Array:
    return ((x >= start) & (x <= end)).astype(float)


def _singleton(x: Array, position: float) -> Array:
    """1 at one point, 0 elsewhere.

    Source: thesis eq 2.35 (errata T47)
    """
    return (x == position).astype(float)


def _binary(x: Array, start: float, direction: float) -> Array:
    return (x >= start if direction > 0 else x <= start).astype(float)


def _constant(x: Array, value: float) -> Array:
    return np.full_like(x, value)


def _linear(x: Array, *coefficients: float) -> Array:
    raise ValueError("a linear term is a function of all inputs and has no membership of its own")


def _discrete(x: Array, *pairs: float) -> Array:
    return np.interp(x, pairs[0::2], pairs[1::2])


def _spike(x: Array, center: float, width: float) -> Array:
    return np.exp(-np.abs(10.0 / width * (x - center)))


def _cosine(x: Array, center: float, width: float) -> Array:
    inside = np.abs(x - center) <= width / 2.0
    return np.where(inside, 0.5 * (1.0 + np.cos(2.0 * np.pi / width * np.where(inside, x - center, 0.0))), 0.0)


def _concave(x: Array, inflection: float, end: float) -> Array:
    if inflection <= end:
        return np.where(x < end, (end - inflection) / (2.0 * end - inflection - np.minimum(x, end)), 1.0)
    return np.where(x > end, (inflection - end) / (inflection - 2.0 * end + np.maximum(x, end)), 1.0)


def _arc(x: Array, start: float, end: float) -> Array:
    """Quarter of a circle from 0 at start to 1 at end, and 1 beyond end."""
    t = _ramp(x, start, end)
    return np.sqrt(np.maximum(1.0 - (1.0 - t) ** 2, 0.0))


def _semi_ellipse(x: Array, start: float, end: float) -> Array:
    t = (x - 0.5 * (start + end)) / (0.5 * (end - start))
    return np.sqrt(np.maximum(1.0 - t**2, 0.0))


_FUNCTIONS: dict[str, Callable[..., Array]] = {
    "triangle": _triangle, "trapezoid": _trapezoid, "gaussian": _gaussian, "two-sided gaussian": _two_sided_gaussian,
    "bell": _bell, "sigmoid": _sigmoid, "sigmoid difference": _sigmoid_difference,
    "sigmoid product": _sigmoid_product, "z": _z, "s": _s, "pi": _pi, "ramp": _ramp, "rectangle": _rectangle,
    "singleton": _singleton, "binary": _binary, "constant": _constant, "linear": _linear, "discrete": _discrete,
    "spike": _spike, "cosine": _cosine, "concave": _concave, "arc": _arc, "semi-ellipse": _semi_ellipse,
}  # fmt: skip


def membership(shape: str, x: ArrayLike, *parameters: float) -> Array:
    """Membership in [0, 1] of the values x (any shape) in a set of the named shape; nan where x is nan.

    Raises ValueError for an unknown shape.

    Source: thesis eq 2.27 (errata T45)

    >>> membership("triangle", [0.0, 1.0, 3.0], 0.0, 2.0, 4.0).tolist()
    [0.0, 0.5, 0.5]
    """
    if shape not in _FUNCTIONS:
        raise ValueError(f"unknown shape {shape!r}; known: {', '.join(SHAPES)}")
    values = np.asarray(x, dtype=float)
    result = _FUNCTIONS[shape](values, *parameters)
    return np.where(np.isnan(values), np.nan, result)


def check_name(name: str, what: str) -> None:
    """Raise ValueError unless `name` is one word that a rule text can hold."""
    if not name or any(c.isspace() or c in "(),;#:" for c in name) or name.lower() in _KEYWORDS:
        raise ValueError(f"{what} name {name!r} must be one word, without brackets or , ; : # and not a rule keyword")


def _check_parameters(shape: str, p: tuple[float, ...]) -> str:
    """What is wrong with the parameters of a shape; empty when nothing is."""
    names = SHAPES[shape]
    if shape == "linear":
        return "" if p else "needs at least the constant"
    if shape == "discrete":
        if len(p) < 2 or len(p) % 2:
            return f"needs pairs x1, y1, x2, y2, ..., got {len(p)} numbers"
        return "" if list(p[0::2]) == sorted(p[0::2]) else f"needs its x in ascending order, got {p[0::2]}"
    if len(p) != len(names):
        return f"needs {len(names)} parameters ({', '.join(names)}), got {len(p)}"
    if shape in _ORDERED and list(p) != sorted(p):
        return f"needs {' <= '.join(names)}, got {', '.join(f'{v:g}' for v in p)}"
    for k in _POSITIVE.get(shape, ()):
        if not p[k] > 0.0:
            return f"needs {names[k]} > 0, got {p[k]:g}"
    if (shape == "bell" and p[1] == 0.0) or (shape in ("semi-ellipse", "concave") and p[0] == p[1]):
        return f"needs a width other than 0, got {', '.join(f'{v:g}' for v in p)}"
    return ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Term:
    """A named fuzzy set on the line: a shape of `SHAPES`, its parameters in that order, and its height.

    Raises ValueError for an unknown shape, a wrong number of parameters or breakpoints out of order.

    Source: thesis eq 2.26

    >>> float(Term(name="Near", shape="trapezoid", parameters=(0, 0, 1, 2)).membership(1.25))
    0.75
    """

    name: str
    shape: str
    parameters: tuple[float, ...]
    height: float = 1.0

    def __post_init__(self) -> None:
        check_name(self.name, "term")
        if self.shape not in SHAPES:
            raise ValueError(f"term {self.name!r}: unknown shape {self.shape!r}; known: {', '.join(SHAPES)}")
        try:
            p = tuple(float(v) + 0.0 for v in self.parameters)
        except (TypeError, ValueError):
            raise ValueError(f"term {self.name!r}: parameters must be numbers, got {self.parameters!r}") from None
        wrong = _check_parameters(self.shape, p)
        finite = all(math.isfinite(v) for v in p)
        if not wrong and (any(math.isnan(v) for v in p) or (self.shape not in _MAY_BE_INFINITE and not finite)):
            wrong = f"needs finite parameters, got {p}"
        if wrong:
            raise ValueError(f"term {self.name!r}: {self.shape} {wrong}")
        if not (math.isfinite(self.height) and self.height > 0.0):
            raise ValueError(f"term {self.name!r}: height must be positive, got {self.height}")
        object.__setattr__(self, "parameters", p)
        object.__setattr__(self, "height", float(self.height))

    def membership(self, x: ArrayLike) -> Array:
        """Membership of the values x (any shape); nan where x is nan. Raises ValueError for a linear term."""
        values = membership(self.shape, x, *self.parameters)
        return values if self.height == 1.0 or self.shape == "constant" else self.height * values


def breakpoints(term: Term) -> tuple[float, ...]:
    """The finite x at which a polygonal term bends or jumps, ascending. Raises ValueError for a curved shape."""
    if term.shape not in POLYGONAL:
        raise ValueError(f"term {term.name!r} is {term.shape}, which is not made of straight lines")
    p = term.parameters[0::2] if term.shape == "discrete" else term.parameters
    return tuple(sorted({v for v in p if math.isfinite(v)}))
