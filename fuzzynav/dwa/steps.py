"""The dynamic window in the open: its parameters, and one function for each equation.

They work on arrays of samples `(n, 2)` of v [m/s] and omega [rad/s]; `dwa.plan` runs the same steps compiled.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.checks import not_negative, one_of, positive
from fuzzynav.dwa import kernels
from fuzzynav.dwa.contact import arc_contact, near_points
from fuzzynav.geometry import Array, wrap
from fuzzynav.robot import Robot, limit, limits_of, move

__all__ = [
    "TABLE_3_3",
    "TABLE_4_1",
    "Params",
    "admissible",
    "admissible_as_printed",
    "arcs",
    "brake",
    "distance_score",
    "end_clearance",
    "free_distance",
    "heading_score",
    "normalise",
    "objective",
    "speed_score",
    "step",
    "step_as_printed",
    "stopping_distance",
    "window",
    "window_as_printed",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Params:
    """Parameters of the dynamic window; SI units.

    The defaults are thesis table 3.3, with the resolution that can start (errata T31) and our choices for what it
    does not print: dt, d_max. Raises ValueError for weights below zero or all zero, and for a horizon under one step.

    `thinnest` is a promise about the world: no obstacle is thinner, and none has a corner under 90 degrees. Between two
    beams the ground is known as far as nothing of that size can hide (`dwa.sight`).
    """

    weights: tuple[float, float, float] = (0.8, 0.1, 0.1)  # heading, distance, speed
    sim_time: float = 3.0  # [s] how far ahead the arcs are followed
    dt: float = 0.1  # [s] between two commands
    v_resolution: float = 0.01  # [m/s]
    omega_resolution: float = 0.017  # [rad/s]
    d_max: float = 2.0  # [m] clearances beyond it score alike
    margin: float = 0.0  # [m] kept free beyond the stopping distance
    reaction: float = 0.0  # [s] of lag allowed for in the stopping distance
    distance: Literal["arc", "end"] = "arc"  # scored: way to first contact, or clearance at the end of the arc
    bound: Literal["arc", "as_printed"] = "arc"  # what is admissible: braking on the arc, or eq 3.15 as printed
    sampling: Literal["closed", "as_printed"] = "closed"  # both ends of the window, or steps from its lower end
    blind: bool = True  # what no beam has crossed counts as occupied for braking
    thinnest: float = 0.2  # [m] of the obstacles that a scan must not miss
    footprint: tuple[tuple[float, float], ...] | None = None  # convex, counter-clockwise [m]; None: the disc

    def __post_init__(self) -> None:
        w = np.asarray(self.weights, dtype=float)
        if w.shape != (3,) or not np.isfinite(w).all() or w.min() < 0 or not 0 < w.sum() < np.inf:
            raise ValueError(f"weights must be three numbers, none negative and not all zero, got {self.weights}")
        for name in ("sim_time", "dt", "v_resolution", "omega_resolution", "d_max", "thinnest"):
            positive(**{name: getattr(self, name)})
        if self.sim_time < self.dt:
            raise ValueError(f"the horizon sim_time {self.sim_time} s is shorter than one step of {self.dt} s")
        not_negative(margin=self.margin, reaction=self.reaction)
        one_of(("arc", "end"), distance=self.distance)
        one_of(("arc", "as_printed"), bound=self.bound)
        one_of(("closed", "as_printed"), sampling=self.sampling)
        if self.footprint is not None and not _convex(np.asarray(self.footprint, dtype=float)):
            raise ValueError("the footprint must be a convex polygon, counter-clockwise, around the origin")

        if not isinstance(self.weights, tuple):
            object.__setattr__(self, "weights", tuple(w.tolist()))
        if self.footprint is not None:
            object.__setattr__(self, "footprint", tuple((float(x), float(y)) for x, y in self.footprint))

    @property
    def settings(self) -> Array:
        """The parameters as the kernels take them: an array of one `kernels.SETTINGS` record."""
        plain = (*(getattr(self, name) for name in kernels.NUMBERS), self.distance == "end")
        return np.array([(*plain, self.bound == "as_printed", self.blind)], dtype=kernels.SETTINGS)


TABLE_3_3 = Params()
TABLE_4_1 = Params(weights=(0.05, 0.2, 0.3))


# --- the steps, one by one -----------------------------------------------------------------------


def window(velocity: ArrayLike, robot: Robot, params: Params = TABLE_3_3) -> Array:
    """Samples `(n, 2)` of the speeds within reach: both ends of the window, zero, and last the emergency candidate.

    Source: thesis eq 4.11 and 4.12 (errata T36).

    >>> from fuzzynav.robot import THESIS
    >>> window([0.5, 0.0], THESIS)[:, 0].max().round(3).item()
    0.52
    """
    v, omega = np.asarray(velocity, dtype=float)
    return np.asarray(kernels.window(v, omega, limits_of(robot)[0], params.settings[0]))


def window_as_printed(velocity: ArrayLike, robot: Robot, params: Params = TABLE_3_3) -> Array:
    """Samples `(n, 2)` in steps from the lower end of the window: the upper end is met by chance only (errata T31)."""
    low = limit([robot.min_vel_x, -robot.max_vel_theta], velocity, robot, params.dt)
    high = limit([robot.max_vel_x, robot.max_vel_theta], velocity, robot, params.dt)
    v = np.arange(low[0], high[0], params.v_resolution)
    omega = np.arange(low[1], high[1], params.omega_resolution)
    return np.stack(np.meshgrid(v, omega, indexing="ij"), axis=-1).reshape(-1, 2)


def brake(velocity: ArrayLike, robot: Robot, dt: float) -> Array:
    """The emergency candidate `(2,)`: full braking on the same arc, so that it stays where it was found free."""
    v, omega = np.asarray(velocity, dtype=float)
    return np.array(kernels.brake(v, omega, limits_of(robot)[0], dt))


def arcs(pose: ArrayLike, samples: ArrayLike, times: ArrayLike) -> Array:
    """Poses `(n, t, 3)` along the exact arcs of samples `(n, 2)` at times `(t,)` [s]."""
    return move(np.asarray(pose, dtype=float), np.asarray(samples, dtype=float)[:, None, :], np.asarray(times)[None, :])


def step(pose: ArrayLike, velocity: ArrayLike, omega: float, dt: float) -> Array:
    """Pose `(3,)` one Euler step on, for body-frame velocities (v_x, v_y) [m/s].

    Source: thesis eq 4.10 (errata T32).

    >>> step([0, 0, 0], [1.0, 0.0], 0.0, 1.0).tolist()
    [1.0, 0.0, 0.0]
    """
    (x, y, theta), (vx, vy) = np.asarray(pose, dtype=float), np.asarray(velocity, dtype=float)
    c, s = np.cos(theta), np.sin(theta)
    return np.array([x + (vx * c - vy * s) * dt, y + (vx * s + vy * c) * dt, float(wrap(theta + omega * dt))])


def step_as_printed(pose: ArrayLike, velocity: ArrayLike, omega: float, dt: float) -> Array:
    """Eq 4.10 as printed: without v_y the robot can only move along y = x."""
    (x, y, theta), (vx, vy) = np.asarray(pose, dtype=float), np.asarray(velocity, dtype=float)
    c, s = np.cos(theta), np.sin(theta)
    return np.array([x + (vx * c - vy * s) * dt, y + (vy * s + vx * c) * dt, float(wrap(theta + omega * dt))])


def free_distance(pose: ArrayLike, samples: ArrayLike, points: ArrayLike, radius: float) -> Array:
    """Way `(n,)` [m] along each arc until a disc first touches one of the points; inf if it never does.

    >>> free_distance([0, 0, 0], [[1.0, 0.0]], [[2.0, 0.0]], 0.3).round(3).tolist()
    [1.7]
    """
    pts = np.ascontiguousarray(np.asarray(points, dtype=float).reshape(-1, 2))
    near, _ = near_points(np.asarray(pose, dtype=float), pts, np.zeros(len(pts)), radius, np.inf)
    return np.array([arc_contact(v, w, near) for v, w in np.asarray(samples, dtype=float)])


def end_clearance(pose: ArrayLike, samples: ArrayLike, points: ArrayLike, radius: float, sim_time: float) -> Array:
    """Clearance `(n,)` [m] at the end of each predicted arc, which is what the thesis calls dist (errata T35)."""
    end = arcs(pose, samples, [sim_time])[:, 0, None, :2]
    gaps = np.linalg.norm(end - np.asarray(points, dtype=float).reshape(1, -1, 2), axis=-1)
    found: Array = np.maximum(gaps.min(axis=1, initial=np.inf) - radius, 0.0)
    return found


def stopping_distance(samples: ArrayLike, robot: Robot, dt: float) -> Array:
    """Way `(n,)` [m] on the arc while v is held for dt and then lowered step by step: v^2/2a + v dt/2.

    The deceleration is the lesser of dec_lim_x and what lets omega shrink with v, so that the arc stays the same.

    >>> from fuzzynav.robot import THESIS
    >>> stopping_distance([[1.0, 0.0]], THESIS, 0.1).round(3).tolist()
    [2.55]
    """
    lim = limits_of(robot)[0]
    rows = np.asarray(samples, dtype=float).reshape(-1, 2)
    return np.array([kernels.stopping(v, kernels.braking(v, w, lim), dt) for v, w in rows])


def admissible(samples: ArrayLike, free: ArrayLike, robot: Robot, dt: float) -> NDArray[np.bool_]:
    """Samples that stop before contact: v and omega fall to zero on the arc within the free way [m].

    Source: thesis eq 3.15 and 4.13 (errata T34, T35, T36): the free way is taken along the arc, and the turn is bounded
    by |omega| <= 2 dist acc_lim_theta/v.
    """
    return stopping_distance(samples, robot, dt) <= np.asarray(free, dtype=float)


def admissible_as_printed(samples: ArrayLike, dist: ArrayLike, robot: Robot) -> NDArray[np.bool_]:
    """Eq 3.15 as printed: dist [m] from the end of the arc, a turn bound in wrong units that spares right turns."""
    s, d = np.asarray(samples, dtype=float), np.asarray(dist, dtype=float)
    return (s[:, 0] <= np.sqrt(2 * d * robot.dec_lim_x)) & (s[:, 1] <= np.sqrt(2 * d * robot.acc_lim_theta))


def heading_score(pose: ArrayLike, samples: ArrayLike, goal: ArrayLike, sim_time: float) -> Array:
    """180 minus the angle [deg] between the heading at the end of each arc and the direction from there to the goal.

    Source: thesis eq 3.18.
    """
    end = arcs(pose, samples, [sim_time])[:, 0]
    dx, dy = np.asarray(goal, dtype=float)[:2, None] - end[:, :2].T
    return 180.0 - np.degrees(np.abs(wrap(np.arctan2(dy, dx) - end[:, 2])))


def distance_score(distance: ArrayLike, d_max: float) -> Array:
    """The distance [m], cut at d_max.

    Source: thesis eq 3.19.
    """
    found: Array = np.minimum(np.asarray(distance, dtype=float), d_max)
    return found


def speed_score(samples: ArrayLike) -> Array:
    """The forward speed [m/s]; driving backwards earns nothing.

    Source: thesis eq 3.20.
    """
    found: Array = np.maximum(np.asarray(samples, dtype=float)[:, 0], 0.0)
    return found


def normalise(raw: ArrayLike) -> Array:
    """Each score divided by its sum over the candidates, column by column; zeros where the sum is 0.

    Source: thesis eq 3.21 (errata T38: shares that add to 1, not values spread over [0, 1]).

    >>> normalise([180.0, 170.0, 160.0, 150.0, 140.0]).round(4).tolist()
    [0.225, 0.2125, 0.2, 0.1875, 0.175]
    """
    values = np.asarray(raw, dtype=float)
    whole = values.sum(axis=0)
    return np.where(whole > 0, values / np.where(whole > 0, whole, 1.0), 0.0)


def objective(shares: ArrayLike, weights: ArrayLike) -> Array:
    """The weighted sum of shares `(n, 3)`; normalising is the sigma of the formula and has already happened.

    Source: thesis eq 3.17 and 4.14 (errata T37, T39).
    """
    found: Array = np.asarray(shares, dtype=float) @ np.asarray(weights, dtype=float)
    return found


def _convex(corners: Array) -> bool:
    """Whether corners `(n, 2)` go counter-clockwise around the origin without a dent."""
    if corners.ndim != 2 or corners.shape[0] < 3 or corners.shape[1] != 2 or not np.isfinite(corners).all():
        return False
    edges, after = np.roll(corners, -1, axis=0) - corners, np.roll(corners, -1, axis=0)
    bends = edges[:, 0] * np.roll(edges, -1, axis=0)[:, 1] - edges[:, 1] * np.roll(edges, -1, axis=0)[:, 0]
    around = corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0]
    return bool((bends > 0).all() and (around > 0).all())
