"""`FuzzySystem`: inputs, outputs and rules, ready to be called."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fuzzynav.fuzzy.membership import Term
from fuzzynav.fuzzy.rules import Proposition, Rule, propositions
from fuzzynav.fuzzy.variable import RuleBlock, Variable

__all__ = ["FuzzySystem", "Rule", "RuleBlock", "Term", "Variable"]


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

    def __post_init__(self) -> None:
        for part in ("inputs", "outputs", "blocks"):
            object.__setattr__(self, part, tuple(getattr(self, part)))
        if not self.inputs or not self.outputs:
            raise ValueError(f"fuzzy system {self.name!r} needs at least one input and one output")
        if not self.blocks:
            raise ValueError(f"fuzzy system {self.name!r} has an empty rule base")
        names = [v.name for v in (*self.inputs, *self.outputs)]
        if len(set(names)) < len(names):
            raise ValueError(f"fuzzy system {self.name!r}: two variables have one name: {', '.join(names)}")
        for output in self.outputs:
            output.check_output()
            for term in output.terms:
                if term.shape == "linear" and len(term.parameters) != len(self.inputs) + 1:
                    raise ValueError(
                        f"output {output.name!r}: linear term {term.name!r} needs {len(self.inputs)} coefficients and "
                        f"a constant, got {len(term.parameters)} numbers"
                    )
        for rule in self.rules:
            for proposition in propositions(rule.antecedent):
                _check(proposition, self.inputs, "input", rule)
            for proposition in rule.consequents:
                _check(proposition, self.outputs, "output", rule)

    @property
    def rules(self) -> tuple[Rule, ...]:
        """All rules, block after block: the order of `Inference.firing`."""
        return tuple(rule for block in self.blocks for rule in block.rules)

    @classmethod
    def load(cls, path: str | Path) -> FuzzySystem:
        """System read from a .fll or MATLAB .fis file."""
        from fuzzynav.fuzzy.files import load

        return load(path)

    def save(self, path: str | Path) -> None:
        """Write the system to a .fll or MATLAB .fis file."""
        from fuzzynav.fuzzy.files import save

        save(self, path)

    def to_skfuzzy(self) -> Any:
        """The same system as a scikit-fuzzy ControlSystem."""
        from fuzzynav.fuzzy.exchange import to_skfuzzy

        return to_skfuzzy(self)

    @classmethod
    def from_skfuzzy(cls, control_system: Any, name: str = "from_skfuzzy") -> FuzzySystem:
        """The system that a scikit-fuzzy ControlSystem describes."""
        from fuzzynav.fuzzy.exchange import from_skfuzzy

        return from_skfuzzy(control_system, name)


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
