"""Reading the FuzzyLite Language (.fll); `fll_writer` writes it.

What our systems hold and the language has no word for stands in lines that other readers take for comments:
`#! unit: m/s`, `#! source: ...`, `#! quadrature: trapezoid` (without it: midpoint, FuzzyLite's own arithmetic),
`#! singleton: term` (written as a Rectangle of width 0, or a Constant), `#! resolution: 101` for a weighted output.

Read as FuzzyLite means it: a Centroid without a number has 1000 samples; `enabled: false` takes out a rule block, the
conclusions on an output (whose answer is then nan), or the propositions on an input (whose degree is then 0).
Refused by name and line: Function terms, activations other than General, rules that use an output as a condition, and
whatever else is unknown. Three differences from FuzzyLite are deliberate: a hedge in a conclusion acts on that
conclusion alone (there it is carried over to the next ones); a rule that does not fire concludes nothing (there 'then
y is not small' holds wholly just then); a nan input gives nan.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from fuzzynav.fuzzy.files.text import (
    at,
    boolean,
    fault,
    identifier,
    named,
    numbers,
    quadrature,
    resolution,
    shortened,
    unquote,
)
from fuzzynav.fuzzy.membership import MONOTONE, SHAPES, Term
from fuzzynav.fuzzy.operators import CONORMS, NORMS
from fuzzynav.fuzzy.rules import And, Antecedent, Or, Proposition, Rule, propositions
from fuzzynav.fuzzy.system import FuzzySystem, check_rule
from fuzzynav.fuzzy.variable import DEFUZZIFIERS, WEIGHTED, RuleBlock, Variable

__all__ = ["parse"]

SHAPE_WORDS = {name: shape.fll for name, shape in SHAPES.items() if shape.fll}
NORM_WORDS = {name: norm.fll for name, norm in NORMS.items()}
CONORM_WORDS = {name: conorm.fll for name, conorm in CONORMS.items()}
DEFUZZIFIER_WORDS = {name: way.fll for name, way in DEFUZZIFIERS.items()}

_SECTIONS = {
    "Engine": ("description",),
    "InputVariable": ("description", "enabled", "range", "lock-range", "term"),
    "OutputVariable": (
        "description", "enabled", "range", "lock-range", "aggregation", "defuzzifier", "default", "lock-previous",
        "term",
    ),
    "RuleBlock": ("description", "enabled", "conjunction", "disjunction", "implication", "activation", "rule"),
}  # fmt: skip
_DIRECTIVES = {
    "Engine": ("source", "description"),
    "InputVariable": ("unit", "singleton"),
    "OutputVariable": ("unit", "quadrature", "resolution", "singleton"),
    "RuleBlock": (),
}
_FUZZYLITE_RESOLUTION = "1000"


@dataclass
class _Section:
    """One component of the file: its key, name and line, and the lines under it."""

    kind: str
    name: str
    line: int
    single: dict[str, tuple[int, str]] = field(default_factory=dict)
    many: list[tuple[int, str]] = field(default_factory=list)
    singletons: set[str] = field(default_factory=set)

    def get(self, key: str, default: str) -> tuple[int, str]:
        return self.single.get(key, (self.line, default))


def parse(text: str, where: str = "<text>") -> FuzzySystem:
    """Fuzzy system written in the FuzzyLite Language.

    Raises ValueError that names `where` (the file), the line, the field and what would be right.
    """
    sections = _sections(text, where)
    head = sections[0]
    inputs = tuple(_variable(s, where) for s in sections if s.kind == "InputVariable")
    outputs = tuple(_variable(s, where) for s in sections if s.kind == "OutputVariable")
    _check_names(sections, where)
    off = _off(sections, where)
    read = [_block(s, where, off, (inputs, outputs)) for s in sections if s.kind == "RuleBlock"]
    blocks = tuple(block for block in read if block is not None)
    if not inputs or not outputs or not blocks:
        missing = "InputVariable" if not inputs else "OutputVariable" if not outputs else "RuleBlock with enabled rules"
        raise fault(where, text.count("\n") + 1, "", f"the file ends without any {missing}: is it cut off?")
    description = _read(head, "description", "", where, unquote)
    source = _read(head, "source", "", where, unquote)
    try:
        return FuzzySystem(
            name=head.name, inputs=inputs, outputs=outputs, blocks=blocks, source=source, description=description
        )
    except ValueError as error:
        raise _located(error, where, sections) from None


def _check_names(sections: list[_Section], where: str) -> None:
    """Raise ValueError with the line of a variable whose name another one has."""
    seen: set[str] = set()
    for section in sections:
        if section.kind in ("InputVariable", "OutputVariable"):
            if identifier(section.name) in seen:
                raise fault(where, section.line, section.kind, f"the name {section.name!r} is used twice")
            seen.add(identifier(section.name))


def _located(error: ValueError, where: str, sections: list[_Section]) -> ValueError:
    """The error of a whole system with the line of the variable that it names, or of the engine."""
    for section in sections:
        role = {"InputVariable": "input", "OutputVariable": "output"}.get(section.kind)
        if role and f"{role} {identifier(section.name)!r}" in str(error):
            return fault(where, section.line, section.kind, str(error))
        if section.kind == "RuleBlock" and f"rule block {section.name!r}" in str(error):
            return fault(where, section.line, section.kind, str(error))
    return fault(where, sections[0].line, "Engine", str(error))


def _sections(text: str, where: str) -> list[_Section]:
    """Split the text at its component lines and check that every line under them has a known key."""
    sections: list[_Section] = []
    for line, raw in enumerate(text.split("\n"), start=1):
        directive = re.fullmatch(r"\s*#!\s*([A-Za-z-]+):(.*)", raw)
        bare = raw.partition("#")[0].strip()
        if directive is None and not bare:
            continue
        key, colon, value = (directive[1], ":", directive[2]) if directive else bare.partition(":")
        key, value = key.strip(), value.strip()
        if not colon:
            raise fault(where, line, "", f"expected 'key: value', got {shortened(bare)!r}")
        if directive is None and key in _SECTIONS:
            if (key == "Engine") == bool(sections):
                raise fault(where, line, key, "a file must begin with Engine:, and hold it once")
            sections.append(_Section(key, value, line))
        else:
            if not sections:
                raise fault(where, line, key, "expected Engine: before anything else")
            _store(sections[-1], line, key, value, where, directive is not None)
    if not sections:
        raise fault(where, 1, "", "the file holds nothing; expected Engine: on the first line")
    return sections


def _store(section: _Section, line: int, key: str, value: str, where: str, directive: bool) -> None:
    known = (_DIRECTIVES if directive else _SECTIONS)[section.kind]
    if key not in known:
        mark = "#! " if directive else ""
        raise fault(where, line, f"{mark}{key}", f"unknown under {section.kind}; known: {', '.join(known) or 'none'}")
    if key == "singleton":
        section.singletons.add(value)
    elif key in ("term", "rule"):
        section.many.append((line, value))
    elif key in section.single and not (key == "description" and directive):
        raise fault(where, line, key, f"stands twice under {section.kind} {section.name!r}")
    else:
        section.single[key] = (line, value)


def _read(section: _Section, key: str, default: str, where: str, convert: Callable[[str], Any]) -> Any:
    line, value = section.get(key, default)
    with at(where, line, key):
        return convert(value)


def _variable(section: _Section, where: str) -> Variable:
    """Variable of an InputVariable or OutputVariable section."""
    low, high = _read(section, "range", "-inf inf", where, _range)
    common: dict[str, Any] = {
        "name": identifier(section.name), "low": low, "high": high,
        "unit": _read(section, "unit", "", where, unquote),
        "lock_range": _read(section, "lock-range", "false", where, boolean),
    }  # fmt: skip
    enabled = _read(section, "enabled", "true", where, boolean)
    if section.kind == "InputVariable":
        terms = tuple(_term(line, value, where, section.singletons) for line, value in section.many)
        with at(where, section.line, section.kind):
            variable = Variable(terms=terms, **common)
            variable.check_input()
        return variable
    if low == high and not common["lock_range"] and "Weighted" in section.get("defuzzifier", "")[1]:
        common["low"], common["high"] = -math.inf, math.inf  # a weighted defuzzifier has no use for the range
    defuzzifier, samples, kind = _read(section, "defuzzifier", "none", where, _defuzzifier)
    terms = tuple(_term(line, value, where, section.singletons) for line, value in section.many)
    _check_kind(section, where, kind, terms)
    default = _read(section, "default", "nan", where, numbers)
    if len(default) != 1:
        raise fault(where, section.get("default", "")[0], "default", "expected one number or nan")
    with at(where, section.line, section.kind):
        output = Variable(
            terms=terms, defuzzifier=defuzzifier,
            resolution=samples or _read(section, "resolution", "101", where, resolution),
            quadrature=_read(section, "quadrature", "midpoint", where, quadrature),
            aggregation=_read(section, "aggregation", "none", where, partial(_aggregation, defuzzifier)),
            default=default[0] if enabled else math.nan,
            lock_previous=_read(section, "lock-previous", "false", where, boolean), **common,
        )  # fmt: skip
        output.check_output()
    return output


def _range(text: str) -> tuple[float, float]:
    values = numbers(text)
    if len(values) != 2:
        raise ValueError(f"expected two numbers, low and high, got {shortened(text)!r}")
    return values[0], values[1]


def _aggregation(defuzzifier: str, text: str) -> str | None:
    if text in ("none", ""):
        if defuzzifier not in WEIGHTED:
            raise ValueError(f"the {DEFUZZIFIER_WORDS[defuzzifier]} of an output needs one, for instance Maximum")
        return None
    return named(text, CONORM_WORDS, "aggregation")


def _defuzzifier(text: str) -> tuple[str, int, str]:
    """Our name, the resolution, and the type of a weighted one."""
    name, _, parameter = text.partition(" ")
    if name in ("none", ""):
        raise ValueError("an output needs one, for instance Centroid 101")
    ours, parameter = named(name, DEFUZZIFIER_WORDS, "defuzzifier"), parameter.strip()
    if ours not in WEIGHTED:
        return ours, resolution(parameter or _FUZZYLITE_RESOLUTION), ""
    if parameter not in ("", "Automatic", "TakagiSugeno", "Tsukamoto"):
        raise ValueError(f"unknown type {shortened(parameter)!r} of {name}; known: TakagiSugeno, Tsukamoto")
    return ours, 0, parameter


def _check_kind(section: _Section, where: str, kind: str, terms: tuple[Term, ...]) -> None:
    """Raise unless the terms are of the stated type of weighted defuzzifier."""
    fitting = {"TakagiSugeno": {"constant", "linear", "singleton"}, "Tsukamoto": MONOTONE}.get(kind, set(SHAPES))
    for (line, _), term in zip(section.many, terms):
        if term.shape not in fitting:
            raise fault(where, line, "term", f"{term.name!r} ({SHAPE_WORDS[term.shape]}) does not fit type {kind}")


def _term(line: int, text: str, where: str, singletons: set[str]) -> Term:
    words = text.split()
    with at(where, line, "term"):
        if len(words) < 2:
            raise ValueError(f"expected 'name Shape numbers', got {shortened(text)!r}")
        name, shape = identifier(words[0]), words[1]
        if shape == "Function":
            raise ValueError(f"{name!r} is a Function term, which is not supported: use Linear, Constant or Discrete")
        ours, values = named(shape, SHAPE_WORDS, "shape"), numbers(" ".join(words[2:]))
        height = values.pop() if len(values) == _count(ours, values) + 1 else 1.0
        if words[0] in singletons:
            return Term(name=name, shape="singleton", parameters=tuple(values[:1]), height=height)
        return Term(name=name, shape=ours, parameters=_ours(ours, values), height=height)


def _count(shape: str, values: list[float]) -> int:
    """How many of the numbers are parameters, so that one more is the height."""
    if shape in ("linear", "constant"):
        return len(values)
    return len(values) // 2 * 2 if shape == "discrete" and len(values) > 1 else len(SHAPES[shape].parameters)


def _ours(shape: str, values: list[float]) -> tuple[float, ...]:
    """Parameters in our stricter form; the membership is the same."""
    if shape == "binary" and len(values) == 2 and values[0] != values[1]:
        return values[0], math.copysign(math.inf, values[1] - values[0])
    if shape == "rectangle" and len(values) == 2:
        return min(values), max(values)
    if shape in ("gaussian", "spike") and len(values) == 2:
        return values[0], abs(values[1])
    if shape == "two-sided gaussian" and len(values) == 4:
        return values[0], abs(values[1]), values[2], abs(values[3])
    return tuple(values)


def _off(sections: list[_Section], where: str) -> dict[str, set[str]]:
    """Names of the disabled inputs and outputs."""
    off: dict[str, set[str]] = {"InputVariable": set(), "OutputVariable": set()}
    for section in sections:
        if section.kind in off and not _read(section, "enabled", "true", where, boolean):
            off[section.kind].add(identifier(section.name))
    return off


def _block(
    section: _Section,
    where: str,
    off: dict[str, set[str]],
    variables: tuple[tuple[Variable, ...], tuple[Variable, ...]],
) -> RuleBlock | None:
    """The block of a RuleBlock section; None when nothing of it is enabled."""
    operators = {
        key: _read(section, key, "none", where, partial(_operator, key, words))
        for key, words in (("conjunction", NORM_WORDS), ("disjunction", CONORM_WORDS), ("implication", NORM_WORDS))
    }
    line, activation = section.get("activation", "General")
    if activation not in ("General", "none", ""):
        raise fault(where, line, "activation", f"{shortened(activation)!r} is not supported; expected General")
    inputs, outputs = variables
    enabled = _read(section, "enabled", "true", where, boolean)
    sampled = {v.name for v in outputs if v.defuzzifier not in WEIGHTED}
    rules = []
    for line, text in section.many:
        with at(where, line, "rule"):
            rule = _rule(text, operators, off, {v.name for v in outputs})
            if rule is not None and enabled:
                check_rule(rule, inputs, outputs)
        if rule is not None:
            rules.append(rule)
            if operators["implication"] is None and not sampled.isdisjoint(c.variable for c in rule.consequents):
                line = section.get("implication", "")[0]
                raise fault(where, line, "implication", "the outputs concluded here need one, for instance Minimum")
    if not rules or not enabled:
        return None
    with at(where, section.line, "RuleBlock"):
        given = {key: value for key, value in operators.items() if value is not None}
        return RuleBlock(rules=tuple(rules), name=section.name, **given)


def _operator(key: str, words: dict[str, str], text: str) -> str | None:
    return None if text in ("none", "") else named(text, words, key)


def _rule(text: str, operators: dict[str, str | None], off: dict[str, set[str]], outputs: set[str]) -> Rule | None:
    """The rule without its disabled parts; None when nothing is left of it."""
    rule = Rule.parse(text)
    for condition in propositions(rule.antecedent):
        if condition.variable in outputs:
            raise ValueError(f"the output {condition.variable!r} as a condition is not supported; use inputs")
    for key, kind, word in (("conjunction", And, "and"), ("disjunction", Or, "or")):
        if operators[key] is None and _uses(rule.antecedent, kind):
            raise ValueError(f"uses '{word}', but the {key} of its block is none")
    antecedent = _enabled(rule.antecedent, off["InputVariable"])
    consequents = tuple(c for c in rule.consequents if c.variable not in off["OutputVariable"])
    if antecedent is None or not consequents:
        return None
    return replace(rule, antecedent=antecedent, consequents=consequents)


def _uses(node: Antecedent, kind: type) -> bool:
    return isinstance(node, kind) or any(_uses(part, kind) for part in getattr(node, "parts", ()))


def _enabled(node: Antecedent, off: set[str]) -> Antecedent | None:
    """The antecedent in which propositions on disabled inputs have degree 0; None when it can never hold."""
    if isinstance(node, Proposition):
        return None if node.variable in off else node
    parts = [_enabled(part, off) for part in node.parts]
    left = tuple(part for part in parts if part is not None)
    if isinstance(node, And) and len(left) < len(parts):
        return None
    if len(left) < 2:
        return left[0] if left else None
    return replace(node, parts=left)
