"""The derivatives of a measured position: by differences, by a Luenberger observer and by a Kalman filter.

An observer estimates the flat state z = (x, dx/dt, y, dy/dt) from positions `(2,)` [m] measured every dt [s];
the model between two of them is the double integrator of eq 2.18, pushed by the acceleration of the last command.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from fuzzynav.geometry import Array

if TYPE_CHECKING:
    from filterpy.kalman import KalmanFilter

__all__ = ["Differences", "Kalman", "Luenberger", "Observer", "luenberger_gain"]


class Observer(Protocol):
    """Estimates z from positions; `push` tells it the acceleration of the command that was given."""

    def reset(self) -> None:
        """Forget everything."""
        ...

    def update(self, position: Array, velocity: Array) -> Array:
        """z `(4,)` from a measured position; `velocity` (2,) [m/s] is the guess used at the first call."""
        ...

    def push(self, acceleration: Array) -> None:
        """Note the acceleration (2,) [m/s^2] that acts until the next measurement."""
        ...


def _chain(dt: float) -> tuple[Array, Array]:
    """One double integrator sampled at dt: transition (2, 2) and input (2,)."""
    if not (np.isfinite(dt) and dt > 0):
        raise ValueError(f"dt must be positive and finite, got {dt}")
    return np.array([[1.0, dt], [0.0, 1.0]]), np.array([dt**2 / 2.0, dt])


class Differences:
    """Backward differences of the measured positions: no model, and noise divided by dt."""

    def __init__(self, dt: float = 0.1) -> None:
        _chain(dt)
        self.dt = dt
        self.reset()

    def reset(self) -> None:
        """Forget the last position."""
        self._last: Array | None = None

    def update(self, position: Array, velocity: Array) -> Array:
        """The measured position and its difference quotient."""
        rate = velocity if self._last is None else (position - self._last) / self.dt
        self._last = position.copy()
        return np.array([position[0], rate[0], position[1], rate[1]])

    def push(self, acceleration: Array) -> None:
        """Differences know no model."""


def luenberger_gain(poles: tuple[float, float], dt: float) -> Array:
    """Gain (2,) that puts the poles of one channel's estimation error at exp(p dt), p given in [1/s].

    Raises ValueError unless both poles are negative and different.

    >>> luenberger_gain((-3.0, -4.0), 0.1).round(4).tolist()
    [0.5034, 0.8545]
    """
    if not (max(poles) < 0 and poles[0] != poles[1]):
        raise ValueError(f"the two poles of an observer must be negative and different, got {poles}")
    transition, _ = _chain(dt)
    # the error after correction is (A - L C A) e: place the poles of the pair (A', (C A)')
    seen = transition[:1]
    from scipy.signal import place_poles  # here: it loads all of scipy.signal and scipy.stats

    placed = place_poles(transition.T, seen.T, np.exp(np.asarray(poles) * dt))
    return np.asarray(placed.gain_matrix[0])


class Luenberger:
    """Observer of fixed gain: predict with the model, correct by the gain times the surprise."""

    def __init__(self, dt: float = 0.1, poles: tuple[float, float] = (-2.0, -2.5)) -> None:
        self.transition, self.input = _chain(dt)
        self.gain = luenberger_gain(poles, dt)
        self.reset()

    def reset(self) -> None:
        """Forget the estimate."""
        self._z: Array | None = None  # (2, 2): axis, order
        self._push = np.zeros(2)

    def update(self, position: Array, velocity: Array) -> Array:
        """Corrected estimate; the first call takes the position as measured and the velocity as guessed."""
        if self._z is None:
            self._z = np.stack([position, velocity], axis=-1)
        else:
            guess = self._z @ self.transition.T + self._push[:, None] * self.input
            self._z = guess + (position - guess[:, 0])[:, None] * self.gain
        return self._z.reshape(4).copy()

    def push(self, acceleration: Array) -> None:
        """Note the acceleration that acts until the next measurement."""
        self._push = acceleration


class Kalman:
    """Kalman filter (filterpy) of the two double integrators with known input.

    position_noise: standard deviation of a measured position [m]; drive_noise: of the acceleration that the model
    does not know [m/s^2]. Raises ValueError unless both are positive.
    """

    def __init__(self, dt: float = 0.1, position_noise: float = 0.01, drive_noise: float = 0.05) -> None:
        if not (position_noise > 0 and drive_noise > 0):
            raise ValueError(f"the two noises must be positive, got {position_noise} and {drive_noise}")
        self.position_noise, self.drive_noise = position_noise, drive_noise
        self.transition, self.input = _chain(dt)
        self.reset()

    def reset(self) -> None:
        """Forget the estimate and its covariance."""
        self._filter: KalmanFilter | None = None
        self._push = np.zeros(2)

    def update(self, position: Array, velocity: Array) -> Array:
        """Predicted and corrected estimate; the first call takes the position as measured."""
        if self._filter is None:
            self._filter = self._new(position, velocity)
        else:
            self._filter.predict(u=self._push)
            self._filter.update(position)
        return np.asarray(self._filter.x, dtype=float).reshape(4).copy()

    def push(self, acceleration: Array) -> None:
        """Note the acceleration that acts until the next measurement."""
        self._push = acceleration

    def _new(self, position: Array, velocity: Array) -> KalmanFilter:
        from filterpy.kalman import KalmanFilter  # here: it loads all of scipy.stats, which no other law needs

        kalman = KalmanFilter(dim_x=4, dim_z=2, dim_u=2)
        both = np.eye(2)
        kalman.F, kalman.B = np.kron(both, self.transition), np.kron(both, self.input[:, None])
        kalman.H = np.kron(both, np.array([[1.0, 0.0]]))
        kalman.R = both * self.position_noise**2
        kalman.Q = np.kron(both, np.outer(self.input, self.input)) * self.drive_noise**2
        kalman.P = np.kron(both, np.diag([self.position_noise**2, 0.1**2]))
        kalman.x = np.array([position[0], velocity[0], position[1], velocity[1]])
        return kalman
