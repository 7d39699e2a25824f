"""The named records that the compiled blend reads and writes; units of the schemes stand in their dataclasses."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fuzzynav.geometry import Array
from fuzzynav.tracking.records import Records

__all__ = ["LOG", "MIND", "PRINTED", "SAFE", "Made", "Scene", "Track"]


def _record(*fields: str | tuple[Any, ...]) -> np.dtype[Any]:
    """Record type of these fields; a bare name is a real number."""
    return np.dtype((np.record, [(f, "f8") if isinstance(f, str) else f for f in fields]))


PRINTED = _record("gate", "d0", "keep_speed", "turn", ("hard", "?"))  # of PrintedScheme

SAFE = _record(  # of SafeScheme, and what the robot and the rule base add
    "enter",
    "leave",
    "follow",
    "enter_time",
    "leave_time",
    "cruise",
    "creep",
    "gain",
    "ahead",
    "stretch",
    "look",
    ("rate", "i8"),
    "guard",
    "guard_turn",
    "fade",
    "reach",
    "same_side",
    ("moving", "?"),
    "evade_margin",
    "evade_time",
    "evade_speed",
    "evade_turn",
    "floor",  # least F of the rule base
    "ceiling",  # and greatest
    "radius",  # [m] of the robot
)

MIND = _record(  # what a blend knows from step to step
    ("index", "i8"),  # step of the reference
    ("latched", "?"),  # whether avoidance has taken over
    "side",  # +1: the points stay on the right, -1: on the left, 0: not chosen yet
    "weight",  # share of avoidance in the command
    "released",  # [s] when avoidance handed back last
    "fuzzy",  # F of the rule base; of the safe blend stretched to 0 to 1
    ("goal", "i8"),  # step of the reference at which the robot wants to rejoin it
    ("braked", "?"),  # whether the guard changed the command
    "predicted",  # [m] least clearance that tracking alone would keep
    "v",  # [m/s] last command
    "omega",  # [rad/s]
    "time",  # [s]
)

LOG = _record(  # what a run keeps of each step
    ("index", "i8"), "weight", "F", ("avoiding", "?"), ("braked", "?"), "clearance", "predicted"
)  # fmt: skip


class Track(NamedTuple):
    """The tracking law inside a blend: its gains (one record), its memory (an array of one), and the reference."""

    gains: Any
    memory: Records
    rows: Records


class Scene(NamedTuple):
    """What a compiled run goes past, and how it is driven."""

    block: Array  # (5,) x, y, width, height [m], theta [rad]
    until: int  # the block is there while the reference's index is below
    angles: Array  # (k,) [rad] of the beams
    safe: bool  # the safe blend; else the printed one
    limited: bool  # limits of speed and acceleration hold
    euler: bool  # integrated as the thesis does; else along exact arcs


class Made(NamedTuple):
    """What a compiled run fills; poses[0] is the start."""

    poses: Array  # (n + 1, 3)
    commands: Array  # (n, 2)
    log: Records  # (n,) LOG records
