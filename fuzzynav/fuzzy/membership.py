"""Membership functions: every shape as a readable NumPy function and as a row of `SHAPES`, and `Term`, a named set.

A new shape needs a number in `codes`, a function and a row here, and a branch in `kernels`, its compiled twin. Tests
hold function, twin and file formats together.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.fuzzy import codes
from fuzzynav.fuzzy.names import check_name
from fuzzynav.geometry import Array

__all__ = ["MONOTONE", "POLYGONAL", "SHAPES", "Shape", "Term", "breakpoints", "membership"]

LARGEST, SMALLEST = 1e150, 1e-150
"""Bounds of parameters and of widths: their squares are still numbers."""


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
    return 1.0 / (1.0 + np.abs((x - center) / width) ** (2.0 * slope))


def _sigmoid(x: Array, inflection: float, slope: float) -> Array:
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
    result: Array = (x == position).astype(float)
    return result


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """A shape of sets: one row of the table from which names, codes and words of the file formats derive.

    Called with a name and its parameters it makes a term.

    >>> float(triangle("Near", 0, 0, 2).membership(0.5))
    0.75
    """

    name: str
    code: int
    parameters: tuple[str, ...]
    function: Callable[..., Array] = field(repr=False)
    about: str
    fll: str = ""  # FuzzyLite's word, empty where it has none
    fis: str = ""  # MATLAB's
    places: tuple[int, ...] = ()  # of our parameters in MATLAB's list, where the order differs
    listed: bool = False  # takes any number of parameters
    ordered: bool = False  # parameters ascend
    positive: tuple[int, ...] = ()  # parameters that must be above 0
    nonzero: tuple[int, ...] = ()
    apart: bool = False  # the two parameters differ
    endless: bool = False  # parameters may be infinite
    polygonal: bool = False  # made of straight lines
    monotone: bool = False  # only rises or only falls

    def __call__(self, name: str, *parameters: float, height: float = 1.0) -> Term:
        """Term of this shape. Raises ValueError like `Term`."""
        return Term(name=name, shape=self.name, parameters=parameters, height=height)

    def fault(self, p: tuple[float, ...]) -> str:
        """What is wrong with the parameters; empty when nothing is."""
        if self.listed:
            return _list_fault(self.name, p)
        if len(p) != len(self.parameters):
            return f"needs {len(self.parameters)} parameters ({', '.join(self.parameters)}), got {len(p)}"
        if self.ordered and list(p) != sorted(p):
            return f"needs {' <= '.join(self.parameters)}, got {', '.join(f'{v:g}' for v in p)}"
        for k in self.positive:
            if not p[k] >= SMALLEST:
                return f"needs {self.parameters[k]} > 0, and at least {SMALLEST:g}, got {p[k]:g}"
        narrow = any(abs(p[k]) < SMALLEST for k in self.nonzero) or (self.apart and abs(p[1] - p[0]) < SMALLEST)
        return f"needs a width other than 0, got {', '.join(f'{v:g}' for v in p)}" if narrow else ""


def _list_fault(shape: str, p: tuple[float, ...]) -> str:
    if shape == "linear":
        return "" if p else "needs at least the constant"
    if len(p) < 2 or len(p) % 2:
        return f"needs pairs x1, y1, x2, y2, ..., got {len(p)} numbers"
    if list(p[0::2]) != sorted(p[0::2]):
        return f"needs its x in ascending order, got {p[0::2]}"
    outside = [y for y in p[1::2] if not 0.0 <= y <= 1.0]
    return f"needs memberships from 0 to 1, got {outside[0]:g}" if outside else ""


triangle = Shape(
    name="triangle", code=codes.TRIANGLE, parameters=("a", "b", "c"), function=_triangle, fll="Triangle", fis="trimf",
    ordered=True, endless=True, polygonal=True, about="feet a, c and peak b; a == b or b == c is a shoulder",
)  # fmt: skip
trapezoid = Shape(
    name="trapezoid", code=codes.TRAPEZOID, parameters=("a", "b", "c", "d"), function=_trapezoid, fll="Trapezoid",
    fis="trapmf", ordered=True, endless=True, polygonal=True, about="feet a, d and the top from b to c",
)  # fmt: skip
gaussian = Shape(
    name="gaussian", code=codes.GAUSSIAN, parameters=("mean", "sigma"), function=_gaussian, fll="Gaussian",
    fis="gaussmf", places=(1, 0), positive=(1,), about="1 at the mean",
)  # fmt: skip
two_sided_gaussian = Shape(
    name="two-sided gaussian", code=codes.TWO_SIDED_GAUSSIAN, parameters=("mean_a", "sigma_a", "mean_b", "sigma_b"),
    function=_two_sided_gaussian, fll="GaussianProduct", fis="gauss2mf", places=(1, 0, 3, 2), positive=(1, 3),
    about="Gaussian flanks left of mean_a and right of mean_b, 1 between them",
)  # fmt: skip
bell = Shape(
    name="bell", code=codes.BELL, parameters=("center", "width", "slope"), function=_bell, fll="Bell", fis="gbellmf",
    places=(2, 0, 1), nonzero=(1,), about="1 at the centre and 0.5 a width away from it",
)  # fmt: skip
sigmoid = Shape(
    name="sigmoid", code=codes.SIGMOID, parameters=("inflection", "slope"), function=_sigmoid, fll="Sigmoid",
    fis="sigmf", places=(1, 0), monotone=True, about="0.5 at the inflection; a negative slope makes it fall",
)  # fmt: skip
sigmoid_difference = Shape(
    name="sigmoid difference", code=codes.SIGMOID_DIFFERENCE, parameters=("left", "rising", "falling", "right"),
    function=_sigmoid_difference, fll="SigmoidDifference", fis="dsigmf", places=(1, 0, 2, 3),
    about="a sigmoid that rises at the left less one that rises at the right",
)  # fmt: skip
sigmoid_product = Shape(
    name="sigmoid product", code=codes.SIGMOID_PRODUCT, parameters=("left", "rising", "falling", "right"),
    function=_sigmoid_product, fll="SigmoidProduct", fis="psigmf", places=(1, 0, 2, 3),
    about="a sigmoid at the left times one at the right",
)  # fmt: skip
z_shape = Shape(
    name="z", code=codes.Z, parameters=("start", "end"), function=_z, fll="ZShape", fis="zmf", ordered=True,
    monotone=True, about="smooth fall from 1 at start to 0 at end",
)  # fmt: skip
s_shape = Shape(
    name="s", code=codes.S, parameters=("start", "end"), function=_s, fll="SShape", fis="smf", ordered=True,
    monotone=True, about="smooth rise from 0 at start to 1 at end",
)  # fmt: skip
pi_shape = Shape(
    name="pi", code=codes.PI, parameters=("bottom_left", "top_left", "top_right", "bottom_right"), function=_pi,
    fll="PiShape", fis="pimf", ordered=True, about="smooth rise and fall",
)  # fmt: skip
ramp = Shape(
    name="ramp", code=codes.RAMP, parameters=("start", "end"), function=_ramp, fll="Ramp", polygonal=True,
    monotone=True, about="straight line from 0 at start to 1 at end, in either direction, and 1 beyond",
)  # fmt: skip
rectangle = Shape(
    name="rectangle", code=codes.RECTANGLE, parameters=("start", "end"), function=_rectangle, fll="Rectangle",
    ordered=True, endless=True, polygonal=True, about="1 from start to end",
)  # fmt: skip
singleton = Shape(
    name="singleton", code=codes.SINGLETON, parameters=("position",), function=_singleton, about="1 at one point",
)  # fmt: skip
binary = Shape(
    name="binary", code=codes.BINARY, parameters=("start", "direction"), function=_binary, fll="Binary", endless=True,
    polygonal=True, about="1 from start upwards for the direction inf, downwards for -inf",
)  # fmt: skip
constant = Shape(
    name="constant", code=codes.CONSTANT, parameters=("value",), function=_constant, fll="Constant", fis="constant",
    about="the number that a Takagi-Sugeno rule concludes",
)  # fmt: skip
linear = Shape(
    name="linear", code=codes.LINEAR, parameters=("coefficients",), function=_linear, fll="Linear", fis="linear",
    listed=True, about="one coefficient for each input and then the constant, concluded by a Takagi-Sugeno rule",
)  # fmt: skip
discrete = Shape(
    name="discrete", code=codes.DISCRETE, parameters=("pairs",), function=_discrete, fll="Discrete", listed=True,
    polygonal=True, about="straight lines through x1, y1, x2, y2, ... and level beyond them",
)  # fmt: skip
spike = Shape(
    name="spike", code=codes.SPIKE, parameters=("center", "width"), function=_spike, fll="Spike", positive=(1,),
    about="exponential flanks on both sides of the centre",
)  # fmt: skip
cosine = Shape(
    name="cosine", code=codes.COSINE, parameters=("center", "width"), function=_cosine, fll="Cosine", positive=(1,),
    about="one wave of the cosine about the centre, 0 beyond half a width",
)  # fmt: skip
concave = Shape(
    name="concave", code=codes.CONCAVE, parameters=("inflection", "end"), function=_concave, fll="Concave",
    apart=True, monotone=True, about="0.5 at the inflection, 1 from end on",
)  # fmt: skip
arc = Shape(
    name="arc", code=codes.ARC, parameters=("start", "end"), function=_arc, fll="Arc", monotone=True,
    about="quarter of a circle from 0 at start to 1 at end, and 1 beyond",
)  # fmt: skip
semi_ellipse = Shape(
    name="semi-ellipse", code=codes.SEMI_ELLIPSE, parameters=("start", "end"), function=_semi_ellipse,
    fll="SemiEllipse", apart=True, about="half an ellipse from start to end",
)  # fmt: skip

SHAPES: dict[str, Shape] = {
    shape.name: shape
    for shape in (
        triangle, trapezoid, gaussian, two_sided_gaussian, bell, sigmoid, sigmoid_difference, sigmoid_product, z_shape,
        s_shape, pi_shape, ramp, rectangle, singleton, binary, constant, linear, discrete, spike, cosine, concave, arc,
        semi_ellipse,
    )
}  # fmt: skip
"""The table of shapes, by name."""

POLYGONAL = frozenset(shape.name for shape in SHAPES.values() if shape.polygonal)
"""Shapes made of straight lines, for which the quadrature 'exact' is exact."""

MONOTONE = frozenset(shape.name for shape in SHAPES.values() if shape.monotone)
"""Shapes that a weighted defuzzifier may invert (Tsukamoto): the x at which the membership equals the strength."""


def membership(shape: str, x: ArrayLike, *parameters: float) -> Array:
    """Membership in [0, 1] of the values x (any shape) in a set of the named shape; nan where x is nan.

    Raises ValueError for an unknown shape.

    Source: thesis eq 2.27 (errata T45)

    >>> membership("triangle", [0.0, 1.0, 3.0], 0.0, 2.0, 4.0).tolist()
    [0.0, 0.5, 0.5]
    """
    if shape not in SHAPES:
        raise ValueError(f"unknown shape {shape!r}; known: {', '.join(SHAPES)}")
    values = np.asarray(x, dtype=float)
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):  # far out a power or a quotient is inf: 0 or 1
        result = SHAPES[shape].function(values, *parameters)
    return np.where(np.isnan(values), np.nan, result)


@dataclass(frozen=True, slots=True, kw_only=True)
class Term:
    """A named fuzzy set on the line: a shape of `SHAPES`, its parameters in that order, and its height.

    Raises ValueError for an unknown shape, a wrong number of parameters, breakpoints out of order or a height above 1.

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
        here = f"term {self.name!r}"
        if self.shape not in SHAPES:
            raise ValueError(f"{here}: unknown shape {self.shape!r}; known: {', '.join(SHAPES)}")
        try:
            p, height = tuple(float(v) + 0.0 for v in self.parameters), float(self.height)
        except (TypeError, ValueError, OverflowError):
            given = f"{self.parameters!r}, height {self.height!r}"
            raise ValueError(f"{here}: parameters and height must be numbers, got {given}") from None
        if wrong := SHAPES[self.shape].fault(p) or _size_fault(self.shape, p):
            raise ValueError(f"{here}: {self.shape} {wrong}")
        if not 0.0 < height <= 1.0:
            raise ValueError(f"{here}: the height must be above 0 and at most 1, got {height:g}")
        object.__setattr__(self, "parameters", p)
        object.__setattr__(self, "height", height)

    def membership(self, x: ArrayLike) -> Array:
        """Membership of the values x (any shape); nan where x is nan. Raises ValueError for a linear term."""
        values = membership(self.shape, x, *self.parameters)
        return values if self.height == 1.0 or self.shape == "constant" else self.height * values


def _size_fault(shape: str, p: tuple[float, ...]) -> str:
    if any(math.isnan(v) for v in p) or (not SHAPES[shape].endless and any(math.isinf(v) for v in p)):
        return f"needs finite parameters, got {p}"
    large = [v for v in p if math.isfinite(v) and abs(v) > LARGEST]
    return f"needs numbers from -{LARGEST:g} to {LARGEST:g}, got {large[0]:g}" if large else ""


def breakpoints(term: Term) -> tuple[float, ...]:
    """The finite x at which a polygonal term bends or jumps, ascending. Raises ValueError for a curved shape."""
    if term.shape not in POLYGONAL:
        raise ValueError(f"term {term.name!r} is {term.shape}, which is not made of straight lines")
    p = term.parameters[0::2] if term.shape == "discrete" else term.parameters
    return tuple(sorted({v for v in p if math.isfinite(v)}))
