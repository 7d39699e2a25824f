"""The robot's motion as compiled steps: the one arc, the one limiter, the one wrap and the one record of limits.

Every loop of the course, open or compiled, moves its robot with these. `lim` is one LIMITS record.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from fuzzynav.geometry import Array

__all__ = [
    "LIMITS",
    "PLANT",
    "arc",
    "arcs",
    "chain",
    "clip",
    "drive",
    "euler",
    "limit",
    "limits",
    "reach",
    "reaches",
    "wrap",
]

LIMITS = np.dtype(
    (
        np.record,
        [
            ("v_low", "f8"),  # [m/s]
            ("v_high", "f8"),  # [m/s]
            ("omega", "f8"),  # [rad/s]
            ("gain", "f8"),  # [m/s^2] speeding up
            ("loss", "f8"),  # [m/s^2] braking
            ("spin", "f8"),  # [rad/s^2] of the turn
            ("radius", "f8"),  # [m]
        ],
    )
)


PLANT = np.dtype(
    (
        np.record,
        [
            ("wheel_radius", "f8"),  # [m] as the robot believes it
            ("track", "f8"),  # [m]
            ("lag", "f8"),  # [s] time constant of the motors
            ("right", "f8"),  # relative error of the true radius of the right wheel
            ("left", "f8"),
        ],
    )
)


@njit(cache=True)
def wrap(angle: float) -> float:
    """Angle [rad] brought to [-pi, pi); what is in range keeps its last digit, as in `geometry.wrap`."""
    if -np.pi <= angle < np.pi:
        return angle
    wrapped = (angle + np.pi) % (2.0 * np.pi) - np.pi
    return -np.pi if wrapped >= np.pi else wrapped


@njit(cache=True)
def clip(value: float, low: float, high: float) -> float:
    """The value, or the bound that it passes."""
    return min(max(value, low), high)


@njit(cache=True)
def arc(x: float, y: float, theta: float, v: float, omega: float, dt: float) -> tuple[float, float, float]:
    """Pose after driving v [m/s], omega [rad/s] for dt [s] along the exact arc."""
    half = 0.5 * omega * dt
    chord = v * dt if half == 0.0 else v * dt * (np.sin(half) / half)
    return x + chord * np.cos(theta + half), y + chord * np.sin(theta + half), wrap(theta + 2.0 * half)


@njit(cache=True)
def euler(x: float, y: float, theta: float, v: float, omega: float, dt: float) -> tuple[float, float, float]:
    """Pose after one Euler step, as the thesis integrates: the chord lies along the old heading."""
    return x + v * dt * np.cos(theta), y + v * dt * np.sin(theta), wrap(theta + omega * dt)


@njit(cache=True)
def arcs(poses: Array, commands: Array, times: Array, out: Array) -> None:
    """Fill out `(n, 3)` with the poses after n arcs."""
    for i in range(out.shape[0]):
        x, y, theta = arc(poses[i, 0], poses[i, 1], poses[i, 2], commands[i, 0], commands[i, 1], times[i])
        out[i, 0], out[i, 1], out[i, 2] = x, y, theta


@njit(cache=True)
def chain(poses: Array, motions: Array) -> None:
    """Fill poses 1 to n from pose 0 and motions `(n, 2)` of advance [m] and turn [rad], arc after arc."""
    for i in range(motions.shape[0]):
        x, y, theta = arc(poses[i, 0], poses[i, 1], poses[i, 2], motions[i, 0], motions[i, 1], 1.0)
        poses[i + 1, 0], poses[i + 1, 1], poses[i + 1, 2] = x, y, theta


@njit(cache=True)
def reach(v: float, omega: float, lim: Any, dt: float) -> tuple[float, float, float, float]:
    """Lowest and highest v, lowest and highest omega that the acceleration limits allow after dt [s].

    A robot that changes direction brakes to zero first and speeds up with what is left of dt.
    """
    gain, loss, ratio = lim.gain * dt, lim.loss * dt, lim.gain / lim.loss
    up = v + gain if v >= 0.0 else (v + loss if v + loss <= 0.0 else (v + loss) * ratio)
    down = v - gain if v <= 0.0 else (v - loss if v - loss >= 0.0 else (v - loss) * ratio)
    return down, up, omega - lim.spin * dt, omega + lim.spin * dt


@njit(cache=True)
def limit(wish_v: float, wish_omega: float, v: float, omega: float, lim: Any, dt: float) -> tuple[float, float]:
    """The command nearest to the wish that the limits of speed and of acceleration allow from (v, omega)."""
    down, up, right, left = reach(v, omega, lim, dt)
    return clip(clip(wish_v, lim.v_low, lim.v_high), down, up), clip(
        clip(wish_omega, -lim.omega, lim.omega), right, left
    )


@njit(cache=True)
def reaches(last: Array, robot: Any, dt: float, low: Array, high: Array) -> None:
    """Fill low and high `(n, 2)` with the ends of `reach` for n last commands."""
    for i in range(last.shape[0]):
        low[i, 0], high[i, 0], low[i, 1], high[i, 1] = reach(last[i, 0], last[i, 1], robot[0], dt)


@njit(cache=True)
def limits(wishes: Array, last: Array, robot: Any, dt: float) -> None:
    """Limit n wishes `(n, 2)` in place."""
    for i in range(wishes.shape[0]):
        wishes[i, 0], wishes[i, 1] = limit(wishes[i, 0], wishes[i, 1], last[i, 0], last[i, 1], robot[0], dt)


@njit(cache=True)
def drive(
    pose: Array, wheels: Array, command: Array, slip: Array, plant: Any, dt: float, by_euler: bool, driven: Array
) -> None:
    """One step of the true robot: motors that lag, wheels that slip or have the wrong radius, then the exact arc.

    Changes pose (3,), the rates of the wheels `(2,)` [rad/s] (right, left) and `driven`, the mean body speeds (2,).
    slip: share of its speed that each wheel loses. An ideal plant drives the command itself, to the last digit.
    """
    half = command[1] * plant.track / 2.0
    right, left = (command[0] + half) / plant.wheel_radius, (command[0] - half) / plant.wheel_radius
    if plant.lag == 0.0 and plant.right == 0.0 and plant.left == 0.0 and slip[0] == 0.0 and slip[1] == 0.0:
        driven[0], driven[1] = command[0], command[1]
        wheels[0], wheels[1] = right, left
    else:
        fade = np.exp(-dt / plant.lag) if plant.lag > 0.0 else 0.0
        mean = plant.lag / dt * (1.0 - fade)  # share of the old rate in the mean over the step
        rims_right = (right + mean * (wheels[0] - right)) * plant.wheel_radius * (1.0 + plant.right) * (1.0 - slip[0])
        rims_left = (left + mean * (wheels[1] - left)) * plant.wheel_radius * (1.0 + plant.left) * (1.0 - slip[1])
        wheels[0], wheels[1] = right + fade * (wheels[0] - right), left + fade * (wheels[1] - left)
        driven[0], driven[1] = (rims_right + rims_left) / 2.0, (rims_right - rims_left) / plant.track
    if by_euler:
        pose[0], pose[1], pose[2] = euler(pose[0], pose[1], pose[2], driven[0], driven[1], dt)
    else:
        pose[0], pose[1], pose[2] = arc(pose[0], pose[1], pose[2], driven[0], driven[1], dt)


def _warm() -> None:
    """Compile every kernel with the types used in practice."""
    plant = np.array([(0.035, 0.23, 0.1, 0.0, 0.0)], dtype=PLANT)
    drive(np.zeros(3), np.zeros(2), np.ones(2), np.zeros(2), plant[0], 0.1, False, np.zeros(2))
    robot = np.array([(-1.0, 1.0, 1.0, 0.5, 0.5, 1.0, 0.2)], dtype=LIMITS)
    still, out = np.zeros((1, 2)), np.empty((1, 3))
    for poses in (np.zeros((1, 3)), np.broadcast_to(np.zeros(3), (1, 3))):
        arcs(poses, still, np.ones(1), out)
    chain(np.zeros((2, 3)), still)
    reaches(still, robot, 0.1, still.copy(), still.copy())
    limits(still.copy(), still, robot, 0.1)
    euler(0.0, 0.0, 0.0, 1.0, 0.0, 0.1)
