"""Writing MATLAB's fuzzy inference system files (.fis); `fis` reads them and says what the `%!` lines mean."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

from fuzzynav.fuzzy.files.fis import CONORM_WORDS, DEFUZZIFIER_WORDS, NORM_WORDS, SHAPE_WORDS, places, swapped
from fuzzynav.fuzzy.files.text import identifier, is_plain, quote, resolution, same_number, show
from fuzzynav.fuzzy.membership import SHAPES, Term
from fuzzynav.fuzzy.rules import And, Or, Proposition, Rule
from fuzzynav.fuzzy.system import FuzzySystem
from fuzzynav.fuzzy.variable import WEIGHTED, RuleBlock, Variable

__all__ = ["dump"]


def dump(system: FuzzySystem) -> str:
    """Text of the system as a .fis file; `fis.parse` gives back a system with the same answers.

    Rule blocks with the same operators become one. The propositions of a rule come back in the order of the variables,
    without those that say `any`. MATLAB computes with its own quadrature and default whatever ours are. Raises
    ValueError for what the format cannot say: rule blocks that differ in their operators, hedges, mixed 'and' and
    'or', operators and shapes that MATLAB does not know.
    """
    block = _merged(system)
    lines = list(_system(system, block))
    for kind, variables in (("Input", system.inputs), ("Output", system.outputs)):
        for index, variable in enumerate(variables, start=1):
            lines += ["", f"[{kind}{index}]", *_variable(variable, kind == "Output")]
    lines += ["", "[Rules]", *(_rule(rule, system) for rule in block.rules)]
    return "\n".join(lines) + "\n"


def _merged(system: FuzzySystem) -> RuleBlock:
    """The rules of all blocks, block after block, as one. Raises ValueError unless the operators agree."""
    first = system.blocks[0]
    for what in ("conjunction", "disjunction", "implication"):
        found = sorted({getattr(block, what) for block in system.blocks})
        if len(found) > 1:
            raise ValueError(
                f"a .fis file holds one rule block; those of {system.name!r} differ in their {what}: {', '.join(found)}"
            )
    return replace(first, rules=system.rules, name=" and ".join(b.name for b in system.blocks if b.name))


def _one(values: set[str], what: str, table: dict[str, str]) -> str:
    if len(values) != 1:
        raise ValueError(f"a .fis file has one {what} for all outputs, got {', '.join(sorted(values))}")
    (value,) = values
    if value not in table:
        raise ValueError(f"{what} {value!r} has no name in a .fis file; known: {', '.join(table)}")
    return table[value]


def _system(system: FuzzySystem, block: RuleBlock) -> Iterable[str]:
    if not is_plain(system.name) or "'" in system.name:
        raise ValueError(f"the name {system.name!r} cannot stand in a .fis file: it must be one line without quotes")
    weighted = {v.defuzzifier in WEIGHTED for v in system.outputs}
    if len(weighted) != 1:
        raise ValueError("a .fis file is Mamdani or Sugeno throughout; the outputs have defuzzifiers of both kinds")
    yield "[System]"
    yield f"Name='{system.name}'"
    yield f"Type='{'sugeno' if weighted == {True} else 'mamdani'}'"
    yield "Version=2.0"
    yield f"NumInputs={len(system.inputs)}"
    yield f"NumOutputs={len(system.outputs)}"
    yield f"NumRules={len(block.rules)}"
    yield f"AndMethod='{_one({block.conjunction}, 'conjunction', NORM_WORDS)}'"
    yield f"OrMethod='{_one({block.disjunction}, 'disjunction', CONORM_WORDS)}'"
    yield f"ImpMethod='{_one({block.implication}, 'implication', NORM_WORDS)}'"
    yield f"AggMethod='{_one({str(v.aggregation) for v in system.outputs}, 'aggregation', CONORM_WORDS)}'"
    methods = {swapped(v.defuzzifier, v.low, v.high) for v in system.outputs}
    yield f"DefuzzMethod='{_one(methods, 'defuzzifier', DEFUZZIFIER_WORDS)}'"
    for key, value in (("source", system.source), ("description", system.description), ("block", block.name)):
        if value:
            yield f"%! {key}: {quote(value)}"


def _name(name: str, what: str) -> str:
    if identifier(name) != name:
        raise ValueError(f"the {what} name {name!r} cannot stand in a .fis file; use letters, digits and _")
    return name


def _variable(variable: Variable, output: bool) -> Iterable[str]:
    if not (math.isfinite(variable.low) and math.isfinite(variable.high)):
        raise ValueError(f"variable {variable.name!r}: a .fis file needs a finite range")
    yield f"Name='{_name(variable.name, 'variable')}'"
    yield f"Range=[{show(variable.low)} {show(variable.high)}]"
    if variable.unit:
        yield f"%! unit: {quote(variable.unit)}"
    if variable.lock_range:
        yield "%! lock-range: true"
    if output:
        yield from _output(variable)
    yield f"NumMFs={len(variable.terms)}"
    for index, term in enumerate(variable.terms, start=1):
        yield f"MF{index}={_term(term)}"


def _output(variable: Variable) -> Iterable[str]:
    if variable.quadrature != "sum":
        yield f"%! quadrature: {variable.quadrature}"
    if variable.resolution != 101:
        yield f"%! resolution: {resolution(str(variable.resolution))}"
    if not same_number(variable.default, 0.5 * (variable.low + variable.high)):
        yield f"%! default: {show(variable.default)}"
    if variable.lock_previous:
        yield "%! lock-previous: true"


def _term(term: Term) -> str:
    if term.shape not in SHAPE_WORDS:
        raise ValueError(f"term {term.name!r}: MATLAB has no shape {term.shape!r}; known: {', '.join(SHAPE_WORDS)}")
    if term.height != 1.0:
        raise ValueError(f"term {term.name!r}: a .fis file has no height, got {term.height:g}")
    if not all(math.isfinite(v) for v in term.parameters):
        raise ValueError(f"term {term.name!r}: a .fis file needs finite numbers, got {term.parameters}")
    shape = SHAPES[term.shape]
    values = list(term.parameters)
    for ours, theirs in enumerate(() if shape.listed else places(shape)):
        values[theirs] = term.parameters[ours]
    return f"'{_name(term.name, 'term')}':'{shape.fis}',[{' '.join(show(v) for v in values)}]"


def _rule(rule: Rule, system: FuzzySystem) -> str:
    parts, connection = _flat(rule)
    left = _codes(parts, system.inputs, rule)
    right = _codes(rule.consequents, system.outputs, rule)
    if any(code.startswith("-") for code in right):
        raise ValueError(f"rule '{rule}': 'not' in a conclusion means another thing in a .fis file")
    return f"{' '.join(left)}, {' '.join(right)} ({show(rule.weight)}) : {connection}"


def _flat(rule: Rule) -> tuple[tuple[Proposition, ...], int]:
    """The propositions of the antecedent and the code of what joins them."""
    if isinstance(rule.antecedent, Proposition):
        return (rule.antecedent,), 1
    parts = tuple(part for part in rule.antecedent.parts if isinstance(part, Proposition))
    if len(parts) < len(rule.antecedent.parts):
        raise ValueError(f"rule '{rule}': a .fis rule joins its propositions with 'and' alone or with 'or' alone")
    return parts, 1 if isinstance(rule.antecedent, And) else 2


def _codes(parts: Iterable[Proposition], variables: tuple[Variable, ...], rule: Rule) -> list[str]:
    codes = {variable.name: "0" for variable in variables}
    for part in parts:
        if codes[part.variable] != "0":
            raise ValueError(f"rule '{rule}': a .fis rule can name {part.variable!r} only once")
        if part.hedges == ("any",) and not isinstance(rule.antecedent, Or):
            continue
        if part.hedges not in ((), ("not",)):
            raise ValueError(f"rule '{rule}': a .fis file has no hedge but 'not'")
        variable = next(v for v in variables if v.name == part.variable)
        index = [term.name for term in variable.terms].index(part.term) + 1
        codes[part.variable] = f"{'-' if part.hedges else ''}{index}"
    return list(codes.values())
