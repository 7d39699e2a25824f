"""Model predictive control: at every step a small quadratic program, solved by OSQP from the last answer."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from scipy.linalg import solve_discrete_are

from fuzzynav.geometry import Array, wrap
from fuzzynav.robot import Robot
from fuzzynav.tracking import kernels
from fuzzynav.tracking.law import Setting
from fuzzynav.tracking.lqr import LEAST_SPEED, Weights, sampled_model

__all__ = ["Mpc", "MpcState", "braking", "mpc_cost"]

Indices = NDArray[np.int64]
OUT_OF_REACH = 100.0  # [m] further than this from the reference the solver's tolerance is wider than the limits
NAMES = {
    "solved": "solved",
    "solved inaccurate": "solved",
    "primal infeasible": "infeasible",
    "primal infeasible inaccurate": "infeasible",
}


def mpc_cost(errors: ArrayLike, changes: ArrayLike, weights: Weights) -> float:
    """Sum of e'Qe over the predicted errors `(N, 3)` and of du'R du over commands minus reference `(N, 2)`.

    Source: thesis eq 1.11.
    """
    e, u = np.asarray(errors, dtype=float), np.asarray(changes, dtype=float)
    return float(np.einsum("ni,ij,nj", e, weights.q, e) + np.einsum("ni,ij,nj", u, weights.r, u))


def braking(last: ArrayLike, robot: Robot, dt: float) -> Array:
    """The command `(2,)` that slows down as quickly as the limits allow after `last`.

    >>> from fuzzynav.robot import TURTLEBOT2
    >>> braking([0.5, 0.2], TURTLEBOT2, 0.1).round(3).tolist()
    [0.25, 0.0]
    """
    v, omega = np.asarray(last, dtype=float)
    slower = np.sign(v) * max(abs(v) - robot.dec_lim_x * dt, 0.0)
    return np.array([slower, np.sign(omega) * max(abs(omega) - robot.acc_lim_theta * dt, 0.0)])


@dataclass(frozen=True, slots=True, kw_only=True)
class Mpc:
    """Linear time-varying MPC about the reference, with limits on v, omega and both accelerations.

    After each step the state's `outcome` is 'solved', 'infeasible', 'not converged' or 'out of reach'; in the last
    three cases the command brakes. The thesis prints no values, these are ours. Raises ValueError unless the horizon
    is at least 1 step and the tolerance positive.
    """

    weights: Weights = field(default_factory=Weights)
    horizon: int = 15  # steps
    tolerance: float = 1e-4
    iterations: int = 2000

    def __post_init__(self) -> None:
        if self.horizon < 1 or self.iterations < 1 or not self.tolerance > 0:
            raise ValueError(f"horizon and iterations must be at least 1 and tolerance positive, got {self}")

    def start(self, setting: Setting) -> MpcState:
        """The state before the first step: no last command, no answer to start from."""
        problem = _Problem(self, setting.robot, setting.dt, self.terminal(setting))
        return MpcState(problem, None, np.zeros(5 * self.horizon), np.zeros(7 * self.horizon))

    def terminal(self, setting: Setting) -> Array:
        """Cost to go (3, 3) after the horizon: that of the LQR at the mean speed, Q where that is at rest."""
        v = float(setting.rows["v"].mean())
        if abs(v) < LEAST_SPEED:
            return self.weights.q
        a, b = sampled_model(v, 0.0, setting.dt)
        return np.asarray(solve_discrete_are(a, b, self.weights.q, self.weights.r))

    def command(self, state: MpcState, pose: ArrayLike, row: Any) -> tuple[Array, MpcState]:
        """Command (2,) and next state; `row` `(N,)` is the reference over the horizon, the first of it now."""
        p, now = np.asarray(pose, dtype=float), row[0]
        theta = float(now.theta)
        c, s, dx, dy = math.cos(theta), math.sin(theta), p[0] - now.x, p[1] - now.y
        error = np.array([c * dx + s * dy, -s * dx + c * dy, wrap(p[2] - theta)])
        wanted = np.empty((self.horizon, 2))
        wanted[:, 0], wanted[:, 1] = row["v"], row["omega"]
        last = wanted[0] if state.last is None else state.last
        x, y, outcome = state.problem.solve(error, last, wanted, state)
        solved = outcome == "solved"
        command = wanted[0] + x[3 * self.horizon : 3 * self.horizon + 2] if solved else state.problem.brake(last)
        return command, MpcState(state.problem, command, x, y, outcome)


@dataclass(frozen=True, slots=True, eq=False)
class MpcState:
    """The last command (2,), None before the first, and the last answer: errors and changes x, multipliers y."""

    problem: _Problem
    last: Array | None
    x: Array  # (5 N,)
    y: Array  # (7 N,)
    outcome: str = "solved"

    @property
    def evidence(self) -> dict[str, float]:
        """Whether the last program was solved, 1 or 0, for the record of a run."""
        return {"mpc_solved": float(self.outcome == "solved")}


class _Problem:
    """The quadratic program of one horizon: errors e_1..e_N, then changes du_0..du_(N-1) of the command.

    Rows: N model equations (3 each), N speed limits (2 each), N acceleration limits (2 each); only numbers change
    from step to step, never the pattern. The last answer is taken over one step later, its last part twice.
    """

    def __init__(self, params: Mpc, robot: Robot, dt: float, terminal: Array) -> None:
        self.n, self.robot, self.dt, self.terminal = params.horizon, robot, dt, terminal
        n, w = self.n, params.weights
        self.bounds = np.array(
            [
                [robot.min_vel_x, -robot.max_vel_theta],
                [robot.max_vel_x, robot.max_vel_theta],
                [dt * min(robot.acc_lim_x, robot.dec_lim_x), dt * robot.acc_lim_theta],
            ]
        )
        self.matrix, self.places, self.sources = _pattern(n)
        self.numbers, self.low, self.high = np.empty(15 * n), np.zeros(7 * n), np.zeros(7 * n)
        blocks = [w.q] * (n - 1) + [terminal] + [w.r] * n
        cost = sparse.triu(sparse.block_diag(blocks, format="csc"), format="csc")
        import osqp  # here: only this law needs the solver

        self.solver = osqp.OSQP()
        wide = np.full(7 * n, 1e3)
        # fixed rho, no scaling: the answer then depends on the numbers alone, not on the clock or on earlier problems
        self.solver.setup(
            P=cost,
            q=np.zeros(5 * n),
            A=self.matrix,
            l=-wide,
            u=wide,
            verbose=False,
            polishing=False,
            eps_abs=params.tolerance,
            eps_rel=params.tolerance,
            max_iter=params.iterations,
            adaptive_rho=False,
            rho=0.5,
            check_termination=5,
            scaling=0,
        )

    def brake(self, last: Array) -> Array:
        """The command (2,) where there is no answer."""
        return braking(last, self.robot, self.dt)

    def solve(self, error: Array, last: Array, wanted: Array, before: MpcState) -> tuple[Array, Array, str]:
        """Answer, multipliers and outcome for the error now (3,), the last command (2,) and the speeds (N, 2).

        Starts from the answer before; zeros where there is none.
        """
        if not math.hypot(error[0], error[1]) < OUT_OF_REACH:
            return np.zeros_like(before.x), np.zeros_like(before.y), "out of reach"
        kernels.horizon(error, last, wanted, self.dt, self.bounds, self.numbers, self.low, self.high)
        self.matrix.data[self.places] = self.numbers[self.sources]
        self.solver.update(Ax=self.matrix.data, l=self.low, u=self.high)
        self.solver.warm_start(x=self._later(before.x, (3, 2)), y=self._later(before.y, (3, 2, 2)))
        answer = self.solver.solve(raise_error=False)
        name = NAMES.get(answer.info.status, "not converged")
        if name != "solved":
            return np.zeros_like(before.x), np.zeros_like(before.y), name
        return np.asarray(answer.x), np.asarray(answer.y), name

    def _later(self, vector: Array, widths: tuple[int, ...]) -> Array:
        parts, start = [], 0
        for width in widths:
            block = vector[start : start + width * self.n]
            parts += [block[width:], block[-width:]]
            start += width * self.n
        return np.concatenate(parts)


def _pattern(n: int) -> tuple[sparse.csc_matrix, Indices, Indices]:
    """Constraint matrix of a horizon of n steps, and which of its data are which of the model's numbers."""
    entries: list[tuple[int, int, float, int]] = []  # row, column, value, place among the 15 n numbers or -1
    for j in range(n):
        u = 3 * n + 2 * j
        for r in range(3):
            entries.append((3 * j + r, 3 * j + r, 1.0, -1))
            entries += [(3 * j + r, 3 * (j - 1) + c, -1.0, 15 * j + 3 * r + c) for c in range(3 if j else 0)]
            entries += [(3 * j + r, u + c, -1.0, 15 * j + 9 + 2 * r + c) for c in range(2)]
        for r in range(2):
            entries += [(3 * n + 2 * j + r, u + r, 1.0, -1), (5 * n + 2 * j + r, u + r, 1.0, -1)]
            if j:
                entries.append((5 * n + 2 * j + r, u - 2 + r, -1.0, -1))
    rows, columns, values, places = (np.array(part) for part in zip(*entries, strict=True))
    tagged = sparse.csc_matrix((np.arange(1.0, len(rows) + 1), (rows, columns)), shape=(7 * n, 5 * n))
    order = tagged.data.astype(int) - 1
    tagged.data = values[order].astype(float)
    place = places[order]
    return tagged, np.flatnonzero(place >= 0), place[place >= 0]
