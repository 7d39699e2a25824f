"""Reading MATLAB's fuzzy inference system files (.fis); `fis_writer` writes them.

A file read here answers as MATLAB's evalfis does: the centroid is the plain sum over 101 points, and where no rule
fires the answer is the middle of the output's range. What our systems hold and the format has no word for stands in
lines `%! key: value`, which MATLAB and Octave take for comments.

MATLAB's som and lom take the smallest and largest ABSOLUTE value of the maximum; on a range below 0 they change places,
and on a range that holds both signs they are refused. A negative consequent (not) is refused: it negates the output
set, while a hedge in our rules acts on the strength.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from fuzzynav.fuzzy.files.text import (
    at,
    boolean,
    fault,
    identifier,
    named,
    number,
    numbers,
    quadrature,
    resolution,
    shortened,
    unquote,
)
from fuzzynav.fuzzy.membership import SHAPES, Shape, Term
from fuzzynav.fuzzy.operators import CONORMS, NORMS
from fuzzynav.fuzzy.rules import And, Antecedent, Or, Proposition, Rule
from fuzzynav.fuzzy.system import FuzzySystem
from fuzzynav.fuzzy.variable import DEFUZZIFIERS, WEIGHTED, RuleBlock, Variable

__all__ = ["parse"]

SHAPE_WORDS = {name: shape.fis for name, shape in SHAPES.items() if shape.fis}
NORM_WORDS = {name: norm.fis for name, norm in NORMS.items() if norm.fis}
CONORM_WORDS = {name: conorm.fis for name, conorm in CONORMS.items() if conorm.fis}
DEFUZZIFIER_WORDS = {name: way.fis for name, way in DEFUZZIFIERS.items()}

_METHODS = ("andmethod", "ormethod", "impmethod", "aggmethod", "defuzzmethod")
_SYSTEM = ("name", "type", "version", "numinputs", "numoutputs", "numrules", *_METHODS)
_DIRECTIVES = {
    "System": ("source", "description", "block"),
    "Input": ("unit", "lock-range"),
    "Output": ("unit", "lock-range", "quadrature", "resolution", "default", "lock-previous"),
    "Rules": (),
}
_RULE = re.compile(r"\s*([^,]*),([^(]*)\(([^)]*)\)\s*:\s*([12])\s*")


@dataclass
class _Section:
    """A section of the file: kind, number (of an input or output), line, its values and its free lines."""

    kind: str
    index: int
    line: int
    values: dict[str, tuple[int, str]] = field(default_factory=dict)
    rows: list[tuple[int, str]] = field(default_factory=list)


def parse(text: str, where: str = "<text>") -> FuzzySystem:
    """Fuzzy system of the text of a .fis file.

    Raises ValueError that names `where` (the file), the line, the field and what would be right.
    """
    sections = _sections(text, where)
    system = sections[0]
    methods = _methods(system, where)
    variables = {}
    for kind, key in (("Input", "numinputs"), ("Output", "numoutputs")):
        found = [s for s in sections if s.kind == kind]
        _check_count(system, key, len(found), f"[{kind}] sections", where)
        if [s.index for s in found] != list(range(1, len(found) + 1)):
            raise fault(where, found[0].line, f"[{kind}]", f"expected [{kind}1], [{kind}2], ... in this order")
        variables[kind] = [_variable(s, where, methods) for s in found]
    last = sections[-1]
    if last.kind != "Rules":
        raise fault(where, text.count("\n") + 1, "[Rules]", "the file ends without its rules: is it cut off?")
    _check_count(system, "numrules", len(last.rows), "lines under [Rules]", where)
    rules = []
    for line, row in last.rows:
        with at(where, line, "rule"):
            rules.append(_rule(row, variables["Input"], variables["Output"]))
    get = _reader(system, where)
    with at(where, last.line, "[Rules]"):
        block = RuleBlock(
            rules=tuple(rules), name=get("%block", "", unquote), conjunction=methods["andmethod"],
            disjunction=methods["ormethod"], implication=methods["impmethod"],
        )  # fmt: skip
    with at(where, 1):
        return FuzzySystem(
            name=get("name", "''", _text), inputs=tuple(variables["Input"]),
            outputs=tuple(variables["Output"]), blocks=(block,),
            source=get("%source", "", unquote), description=get("%description", "", unquote),
        )  # fmt: skip


def _sections(text: str, where: str) -> list[_Section]:
    """Split the text at its [Section] lines and check every key."""
    sections: list[_Section] = []
    seen: set[tuple[str, int]] = set()
    for line, raw in enumerate(text.split("\n"), start=1):
        bare = raw.strip()
        directive = re.fullmatch(r"%!\s*([a-z-]+):(.*)", bare)
        if not bare or (bare[0] in "%#" and directive is None):
            continue
        head = re.fullmatch(r"\[(System|Input|Output|Rules)(\d{0,6})\]", bare)
        if head:
            name = (head[1], int(head[2] or 0))
            if (name[0] == "System") == bool(sections) or name in seen or ("Rules", 0) in seen:
                raise fault(where, line, bare, "expected [System], [Input1] ..., [Output1] ..., [Rules], each once")
            sections.append(_Section(*name, line))
            seen.add(name)
        elif not sections:
            raise fault(where, line, "", f"expected [System], got {bare[:40]!r}")
        elif directive:
            _store(sections[-1], line, "%" + directive[1], directive[2].strip(), where)
        elif sections[-1].kind == "Rules":
            sections[-1].rows.append((line, bare))
        else:
            key, sign, value = bare.partition("=")
            if not sign:
                raise fault(where, line, "", f"expected Key=value, got {bare[:40]!r}")
            _store(sections[-1], line, key.strip().lower(), value.strip(), where)
    if not sections:
        raise fault(where, 1, "", "the file holds nothing; expected [System] on the first line")
    return sections


def _store(section: _Section, line: int, key: str, value: str, where: str) -> None:
    known = {"System": _SYSTEM, "Rules": ()}.get(section.kind, ("name", "range", "nummfs"))
    fine = key[1:] in _DIRECTIVES[section.kind] if key[0:1] == "%" else key in known
    if not fine and not (section.kind in ("Input", "Output") and re.fullmatch(r"mf\d{1,6}", key)):
        raise fault(where, line, key, f"unknown under [{section.kind}]; known: {', '.join(known)}")
    if key in section.values:
        raise fault(where, line, key, f"stands twice under [{section.kind}]")
    section.values[key] = (line, value)


def _reader(section: _Section, where: str) -> Callable[[str, str | None, Callable[[str], Any]], Any]:
    """Function (key, default, conversion) that reads one value of the section; a default of None means needed."""

    def get(key: str, default: str | None, convert: Callable[[str], Any]) -> Any:
        if key not in section.values and default is None:
            raise fault(where, section.line, key, f"is missing under [{section.kind}]")
        line, value = section.values.get(key, (section.line, default or ""))
        with at(where, line, key.replace("%", "%! ")):
            return convert(value)

    return get


def _text(value: str) -> str:
    if len(value) < 2 or value[0] != value[-1] or value[0] not in "'\"":
        raise ValueError(f"expected text in quotes, got {shortened(value)!r}")
    return value[1:-1]


def _list(value: str) -> list[float]:
    if value[:1] != "[" or value[-1:] != "]":
        raise ValueError(f"expected numbers in [ ], got {shortened(value)!r}")
    return numbers(value[1:-1].replace(",", " "))


def _whole(value: str) -> int:
    if not re.fullmatch(r"\d{1,6}", value):
        raise ValueError(f"expected a whole number, got {shortened(value)!r}")
    return int(value)


def _check_count(section: _Section, key: str, found: int, what: str, where: str) -> None:
    stated = _reader(section, where)(key, None, _whole)
    if stated != found:
        line = section.values[key][0]
        raise fault(where, line, key, f"says {stated}, but the file has {found} {what}: is it cut off?")


def _methods(system: _Section, where: str) -> dict[str, str]:
    """Type and operators of the system, in our words."""
    get = _reader(system, where)
    kind = get("type", None, _text).lower()
    if kind not in ("mamdani", "sugeno"):
        raise fault(where, system.values["type"][0], "type", f"expected 'mamdani' or 'sugeno', got {kind!r}")
    sugeno = kind == "sugeno"
    tables = {
        "andmethod": (NORM_WORDS, "'min'"), "ormethod": (CONORM_WORDS, "'max'"), "impmethod": (NORM_WORDS, "'min'"),
        "aggmethod": (CONORM_WORDS, "'sum'" if sugeno else "'max'"),
        "defuzzmethod": (DEFUZZIFIER_WORDS, "'wtaver'" if sugeno else "'centroid'"),
    }  # fmt: skip
    methods = {key: get(key, default, partial(_known, table)) for key, (table, default) in tables.items()}
    if (methods["defuzzmethod"] in WEIGHTED) != sugeno:
        line = system.values.get("defuzzmethod", (system.line, ""))[0]
        raise fault(where, line, "defuzzmethod", f"{DEFUZZIFIER_WORDS[methods['defuzzmethod']]} does not fit a {kind}")
    return methods


def _known(words: dict[str, str], value: str) -> str:
    text = _text(value).lower()
    if text not in words.values():
        raise ValueError(f"{shortened(text)!r} is not supported; expected {', '.join(words.values())}")
    return named(text, words, "method")


def _variable(section: _Section, where: str, methods: dict[str, str]) -> Variable:
    """Variable of an [InputN] or [OutputN] section."""
    get = _reader(section, where)
    limits = get("range", None, _list)
    if len(limits) != 2:
        raise fault(where, section.values["range"][0], "range", f"expected two numbers, got {len(limits)}")
    rows = [(int(key[2:]), line, value) for key, (line, value) in section.values.items() if re.match(r"mf\d", key)]
    if [index for index, _, _ in rows] != list(range(1, len(rows) + 1)):
        raise fault(where, section.line, f"[{section.kind}{section.index}]", "expected MF1, MF2, ... in this order")
    _check_count(section, "nummfs", len(rows), "MF lines", where)
    terms = tuple(_term(line, value, where) for _, line, value in rows)
    name, low, high = identifier(get("name", None, _text)), limits[0], limits[1]
    with at(where, section.line, f"[{section.kind}{section.index}]"):
        common: dict[str, Any] = {
            "name": name, "low": low, "high": high, "terms": terms, "unit": get("%unit", "", unquote),
            "lock_range": get("%lock-range", "false", boolean),
        }  # fmt: skip
        if section.kind == "Input":
            variable = Variable(**common)
            variable.check_input()
            return variable
        output = Variable(
            defuzzifier=swapped(methods["defuzzmethod"], low, high), aggregation=methods["aggmethod"],
            quadrature=get("%quadrature", "sum", quadrature), resolution=get("%resolution", "101", resolution),
            default=get("%default", repr(0.5 * (low + high)), number),
            lock_previous=get("%lock-previous", "false", boolean), **common,
        )  # fmt: skip
        output.check_output()
    return output


def swapped(defuzzifier: str, low: float, high: float) -> str:
    """MATLAB's som and lom (by absolute value) in our words, and the other way round."""
    ends = ["smallest of maximum", "largest of maximum"]
    if defuzzifier not in ends or low >= 0.0:
        return defuzzifier
    if high > 0.0:
        raise ValueError(
            f"{DEFUZZIFIER_WORDS[defuzzifier]} on the range {low:g} to {high:g}: MATLAB takes the absolute value, "
            "which is not supported across 0; use mom or centroid"
        )
    return ends[1 - ends.index(defuzzifier)]


def _term(line: int, value: str, where: str) -> Term:
    with at(where, line, "MF"):
        match = re.fullmatch(r"'([^']*)'\s*:\s*'([^']*)'\s*,\s*(\[[^\]]*\]|\S+)", value)
        if match is None:
            raise ValueError(f"expected 'name':'type',[numbers], got {value[:60]!r}")
        name, kind = identifier(match[1]), match[2].lower()
        p = _list(match[3]) if match[3][0] == "[" else [number(match[3])]
        shape = SHAPES[named(kind, SHAPE_WORDS, "membership function")]
        return Term(name=name, shape=shape.name, parameters=_parameters(shape, tuple(p)))


def places(shape: Shape) -> tuple[int, ...]:
    """For each of our parameters its place in MATLAB's list."""
    return shape.places or tuple(range(len(shape.parameters)))


def _parameters(shape: Shape, p: tuple[float, ...]) -> tuple[float, ...]:
    """MATLAB's numbers in our order."""
    if shape.listed:
        return p
    if len(p) != len(shape.parameters):
        raise ValueError(f"{shape.fis} needs {len(shape.parameters)} numbers, got {len(p)}")
    return _ours(shape.name, tuple(p[k] for k in places(shape)))


def _ours(shape: str, p: tuple[float, ...]) -> tuple[float, ...]:
    """MATLAB's smf and zmf with ends in the wrong order are a step half way."""
    if shape in ("s", "z") and p[0] > p[1]:
        return (0.5 * (p[0] + p[1]),) * 2
    if shape == "gaussian":
        return p[0], abs(p[1])
    return p


def _rule(row: str, inputs: list[Variable], outputs: list[Variable]) -> Rule:
    """Rule of a line such as `1 -2, 1 (0.5) : 1`."""
    match = _RULE.fullmatch(row)
    if match is None:
        raise ValueError(f"expected '1 2, 1 (1) : 1', got {row[:60]!r}")
    left, right = numbers(match[1]), numbers(match[2])
    if len(left) != len(inputs) or len(right) != len(outputs):
        raise ValueError(
            f"expected {len(inputs)} input and {len(outputs)} output numbers, got {len(left)} and {len(right)}"
        )
    parts: list[Antecedent] = [p for p in map(_proposition, left, inputs) if p is not None]
    conclusions = [p for p in map(_proposition, right, outputs) if p is not None]
    if any(p.hedges for p in conclusions):
        raise ValueError("a negative output number (not) is not supported; name the opposite set")
    if not conclusions:
        raise ValueError("the rule has no conclusion: every output number is 0")
    if not parts:
        if match[4] == "2":
            raise ValueError("every input number is 0 and the connection is 2 (or): such a rule never fires")
        parts = [Proposition(variable=inputs[0].name, hedges=("any",))]
    join = And if match[4] == "1" else Or
    antecedent = parts[0] if len(parts) == 1 else join(parts=tuple(parts))
    return Rule(antecedent=antecedent, consequents=tuple(conclusions), weight=number(match[3]))


def _proposition(code: float, variable: Variable) -> Proposition | None:
    """Proposition of a signed term number; None for 0, don't care."""
    if not (math.isfinite(code) and code == int(code)):
        raise ValueError(f"{variable.name}: expected a whole term number (no hedge codes), got {code:g}")
    if code == 0:
        return None
    if abs(code) > len(variable.terms):
        raise ValueError(f"{variable.name} has {len(variable.terms)} terms, got number {code:g}")
    hedges = ("not",) if code < 0 else ()
    return Proposition(variable=variable.name, term=variable.terms[int(abs(code)) - 1].name, hedges=hedges)
