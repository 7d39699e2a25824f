"""Potential fields (chapter 09): forces that lead to a goal, what traps them, and what frees them."""

from fuzzynav.potential.fields import CLASSICAL, IMPROVED, Gains, force, potential, printed_force
from fuzzynav.potential.obstacles import discs, walls
from fuzzynav.potential.walks import AS_PRINTED, Escape, Steps, Walk, walk

__all__ = [
    "AS_PRINTED", "CLASSICAL", "IMPROVED", "Escape", "Gains", "Steps", "Walk", "discs", "force", "potential",
    "printed_force", "walk", "walls",
]  # fmt: skip
