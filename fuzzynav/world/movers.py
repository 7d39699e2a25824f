"""What moves by itself in a world."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["Mover"]

MOTIONS = ("constant", "patrol", "wander")


@dataclass(frozen=True, slots=True, kw_only=True)
class Mover:
    """A disc that moves by itself; make one with `constant`, `patrol` or `wander`.

    A mover whose yield_distance is not 0 slows down when the robot's centre is ahead of it and nearer to its edge
    than that distance, and stands at half of it. Movers pass through obstacles and one another.
    """

    radius: float  # [m]
    start: tuple[float, float]  # [m]
    motion: str = "constant"
    velocity: tuple[float, float] = (0.0, 0.0)  # [m/s], constant
    waypoints: tuple[tuple[float, float], ...] = ()  # [m], patrol
    speed: float = 0.0  # [m/s], patrol and wander
    yield_distance: float = 0.0  # [m]

    def __post_init__(self) -> None:
        """Refuse what cannot move."""
        numbers = [self.radius, *self.start, *self.velocity, self.speed, self.yield_distance, *np.ravel(self.waypoints)]
        if len(self.start) != 2 or len(self.velocity) != 2 or not np.isfinite(numbers).all():
            raise ValueError(f"a mover needs finite numbers, points of two numbers each, got {self}")
        if not self.radius > 0 or self.speed < 0 or self.yield_distance < 0:
            raise ValueError(
                "a mover needs a positive radius, and a speed and yield_distance of 0 or more, got "
                f"{self.radius}, {self.speed}, {self.yield_distance}"
            )
        if self.motion not in MOTIONS:
            raise ValueError(f"motion must be one of {MOTIONS}, got {self.motion!r}")
        if self.motion == "patrol" and (len(self.waypoints) < 2 or np.ptp(self.waypoints, axis=0).max() == 0.0):
            raise ValueError(f"a patrol needs two or more different waypoints, got {self.waypoints}")

    @classmethod
    def constant(cls, start: ArrayLike, velocity: ArrayLike, radius: float, yield_distance: float = 0.0) -> Mover:
        """Mover that keeps its velocity (2,) [m/s] for ever."""
        return cls(radius=radius, start=_pair(start), velocity=_pair(velocity), yield_distance=yield_distance)

    @classmethod
    def patrol(cls, waypoints: ArrayLike, speed: float, radius: float, yield_distance: float = 0.0) -> Mover:
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
        )

    @classmethod
    def wander(cls, start: ArrayLike, speed: float, radius: float, yield_distance: float = 0.0) -> Mover:
        """Mover that walks straight from one random point of free ground to the next."""
        return cls(radius=radius, start=_pair(start), motion="wander", speed=speed, yield_distance=yield_distance)


def _pair(values: ArrayLike) -> tuple[float, float]:
    pair = np.asarray(values, dtype=float).ravel()
    if len(pair) != 2:
        raise ValueError(f"expected two numbers, got {pair.tolist()}")
    return float(pair[0]), float(pair[1])
