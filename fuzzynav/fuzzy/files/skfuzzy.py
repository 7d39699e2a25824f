"""Exchange with scikit-fuzzy: a `FuzzySystem` as a `skfuzzy.control.ControlSystem`, and back.

scikit-fuzzy holds a set as samples on a universe and joins them by straight lines; it clips with the minimum, joins
with the maximum, and has no default. So the two systems agree where a rule fires, up to the sampling, and both come
nearer to the exact answer as the resolution grows. Inputs outside their range: scikit-fuzzy clips them.
It is imported when it is first asked for: it brings matplotlib along, for which a robot has no use.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.fuzzy.files.text import identifier
from fuzzynav.fuzzy.membership import POLYGONAL, Term, breakpoints
from fuzzynav.fuzzy.operators import CONORMS, NORMS
from fuzzynav.fuzzy.rules import And, Antecedent, Or, Proposition, Rule
from fuzzynav.fuzzy.system import FuzzySystem
from fuzzynav.fuzzy.variable import RuleBlock, Variable
from fuzzynav.geometry import Array

__all__ = ["answer", "from_skfuzzy", "to_skfuzzy"]

_INPUT_SAMPLES = 1001
_METHODS = {
    "centroid": "centroid",
    "bisector": "bisector",
    "mean of maximum": "mom",
    "smallest of maximum": "som",
    "largest of maximum": "lom",
}
_AND = {"min": np.fmin, "product": np.multiply}
_OR = {"max": np.fmax}


@cache
def _control() -> ModuleType:
    """scikit-fuzzy's `control`, imported at the first call."""
    from skfuzzy import control

    return control  # type: ignore[no-any-return]


def _known_and() -> dict[Any, str]:
    own = {norm.function: name for name, norm in NORMS.items()}
    accumulation = _control().antecedent_consequent.accumulation_mult
    return own | {np.fmin: "min", np.minimum: "min", min: "min", np.multiply: "product", accumulation: "product"}


def _known_or() -> dict[Any, str]:
    own = {conorm.function: name for name, conorm in CONORMS.items()}
    accumulation = _control().antecedent_consequent.accumulation_max
    return own | {np.fmax: "max", np.maximum: "max", max: "max", accumulation: "max"}


def to_skfuzzy(system: FuzzySystem) -> Any:
    """The system as a scikit-fuzzy ControlSystem with the same variables, terms and rules.

    The default of an output, for which scikit-fuzzy has no place, is left out. Raises ValueError that names what else
    scikit-fuzzy cannot express: weighted defuzzifiers, hedges other than `not`, other implications and aggregations.
    """
    if len({variable.name for variable in (*system.inputs, *system.outputs)} & {"current"}):
        raise ValueError("scikit-fuzzy keeps the name 'current' for itself; rename the variable")
    inputs = {v.name: _control().Antecedent(_universe(v, _INPUT_SAMPLES), v.name) for v in system.inputs}
    outputs = {v.name: _consequent(v) for v in system.outputs}
    for variable in (*system.inputs, *system.outputs):
        target = (inputs | outputs)[variable.name]
        for term in variable.terms:
            target[term.name] = _samples(term, target.universe, variable)
    result = _control().ControlSystem()
    for target in (*inputs.values(), *outputs.values()):  # first, so that the order of the variables is ours
        result.graph.add_node(target)
        result.graph.update(target.graph)
    for index, (block, rule) in enumerate(_numbered(system), start=1):
        result.addrule(_sk_rule(block, rule, inputs, outputs, f"rule {index}"))
    return result


def _numbered(system: FuzzySystem) -> Iterable[tuple[RuleBlock, Rule]]:
    for block in system.blocks:
        if block.implication != "min":
            raise ValueError(f"scikit-fuzzy knows implication min only; block {block.name!r} has {block.implication!r}")
        for rule in block.rules:
            yield block, rule


def _consequent(variable: Variable) -> Any:
    here = f"output {variable.name!r}"
    if variable.defuzzifier not in _METHODS:
        raise ValueError(f"{here}: scikit-fuzzy has no defuzzifier {variable.defuzzifier!r}")
    if variable.aggregation != "max":
        raise ValueError(f"{here}: scikit-fuzzy knows aggregation max only, got {variable.aggregation!r}")
    if variable.lock_previous:
        raise ValueError(f"{here}: scikit-fuzzy has no lock-previous")
    universe = _universe(variable, variable.resolution)
    return _control().Consequent(universe, variable.name, defuzzify_method=_METHODS[variable.defuzzifier])


def _universe(variable: Variable, n: int) -> Array:
    """Samples of the range, the bends of its terms, and both sides of their steps."""
    if not (math.isfinite(variable.low) and math.isfinite(variable.high)):
        raise ValueError(f"variable {variable.name!r}: scikit-fuzzy needs a finite range")
    bends: set[float] = set()
    for term in variable.terms:
        points = set(breakpoints(term)) if term.shape in POLYGONAL else set()
        if term.shape in ("s", "z", "pi"):
            points = set(term.parameters)
        for x in points:
            near = np.array([np.nextafter(x, -np.inf), x, np.nextafter(x, np.inf)])
            steps = np.abs(np.diff(term.membership(near))) > 1e-6
            bends |= {x, *(near[[0, 2]][steps])}
    inside = [x for x in bends if variable.low <= x <= variable.high]
    return np.union1d(np.linspace(variable.low, variable.high, n), inside)


def _samples(term: Term, universe: Array, variable: Variable) -> Array:
    here = f"variable {variable.name!r}, term {term.name!r}"
    if term.shape in ("linear", "constant", "singleton"):
        raise ValueError(f"{here}: scikit-fuzzy has no {term.shape} term")
    return term.membership(universe)


def _sk_rule(block: RuleBlock, rule: Rule, inputs: dict[str, Any], outputs: dict[str, Any], label: str) -> Any:
    antecedent = _sk_antecedent(rule.antecedent, inputs, rule)
    if antecedent is None:
        raise ValueError(f"rule '{rule}': scikit-fuzzy has no 'any'")
    for part in rule.consequents:
        if part.hedges:
            raise ValueError(f"rule '{rule}': scikit-fuzzy has no hedge in a conclusion")
    conclusions = [
        _control().rule.WeightedTerm(outputs[part.variable][part.term], rule.weight) for part in rule.consequents
    ]
    return _control().Rule(
        antecedent, conclusions, label=label,
        and_func=_AND.get(block.conjunction, NORMS[block.conjunction].function),
        or_func=_OR.get(block.disjunction, CONORMS[block.disjunction].function),
    )  # fmt: skip


def _sk_antecedent(node: Antecedent, inputs: dict[str, Any], rule: Rule) -> Any:
    """Term or aggregate of scikit-fuzzy; None for what always holds (any)."""
    if isinstance(node, Proposition):
        if node.hedges == ("any",):
            return None
        if node.hedges not in ((), ("not",)):
            raise ValueError(f"rule '{rule}': scikit-fuzzy has no hedge but 'not', got {' '.join(node.hedges)!r}")
        term = inputs[node.variable][node.term]
        return ~term if node.hedges else term
    parts = [_sk_antecedent(part, inputs, rule) for part in node.parts]
    if isinstance(node, Or) and None in parts:
        return None
    parts = [part for part in parts if part is not None]
    result = parts[0] if parts else None
    for part in parts[1:]:
        result = result & part if isinstance(node, And) else result | part
    return result


def answer(control_system: Any, *inputs: ArrayLike) -> tuple[Array, ...]:
    """What scikit-fuzzy answers: one array for each output, nan where no rule fires; the inputs broadcast.

    Every point gets a simulation without a cache: one that is used again can return the answer before (0.5.0).
    """
    points = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in inputs))
    names = [variable.label for variable in control_system.antecedents]
    outputs = [variable.label for variable in control_system.consequents]
    if len(names) != len(points):
        raise ValueError(f"the ControlSystem has {len(names)} inputs ({', '.join(names)}), got {len(points)}")
    results = np.full((len(outputs), *points[0].shape), np.nan)
    simulation = _control().ControlSystemSimulation(control_system, cache=False)
    with warnings.catch_warnings():  # scikit-fuzzy 0.5 passes `out` by position, which NumPy 2.4 no longer likes
        warnings.filterwarnings("ignore", "Passing more than 2 positional arguments", DeprecationWarning)
        for index in np.ndindex(points[0].shape):
            for name, values in zip(names, points):
                simulation.input[name] = float(values[index])
            try:
                simulation.compute()
            except _control().exceptions.EmptyMembershipError:
                continue
            for row, label in enumerate(outputs):
                results[(row, *index)] = simulation.output.get(label, np.nan)
    return tuple(results)


def from_skfuzzy(control_system: Any, name: str = "from_skfuzzy") -> FuzzySystem:
    """The system that a scikit-fuzzy ControlSystem describes, its sets as Discrete terms on its universes.

    Inputs are locked to their range, as scikit-fuzzy clips them. Raises ValueError that names what has no counterpart:
    an output used as a condition, a function of the user's own for AND, OR or accumulation.
    """
    if not isinstance(control_system, _control().ControlSystem):
        raise ValueError(f"expected a skfuzzy.control.ControlSystem, got {type(control_system).__name__}")
    rules = list(control_system.rules)
    if not rules:
        raise ValueError("the ControlSystem has no rules: a fuzzy system needs at least one")
    inputs = tuple(_variable(v, lock_range=True) for v in control_system.antecedents)
    outputs = tuple(_output(v) for v in control_system.consequents)
    blocks: list[tuple[tuple[str, str], list[Rule]]] = []
    for sk_rule in rules:
        methods = _function(sk_rule.and_func, _known_and()), _function(sk_rule.or_func, _known_or())
        if not blocks or blocks[-1][0] != methods:
            blocks.append((methods, []))
        blocks[-1][1].extend(_rules(sk_rule))
    made = tuple(RuleBlock(rules=tuple(r), conjunction=m[0], disjunction=m[1]) for m, r in blocks)
    return FuzzySystem(name=name, inputs=inputs, outputs=outputs, blocks=made, source="scikit-fuzzy ControlSystem")


def _function(function: Any, known: dict[Any, str]) -> str:
    if function not in known:
        raise ValueError(
            f"the function {getattr(function, '__name__', function)!r} of a rule is not known; "
            f"known: {', '.join(sorted(set(known.values())))}"
        )
    return known[function]


def _variable(variable: Any, **options: Any) -> Variable:
    universe = np.asarray(variable.universe, dtype=float)
    if universe.ndim != 1 or universe.size < 2 or not (np.diff(universe) > 0.0).all():
        raise ValueError(f"variable {variable.label!r}: its universe must be ascending, with two points or more")
    terms = tuple(
        Term(
            name=identifier(str(term.label)), shape="discrete", parameters=_pairs(universe, np.asarray(term.mf, float))
        )
        for term in variable.terms.values()
    )
    return Variable(name=identifier(str(variable.label)), low=universe[0], high=universe[-1], terms=terms, **options)


def _output(variable: Any) -> Variable:
    if variable.accumulation_method not in _known_or():
        raise ValueError(
            f"output {variable.label!r}: only accumulation_max is known, not {variable.accumulation_method}"
        )
    methods = {theirs: ours for ours, theirs in _METHODS.items()}
    method = str(variable.defuzzify_method).lower()
    if method not in methods:
        raise ValueError(f"output {variable.label!r}: unknown defuzzify_method {method!r}; known: {', '.join(methods)}")
    exact = method == "centroid"
    return _variable(
        variable, defuzzifier=methods[method], resolution=len(variable.universe),
        quadrature="exact" if exact else "trapezoid",
    )  # fmt: skip


def _pairs(x: Array, y: Array) -> tuple[float, ...]:
    """The points x1, y1, x2, y2, ... without those that lie on the line between their neighbours."""
    slope = np.diff(y) / np.diff(x)
    bend = np.abs(np.diff(slope)) * np.minimum(np.diff(x)[:-1], np.diff(x)[1:]) > 1e-12
    keep = np.concatenate([[True], bend, [True]])
    return tuple(np.stack([x[keep], y[keep]], axis=-1).ravel().tolist())


def _rules(sk_rule: Any) -> Iterable[Rule]:
    """Our rules of one of theirs: one for each weight, since ours is the weight of the whole rule."""
    antecedent = _antecedent(sk_rule.antecedent)
    by_weight: dict[float, list[Proposition]] = {}
    for part in sk_rule.consequent:
        conclusion = Proposition(variable=_label(part.term.parent), term=_label(part.term))
        by_weight.setdefault(float(part.weight), []).append(conclusion)
    for weight, conclusions in by_weight.items():
        yield Rule(antecedent=antecedent, consequents=tuple(conclusions), weight=weight)


def _label(thing: Any) -> str:
    return identifier(str(thing.label))


def _antecedent(node: Any) -> Antecedent:
    if isinstance(node, _control().term.Term):
        if isinstance(node.parent, _control().Consequent):
            raise ValueError(f"the output {node.parent.label!r} as a condition of a rule is not supported")
        return Proposition(variable=_label(node.parent), term=_label(node))
    if not isinstance(node, _control().term.TermAggregate):
        raise ValueError(f"unknown antecedent {node!r}")
    if node.kind == "not":
        return _negated(node.term1)
    join = And if node.kind == "and" else Or
    parts: list[Antecedent] = []
    for part in (_antecedent(node.term1), _antecedent(node.term2)):
        parts += part.parts if isinstance(part, join) else [part]
    return join(parts=tuple(parts))


def _negated(node: Any) -> Antecedent:
    """`not` of a single term."""
    plain = _antecedent(node) if isinstance(node, _control().term.Term) else None
    if not isinstance(plain, Proposition):
        raise ValueError(f"NOT of a combination is not supported, got {node!r}: write it with NOT of single terms")
    return Proposition(variable=plain.variable, term=plain.term, hedges=("not",))
