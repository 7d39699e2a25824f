"""Search by evolution: today the optimiser that tuned the weights of chapter 06."""

from fuzzynav.evolve.cma import minimise

__all__ = ["minimise"]
