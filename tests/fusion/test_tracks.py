"""The tracker of moving obstacles against known motion."""

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter

from fuzzynav.control import Observation
from fuzzynav.fusion import tracks
from fuzzynav.fusion.tracks import Tracker, Tracks
from fuzzynav.sensors import Laser, laser_scan
from fuzzynav.world import Mover, World, movers_start, movers_step

ROUND = Laser(beams=360, field_of_view=2.0 * np.pi, range_min=0.0, range_max=10.0, noise=0.01)
DT = 0.1


def seen(time: float, pose: np.ndarray, ranges: np.ndarray, angles: np.ndarray) -> Observation:
    """An observation with nothing but a scan."""
    none = np.zeros(2)
    return Observation(
        time=time, pose=pose, velocity=none, goal=none, points=np.zeros((0, 2)), ranges=ranges, angles=angles,
        range_max=10.0,
    )  # fmt: skip


def follow(world: World, poses: np.ndarray, laser: Laser = ROUND, seed: int = 0) -> tuple[list[Tracks], np.ndarray]:
    """What a tracker tells along the poses, and where the movers truly are."""
    rng, tracker = np.random.default_rng(seed), Tracker()
    state, told, truth = movers_start(world, 0), [], []
    for k, pose in enumerate(poses):
        scan = laser_scan(world, pose, laser, rng, state.positions)
        told.append(tracker.update(seen(k * DT, pose, scan.ranges, scan.angles)))
        truth.append(state.positions)
        state = movers_step(state, DT, pose, rng)
    return told, np.array(truth)


def test_a_filter_step_is_that_of_filterpy() -> None:
    rng = np.random.default_rng(3)
    mean, half = rng.normal(size=4), rng.normal(size=(4, 4))
    cov, q, dt = half @ half.T + np.eye(4), 0.3, 0.25
    other = KalmanFilter(dim_x=4, dim_z=2)
    other.x, other.P = mean.copy(), cov.copy()
    other.F = np.eye(4) + dt * np.eye(4, k=2)
    other.Q = q * np.kron([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]], np.eye(2))
    other.H, other.R = np.eye(2, 4), np.array([[0.2, 0.05], [0.05, 0.1]])
    for _ in range(5):
        z = rng.normal(size=2)
        mean, cov = tracks.kalman_step(mean, cov, z, dt, q, other.R)
        other.predict()
        other.update(z)
        np.testing.assert_allclose(mean, other.x, atol=1e-12)
        np.testing.assert_allclose(cov, other.P, atol=1e-12)


def test_a_constant_velocity_is_found() -> None:
    velocity = np.array([0.6, -0.4])
    told, truth = follow(World(movers=(Mover.constant((2.0, 3.0), velocity, 0.4),)), np.zeros((30, 3)))
    late = [t for t in told[8:]]
    assert all(len(t.ids) == 1 and t.ids[0] == told[8].ids[0] and t.moving[0] for t in late)
    error = np.array([np.hypot(*(t.velocities[0] - velocity)) for t in late])
    assert error.max() < 0.25 and np.median(error) < 0.1
    assert max(np.hypot(*(t.centers[0] - p[0])) for t, p in zip(late, truth[8:], strict=True)) < 0.03
    assert abs(late[-1].radii[0] - 0.4) < 0.03


def test_a_scan_is_needed() -> None:
    blind = Observation(time=0.0, pose=np.zeros(3), velocity=np.zeros(2), goal=np.zeros(2), points=np.zeros((0, 2)))
    with pytest.raises(ValueError, match="needs a scan"):
        Tracker().update(blind)
