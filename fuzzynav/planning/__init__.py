"""Global planning: grid search, heuristics, visibility and sampling (chapter 05a)."""

from fuzzynav.planning import astar, heuristics, plain, sampling, visibility

__all__ = [
    "astar",
    "heuristics",
    "plain",
    "sampling",
    "visibility",
]
