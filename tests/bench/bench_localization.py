"""Monte Carlo localization: one cycle of 1000 particles with 30 beams, the kernel against plain NumPy."""

import time

import numpy as np

from fuzzynav import localization, sensors
from fuzzynav.localization import particles
from fuzzynav.maps.gridmap import GridMap


def plain_scores(poses: np.ndarray, scan: sensors.Scan, field: particles.LikelihoodField) -> np.ndarray:
    """The same sums by array operations alone, for poses and beams inside the map."""
    angles = poses[:, 2:] + scan.angles
    x = poses[:, :1] + scan.ranges * np.cos(angles)
    y = poses[:, 1:2] + scan.ranges * np.sin(angles)
    cells = np.floor((np.stack([x, y], axis=-1) - field.grid.origin) / field.resolution).astype(int)
    inside = np.all((cells >= 0) & (cells < field.log.shape[::-1]), axis=-1)
    cells = np.where(inside[..., None], cells, 0)
    return np.where(inside, field.log[cells[..., 1], cells[..., 0]], field.floor).sum(axis=1)


def median(call: object, repeat: int = 40) -> float:
    times = []
    for _ in range(repeat):
        begin = time.perf_counter()
        call()
        times.append(time.perf_counter() - begin)
    return float(np.median(times))


def rows() -> list[dict[str, object]]:
    """One row for the scores, one for a whole cycle."""
    rng = np.random.default_rng(0)
    walls = np.zeros((100, 200), dtype=bool)
    walls[[0, -1]] = walls[:, [0, -1]] = True
    walls[rng.integers(1, 99, 60), rng.integers(1, 199, 60)] = True
    grid, params, noise = GridMap(walls, 0.1), particles.MonteCarlo(), localization.MotionNoise()
    field = particles.likelihood_field(grid, params)
    laser = sensors.Laser(beams=30, field_of_view=2 * np.pi, range_max=30.0)
    scan, swarm = sensors.laser_scan(grid, [5.0, 4.0, 0.3], laser, rng), particles.scatter(grid, 1000, rng)
    ours, _ = particles.log_likelihoods(swarm.poses, scan, field, params)
    same = float(np.isclose(ours, plain_scores(swarm.poses, scan, field)).mean())
    fast = median(lambda: particles.log_likelihoods(swarm.poses, scan, field, params))
    slow = median(lambda: plain_scores(swarm.poses, scan, field))
    cycle = median(lambda: particles.step(particles.drift(swarm, [0.1, 0.1], noise, rng), scan, field, params, rng))
    return [
        {
            "task": "scores of 1000 particles, 30 beams",
            "unit": "ms",
            "ours": 1e3 * fast,
            "peer": 1e3 * slow,
            "peer_name": "NumPy",
            "ratio": slow / fast,
            "agreement": f"{100 * same:.1f} % of the scores equal to 1e-5",
        },
        {
            "task": "particle filter cycle, 1000 particles, 30 beams",
            "unit": "ms",
            "ours": 1e3 * cycle,
            "peer": None,
            "peer_name": None,
            "ratio": None,
            "agreement": "no peer installed",
        },
    ]
