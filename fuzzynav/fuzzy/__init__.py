"""Fuzzy sets, rules and systems: Mamdani and Takagi-Sugeno, singleton and non-singleton."""

from fuzzynav.fuzzy.membership import SHAPES, Term
from fuzzynav.fuzzy.rules import And, Or, Proposition, Rule
from fuzzynav.fuzzy.shapes import (
    bell,
    constant,
    discrete,
    gaussian,
    linear,
    pi_shape,
    ramp,
    rectangle,
    s_shape,
    sigmoid,
    singleton,
    trapezoid,
    triangle,
    two_sided_gaussian,
    z_shape,
)
from fuzzynav.fuzzy.system import FuzzySystem
from fuzzynav.fuzzy.variable import RuleBlock, Variable

__all__ = [
    "SHAPES", "And", "FuzzySystem", "Or", "Proposition", "Rule", "RuleBlock", "Term", "Variable", "bell", "constant",
    "discrete", "gaussian", "linear", "pi_shape", "ramp", "rectangle", "s_shape", "sigmoid", "singleton", "trapezoid",
    "triangle", "two_sided_gaussian", "z_shape",
]  # fmt: skip
