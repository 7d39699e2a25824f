"""The labs of chapter 02: growing doubt, a filter and its honesty, a swarm that finds the robot, a map that appears."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from fuzzynav.geometry import Array
from fuzzynav.localization.kalman import (
    Belief,
    LandmarkSensor,
    MotionNoise,
    Track,
    dead_reckoning,
    ellipse,
    nees_bounds,
)
from fuzzynav.mapping.occupancy import InverseSensor, empty, update
from fuzzynav.plot.base import COLORS, draw_grid, draw_path, draw_robot, metric_axes
from fuzzynav.plot.maps import draw_ellipses, draw_nees, draw_occupancy, draw_swarm, ellipse_lines, place_swarm
from fuzzynav.robot import TURTLEBOT2
from fuzzynav.sensors import Laser, dead_reckon
from fuzzynav.studies import localization as study

__all__ = ["STORIES", "doubt_lab", "ekf_lab", "occupancy_lab", "swarm_lab"]

Update = Callable[..., tuple[list[Artist], str]]
START = np.array([5.0, 1.5, 0.0])
STORIES = ("start unknown", "start known", "kidnapped", "kidnapped, no recovery")


def doubt_lab(figure: Figure) -> Update:
    """Dead reckoning round the hall: noise of travel and turn in percent, and the laps driven."""
    ax = metric_axes(figure.add_subplot(), (-0.5, 11.0, -1.5, 8.5))
    line = draw_path(ax, [], role="robot", label="believed path")
    cloud = ax.scatter([], [], s=5, color=COLORS["mover"], linewidths=0, zorder=4, label="200 robots with this noise")
    rings = draw_ellipses(ax, Track(START[None], np.zeros((1, 3, 3))))
    rings.set_label("95 % ellipses by the Jacobians")
    figure.legend(loc="outside upper center", ncols=3)

    def update(travel: float, turn: float, laps: int) -> tuple[list[Artist], str]:
        noise = MotionNoise(
            travel_per_metre=(travel / 100) ** 2,
            travel_per_radian=0.0,
            turn_per_metre=np.deg2rad(turn) ** 2,
            turn_per_radian=0.0,
        )
        motions = study.lap(int(laps))
        found = dead_reckoning(Belief(START, np.zeros((3, 3))), motions, noise)
        walks = study.random_walks(START, motions, noise, 200)
        line.set_data(found.means[:, 0], found.means[:, 1])
        cloud.set_offsets(walks[:, :2])
        rings.set_segments(ellipse_lines(found, 12))
        share = _inside(walks[:, :2], found)
        sigma = np.sqrt(np.linalg.eigvalsh(found.covariances[-1][:2, :2]))
        return [line, cloud, rings], (
            f"After {int(laps)} lap(s): standard deviation {sigma[1]:.2f} m along the long "
            f"axis, {sigma[0]:.2f} m across; {100 * share:.0f} % of the robots inside."
        )

    return update


def _inside(points: Array, track: Track) -> float:
    """Share of the points inside the 95 % ellipse of the last belief."""
    edge = ellipse(track.means[-1], track.covariances[-1], 0.95, 181) - track.means[-1, :2]
    gap = points - track.means[-1, :2]
    reach = np.interp(np.arctan2(gap[:, 1], gap[:, 0]), *_by_angle(edge))
    return float((np.hypot(*gap.T) <= reach).mean())


def _by_angle(edge: Array) -> tuple[Array, Array]:
    angle = np.arctan2(edge[:-1, 1], edge[:-1, 0])
    order = np.argsort(angle)
    angle, size = angle[order], np.hypot(*edge[:-1][order].T)
    return np.concatenate([angle - 2 * np.pi, angle, angle + 2 * np.pi]), np.tile(size, 3)


def ekf_lab(figure: Figure) -> Update:
    """The filter of the hall: noise of range [m] and bearing [deg], trust in them, number of beacons."""
    left, right = figure.subplots(1, 2, width_ratios=[1.4, 1.0])
    metric_axes(left, (0.0, 10.0, 0.0, 7.0))
    track = dead_reckon(START, study.lap())
    draw_path(left, track[:, :2], role="reference", linestyle="--", label="driven")
    line = draw_path(left, [], label="estimated")
    rings = draw_ellipses(left, Track(START[None], np.zeros((1, 3, 3))))
    (marks,) = left.plot([], [], marker="^", linestyle="", color=COLORS["goal"], markersize=8, label="beacons")
    curve = draw_nees(right, np.ones(len(track)), nees_bounds(1))
    figure.legend(loc="outside upper center", ncols=4)

    def update(sigma: float, bearing: float, trust: float, beacons: int) -> tuple[list[Artist], str]:
        sensor = LandmarkSensor(sigma_range=sigma, sigma_bearing=np.deg2rad(bearing), range_max=5.0)
        here = study.BEACONS[: int(beacons)]
        truth, found, honesty = study.ekf_run(sensor, trust=trust, beacons=here)
        line.set_data(found.means[:, 0], found.means[:, 1])
        rings.set_segments(ellipse_lines(found, 6))
        marks.set_data(here[:, 0], here[:, 1])
        curve.set_ydata(np.maximum(honesty, 0.01))
        error = np.sqrt(np.mean(np.sum((found.means - truth)[:, :2] ** 2, axis=1)))
        return [line, rings, marks, curve], (
            f"RMS error {error:.2f} m; mean NEES {honesty.mean():.1f} "
            "(3 is honest, more is overconfident, less is too modest)."
        )

    return update


def swarm_lab(figure: Figure) -> Update:
    """The particle filter in the flat: frame, number of particles and story, both as text."""
    ax = figure.add_subplot()
    draw_grid(ax, study.flat())
    first = study.chase(300)
    dots = draw_swarm(ax, first.swarms[0])
    robot = draw_robot(ax, first.truth[0], TURTLEBOT2.radius, role="reference", label="true")
    guess = draw_robot(ax, first.estimates[0], TURTLEBOT2.radius, role="path", label="estimated")
    figure.legend(loc="outside upper center", ncols=3)

    def update(frame: int, particles: str, story: str) -> tuple[list[Artist], str]:
        run = study.chase(
            int(particles), lost=story == STORIES[0], kidnap=story in STORIES[2:], recovery=story != STORIES[3]
        )
        k = min(int(frame), len(run.errors) - 1)
        place_swarm(dots, run.swarms[k])
        robot.place(run.truth[k])
        guess.place(run.estimates[k])
        return [dots, *robot.artists, *guess.artists], f"Scan {k + 1}: the estimate is {run.errors[k]:.2f} m off."

    return update


def occupancy_lab(figure: Figure) -> Update:
    """A map that appears scan by scan: frame, range noise [m], and the share of the odometry's drift that is left."""
    ax = figure.add_subplot()
    motions, truth = study.tour()
    blank = empty(study.flat().extent, 0.1)
    image = draw_occupancy(ax, blank)
    robot = draw_robot(ax, truth[0], TURTLEBOT2.radius)
    base = Laser(beams=121, field_of_view=np.deg2rad(240.0), range_max=8.0, noise=0.0)
    poses, scans = study.tour_scans(base, every=4)
    ranges, drifted = np.array([s.ranges for s in scans]), dead_reckon(truth[0], study.odometry_of(motions))[::4]

    def update_map(frame: int, noise: float, drift: float) -> tuple[list[Artist], str]:
        k = min(int(frame) + 1, len(poses))
        told = np.maximum(ranges + noise * np.random.default_rng(0).standard_normal(ranges.shape), 0.0)
        believed = poses + drift / 100 * (drifted - poses - _turns(drifted - poses))
        grid = update(blank, believed[:k], told[:k], base.angles, InverseSensor(reach=8.0))
        image.set_data(grid.probability)
        robot.place(believed[k - 1])
        sharp = grid.sharpness()
        return [image, *robot.artists], (
            f"{k} scans: {sharp.occupied} cells occupied, {sharp.free} free, "
            f"mean doubt {sharp.entropy:.2f} bit a seen cell."
        )

    return update_map


def _turns(gap: Array) -> Array:
    """Whole turns in the heading column of pose differences."""
    out = np.zeros_like(gap)
    out[:, 2] = 2.0 * np.pi * np.round(gap[:, 2] / (2.0 * np.pi))
    return out
