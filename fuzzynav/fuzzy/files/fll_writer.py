"""Writing the FuzzyLite Language (.fll); `fll` reads it and says what the `#!` lines mean."""

from __future__ import annotations

from collections.abc import Iterable

from fuzzynav.fuzzy.files.fll import CONORM_WORDS, DEFUZZIFIER_WORDS, NORM_WORDS, SHAPE_WORDS
from fuzzynav.fuzzy.files.text import identifier, is_plain, quote, resolution, show
from fuzzynav.fuzzy.membership import Term
from fuzzynav.fuzzy.system import FuzzySystem
from fuzzynav.fuzzy.variable import WEIGHTED, RuleBlock, Variable

__all__ = ["dump"]


def dump(system: FuzzySystem) -> str:
    """Text of the system in the FuzzyLite Language; `fll.parse` gives an equal system back.

    Raises ValueError for what the language cannot say: a name that FuzzyLite would change, for instance.
    """
    lines = [f"Engine: {_title(system.name, 'fuzzy system')}"]
    if system.description:
        plain = is_plain(system.description) and "#" not in system.description
        lines.append(f"  {'' if plain else '#! '}description: {quote(system.description)}")
    if system.source:
        lines.append(f"  #! source: {quote(system.source)}")
    for variable in system.inputs:
        lines += _variable("InputVariable", variable)
        lines += _terms(variable, weighted=False)
    for variable in system.outputs:
        lines += _variable("OutputVariable", variable)
        lines += _output(variable)
        lines += _terms(variable, weighted=variable.defuzzifier in WEIGHTED)
    for block in system.blocks:
        lines += _block(block)
    return "\n".join(line.rstrip() for line in lines) + "\n"


def _title(name: str, what: str) -> str:
    if not is_plain(name) or "#" in name:
        raise ValueError(f"the name {name!r} of a {what} cannot stand in a .fll file: it must be one line without #")
    return name


def _name(name: str, what: str) -> str:
    if identifier(name) != name:
        raise ValueError(
            f"the {what} name {name!r} cannot stand in a .fll file: FuzzyLite would read {identifier(name)!r}; "
            "use letters, digits and _"
        )
    return name


def _variable(kind: str, variable: Variable) -> Iterable[str]:
    yield f"{kind}: {_name(variable.name, 'variable')}"
    if variable.unit:
        yield f"  #! unit: {quote(variable.unit)}"
    yield "  enabled: true"
    yield f"  range: {show(variable.low)} {show(variable.high)}"
    yield f"  lock-range: {str(variable.lock_range).lower()}"


def _output(variable: Variable) -> Iterable[str]:
    weighted = variable.defuzzifier in WEIGHTED
    name = DEFUZZIFIER_WORDS[variable.defuzzifier]
    samples = f"{resolution(str(variable.resolution))}"
    yield f"  #! quadrature: {variable.quadrature}"
    if weighted:
        yield f"  #! resolution: {samples}"
    if weighted and variable.aggregation == "sum":
        yield "  aggregation: none"
    else:
        yield f"  aggregation: {CONORM_WORDS[str(variable.aggregation)]}"
    yield f"  defuzzifier: {name}" + ("" if weighted else f" {samples}")
    yield f"  default: {show(variable.default)}"
    yield f"  lock-previous: {str(variable.lock_previous).lower()}"


def _terms(variable: Variable, *, weighted: bool) -> Iterable[str]:
    for term in variable.terms:
        _name(term.name, "term")
        if term.shape == "singleton":
            yield f"  #! singleton: {term.name}"
        yield f"  term: {term.name} {_shape(term, weighted)}"


def _shape(term: Term, weighted: bool) -> str:
    height = "" if term.height == 1.0 else f" {show(term.height)}"
    values = " ".join(show(v) for v in term.parameters)
    if term.shape == "singleton":
        if weighted and not height:
            return f"Constant {values}"
        return f"Rectangle {values} {values}{height}"
    if height and term.shape in ("constant", "linear"):
        raise ValueError(f"term {term.name!r}: a {term.shape} term has no height in a .fll file, got {term.height:g}")
    return f"{SHAPE_WORDS[term.shape]} {values}{height}"


def _block(block: RuleBlock) -> Iterable[str]:
    yield f"RuleBlock: {_title(block.name, 'rule block')}"
    yield "  enabled: true"
    yield f"  conjunction: {NORM_WORDS[block.conjunction]}"
    yield f"  disjunction: {CONORM_WORDS[block.disjunction]}"
    yield f"  implication: {NORM_WORDS[block.implication]}"
    yield "  activation: General"
    for rule in block.rules:
        yield f"  rule: {rule}"
