"""Linguistic variables and rule blocks: the data base and the rule base of a fuzzy system."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, fields, replace
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.fuzzy import codes
from fuzzynav.fuzzy.membership import LARGEST, MONOTONE, POLYGONAL, Term
from fuzzynav.fuzzy.names import check_name
from fuzzynav.fuzzy.operators import CONORMS, NORMS
from fuzzynav.fuzzy.rules import Rule
from fuzzynav.geometry import Array

__all__ = [
    "DEFUZZIFIERS",
    "MAX_RESOLUTION",
    "MAX_SAMPLES",
    "QUADRATURES",
    "WEIGHTED",
    "Defuzzifier",
    "RuleBlock",
    "Variable",
    "tuple_of",
]  # fmt: skip

_T = TypeVar("_T")


@dataclass(frozen=True, slots=True)
class Defuzzifier:
    """A way from a fuzzy output to a number: its number in the compiled kernels, its words in the file formats."""

    code: int
    fll: str
    fis: str


DEFUZZIFIERS: dict[str, Defuzzifier] = {
    "centroid": Defuzzifier(codes.CENTROID, "Centroid", "centroid"),
    "bisector": Defuzzifier(codes.BISECTOR, "Bisector", "bisector"),
    "mean of maximum": Defuzzifier(codes.MEAN_OF_MAXIMUM, "MeanOfMaximum", "mom"),
    "smallest of maximum": Defuzzifier(codes.SMALLEST_OF_MAXIMUM, "SmallestOfMaximum", "som"),
    "largest of maximum": Defuzzifier(codes.LARGEST_OF_MAXIMUM, "LargestOfMaximum", "lom"),
    "weighted average": Defuzzifier(codes.WEIGHTED_AVERAGE, "WeightedAverage", "wtaver"),
    "weighted sum": Defuzzifier(codes.WEIGHTED_SUM, "WeightedSum", "wtsum"),
}
"""Ways from a fuzzy output to a number, by name."""

WEIGHTED = frozenset({"weighted average", "weighted sum"})
"""The defuzzifiers of Takagi-Sugeno systems: no sampling, one number for each rule."""

QUADRATURES: dict[str, int] = {
    "trapezoid": codes.TRAPEZOID_RULE, "midpoint": codes.MIDPOINTS, "sum": codes.PLAIN_SUM, "exact": codes.EXACT,
}  # fmt: skip
"""How the integrals of the centroid are taken from the samples: names and numbers in the compiled kernels."""

MAX_RESOLUTION = 100_000
"""Largest number of samples of an output."""

MAX_SAMPLES = 10_000_000
"""Largest number of samples of all sets of an output together, which take 80 MB."""


def _one_of(value: object, known: Collection[str], what: str) -> None:
    """Raise ValueError that names `what` and lists the known words unless the value is one of them."""
    if not isinstance(value, str) or value not in known:
        raise ValueError(f"{what}: got {value!r}; known: {', '.join(known)}")


def tuple_of(values: Iterable[_T], kind: type[_T], what: str) -> tuple[_T, ...]:
    """The values as a tuple. Raises ValueError that names `what` unless each is of that kind."""
    if not isinstance(values, Iterable) or isinstance(values, str):
        raise ValueError(f"{what}: expected a tuple of {kind.__name__}, got {values!r}")
    found = tuple(values)
    for value in found:
        if not isinstance(value, kind):
            raise ValueError(f"{what}: expected a tuple of {kind.__name__}, got one with {value!r}")
    return found


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Variable:
    """A linguistic variable: a name, a range [low, high] in `unit`, and its terms.

    An input that only linear conclusions use needs no terms.

    The fields from `aggregation` on matter for outputs only. `aggregation` None becomes "max", or "sum" with a weighted
    defuzzifier. `resolution` is the number of samples of the range: both ends included ("trapezoid", "sum") or the
    middles of as many equal cells ("midpoint"). `default` is the answer where no rule fires. `lock_range` clips an
    input, or the answer of an output, to the range. `lock_previous` lets an output keep the value that the call was
    given as `previous` where no rule fires.

    Raises ValueError with the name of the variable and of the field at fault.
    """

    name: str
    low: float
    high: float
    terms: tuple[Term, ...]
    unit: str = ""
    lock_range: bool = False
    aggregation: str | None = None
    defuzzifier: str = "centroid"
    resolution: int = 101
    quadrature: str = "trapezoid"
    default: float = math.nan
    lock_previous: bool = False

    def __post_init__(self) -> None:
        check_name(self.name, "variable")
        here = f"variable {self.name!r}"
        object.__setattr__(self, "terms", tuple_of(self.terms, Term, f"{here}, terms"))
        for name in ("low", "high", "default"):
            try:
                value = float(getattr(self, name))
            except (TypeError, ValueError):
                raise ValueError(f"{here}: {name} must be a number, got {getattr(self, name)!r}") from None
            object.__setattr__(self, name, math.nan if math.isnan(value) else value)
        _one_of(self.defuzzifier, DEFUZZIFIERS, f"{here}, defuzzifier")
        if self.aggregation is None:
            object.__setattr__(self, "aggregation", "sum" if self.defuzzifier in WEIGHTED else "max")
        _one_of(self.aggregation, CONORMS, f"{here}, aggregation")
        _one_of(self.quadrature, QUADRATURES, f"{here}, quadrature")
        if not self.low < self.high:
            raise ValueError(f"{here}: the range must have low < high, got {self.low:g} to {self.high:g}")
        ends = [v for v in (self.low, self.high) if LARGEST < abs(v) < math.inf]
        if ends:
            raise ValueError(f"{here}: the range must stay within -{LARGEST:g} to {LARGEST:g}, got {ends[0]:g}")
        names = [term.name for term in self.terms]
        if len(set(names)) < len(names):
            raise ValueError(f"{here}: two terms have one name: {', '.join(names)}")
        if type(self.resolution) is not int or not 2 <= self.resolution <= MAX_RESOLUTION:
            raise ValueError(
                f"{here}: resolution must be a whole number from 2 to {MAX_RESOLUTION}, got {self.resolution!r}"
            )

    def _key(self) -> tuple[object, ...]:
        """The fields, with a nan default as None, so that two unset defaults are equal."""
        values = (getattr(self, field.name) for field in fields(self))
        return tuple(None if isinstance(v, float) and math.isnan(v) else v for v in values)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Variable) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def term(self, name: str) -> Term:
        """The term of that name. Raises ValueError that lists the known ones."""
        for term in self.terms:
            if term.name == name:
                return term
        known = ", ".join(t.name for t in self.terms) or "none"
        raise ValueError(f"variable {self.name!r} has no term {name!r}; known: {known}")

    def with_term(self, name: str, parameters: Sequence[float]) -> Variable:
        """The same variable with other parameters for one term. Raises ValueError as `Term` does."""
        old = self.term(name)
        if not isinstance(parameters, Iterable) or isinstance(parameters, str):
            raise ValueError(
                f"variable {self.name!r}: term {name!r}: parameters must be a list of numbers, got {parameters!r}"
            )
        try:
            new = replace(old, parameters=tuple(parameters))
        except ValueError as error:
            raise ValueError(f"variable {self.name!r}: {error}") from None
        return replace(self, terms=tuple(new if term is old else term for term in self.terms))

    def fuzzify(self, x: ArrayLike) -> Array:
        """Membership of the values x (...) in each term: (..., n_terms). nan stays nan.

        >>> from fuzzynav.fuzzy.membership import Term
        >>> near = Term(name="Near", shape="triangle", parameters=(0, 0, 4))
        >>> Variable(name="Distance", low=0, high=4, terms=(near,), unit="m").fuzzify(1.0).tolist()
        [0.75]
        """
        values = np.asarray(x, dtype=float)
        if self.lock_range:
            values = np.clip(values, self.low, self.high)
        degrees = np.empty((*values.shape, len(self.terms)))
        for k, term in enumerate(self.terms):
            degrees[..., k] = term.membership(values)
        return degrees

    def samples(self) -> Array:
        """The points (resolution,) at which an output is sampled."""
        n = int(self.resolution)
        if self.quadrature == "midpoint":
            return self.low + (np.arange(n) + 0.5) * (self.high - self.low) / n
        return np.linspace(self.low, self.high, n)

    def check_input(self) -> None:
        """Raise ValueError if a term has no membership of its own."""
        for term in self.terms:
            if term.shape in ("constant", "linear"):
                raise ValueError(
                    f"input {self.name!r}: term {term.name!r} ({term.shape}) is a conclusion and has no membership; "
                    "use a shape such as triangle"
                )

    def check_output(self) -> None:
        """Raise ValueError if the terms do not fit the defuzzifier, vanish between the samples or need too many."""
        here = f"output {self.name!r}"
        if not self.terms:
            raise ValueError(f"{here} has no terms: an output needs at least one")
        if self.defuzzifier in WEIGHTED:
            self._check_weighted(here)
            return
        if not (math.isfinite(self.low) and math.isfinite(self.high)):
            raise ValueError(f"{here}: {self.defuzzifier} needs a finite range, got {self.low:g} to {self.high:g}")
        if len(self.terms) * self.resolution > MAX_SAMPLES:
            raise ValueError(
                f"{here}: {len(self.terms)} terms of {self.resolution} samples are more than {MAX_SAMPLES}; lower the "
                "resolution"
            )
        if self.quadrature == "exact":
            self._check_exact(here)
        for term in self.terms:
            if term.shape in ("constant", "linear", "singleton"):
                raise ValueError(f"{here}: term {term.name!r} ({term.shape}) has no area; use weighted average or sum")
            if self.quadrature != "exact":
                self._check_sampled(here, term)

    def _check_weighted(self, here: str) -> None:
        for term in self.terms:
            if term.shape not in MONOTONE | {"constant", "linear", "singleton"}:
                raise ValueError(
                    f"{here}: {self.defuzzifier} cannot use term {term.name!r} ({term.shape}); it takes constant, "
                    f"linear, singleton, or a shape that only rises or falls: {', '.join(sorted(MONOTONE))}"
                )
            if term.shape == "sigmoid" and term.parameters[1] == 0.0:
                raise ValueError(
                    f"{here}: {self.defuzzifier} cannot use term {term.name!r}: a sigmoid of slope 0 neither rises "
                    "nor falls"
                )

    def _check_exact(self, here: str) -> None:
        if self.defuzzifier != "centroid" or self.aggregation not in ("max", "sum"):
            raise ValueError(f"{here}: quadrature 'exact' is for the centroid with aggregation max or sum")
        for term in self.terms:
            if term.shape not in POLYGONAL:
                raise ValueError(
                    f"{here}: quadrature 'exact' needs terms of straight lines; {term.name!r} is {term.shape}: "
                    "choose trapezoid"
                )

    def _check_sampled(self, here: str, term: Term) -> None:
        finite = [v for v in term.parameters if self.low <= v <= self.high]
        fine = np.concatenate([np.linspace(self.low, self.high, 10 * int(self.resolution)), finite])
        if not (term.membership(self.samples()) > 0.0).any() and (term.membership(fine) > 0.0).any():
            raise ValueError(
                f"{here}: term {term.name!r} lies between two samples and would vanish; raise resolution "
                f"above {self.resolution}"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleBlock:
    """Rules that share their operators. Raises ValueError for an empty block or an unknown operator."""

    rules: tuple[Rule, ...]
    name: str = ""
    conjunction: str = "min"
    disjunction: str = "max"
    implication: str = "min"
    activation: str = "general"

    def __post_init__(self) -> None:
        here = f"rule block {self.name!r}"
        if not isinstance(self.rules, Iterable) or isinstance(self.rules, str):
            raise ValueError(f"{here}: expected a tuple of Rule objects or rule texts, got {self.rules!r}")
        rules = tuple(Rule.parse(rule) if isinstance(rule, str) else rule for rule in self.rules)
        object.__setattr__(self, "rules", rules)
        if not rules:
            raise ValueError(f"{here} has no rules: a fuzzy system needs at least one")
        for rule in rules:
            if not isinstance(rule, Rule):
                raise ValueError(f"{here}: expected Rule objects or rule texts, got {rule!r}")
        _one_of(self.conjunction, NORMS, f"{here}, conjunction")
        _one_of(self.disjunction, CONORMS, f"{here}, disjunction")
        _one_of(self.implication, NORMS, f"{here}, implication")
        if self.activation != "general":
            raise ValueError(f"{here}: activation {self.activation!r} is not supported; use general")
