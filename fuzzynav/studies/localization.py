"""The scenes and runs of notebook 02, all our choice: a flat of five places, a hall with beacons, a table in depth."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from fuzzynav.geometry import Array, wrap
from fuzzynav.localization.kalman import (
    Belief,
    LandmarkSensor,
    MotionNoise,
    Track,
    correct,
    nees,
    predict,
    sample_motions,
    see_landmarks,
    track,
)
from fuzzynav.localization.particles import (
    LikelihoodField,
    MonteCarlo,
    Swarm,
    drift,
    likelihood_field,
    scatter,
    spread,
    step,
)
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import move
from fuzzynav.sensors import Laser, Scan, dead_reckon, laser_scan
from fuzzynav.sensors.cameras import Camera
from fuzzynav.world import World

__all__ = [
    "BEACONS",
    "NAMES",
    "NOISE",
    "Chase",
    "boxes_depth",
    "chase",
    "ekf_run",
    "flat",
    "lap",
    "odometry_of",
    "random_walks",
    "table_scene",
    "tour",
    "tour_scans",
]

NAMES = {"kitchen": (2.0, 5.6), "lab": (7.5, 5.6), "corridor": (5.0, 3.6), "office": (2.5, 1.5), "store": (8.5, 1.5)}
NOISE = MotionNoise(travel_per_metre=1e-3, travel_per_radian=1e-4, turn_per_metre=2e-3, turn_per_radian=4e-3)
BEACONS = np.array([[0.5, 0.5], [9.5, 0.5], [9.5, 6.5], [0.5, 6.5], [5.0, 3.5]])
_WALLS = ((0.0, 2.9, 10.0, 0.1), (0.0, 4.2, 10.0, 0.1), (4.5, 4.2, 0.1, 2.8), (6.0, 0.0, 0.1, 3.0))  # x, y, w, h [m]
_DOORS = ((1.5, 4.2, 0.9, 0.1), (7.0, 4.2, 0.9, 0.1), (3.0, 2.9, 0.9, 0.1), (8.0, 2.9, 0.9, 0.1))
_THINGS = ((3.0, 5.8, 0.9, 0.6), (0.1, 0.1, 0.4, 2.0), (9.0, 4.9, 0.6, 1.4), (6.8, 0.1, 1.6, 0.4), (5.2, 6.4, 1.0, 0.5))


def flat() -> GridMap:
    """A flat of 10 m by 7 m in cells of 0.1 m: kitchen, lab, office and store round a corridor, with furniture."""
    occupied = np.zeros((70, 100), dtype=bool)
    occupied[[0, -1], :] = occupied[:, [0, -1]] = True
    for boxes, value in ((_WALLS, True), (_DOORS, False), (_THINGS, True)):
        for x, y, w, h in boxes:
            i, j, m, n = (round(10 * v) for v in (x, y, w, h))
            occupied[j : j + n, i : i + m] = value
    return GridMap(occupied, 0.1)


_STOPS = [
    (1.0, 5.0),
    (1.95, 5.0),
    (1.95, 3.6),
    (3.45, 3.6),
    (3.45, 1.4),
    (1.5, 1.4),
    (3.45, 1.4),
    (3.45, 3.6),
    (8.45, 3.6),
    (8.45, 1.2),
    (8.45, 3.6),
    (7.45, 3.6),
    (7.45, 5.6),
    (6.0, 5.6),
]


def tour(stops: list[tuple[float, float]] = _STOPS, advance: float = 0.15, turn: float = 0.3) -> tuple[Array, Array]:
    """A drive through the flat: motions `(n, 2)`, advance [m] and turn [rad], and the true poses `(n + 1, 3)`.

    The robot turns on the spot towards each stop and drives straight; steps are at most `advance` and `turn` long.
    """
    pose = np.array([*stops[0], 0.0])
    motions: list[tuple[float, float]] = []
    for stop in stops[1:]:
        gap = np.subtract(stop, pose[:2])
        angle, length = float(wrap(np.arctan2(gap[1], gap[0]) - pose[2])), float(np.hypot(*gap))
        for amount, largest, column in ((angle, turn, 1), (length, advance, 0)):
            n = int(np.ceil(abs(amount) / largest - 1e-9))
            part = amount / max(n, 1)
            motions += [(0.0, part) if column else (part, 0.0)] * n
        pose = np.array([*stop, np.arctan2(gap[1], gap[0])])
    driven = np.array(motions)
    return driven, dead_reckon([*stops[0], 0.0], driven)


def odometry_of(motions: Array, noise: MotionNoise = NOISE, seed: int = 0) -> Array:
    """What noisy odometry reports `(n, 2)` for motions truly made."""
    return sample_motions(motions, noise, np.random.default_rng(seed))


def tour_scans(laser: Laser, seed: int = 0, every: int = 1) -> tuple[Array, list[Scan]]:
    """Poses `(n, 3)` along the tour, every so many steps, and a noisy scan of the flat at each."""
    rng, world = np.random.default_rng(seed), World(grid=flat())
    poses = tour()[1][::every]
    return poses, [laser_scan(world, pose, laser, rng) for pose in poses]


def random_walks(start: Array, motions: Array, noise: MotionNoise, walks: int, seed: int = 0) -> Array:
    """Final poses `(walks, 3)` of robots that meant to make the motions and made noisy ones, all from `start`."""
    rng = np.random.default_rng(seed)
    poses = np.tile(np.asarray(start, dtype=float), (walks, 1))
    for motion in motions:
        poses = move(poses, sample_motions(np.broadcast_to(motion, (walks, 2)), noise, rng), 1.0)
    return poses


# --- the hall with beacons ---------------------------------------------------------------------


def lap(laps: int = 1, steps: int = 60) -> Array:
    """Motions `(n, 2)` round an oval of 6 m by 4 m about (5, 3.5) [m], from (5, 1.5) to the east."""
    straight, arc = np.array([0.2, 0.0]), np.array([np.pi * 2.0 / 20, np.pi / 20])
    one = np.vstack(
        [
            np.tile(straight, (5, 1)),
            np.tile(arc, (20, 1)),
            np.tile(straight, (10, 1)),
            np.tile(arc, (20, 1)),
            np.tile(straight, (5, 1)),
        ]
    )
    return np.tile(one[:steps], (laps, 1))


def ekf_run(
    sensor: LandmarkSensor,
    noise: MotionNoise = NOISE,
    trust: float = 1.0,
    laps: int = 1,
    seed: int = 0,
    beacons: Array = BEACONS,
) -> tuple[Array, Track, Array]:
    """True poses `(n, 3)`, the filter's track and its NEES `(n,)` for laps of the hall.

    `trust` is the factor by which the filter takes the sensor's standard deviations to be larger than they are.
    Beacons are seen at every second step.
    """
    rng = np.random.default_rng(seed)
    motions = lap(laps)
    truth = dead_reckon([5.0, 1.5, 0.0], motions)
    told = sample_motions(motions, noise, rng)
    believed = replace(sensor, sigma_range=sensor.sigma_range * trust, sigma_bearing=sensor.sigma_bearing * trust)
    belief = Belief(truth[0], np.diag([0.05, 0.05, 0.02]) ** 2)
    beliefs = [Belief(rng.multivariate_normal(belief.mean, belief.covariance), belief.covariance)]
    for k, motion in enumerate(told, start=1):
        belief = predict(beliefs[-1], motion, noise)
        if k % 2 == 0:
            ids, measured = see_landmarks(truth[k], beacons, sensor, rng)
            belief = correct(belief, ids, measured, beacons, believed).belief
        beliefs.append(belief)
    found = track(beliefs)
    return truth, found, nees(truth, found.means, found.covariances)


# --- the particle filter -----------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Chase:
    """A run of the particle filter: true poses `(n, 3)`, estimates `(n, 3)`, a swarm for each, errors `(n,)` [m]."""

    truth: Array
    estimates: Array
    swarms: tuple[Swarm, ...]
    errors: Array


@lru_cache(maxsize=1)
def _scene() -> tuple[GridMap, World, Laser]:
    grid = flat()
    return grid, World(grid=grid), Laser(beams=61, field_of_view=np.deg2rad(270.0), range_max=6.0, noise=0.02)


@lru_cache(maxsize=1)
def _field() -> LikelihoodField:
    return likelihood_field(_scene()[0], MonteCarlo())


@lru_cache(maxsize=32)
def chase(
    particles: int = 1000,
    lost: bool = True,
    kidnap: bool = False,
    recovery: bool = True,
    seed: int = 0,
) -> Chase:
    """Monte Carlo localization along the tour, with a scan at every second step.

    lost: the first swarm lies anywhere, else about the true pose. kidnap: after 40 scans the robot is carried to the
    lab and drives on there unaware. recovery: random particles are sent out when the match falls.
    """
    grid, world, laser = _scene()
    params = MonteCarlo() if recovery else MonteCarlo(slow=0.0, fast=0.0)
    rng = np.random.default_rng(seed)
    motions, truth = _kidnapped() if kidnap else tour()
    told = odometry_of(motions, seed=seed)
    swarm = (
        scatter(grid, particles, rng)
        if lost
        else spread(Belief(truth[0], np.diag([0.1, 0.1, 0.1]) ** 2), particles, rng)
    )
    estimates, swarms = [], []
    for k, pose in enumerate(truth):
        if k:
            swarm = drift(swarm, told[k - 1], NOISE, rng)
        if k % 2:
            continue
        swarm, belief = step(swarm, laser_scan(world, pose, laser, rng), _field(), params, rng)
        estimates.append(belief.mean)
        swarms.append(swarm)
    found = np.array(estimates)
    return Chase(truth[::2], found, tuple(swarms), np.hypot(*(found - truth[::2])[:, :2].T))


def _kidnapped() -> tuple[Array, Array]:
    """The tour up to step 80, then a drive that starts in the lab."""
    motions, poses = tour()
    rest, after = tour([(6.0, 5.6), (7.45, 5.6), (7.45, 3.6), (1.95, 3.6), (1.95, 5.0), (1.0, 5.0)])
    return np.vstack([motions[:80], rest]), np.vstack([poses[:80], after])


# --- a table in depth --------------------------------------------------------------------------


def table_scene() -> Array:
    """Boxes `(n, 6)`, low x, y, z and high x, y, z [m] in the robot's frame: a table with legs, a crate, the floor."""
    legs = [(x, y, 0.0, x + 0.06, y + 0.06, 0.7) for x in (1.6, 2.44) for y in (-0.6, 0.74)]
    return np.array(
        [
            *legs,
            (1.6, -0.6, 0.7, 2.5, 0.8, 0.75),
            (2.2, 1.0, 0.0, 2.7, 1.6, 0.5),
            (3.4, -2.5, 0.0, 3.5, 2.5, 2.0),
            (0.0, -3.0, -0.1, 4.5, 3.0, 0.0),
        ]
    )


def boxes_depth(boxes: Array, camera: Camera, mount: float) -> Array:
    """Ideal depth image `(height, width)` [m] of boxes `(n, 6)` in the robot's frame, from `mount` [m] above the floor.

    nan where a ray meets nothing.
    """
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    rays = np.stack([np.ones(u.shape), -(u - camera.cx) / camera.fx, -(v - camera.cy) / camera.fy], axis=-1)
    eye = np.array([0.0, 0.0, mount])
    with np.errstate(divide="ignore", invalid="ignore"):
        first = (boxes[:, None, None, :3] - eye) / rays
        second = (boxes[:, None, None, 3:] - eye) / rays
    enter = np.nanmax(np.minimum(first, second), axis=-1)
    leave = np.nanmin(np.maximum(first, second), axis=-1)
    depth = np.where((enter <= leave) & (enter > 0.0), enter, np.inf).min(axis=0)
    return np.where(np.isfinite(depth), depth, np.nan)
