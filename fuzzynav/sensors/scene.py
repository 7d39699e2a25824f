"""Encoders, sonar and laser scanner: the ideal reading, its faults, and the points it stands for.

A sensor is described by a frozen dataclass; a measurement takes the truth, the sensor and a random generator.
Cameras stand in `cameras`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

from fuzzynav.geometry import Array, to_world, wrap
from fuzzynav.robot import Robot, body_from_rims

if TYPE_CHECKING:
    from fuzzynav.maps.gridmap import GridMap
    from fuzzynav.world import World

__all__ = [
    "SPEED_OF_LIGHT",
    "SPEED_OF_LIGHT_AS_PRINTED",
    "SPEED_OF_SOUND",
    "Encoders",
    "Laser",
    "Scan",
    "Sonar",
    "cast_scene",
    "dead_reckon",
    "encoder_counts",
    "laser_faults",
    "laser_ideal",
    "laser_range",
    "laser_scan",
    "odometry",
    "polar_to_points",
    "sonar_cone",
    "sonar_ideal",
    "sonar_range",
    "sonar_reading",
    "wheel_angle",
    "wheel_travel",
]

SPEED_OF_SOUND = 343.0  # [m/s] in air of 20 degrees C, thesis section 1.3.3
SPEED_OF_LIGHT = 299_792_458.0  # [m/s] exact
SPEED_OF_LIGHT_AS_PRINTED = 3e8  # [m/s] thesis section 1.3.4, 0.069 % high (errata T68)


def _check(model: Any, *, positive: tuple[str, ...] = (), share: tuple[str, ...] = ()) -> None:
    """Refuse fields that are not finite, not `positive`, or no `share` in [0, 1]; all others must not be negative."""
    for field in fields(model):
        value = getattr(model, field.name)
        wish, good = "finite and not negative", np.isfinite(value) and value >= 0
        if field.name in positive:
            wish, good = "finite and positive", np.isfinite(value) and value > 0
        if field.name in share:
            wish, good = "a number in [0, 1]", 0 <= value <= 1
        if not good:
            raise ValueError(f"{type(model).__name__}.{field.name} must be {wish}, got {value}")


def _pose(pose: ArrayLike) -> Array:
    """One finite pose `(3,)`, or a ValueError."""
    p = np.asarray(pose, dtype=float)
    if p.shape != (3,) or not np.isfinite(p).all():
        raise ValueError(f"a pose is three finite numbers x, y, theta, got {p.tolist()}")
    return p


def cast_scene(
    scene: World | GridMap, pose: ArrayLike, angles: Array, range_max: float, movers: ArrayLike | None = None
) -> Array:
    """Ranges `(n,)` [m] of beams in a map, or in a whole world with its moving obstacles at `movers` `(m, 2)` [m].

    Without `movers` they stand where they start. Raises ValueError for a pose that is not finite, or for movers in
    a map, which has none.
    """
    if movers is None:
        return np.asarray(scene.cast(_pose(pose), angles, range_max), dtype=float)
    if not hasattr(scene, "movers"):
        raise ValueError("a map has no moving obstacles: give a World, or leave movers out")
    return np.asarray(scene.cast(_pose(pose), angles, range_max, movers), dtype=float)  # type: ignore[arg-type]


# --- wheel encoders ----------------------------------------------------------------------------


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


def wheel_angle(ticks: ArrayLike, ticks_per_turn: int) -> Array:
    """Wheel angle [rad] of a number of encoder ticks.

    Source: thesis eq 1.2.

    >>> float(wheel_angle(256, 1024).round(4))
    1.5708
    """
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
    section 1.3.2, with L the full wheel separation.
    """
    ticks = np.diff(np.asarray(counts, dtype=float).reshape(-1, 2), axis=0)
    return body_from_rims(wheel_travel(ticks, ticks_per_turn, robot.wheel_radius), robot)


def dead_reckon(start: ArrayLike, motions: ArrayLike) -> Array:
    """Poses `(n + 1, 3)` from a start pose and motions `(n, 2)` of advance [m] and turn [rad], by exact arcs.

    >>> dead_reckon([0, 0, 0], [[np.pi / 2, np.pi / 2]] * 2).round(6).tolist()[-1]    # half a unit circle
    [0.0, 2.0, -3.141593]
    """
    pose, moved = _pose(start), np.asarray(motions, dtype=float).reshape(-1, 2)
    heading = pose[2] + np.concatenate([[0.0], np.cumsum(moved[:, 1])])
    chord = moved[:, 0] * np.sinc(moved[:, 1] / (2.0 * np.pi))
    middle = heading[:-1] + moved[:, 1] / 2.0
    steps = np.stack([chord * np.cos(middle), chord * np.sin(middle)], axis=-1)
    xy = pose[:2] + np.vstack([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    return np.column_stack([xy, wrap(heading)])


# --- sonar -------------------------------------------------------------------------------------


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
        _check(self, positive=("range_max", "cone", "specular_angle", "rays"))
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


# --- laser -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Laser:
    """A scanning laser range finder; `field_of_view` [rad] is centred ahead, the first beam is the rightmost.

    `noise` [m] is the standard deviation of a range, `dropout` the share of beams that return nothing.
    Raises ValueError for zero beams, negative noise and other impossible values.
    """

    beams: int = 181
    field_of_view: float = np.pi
    range_min: float = 0.05
    range_max: float = 8.0
    noise: float = 0.01
    dropout: float = 0.0

    def __post_init__(self) -> None:
        _check(self, positive=("beams", "range_max"), share=("dropout",))
        if self.beams != int(self.beams):
            raise ValueError(f"Laser.beams must be a whole number, got {self.beams}")
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
    Raises ValueError if the shapes differ, there is no beam, an angle is not finite or a range is negative.
    """

    angles: Array
    ranges: Array
    range_max: float

    def __post_init__(self) -> None:
        angles, ranges = np.array(self.angles, dtype=float), np.array(self.ranges, dtype=float)
        if angles.ndim != 1 or angles.shape != ranges.shape or angles.size == 0:
            raise ValueError(f"a scan needs as many ranges as angles, at least one: {angles.shape}, {ranges.shape}")
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
        return to_world(_pose(pose), self.points)


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
