"""Terms by the name of their shape: `triangle("Near", 0, 0, 2)`."""

from __future__ import annotations

from fuzzynav.fuzzy.membership import Term

__all__ = ["bell", "constant", "discrete", "gaussian", "linear", "pi_shape", "ramp", "rectangle", "s_shape", "sigmoid",
           "singleton", "trapezoid", "triangle", "two_sided_gaussian", "z_shape"]  # fmt: skip


def _term(name: str, shape: str, *parameters: float) -> Term:
    return Term(name=name, shape=shape, parameters=parameters)


def triangle(name: str, a: float, b: float, c: float) -> Term:
    """Triangle with feet a, c and peak b; a == b or b == c is a shoulder.

    >>> float(triangle("Near", 0, 0, 2).membership(0.5))
    0.75
    """
    return _term(name, "triangle", a, b, c)


def trapezoid(name: str, a: float, b: float, c: float, d: float) -> Term:
    """Trapezoid with feet a, d and its top from b to c."""
    return _term(name, "trapezoid", a, b, c, d)


def gaussian(name: str, mean: float, sigma: float) -> Term:
    """Gaussian of height 1 at the mean."""
    return _term(name, "gaussian", mean, sigma)


def two_sided_gaussian(name: str, mean_a: float, sigma_a: float, mean_b: float, sigma_b: float) -> Term:
    """Gaussian flanks left of mean_a and right of mean_b, 1 between them."""
    return _term(name, "two-sided gaussian", mean_a, sigma_a, mean_b, sigma_b)


def bell(name: str, center: float, width: float, slope: float) -> Term:
    """Generalised bell, 1 at the centre and 0.5 a width away from it."""
    return _term(name, "bell", center, width, slope)


def sigmoid(name: str, inflection: float, slope: float) -> Term:
    """Sigmoid, 0.5 at the inflection; a negative slope makes it fall."""
    return _term(name, "sigmoid", inflection, slope)


def z_shape(name: str, start: float, end: float) -> Term:
    """Smooth fall from 1 at start to 0 at end."""
    return _term(name, "z", start, end)


def s_shape(name: str, start: float, end: float) -> Term:
    """Smooth rise from 0 at start to 1 at end."""
    return _term(name, "s", start, end)


def pi_shape(name: str, bottom_left: float, top_left: float, top_right: float, bottom_right: float) -> Term:
    """Smooth rise and fall."""
    return _term(name, "pi", bottom_left, top_left, top_right, bottom_right)


def ramp(name: str, start: float, end: float) -> Term:
    """Straight line from 0 at start to 1 at end, in either direction, and 1 beyond."""
    return _term(name, "ramp", start, end)


def rectangle(name: str, start: float, end: float) -> Term:
    """1 from start to end."""
    return _term(name, "rectangle", start, end)


def singleton(name: str, position: float) -> Term:
    """1 at one point."""
    return _term(name, "singleton", position)


def constant(name: str, value: float) -> Term:
    """The number that a Takagi-Sugeno rule concludes."""
    return _term(name, "constant", value)


def linear(name: str, *coefficients: float) -> Term:
    """One coefficient for each input and then the constant, concluded by a Takagi-Sugeno rule."""
    return _term(name, "linear", *coefficients)


def discrete(name: str, *pairs: float) -> Term:
    """Straight lines through x1, y1, x2, y2, ... and level beyond them."""
    return _term(name, "discrete", *pairs)
