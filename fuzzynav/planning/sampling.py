"""Planners that sample: a random tree, a probabilistic roadmap and a particle swarm, compact enough to read.

They stand here for comparison with the grid planners of `astar` on the same maps. All take points in metres and a
random generator, and keep a disc of `radius` [m] free along straight legs.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from fuzzynav.geometry import Array, length
from fuzzynav.maps.gridmap import GridMap

__all__ = ["PRM", "RRT", "Sampled", "Swarm", "prm", "rrt", "swarm"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Sampled:
    """What a sampling planner found.

    status: "reached", "no_path", "start_blocked" or "goal_blocked"; points `(n, 2)` [m], empty unless reached, with
    their length [m], nan unless reached. evidence: segments `(m, 2, 2)` [m] of the tree or roadmap; for the swarm
    the best path of each iteration. checks: how many straight legs were tested against the map.
    """

    status: str
    points: Array
    length: float
    evidence: tuple[Array, ...] | Array
    checks: int

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        for array in (self.points, *(self.evidence if isinstance(self.evidence, tuple) else (self.evidence,))):
            array.setflags(write=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class RRT:
    """Random tree: step [m], share of samples put on the goal, most samples, radius [m]."""

    step: float = 1.5
    goal_bias: float = 0.1
    samples: int = 4000
    radius: float = 0.0

    def __post_init__(self) -> None:
        _positive(step=self.step, samples=self.samples)
        _shares(goal_bias=self.goal_bias)
        _radius(self.radius)


@dataclass(frozen=True, slots=True, kw_only=True)
class PRM:
    """Roadmap: number of free samples, neighbours that each is linked with, radius [m]."""

    samples: int = 250
    neighbours: int = 10
    radius: float = 0.0

    def __post_init__(self) -> None:
        _positive(samples=self.samples, neighbours=self.neighbours)
        _radius(self.radius)


@dataclass(frozen=True, slots=True, kw_only=True)
class Swarm:
    """Particle swarm: each particle is a polyline with `nodes` inner nodes.

    inertia, own and common are the weights of a particle's last move, of its own best and of the swarm's best place.
    penalty counts each metre that overlaps an obstacle.
    """

    particles: int = 60
    iterations: int = 150
    nodes: int = 5
    inertia: float = 0.72
    own: float = 1.5
    common: float = 1.5
    penalty: float = 30.0
    radius: float = 0.0

    def __post_init__(self) -> None:
        _positive(
            particles=self.particles,
            iterations=self.iterations,
            nodes=self.nodes,
            penalty=self.penalty,
            own=self.own,
            common=self.common,
        )
        _shares(inertia=self.inertia)
        _radius(self.radius)


def _positive(**values: float) -> None:
    for name, value in values.items():
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be positive, got {value}")


def _shares(**values: float) -> None:
    for name, value in values.items():
        if not 0.0 <= value <= 1.0:
            raise ValueError(f"{name} must lie in 0 to 1, got {value}")


def _radius(value: float) -> None:
    if not (np.isfinite(value) and value >= 0.0):
        raise ValueError(f"radius must be metres, 0 or more, got {value}")


@dataclass(slots=True)
class _Sight:
    """The free-leg test of one run, with its count."""

    grid: GridMap
    radius: float
    count: int = field(default=0)

    def __call__(self, a: ArrayLike, b: ArrayLike) -> bool:
        self.count += 1
        return self.grid.clear_line(a, b, self.radius, "permissive")

    def ends(self, start: ArrayLike, goal: ArrayLike) -> tuple[Array, Array, str]:
        a, b = np.asarray(start, dtype=float), np.asarray(goal, dtype=float)
        for name, point in (("start", a), ("goal", b)):
            if point.shape != (2,) or not np.isfinite(point).all():
                raise ValueError(f"{name} must be two finite numbers of metres, got {point.tolist()}")
        blocked = [n for n, p in (("start", a), ("goal", b)) if not self(p, p)]
        return a, b, f"{blocked[0]}_blocked" if blocked else ""

    def result(self, status: str, points: ArrayLike, evidence: tuple[Array, ...] | Array) -> Sampled:
        p = np.asarray(points, dtype=float).reshape(-1, 2)
        return Sampled(
            status=status, points=p, length=length(p) if len(p) else float("nan"), evidence=evidence, checks=self.count
        )


_NO_LEGS = np.empty((0, 2, 2))


def _anywhere(grid: GridMap, rng: np.random.Generator, count: int) -> Array:
    xmin, xmax, ymin, ymax = grid.extent
    return rng.uniform([xmin, ymin], [xmax, ymax], (count, 2))


def rrt(grid: GridMap, start: ArrayLike, goal: ArrayLike, rng: np.random.Generator, options: RRT = RRT()) -> Sampled:
    """Path by a rapidly-exploring random tree: grow the nearest node towards a random point, until the goal is met."""
    sight = _Sight(grid, options.radius)
    a, b, blocked = sight.ends(start, goal)
    if blocked:
        return sight.result(blocked, [], _NO_LEGS)
    nodes, parent, count = np.empty((options.samples + 2, 2)), [-1], 1
    nodes[0] = a
    for _ in range(options.samples):
        target = b if rng.random() < options.goal_bias else _anywhere(grid, rng, 1)[0]
        gaps = np.hypot(*(nodes[:count] - target).T)
        near = int(gaps.argmin())
        new = nodes[near] + (target - nodes[near]) * min(1.0, options.step / max(gaps[near], 1e-12))
        if not sight(nodes[near], new):
            continue
        nodes[count] = new
        parent.append(near)
        count += 1
        if np.hypot(*(new - b)) <= options.step and sight(new, b):
            nodes[count] = b
            parent.append(count - 1)
            tree = _legs(nodes, parent)
            way = [count]
            while way[-1] > 0:
                way.append(parent[way[-1]])
            return sight.result("reached", nodes[way[::-1]], tree)
    return sight.result("no_path", [], _legs(nodes, parent))


def _legs(nodes: Array, parent: list[int]) -> Array:
    return np.stack([nodes[parent[1:]], nodes[1 : len(parent)]], axis=1) if len(parent) > 1 else _NO_LEGS


def prm(grid: GridMap, start: ArrayLike, goal: ArrayLike, rng: np.random.Generator, options: PRM = PRM()) -> Sampled:
    """Shortest path on a probabilistic roadmap: free samples, each linked with its nearest ones in sight."""
    sight = _Sight(grid, options.radius)
    a, b, blocked = sight.ends(start, goal)
    if blocked:
        return sight.result(blocked, [], _NO_LEGS)
    drawn = _anywhere(grid, rng, 20 * options.samples)
    free = drawn[grid.distance(drawn) >= options.radius + 1e-9][: options.samples]
    points = np.concatenate([[a, b], free])
    links = _links(points, options.neighbours, sight)
    gaps = np.hypot(*(points[links[:, 0]] - points[links[:, 1]]).T)
    graph = csr_matrix((gaps, (links[:, 0], links[:, 1])), shape=(len(points), len(points)))
    cost, before = dijkstra(graph, directed=False, indices=0, return_predecessors=True)
    legs = points[links]
    if not np.isfinite(cost[1]):
        return sight.result("no_path", [], legs)
    way = [1]
    while way[-1] != 0:
        way.append(int(before[way[-1]]))
    return sight.result("reached", points[way[::-1]], legs)


def _links(points: Array, neighbours: int, sight: _Sight) -> NDArray[np.int64]:
    """Pairs `(m, 2)` of near points in sight of each other, each once."""
    _, near = cKDTree(points).query(points, k=min(neighbours + 1, len(points)))
    pairs = {(min(i, int(j)), max(i, int(j))) for i, row in enumerate(near) for j in row if int(j) != i}
    seen = [pair for pair in sorted(pairs) if sight(points[pair[0]], points[pair[1]])]
    return np.array(seen, dtype=np.int64).reshape(-1, 2)


def swarm(
    grid: GridMap, start: ArrayLike, goal: ArrayLike, rng: np.random.Generator, options: Swarm = Swarm()
) -> Sampled:
    """Path by particle swarm optimisation of a polyline: length plus a penalty for every metre in an obstacle.

    The best particle is tested leg by leg at the end; if it is not free, the status is "no_path".
    """
    sight = _Sight(grid, options.radius)
    a, b, blocked = sight.ends(start, goal)
    if blocked:
        return sight.result(blocked, [], ())
    xmin, xmax, ymin, ymax = grid.extent
    low, high = np.array([xmin, ymin]), np.array([xmax, ymax])
    line = a + (b - a) * np.linspace(0.0, 1.0, options.nodes + 2)[1:-1, None]
    place = np.clip(line + rng.normal(0.0, 0.2, (options.particles, options.nodes, 2)) * (high - low), low, high)
    place[0] = line
    move = np.zeros_like(place)
    own, own_cost = place.copy(), _costs(grid, a, b, place, options)
    history = []
    for _ in range(options.iterations):
        best = own[own_cost.argmin()]
        history.append(np.concatenate([[a], best, [b]]))
        pull, push = rng.random((2, *place.shape))
        move = options.inertia * move + options.own * pull * (own - place) + options.common * push * (best - place)
        place = np.clip(place + move, low, high)
        cost = _costs(grid, a, b, place, options)
        better = cost < own_cost
        own[better], own_cost[better] = place[better], cost[better]
    found = np.concatenate([[a], own[own_cost.argmin()], [b]])
    free = all(sight(p, q) for p, q in zip(found[:-1], found[1:], strict=True))  # noqa: RUF007
    return sight.result("reached" if free else "no_path", found if free else [], (*history, found))


def _costs(grid: GridMap, a: Array, b: Array, place: Array, options: Swarm) -> Array:
    """Length [m] plus penalty of every particle `(p, nodes, 2)`."""
    ends = np.broadcast_to([a, b], (len(place), 2, 2))
    whole = np.concatenate([ends[:, :1], place, ends[:, 1:]], axis=1)
    legs = np.hypot(*np.moveaxis(np.diff(whole, axis=1), -1, 0))
    u = (np.arange(20) + 0.5) / 20
    samples = whole[:, :-1, None] + u[:, None] * np.diff(whole, axis=1)[:, :, None]
    inside = grid.distance(samples) < options.radius + 0.05 * grid.resolution
    costs: Array = legs.sum(axis=1) + options.penalty * (inside.mean(axis=-1) * legs).sum(axis=1)
    return costs
