"""The sonar: one range for a whole cone, and echoes that do not return."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

from fuzzynav.geometry import Array
from fuzzynav.sensors.scene import cast_scene, check_model

if TYPE_CHECKING:
    from fuzzynav.maps.gridmap import GridMap
    from fuzzynav.world import World

__all__ = ["SPEED_OF_SOUND", "Sonar", "sonar_cone", "sonar_ideal", "sonar_range", "sonar_reading"]

SPEED_OF_SOUND = 343.0  # [m/s] in air of 20 degrees C, thesis section 1.3.3


@dataclass(frozen=True, slots=True, kw_only=True)
class Sonar:
    """An ultrasonic range sensor; angles in radians, ranges in metres.

    A surface is heard only where the beam meets it within `specular_angle` of its normal: a smooth wall throws
    the sound of a flatter beam away, and nothing comes back. `noise` is the standard deviation relative to the range.
    Raises ValueError for negative or impossible values.
    """

    range_min: float = 0.15
    range_max: float = 5.0
    cone: float = np.pi / 6.0  # [rad] full opening
    specular_angle: float = np.pi / 7.2  # [rad] 25 degrees
    noise: float = 0.01
    rays: int = 61

    def __post_init__(self) -> None:
        check_model(self, positive=("range_max", "cone", "specular_angle", "rays"))
        if self.range_min >= self.range_max:
            raise ValueError(f"Sonar.range_min {self.range_min} must lie below range_max {self.range_max}")


def sonar_range(time: ArrayLike, speed: float = SPEED_OF_SOUND) -> Array:
    """Distance [m] of the surface whose echo returns after `time` [s].

    Source: thesis eq 1.4.

    >>> float(sonar_range(0.01))
    1.715
    """
    return speed * np.asarray(time, dtype=float) / 2.0


def sonar_cone(
    scene: World | GridMap, pose: ArrayLike, sonar: Sonar, movers: ArrayLike | None = None
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Angles [rad], ranges [m] and whether an echo returns, each `(rays,)`, for the rays of the cone.

    The normal of a surface is taken from two more rays 0.1 mrad to either side.
    """
    angles = np.linspace(-0.5, 0.5, int(sonar.rays)) * sonar.cone if sonar.rays > 1 else np.zeros(1)
    beams = np.concatenate([angles, angles - 1e-4, angles + 1e-4])
    ranges = cast_scene(scene, pose, beams, sonar.range_max, movers)
    middle, low, high = ranges.reshape(3, -1)
    slope = (high - low) / 2e-4  # dr/da = r tan(incidence)
    echo = (middle < sonar.range_max) & (np.abs(np.arctan2(slope, middle)) <= sonar.specular_angle)
    return angles, middle, echo


def sonar_ideal(scene: World | GridMap, pose: ArrayLike, sonar: Sonar, movers: ArrayLike | None = None) -> float:
    """Range [m] of the nearest surface in the cone that sends an echo; range_max where none does.

    What is nearer than range_min is reported at range_min.
    """
    _, ranges, echo = sonar_cone(scene, pose, sonar, movers)
    return float(np.clip(np.min(ranges[echo], initial=sonar.range_max), sonar.range_min, sonar.range_max))


def sonar_reading(
    scene: World | GridMap, pose: ArrayLike, sonar: Sonar, rng: Generator, movers: ArrayLike | None = None
) -> float:
    """Range [m] with the sensor's noise; range_max without noise where no echo returns."""
    ideal = sonar_ideal(scene, pose, sonar, movers)
    draw = rng.standard_normal()
    if ideal >= sonar.range_max:
        return sonar.range_max
    return float(np.clip(ideal * (1.0 + sonar.noise * draw), sonar.range_min, sonar.range_max))
