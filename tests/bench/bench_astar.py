"""Speed of grid search: milliseconds a query on seeded maps of 512 x 512 and 1024 x 1024, beside planners for Python.

Each peer is compared under its own corner rule; loading the map is not counted for either side. Times are CPU seconds,
the least of three passes over the same queries. Slow peers get the first queries only, and one pass; ours is timed on
the same queries.
"""

import importlib.util
import time
from dataclasses import replace

import numpy as np
from scipy.ndimage import label
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar, heuristics

QUERIES = 12
PERMISSIVE = replace(astar.OPTIMAL, corners="permissive", ties="lifo")


def rooms(rng, size, room=32):
    """Square rooms with one door in each wall."""
    occupied = np.zeros((size, size), dtype=bool)
    occupied[::room] = occupied[:, ::room] = True
    for y in range(0, size, room):
        for x in range(0, size, room):
            a, b = rng.integers(2, room - 2, 2)
            occupied[y, x + a : x + a + 2] = occupied[y + b : y + b + 2, x] = False
    return occupied


def blocks(rng, size):
    """Rectangular houses of 4 to 40 cells, a third of the ground."""
    occupied = np.zeros((size, size), dtype=bool)
    while occupied.mean() < 0.33:
        (x, y), (w, h) = rng.integers(0, size, 2), rng.integers(4, 40, 2)
        occupied[y : y + h, x : x + w] = True
    return occupied


def scattered(rng, size):
    """A fifth of the cells occupied, independently."""
    return rng.random((size, size)) < 0.2


def maze(rng, size, width=7):
    """Corridors of a perfect maze, `width` cells wide, with walls of one cell."""
    n = size // (width + 1)
    occupied = np.ones((size, size), dtype=bool)
    seen, stack = {(0, 0)}, [(0, 0)]
    occupied[:width, :width] = False
    while stack:
        x, y = stack[-1]
        ways = [
            (dx, dy)
            for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1))
            if 0 <= x + dx < n and 0 <= y + dy < n and (x + dx, y + dy) not in seen
        ]
        if not ways:
            stack.pop()
            continue
        dx, dy = ways[rng.integers(len(ways))]
        (x0, x1), (y0, y1) = sorted((x, x + dx)), sorted((y, y + dy))
        p = width + 1
        occupied[y0 * p : y1 * p + width, x0 * p : x1 * p + width] = False
        seen.add((x + dx, y + dy))
        stack.append((x + dx, y + dy))
    return occupied


def queries(rng, occupied):
    """Pairs of cells x, y in the largest region, at least half the map apart."""
    regions, _ = label(~occupied)
    y, x = np.nonzero(regions == np.bincount(regions[regions > 0]).argmax())
    pairs = []
    while len(pairs) < QUERIES:
        a, b = rng.integers(0, len(x), 2)
        if np.hypot(x[a] - x[b], y[a] - y[b]) > 0.5 * len(occupied):
            pairs.append(((int(x[a]), int(y[a])), (int(x[b]), int(y[b]))))
    return pairs


def seconds(solve, pairs, passes=3):
    """Least CPU seconds of one pass, and the answers."""
    spent = []
    for _ in range(passes):
        began = time.process_time()
        answers = [solve(*pair) for pair in pairs]
        spent.append(time.process_time() - began)
    return min(spent), answers


def w9(occupied):
    from w9_pathfinding.diagonal_movement import DiagonalMovement
    from w9_pathfinding.envs import Grid
    from w9_pathfinding.pf import AStar

    environment = Grid(
        np.where(occupied, -1.0, 1.0).tolist(),
        diagonal_movement_cost_multiplier=2**0.5,
        diagonal_movement=DiagonalMovement.only_when_no_obstacle,
    )
    return AStar(environment).find_path


def tcod(occupied):
    from tcod.path import AStar

    planner = AStar((~occupied).astype(np.int8), diagonal=2**0.5)
    return lambda a, b: [(x, y) for y, x in [(a[1], a[0]), *planner.get_path(a[1], a[0], b[1], b[0])]]


def pyastar2d(occupied):
    import pyastar2d as module

    weights = np.where(occupied, np.inf, 1.0).astype(np.float32)
    return lambda a, b: module.astar_path(weights, a[::-1], b[::-1], allow_diagonal=True)[:, ::-1]


def scikit_image(occupied):
    from skimage.graph import MCP_Geometric

    costs = np.where(occupied, -1.0, 1.0)

    def solve(a, b):
        planner = MCP_Geometric(costs)
        planner.find_costs([a[::-1]], [b[::-1]])
        return np.array(planner.traceback(b[::-1]))[:, ::-1]

    return solve


def scipy_dijkstra(occupied):
    rows, cols = occupied.shape
    free = np.pad(~occupied, 1)
    number = np.arange(rows * cols).reshape(rows, cols)
    parts = []
    for dx, dy in heuristics.STEPS.tolist():
        there = free[1 + dy : rows + 1 + dy, 1 + dx : cols + 1 + dx] & ~occupied
        if dx and dy:
            there &= free[1 + dy : rows + 1 + dy, 1:-1] & free[1:-1, 1 + dx : cols + 1 + dx]
        parts.append((number[there], number[there] + dy * cols + dx, np.full(there.sum(), np.hypot(dx, dy))))
    a, b, w = (np.concatenate(p) for p in zip(*parts))
    graph = csr_matrix((w, (a, b)), shape=(rows * cols, rows * cols))
    return lambda start, goal: float(dijkstra(graph, indices=start[1] * cols + start[0])[goal[1] * cols + goal[0]])


def pathfinding(occupied):
    from pathfinding.core.diagonal_movement import DiagonalMovement
    from pathfinding.core.grid import Grid
    from pathfinding.finder.a_star import AStarFinder

    matrix = (~occupied).astype(int).tolist()

    def solve(a, b):
        grid = Grid(matrix=matrix)
        finder = AStarFinder(diagonal_movement=DiagonalMovement.only_when_no_obstacle)
        path, _ = finder.find_path(grid.node(*a), grid.node(*b), grid)
        return [(node.x, node.y) for node in path]

    return solve


# name, module, how to make its solver, its corner rule, how many of the queries it gets
PEERS = (
    ("w9-pathfinding 0.1 (C++)", "w9_pathfinding", w9, astar.QUICK, QUERIES),
    ("tcod 21 (C)", "tcod", tcod, PERMISSIVE, QUERIES),
    ("pyastar2d 1.1 (C++)", "pyastar2d", pyastar2d, PERMISSIVE, QUERIES),
    ("SciPy dijkstra (C++)", "scipy", scipy_dijkstra, astar.QUICK, 3),
    ("scikit-image MCP (Cython)", "skimage", scikit_image, PERMISSIVE, 3),
    ("pathfinding 1.0 (Python)", "pathfinding", pathfinding, astar.QUICK, 1),
)


def agreement(ours, theirs):
    """How the lengths of both sides compare."""
    other = [t if isinstance(t, float) else astar.path_length(np.asarray(t)) for t in theirs]
    excess = np.array([t / r.length - 1.0 for t, r in zip(other, ours)])
    if np.abs(excess).max() < 1e-5:
        return f"same length in all {len(excess)} queries"
    if excess.min() < -1e-5:
        return f"theirs is up to {-100 * excess.min():.1f} % shorter"
    return f"theirs is up to {100 * excess.max():.1f} % longer: not exact"


def ours(grid, options):
    """Our solver for a map under these choices."""
    return lambda a, b: astar.search(grid, a, b, options)


def against(task, grid, pairs, peer):
    """The row of one map and one peer."""
    name, module, side, options, count = peer
    spent, found = seconds(ours(grid, options), pairs[:count])
    row = {
        "task": task,
        "unit": "ms",
        "ours": 1e3 * spent / count,
        "peer": None,
        "peer_name": name,
        "ratio": None,
        "agreement": "not installed",
    }
    if importlib.util.find_spec(module) is None:
        return row
    theirs, answers = seconds(side(grid.occupied), pairs[:count], 1 if count < QUERIES else 3)
    return {**row, "peer": 1e3 * theirs / count, "ratio": theirs / spent, "agreement": agreement(found, answers)}


def rows():
    """One row for each map and peer, and one with our time for each cell expanded."""
    table = []
    for size in (512, 1024):
        for make in (rooms, blocks, scattered, maze):
            rng = np.random.default_rng([size, len(make.__name__)])
            occupied = make(rng, size)
            grid, pairs = GridMap(occupied), queries(rng, occupied)
            name = f"{make.__name__}, {size} x {size}"
            table += [against(f"path on {name}", grid, pairs, peer) for peer in PEERS]
            spent, found = seconds(ours(grid, astar.QUICK), pairs)
            table.append(
                {
                    "task": f"one cell expanded on {name}",
                    "unit": "ns",
                    "ours": 1e9 * spent / sum(r.searched for r in found),
                    "peer": None,
                    "peer_name": "none",
                    "ratio": None,
                    "agreement": "-",
                }
            )
    return table
