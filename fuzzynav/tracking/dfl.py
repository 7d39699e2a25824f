"""Dynamic feedback linearization: the unicycle turned into two double integrators, step by step.

The names follow the thesis: flat state z = (x, dx/dt, y, dy/dt), virtual inputs u = (d2x/dt2, d2y/dt2).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import expm

from fuzzynav.checks import positive_fields
from fuzzynav.geometry import Array
from fuzzynav.tracking.kernels import DFL, FLATNESS
from fuzzynav.tracking.law import Setting, State, begin, stepped
from fuzzynav.tracking.reference import Sample

__all__ = [
    "CHAINS",
    "Dfl",
    "FlatGains",
    "Flatness",
    "LinearSystem",
    "closed_loop",
    "compensate",
    "controllability",
    "decoupling",
    "error_response",
    "flat_state",
    "from_virtual",
    "gain_matrix",
    "gains_from_poles",
    "largest_step",
    "poles",
    "reference_state",
    "sampled_loop",
    "virtual_inputs",
    "yaw_rate_unguarded",
]


@dataclass(frozen=True, slots=True)
class LinearSystem:
    """A linear time-invariant system: matrices A `(n, n)`, B `(n, m)`, C `(p, n)`, D `(p, m)`.

    Source: thesis eq 2.1, 2.2, 2.5, 2.6, 1.13.
    """

    a: Array
    b: Array
    c: Array
    d: Array

    def rates(self, x: ArrayLike, u: ArrayLike) -> Array:
        """dx/dt = A x + B u for states `(..., n)` and inputs `(..., m)`."""
        return np.asarray(x, dtype=float) @ self.a.T + np.asarray(u, dtype=float) @ self.b.T

    def output(self, x: ArrayLike, u: ArrayLike) -> Array:
        """y = C x + D u."""
        return np.asarray(x, dtype=float) @ self.c.T + np.asarray(u, dtype=float) @ self.d.T

    def discrete(self, dt: float) -> LinearSystem:
        """The system between samples dt [s] apart, its input held: x[k+1] = A x[k] + B u[k].

        Source: thesis eq 2.3, 2.4.

        >>> CHAINS.discrete(0.1).b[:, 0].round(4).tolist()       # dt^2/2 and dt
        [0.005, 0.1, 0.0, 0.0]
        """
        n, m = self.b.shape
        block = np.zeros((n + m, n + m))
        block[:n, :n], block[:n, n:] = self.a, self.b
        power = expm(block * dt)
        return LinearSystem(power[:n, :n], power[:n, n:], self.c, self.d)


def _chains() -> LinearSystem:
    """Two double integrators, the target system.   Source: thesis eq 2.13, 2.18, 2.49."""
    a, b, c = np.zeros((4, 4)), np.zeros((4, 2)), np.zeros((2, 4))
    a[0, 1] = a[2, 3] = b[1, 0] = b[3, 1] = c[0, 0] = c[1, 2] = 1.0
    return LinearSystem(a, b, c, np.zeros((2, 2)))


CHAINS = _chains()


def controllability(system: LinearSystem = CHAINS, blocks: int = 2) -> Array:
    """Controllability matrix [B, AB, ...] `(n, m blocks)`; two blocks suffice where A^2 = 0.

    Source: thesis eq 2.19.

    >>> int(np.linalg.matrix_rank(controllability()))
    4
    """
    parts = [system.b]
    for _ in range(blocks - 1):
        parts.append(system.a @ parts[-1])
    return np.hstack(parts)


def decoupling(theta: ArrayLike, v: ArrayLike) -> Array:
    """Decoupling matrix `(..., 2, 2)`: from (dv/dt, omega) to the accelerations; its determinant is v.

    Source: thesis eq 2.16, 5.4 (errata T57: its xi is the zeta of eq 5.3).

    >>> float(np.linalg.det(decoupling(0.7, 0.25)).round(6))
    0.25
    """
    t, speed = np.broadcast_arrays(np.asarray(theta, dtype=float), np.asarray(v, dtype=float))
    c, s = np.cos(t), np.sin(t)
    return np.stack([np.stack([c, -speed * s], axis=-1), np.stack([s, speed * c], axis=-1)], axis=-2)


def from_virtual(u: ArrayLike, theta: ArrayLike, v: ArrayLike) -> Array:
    """(dv/dt, omega) `(..., 2)` that give the accelerations u `(..., 2)` [m/s^2] at heading theta and speed v.

    Source: thesis eq 2.17, 5.3. Raises ValueError where v is 0: the matrix has no inverse there.

    >>> from_virtual([0.0, 0.1], 0.0, 0.5).round(3).tolist()
    [0.0, 0.2]
    """
    a, t, speed = (np.asarray(q, dtype=float) for q in (u, theta, v))
    if (speed == 0.0).any():
        raise ValueError("at v = 0 the yaw rate has no effect on the acceleration: eq 2.17 needs v other than 0")
    c, s = np.cos(t), np.sin(t)
    return np.stack([a[..., 0] * c + a[..., 1] * s, (a[..., 1] * c - a[..., 0] * s) / speed], axis=-1)


def yaw_rate_unguarded(u: ArrayLike, theta: ArrayLike, v: ArrayLike) -> Array:
    """The yaw rate of eq 5.2 without a guard: inf or nan at v = 0, for the picture of the singularity (errata T58)."""
    a, t = np.asarray(u, dtype=float), np.asarray(theta, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray((a[..., 1] * np.cos(t) - a[..., 0] * np.sin(t)) / np.asarray(v, dtype=float))


def flat_state(pose: ArrayLike, v: ArrayLike) -> Array:
    """Flat state z = (x, dx/dt, y, dy/dt) `(..., 4)` of a robot at a pose with speed v [m/s].

    Source: thesis eq 2.47.
    """
    p, speed = np.asarray(pose, dtype=float), np.asarray(v, dtype=float)
    return np.stack([p[..., 0], speed * np.cos(p[..., 2]), p[..., 1], speed * np.sin(p[..., 2])], axis=-1)


def reference_state(sample: Sample) -> tuple[Array, Array]:
    """Flat state `(..., 4)` and virtual inputs `(..., 2)` of a reference.

    Source: thesis eq 2.20, 2.48.
    """
    both = np.stack([sample.position, sample.velocity], axis=-1)  # (..., axis, order)
    return both.reshape(*both.shape[:-2], 4), sample.acceleration


@dataclass(frozen=True, slots=True, kw_only=True)
class FlatGains:
    """What both flat laws share: their gains, those of table 5.2, and how their singularity is guarded.

    Raises ValueError unless gains, v_min and rest_radius are positive; v0 may be left out.
    """

    kp1: float = 1.0  # [1/s^2] on x
    kd1: float = 0.7  # [1/s]
    kp2: float = 1.0  # [1/s^2] on y
    kd2: float = 0.7  # [1/s]
    v_min: float = 0.05  # [m/s] least speed to divide by; below it the turn fades to the reference's heading
    rest_radius: float = 0.02  # [m] of a reference at rest: within it the robot stands
    v0: float | None = None  # [m/s] first value of the integrator; None: the speed of the reference

    def __post_init__(self) -> None:
        positive_fields(self, leave=("v0",))
        if self.v0 is not None and not (np.isfinite(self.v0) and self.v0 > 0):
            raise ValueError(
                f"v0 must be positive, got {self.v0}: eq 5.2 divides by it, and a negative one drives the "
                "curve backwards; leave it out to start at the speed of the reference"
            )

    def start(self, setting: Setting) -> State:
        """The state before the first step; raises ValueError for a dt at which the sampled loop is not stable."""
        if setting.dt >= largest_step(self):
            raise ValueError(
                f"dt = {setting.dt:g} s is too large for these gains: the sampled loop is stable below "
                f"{largest_step(self):.3g} s; shorten dt or lower the gains"
            )
        return begin(setting, "dfl", self)


class Dfl(FlatGains):
    """Dynamic feedback linearization of thesis section 5.2.1, guarded.

    The integrator starts at the speed of the reference, moves before it divides, keeps the reference's direction
    of travel, and divides by v_min at least; a reference at rest is held within rest_radius.
    """

    __slots__ = ()

    def command(self, state: State, pose: ArrayLike, row: Any) -> tuple[Array, State]:
        """Command (2,) and next state; reads position, velocity, acceleration, heading, v and omega of the row."""
        return stepped(DFL, state, pose, row)


class Flatness(FlatGains):
    """The linear controller in flat coordinates: the same gains, but linearised about the reference's motion.

    Heading and speed of the reference stand in the decoupling matrix where `Dfl` has the robot's own: exact on
    the reference, first-order near it. The baseline that the thesis names and does not run (errata T65).
    """

    __slots__ = ()

    def command(self, state: State, pose: ArrayLike, row: Any) -> tuple[Array, State]:
        """Command (2,) and next state; reads all that `Dfl` reads."""
        return stepped(FLATNESS, state, pose, row)


def gain_matrix(gains: FlatGains) -> Array:
    """Gain matrix K `(2, 4)`, block diagonal.   Source: thesis eq 2.24."""
    return np.array([[gains.kp1, gains.kd1, 0.0, 0.0], [0.0, 0.0, gains.kp2, gains.kd2]])


def virtual_inputs(z: ArrayLike, z_ref: ArrayLike, u_ref: ArrayLike, gains: FlatGains) -> Array:
    """Virtual inputs u = u_ref + K (z_ref - z) `(..., 2)` [m/s^2].

    Source: thesis eq 2.23, 2.25, 5.1.
    """
    gap = np.asarray(z_ref, dtype=float) - np.asarray(z, dtype=float)
    return np.asarray(np.asarray(u_ref, dtype=float) + gap @ gain_matrix(gains).T)


def compensate(v: float, u: ArrayLike, theta: float, dt: float) -> tuple[float, float]:
    """Speed v [m/s] and yaw rate [rad/s] for virtual inputs u: the integrator moves first, then divides.

    Source: thesis eq 5.2 (errata T58: it needs a start value, and a guard where v becomes 0).

    >>> compensate(0.2, [0.1, 0.1], 0.0, 0.1)
    (0.21000000000000002, 0.47619047619047616)
    """
    a = np.asarray(u, dtype=float)
    along = float(a[0] * np.cos(theta) + a[1] * np.sin(theta))
    moved = v + dt * along
    return moved, float(from_virtual(a, theta, moved)[1])


def closed_loop(gains: FlatGains) -> Array:
    """Matrix A - B K `(4, 4)` of the error dynamics.   Source: thesis eq 2.21, 2.22."""
    return CHAINS.a - CHAINS.b @ gain_matrix(gains)


def poles(gains: FlatGains) -> Array:
    """Poles `(4,)` [1/s] of the error dynamics, of x and then of y: roots of s^2 + kd s + kp.

    >>> poles(Dfl())[0].round(4)
    np.complex128(-0.35+0.9367j)
    """
    return np.concatenate([np.roots([1.0, d, p]) for p, d in ((gains.kp1, gains.kd1), (gains.kp2, gains.kd2))])


def gains_from_poles(wanted: ArrayLike) -> Dfl:
    """Gains that put the poles of both channels at the two given places [1/s] (a conjugate or a real pair).

    Raises ValueError unless both lie in the left half-plane.

    >>> g = gains_from_poles([-1.0, -2.0])
    >>> (round(g.kp1, 9), round(g.kd1, 9))
    (2.0, 3.0)
    """
    s = np.asarray(wanted, dtype=complex).ravel()
    if s.shape != (2,) or (s.real >= 0).any() or abs(s.sum().imag) > 1e-9 * abs(s).max():
        raise ValueError(f"give two poles in the left half-plane, real or conjugate, got {np.asarray(wanted).tolist()}")
    kp, kd = float((s[0] * s[1]).real), float(-s.sum().real)  # s^2 + kd s + kp, the companion form of each chain
    return Dfl(kp1=kp, kd1=kd, kp2=kp, kd2=kd)


def error_response(t: ArrayLike, error: ArrayLike, gains: FlatGains) -> Array:
    """Flat error z - z_ref `(n, 4)` at times t `(n,)` [s] after it was `error` `(4,)`: exp((A - BK) t) e.

    The closed form that an ideal run must show.
    """
    matrix = closed_loop(gains)
    return np.stack([expm(matrix * time) @ np.asarray(error, dtype=float) for time in np.asarray(t, dtype=float)])


def sampled_loop(kp: float, kd: float, dt: float) -> Array:
    """Matrix `(2, 2)` of one channel's error from sample to sample: the rate is updated first, then driven.

    >>> sampled_loop(1.0, 0.7, 0.1).round(3).tolist()
    [[0.99, 0.093], [-0.1, 0.93]]
    """
    return np.array([[1.0 - kp * dt**2, dt - kd * dt**2], [-kp * dt, 1.0 - kd * dt]])


def largest_step(gains: FlatGains) -> float:
    """Least upper bound of the steps dt [s] at which the sampled error dynamics are stable.

    Both poles of `sampled_loop` lie inside the unit circle while kp dt^2 + 2 kd dt < 4.

    >>> round(largest_step(Dfl()), 3)
    1.419
    """
    pairs = ((gains.kp1, gains.kd1), (gains.kp2, gains.kd2))
    return float(min((-d + np.sqrt(d**2 + 4.0 * p)) / p for p, d in pairs))
