"""Model predictive control: at every step a small quadratic program, solved by OSQP from the last answer."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import osqp
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from scipy.linalg import solve_discrete_are

from fuzzynav.geometry import Array, wrap
from fuzzynav.robot import TURTLEBOT2, Robot
from fuzzynav.tracking.kernels import MPC, _horizon
from fuzzynav.tracking.lqr import LEAST_SPEED, Weights, sampled_model
from fuzzynav.tracking.reference import Reference
from fuzzynav.tracking.tracker import NO_RATES, Tracker

__all__ = ["Mpc", "MpcParams", "braking", "mpc_cost"]

Indices = NDArray[np.int64]
NAMES = {
    "solved": "solved",
    "solved inaccurate": "solved",
    "primal infeasible": "infeasible",
    "primal infeasible inaccurate": "infeasible",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class MpcParams:
    """Weights, horizon and solver of the predictive controller; the thesis prints none, these are ours.

    Raises ValueError unless the horizon is at least 1 step and the tolerance positive.
    """

    weights: Weights = field(default_factory=Weights)
    horizon: int = 15  # steps
    tolerance: float = 1e-4
    iterations: int = 2000

    def __post_init__(self) -> None:
        if self.horizon < 1 or self.iterations < 1 or not self.tolerance > 0:
            raise ValueError(f"horizon and iterations must be at least 1 and tolerance positive, got {self}")


def mpc_cost(errors: ArrayLike, changes: ArrayLike, weights: Weights) -> float:
    """Sum of e'Qe over the predicted errors `(N, 3)` and of du'R du over commands minus reference `(N, 2)`.

    Source: thesis eq 1.11.
    """
    e, u = np.asarray(errors, dtype=float), np.asarray(changes, dtype=float)
    return float(np.einsum("ni,ij,nj", e, weights.q, e) + np.einsum("ni,ij,nj", u, weights.r, u))


def braking(last: ArrayLike, robot: Robot, dt: float) -> Array:
    """The command `(2,)` that slows down as quickly as the limits allow after `last`.

    >>> braking([0.5, 0.2], TURTLEBOT2, 0.1).round(3).tolist()
    [0.25, 0.0]
    """
    v, omega = np.asarray(last, dtype=float)
    slower = np.sign(v) * max(abs(v) - robot.dec_lim_x * dt, 0.0)
    return np.array([slower, np.sign(omega) * max(abs(omega) - robot.acc_lim_theta * dt, 0.0)])


class Mpc(Tracker):
    """Linear time-varying MPC about the reference, with limits on v, omega and both accelerations.

    The state is the last command, a flag that there was one, and the last answer (the warm start). `outcome` is
    'solved', 'infeasible' or 'not converged' after each call; in the last two cases the command brakes.
    """

    kind = MPC

    def __init__(
        self, reference: Reference, params: MpcParams | None = None, robot: Robot = TURTLEBOT2, dt: float = 0.1
    ) -> None:
        self.params = params or MpcParams()
        self.outcome = "solved"
        super().__init__(reference, np.zeros(1), robot, dt)
        held = np.repeat(self.rows[-1:], self.params.horizon, axis=0)
        held[:, [2, 3, 4, 5, 7, 8]] = 0.0  # beyond its end the reference stands still
        self._ahead = np.concatenate([self.rows, held])
        self._problem = _Problem(self.params, robot, dt, self._terminal())

    def start(self) -> Array:
        """The state before the first step: no last command, no answer to start from."""
        return np.zeros(3 + 12 * self.params.horizon)

    def reset(self) -> None:
        """Forget the run before."""
        super().reset()
        self.outcome = "solved"

    @property
    def evidence(self) -> dict[str, float]:
        """Whether the last program was solved, 1 or 0, for the record of a run."""
        return {"mpc_solved": float(self.outcome == "solved")}

    def _terminal(self) -> Array:
        """Cost to go (3, 3) after the horizon: that of the LQR at the mean speed, Q where that is at rest."""
        w, v = self.params.weights, float(self.rows[:, 7].mean())
        if abs(v) < LEAST_SPEED:
            return w.q
        a, b = sampled_model(v, 0.0, self.dt)
        return np.asarray(solve_discrete_are(a, b, w.q, w.r))

    def row(self, t: float) -> Array:
        """The reference over the horizon from time t [s]: `(N, 9)`, rows as the other laws read them."""
        k, n = round(t / self.dt), self.params.horizon
        if 0 <= k <= self.steps and abs(t - k * self.dt) < 1e-9:
            return self._ahead[k : k + n]
        times = t + np.arange(n) * self.dt
        rows = self.reference.rows(times)
        rows[times > self.reference.duration] *= np.array([1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0])
        return rows

    def step(self, state: Array, pose: ArrayLike, row: Array, rates: Array = NO_RATES) -> tuple[Array, Array]:
        """Command (2,) and next state; `row` (N, 9) is the reference over the horizon."""
        n, p, now = self.params.horizon, np.asarray(pose, dtype=float), row[0]
        c, s = np.cos(now[6]), np.sin(now[6])
        dx, dy = p[0] - now[0], p[1] - now[1]
        error = np.array([c * dx + s * dy, -s * dx + c * dy, float(wrap(p[2] - now[6]))])
        last = state[:2] if state[2] else now[7:9]
        self._problem.pose(error, last, row[:, 7:9])
        x, y, self.outcome = self._problem.solve(state[3 : 3 + 5 * n], state[3 + 5 * n :])
        after = np.zeros_like(state)
        command = braking(last, self.robot, self.dt)
        if self.outcome == "solved":
            command = now[7:9] + x[3 * n : 3 * n + 2]
            after[3:] = np.concatenate([x, y])
        after[:2], after[2] = command, 1.0
        return command, after


class _Problem:
    """The quadratic program of one horizon: errors e_1..e_N, then changes du_0..du_(N-1) of the command.

    Rows: N model equations (3 each), N speed limits (2 each), N acceleration limits (2 each); only numbers change
    from step to step, never the pattern. The last answer is taken over one step later, its last part twice.
    """

    def __init__(self, params: MpcParams, robot: Robot, dt: float, terminal: Array) -> None:
        self.n, self.dt = params.horizon, dt
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

    def pose(self, error: Array, last: Array, wanted: Array) -> None:
        """Set the error now (3,), the last command (2,) and the reference's speeds (N, 2)."""
        speeds = np.ascontiguousarray(wanted)
        _horizon(error, np.ascontiguousarray(last), speeds, self.dt, self.bounds, self.numbers, self.low, self.high)
        self.matrix.data[self.places] = self.numbers[self.sources]
        self.solver.update(Ax=self.matrix.data, l=self.low, u=self.high)

    def solve(self, x: Array, y: Array) -> tuple[Array, Array, str]:
        """Answer, multipliers and status, starting from the last answer (all zero: from nothing)."""
        self.solver.warm_start(x=self._later(x, (3, 2)), y=self._later(y, (3, 2, 2)))
        answer = self.solver.solve(raise_error=False)
        name = NAMES.get(answer.info.status, "not converged")
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
