"""The scanning laser: the same one measures in chapter 01 and drives the robot in every later chapter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

from fuzzynav import checks
from fuzzynav.geometry import Array, to_world
from fuzzynav.sensors.scene import cast_scene, check_model

if TYPE_CHECKING:
    from fuzzynav.maps.gridmap import GridMap
    from fuzzynav.world import World

__all__ = [
    "SPEED_OF_LIGHT",
    "SPEED_OF_LIGHT_AS_PRINTED",
    "Laser",
    "Scan",
    "laser_faults",
    "laser_ideal",
    "laser_range",
    "laser_scan",
    "polar_to_points",
]

SPEED_OF_LIGHT = 299_792_458.0  # [m/s] exact
SPEED_OF_LIGHT_AS_PRINTED = 3e8  # [m/s] thesis section 1.3.4, 0.069 % high (errata T68)


@dataclass(frozen=True, slots=True, kw_only=True)
class Laser:
    """A scanning laser range finder; `field_of_view` [rad] is centred ahead, the first beam is the rightmost.

    `noise` [m] is the standard deviation of a range, `dropout` the share of beams that return nothing.
    Raises ValueError for a negative noise and other impossible values; a scanner of 0 beams is one that is dead.
    """

    beams: int = 181
    field_of_view: float = np.pi
    range_min: float = 0.05
    range_max: float = 8.0
    noise: float = 0.01
    dropout: float = 0.0

    def __post_init__(self) -> None:
        check_model(self, positive=("range_max", "field_of_view"), share=("dropout",))
        if self.beams != int(self.beams):
            raise ValueError(f"Laser.beams must be a whole number, got {self.beams}")
        if self.field_of_view > 2.0 * np.pi + 1e-9:
            raise ValueError(f"Laser.field_of_view must lie in (0, 2 pi], got {self.field_of_view}")
        if self.range_min >= self.range_max:
            raise ValueError(f"Laser.range_min {self.range_min} must lie below range_max {self.range_max}")

    @property
    def angles(self) -> Array:
        """Beam angles `(beams,)` [rad] in the body frame; a full circle does not repeat its first beam."""
        if self.beams == 1:
            return np.zeros(1)
        full = self.field_of_view >= 2.0 * np.pi - 1e-9
        return np.linspace(-0.5, 0.5, int(self.beams), endpoint=not full) * self.field_of_view


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scan:
    """One laser scan: `angles` [rad] in the body frame and `ranges` [m], both `(n,)`.

    inf: nothing within range_max. nan: no measurement. -inf: nearer than the sensor can see (as in REP 117).
    Raises ValueError if the shapes differ, an angle is not finite or a range is negative.
    """

    angles: Array
    ranges: Array
    range_max: float

    def __post_init__(self) -> None:
        angles, ranges = np.array(self.angles, dtype=float), np.array(self.ranges, dtype=float)
        if angles.ndim != 1 or angles.shape != ranges.shape:
            raise ValueError(f"a scan needs as many ranges as angles, got {ranges.shape} and {angles.shape}")
        if not np.isfinite(angles).all() or np.any(np.isfinite(ranges) & (ranges < 0)):
            raise ValueError("the angles of a scan must be finite and its finite ranges not negative")
        if not self.range_max > 0:
            raise ValueError(f"Scan.range_max must be positive, got {self.range_max}")
        object.__setattr__(self, "angles", angles)
        object.__setattr__(self, "ranges", ranges)

    @property
    def hits(self) -> NDArray[np.bool_]:
        """Which beams `(n,)` measured a surface."""
        return np.isfinite(self.ranges)

    @property
    def points(self) -> Array:
        """Measured points `(m, 2)` [m] in the body frame, one for each hit."""
        return polar_to_points(self.ranges[self.hits], self.angles[self.hits])

    def world_points(self, pose: ArrayLike) -> Array:
        """Measured points `(m, 2)` [m] in the world, as seen from `pose`."""
        return to_world(checks.pose(pose), self.points)


def laser_range(time: ArrayLike, speed: float = SPEED_OF_LIGHT) -> Array:
    """Distance [m] of the surface whose light returns after `time` [s].

    Source: thesis eq 1.5 (errata T68: 3e8 m/s is 0.069 % high).

    >>> float(laser_range(1e-8).round(4)), float(laser_range(1e-8, SPEED_OF_LIGHT_AS_PRINTED).round(4))
    (1.499, 1.5)
    """
    return speed * np.asarray(time, dtype=float) / 2.0


def polar_to_points(ranges: ArrayLike, angles: ArrayLike) -> Array:
    """Points `(..., 2)` [m] in the sensor's frame from ranges [m] and angles [rad].

    Source: thesis eq 1.10.
    """
    r, a = np.asarray(ranges, dtype=float), np.asarray(angles, dtype=float)
    return np.stack([r * np.cos(a), r * np.sin(a)], axis=-1)


def laser_ideal(scene: World | GridMap, pose: ArrayLike, laser: Laser, movers: ArrayLike | None = None) -> Scan:
    """Exact scan of everything in the scene, moving obstacles included; inf where nothing is within range_max."""
    ranges = cast_scene(scene, pose, laser.angles, laser.range_max, movers)
    ranges = np.where(ranges >= laser.range_max, np.inf, ranges)
    ranges = np.where(ranges < laser.range_min, -np.inf, ranges)
    return Scan(angles=laser.angles, ranges=ranges, range_max=laser.range_max)


def laser_faults(scan: Scan, laser: Laser, rng: Generator) -> Scan:
    """The scan as the sensor would have reported it: Gaussian noise on each range, and dropouts as nan."""
    noisy = scan.ranges + laser.noise * rng.standard_normal(scan.ranges.shape)
    lost = rng.random(scan.ranges.shape) < laser.dropout
    noisy = np.where(scan.hits, np.clip(noisy, laser.range_min, laser.range_max), scan.ranges)
    return Scan(angles=scan.angles, ranges=np.where(lost, np.nan, noisy), range_max=scan.range_max)


def laser_scan(
    scene: World | GridMap, pose: ArrayLike, laser: Laser, rng: Generator, movers: ArrayLike | None = None
) -> Scan:
    """A scan with the sensor's faults: `laser_faults` of `laser_ideal`."""
    return laser_faults(laser_ideal(scene, pose, laser, movers), laser, rng)
