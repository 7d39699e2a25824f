"""What one decision among movers rests on, and its record."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from fuzzynav.checks import not_negative, positive
from fuzzynav.fusion import kernels
from fuzzynav.geometry import Array
from fuzzynav.robot import Robot, limits_of

__all__ = ["REASONS", "Decision", "Params", "settings_of"]

REASONS: tuple[str, ...] = (
    "admissible",
    "cannot stop before contact",
    "nothing was seen there",
    "a mover could be there before the robot stands",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Params:
    """Parameters of the planner of chapter 07; SI units. All but alpha, beta and gamma are ours.

    Raises ValueError for weights below zero or all zero, and for lengths and times that are negative.
    """

    weights: tuple[float, float, float, float] = (0.4, 0.1, 0.2, 0.1)  # alpha, beta, gamma, delta of eq 4.15
    dt: float = 0.1  # [s] between two commands
    sim_time: float = 3.0  # [s] how far ahead movers are predicted; 0: not at all
    aim_time: float = 1.0  # [s] when the heading of an arc is looked at
    v_samples: int = 11  # of a whole window
    omega_samples: int = 21
    d_max: float = 2.0  # [m] clearances beyond it score alike
    margin: float = 0.01  # [m] kept from what stands, where the robot is not nearer already
    error: float = 0.0  # [m] bound of the position error of movers
    growth: float = 0.1  # [m/s] of a prediction's uncertainty
    reserve: float = 0.15  # [m] kept from where movers may be, by a robot faster than creep
    aside: float = 0.12  # [m] kept from where movers are now, where they are not nearer already
    creep: float = 0.05  # [m/s] a robot this slow counts as standing
    guard: bool = True  # movers may be anywhere within the speed bound; False: they are trusted to stand
    hidden: bool = False  # what was not seen may hide a mover
    thinnest: float = 0.2  # [m] of the obstacles that a scan must not miss

    def __post_init__(self) -> None:
        w = np.asarray(self.weights, dtype=float)
        if w.shape != (4,) or not np.isfinite(w).all() or w.min() < 0 or not w.sum() > 0:
            raise ValueError(f"weights must be four numbers, none negative and not all zero, got {self.weights}")
        positive(dt=self.dt, aim_time=self.aim_time, d_max=self.d_max, thinnest=self.thinnest)
        not_negative(sim_time=self.sim_time, margin=self.margin, error=self.error, growth=self.growth)
        if self.v_samples < 2 or self.omega_samples < 3:
            raise ValueError(f"a window needs 2 x 3 samples or more, got {self.v_samples} x {self.omega_samples}")


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """One decision with all its evidence; row k of every array belongs to sample k, the last is the emergency one."""

    command: Array  # (2,)
    samples: Array  # (n, 2)
    raw: Array  # (n, 4) heading [deg], clearance of what stands [m], speed [m/s], clearance of movers [m]
    scores: Array  # (n, 4) shares of the four terms; 0 where not eligible
    totals: Array  # (n,) nan where not eligible
    reasons: NDArray[np.int64]  # (n,) index into REASONS
    ways: Array  # (n, 5) free, known, stopping [m], least predicted gap [m], time of the predicted contact [s]
    chosen: int
    braking: bool  # the emergency candidate, because nothing was admissible


@lru_cache(maxsize=256)
def settings_of(robot: Robot, params: Params, speed_bound: float) -> tuple[Array, Array]:
    """Limits and settings as the kernels take them."""
    wide = max(robot.acc_lim_x, robot.dec_lim_x) * params.dt * 2.0
    turn = robot.acc_lim_theta * params.dt * 2.0
    bound = speed_bound if params.guard else 0.0
    reserve, aside = (params.reserve, params.aside) if bound > 0.0 else (0.0, params.margin)
    values = (
        params.dt, params.sim_time, params.aim_time,
        min(wide, robot.max_vel_x - robot.min_vel_x) / (params.v_samples - 1),
        min(turn, 2.0 * robot.max_vel_theta) / (params.omega_samples - 1),
        params.d_max, params.margin, bound,
        reserve, aside, params.creep + 1e-9, params.growth,
    )  # fmt: skip
    return limits_of(robot), np.array([values], dtype=kernels.SETTINGS)
