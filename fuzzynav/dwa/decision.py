"""One decision of the dynamic window: which speeds can be reached, which can stop in time, and which is best.

`plan` keeps all its evidence. The steps themselves stand in `steps`, one function for each equation.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.control import FAULTS, Observation
from fuzzynav.dwa import kernels
from fuzzynav.dwa.sight import border
from fuzzynav.dwa.steps import TABLE_3_3, Params, brake, window_as_printed
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import Robot, limits_of

__all__ = ["REASONS", "Field", "Plan", "blind_spots", "plan", "prepared", "rated"]

REASONS: tuple[str, ...] = (
    "admissible",
    "cannot stop before contact",
    "cannot stop turning before contact",
    "above the printed speed bound",
    "above the printed turn bound",
    "nothing was seen there",
    *FAULTS,
)
MOST_SAMPLES = 100_000  # of one window: more is a slip of a resolution
MOST_SPEED = 10.0  # times the robot's own limit: a measured speed beyond it is no speed of this robot
NO_POINTS, NO_RADII = np.empty((0, 2)), np.empty(0)
NO_CHART = (np.empty((0, 0)), np.array([1.0, 0.0, 0.0]))


@dataclass(frozen=True, slots=True, eq=False)
class Field:
    """Distances [m] from cell centres to the nearest obstacle: the other way to tell `plan` what is in the way.

    Where it holds nan nothing is known. Raises ValueError for values that are no table, or a resolution that is not
    positive.
    """

    values: Array  # [row, col]
    resolution: float
    origin: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        values = np.ascontiguousarray(self.values, dtype=float)
        if values.ndim != 2 or not values.size:
            raise ValueError(f"a field is a table of distances [row, col], got an array of shape {values.shape}")
        numbers = (self.resolution, *self.origin)
        if len(numbers) != 3 or not np.isfinite(numbers).all() or not self.resolution > 0:
            raise ValueError(f"a field needs a positive resolution and an origin (x, y), got {numbers}")
        object.__setattr__(self, "values", values)

    @property
    def chart(self) -> tuple[Array, Array]:
        """Values and (resolution, x, y) as the kernels take them."""
        return self.values, np.array([self.resolution, *self.origin])

    @classmethod
    def of(cls, grid: GridMap, resolution: float = 0.05) -> Field:
        """The field of a map, on cells of about `resolution` [m]: the finer, the nearer to the truth from below.

        Raises ValueError for a resolution that is not positive, or that cuts a cell into more than 100 parts.
        """
        if not (np.isfinite(resolution) and 0.01 * grid.resolution <= resolution):
            raise ValueError(
                f"the resolution of a field must be positive and at least a hundredth of a cell, "
                f"{0.01 * grid.resolution:g} m, got {resolution}"
            )
        parts = max(int(np.ceil(grid.resolution / resolution - 1e-9)), 1)
        cells = np.kron(grid.occupied, np.ones((parts, parts), dtype=bool))
        fine = GridMap(cells, grid.resolution / parts, grid.origin)
        return cls(np.ascontiguousarray(fine.distance_field()), fine.resolution, fine.origin)


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """One decision with all its evidence; row k of every array belongs to sample k.

    The last sample is the emergency candidate. `chosen` is the sample driven; `braking` says that it is the emergency
    candidate because nothing was admissible.
    """

    command: Array  # (2,)
    samples: Array  # (n, 2)
    scores: Array  # (n, 3) shares of heading, distance and speed; 0 where refused
    raw: Array  # (n, 3) before normalising: [deg], [m], [m/s]
    totals: Array  # (n,) nan where refused
    admissible: NDArray[np.bool_]  # (n,)
    reasons: NDArray[np.int64]  # (n,) index into REASONS
    free: Array  # (n,) [m] along the arc to first contact with what was sensed; inf if none within reach or in time
    known: Array  # (n,) [m] along the arc inside what the beams have crossed; never more than free
    stopping: Array  # (n,) [m]
    weights: Array  # (3,)
    chosen: int
    braking: bool
    nearest: float  # [m] from the rim to the nearest sensed point; inf if there is none

    @property
    def blind(self) -> bool:
        """Whether the robot may drive nowhere, and for no other reason than that it was told too little."""
        return bool(kernels.is_blind(self.samples, self.reasons))


def blind_spots(observation: Observation, robot: Robot, params: Params = TABLE_3_3) -> tuple[Array, Array]:
    """Border of what the beams have crossed: points `(n, 2)` [m] and their radii `(n,)` [m]; empty without a scan.

    Whoever stays inside it meets no standing obstacle, seen or unseen, that is as thick as `params.thinnest`; where
    and why the ground counts as known, `dwa.sight` says.
    """
    points, radii, _ = _border(observation, prepared(robot, params))
    return points, radii


def plan(
    observation: Observation,
    robot: Robot,
    params: Params = TABLE_3_3,
    *,
    weights: ArrayLike | None = None,
    field: Field | None = None,
) -> Plan:
    """The best admissible speeds for the next step; with none admissible the robot brakes on the arc it is on.

    Obstacles are the observation's points, a distance field, or both. Points that have a velocity keep it: the way to
    them is that until the robot and the point meet, and a sample is refused if something that moves would meet the
    robot while it brakes. What a scan has not shown is not free, unless a
    field says so, or `params.blind` is False; an observation without a scan says that its points are all there is.
    Where a sensor fails (pose, points or range not finite), every sample is refused and REASONS names the fault.
    `weights` overrides those of the parameters. Raises ValueError for shapes that do not fit, for a speed of more than
    ten times the robot's limit, a goal or weights that are not finite, and weights that are negative or all zero.

    Source: thesis eq 3.16.
    """
    ready = prepared(robot, params)
    fault = observation.faults()
    v, omega = float(observation.velocity[0]), float(observation.velocity[1])
    if abs(v) > ready.fastest[0] or abs(omega) > ready.fastest[1]:
        raise ValueError(
            f"the robot cannot drive at {v:g} m/s and {omega:g} rad/s: that is more than {MOST_SPEED:g} times "
            f"the limits of {robot.name}"
        )
    if params.sampling == "closed":
        samples = kernels.window(v, omega, ready.limits[0], ready.settings[0])
    else:
        samples = np.vstack([window_as_printed((v, omega), robot, params), brake((v, omega), robot, params.dt)])
    w = ready.weights if weights is None else _checked(weights)
    return _refused(samples, fault, w) if fault else rated(observation, ready, samples, w, field)


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """What the kernels need of one robot and its parameters."""

    robot: Robot
    params: Params
    limits: Array  # one record of robot.kernels.LIMITS
    settings: Array  # one record of dwa.kernels.SETTINGS
    corners: Array  # (n, 2) of the footprint; none for the disc
    weights: Array
    fastest: tuple[float, float]  # [m/s], [rad/s] no measured speed is beyond it


@lru_cache(maxsize=64)
def prepared(robot: Robot, params: Params) -> Prepared:
    """The arrays of a robot and its parameters."""
    gain, spin = max(robot.acc_lim_x, robot.dec_lim_x) * params.dt, robot.acc_lim_theta * params.dt
    count = (2.0 * gain / params.v_resolution + 2.0) * (2.0 * spin / params.omega_resolution + 2.0)
    if count > MOST_SAMPLES:
        raise ValueError(
            f"v_resolution {params.v_resolution:g} and omega_resolution {params.omega_resolution:g} make windows of "
            f"{count:.0f} samples; at most {MOST_SAMPLES} are allowed"
        )
    corners = NO_POINTS if params.footprint is None else np.array(params.footprint, dtype=float)
    fastest = (MOST_SPEED * max(robot.max_vel_x, -robot.min_vel_x), MOST_SPEED * robot.max_vel_theta)
    weights = np.array(params.weights, dtype=float)
    return Prepared(robot, params, limits_of(robot), params.settings, corners, weights, fastest)


def _checked(weights: ArrayLike) -> Array:
    """Three weights, or a ValueError."""
    w = np.asarray(weights, dtype=float)
    if w.shape != (3,) or not (min(w.tolist()) >= 0 and 0 < w[0] + w[1] + w[2] < np.inf):
        raise ValueError(f"weights must be three finite numbers, none negative and not all zero, got {w.tolist()}")
    return w


def _border(observation: Observation, ready: Prepared) -> tuple[Array, Array, int]:
    """Border of what the beams have crossed, its radii, and how many of its points bound gaps between beams."""
    if observation.ranges is None or observation.angles is None:
        return NO_POINTS, NO_RADII, 0
    ranges = np.ascontiguousarray(observation.ranges, dtype=float)
    angles = np.ascontiguousarray(observation.angles, dtype=float)
    pose, size = np.asarray(observation.pose, dtype=float), float(ready.robot.radius)
    if len(ready.corners):
        size = float(np.sqrt((ready.corners**2).sum(axis=1).max()))
    reach = float(observation.range_max)
    found: tuple[Array, Array, int] = border(
        ranges, angles, pose, reach, size, ready.corners, float(ready.params.thinnest)
    )
    return found


def _charted(observation: Observation, field: Field | None) -> bool:
    """Whether a map says what the beams have not shown; a scan in which no beam lives speaks against any map."""
    if field is None:
        return False
    ranges = observation.ranges
    return ranges is None or not len(ranges) or not bool(np.isnan(ranges).all())


def _drift(velocities: ArrayLike, count: int) -> Array:
    """Velocities of the points `(count, 2)` [m/s], or a ValueError."""
    found = np.ascontiguousarray(velocities, dtype=float)
    if (found.shape != (count, 2) and (found.size or count)) or not np.isfinite(found).all():
        raise ValueError(f"point_velocities must be {count} finite rows, one for each point, got {found.tolist()}")
    return found.reshape(-1, 2)


def rated(observation: Observation, ready: Prepared, samples: Array, weights: Array, field: Field | None) -> Plan:
    """Rate samples, of which the last is the emergency candidate, and choose."""
    seen = (NO_POINTS, NO_RADII, 0)
    if ready.params.blind and not _charted(observation, field):
        seen = _border(observation, ready)
    points = np.ascontiguousarray(observation.points, dtype=float).reshape(-1, 2)
    drift = NO_POINTS if observation.point_velocities is None else _drift(observation.point_velocities, len(points))
    raw, ways, reasons, shares, totals, best, nearest = kernels.decide(
        samples,
        np.asarray(observation.pose, dtype=float),
        np.asarray(observation.goal, dtype=float),
        (points, drift, *seen),
        NO_CHART if field is None else field.chart,
        (ready.limits, ready.corners),
        ready.settings,
        weights,
    )
    chosen = len(samples) - 1 if best < 0 else best
    return Plan(
        command=samples[chosen].copy(),
        samples=samples,
        scores=shares,
        raw=raw,
        totals=totals,
        admissible=reasons == kernels.ADMISSIBLE,
        reasons=reasons,
        free=ways[:, 0],
        known=ways[:, 1],
        stopping=ways[:, 3],
        weights=weights.copy(),
        chosen=chosen,
        braking=best < 0,
        nearest=float(nearest),
    )


def _refused(samples: Array, fault: str, weights: Array) -> Plan:
    """The plan of a robot whose sensors fail: no sample is admissible, it brakes."""
    n = len(samples)
    blank = np.full(n, np.nan)
    return Plan(
        command=samples[-1].copy(),
        samples=samples,
        scores=np.zeros((n, 3)),
        raw=np.full((n, 3), np.nan),
        totals=blank,
        admissible=np.zeros(n, dtype=bool),
        reasons=np.full(n, REASONS.index(fault)),
        free=blank,
        known=blank,
        stopping=blank,
        weights=weights.copy(),
        chosen=n - 1,
        braking=True,
        nearest=float("nan"),
    )
