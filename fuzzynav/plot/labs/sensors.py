"""The labs of chapter 01: wheel errors, a laser in a room, the cone of a sonar, the depth error of a stereo camera."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from fuzzynav.geometry import wrap
from fuzzynav.plot.base import COLORS, draw_grid, draw_path, draw_robot, metric_axes
from fuzzynav.plot.sensors import draw_beams, place_beams
from fuzzynav.robot import TURTLEBOT2
from fuzzynav.sensors import Encoders, Laser, Sonar, dead_reckon, laser_scan, sonar_cone
from fuzzynav.sensors.cameras import Stereo, disparity, stereo_reading, stereo_sigma
from fuzzynav.studies.sensors import believed_run, room, square_motions, wall

__all__ = ["laser_lab", "sonar_lab", "stereo_lab", "wheel_error_lab"]

Update = Callable[..., tuple[list[Artist], str]]


def wheel_error_lab(figure: Figure) -> Update:
    """Two laps of a square as driven and as odometry believes; errors in percent, ticks per turn."""
    motions = square_motions(laps=2)
    true = dead_reckon(np.zeros(3), motions)
    ax = metric_axes(figure.add_subplot(), (-2.6, 4.2, -1.6, 4.6))
    draw_path(ax, true[:, :2], role="reference", linestyle="--", label="driven")
    line = draw_path(ax, [], label="believed")
    here = draw_robot(ax, true[-1], TURTLEBOT2.radius, role="reference", label="where it is")
    there = draw_robot(ax, true[-1], TURTLEBOT2.radius, label="where it believes to be")
    figure.legend(loc="outside right upper")

    def update(
        right: float, left: float, track: float, slip: float, noise: float, ticks: int
    ) -> tuple[list[Artist], str]:
        faults = Encoders(
            ticks_per_turn=int(ticks),
            right_radius_error=right / 100,
            left_radius_error=left / 100,
            track_error=track / 100,
            slip=slip / 100,
            slip_noise=noise,
        )
        told = believed_run(motions, TURTLEBOT2, faults)
        line.set_data(told[:, 0], told[:, 1])
        there.place(told[-1])
        gap, turn = np.hypot(*(told[-1] - true[-1])[:2]), np.rad2deg(wrap(told[-1, 2] - true[-1, 2]))
        text = f"After two laps: {gap:.2f} m and {np.round(turn, 1) + 0.0:.1f} deg off."
        return [line, *here.artists, *there.artists], text

    return update


def laser_lab(figure: Figure) -> Update:
    """A laser scan in a room that a person crosses in ten seconds; noise [m], dropout [%]."""
    pose = np.array([3.2, 1.6, 0.6])
    world = room()
    ax = metric_axes(figure.add_subplot(), (0.0, 8.0, 0.0, 4.25))
    if world.grid is not None:
        draw_grid(ax, world.grid)
    base = Laser(field_of_view=2.0 * np.pi, range_max=6.0)
    beams = draw_beams(ax, pose, laser_scan(world, pose, base, np.random.default_rng(0)))
    (dots,) = ax.plot([], [], linestyle="", marker=".", color=COLORS["path"], zorder=6)
    body = draw_robot(ax, pose, TURTLEBOT2.radius)
    person = Circle((0.0, 0.0), world.movers[0].radius, facecolor=COLORS["mover"], edgecolor="black", zorder=5)
    ax.add_patch(person)

    def update(time: float, beams_used: int, noise: float, dropout: float, reach: float) -> tuple[list[Artist], str]:
        at = np.add(world.movers[0].start, np.multiply(world.movers[0].velocity, time))
        person.center = (float(at[0]), float(at[1]))
        laser = replace(base, beams=int(beams_used), noise=noise, dropout=dropout / 100, range_max=reach)
        scan = laser_scan(world, pose, laser, np.random.default_rng(1), at[None])
        place_beams(beams, pose, scan)
        points = scan.world_points(pose)
        dots.set_data(points[:, 0], points[:, 1])
        near = int((np.hypot(*(points - at).T) < 0.25 + 3 * noise + 0.02).sum()) if len(points) else 0
        text = f"{int(scan.hits.sum())} of {int(beams_used)} beams measured a surface, {near} of them the person."
        return [beams, dots, person, *body.artists], text

    return update


def sonar_lab(figure: Figure) -> Update:
    """A sonar before a smooth wall; angles in degrees, distance in metres."""
    ax = metric_axes(figure.add_subplot(), (-0.3, 5.3, -1.7, 1.7))
    board = Polygon(np.zeros((4, 2)), facecolor=COLORS["obstacle"], zorder=3)
    ax.add_patch(board)
    rays = LineCollection([], linewidths=0.8, zorder=2)
    ax.add_collection(rays, autolim=False)
    (arc,) = ax.plot([], [], color=COLORS["path"], linestyle="-", linewidth=2.5, zorder=6)
    draw_robot(ax, [0.0, 0.0, 0.0], TURTLEBOT2.radius)

    def update(angle: float, distance: float, cone: float, specular: float) -> tuple[list[Artist], str]:
        sonar = Sonar(cone=np.deg2rad(cone), specular_angle=np.deg2rad(specular), noise=0.0, range_max=5.0)
        angles, ranges, echo = sonar_cone(wall(np.deg2rad(angle), distance), np.zeros(3), sonar)
        ends = np.stack([ranges * np.cos(angles), ranges * np.sin(angles)], axis=-1)
        rays.set_segments(list(np.stack([np.zeros_like(ends), ends], axis=1)))
        rays.set_color([COLORS["accent"] if heard else "#CCCCCC" for heard in echo])
        reading = float(np.min(ranges[echo], initial=sonar.range_max))
        arc.set_data(reading * np.cos(angles), reading * np.sin(angles))
        along, across = np.array([-np.sin(np.deg2rad(angle)), np.cos(np.deg2rad(angle))]), np.deg2rad(angle)
        face = np.array([distance, 0.0]) + np.outer([-3.0, 3.0], along)
        board.set_xy(np.vstack([face, face[::-1] + 0.1 * np.array([np.cos(across), np.sin(across)])]))
        return [board, rays, arc], _sonar_words(reading, distance, int(echo.sum()), sonar)

    return update


def _sonar_words(reading: float, distance: float, heard: int, sonar: Sonar) -> str:
    if heard == 0:
        return f"No echo: the sonar reports {sonar.range_max:.2f} m, the wall ahead is at {distance:.2f} m."
    returned = f"{heard} of {sonar.rays} rays return."
    return f"Reading {reading:.2f} m, straight ahead the wall is at {distance:.2f} m; {returned}"


def stereo_lab(figure: Figure) -> Update:
    """Measured against true depth, and the depth error over the distance; focal [px], baseline [m], sigma [px]."""
    left, right = figure.subplots(1, 2)
    depth = np.linspace(0.5, 8.0, 151)
    _stereo_axes(left, right)
    (dots,) = left.plot([], [], linestyle="", marker=".", color=COLORS["robot"], markersize=3)
    (curve,) = right.plot([], [], color=COLORS["path"], linestyle="-")
    (mark,) = right.plot([], [], linestyle="", marker="o", color=COLORS["robot"])

    def update(focal: float, baseline: float, sigma: float, at: float) -> tuple[list[Artist], str]:
        stereo = Stereo(focal=focal, baseline=baseline, disparity_sigma=sigma)
        many = np.repeat(depth, 4)
        dots.set_data(many, stereo_reading(many, stereo, np.random.default_rng(0)))
        curve.set_data(depth, stereo_sigma(depth, stereo))
        error, shift = float(stereo_sigma(at, stereo)), float(disparity(at, stereo))
        mark.set_data([at], [error])
        return [dots, curve, mark], f"At {at:.1f} m: disparity {shift:.1f} px, standard deviation {100 * error:.1f} cm."

    return update


def _stereo_axes(left: Axes, right: Axes) -> None:
    left.plot([0.0, 8.0], [0.0, 8.0], color=COLORS["reference"], linestyle="--", linewidth=1.0)
    left.set(xlim=(0.0, 8.0), ylim=(0.0, 12.0), xlabel="true depth [m]", ylabel="measured depth [m]")
    right.set(xlim=(0.0, 8.0), ylim=(0.0, 1.5), xlabel="depth [m]", ylabel="standard deviation [m]")
