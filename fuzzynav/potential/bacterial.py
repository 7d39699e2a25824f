"""The pseudo-bacterial potential field: gains of attraction and repulsion sought anew for every scene.

Source: Orozco-Rosas, Montiel, Sepulveda 2015. What their text leaves open is ours: a walk that does not reach the
goal costs a fixed length and what it still lacks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.checks import positive, share
from fuzzynav.geometry import Array
from fuzzynav.potential.fields import IMPROVED, Gains
from fuzzynav.potential.walks import Steps, Walk, walk

__all__ = ["Bacterial", "Found", "bacterial_field"]

Cost = Callable[[Array], float]
FAILED = 1000.0  # [m] that a walk costs which does not reach the goal


@dataclass(frozen=True, slots=True, kw_only=True)
class Bacterial:
    """Size and chances of the search. Raises ValueError for counts below 1, empty ranges and shares out of range."""

    population: int = 8
    generations: int = 5
    clones: int = 4
    survivors: float = 0.5  # share of the best that are kept
    attract: tuple[float, float] = (0.1, 10.0)
    repel: tuple[float, float] = (0.01, 50.0)

    def __post_init__(self) -> None:
        if min(self.population, self.generations, self.clones) < 1:
            raise ValueError(f"population, generations and clones must be 1 or more, got {self}")
        share(survivors=self.survivors)
        for name in ("attract", "repel"):
            low, high = getattr(self, name)
            positive(**{name: low})
            if not low < high < np.inf:
                raise ValueError(f"{name} must be a range of two rising gains, got {(low, high)}")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """The best gains, their walk, and the least cost after every generation `(generations + 1,)`."""

    gains: Gains
    walk: Walk
    history: Array


def bacterial_field(
    scene: tuple[ArrayLike, ArrayLike, ArrayLike],
    steps: Steps,
    rng: np.random.Generator,
    *,
    radius: float = 0.0,
    base: Gains = IMPROVED,
    options: Bacterial = Bacterial(),
) -> Found:
    """Seek gains whose walk from start to goal past the obstacles (the three of `scene`) is the shortest.

    A bacterium is a pair of gains. Bacterial mutation copies it `clones` times, changes one gene in every copy, and
    goes on with the best, if it is better; gene after gene. Then the best survive, and pairs of them
    exchange genes to fill the population again. Raises ValueError as `walk` does.
    """
    spans = np.log([options.attract, options.repel])

    def cost(genes: Array) -> float:
        attract, repel = np.exp(genes)
        made = walk(*scene, replace(base, attract=float(attract), repel=float(repel)), steps, radius=radius)
        lack = float(np.hypot(*(made.places[-1] - np.asarray(scene[1], dtype=float))))
        return made.length if made.status == "reached" else FAILED + lack

    crowd = rng.uniform(spans[:, 0], spans[:, 1], (options.population, 2))
    costs = np.array([cost(genes) for genes in crowd])
    history = [costs.min()]
    for _ in range(options.generations):
        for k in range(len(crowd)):
            crowd[k], costs[k] = _mutated(crowd[k], costs[k], spans, cost, rng, options.clones)
        crowd, costs = _crossed(crowd, costs, cost, rng, options.survivors)
        history.append(costs.min())
    attract, repel = np.exp(crowd[int(np.argmin(costs))])
    best = replace(base, attract=float(attract), repel=float(repel))
    return Found(gains=best, walk=walk(*scene, best, steps, radius=radius), history=np.array(history))


def _mutated(
    genes: Array, now: float, spans: Array, cost: Cost, rng: np.random.Generator, clones: int
) -> tuple[Array, float]:
    """Bacterial mutation of one bacterium: gene after gene, in random order, the best of the changed copies is kept."""
    for gene in rng.permutation(len(genes)):
        tried = np.tile(genes, (clones, 1))
        tried[:, gene] = rng.uniform(spans[gene, 0], spans[gene, 1], clones)
        costs = [cost(one) for one in tried]
        if min(costs) < now:
            now = min(costs)
            genes = tried[int(np.argmin(costs))]
    return genes, now


def _crossed(crowd: Array, costs: Array, cost: Cost, rng: np.random.Generator, survivors: float) -> tuple[Array, Array]:
    """The best survive; the others are replaced by children that take each gene from one of two survivors."""
    kept = max(int(np.ceil(survivors * len(crowd))), 1)
    order = np.argsort(costs, kind="stable")[:kept]
    parents = order[rng.integers(0, kept, (len(crowd) - kept, 2))]
    which = rng.integers(0, 2, (len(crowd) - kept, 2))
    children = crowd[np.take_along_axis(parents, which, axis=1), np.arange(2)]
    new = np.array([cost(genes) for genes in children])
    return np.vstack([crowd[order], children]), np.concatenate([costs[order], new])
