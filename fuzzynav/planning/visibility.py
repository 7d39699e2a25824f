"""The shortest path of all for a disc on a small map: straight tangents and arcs around the corners of obstacles.

A disc of radius r keeps its centre r away from every occupied square. The shortest such path is taut: it runs
straight from corner to corner and turns around each on an arc of radius r. Corners and the tangents between them
form a graph, and Dijkstra's search over its tangents finds the optimum that grid planners are compared with.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.maps.kernels import disc_passes
from fuzzynav.robot.kernels import wrap

__all__ = ["AnyAngle", "shortest"]

Long = NDArray[np.int64]

_MOST = 1500  # corners: the graph grows with their square
_THIN = 1e-7  # [cells] radius that stands for a point which may touch walls but not slip between two squares
_ARC = 0.15  # [rad] between the points of a drawn arc
_SLACK = 1e-7


@dataclass(frozen=True, slots=True, kw_only=True)
class AnyAngle:
    """The optimum: status "reached", "no_path", "start_blocked" or "goal_blocked"; points `(n, 2)` [m], length [m].

    Arcs are given as chords; `length` counts them as arcs. Unless reached, there are no points and the length is nan.
    """

    status: str
    points: Array
    length: float

    def __post_init__(self) -> None:
        """Make the points read-only."""
        self.points.setflags(write=False)


def shortest(
    grid: GridMap, start: ArrayLike, goal: ArrayLike, radius: float = 0.0, corners: str = "strict"
) -> AnyAngle:
    """Shortest path [m] of a disc of `radius` [m] from point to point `(2,)` [m].

    At radius 0, "strict" keeps a point from slipping between two squares that meet in a corner, "permissive" lets it.
    Raises ValueError for points that are not finite, a bad radius, an unknown rule, or a map of over 1500 corners.

    >>> wall = GridMap.from_ascii("...\\n.#.\\n...")
    >>> round(shortest(wall, [0.5, 0.5], [2.5, 2.5]).length, 4)      # around the corner (2, 1): twice hypot(1.5, 0.5)
    3.1623
    """
    if not (np.isfinite(radius) and radius >= 0.0):
        raise ValueError(f"radius must be metres, 0 or more, got {radius}")
    for name, point in (("start", start), ("goal", goal)):
        if not grid.clear_line(point, point, radius, "permissive"):
            return AnyAngle(status=f"{name}_blocked", points=np.empty((0, 2)), length=float("nan"))
    grid.move_allowed((0, 0), (0, 0), corners)  # refuses an unknown rule
    slip = radius == 0.0 and corners == "permissive"
    ends = (np.stack([start, goal]).astype(float) - grid.origin) / grid.resolution
    if (ends[0] == ends[1]).all():
        return AnyAngle(status="reached", points=np.stack([start, goal]).astype(float), length=0.0)
    r = 0.0 if slip else max(radius / grid.resolution, _THIN)
    nodes, cones = _corners(grid.occupied, slip)
    if len(nodes) > _MOST:
        raise ValueError(f"the map has {len(nodes)} corners, more than the {_MOST} that this exact method is meant for")
    nodes, cones = np.concatenate([ends, nodes]), np.concatenate([np.zeros((2, 2)), cones])
    tangents, numbers = _tangents(grid.occupied, nodes, cones, r)
    order = np.argsort(numbers[:, 0], kind="stable")
    tangents, numbers = tangents[order], numbers[order]
    first = np.searchsorted(numbers[:, 0], np.arange(2 * len(nodes) + 1))
    length, back = _walk(grid.occupied, nodes, cones, tangents, numbers, first, r)
    if not back:
        return AnyAngle(status="no_path", points=np.empty((0, 2)), length=float("nan"))
    points = _draw(nodes, tangents, numbers, back[::-1], r)
    return AnyAngle(status="reached", points=points * grid.resolution + grid.origin, length=length * grid.resolution)


def _corners(occupied: NDArray[np.bool_], slip: bool) -> tuple[Array, Array]:
    """Convex corners `(n, 2)` [cells] and the signs `(n, 2)` of the quadrant that points away from the obstacle.

    With `slip`, points where two squares meet are corners as well, with signs 0: every turn is allowed there.
    """
    full = np.pad(occupied, 1, constant_values=True)
    quads = np.stack([full[:-1, :-1], full[:-1, 1:], full[1:, :-1], full[1:, 1:]], axis=-1)  # SW, SE, NW, NE
    away = np.array([[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]])
    single = np.argwhere(quads.sum(axis=-1) == 1)
    signs = away[quads[single[:, 0], single[:, 1]].argmax(axis=-1)]
    points = single[:, ::-1].astype(float)
    if slip:
        pair = (quads == [1, 0, 0, 1]).all(axis=-1) | (quads == [0, 1, 1, 0]).all(axis=-1)
        meet = np.argwhere(pair)[:, ::-1].astype(float)
        points, signs = np.concatenate([points, meet]), np.concatenate([signs, np.zeros((len(meet), 2))])
    return points, signs


@njit(cache=True)
def _taut(cone: Array, side: float, heading: float) -> bool:
    """Whether a tangent touches the outer quarter of a corner's circle; side 1 has the circle on the left."""
    ux, uy = side * np.sin(heading), -side * np.cos(heading)
    return bool(ux * cone[0] >= -_SLACK and uy * cone[1] >= -_SLACK)


@njit(cache=True)
def _tangents(occupied: NDArray[np.bool_], nodes: Array, cones: Array, r: float) -> tuple[Array, Long]:
    """All free tangents: heading and length `(m, 2)`; from and to `(m, 2)` as 2 node + (circle to the right)."""
    n = nodes.shape[0]
    found = [(0.0, 0.0, 0, 0)]
    found.pop()
    for a in range(n):
        for b in range(n):
            if a == b or a == 1 or b == 0:
                continue
            dx, dy = nodes[b, 0] - nodes[a, 0], nodes[b, 1] - nodes[a, 1]
            gap = np.hypot(dx, dy)
            if gap == 0.0:
                continue
            way = np.arctan2(dy, dx)
            ra, rb = (r if a > 1 else 0.0), (r if b > 1 else 0.0)
            for ka in range(2 if a > 1 else 1):
                for kb in range(2 if b > 1 else 1):
                    sa, sb = 1.0 - 2.0 * ka, 1.0 - 2.0 * kb
                    lean = (sb * rb - sa * ra) / gap
                    if abs(lean) > 1.0:
                        continue
                    turn = np.arcsin(lean)
                    heading = way - turn
                    if (a > 1 and not _taut(cones[a], sa, heading)) or (b > 1 and not _taut(cones[b], sb, heading)):
                        continue
                    nx, ny = -np.sin(heading), np.cos(heading)
                    ax, ay = nodes[a, 0] - sa * ra * nx, nodes[a, 1] - sa * ra * ny
                    bx, by = nodes[b, 0] - sb * rb * nx, nodes[b, 1] - sb * rb * ny
                    if disc_passes(occupied, ax, ay, bx, by, r, False):
                        found.append((heading, gap * np.cos(turn), 2 * a + ka, 2 * b + kb))
    shape = np.empty((len(found), 2))
    numbers = np.empty((len(found), 2), dtype=np.int64)
    for k in range(len(found)):
        shape[k, 0], shape[k, 1], numbers[k, 0], numbers[k, 1] = found[k]
    return shape, numbers


@njit(cache=True)
def _arc(occupied: NDArray[np.bool_], x: float, y: float, side: float, heading: float, turn: float, r: float) -> bool:
    """Whether the arc around (x, y) from one heading on is free, at points a tenth of a quarter apart."""
    steps = int(np.ceil(turn / (np.pi / 20.0)))
    for k in range(1, steps):
        at = heading + side * turn * k / steps
        px, py = x + side * r * np.sin(at), y - side * r * np.cos(at)
        if not disc_passes(occupied, px, py, px, py, r, False):
            return False
    return True


@njit(cache=True)
def _walk(
    occupied: NDArray[np.bool_], nodes: Array, cones: Array, tangents: Array, numbers: Long, first: Long, r: float
) -> tuple[float, list[int]]:
    """Length [cells] and the tangents, last first, of the shortest way from node 0 to node 1."""
    m = tangents.shape[0]
    best = np.full(m, np.inf)
    before = np.full(m, -1)
    done = np.zeros(m, dtype=np.bool_)
    heap = [(0.0, 0)]
    heap.pop()
    for e in range(first[0], first[1]):
        best[e] = tangents[e, 1]
        heapq.heappush(heap, (best[e], e))
    back = [0]
    back.pop()
    while len(heap) > 0:
        length, e = heapq.heappop(heap)
        if done[e]:
            continue
        done[e] = True
        state = numbers[e, 1]
        node, side = state // 2, 1.0 - 2.0 * (state % 2)
        if node == 1:
            while e >= 0:
                back.append(e)
                e = before[e]
            return length, back
        for f in range(first[state], first[state + 1]):
            if done[f]:
                continue
            turn = wrap(side * (tangents[f, 0] - tangents[e, 0]))
            if turn < -_SLACK and (cones[node, 0] != 0.0 or r > 0.0):
                continue
            via = length + r * max(turn, 0.0) + tangents[f, 1]
            if via < best[f] and _arc(occupied, nodes[node, 0], nodes[node, 1], side, tangents[e, 0], turn, r):
                best[f], before[f] = via, e
                heapq.heappush(heap, (via, f))
    return np.inf, back


def _draw(nodes: Array, tangents: Array, numbers: Long, path: list[int], r: float) -> Array:
    """Points [cells] of the tangents in `path`, with arcs between them."""
    points = [nodes[0]]
    for e, f in pairwise(path):
        state = numbers[e, 1]
        node, side = nodes[state // 2], 1.0 - 2.0 * (state % 2)
        turn = wrap(side * (tangents[f, 0] - tangents[e, 0]))
        count = int(np.ceil(max(turn, 0.0) / _ARC)) + 1 if r > 10.0 * _THIN else 1
        at = tangents[e, 0] + side * np.linspace(0.0, max(turn, 0.0), count)
        points.extend(node + side * r * np.stack([np.sin(at), -np.cos(at)], axis=-1))
    return np.array([*points, nodes[1]])


def _warm() -> None:
    """Compile the kernels."""
    shortest(GridMap.from_ascii("...\n.#.\n..."), [0.5, 0.5], [2.5, 2.5])
