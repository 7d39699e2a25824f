"""Thesis 1: the scenes and runs of notebook 01, which are our choice, and its claims.

The thesis prints no measured result there: its numbers there are the two speeds of eq 1.4 and 1.5,
which `sensors` holds. The scenes below stand where it shows pictures.
"""

from __future__ import annotations

import numpy as np

from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import Robot
from fuzzynav.sensors import Encoders, dead_reckon, encoder_counts, odometry
from fuzzynav.studies.reproduction import Reproduction
from fuzzynav.world import Mover, World

__all__ = ["REPRODUCTIONS", "believed_run", "room", "square_motions", "wall"]

REPRODUCTIONS: tuple[Reproduction, ...] = ()

ROOM = """
################################
#..............................#
#..............................#
#..............................#
#.........................######
#..............................#
#..............................#
#..............................#
#....####......................#
#....####......................#
#....####......................#
#..............................#
#...................##.........#
#...................##.........#
#..............................#
#..............................#
################.....###########
"""


def square_motions(side: float = 3.0, corner: float = 0.5, laps: int = 1, step: float = 0.05) -> Array:
    """Motions `(n, 2)`, advance [m] and turn [rad], round a square with round corners, counter-clockwise.

    Steps are at most `step` [m] long. Raises ValueError if the corners do not fit the side.
    """
    if not 0 < 2 * corner <= side:
        raise ValueError(f"two corners of radius {corner} must fit the side of {side} m")
    straight, arc = side - 2.0 * corner, 0.5 * np.pi * corner
    parts = []
    for length, turn in ((straight, 0.0), (arc, np.pi / 2.0)):
        n = int(np.ceil(length / step - 1e-9)) if length > 0 else 0
        parts.append(np.tile([length, turn], (n, 1)) / max(n, 1))
    return np.tile(np.vstack(parts), (4 * laps, 1))


def believed_run(motions: Array, robot: Robot, encoders: Encoders, seed: int = 0) -> Array:
    """Poses `(n + 1, 3)` that odometry believes while the robot truly makes these motions from the origin."""
    counts = encoder_counts(motions, robot, encoders, np.random.default_rng(seed))
    return dead_reckon(np.zeros(3), odometry(counts, robot, encoders.ticks_per_turn))


def room(person: bool = True) -> World:
    """A room of 8 m by 4.25 m with a box, a pillar and a door, and a person of radius 0.25 m who walks through it."""
    walker = Mover.constant((6.8, 2.5), (-0.45, 0.06), 0.25)
    return World(grid=GridMap.from_ascii(ROOM, 0.25), movers=(walker,) if person else ())


def wall(angle: float, distance: float = 2.0) -> World:
    """A smooth wall 6 m long whose face crosses the x axis at distance [m], turned by angle [rad]."""
    thick = 0.1
    middle = np.array([distance, 0.0]) + 0.5 * thick * np.array([np.cos(angle), np.sin(angle)])
    return World(rectangles=np.array([[*middle, thick, 6.0, angle]]))
