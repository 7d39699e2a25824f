"""Speed of chapter 09: forces on a lattice, walks out of traps, a harmonic field."""

import time
from statistics import median

import numpy as np

from fuzzynav.maps.gridmap import GridMap
from fuzzynav.potential import IMPROVED, discs, force, walk
from fuzzynav.potential.harmonic import harmonic
from fuzzynav.potential.traps import RADIUS, trap
from fuzzynav.studies.potential.freeing import STEPS, escapes

GOAL = np.array([8.0, 8.0])
TRAPS = 100


def timed(action, repeats):
    """Median seconds of an action, after one that warms up."""
    action()
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        action()
        times.append(time.perf_counter() - begin)
    return median(times)


def row(task, unit, ours, peer=None, peer_name="no installed program does this", agreement=""):
    ratio = None if peer is None else peer / ours
    return {
        "task": task, "unit": unit, "ours": ours, "peer": peer, "peer_name": peer_name, "ratio": ratio,
        "agreement": agreement,
    }  # fmt: skip


def by_numpy(points, places):
    """The improved force of points by array operations."""
    to_goal = GOAL - points
    d = np.hypot(*np.moveaxis(to_goal, -1, 0))
    n, k, rho0, eta = IMPROVED.exponent, IMPROVED.repel, IMPROVED.influence, IMPROVED.attract
    scale = k * (d / (d + 1.0)) ** n
    slope = scale * n / (np.maximum(d, 1e-12) * (d + 1.0))
    away = points[:, :, None] - places
    rho = np.maximum(np.hypot(away[..., 0], away[..., 1]), 1e-9)
    a = np.where(rho < rho0, 1.0 / rho - 1.0 / rho0, 0.0)
    pushed = ((scale[..., None] * a / rho**3)[..., None] * away).sum(axis=2)
    more = (0.5 * (a**2).sum(axis=2) * slope / np.maximum(d, 1e-12))[..., None] * to_goal
    return eta * to_goal + pushed + more


def rows():
    """All rows of this benchmark."""
    rng = np.random.default_rng(0)
    places = rng.uniform(0.0, 8.0, (10, 2))
    points = np.stack(np.meshgrid(np.linspace(0.0, 8.0, 200), np.linspace(0.0, 8.0, 200)), axis=-1)
    obstacles = discs(places)
    ours = 1e3 * timed(lambda: force(points, GOAL, obstacles, IMPROVED), 50)
    peer = 1e3 * timed(lambda: by_numpy(points, places), 20)
    same = np.allclose(force(points, GOAL, obstacles, IMPROVED), by_numpy(points, places), rtol=1e-9)
    scenes, escape = [trap(10_000 + k) for k in range(TRAPS)], escapes()["ours"]

    def freed():
        for scene in scenes:
            walk(scene.start, scene.goal, scene.obstacles, IMPROVED, STEPS, escape=escape, radius=RADIUS)

    walks = 1000 / TRAPS * timed(freed, 3)
    grid = GridMap(rng.random((200, 200)) < 0.2)
    row_, column = np.argwhere(~grid.occupied)[-1]
    solved = timed(lambda: harmonic(grid, [column + 0.5, row_ + 0.5]), 5)
    return [
        row("forces on 200 x 200 points, ten obstacles", "ms", ours, peer, "NumPy", "equal to 1e-9" if same else "no"),
        row("a thousand traps, with the rules that free", "s", walks),
        row("a harmonic field of 200 x 200 cells", "s", solved, None, "SciPy's factorisation is what ours calls"),
    ]
