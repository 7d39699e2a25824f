"""The start page's demonstration: a robot that believes its odometry."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from fuzzynav.geometry import Array
from fuzzynav.plot.base import draw_path, draw_robot, metric_axes
from fuzzynav.robot import TURTLEBOT2, Robot, body_speeds, move, wheel_speeds

__all__ = ["LAP_FRAMES", "odometry_error", "odometry_lab", "odometry_lap"]

LAP_FRAMES = 101
SIDE = 3.0  # [m] of the square that the robot believes it drives
CORNER = 0.5  # [m] radius of its corners
SPEED = 0.4  # [m/s]


def odometry_lap(error: float, robot: Robot = TURTLEBOT2, frames: int = LAP_FRAMES) -> tuple[Array, Array]:
    """Believed and true poses `(frames, 3)` over one lap of a rounded square, equally spaced in time.

    The true right wheel is larger than the believed one by the fraction `error`; the robot counts
    the turns of its wheels without fault, so that it believes a perfect lap.
    """
    straight, quarter = (SIDE - 2 * CORNER) / SPEED, np.pi / 2 * CORNER / SPEED
    knots = np.cumsum([0.0, *([straight, quarter] * 4)])
    wheels = wheel_speeds(np.array([[SPEED, 0.0], [SPEED, SPEED / CORNER]] * 4), robot)
    times = np.linspace(0.0, knots[-1], frames)
    start = np.array([CORNER, 0.0, 0.0])
    believed = _drive(start, body_speeds(wheels, robot), knots, times)
    true = _drive(start, body_speeds(wheels * [1.0 + error, 1.0], robot), knots, times)
    return believed, true


def odometry_error(error: float) -> float:
    """Distance [m] between the believed and the true place after one lap."""
    believed, true = odometry_lap(error)
    return float(np.hypot(*(true[-1, :2] - believed[-1, :2])))


def odometry_lab(figure: Figure) -> Callable[..., tuple[list[Artist], str]]:
    """The demonstration for a player: frame 0 to LAP_FRAMES - 1, error [%] of the right wheel."""
    ax = metric_axes(figure.add_subplot(), (-1.2, 4.0, -1.2, 4.0))
    lap, _ = odometry_lap(0.0)
    draw_path(ax, lap[:, :2], role="reference", linestyle="--", label="believed path")
    line = draw_path(ax, [], label="true path")
    ghost = draw_robot(ax, lap[0], TURTLEBOT2.radius, role="unknown", label="where it believes to be")
    body = draw_robot(ax, lap[0], TURTLEBOT2.radius, label="where it is")
    figure.legend(loc="outside right upper")

    def update(frame: int, error: float) -> tuple[list[Artist], str]:
        believed, true = odometry_lap(error / 100.0)
        line.set_data(true[: frame + 1, 0], true[: frame + 1, 1])
        ghost.place(believed[frame])
        body.place(true[frame])
        gap = np.hypot(*(true[frame, :2] - believed[frame, :2]))
        when = "After one lap" if frame == LAP_FRAMES - 1 else f"After {frame} % of the lap"
        return [line, *ghost.artists, *body.artists], f"{when} the robot is {gap:.2f} m from where it believes to be."

    return update


def _drive(start: Array, commands: Array, knots: Array, times: Array) -> Array:
    """Poses at the given times while piece k of the commands holds from knot k to knot k + 1."""
    corners = [start]
    for command, duration in zip(commands, np.diff(knots), strict=True):
        corners.append(move(corners[-1], command, duration))
    piece = np.clip(np.searchsorted(knots, times, side="right") - 1, 0, len(commands) - 1)
    return move(np.array(corners)[piece], commands[piece], times - knots[piece])
