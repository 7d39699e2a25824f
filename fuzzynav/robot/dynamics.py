"""Forces on the robot: torques, accelerations, and motors that lag behind their command."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array, wrap
from fuzzynav.robot.kinematics import pose_rate
from fuzzynav.robot.model import Robot

__all__ = ["accelerations", "drive", "motor_lag", "state_rate"]


def accelerations(torques: ArrayLike, robot: Robot) -> Array:
    """Accelerations v' [m/s^2], omega' [rad/s^2] from wheel torques `(..., 2)` (right, left) [N m].

    Source: thesis eq 2.10 with the full separation: L/(2r) (errata T28).

    >>> from fuzzynav.robot import TURTLEBOT2
    >>> accelerations([0.2, 0.1], TURTLEBOT2).round(4).tolist()    # 0.3/(6.3*0.035), 0.23*0.1/(2*0.1*0.035)
    [1.3605, 3.2857]
    """
    t = np.asarray(torques, dtype=float)
    forward = (t[..., 0] + t[..., 1]) / (robot.mass * robot.wheel_radius)
    turn = robot.track / (2.0 * robot.wheel_radius) * (t[..., 0] - t[..., 1]) / robot.inertia
    return np.stack([forward, turn], axis=-1)


def state_rate(state: ArrayLike, torques: ArrayLike, robot: Robot) -> Array:
    """Derivative of the state `(..., 5)` x, y, theta, v, omega under wheel torques (right, left) [N m].

    Source: thesis eq 2.12 (errata T28).
    """
    s = np.asarray(state, dtype=float)
    motion, push = pose_rate(s[..., :3], s[..., 3:]), accelerations(torques, robot)
    shape = np.broadcast_shapes(motion.shape[:-1], push.shape[:-1])
    return np.concatenate([np.broadcast_to(motion, (*shape, 3)), np.broadcast_to(push, (*shape, 2))], axis=-1)


def drive(state: ArrayLike, torques: ArrayLike, dt: float, robot: Robot) -> Array:
    """State `(5,)` after dt [s] of constant wheel torques, by SciPy's eighth-order Runge-Kutta (DOP853).

    The step adapts to a relative error of 1e-10; theta is wrapped. Raises ValueError if an input is not finite.
    """
    start, torque = np.asarray(state, dtype=float), np.asarray(torques, dtype=float)
    if start.shape != (5,) or torque.shape != (2,) or not (np.isfinite([*start, *torque, dt]).all() and dt >= 0):
        raise ValueError("drive needs a state (5,), torques (2,) and dt >= 0, all finite")
    from scipy.integrate import solve_ivp  # here: a robot that follows speeds loads no integrator

    done = solve_ivp(lambda _, s: state_rate(s, torque, robot), (0.0, dt), start, "DOP853", rtol=1e-10, atol=1e-12)
    end = done.y[:, -1]
    end[2] = wrap(end[2])
    return np.asarray(end)


def motor_lag(speed: ArrayLike, command: ArrayLike, time_constant: float, dt: float) -> Array:
    """Speeds after dt [s] of a first-order motor that follows `command`; exact for any dt.

    Raises ValueError if the time constant [s] is not positive or dt is negative.

    >>> float(motor_lag(0.0, 1.0, 0.1, 0.1).round(3))               # 1 - 1/e
    0.632
    """
    if not (time_constant > 0 and dt >= 0):
        raise ValueError(f"time_constant must be positive and dt not negative, got {time_constant} and {dt}")
    s, c = np.asarray(speed, dtype=float), np.asarray(command, dtype=float)
    return np.asarray(c + (s - c) * np.exp(-dt / time_constant))
