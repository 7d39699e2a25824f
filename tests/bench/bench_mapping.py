"""Occupancy mapping of the whole Killian log, and one scan of 360 beams on a map of a million cells."""

import time
from collections.abc import Callable

import numpy as np
from bresenham import bresenham

from fuzzynav import mapping
from fuzzynav.mapping import logs, posegraph
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.world import World

RESOLUTION = 0.1
SENSOR = mapping.InverseSensor()


def best(call: Callable[[], object], repeat: int) -> float:
    """The shortest of several runs [s]: on a busy machine the others measure its neighbours."""
    times = []
    for _ in range(repeat):
        begin = time.perf_counter()
        call()
        times.append(time.perf_counter() - begin)
    return min(times)


def numpy_map(blank: mapping.OccupancyGrid, poses: np.ndarray, ranges: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """The same sensor model by array operations, beams sampled twice in each cell."""
    odds = blank.log_odds.copy()
    hit, miss, low, high = mapping.log_odds([SENSOR.hit, SENSOR.miss, SENSOR.low, SENSOR.high])
    for pose, scan in zip(poses, ranges, strict=True):
        good = ~np.isnan(scan)
        reach, heading = np.minimum(scan[good], SENSOR.reach), pose[2] + angles[good]
        way = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
        ends = np.floor((pose[:2] + reach[:, None] * way - blank.origin) / RESOLUTION).astype(int)
        steps = np.arange(0.0, reach.max(), RESOLUTION / 2)
        along = pose[:2] + steps[:, None, None] * way
        cells = np.floor((along - blank.origin) / RESOLUTION).astype(int)
        crossed = np.unique(cells[steps[:, None] < reach] @ [1, odds.shape[1]])
        stop = np.unique(ends[scan[good] <= SENSOR.reach] @ [1, odds.shape[1]])
        crossed = np.setdiff1d(crossed, stop, assume_unique=True)
        odds.flat[crossed] = np.maximum(odds.flat[crossed] + miss, low)
        odds.flat[stop] = np.minimum(odds.flat[stop] + hit, high)
    return odds


def bresenham_map(
    blank: mapping.OccupancyGrid, poses: np.ndarray, ranges: np.ndarray, angles: np.ndarray
) -> np.ndarray:
    """The same sensor model with the lines of the package bresenham, which skip cells that are cut at a corner."""
    odds = blank.log_odds.copy()
    hit, miss, low, high = mapping.log_odds([SENSOR.hit, SENSOR.miss, SENSOR.low, SENSOR.high])
    for pose, scan in zip(poses, ranges, strict=True):
        start = np.floor((pose[:2] - blank.origin) / RESOLUTION).astype(int).tolist()
        crossed, stop = set(), set()
        for r, a in zip(scan, pose[2] + angles, strict=True):
            if not np.isnan(r):
                tip = pose[:2] + min(r, SENSOR.reach) * np.array([np.cos(a), np.sin(a)])
                *way, last = bresenham(*start, *np.floor((tip - blank.origin) / RESOLUTION).astype(int).tolist())
                crossed.update(way)
                if r <= SENSOR.reach:
                    stop.add(last)
        for i, j in crossed - stop:
            odds[j, i] = max(odds[j, i] + miss, low)
        for i, j in stop:
            odds[j, i] = min(odds[j, i] + hit, high)
    return odds


def agreement(ours: np.ndarray, other: np.ndarray) -> str:
    """How many of the cells that either side has seen have the same verdict."""
    seen = (ours != 0) | (other != 0)
    p, q = mapping.probability(ours[seen]), mapping.probability(other[seen])
    same = (np.digitize(p, [0.196, 0.65]) == np.digitize(q, [0.196, 0.65])).mean()
    return f"{100 * same:.1f} % of the seen cells with the same verdict"


def map_rows() -> list[dict[str, object]]:
    log = logs.killian()
    poses = posegraph.solve(log).poses
    whole = (poses, log.ranges, log.angles)
    blank = mapping.build(*whole, resolution=RESOLUTION)
    blank = mapping.OccupancyGrid(np.zeros_like(blank.log_odds), RESOLUTION, blank.origin)
    ours = len(poses) / best(lambda: mapping.update(blank, *whole, SENSOR), 5)
    out = []
    for name, peer, every in (("NumPy", numpy_map, 8), ("bresenham 0.2.1", bresenham_map, 40)):
        part = (poses[::every], log.ranges[::every], log.angles)
        theirs = len(part[0]) / best(lambda peer=peer, part=part: peer(blank, *part), 1)
        note = agreement(mapping.update(blank, *part, SENSOR).log_odds, peer(blank, *part))
        out.append(
            {
                "task": "occupancy map of the Killian log, 3873 scans of 180 beams, 0.1 m",
                "unit": "scans/s",
                "ours": ours,
                "peer": theirs,
                "peer_name": f"{name} (every {every}th scan)",
                "ratio": ours / theirs,
                "agreement": note,
            }
        )
    return out


def numpy_cast(grid: GridMap, pose: np.ndarray, angles: np.ndarray, range_max: float) -> np.ndarray:
    """The cell walk of all beams at once, one array step for each cell."""
    x, y = (np.asarray(pose[:2]) - grid.origin) / grid.resolution
    dx, dy = np.cos(pose[2] + angles), np.sin(pose[2] + angles)
    i, j = np.full(len(angles), int(x)), np.full(len(angles), int(y))
    out, going = np.full(len(angles), range_max), np.arange(len(angles))
    while len(going):
        tx = (i[going] + (dx[going] > 0) - x) / dx[going]
        ty = (j[going] + (dy[going] > 0) - y) / dy[going]
        across, t = tx < ty, np.minimum(tx, ty) * grid.resolution
        i[going] += np.where(across, np.sign(dx[going]), 0).astype(int)
        j[going] += np.where(across, 0, np.sign(dy[going])).astype(int)
        inside = (i[going] >= 0) & (j[going] >= 0) & (i[going] < grid.shape[1]) & (j[going] < grid.shape[0])
        hit = ~inside | grid.occupied[np.where(inside, j[going], 0), np.where(inside, i[going], 0)]
        out[going[hit]] = np.minimum(t[hit], range_max)
        going = going[~hit & (t < range_max)]
    return out


def cast_rows() -> list[dict[str, object]]:
    rng = np.random.default_rng(0)
    pose, angles = np.array([50.03, 50.02, 0.1]), np.linspace(-np.pi, np.pi, 360, endpoint=False)
    out = []
    for name, share in (("sparse", 0.0005), ("cluttered", 0.01)):
        grid = GridMap(rng.random((1000, 1000)) < share, 0.1)
        grid.distance_field()
        ours = best(lambda grid=grid: grid.cast(pose, angles, 100.0), 50)
        theirs = best(lambda grid=grid: numpy_cast(grid, pose, angles, 100.0), 5)
        gap = np.abs(grid.cast(pose, angles, 100.0) - numpy_cast(grid, pose, angles, 100.0)).max()
        out.append(
            {
                "task": f"scan of 360 beams, 1000 x 1000 cells, {name}",
                "unit": "us",
                "ours": 1e6 * ours,
                "peer": 1e6 * theirs,
                "peer_name": "NumPy",
                "ratio": theirs / ours,
                "agreement": f"ranges within {max(gap, 1e-12):.0e} m",
            }
        )
    return out


def world_rows() -> list[dict[str, object]]:
    """What every step of a simulation asks: a scan of the whole world, and the clearance of the robot."""
    rng = np.random.default_rng(1)
    discs = np.column_stack([rng.uniform(0, 20, (20, 2)), rng.uniform(0.1, 0.4, 20)])
    boxes = np.column_stack([rng.uniform(0, 20, (20, 2)), rng.uniform(0.2, 0.8, (20, 2)), rng.uniform(-3, 3, 20)])
    world = World(grid=GridMap(rng.random((400, 400)) < 0.002, 0.05), discs=discs, rectangles=boxes)
    pose = next(p for p in np.column_stack([rng.uniform(1, 19, (50, 2)), np.zeros(50)]) if world.clearance(p[:2]) > 0.3)
    angles = np.linspace(-np.pi, np.pi, 720, endpoint=False)
    none = {"unit": "us", "peer": None, "peer_name": None, "ratio": None, "agreement": "no peer installed"}
    return [
        {
            "task": "scan of 720 beams, 20 m world of 400 x 400 cells and 40 shapes",
            "ours": 1e6 * best(lambda: world.cast(pose, angles, 10.0), 200),
            **none,
        },
        {
            "task": "clearance of one point in the same world",
            "ours": 1e6 * best(lambda: world.clearance(pose[:2]), 200),
            **none,
        },
    ]


def rows() -> list[dict[str, object]]:
    """Mapping against two peers, ray casting on two maps, and the world of the simulations."""
    return map_rows() + cast_rows() + world_rows()
