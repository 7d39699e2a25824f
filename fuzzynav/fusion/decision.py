"""One decision among movers: its parameters, the decision, and all its evidence."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.checks import not_negative, positive, share
from fuzzynav.control import Observation
from fuzzynav.fusion import kernels
from fuzzynav.fusion.evasion import EVASION
from fuzzynav.fusion.objective import checked_weights
from fuzzynav.fusion.sensed import NO_ROWS, Surroundings
from fuzzynav.fusion.subgoals import arc_cap
from fuzzynav.geometry import Array
from fuzzynav.robot import Robot, limits_of

__all__ = ["EVADING", "REASONS", "Decision", "Evasion", "Params", "decide"]

REASONS: tuple[str, ...] = (
    "admissible",
    "cannot stop before contact",
    "nothing was seen there",
    "a mover could be there before the robot stands",
)
SLOWEST = 0.05  # of the top speed: no sub-goal caps the speed below it


@dataclass(frozen=True, slots=True, kw_only=True)
class Evasion:
    """How a robot evades movers that do not yield; all ours.

    A speed is held for `hold`, then another one until the end of the prediction. Its promise is the share of the way at
    top speed that it gains towards the target, of which `early` is the share of the first moment, less `dread` times
    the greatest nearness to a mover, exp(-gap / scale - time / fade). Raises ValueError for values out of range.
    """

    hold: float = 1.0  # [s]
    early: float = 0.3
    dread: float = 3.0
    scale: float = 0.3  # [m]
    fade: float = 4.0  # [s]

    def __post_init__(self) -> None:
        positive(hold=self.hold, scale=self.scale, fade=self.fade)
        not_negative(dread=self.dread)
        share(early=self.early)


@dataclass(frozen=True, slots=True, kw_only=True)
class Params:
    """Parameters of a decision; SI units. They are ours.

    `guard`: movers may be anywhere that the speed bound lets them be; without it they are taken to stand where they
    are. `sim_time` 0 switches the prediction off, `reserve` and `creep` 0 the distance that is kept on top of the
    guarantee. Raises ValueError for weights below zero or all zero, and for lengths and times that are negative.
    """

    weights: tuple[float, float, float, float] = (0.4, 0.1, 0.2, 0.1)  # alpha, beta, gamma, delta of eq 4.15
    dt: float = 0.1  # [s] between two commands
    sim_time: float = 3.0  # [s] how far ahead movers are predicted
    growth: float = 0.1  # [m/s] of a prediction's uncertainty
    aim_turn: float = 0.3  # [rad] that the outermost turn of a window makes until the heading is looked at
    aim_time: tuple[float, float] = (0.4, 3.0)  # [s] but not sooner, and not later
    v_samples: int = 11  # across a window
    omega_samples: int = 21
    d_max: float = 2.0  # [m] clearances beyond it score alike
    margin: float = 0.01  # [m] kept from what stands
    thinnest: float = 0.2  # [m] of the obstacles that a scan must not miss
    guard: bool = True
    evasion: Evasion | None = None  # rather out of the guarantee than struck: for movers that do not yield
    hidden: bool = False  # what was not seen may hide a mover
    error: float = 0.0  # [m] bound of the error of places, of odometry and of tracks together
    reserve: float = 0.15  # [m] kept from where movers can be, by a robot faster than creep
    aside: float = 0.12  # [m] kept from where movers are
    creep: float = 0.05  # [m/s] a robot this slow counts as standing
    cap: bool = True  # no faster than the arc through the sub-goal allows

    def __post_init__(self) -> None:
        checked_weights(self.weights)
        positive(dt=self.dt, aim_turn=self.aim_turn, d_max=self.d_max, thinnest=self.thinnest)
        for name in ("sim_time", "growth", "margin", "error", "reserve", "aside", "creep"):
            not_negative(**{name: getattr(self, name)})
        if not 0 < self.aim_time[0] <= self.aim_time[1] < np.inf:
            raise ValueError(f"aim_time must be two rising positive times, got {self.aim_time}")
        if self.v_samples < 2 or self.omega_samples < 3:
            raise ValueError(f"a window needs 2 x 3 samples or more, got {self.v_samples} x {self.omega_samples}")


EVADING = Params(
    evasion=Evasion(),
    v_samples=3,  # few, because each is followed by many others
    omega_samples=11,
    aside=0.02,  # what is predicted to leave is no obstacle
    cap=False,  # a detour may be wide
)


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """One decision with all its evidence; row k of every array belongs to sample k, the last is the emergency one.

    `raw` holds the four terms of eq 4.15, `scores` their shares; both count among the samples that are `eligible`:
    admissible, and without a predicted contact where there is such a one, otherwise with the latest. Of a robot that
    evades `totals` are promises, of every sample that what stands admits, there are no shares, and the time of the
    predicted contact is that of the best go on.
    """

    command: Array  # (2,)
    target: Array  # (2,) [m]
    samples: Array  # (n, 2)
    raw: Array  # (n, 4) heading [deg], clearance of what stands [m], speed [m/s], clearance of movers [m]
    scores: Array  # (n, 4)
    totals: Array  # (n,) nan where not eligible
    reasons: NDArray[np.int64]  # (n,) index into REASONS
    ways: Array  # (n, 5) free, known, stopping [m], least predicted gap [m], time of the predicted contact [s]
    chosen: int
    braking: bool  # the emergency sample, because none is admissible

    @property
    def eligible(self) -> NDArray[np.bool_]:
        """Samples `(n,)` among which the objective chooses."""
        return ~np.isnan(self.totals)


def decide(
    observation: Observation,
    target: ArrayLike,
    around: Surroundings,
    robot: Robot,
    params: Params,
    speed_bound: float,
) -> Decision:
    """The best speeds for the next step towards `target`, among movers no faster than `speed_bound` [m/s].

    A speed is admissible if the robot, driving it for a step and then braking on the same arc, touches nothing that
    stands, leaves no ground that was seen, and stays clear of every place that a hazard can have reached by then. A
    robot that stands, or turns in place, satisfies that always. Among the admissible ones those count whose arc is free
    of predicted contact. With none admissible the robot brakes on its arc: that was admissible a step before. A robot
    that evades (`params.evasion`) does not ask what hazards can reach: it takes the speed that promises most.
    """
    here, aim = np.asarray(observation.pose, dtype=float), np.asarray(target, dtype=float)
    cap = max(arc_cap(here, aim, robot.max_vel_theta), SLOWEST * robot.max_vel_x) if params.cap else robot.max_vel_x
    settings, weights, evasion = _settings(robot, params, float(speed_bound))
    samples, raw, ways, reasons, shares, totals, best = kernels.decide(
        np.asarray(observation.velocity, dtype=float),
        here,
        aim,
        _sensed(around, params, speed_bound),
        (limits_of(robot), min(cap, robot.max_vel_x), evasion),
        settings,
        weights,
    )
    chosen = len(samples) - 1 if best < 0 else best
    return Decision(
        command=samples[chosen].copy(),
        target=aim.copy(),
        samples=samples,
        raw=raw,
        scores=shares,
        totals=totals,
        reasons=reasons,
        ways=ways,
        chosen=chosen,
        braking=best < 0,
    )


@lru_cache(maxsize=256)
def _settings(robot: Robot, params: Params, speed_bound: float) -> tuple[Array, Array, Array]:
    """Settings, weights and how to evade as the kernels take them."""
    wide = min((robot.acc_lim_x + robot.dec_lim_x) * params.dt, robot.max_vel_x - robot.min_vel_x)
    turn = min(robot.acc_lim_theta * params.dt, robot.max_vel_theta)
    aim = min(max(params.aim_turn / turn, params.aim_time[0]), params.aim_time[1])
    bound = speed_bound if params.guard else 0.0
    reserve, aside = (params.reserve, params.aside) if bound > 0.0 else (0.0, params.margin)
    values = (
        params.dt, params.sim_time, aim, wide / (params.v_samples - 1), 2.0 * turn / (params.omega_samples - 1),
        params.d_max, params.margin, bound, reserve, aside, params.creep + 1e-9, params.growth,
        params.evasion is not None,
    )  # fmt: skip
    own = params.evasion or Evasion()
    flight = (params.sim_time, own.hold, own.early, own.dread, own.scale, own.fade, params.growth)
    return (
        np.array([values], dtype=kernels.SETTINGS),
        np.array(params.weights),
        np.array([flight], dtype=EVASION),
    )


def _sensed(around: Surroundings, params: Params, speed_bound: float) -> tuple[Array, Array, Array, int, Array, Array]:
    """The surroundings as the kernels take them."""
    hazards = around.hazards
    if params.guard and params.hidden and speed_bound > 0.0:
        hazards = np.vstack([hazards, np.column_stack([around.border, around.radii])])
    if params.error > 0.0:
        hazards = hazards + np.array([0.0, 0.0, params.error])
    tracks = around.movers if params.sim_time > 0.0 else NO_ROWS
    return around.points, around.border, around.radii, around.holes, hazards, tracks
