"""Where a rule base is silent."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from fuzzynav.fuzzy.variable import Variable
from fuzzynav.geometry import Array

__all__ = ["Gaps", "combinations", "grid"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Gaps:
    """Points (m, n_inputs) of the input box where some output hears no rule, of `total` points that were tried.

    `missing` are the combinations of input terms, by name, that no rule covers even where they hold wholly.
    """

    inputs: tuple[str, ...]
    points: Array
    total: int
    missing: tuple[tuple[str, ...], ...]

    def __len__(self) -> int:
        return len(self.points)

    @property
    def fraction(self) -> float:
        """Part of the tried points at which no rule fires."""
        return len(self.points) / self.total

    def __str__(self) -> str:
        if not len(self) and not self.missing:
            return f"every one of {self.total} points is covered"
        names = " x ".join(self.inputs)
        rows = "; ".join(", ".join(row) for row in self.missing)
        return f"{len(self)} of {self.total} points ({100.0 * self.fraction:.1f} %) uncovered; missing {names}: {rows}"


def grid(inputs: tuple[Variable, ...], n: int) -> Array:
    """All points (n ** n_inputs, n_inputs) of a regular grid over the input box, ends included.

    Raises ValueError for less than 2 points a side, an endless range, or more than 5 million points.
    """
    if n < 2 or n ** len(inputs) > 5_000_000:
        raise ValueError(f"n must be at least 2 and n ** {len(inputs)} at most 5000000, got n = {n}")
    for variable in inputs:
        if not np.isfinite([variable.low, variable.high]).all():
            raise ValueError(f"input {variable.name!r} has no finite range, so its gaps cannot be listed")
    axes = [np.linspace(variable.low, variable.high, n) for variable in inputs]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(inputs))


def combinations(inputs: tuple[Variable, ...]) -> tuple[list[tuple[str, ...]], Array]:
    """Every choice of one term for each input, by name, and as degrees (m, n_terms): 1 for the chosen, 0 elsewhere.

    Inputs without terms, which only linear conclusions use, offer no choice. Raises ValueError for more than 200,000
    choices.
    """
    inputs = tuple(variable for variable in inputs if variable.terms)
    count = int(np.prod([len(variable.terms) for variable in inputs], dtype=float))
    if count > 200_000:
        raise ValueError(f"{count} combinations of terms are too many to list")
    names = list(product(*([term.name for term in variable.terms] for variable in inputs)))
    blocks = np.meshgrid(*(np.arange(len(v.terms)) for v in inputs), indexing="ij")
    rows = [np.eye(len(v.terms))[block.ravel()] for v, block in zip(inputs, blocks, strict=True)]
    return names, np.concatenate([np.empty((count, 0)), *rows], axis=1)
