"""What stands between a command and the motion, and between the pose and its measurement."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from fuzzynav.geometry import Array
from fuzzynav.robot import Robot
from fuzzynav.robot.kernels import PLANT

__all__ = ["UNDISTURBED", "Disturbance"]

SLIP_TIME = 1.0  # [s] a wheel's slip is drawn anew this often


@dataclass(frozen=True, slots=True, kw_only=True)
class Disturbance:
    """What stands between a controller and the ideal robot; all zero is the ideal robot.

    Raises ValueError for a negative value (the two radius errors may have either sign) or slip of 1 and more.
    """

    position_noise: float = 0.0  # [m] standard deviation of each measured coordinate
    heading_noise: float = 0.0  # [rad] standard deviation of the measured heading
    slip: float = 0.0  # greatest share of its speed that a wheel loses
    delay: float = 0.0  # [s] from a command to its effect
    right_radius: float = 0.0  # relative error of the true radius of the right wheel
    left_radius: float = 0.0
    motor_lag: float = 0.0  # [s] time constant of the wheels

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            signed = field.name in ("right_radius", "left_radius")
            if not np.isfinite(value) or (value < 0 and not signed) or (signed and abs(value) >= 1):
                raise ValueError(f"{field.name} must be finite and {'below 1' if signed else 'not negative'}: {value}")
        if self.slip >= 1.0:
            raise ValueError(f"slip is the share of speed lost and must be below 1, got {self.slip}")

    def draws(self, steps: int, dt: float, rng: np.random.Generator | int) -> tuple[Array, Array]:
        """Measurement noise `(steps, 3)` and wheel slip `(steps, 2)` of one run."""
        generator = np.random.default_rng(rng)
        noise = generator.standard_normal((steps, 3))
        noise *= [self.position_noise, self.position_noise, self.heading_noise]
        hold = max(round(SLIP_TIME / dt), 1)
        slip = self.slip * generator.random((steps // hold + 1, 2))
        return noise, np.repeat(slip, hold, axis=0)[:steps]

    def plant(self, robot: Robot) -> Array:
        """The robot as it truly is, for `robot.kernels.drive`: an array of one PLANT record."""
        values = (robot.wheel_radius, robot.track, self.motor_lag, self.right_radius, self.left_radius)
        return np.array([values], dtype=PLANT)


UNDISTURBED = Disturbance()
