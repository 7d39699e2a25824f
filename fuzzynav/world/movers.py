"""What moves by itself in a world."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.world.timed import frame_at

__all__ = ["Mover"]

MOTIONS = ("constant", "patrol", "wander", "timed")


@dataclass(frozen=True, slots=True, kw_only=True)
class Mover:
    """A disc that moves by itself; make one with `constant`, `patrol`, `wander` or `timed`.

    A mover whose yield_distance is not 0 slows down when the robot's centre is ahead of it and nearer to its edge
    than that distance, and stands at half of it. One with courtesy waits as long as its next step would bring its edge
    within that distance of the rim of a robot that stands, and nearer than it is; 0 is blind. A timed mover that waits
    goes on where it stopped. Movers pass through obstacles and one another.
    """

    radius: float  # [m]
    start: tuple[float, float]  # [m]; a timed mover's is its place at time 0, whatever is handed in
    motion: str = "constant"
    velocity: tuple[float, float] = (0.0, 0.0)  # [m/s], constant
    waypoints: tuple[tuple[float, float], ...] = ()  # [m], patrol
    frames: tuple[tuple[float, float, float], ...] = ()  # t [s], x, y [m], timed
    phase: float = 0.0  # [s] of its loop that a timed mover has walked at time 0
    speed: float = 0.0  # [m/s], patrol and wander
    yield_distance: float = 0.0  # [m]
    courtesy: float = 0.0  # [m]

    def __post_init__(self) -> None:
        """Refuse what cannot move; bring a phase into its loop."""
        numbers = [self.radius, *self.start, *self.velocity, self.speed, self.yield_distance, self.courtesy, self.phase]
        finite = np.isfinite([*numbers, *np.ravel(self.waypoints), *np.ravel(self.frames)]).all()
        if len(self.start) != 2 or len(self.velocity) != 2 or not finite:
            raise ValueError(f"a mover needs finite numbers, points of two numbers each, got {self}")
        if not self.radius > 0 or min(self.speed, self.yield_distance, self.courtesy) < 0:
            raise ValueError(
                "a mover needs a positive radius, and a speed, yield_distance and courtesy of 0 or more, got "
                f"{self.radius}, {self.speed}, {self.yield_distance}, {self.courtesy}"
            )
        if self.motion not in MOTIONS:
            raise ValueError(f"motion must be one of {MOTIONS}, got {self.motion!r}")
        if self.motion == "patrol" and (len(self.waypoints) < 2 or np.ptp(self.waypoints, axis=0).max() == 0.0):
            raise ValueError(f"a patrol needs two or more different waypoints, got {self.waypoints}")
        if self.motion != "timed" and (self.frames or self.phase):
            raise ValueError(f"frames and a phase belong to a timed mover, not to {self.motion}")
        if self.motion == "timed":
            self._begin()

    def _begin(self) -> None:
        """Check the frames, and set out from the place at the phase."""
        rows = np.array(self.frames)
        if rows.ndim != 2 or rows.shape[1] != 3 or rows[0, 0] < 0.0 or not (np.diff(rows[:, 0]) > 0.0).all():
            raise ValueError(f"frames must be rows of t, x, y, their times rising from 0 or later, got {rows.tolist()}")
        object.__setattr__(self, "phase", float(self.phase % rows[-1, 0]) if len(rows) > 1 else 0.0)
        x, y, _, _ = frame_at(rows, len(rows), self.phase)
        object.__setattr__(self, "start", (float(x), float(y)))

    @classmethod
    def constant(
        cls, start: ArrayLike, velocity: ArrayLike, radius: float, yield_distance: float = 0.0, courtesy: float = 0.0
    ) -> Mover:
        """Mover that keeps its velocity (2,) [m/s] for ever."""
        return cls(
            radius=radius,
            start=_pair(start),
            velocity=_pair(velocity),
            yield_distance=yield_distance,
            courtesy=courtesy,
        )

    @classmethod
    def patrol(
        cls, waypoints: ArrayLike, speed: float, radius: float, yield_distance: float = 0.0, courtesy: float = 0.0
    ) -> Mover:
        """Mover that walks along the waypoints `(n, 2)` [m], turns at the last one and walks back."""
        points = tuple(_pair(p) for p in np.asarray(waypoints, dtype=float))
        if not points:
            raise ValueError("a patrol needs two or more different waypoints, got none")
        return cls(
            radius=radius,
            start=points[0],
            motion="patrol",
            waypoints=points,
            speed=speed,
            yield_distance=yield_distance,
            courtesy=courtesy,
        )

    @classmethod
    def wander(
        cls, start: ArrayLike, speed: float, radius: float, yield_distance: float = 0.0, courtesy: float = 0.0
    ) -> Mover:
        """Mover that walks straight from one random point of free ground to the next."""
        return cls(
            radius=radius,
            start=_pair(start),
            motion="wander",
            speed=speed,
            yield_distance=yield_distance,
            courtesy=courtesy,
        )

    @classmethod
    def timed(
        cls, frames: ArrayLike, radius: float, phase: float = 0.0, yield_distance: float = 0.0, courtesy: float = 0.0
    ) -> Mover:
        """Mover that is at the places of frames `(n, 3)` (t [s], x, y [m]) at their times, and walks between them.

        The last time is the period; there it jumps back to the first frame. Before the first time it stands. `phase`
        [s] is how far into the loop it begins. Raises ValueError for times that do not rise, or are negative.

        >>> Mover.timed([[0, 0, 0], [2, 4, 0]], 0.3, phase=2.5).start
        (1.0, 0.0)
        """
        rows = np.asarray(frames, dtype=float)
        if rows.ndim != 2 or rows.shape[1] != 3 or not np.isfinite(rows).all():
            raise ValueError(f"frames must be finite rows of t, x, y, got {rows.tolist()}")
        return cls(
            radius=radius,
            start=(0.0, 0.0),
            motion="timed",
            frames=tuple((float(t), float(x), float(y)) for t, x, y in rows),
            phase=float(phase),
            yield_distance=yield_distance,
            courtesy=courtesy,
        )


def _pair(values: ArrayLike) -> tuple[float, float]:
    pair = np.asarray(values, dtype=float).ravel()
    if len(pair) != 2:
        raise ValueError(f"expected two numbers, got {pair.tolist()}")
    return float(pair[0]), float(pair[1])
