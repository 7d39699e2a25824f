"""Wheel encoders: ticks, the way they stand for, and where dead reckoning believes the robot is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

from fuzzynav import checks
from fuzzynav.geometry import Array, wrap
from fuzzynav.robot import Robot, body_from_rims, kernels

__all__ = [
    "EXACT",
    "Encoders",
    "Odometry",
    "dead_reckon",
    "encoder_counts",
    "odometry",
    "wheel_angle",
    "wheel_travel",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Encoders:
    """Two wheel encoders and how the true wheels differ from the ones the robot believes in.

    Errors of measures are relative: `right_radius_error` 0.01 means that the true right wheel is 1 % larger.
    `slip` is the share of rim travel that does not move the robot; `slip_noise` [m^0.5] makes the slip of
    each wheel uneven: its travel errs by slip_noise times the square root of the travel [m].
    Raises ValueError for values that no wheel can have.
    """

    ticks_per_turn: int = 2578  # of one wheel, as on a Kobuki base
    right_radius_error: float = 0.0
    left_radius_error: float = 0.0
    track_error: float = 0.0
    slip: float = 0.0
    slip_noise: float = 0.0  # [m^0.5]

    def __post_init__(self) -> None:
        errors = (self.right_radius_error, self.left_radius_error, self.track_error)
        if self.ticks_per_turn != int(self.ticks_per_turn) or self.ticks_per_turn < 1:
            raise ValueError(f"Encoders.ticks_per_turn must be a whole number of at least 1, got {self.ticks_per_turn}")
        if not all(np.isfinite(e) and e > -1 for e in errors):
            raise ValueError(f"Encoders: right_radius_error, left_radius_error, track_error must exceed -1: {errors}")
        if not 0 <= self.slip < 1:
            raise ValueError(f"Encoders.slip must lie in [0, 1), got {self.slip}")
        if not (np.isfinite(self.slip_noise) and self.slip_noise >= 0):
            raise ValueError(f"Encoders.slip_noise must be finite and not negative, got {self.slip_noise}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Odometry:
    """How dead reckoning misjudges speed: a constant share and a random one, of v and of omega.

    Raises ValueError for a negative noise or a value that is not finite.
    """

    noise: tuple[float, float] = (0.0, 0.0)  # standard deviation, as a share of the speed
    bias: tuple[float, float] = (0.0, 0.0)  # constant share

    def __post_init__(self) -> None:
        checks.finite(self.bias, "Odometry.bias (v, omega)", 2)
        if checks.finite(self.noise, "Odometry.noise (v, omega)", 2).min() < 0.0:
            raise ValueError(f"Odometry.noise must not be negative, got {self.noise}")

    def factors(self, rng: Generator) -> Array:
        """Believed over true speed `(2,)` of one step; exactly 1 for exact odometry."""
        if not (any(self.noise) or any(self.bias)):
            return np.ones(2)
        return 1.0 + np.array(self.bias) + np.array(self.noise) * rng.standard_normal(2)


EXACT = Odometry()


def wheel_angle(ticks: ArrayLike, ticks_per_turn: int) -> Array:
    """Wheel angle [rad] of a number of encoder ticks.

    Raises ValueError for less than one tick a turn.   Source: thesis eq 1.2.

    >>> float(wheel_angle(256, 1024).round(4))
    1.5708
    """
    if not ticks_per_turn >= 1:
        raise ValueError(f"ticks_per_turn must be 1 or more, got {ticks_per_turn}")
    return 2.0 * np.pi * np.asarray(ticks, dtype=float) / ticks_per_turn


def wheel_travel(ticks: ArrayLike, ticks_per_turn: int, wheel_radius: ArrayLike) -> Array:
    """Distance [m] that a wheel of wheel_radius [m] rolls during a number of ticks.

    Source: thesis eq 1.3.

    >>> float(wheel_travel(1, 2578, 0.035).round(7))               # one tick of a Kobuki
    8.53e-05
    """
    return np.asarray(wheel_radius, dtype=float) * wheel_angle(ticks, ticks_per_turn)


def encoder_counts(
    motions: ArrayLike, robot: Robot, encoders: Encoders, rng: Generator | None = None
) -> NDArray[np.int64]:
    """Counts `(n + 1, 2)` (right, left) of the encoders before and after each true motion `(n, 2)`.

    A motion is the true advance [m] and turn [rad] of the body. The wheels turn as much as that needs with
    their true radii, track and slip; whole ticks of the total angle are counted, so that nothing is lost
    between two readings. Raises ValueError if slip_noise is used without a random generator.
    """
    moved = np.asarray(motions, dtype=float).reshape(-1, 2)
    half = moved[:, 1] * robot.track * (1.0 + encoders.track_error) / 2.0
    travel = np.stack([moved[:, 0] + half, moved[:, 0] - half], axis=-1) / (1.0 - encoders.slip)
    if encoders.slip_noise > 0.0:
        if rng is None:
            raise ValueError("Encoders.slip_noise needs a random generator: pass rng=np.random.default_rng(seed)")
        travel = travel + encoders.slip_noise * np.sqrt(np.abs(travel)) * rng.standard_normal(travel.shape)
    radii = robot.wheel_radius * (1.0 + np.array([encoders.right_radius_error, encoders.left_radius_error]))
    turns = np.cumsum(travel / (2.0 * np.pi * radii), axis=0)
    counts = np.floor(turns * encoders.ticks_per_turn + 1e-9).astype(np.int64)
    return np.vstack([np.zeros((1, 2), dtype=np.int64), counts])


def odometry(counts: ArrayLike, robot: Robot, ticks_per_turn: int) -> Array:
    """Believed motions `(n, 2)`, advance [m] and turn [rad], between encoder counts `(n + 1, 2)` (right, left).

    Advance (s_R + s_L)/2 and turn (s_R - s_L)/L of the two wheel travels: the unnumbered definitions of thesis
    section 1.3.2, with L the full wheel separation. Counters of an unsigned type run over: their differences are
    taken round the end, so that 65535 to 3 is four ticks on. Raises ValueError for counts that are not finite.

    >>> from fuzzynav.robot import TURTLEBOT2
    >>> over, plain = np.array([[65535, 0], [3, 4]], dtype=np.uint16), [[-1, 0], [3, 4]]
    >>> bool((odometry(over, TURTLEBOT2, 2578) == odometry(plain, TURTLEBOT2, 2578)).all())
    True
    """
    given = np.asarray(counts)
    if given.ndim != 2 or given.shape[1] != 2 or not np.isfinite(given).all():
        raise ValueError(f"counts must be finite rows (right, left), got an array of shape {given.shape}")
    ticks = np.diff(given, axis=0)
    if given.dtype.kind == "u":
        ticks = ticks.astype(given.dtype.name.removeprefix("u"))
    return body_from_rims(wheel_travel(ticks, ticks_per_turn, robot.wheel_radius), robot)


def dead_reckon(start: ArrayLike, motions: ArrayLike) -> Array:
    """Poses `(n + 1, 3)` from a start pose and motions `(n, 2)` of advance [m] and turn [rad], by exact arcs.

    >>> dead_reckon([0, 0, 0], [[np.pi / 2, np.pi / 2]] * 2).round(6).tolist()[-1]    # half a unit circle
    [0.0, 2.0, -3.141593]
    """
    moved = np.asarray(motions, dtype=float).reshape(-1, 2)
    poses = np.empty((len(moved) + 1, 3))
    poses[0] = checks.pose(start, "the start pose")
    poses[0, 2] = wrap(poses[0, 2])
    kernels.chain(poses, moved)
    return poses
