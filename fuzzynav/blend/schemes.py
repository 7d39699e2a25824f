"""What is chosen about the blend: the printed scheme and the safe one, as frozen parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzynav.blend.records import PRINTED, SAFE
from fuzzynav.blend.rules import reach_of
from fuzzynav.checks import positive_fields
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.tracking.records import Records

__all__ = ["PrintedScheme", "SafeScheme"]


def filled(record: np.dtype[Any], values: object, more: Mapping[str, float] | None = None) -> Records:
    """An array of one record with the fields of an object, and what is given beside them."""
    made = np.zeros(1, record)
    for name in record.names or ():
        made[name] = more[name] if more and name in more else getattr(values, name)
    return made


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedScheme:
    """The printed blend. Ours: d0, the half width of the gate as 45 deg, and the unit of the turn.

    Raises ValueError for values that are not positive, a gate over pi, or a share outside 0 to 1.
    """

    gate: float = np.pi / 4.0  # [rad] to each side of straight ahead
    d0: float = 0.7  # [m] from the robot's centre to the block
    keep_speed: float = 0.0  # v_a as a share of v_t: 0 as printed, 1 as remark 1 says (errata T59)
    turn: float = 1.0  # [rad/s]
    hard: bool = False  # the hard switch of section 2.5, without gate, d_safe = d0

    def __post_init__(self) -> None:
        if not (0.0 < self.gate <= np.pi and self.d0 > 0.0 and 0.0 <= self.keep_speed <= 1.0 and self.turn > 0.0):
            raise ValueError(f"gate in (0, pi], d0 and turn positive, keep_speed in 0 to 1, got {self}")

    @property
    def record(self) -> Records:
        """The values as the kernels read them: an array of one record."""
        return filled(PRINTED, self)


@dataclass(frozen=True, slots=True, kw_only=True)
class SafeScheme:
    """The safe blend: who drives is decided by a forecast of tracking, how by F. All values ours.

    Raises ValueError for values that are not positive and finite, or leave < enter.
    """

    enter: float = 0.10  # [m] avoidance begins when tracking would come nearer than this to a sensed point
    leave: float = 0.12  # [m] and ends when tracking would keep this
    follow: float = 0.15  # [m] margin that the detour keeps
    enter_time: float = 6.0  # [s] how far the forecast looks while tracking
    leave_time: float = 8.0  # [s] and while avoiding
    cruise: float = 0.20  # [m/s] speed of the detour at F = 0
    creep: float = 0.08  # [m/s] and at F = 1
    gain: float = 2.0  # [1/s] yaw rate for a wrong heading, doubled at F = 1
    ahead: float = 0.3  # [m] least arc to the rejoin point
    stretch: float = 0.5  # [m] arc of reference that must be clear behind it
    look: float = 2.0  # [m] arc that is searched for it
    rate: int = 3  # the reference's time runs at most so many times as fast during the detour
    guard: float = 0.03  # [m] the last filter brakes before a point comes nearer
    guard_turn: float = 2.0  # [1/s] and turns at this rate towards free ground
    fade: float = 0.4  # [s] in which avoidance takes over, and hands back
    reach: float = 2.0  # [m] range of the sensor that is used
    same_side: float = 3.0  # [s] a detour that begins so soon after the last keeps its side
    moving: bool = False  # remember nothing: every point may have moved on
    evade_margin: float = 0.05  # [m] the last filter keeps more than guard from points that may move
    evade_time: float = 2.0  # [s] and looks so far ahead
    evade_speed: float = 0.12  # [m/s] it tries three such steps of v forwards and backwards
    evade_turn: float = 0.7  # [rad/s] and two such steps of omega to each side

    def __post_init__(self) -> None:
        positive_fields(self)
        if self.leave < self.enter:
            raise ValueError(f"leave must not be below enter, or the gate would chatter: {self.leave} < {self.enter}")

    def record(self, system: FuzzySystem, radius: float) -> Records:
        """The values as the kernels read them, with the reach of the rule base and the robot's radius [m]."""
        floor, ceiling = reach_of(system)
        return filled(SAFE, self, {"floor": floor, "ceiling": ceiling, "radius": radius})
