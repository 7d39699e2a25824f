"""`Inference`: what a fuzzy system concluded and why."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from typing import NamedTuple

import numpy as np

from fuzzynav.fuzzy.compiled import Slot
from fuzzynav.fuzzy.operators import conjunction, disjunction
from fuzzynav.fuzzy.rules import Rule
from fuzzynav.fuzzy.variable import WEIGHTED, Variable
from fuzzynav.geometry import Array

__all__ = ["Inference", "SampledSet"]


class SampledSet(NamedTuple):
    """A fuzzy set by its samples: places x (n,) and memberships mu (..., n)."""

    x: Array
    mu: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Inference:
    """The answers of a system with the evidence for them; (...) is the common shape of the inputs.

    `values` holds one array (...) for each output, in order; `firing` (..., n_rules) every rule's strength;
    `memberships` each input's degrees (..., n_terms) by name; `strengths` (..., n_sets) the strength of each concluded
    set of `slots`.
    """

    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    rules: tuple[Rule, ...]
    readings: tuple[Array | str, ...]
    values: tuple[Array, ...]
    firing: Array
    memberships: dict[str, Array]
    strengths: Array
    slots: tuple[Slot, ...]

    def conclusions(self, output: str) -> dict[str, Array]:
        """Strength (...) of each term of an output, the greatest over its rules. Raises ValueError for a wrong name."""
        o = self._number(output)
        result = {term.name: np.zeros(self.firing.shape[:-1]) for term in self.outputs[o].terms}
        for k, slot in enumerate(self.slots):
            if slot.output == o:
                name = self.outputs[o].terms[slot.term].name
                result[name] = np.maximum(result[name], self.strengths[..., k])
        return result

    def clipped(self, output: str) -> tuple[SampledSet, ...]:
        """Each concluded set of an output after the implication. Raises ValueError for a weighted output."""
        o = self._number(output)
        variable = self.outputs[o]
        if variable.defuzzifier in WEIGHTED:
            raise ValueError(f"output {output!r} is a {variable.defuzzifier}: it has no sets")
        x = variable.samples()
        sets = []
        for k, slot in enumerate(self.slots):
            if slot.output == o:
                term = variable.terms[slot.term].membership(x)
                sets.append(SampledSet(x, conjunction(self.strengths[..., k, None], term, slot.implication)))
        return tuple(sets)

    @property
    def aggregated(self) -> dict[str, SampledSet]:
        """The joined set of every Mamdani output, by name, at the samples of its range."""
        return {v.name: self._joined(v) for v in self.outputs if v.defuzzifier not in WEIGHTED}

    def _joined(self, variable: Variable) -> SampledSet:
        x = variable.samples()
        empty = np.zeros((*self.firing.shape[:-1], x.size))
        parts = [part.mu for part in self.clipped(variable.name)]
        return SampledSet(x, reduce(lambda a, b: disjunction(a, b, str(variable.aggregation)), parts, empty))

    def _number(self, output: str) -> int:
        names = [variable.name for variable in self.outputs]
        if output not in names:
            raise ValueError(f"no output is called {output!r}; known: {', '.join(names)}")
        return names.index(output)

    def explain(self, rules: int = 3) -> str:
        """The inference at one point in sentences: memberships, the strongest rules, the answers.

        Raises ValueError if the inputs were arrays.
        """
        if self.firing.ndim != 1:
            raise ValueError(f"explain speaks of one point, but the inputs have shape {self.firing.shape[:-1]}")
        lines = [self._reading(k) for k in range(len(self.inputs))]
        order = [r for r in np.argsort(-self.firing, kind="stable") if self.firing[r] > 0.0]
        lines += [f"Rule {r + 1} fires with {self.firing[r]:.3f}: {self.rules[r]}." for r in order[:rules]]
        if len(order) > rules:
            more, top = len(order) - rules, f"{self.firing[order[rules]]:.3f}"
            lines.append(
                f"{more} more rules fire, each with at most {top}." if more > 1 else f"One more rule fires, with {top}."
            )
        if not order:
            lines.append("No rule fires.")
        return "\n".join(lines + [self._answer(k) for k in range(len(self.outputs))])

    def _reading(self, k: int) -> str:
        variable, reading = self.inputs[k], self.readings[k]
        value = reading if isinstance(reading, str) else f"{float(reading):g}"
        degrees = self.memberships[variable.name]
        found = [f"{t.name} to {m:.3f}" for t, m in zip(variable.terms, degrees, strict=True) if m >= 0.0005]
        return f"{' '.join([variable.name, '=', value, variable.unit]).strip()} is {', '.join(found) or 'in no term'}."

    def _answer(self, k: int) -> str:
        variable, value = self.outputs[k], float(self.values[k])
        strengths = self.conclusions(variable.name)
        sets = ", ".join(f"{name} to {float(m):.3f}" for name, m in strengths.items() if m > 0.0)
        number = " ".join([f"{value:.3f}", variable.unit]).strip()
        if not sets:
            return f"{variable.name} = {number}: no rule speaks of it here, so this is its stated default."
        return f"{variable.name} is {sets}; its {variable.defuzzifier} is {number}."
