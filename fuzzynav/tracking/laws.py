"""The rivals of the flat controllers: Kanayama's law, PID and sliding mode, each with its parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.checks import positive_fields
from fuzzynav.geometry import Array, wrap
from fuzzynav.tracking.kernels import KANAYAMA, LEAST_DIVISOR, PID, SLIDING
from fuzzynav.tracking.law import Setting, State, begin, stepped

__all__ = [
    "Kanayama",
    "Pid",
    "Sliding",
    "error_rate",
    "kanayama",
    "kanayama_energy",
    "kanayama_energy_rate",
    "pid",
    "sliding",
    "sliding_energy",
    "sliding_surfaces",
    "sliding_surfaces_as_printed",
    "tracking_error",
]


def tracking_error(pose: ArrayLike, wanted: ArrayLike) -> Array:
    """Error `(..., 3)` in the robot's frame: ahead [m], to the left [m], heading [rad] wrapped.

    Source: thesis eq 1.20, 5.9.

    >>> tracking_error([0, 0, np.pi / 2], [0, 1, np.pi / 2]).round(9).tolist()
    [1.0, 0.0, 0.0]
    """
    p, r = np.asarray(pose, dtype=float), np.asarray(wanted, dtype=float)
    c, s = np.cos(p[..., 2]), np.sin(p[..., 2])
    dx, dy = r[..., 0] - p[..., 0], r[..., 1] - p[..., 1]
    return np.stack(np.broadcast_arrays(c * dx + s * dy, -s * dx + c * dy, wrap(r[..., 2] - p[..., 2])), axis=-1)


def error_rate(error: ArrayLike, command: ArrayLike, wanted: ArrayLike) -> Array:
    """Derivative `(..., 3)` of the tracking error when the robot drives `command` and the reference `wanted`.

    The rates of eq 1.19 in the robot's frame.   Source: thesis eq 1.19.
    """
    e, u, r = (np.asarray(q, dtype=float) for q in (error, command, wanted))
    v, omega, v_r, omega_r = u[..., 0], u[..., 1], r[..., 0], r[..., 1]
    first = omega * e[..., 1] - v + v_r * np.cos(e[..., 2])
    second = -omega * e[..., 0] + v_r * np.sin(e[..., 2])
    return np.stack(np.broadcast_arrays(first, second, omega_r - omega), axis=-1)


# --- the law of eq 5.10 --------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Kanayama:
    """The law of eq 5.10. The thesis prints no gains, these are ours. Raises ValueError unless all are positive."""

    k1: float = 1.0  # [1/s]
    k2: float = 10.0  # [1/m^2]
    k3: float = 1.5  # [1/s]

    def __post_init__(self) -> None:
        positive_fields(self)

    def start(self, setting: Setting) -> State:
        """The state before the first step."""
        return begin(setting, "kanayama", self)

    def command(self, state: State, pose: ArrayLike, row: Any) -> tuple[Array, State]:
        """Command (2,) and next state."""
        return stepped(KANAYAMA, state, pose, row)


def kanayama(error: ArrayLike, wanted: ArrayLike, gains: Kanayama) -> Array:
    """Command `(..., 2)` from the tracking error and the reference's speeds (v_d, omega_d).

    A tracking law: with v_d = 0 a sideways error moves nothing (errata T56).   Source: thesis eq 5.10.

    >>> kanayama([0.0, 1.0, 0.0], [0.0, 0.0], Kanayama()).tolist()
    [0.0, 0.0]
    """
    e, r = np.asarray(error, dtype=float), np.asarray(wanted, dtype=float)
    v = r[..., 0] * np.cos(e[..., 2]) + gains.k1 * e[..., 0]
    omega = r[..., 1] + gains.k2 * r[..., 0] * e[..., 1] + gains.k3 * np.sin(e[..., 2])
    return np.stack(np.broadcast_arrays(v, omega), axis=-1)


def kanayama_energy(error: ArrayLike, gains: Kanayama) -> Array:
    """V = (e_x^2 + e_y^2)/2 + (1 - cos e_theta)/k2 `(...)`: never grows under eq 5.10 (errata T56)."""
    e = np.asarray(error, dtype=float)
    return np.asarray((e[..., 0] ** 2 + e[..., 1] ** 2) / 2.0 + (1.0 - np.cos(e[..., 2])) / gains.k2)


def kanayama_energy_rate(error: ArrayLike, gains: Kanayama) -> Array:
    """dV/dt = -k1 e_x^2 - (k3/k2) sin^2 e_theta `(...)` of the energy above (errata T56)."""
    e = np.asarray(error, dtype=float)
    return np.asarray(-gains.k1 * e[..., 0] ** 2 - gains.k3 / gains.k2 * np.sin(e[..., 2]) ** 2)


# --- PID -----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Pid:
    """Two PID channels: error ahead to v, heading error plus k_y times error left to omega.

    `feed_forward` adds the reference's own speeds, which eq 1.12 does not have. An integral stops growing while its
    output is at the limit. Raises ValueError for a negative
    gain, or a proportional gain of 0.
    """

    kp_v: float = 1.0  # [1/s]
    ki_v: float = 0.5  # [1/s^2]
    kd_v: float = 0.05
    kp_omega: float = 2.0  # [1/s]
    ki_omega: float = 0.2  # [1/s^2]
    kd_omega: float = 0.05
    k_y: float = 2.0  # [rad/m]
    feed_forward: bool = False

    def __post_init__(self) -> None:
        positive_fields(self, may_be_zero=("ki_v", "kd_v", "ki_omega", "kd_omega", "k_y"))

    def start(self, setting: Setting) -> State:
        """The state before the first step."""
        return begin(setting, "pid", self)

    def command(self, state: State, pose: ArrayLike, row: Any) -> tuple[Array, State]:
        """Command (2,) and next state."""
        return stepped(PID, state, pose, row)


def pid(error: float, integral: float, last: float, gains: tuple[float, float, float], dt: float) -> float:
    """One PID output: Kp e + Ki times the integral (this error included) + Kd times the difference quotient.

    Source: thesis eq 1.12.

    >>> round(pid(0.2, 0.02, 0.1, (1.0, 0.5, 0.1), 0.1), 4)         # 0.2 + 0.01 + 0.1
    0.31
    """
    kp, ki, kd = gains
    return kp * error + ki * integral + kd * (error - last) / dt


# --- sliding mode --------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Sliding:
    """Sliding mode with the repaired surfaces: reaching rates, boundary layers and the slope of the second surface.

    Raises ValueError unless all are positive.
    """

    k1: float = 0.3  # [m/s]
    phi1: float = 0.1  # [m]
    k2: float = 1.5  # [rad/s]
    phi2: float = 0.3  # [rad]
    c: float = 2.0  # [1/m]

    def __post_init__(self) -> None:
        positive_fields(self)

    def start(self, setting: Setting) -> State:
        """The state before the first step."""
        return begin(setting, "sliding", self)

    def command(self, state: State, pose: ArrayLike, row: Any) -> tuple[Array, State]:
        """Command (2,) and next state."""
        return stepped(SLIDING, state, pose, row)


def sliding_surfaces_as_printed(error: ArrayLike, rate: ArrayLike, slopes: ArrayLike) -> Array:
    """Three surfaces s = de/dt + Lambda e `(..., 3)` of thesis eq 1.21 to 1.23, as printed.

    The rate holds v and omega, so a law written with s is an algebraic loop, and three surfaces cannot be forced
    with two inputs (errata T53).
    """
    return np.asarray(np.asarray(rate) + np.asarray(slopes, dtype=float) * np.asarray(error, dtype=float))


def sliding_surfaces(error: ArrayLike, v_r: ArrayLike, gains: Sliding) -> Array:
    """Two surfaces `(..., 2)` for two inputs: s1 = e1 [m], s2 = e3 + sign(v_r) atan(c e2) [rad].

    On s2 = 0 the robot is turned towards the path, and e2 shrinks while v_r is not 0.
    Source: thesis eq 1.21, 1.22, 1.23 (errata T53: the repaired choice).
    """
    e, v = np.asarray(error, dtype=float), np.asarray(v_r, dtype=float)
    sense = np.where(v >= 0.0, 1.0, -1.0)
    return np.stack([e[..., 0] + 0.0 * sense, wrap(e[..., 2] + sense * np.arctan(gains.c * e[..., 1]))], axis=-1)


def sliding(error: ArrayLike, wanted: ArrayLike, gains: Sliding) -> Array:
    """Command `(..., 2)` that gives ds_i/dt = -k_i sat(s_i/phi_i); the reference's speeds are (v_r, omega_r).

    Where c e1 would make omega ineffective on s2 (1 + slope e1 below 0.2) the divisor is held.
    Source: thesis eq 1.24 (errata T53: solved for the inputs instead of looping).
    """
    e, r = np.asarray(error, dtype=float), np.asarray(wanted, dtype=float)
    s = sliding_surfaces(e, r[..., 0], gains)
    sense = np.where(r[..., 0] >= 0.0, 1.0, -1.0)
    slope = sense * gains.c / (1.0 + (gains.c * e[..., 1]) ** 2)
    reach = gains.k2 * np.clip(s[..., 1] / gains.phi2, -1.0, 1.0)
    turning = r[..., 1] + slope * r[..., 0] * np.sin(e[..., 2]) + reach
    omega = turning / np.maximum(1.0 + slope * e[..., 0], LEAST_DIVISOR)
    pull = gains.k1 * np.clip(s[..., 0] / gains.phi1, -1.0, 1.0)
    return np.stack([r[..., 0] * np.cos(e[..., 2]) + omega * e[..., 1] + pull, omega], axis=-1)


def sliding_energy(surfaces: ArrayLike) -> Array:
    """V = s's/2 `(...)`; outside the layers dV/dt = -sum k_i |s_i|, inside it is only -sum k_i s_i^2/phi_i.

    Source: thesis eq 1.25, 1.26 (errata T53: finite time outside the layers alone).
    """
    s = np.asarray(surfaces, dtype=float)
    return np.asarray((s**2).sum(axis=-1) / 2.0)
