"""Covariance matrix adaptation: an evolution strategy for a few dozen numbers and a cost without derivatives."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fuzzynav.geometry import Array

__all__ = ["minimise"]


def minimise(
    cost: Callable[[Array], float], start: Array, sigma: float, generations: int, seed: int = 0
) -> list[Array]:
    """Means `(n,)` of every generation, the start first, of an evolution that adapts its covariance to the cost.

    Rank-mu and rank-one updates, cumulative control of the step length; sigma is the first spread of a sample.
    Source: N. Hansen, The CMA Evolution Strategy: A Tutorial, 2016.
    """
    rng, n = np.random.default_rng(seed), len(start)
    size = 4 + int(3 * np.log(n))
    parents = size // 2
    w = np.log(parents + 0.5) - np.log(np.arange(1, parents + 1))
    w /= w.sum()
    mu = 1.0 / (w**2).sum()
    cs, cc = (mu + 2) / (n + mu + 5), (4 + mu / n) / (n + 4 + 2 * mu / n)
    c1 = 2 / ((n + 1.3) ** 2 + mu)
    cm = min(1 - c1, 2 * (mu - 2 + 1 / mu) / ((n + 2) ** 2 + mu))
    damping, chi = 1 + cs, np.sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n**2))
    mean, cov, ps, pc = start.copy(), np.eye(n), np.zeros(n), np.zeros(n)
    means = [mean]
    for _ in range(generations):
        values, axes = np.linalg.eigh(cov)
        root = axes * np.sqrt(np.maximum(values, 1e-12))
        steps = rng.standard_normal((size, n)) @ root.T
        order = np.argsort([cost(mean + sigma * s) for s in steps], kind="stable")[:parents]
        move = w @ steps[order]
        mean = mean + sigma * move
        ps = (1 - cs) * ps + np.sqrt(cs * (2 - cs) * mu) * (axes / np.sqrt(np.maximum(values, 1e-12))) @ axes.T @ move
        pc = (1 - cc) * pc + np.sqrt(cc * (2 - cc) * mu) * move
        cov = (1 - c1 - cm) * cov + c1 * np.outer(pc, pc) + cm * (steps[order].T * w) @ steps[order]
        sigma *= float(np.exp(cs / damping * (np.linalg.norm(ps) / chi - 1)))
        means.append(mean)
    return means
