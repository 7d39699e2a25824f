"""Fuzzy sets, rules and systems: Mamdani and Takagi-Sugeno, singleton and non-singleton."""

from fuzzynav.fuzzy.membership import SHAPES, Term
from fuzzynav.fuzzy.rules import And, Or, Proposition, Rule
from fuzzynav.fuzzy.system import FuzzySystem
from fuzzynav.fuzzy.variable import RuleBlock, Variable

__all__ = ["And", "FuzzySystem", "Or", "Proposition", "Rule", "RuleBlock", "SHAPES", "Term", "Variable"]
