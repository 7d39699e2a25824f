"""The walk down a potential field, what traps it, and the virtual target that shall free it.

Source: Fuzzy-APF eq 6, 7 and 10 to 12.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.checks import finite, not_negative, positive, share
from fuzzynav.data import folder
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.geometry import Array, length
from fuzzynav.potential import kernels
from fuzzynav.potential.fields import Gains, record
from fuzzynav.potential.obstacles import checked

__all__ = ["AS_PRINTED", "STATUSES", "Escape", "Steps", "Walk", "walk"]

STATUSES: tuple[str, ...] = ("reached", "collided", "local_minimum", "timeout")


@dataclass(frozen=True, slots=True, kw_only=True)
class Steps:
    """How a walk proceeds and ends. Raises ValueError for lengths and counts that are not positive.

    A walk is trapped where the last `watch` iterations have not brought it further than `share` of their steps: the
    print asks whether a vector is at most 0 (eq 7, errata A8), the detector is ours.
    """

    step: float = 0.01  # [m] table 2
    tolerance: float = 0.1  # [m] ours, the paper prints none
    most: int = 3000  # iterations, table 2
    watch: int = 60  # iterations
    share: float = 0.1
    axes: bool = False  # each axis moves by a whole step, as eq 6 is printed (errata A6)

    def __post_init__(self) -> None:
        positive(step=self.step, tolerance=self.tolerance)
        share(share=self.share)
        if self.most < 1 or not 1 <= self.watch:
            raise ValueError(f"most and watch must be iterations of 1 or more, got {self.most} and {self.watch}")


AS_PRINTED = Steps(axes=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Escape:
    """A rule base that answers a trap with a virtual target, and what its numbers stand for.

    Inputs are the size of the force over `strong` and the distance to the goal over `far`, both cut at 1; outputs the
    angle over `angle` and the gain over `gain` of a virtual target `radius` away. All but the ranges of angle and gain
    is ours: the paper prints no divisors, no radius and no duration. Raises ValueError for a rule base with other than
    two inputs and two outputs, and for numbers out of range.
    """

    rules: FuzzySystem
    radius: float = 1.0  # [m]
    angle: float = np.pi / 3.0  # [rad] section 3.2; the discussion says 30 degrees (errata A10)
    gain: float = 5.0  # section 3.2
    strong: float = 20.0
    far: float = 11.32  # [m] from start to goal of table 2
    hold: int = 200  # iterations for which a virtual target stands
    growth: float = 1.0  # of the hold, from one trap to the next without progress
    cycle: int = 1  # sizes of the angle, 1/cycle of it to all, from one trap to the next without progress
    goalward: bool = False  # the angle counts from the direction to the goal; printed: from the x axis (errata A9)
    turns: bool = False  # the side changes from one trap to the next without progress
    most: int = 50  # traps without progress until the walk gives up

    def __post_init__(self) -> None:
        positive(radius=self.radius, strong=self.strong, far=self.far, growth=self.growth)
        not_negative(angle=self.angle, gain=self.gain)
        if min(self.hold, self.most, self.cycle) < 1:
            raise ValueError(f"hold, most and cycle must be 1 or more, got {self.hold}, {self.most} and {self.cycle}")
        if len(self.rules.inputs) != 2 or len(self.rules.outputs) != 2:
            raise ValueError(
                f"the rule base of an escape has two inputs (force, distance) and two outputs (angle, gain), got "
                f"{len(self.rules.inputs)} and {len(self.rules.outputs)}"
            )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Walk:
    """A walk down a field: `status` is one of STATUSES, a trap never counts as the goal."""

    places: Array  # (n + 1, 2) [m]
    status: str
    trapped: NDArray[np.int64]  # iterations at which the walk was found trapped

    @property
    def iterations(self) -> int:
        """Number of steps."""
        return len(self.places) - 1

    @property
    def length(self) -> float:
        """Length [m] of the walk."""
        return length(self.places)


def walk(
    start: ArrayLike,
    goal: ArrayLike,
    obstacles: ArrayLike,
    gains: Gains,
    steps: Steps,
    *,
    escape: Escape | None = None,
    radius: float = 0.0,
    printed: bool = False,
) -> Walk:
    """Follow the force from start `(2,)` to goal `(2,)` [m] as a disc of `radius` [m].

    Without an `escape` the first trap ends the walk as 'local_minimum'. `printed` takes the force as eq 4 and 9 print
    it. Raises ValueError for places that are not finite, or a start or goal that touches an obstacle.

    Source: Fuzzy-APF eq 6 and 10 to 12.

    >>> walk([0, 0], [8, 8], [], Gains(), AS_PRINTED).iterations
    793
    """
    a, b = (finite(np.asarray(p, dtype=float), name, 2) for p, name in ((start, "the start"), (goal, "the goal")))
    rows = checked(obstacles)
    for place, name in ((a, "start"), (b, "goal")):
        gaps = [kernels.gap_to(place[0], place[1], row, float(radius))[0] for row in rows]
        if gaps and min(gaps) <= 0.0:
            raise ValueError(f"the {name} touches an obstacle: move one of them by more than {-min(gaps):.3g} m")
    own = np.array(
        [(steps.step, steps.tolerance, steps.most, steps.watch, steps.share, steps.axes)], dtype=kernels.WALK
    )
    places, status, trapped = kernels.walk(a, b, rows, float(radius), record(gains, printed), own, _escaping(escape))
    return Walk(places=places, status=STATUSES[status], trapped=trapped)


@lru_cache(maxsize=1)
def _idle() -> FuzzySystem:
    """A rule base for walks that do not ask one."""
    return FuzzySystem.load(folder("fuzzy") / "fuzzy_apf_table_1.fll")


def _escaping(escape: Escape | None) -> tuple[Array, tuple[object, ...]]:
    """The escape as the kernels take it."""
    if escape is None:
        return np.empty(0, dtype=kernels.ESCAPE), _idle().tables
    values = (
        escape.radius, escape.angle, escape.gain, escape.strong, escape.far, float(escape.hold), escape.growth,
        escape.cycle, escape.goalward, escape.turns, escape.most,
    )  # fmt: skip
    return np.array([values], dtype=kernels.ESCAPE), escape.rules.tables
