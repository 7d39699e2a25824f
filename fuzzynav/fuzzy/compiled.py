"""A fuzzy system as flat tables: what the compiled evaluation reads instead of objects."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzynav.fuzzy import codes
from fuzzynav.fuzzy.membership import SHAPES, Term, breakpoints
from fuzzynav.fuzzy.operators import CONORMS, HEDGES, NORMS
from fuzzynav.fuzzy.rules import And, Antecedent, Or, Proposition, propositions
from fuzzynav.fuzzy.variable import DEFUZZIFIERS, MAX_SAMPLES, QUADRATURES, WEIGHTED, RuleBlock, Variable
from fuzzynav.geometry import Array

__all__ = ["Codes", "Compiled", "Parts", "Slot", "Tables", "check_size", "compile_system", "sample_weights"]


Codes = NDArray[np.int64]
Tables = tuple[Any, ...]
"""A system as compiled code takes it, the fields of `Parts` in their order: `FuzzySystem.tables`, read-only."""


class Parts(NamedTuple):
    """The tables of a system by name; i counts inputs, o outputs, t terms (inputs' first), r rules, s concluded sets.

    Built inside compiled code, `Parts(*tables)`: there a name costs nothing, on the way from Python it costs
    microseconds. The columns have names in `codes`. An output that is sampled has rows in `sampled`, an exact one
    corners in `knots` and the lines between them.
    """

    n_input_terms: int
    terms: Codes  # (t, 4): SHAPE, OWNER, FIRST, PAIRS
    propositions: Codes  # (p, 1 + hedges): TERM (-1: any), FIRST_HEDGE ...
    program: Codes  # (k, 5): an operation and its operands
    consequents: Codes  # (c, 2 + hedges): RULE, SET, FIRST_CONCLUSION_HEDGE ..., sorted by set
    slots: Codes  # (s, 4): SLOT_OUTPUT, SLOT_TERM, IMPLICATION, MERGE
    outputs: Codes  # (o, 6): FIRST_SET, SETS, AGGREGATION, DEFUZZIFIER, QUADRATURE, SAMPLES
    ranges: Array  # (i, 3): LOW, HIGH, LOCKED
    numbers: Array  # (t, 5): up to four parameters, HEIGHT
    lists: Array  # (l,) numbers of discrete and linear terms
    weights: Array  # (r,)
    settings: Array  # (o, 6): low, high, default, centre, lock_range, lock_previous
    sampled: Array  # (o, 2 + sets, samples): PLACES from the centre, WEIGHTS, FIRST_ROW ...
    knots: Array  # (o, m)
    lines: Array  # (o, m - 1, sets, 2)


@dataclass(frozen=True, slots=True)
class Slot:
    """One set that rules conclude: output and term by number, the implication, and how its rules are merged."""

    output: int
    term: int
    implication: str
    merge: str


@dataclass(frozen=True, slots=True)
class Compiled:
    """The tables of a system, and what the evidence needs to name their columns."""

    tables: Tables
    slots: tuple[Slot, ...]
    n_terms: int
    n_rules: int


def sample_weights(quadrature: str, n: int) -> Array:
    """Weights (n,) of the samples in an integral, in units of their distance."""
    weights = np.ones(n)
    if quadrature == "trapezoid":
        weights[[0, -1]] = 0.5
    return weights


def compile_system(
    inputs: tuple[Variable, ...], outputs: tuple[Variable, ...], blocks: tuple[RuleBlock, ...]
) -> Compiled:
    """Flat tables of a validated system."""
    numbers, terms, lists = _terms(inputs, outputs)
    props, program, weights = _antecedents(inputs, blocks)
    slots, consequents = _consequents(outputs, blocks)
    n_terms = sum(len(v.terms) for v in inputs)
    settings, out_codes, sampled, knots, lines = _outputs(outputs, slots)
    offsets = np.cumsum([0, *(len(v.terms) for v in outputs)]) + n_terms
    slot_codes = [
        (s.output, int(offsets[s.output]) + s.term, NORMS[s.implication].code, CONORMS[s.merge].code) for s in slots
    ]
    parts = Parts(
        n_input_terms=n_terms, terms=terms, propositions=props, program=program, consequents=consequents,
        slots=_codes(slot_codes, 4), outputs=out_codes,
        ranges=np.array([(v.low, v.high, float(v.lock_range)) for v in inputs]), numbers=numbers, lists=lists,
        weights=weights, settings=settings, sampled=sampled, knots=knots, lines=lines,
    )  # fmt: skip
    for array in parts[1:]:
        array.setflags(write=False)
    return Compiled(tables=tuple(parts), slots=slots, n_terms=n_terms, n_rules=len(weights))


def check_size(outputs: tuple[Variable, ...], blocks: tuple[RuleBlock, ...]) -> None:
    """Raise ValueError if the sampled sets of the outputs would take more than MAX_SAMPLES numbers."""
    concluded = Counter(c.variable for block in blocks for rule in block.rules for c in rule.consequents)
    sampled = [v for v in outputs if v.defuzzifier not in WEIGHTED]
    for output in sampled:
        exact = output.quadrature == "exact"
        width = sum(len(t.parameters) for t in output.terms) if exact else output.resolution
        if len(sampled) * (2 + concluded[output.name]) * width > MAX_SAMPLES:
            raise ValueError(
                f"output {output.name!r}: {concluded[output.name]} conclusions of {width} samples, for {len(sampled)} "
                f"outputs, are more than {MAX_SAMPLES}; lower the resolution"
            )


def _codes(rows: Sequence[tuple[int, ...]], width: int) -> Codes:
    return np.array(rows, dtype=np.int64).reshape(-1, width)


def _terms(inputs: tuple[Variable, ...], outputs: tuple[Variable, ...]) -> tuple[Array, Codes, Array]:
    """Numbers (t, 5), codes (t, 4) and the lists of discrete and linear terms, inputs first."""
    numbers: list[list[float]] = []
    rows: list[tuple[int, ...]] = []
    lists: list[float] = []
    for owner, variable in enumerate((*inputs, *outputs)):
        for term in variable.terms:
            long = SHAPES[term.shape].listed
            numbers.append([*(() if long else term.parameters), 0.0, 0.0, 0.0, 0.0][:4] + [term.height])
            pairs = len(term.parameters) // 2 if term.shape == "discrete" else 0
            rows.append((SHAPES[term.shape].code, owner, len(lists), pairs))
            lists.extend(term.parameters if long else ())
    return np.array(numbers).reshape(-1, 5), _codes(rows, 4), np.array(lists or [0.0])


def _hedges(proposition: Proposition, width: int) -> tuple[int, ...]:
    """Codes of the hedges in the order in which they act (the last word first), padded with NO_HEDGE."""
    found = [HEDGES[word].code for word in reversed(proposition.hedges)]
    return tuple(found + [codes.NO_HEDGE] * (width - len(found)))


def _antecedents(inputs: tuple[Variable, ...], blocks: tuple[RuleBlock, ...]) -> tuple[Codes, Codes, Array]:
    """Distinct propositions (p, 1 + hedges), the postfix program (k, 5) over them, and the rule weights."""
    place: dict[tuple[str, str], int] = {}
    for variable in inputs:
        for term in variable.terms:
            place[variable.name, term.name] = len(place)
    rules = [(block, rule) for block in blocks for rule in block.rules]
    known: dict[Proposition, int] = {}
    for _, rule in rules:
        for proposition in propositions(rule.antecedent):
            known.setdefault(proposition, len(known))
    width = max(len(p.hedges) for p in known)
    rows = [(place[p.variable, p.term] if p.term else -1, *_hedges(p, width)) for p in known]
    program: list[tuple[int, ...]] = []
    for number, (block, rule) in enumerate(rules):
        program.extend(_program(number, rule.antecedent, block, known))
    weights = np.array([rule.weight for _, rule in rules])
    return _codes(rows, 1 + width), _codes(program, 5), weights


def _program(
    number: int, antecedent: Antecedent, block: RuleBlock, known: dict[Proposition, int]
) -> Iterator[tuple[int, ...]]:
    """Instructions (k, 5) of one rule; the common ones, up to three propositions joined by min, take a single one."""
    parts = antecedent.parts if isinstance(antecedent, And) else (antecedent,)
    simple = all(isinstance(part, Proposition) for part in parts)
    if simple and len(parts) <= 3 and block.conjunction == "min":
        places = [known[part] for part in parts if isinstance(part, Proposition)]
        yield (codes.AND_OF_THREE, places[0], places[len(places) // 2], places[-1], number)
        return
    yield from ((*step, 0, 0) for step in _postfix(antecedent, block, known))
    yield codes.STORE, number, 0, 0, 0


def _postfix(antecedent: Antecedent, block: RuleBlock, known: dict[Proposition, int]) -> Iterator[tuple[int, ...]]:
    """Instructions (operation, operand, norm): join the next proposition by AND or OR, or the two on top."""
    if isinstance(antecedent, Proposition):
        yield codes.LOAD, known[antecedent], 0
        return
    either = isinstance(antecedent, Or)
    code = CONORMS[block.disjunction].code if either else NORMS[block.conjunction].code
    yield from _postfix(antecedent.parts[0], block, known)
    for part in antecedent.parts[1:]:
        if isinstance(part, Proposition):
            yield (codes.OR_NEXT if either else codes.AND_NEXT), known[part], code
        else:
            yield from _postfix(part, block, known)
            yield (codes.OR_TOP if either else codes.AND_TOP), 0, code


def _merge(output: Variable, implication: str) -> str:
    """How rules with one consequent are joined before the set is formed; empty when each rule keeps its own set."""
    if output.defuzzifier in WEIGHTED:
        return "" if output.aggregation == "sum" else str(output.aggregation)
    if output.aggregation == "max":
        return "max"
    return "sum" if output.aggregation == "sum" and implication == "product" else ""


def _consequents(outputs: tuple[Variable, ...], blocks: tuple[RuleBlock, ...]) -> tuple[tuple[Slot, ...], Codes]:
    """The concluded sets, ordered by output, and (c, 2 + hedges): rule, slot and hedges of each conclusion."""
    number = {output.name: o for o, output in enumerate(outputs)}
    found: list[tuple[Slot, int, Proposition]] = []
    rules = [(block, rule) for block in blocks for rule in block.rules]
    for r, (block, rule) in enumerate(rules):
        for proposition in rule.consequents:
            o = number[proposition.variable]
            term = [t.name for t in outputs[o].terms].index(proposition.term)
            merge = _merge(outputs[o], block.implication)
            found.append((Slot(o, term, block.implication, merge), r, proposition))
    slots: list[Slot] = []
    rows: list[tuple[int, ...]] = []
    width = max(len(proposition.hedges) for _, _, proposition in found)
    for slot, r, proposition in sorted(found, key=lambda item: (item[0].output, item[1])):
        if not slot.merge:
            slots.append(Slot(slot.output, slot.term, slot.implication, "max"))
        elif slot not in slots:
            slots.append(slot)
        at = slots.index(slot) if slot.merge else len(slots) - 1
        rows.append((r, at, *_hedges(proposition, max(width, 1))))
    rows.sort(key=lambda row: row[1])
    return tuple(slots), _codes(rows, 2 + max(width, 1))


def _outputs(outputs: tuple[Variable, ...], slots: tuple[Slot, ...]) -> tuple[Array, Codes, Array, Array, Array]:
    """Settings (o, 6), codes (o, 6), sampled sets (o, 2 + n, samples), corners (o, m) and lines (o, m - 1, n, 2)."""
    settings, rows_of, sampled, corners, lines = [], [], [], [], []
    for o, output in enumerate(outputs):
        own = [k for k, slot in enumerate(slots) if slot.output == o]
        terms = [output.terms[slots[k].term] for k in own]
        weighted = output.defuzzifier in WEIGHTED
        exact = output.quadrature == "exact" and not weighted
        knots, pieces = _pieces(output, terms) if exact else (np.empty(0), np.empty((0, 0, 2)))
        rows = np.empty((0, 0)) if exact or weighted else _sampled(output, terms)
        centre = 0.0 if exact or weighted else 0.5 * (output.low + output.high)
        rows_of.append((
            own[0] if own else 0, len(own), CONORMS[str(output.aggregation)].code,
            DEFUZZIFIERS[output.defuzzifier].code, QUADRATURES[output.quadrature], max(rows.shape[1], len(knots)),
        ))  # fmt: skip
        settings.append([output.low, output.high, output.default, centre, output.lock_range, output.lock_previous])
        sampled.append(rows)
        corners.append(knots)
        lines.append(pieces)
    return np.array(settings, dtype=float), _codes(rows_of, 6), _stack(sampled), _stack(corners), _stack(lines)


def _stack(arrays: list[Array]) -> Array:
    """Arrays of one number of dimensions in one, filled up with zeros."""
    shape = tuple(max(sizes) for sizes in zip(*(a.shape for a in arrays), strict=True))
    result = np.zeros((len(arrays), *shape))
    for k, a in enumerate(arrays):
        inside: tuple[Any, ...] = (k, *(slice(size) for size in a.shape))
        result[inside] = a
    return result


def _sampled(output: Variable, terms: list[Term]) -> Array:
    """Rows of samples: place from the centre of the range, weight, and each term's membership."""
    x = output.samples()
    rows = [x - 0.5 * (output.low + output.high), sample_weights(output.quadrature, len(x))]
    return np.array(rows + [term.membership(x) for term in terms])


def _pieces(output: Variable, terms: list[Term]) -> tuple[Array, Array]:
    """Corners (m,) of the terms inside the range, and each term's line (m - 1, n, 2) over each piece."""
    inside = [x for term in terms for x in breakpoints(term) if output.low < x < output.high]
    knots = np.unique([output.low, *inside, output.high])
    width = np.diff(knots)
    first, second = knots[:-1] + 0.25 * width, knots[:-1] + 0.75 * width
    lines = np.empty((len(width), len(terms), 2))
    for k, term in enumerate(terms):
        a, b = term.membership(first), term.membership(second)
        lines[:, k, 0], lines[:, k, 1] = 1.5 * a - 0.5 * b, 1.5 * b - 0.5 * a
    return knots, lines
