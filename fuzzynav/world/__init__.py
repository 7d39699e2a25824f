"""The world of a run: walls, discs, boxes and what moves (chapters 01, 06 and 07)."""

from fuzzynav.world.movers import Mover
from fuzzynav.world.traffic import MoverState, movers_between, movers_start, movers_step
from fuzzynav.world.world import World

__all__ = ["Mover", "MoverState", "World", "movers_between", "movers_start", "movers_step"]
