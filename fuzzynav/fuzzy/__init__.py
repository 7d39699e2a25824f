"""Fuzzy sets, rules and systems: Mamdani and Takagi-Sugeno, singleton and non-singleton.

| file | holds |
| --- | --- |
| `names`, `codes` | what may be a name; the numbers by which compiled kernels know shapes and operators |
| `membership` | the shapes of sets: their functions, their table `SHAPES`, and `Term`, a named set |
| `operators` | AND, OR and hedges; `sets`: the notions of fuzzy set theory on samples |
| `rules`, `variable` | rules and their text; linguistic variables and rule blocks |
| `defuzzify`, `readable` | from a set to a number; inference spelt out, to be read and tested against |
| `compiled` | a system as flat tables |
| `kernels`, `set_kernels`, `engine` | the compiled evaluation; `engine.infer_one` serves kernels of other rooms |
| `system`, `inference`, `gaps` | `FuzzySystem`, why it answered as it did, where its rules are silent |
| `files` | FuzzyLite's .fll, MATLAB's .fis, and the exchange with scikit-fuzzy |

The files stand above the system, so `FuzzySystem` gets its `load`, `save`, `to_skfuzzy` and `from_skfuzzy` here.
"""

from fuzzynav.fuzzy.files import disk, skfuzzy
from fuzzynav.fuzzy.membership import (
    SHAPES,
    Shape,
    Term,
    arc,
    bell,
    binary,
    concave,
    constant,
    cosine,
    discrete,
    gaussian,
    linear,
    pi_shape,
    ramp,
    rectangle,
    s_shape,
    semi_ellipse,
    sigmoid,
    sigmoid_difference,
    sigmoid_product,
    singleton,
    spike,
    trapezoid,
    triangle,
    two_sided_gaussian,
    z_shape,
)
from fuzzynav.fuzzy.rules import And, Or, Proposition, Rule
from fuzzynav.fuzzy.system import FuzzySystem
from fuzzynav.fuzzy.variable import RuleBlock, Variable

FuzzySystem.load = staticmethod(disk.load)
FuzzySystem.save = disk.save
FuzzySystem.to_skfuzzy = skfuzzy.to_skfuzzy
FuzzySystem.from_skfuzzy = staticmethod(skfuzzy.from_skfuzzy)

__all__ = [
    "SHAPES", "And", "FuzzySystem", "Or", "Proposition", "Rule", "RuleBlock", "Shape", "Term", "Variable", "arc",
    "bell", "binary", "concave", "constant", "cosine", "discrete", "gaussian", "linear", "pi_shape", "ramp",
    "rectangle", "s_shape", "semi_ellipse", "sigmoid", "sigmoid_difference", "sigmoid_product", "singleton", "spike",
    "trapezoid", "triangle", "two_sided_gaussian", "z_shape",
]  # fmt: skip
