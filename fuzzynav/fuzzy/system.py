"""`FuzzySystem`: inputs, outputs and rules, ready to be called."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.fuzzy.compiled import Compiled, Tables, check_size, compile_system
from fuzzynav.fuzzy.defuzzify import mean_of_maximum
from fuzzynav.fuzzy.engine import run
from fuzzynav.fuzzy.gaps import Gaps, combinations, grid
from fuzzynav.fuzzy.inference import Inference
from fuzzynav.fuzzy.membership import Term
from fuzzynav.fuzzy.rules import Proposition, Rule, propositions
from fuzzynav.fuzzy.sets import match, places
from fuzzynav.fuzzy.variable import WEIGHTED, RuleBlock, Variable, tuple_of
from fuzzynav.geometry import Array

__all__ = ["INFERENCE", "FuzzySystem", "check_rule"]

INFERENCE = {
    "max-min": ("min", "min", "max"),
    "max-product": ("product", "product", "max"),
    "sum-product": ("product", "product", "sum"),
}
"""The three methods of thesis 2.4.4: conjunction, implication, aggregation (the implication is our reading)."""

_EMPTY = np.empty((0, 0))


@dataclass(frozen=True, slots=True, kw_only=True)
class FuzzySystem:
    """A fuzzy system of Mamdani or Takagi-Sugeno type: data base (inputs, outputs) and rule base (blocks).

    `source` names where it is printed, `description` what of it is chosen. Raises ValueError for an empty rule base, a
    name that is used twice, or a rule that speaks of an unknown variable or term.
    """

    name: str
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    blocks: tuple[RuleBlock, ...]
    source: str = ""
    description: str = ""
    _cache: dict[str, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    # what `fuzzynav.fuzzy` binds from its `files`, which stand above this module
    load: ClassVar[Callable[[str | Path], FuzzySystem]]
    save: ClassVar[Callable[[FuzzySystem, str | Path], None]]
    to_skfuzzy: ClassVar[Callable[[FuzzySystem], Any]]
    from_skfuzzy: ClassVar[Callable[..., FuzzySystem]]

    def __post_init__(self) -> None:
        here = f"fuzzy system {self.name!r}"
        if not isinstance(self.name, str):
            raise ValueError(f"the name of a fuzzy system must be text, got {self.name!r}")
        object.__setattr__(self, "inputs", tuple_of(self.inputs, Variable, f"{here}, inputs"))
        object.__setattr__(self, "outputs", tuple_of(self.outputs, Variable, f"{here}, outputs"))
        object.__setattr__(self, "blocks", tuple_of(self.blocks, RuleBlock, f"{here}, blocks"))
        if not self.inputs or not self.outputs:
            raise ValueError(f"{here} needs at least one input and one output")
        if not self.blocks:
            raise ValueError(f"{here} has an empty rule base")
        names = [v.name for v in (*self.inputs, *self.outputs)]
        if len(set(names)) < len(names):
            raise ValueError(f"{here}: two variables have one name: {', '.join(names)}")
        for variable in self.inputs:
            variable.check_input()
        for output in self.outputs:
            output.check_output()
            _check_linear(output, len(self.inputs))
        for rule in self.rules:
            check_rule(rule, self.inputs, self.outputs)
        _check_exact(self.outputs, self.blocks)
        check_size(self.outputs, self.blocks)

    @property
    def rules(self) -> tuple[Rule, ...]:
        """All rules, block after block: the order of `Inference.firing`."""
        return tuple(rule for block in self.blocks for rule in block.rules)

    def __call__(self, *inputs: ArrayLike | Term, previous: ArrayLike | None = None) -> tuple[Any, ...]:
        """One answer for each output: floats for scalar inputs, else arrays of the broadcast shape.

        An input may also be a Term (see `evaluate`). Where an input is nan every answer is nan. Where no rule fires an
        output is its default, or, if it locks its previous value, the one given in `previous` (one for each output).
        Raises ValueError for a wrong number of inputs.
        """
        if Term in map(type, inputs):
            return tuple(v if v.ndim else float(v) for v in self.evaluate(*inputs, previous=previous).values)
        points, shape = self._points(inputs)
        before = _EMPTY if previous is None else self._previous(previous, shape)
        values = np.empty((len(points), len(self.outputs)))
        run(points, _EMPTY, before, self.tables, values, _EMPTY)
        if shape == ():
            return tuple(values[0].tolist())
        return tuple(values[:, k].reshape(shape) for k in range(len(self.outputs)))

    def evaluate(
        self, *inputs: ArrayLike | Term, previous: ArrayLike | None = None, match_norm: str = "min"
    ) -> Inference:
        """The answers with the evidence for them. An input may be a Term: an uncertain reading, itself a fuzzy set.

        Such a reading is matched with every term by sup-min, or sup-product with `match_norm` "product", on 1001
        samples of the range and as many of the reading; a linear consequent is fed its mean of maximum. Raises
        ValueError like a call.
        """
        slots = self._compiled().slots
        crisp = tuple(
            _middle(self.inputs[k], x) if isinstance(x, Term) and k < len(self.inputs) else x
            for k, x in enumerate(inputs)
        )
        points, shape = self._points(crisp)
        before = _EMPTY if previous is None else self._previous(previous, shape)
        degrees = self._degrees(inputs, points, match_norm) if any(isinstance(x, Term) for x in inputs) else _EMPTY
        values, memberships, firing, strengths = self._evidence(points, degrees, before)
        split = np.cumsum([len(v.terms) for v in self.inputs])[:-1]
        parts = np.split(memberships.reshape(*shape, -1), split, axis=-1)
        return Inference(
            inputs=self.inputs,
            outputs=self.outputs,
            rules=self.rules,
            readings=tuple(
                f"the set {x.name}" if isinstance(x, Term) else points[:, k].reshape(shape)
                for k, x in enumerate(inputs)
            ),
            values=tuple(values[:, k].reshape(shape) for k in range(len(self.outputs))),
            firing=firing.reshape(*shape, -1),
            memberships={v.name: part for v, part in zip(self.inputs, parts, strict=True)},
            strengths=strengths.reshape(*shape, len(slots)),
            slots=slots,
        )

    def uncovered(self, n: int = 41, below: float = 0.0) -> Gaps:
        """Points of a grid with n points a side where no rule fires stronger than `below`, and what is missing.

        Raises ValueError where the grid would be too large or the input box has no end.
        """
        points = grid(self.inputs, n)
        names, degrees = combinations(self.inputs)
        weak = self._silent(points, _EMPTY) <= below
        anywhere = np.zeros((len(names), len(self.inputs)))
        missing = np.flatnonzero(self._silent(anywhere, degrees) <= below)
        return Gaps(
            inputs=tuple(v.name for v in self.inputs),
            points=points[weak],
            total=len(points),
            missing=tuple(names[k] for k in missing),
        )

    def _evidence(self, points: Array, degrees: Array, before: Array) -> tuple[Array, Array, Array, Array]:
        """Values, memberships, firing and strengths of the sets at points (n, n_inputs), one row each."""
        compiled = self._compiled()
        ends = np.cumsum([compiled.n_terms, compiled.n_rules, len(compiled.slots)])
        values, evidence = np.empty((len(points), len(self.outputs))), np.empty((len(points), ends[-1]))
        run(points, degrees, before, compiled.tables, values, evidence)
        memberships, firing, strengths = np.split(evidence, ends[:-1], axis=1)
        return values, memberships, firing, strengths

    def _silent(self, points: Array, degrees: Array) -> Array:
        """Strength (n,) of the strongest rule for the output that hears least."""
        strengths = self._evidence(points, degrees, _EMPTY)[3]
        heard = np.zeros((len(self.outputs), len(points)))
        for k, slot in enumerate(self._compiled().slots):
            heard[slot.output] = np.maximum(heard[slot.output], strengths[:, k])
        least: Array = heard.min(axis=0)
        return least

    def with_inference(self, method: str) -> FuzzySystem:
        """The same knowledge under "max-min", "max-product" or "sum-product" inference.

        Raises ValueError for another method.
        """
        if method not in INFERENCE:
            raise ValueError(f"unknown inference {method!r}; known: {', '.join(INFERENCE)}")
        conjunction, implication, aggregation = INFERENCE[method]
        blocks = tuple(replace(b, conjunction=conjunction, implication=implication) for b in self.blocks)
        outputs = tuple(v if v.defuzzifier in WEIGHTED else replace(v, aggregation=aggregation) for v in self.outputs)
        return replace(self, blocks=blocks, outputs=outputs)

    def with_terms(self, changed: Mapping[tuple[str, str], Sequence[float]]) -> FuzzySystem:
        """The same knowledge with other parameters for the terms named by (variable, term); shapes and heights stay.

        Raises ValueError for an unknown variable or term, or parameters that do not fit the shape.

        >>> x = Variable(name="x", low=0, high=4, terms=(Term(name="Low", shape="triangle", parameters=(0, 0, 4)),))
        >>> rules = RuleBlock(rules=("if x is Low then y is Low",))
        >>> system = FuzzySystem(name="s", inputs=(x,), outputs=(replace(x, name="y"),), blocks=(rules,))
        >>> system.with_terms({("x", "Low"): (0, 0, 2)}).inputs[0].fuzzify(1.0).tolist()
        [0.5]
        """
        variables = {v.name: v for v in (*self.inputs, *self.outputs)}
        for key, parameters in changed.items():
            if not (isinstance(key, tuple) and len(key) == 2):
                raise ValueError(f"a term is named by (variable, term), got {key!r}")
            name, term = key
            if name not in variables:
                raise ValueError(f"{self.name!r} has no variable {name!r}; known: {', '.join(variables)}")
            variables[name] = variables[name].with_term(term, parameters)
        inputs, outputs = (tuple(variables[v.name] for v in part) for part in (self.inputs, self.outputs))
        return replace(self, inputs=inputs, outputs=outputs)

    @property
    def tables(self) -> Tables:
        """The system as compiled code takes it: for `engine.infer_one` inside a kernel."""
        return self._compiled().tables

    def _compiled(self) -> Compiled:
        if "compiled" not in self._cache:
            self._cache["compiled"] = compile_system(self.inputs, self.outputs, self.blocks)
        found: Compiled = self._cache["compiled"]
        return found

    def _points(self, inputs: tuple[Any, ...]) -> tuple[Array, tuple[int, ...]]:
        """Inputs as points (n, n_inputs), and the shape that they broadcast to."""
        if len(inputs) != len(self.inputs):
            names = ", ".join(v.name for v in self.inputs)
            raise ValueError(f"{self.name!r} takes {len(self.inputs)} inputs ({names}), got {len(inputs)}")
        try:
            points = np.array(inputs, dtype=float)
        except (TypeError, ValueError):
            points = self._broadcast(inputs)
        if points.ndim == 1:
            return points[None, :], ()
        return np.ascontiguousarray(points.reshape(len(inputs), -1).T), points.shape[1:]

    def _broadcast(self, inputs: tuple[Any, ...]) -> Array:
        """Inputs of several shapes as one array. Raises ValueError that names the input at fault."""
        arrays = []
        for variable, x in zip(self.inputs, inputs, strict=True):
            try:
                arrays.append(np.asarray(x, dtype=float))
            except (TypeError, ValueError):
                raise ValueError(
                    f"input {variable.name!r} must be a number or an array of numbers, got {x!r}"
                ) from None
        try:
            return np.stack(np.broadcast_arrays(*arrays))
        except ValueError:
            shapes = ", ".join(f"{v.name} {a.shape}" for v, a in zip(self.inputs, arrays, strict=True))
            raise ValueError(f"the inputs do not broadcast to one shape: {shapes}") from None

    def _previous(self, previous: ArrayLike, shape: tuple[int, ...]) -> Array:
        """Previous answers as an array (n, n_outputs)."""
        if not any(v.lock_previous for v in self.outputs):
            raise ValueError(f"{self.name!r} has no output that locks its previous value, so previous= has no effect")
        given = (previous,) if np.ndim(previous) == 0 else tuple(previous)  # type: ignore[arg-type]
        if len(given) != len(self.outputs):
            raise ValueError(f"previous= needs one value for each of {len(self.outputs)} outputs, got {len(given)}")
        return np.stack([np.broadcast_to(np.asarray(x, dtype=float), shape).reshape(-1) for x in given], axis=-1)

    def _degrees(self, inputs: tuple[Any, ...], points: Array, norm: str) -> Array:
        """Memberships (n, n_input_terms) of crisp readings and of readings that are sets."""
        columns = []
        for k, (variable, reading) in enumerate(zip(self.inputs, inputs, strict=True)):
            if isinstance(reading, Term):
                x = places(reading, variable.low, variable.high)
                row = match(variable.fuzzify(x).T, reading.membership(x), norm)
                columns.append(np.broadcast_to(row, (len(points), len(row))))
            else:
                columns.append(variable.fuzzify(points[:, k]))
        return np.ascontiguousarray(np.concatenate(columns, axis=1))


def _middle(variable: Variable, reading: Term) -> float:
    """Mean of maximum of an uncertain reading over the range of its variable."""
    x = places(reading, variable.low, variable.high)
    return float(mean_of_maximum(x, reading.membership(x)))


def _check_linear(output: Variable, n_inputs: int) -> None:
    """Raise ValueError unless each linear term has a coefficient for each input, and a constant."""
    for term in output.terms:
        if term.shape == "linear" and len(term.parameters) != n_inputs + 1:
            raise ValueError(
                f"output {output.name!r}: linear term {term.name!r} needs {n_inputs} coefficients and a constant, "
                f"got {len(term.parameters)} numbers"
            )


def _check_exact(outputs: tuple[Variable, ...], blocks: tuple[RuleBlock, ...]) -> None:
    """Raise ValueError unless the sets of exact outputs are clipped or scaled, and so stay made of straight lines."""
    exact = {v.name for v in outputs if v.quadrature == "exact" and v.defuzzifier not in WEIGHTED}
    for block in blocks:
        concluded = {c.variable for rule in block.rules for c in rule.consequents}
        if block.implication not in ("min", "product") and not exact.isdisjoint(concluded):
            raise ValueError(
                f"rule block {block.name!r}: quadrature 'exact' is for implication min or product, got "
                f"{block.implication!r}"
            )


def check_rule(rule: Rule, inputs: tuple[Variable, ...], outputs: tuple[Variable, ...]) -> None:
    """Raise ValueError unless the rule speaks of known inputs, outputs and terms."""
    for proposition in propositions(rule.antecedent):
        _check(proposition, inputs, "input", rule)
    for proposition in rule.consequents:
        _check(proposition, outputs, "output", rule)


def _check(proposition: Proposition, variables: tuple[Variable, ...], role: str, rule: Rule) -> None:
    """Raise ValueError unless the proposition speaks of a known variable and term."""
    for variable in variables:
        if variable.name == proposition.variable:
            terms = [term.name for term in variable.terms]
            if proposition.term and proposition.term not in terms:
                raise ValueError(
                    f"rule '{rule}': {role} {variable.name!r} has no term {proposition.term!r}; "
                    f"known: {', '.join(terms)}"
                )
            return
    known = ", ".join(variable.name for variable in variables)
    raise ValueError(f"rule '{rule}': no {role} is called {proposition.variable!r}; known: {known}")
