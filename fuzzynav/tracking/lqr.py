"""Linear-quadratic regulation about a moving reference: error model, Riccati equation, scheduled gain."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import LinAlgError, solve_continuous_are, solve_discrete_are

from fuzzynav.checks import finite, positive
from fuzzynav.geometry import Array
from fuzzynav.tracking.kernels import LQR, sampled
from fuzzynav.tracking.law import Setting, State, begin, stepped
from fuzzynav.tracking.records import MOST_SPEEDS

__all__ = ["Lqr", "Weights", "bellman_residual", "error_model", "lqr_cost", "lqr_gain", "riccati", "sampled_model"]

LEAST_SPEED = 0.01  # [m/s] a slower reference is as good as at rest


@dataclass(frozen=True, slots=True, kw_only=True)
class Weights:
    """Diagonal weights of errors (ahead, left, heading) and of commands (v, omega).

    The thesis prints none; these are ours. Raises ValueError unless errors weigh 0 or more, ahead and left more
    than 0, and commands more than 0.
    """

    ahead: float = 4.0  # [1/m^2]
    left: float = 8.0  # [1/m^2]
    heading: float = 0.5  # [1/rad^2]
    v: float = 1.0  # [s^2/m^2]
    omega: float = 0.3  # [s^2/rad^2]

    def __post_init__(self) -> None:
        ok = np.isfinite([self.ahead, self.left, self.heading, self.v, self.omega]).all()
        if not (ok and self.ahead > 0 and self.left > 0 and self.heading >= 0 and self.v > 0 and self.omega > 0):
            raise ValueError(f"weights must be positive (heading may be 0), got {self}")

    @property
    def q(self) -> Array:
        """Weight of the error (3, 3)."""
        return np.diag([self.ahead, self.left, self.heading])

    @property
    def r(self) -> Array:
        """Weight of the command (2, 2)."""
        return np.diag([self.v, self.omega])


def error_model(v: ArrayLike, omega: ArrayLike) -> tuple[Array, Array]:
    """Matrices A `(..., 3, 3)`, B `(3, 2)` of pose minus reference, in the reference's frame, at its speeds.

    At v = omega = 0 it is not controllable: A = 0, and B has rank 2 (errata T55).
    """
    speed, turn = np.broadcast_arrays(np.asarray(v, dtype=float), np.asarray(omega, dtype=float))
    a = np.zeros((*speed.shape, 3, 3))
    a[..., 0, 1], a[..., 1, 0], a[..., 1, 2] = turn, -turn, speed
    return a, np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 1.0]])


def sampled_model(v: ArrayLike, omega: ArrayLike, dt: float) -> tuple[Array, Array]:
    """The error model between samples dt [s] apart, commands held: A `(..., 3, 3)`, B `(..., 3, 2)`, exactly."""
    speed, turn = np.broadcast_arrays(np.asarray(v, dtype=float), np.asarray(omega, dtype=float))
    numbers = np.empty((speed.size, 15))
    for k, (one, other) in enumerate(zip(speed.ravel(), turn.ravel(), strict=True)):
        sampled(one, other, dt, numbers[k])
    return numbers[:, :9].reshape(*speed.shape, 3, 3), numbers[:, 9:].reshape(*speed.shape, 3, 2)


def riccati(a: Array, b: Array, weights: Weights) -> Array:
    """Solution P `(3, 3)` of A'P + PA - P B R^-1 B'P + Q = 0, by SciPy.

    Source: thesis eq 1.17. Raises ValueError where (A, B) is not controllable, as for a reference at rest, and where
    the weights lie too far apart for a solution.
    """
    a, b = finite(a, "A", 3, 3), finite(b, "B", 3, 2)
    rank = np.linalg.matrix_rank(np.hstack([b, a @ b, a @ a @ b]))
    if rank < len(a):
        raise ValueError(
            f"the linearised unicycle is not controllable here: [B, AB, AAB] has rank {rank} of {len(a)}. "
            "At v_r = 0 no gain reaches the sideways error: give a reference that moves"
        )
    try:
        return np.asarray(solve_continuous_are(a, b, weights.q, weights.r))
    except LinAlgError as error:
        raise ValueError(f"the Riccati equation has no finite solution for {weights}: {error}") from None


def lqr_gain(v: float, omega: float, weights: Weights, dt: float | None = None) -> Array:
    """Gain K `(2, 3)` in u = u_ref - K (x - x_ref), at the reference's speeds; dt gives the sampled-data gain.

    Source: thesis eq 1.16, 1.18 (errata T55: u = -Kx alone would regulate to zero).

    >>> lqr_gain(0.2, 0.0, Weights(ahead=4.0, v=1.0))[0, 0].round(6).item()      # sqrt(4/1) on the error ahead
    2.0
    """
    a, b = error_model(*finite([v, omega], "the speeds of the reference (v, omega)", 2))
    if dt is None:
        return np.asarray(np.linalg.solve(weights.r, b.T @ riccati(a, b, weights)))
    positive(dt=dt)
    riccati(a, b, weights)
    a, b = sampled_model(v, omega, dt)
    p = solve_discrete_are(a, b, weights.q * dt, weights.r * dt)
    return np.asarray(np.linalg.solve(weights.r * dt + b.T @ p @ b, b.T @ p @ a))


def lqr_cost(errors: ArrayLike, commands: ArrayLike, weights: Weights, dt: float) -> float:
    """Integral of x'Qx + u'Ru over samples dt apart: errors `(n, 3)`, commands minus reference `(n, 2)`.

    Source: thesis eq 1.14.
    """
    e, u = np.asarray(errors, dtype=float), np.asarray(commands, dtype=float)
    return float((np.einsum("ni,ij,nj", e, weights.q, e) + np.einsum("ni,ij,nj", u, weights.r, u)) * dt)


def bellman_residual(x: ArrayLike, u: ArrayLike, v: float, omega: float, weights: Weights) -> float:
    """x'Qx + u'Ru + (dJ/dx)(Ax + Bu) for the cost to go J = x'Px: 0 at u = -Kx, positive elsewhere.

    Source: thesis eq 1.15.
    """
    a, b = error_model(v, omega)
    p = riccati(a, b, weights)
    e, c = np.asarray(x, dtype=float), np.asarray(u, dtype=float)
    return float(e @ weights.q @ e + c @ weights.r @ c + 2.0 * e @ p @ (a @ e + b @ c))


@dataclass(frozen=True, slots=True, kw_only=True)
class Lqr:
    """LQR tracking with a gain scheduled over the reference's speed; one speed gives the constant gain.

    Raises ValueError unless there are 1 to 33 speeds.
    """

    weights: Weights = field(default_factory=Weights)
    speeds: int = 9  # at which the Riccati equation is solved, between the reference's slowest and fastest

    def __post_init__(self) -> None:
        if not 1 <= self.speeds <= MOST_SPEEDS:
            raise ValueError(f"the gain can be scheduled over 1 to {MOST_SPEEDS} speeds, got {self.speeds}")

    def schedule(self, setting: Setting) -> tuple[Array, Array]:
        """Speeds `(n,)` [m/s] and the gain `(n, 2, 3)` at each of them.

        Raises ValueError for a reference that stops or reverses: LQR needs v_r away from 0 (errata T55).
        """
        v = np.abs(setting.rows["v"])
        if v.min() < LEAST_SPEED:
            slow = setting.dt * int(v.argmin())
            raise ValueError(
                f"LQR needs a reference that keeps moving, this one has v = {v.min():.2g} m/s at t = {slow:.3g} s: "
                "at rest the linearised robot is not controllable (A = 0, rank of B is 2 of 3)"
            )
        low, high = float(v.min()), float(v.max())
        n = self.speeds if high - low > 1e-9 else 1
        grid = np.linspace(low, high, n) if n > 1 else np.array([v.mean()])
        return grid, np.stack([lqr_gain(speed, 0.0, self.weights) for speed in grid])

    def start(self, setting: Setting) -> State:
        """The state before the first step, with the scheduled gains."""
        state = begin(setting)
        grid, gains = self.schedule(setting)
        mine, n = state.gains["lqr"], len(grid)
        mine["count"], mine["first"], mine["table"][0, :n] = n, grid[0], gains
        mine["step"] = (float(np.abs(setting.rows["v"]).max()) - grid[0]) / (n - 1) if n > 1 else 1.0
        return state

    def command(self, state: State, pose: ArrayLike, row: Any) -> tuple[Array, State]:
        """Command (2,) and next state."""
        return stepped(LQR, state, pose, row)
