"""A rule base for the weights tuned by evolution, started from the best fixed weights, judged on maps it has not seen.

Twelve rules (2 headings x 3 distances x 2 speeds), each with three constant weights: with all rules alike it is a fixed
set of weights, so that the tuned base can do everything the fixed one can.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from fuzzynav.data import folder
from fuzzynav.dwa.fast import tables_of
from fuzzynav.dwa.steps import Params
from fuzzynav.evolve import minimise
from fuzzynav.fuzzy import FuzzySystem, Rule, Variable
from fuzzynav.fuzzy.membership import Term
from fuzzynav.fuzzy.variable import RuleBlock
from fuzzynav.geometry import Array
from fuzzynav.studies.dwa.comparison import DENSITIES, TRAINING, best_fixed, mean_score

__all__ = ["VALIDATION", "generations", "save_best", "score_generation", "start_vector", "system_of"]

VALIDATION = tuple(f"{density}/{seed}" for density in DENSITIES for seed in range(20000, 20050))
GENERATIONS = 32
TERMS = {"headGoal": ("Little", "Lots"), "distObs": ("Close", "Medium", "Far"), "velRob": ("Slow", "Fast")}
TOPS = {"headGoal": 180.0, "distObs": 15.0, "velRob": 1.0}
KNOTS = np.array([30.0, 90.0, 0.5, 1.5, 3.0, 0.2, 0.7])  # where the sets begin to fall and to rise
SPREAD = np.array([10.0, 20.0, 0.2, 0.4, 0.8, 0.1, 0.2])
OUT = folder("fuzzy") / "ours_dwa_tuned.fll"


def start_vector(weights: ArrayLike) -> Array:
    """The vector (31,) of a rule base that answers fixed weights everywhere."""
    w = np.maximum(np.asarray(weights, dtype=float), 0.01)
    return np.concatenate([np.zeros(7), np.tile(np.log(w[:2] / w[2]), 12)])


def system_of(vector: ArrayLike, name: str = "ours_dwa_tuned") -> FuzzySystem:
    """The rule base that a vector (31,) stands for: seven knots, then two log ratios for each of twelve rules."""
    x = np.asarray(vector, dtype=float)
    h1, h2, d1, d2, d3, v1, v2 = _knots(x[:7])
    sets = {
        "headGoal": ((0, 0, h1, h2), (h1, h2, 180, 180)),
        "distObs": ((0, 0, d1, d2), (d1, d2, d2, d3), (d2, d3, 15, 15)),
        "velRob": ((0, 0, v1, v2), (v1, v2, 1, 1)),
    }
    ratios = np.exp(np.clip(np.column_stack([x[7:].reshape(12, 2), np.zeros(12)]), -6, 6))
    weights = np.round(ratios / ratios.sum(axis=1, keepdims=True), 4)
    block = RuleBlock(rules=_rules(), name="tuned", conjunction="product")
    return FuzzySystem(
        name=name,
        inputs=_inputs(sets),
        outputs=_outputs(weights),
        blocks=(block,),
        source="ours",
        description="weights of the dynamic window, tuned by evolution on random maps",
    )


def _inputs(sets: Mapping[str, Sequence[tuple[float, ...]]]) -> tuple[Variable, ...]:
    """The three inputs with trapezoids at these corners."""
    return tuple(
        Variable(
            name=n,
            low=0.0,
            high=TOPS[n],
            lock_range=True,
            terms=tuple(
                Term(name=term, shape="trapezoid", parameters=p) for term, p in zip(TERMS[n], sets[n], strict=True)
            ),
        )
        for n in sets
    )


def _outputs(weights: Array) -> tuple[Variable, ...]:
    """The three weights, each with twelve constants."""
    return tuple(
        Variable(
            name=n,
            low=0.0,
            high=1.0,
            defuzzifier="weighted average",
            terms=tuple(
                Term(name=f"r{r + 1}", shape="constant", parameters=(float(weights[r, k]),)) for r in range(12)
            ),
        )
        for k, n in enumerate(("alpha", "beta", "gamma"))
    )


def _knots(raw: Array) -> Array:
    """Knots in order inside their ranges, rounded so that the file and the search agree."""
    k = KNOTS + SPREAD * raw
    groups = (k[:2], 1.0, 179.0, 1.0), (k[2:5], 0.02, 14.0, 0.02), (k[5:], 0.01, 0.99, 0.01)
    ordered = []
    for values, low, high, gap in groups:
        inside = np.sort(np.clip(values, low, high))
        for i in range(1, len(inside)):
            inside[i] = max(inside[i], inside[i - 1] + gap)
        ordered.append(inside)
    return np.asarray(np.round(np.concatenate(ordered), 3), dtype=float)


def _rules() -> tuple[Rule, ...]:
    """All combinations of terms, each with its own constants."""
    combinations = [(h, d, v) for h in TERMS["headGoal"] for d in TERMS["distObs"] for v in TERMS["velRob"]]
    return tuple(
        Rule.parse(
            f"if headGoal is {h} and distObs is {d} and velRob is {v} then alpha is r{k} and beta is r{k} "
            f"and gamma is r{k}"
        )
        for k, (h, d, v) in enumerate(combinations, start=1)
    )


def score_generation(case: str) -> dict[str, float]:
    """Training and validation score of one generation's mean; the case is its number and its vector."""
    number, _, text = case.partition(":")
    vector = np.array([float(x) for x in text.split()])
    base = Params(weights=best_fixed())
    rules = tables_of(system_of(vector))
    train, held = mean_score(base, rules, TRAINING), mean_score(base, rules, VALIDATION)
    return {
        "generation": int(number),
        "time": train["time"],
        "success": train["success"],
        "held_time": held["time"],
        "held_success": held["success"],
    }


def generations() -> tuple[str, ...]:
    """Every fourth generation of the evolution on the training maps, as cases; it takes minutes."""
    best = best_fixed()
    base = Params(weights=best)

    def cost(vector: Array) -> float:
        return mean_score(base, tables_of(system_of(vector)), TRAINING)["time"]

    means = minimise(cost, start_vector(best), 0.5, GENERATIONS)
    return tuple(f"{k}:" + " ".join(f"{x:.5f}" for x in mean) for k, mean in enumerate(means))[::4]


def save_best(table: pd.DataFrame) -> None:
    """Write the generation that is best on the validation maps to data/fuzzy/ours_dwa_tuned.fll."""
    winner = str(table.sort_values(["held_time", "generation"])["case"].iloc[0])
    system_of(np.array([float(x) for x in winner.partition(":")[2].split()])).save(OUT)
