"""The world of a run: walls, discs, boxes and what moves (chapters 01, 06 and 07)."""

from fuzzynav.world.world import (
    Mover,
    MoverState,
    World,
    movers_start,
    movers_step,
)

__all__ = [
    "Mover",
    "MoverState",
    "World",
    "movers_start",
    "movers_step",
]
