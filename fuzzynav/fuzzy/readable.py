"""Fuzzy inference spelt out in NumPy, one step a function: to be read, and to test the compiled evaluation against."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce

import numpy as np

from fuzzynav.fuzzy import defuzzify
from fuzzynav.fuzzy.operators import conjunction, disjunction, hedge
from fuzzynav.fuzzy.rules import And, Antecedent, Proposition
from fuzzynav.fuzzy.variable import RuleBlock, Variable
from fuzzynav.geometry import Array

__all__ = ["aggregate", "degree", "fire", "fuzzify", "output_set"]

Degrees = Mapping[tuple[str, str], Array]


def fuzzify(inputs: tuple[Variable, ...], *values: float | Array) -> Degrees:
    """Membership of each input value in each term of its variable, by (variable, term)."""
    return {
        (variable.name, term.name): variable.fuzzify(value)[..., k]
        for variable, value in zip(inputs, values, strict=True)
        for k, term in enumerate(variable.terms)
    }


def degree(antecedent: Antecedent, degrees: Degrees, block: RuleBlock) -> Array:
    """Truth of an antecedent: hedges from the term outwards, then AND and OR of the block."""
    if isinstance(antecedent, Proposition):
        truth = degrees.get((antecedent.variable, antecedent.term), np.ones(()))
        return reduce(lambda m, word: hedge(word, m), reversed(antecedent.hedges), truth)
    parts = [degree(part, degrees, block) for part in antecedent.parts]
    if isinstance(antecedent, And):
        return reduce(lambda a, b: conjunction(a, b, block.conjunction), parts)
    return reduce(lambda a, b: disjunction(a, b, block.disjunction), parts)


def fire(blocks: tuple[RuleBlock, ...], degrees: Degrees) -> Array:
    """Strength of every rule, weight included: (..., n_rules)."""
    rows = [rule.weight * degree(rule.antecedent, degrees, block) for block in blocks for rule in block.rules]
    return np.stack(np.broadcast_arrays(*rows), axis=-1)


def aggregate(output: Variable, blocks: tuple[RuleBlock, ...], firing: Array) -> Array:
    """Aggregated set (..., n_samples) of an output: each conclusion clipped by its own rule, then all joined.

    Source: thesis eq 2.44 (errata T48)
    """
    x = output.samples()
    total = np.zeros((*firing.shape[:-1], x.size))
    rules = [(block, rule) for block in blocks for rule in block.rules]
    for r, (block, rule) in enumerate(rules):
        for conclusion in rule.consequents:
            if conclusion.variable == output.name:
                strength = reduce(lambda m, word: hedge(word, m), reversed(conclusion.hedges), firing[..., r])
                strength = np.where(firing[..., r] > 0.0, strength, firing[..., r])
                term = output.term(conclusion.term).membership(x)
                clipped = conjunction(strength[..., None], term, block.implication)
                total = disjunction(total, clipped, str(output.aggregation))
    return total


def output_set(output: Variable, blocks: tuple[RuleBlock, ...], firing: Array) -> tuple[Array, Array]:
    """Aggregated set of an output and its crisp value (nan or the default where no rule fires)."""
    x, mu = output.samples(), aggregate(output, blocks, firing)
    if output.defuzzifier == "centroid":
        value = defuzzify.centroid(x, mu, output.quadrature)
    else:
        value = {
            "bisector": defuzzify.bisector,
            "mean of maximum": defuzzify.mean_of_maximum,
            "smallest of maximum": defuzzify.smallest_of_maximum,
            "largest of maximum": defuzzify.largest_of_maximum,
        }[output.defuzzifier](x, mu)
    return mu, np.where(mu.max(-1) > 0.0, value, output.default)
