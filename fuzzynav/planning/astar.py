"""Grid planners: one search, its choices as parameters, presets for the planners of the thesis.

From a shell, `python -m fuzzynav.planning.astar MAP SCEN` solves every problem of a MovingAI scenario file.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.maps.gridmap import GridMap
from fuzzynav.maps.movingai import Scenario, read_scenarios
from fuzzynav.planning import kernels

__all__ = [
    "DIJKSTRA",
    "EFFICIENT",
    "ENHANCED",
    "OPTIMAL",
    "QUICK",
    "TRADITIONAL",
    "Options",
    "SearchResult",
    "agrees",
    "path_length",
    "search",
    "search_through",
    "solve",
    "valid_path",
]

Cells = NDArray[np.int64]

_HEURISTICS = ("zero", "euclidean", "manhattan", "octile", "chebyshev", "enhanced")
_TIES = ("fifo", "lifo", "low h")


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """The choices of a search. Raises ValueError for a value that is not offered.

    heuristic: "zero", "euclidean", "manhattan", "octile", "chebyshev" or "enhanced" (thesis eq 4.4, with the
    logarithm to `log_base`), times `weight`, times e^P where `weight_by_distance`. cost: "accumulated", or
    "straight line" for G as the thesis prints it. neighbours: 4 or 8. corners: "strict" forbids a diagonal step
    past an occupied cell. five_directions: leave out three directions by Table 3.1; where that finds no path and
    `fallback`, search again with all. ties: cells of equal f (to 1e-9) leave in the order they came ("fifo"), the
    last first ("lifo"), or the nearest to the goal first ("low h"). reopen: expand a closed cell again when a
    shorter way to it appears. pruned: leave out neighbours that the parent reaches as cheaply without this cell;
    needs strict corners, eight neighbours and a consistent heuristic. safety_radius [m]: distance that the centre
    of every cell of the path keeps from occupied cells.
    """

    heuristic: str = "octile"
    weight: float = 1.0
    weight_by_distance: bool = False
    log_base: float = 10.0
    cost: str = "accumulated"
    neighbours: int = 8
    corners: str = "strict"
    five_directions: bool = False
    fallback: bool = True
    ties: str = "fifo"
    reopen: bool = False
    pruned: bool = False
    safety_radius: float = 0.0

    def __post_init__(self) -> None:
        _among("heuristic", self.heuristic, _HEURISTICS)
        _among("cost", self.cost, ("accumulated", "straight line"))
        _among("neighbours", self.neighbours, (4, 8))
        _among("corners", self.corners, ("strict", "permissive"))
        _among("ties", self.ties, _TIES)
        if not (np.isfinite(self.weight) and self.weight >= 0.0):
            raise ValueError(f"weight must be a finite number, 0 or more, got {self.weight}")
        if not (np.isfinite(self.log_base) and self.log_base > 1.0):
            raise ValueError(f"log_base must be above 1, for instance 10 or e, got {self.log_base}")
        if not (np.isfinite(self.safety_radius) and self.safety_radius >= 0.0):
            raise ValueError(f"safety_radius must be metres, 0 or more, got {self.safety_radius}")
        steady = self.heuristic not in ("manhattan", "enhanced") and self.weight <= 1.0
        plain = self.cost == "accumulated" and not (self.weight_by_distance or self.five_directions or self.reopen)
        if self.pruned and not (steady and plain and self.neighbours == 8 and self.corners == "strict"):
            raise ValueError("pruned needs a consistent heuristic, accumulated cost, 8 neighbours and strict corners")

    def choices(self, five: bool, resolution: float) -> kernels.Choices:
        """The choices as the kernel takes them."""
        return (
            _HEURISTICS.index(self.heuristic),
            float(self.weight),
            float(self.log_base),
            self.weight_by_distance,
            resolution,
            self.cost != "accumulated",
            self.neighbours == 4,
            five,
            self.corners == "strict",
            _TIES.index(self.ties),
            self.reopen,
            self.pruned,
        )


def _among(name: str, value: object, offered: Sequence[object]) -> None:
    if value not in offered:
        raise ValueError(f"{name} must be one of {', '.join(map(repr, offered))}, got {value!r}")


TRADITIONAL = Options(heuristic="euclidean", corners="permissive")
OPTIMAL = Options()
DIJKSTRA = Options(heuristic="zero")
EFFICIENT = Options(heuristic="manhattan", weight_by_distance=True, corners="permissive", five_directions=True)
ENHANCED = Options(heuristic="enhanced", safety_radius=0.5)
QUICK = Options(pruned=True, ties="lifo")


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchResult:
    """What a search found, and what it did for it.

    status: "reached", "no_path", "start_blocked" or "goal_blocked" (by obstacles grown by the safety radius).
    cells `(n, 2)` x, y from start to goal, empty unless reached; length [m] of the path through their centres, nan
    unless reached. `fallback` says that the five directions failed and all eight were searched as well.
    """

    status: str
    cells: Cells
    length: float
    fallback: bool
    seconds: float
    _order: NDArray[np.int32] = field(repr=False)
    _width: int = field(repr=False)

    def __post_init__(self) -> None:
        """Make the arrays read-only: what a search found does not change."""
        self.cells.setflags(write=False)
        self._order.setflags(write=False)

    @property
    def searched(self) -> int:
        """Number of cells expanded: taken from the open list, start and goal included."""
        return len(self._order)

    @property
    def expanded(self) -> Cells:
        """Cells `(searched, 2)` x, y in the order in which they were expanded."""
        y, x = np.divmod(self._order.astype(np.int64), self._width)
        return np.stack([x - 1, y - 1], axis=-1)


def search(grid: GridMap, start: ArrayLike, goal: ArrayLike, options: Options = OPTIMAL) -> SearchResult:
    """Path on the free cells from start to goal, cells x, y counted from 0: best f = g + h first.

    Raises ValueError for a start or goal that is not a cell of the map.
    Source: thesis eq 3.1, eq 3.7, eq 4.1 and eq 4.5, with g accumulated (errata T11).

    >>> search(GridMap(np.zeros((5, 5), dtype=bool)), (0, 0), (4, 2)).length.__round__(4)
    4.8284
    """
    began = time.perf_counter()
    ends = (*checked_cell(grid, start, "start"), *checked_cell(grid, goal, "goal"))
    free = grid.inflate(options.safety_radius) if options.safety_radius > 0.0 else grid
    for status, x, y in (("start_blocked", *ends[:2]), ("goal_blocked", *ends[2:])):
        if free.occupied[y, x]:
            return _nothing(status, began, grid)
    state, found, order = _attempt(free, ends, options, options.five_directions)
    again = not found and options.five_directions and options.fallback
    if again:
        state, found, more = _attempt(free, ends, options, False)
        order = np.concatenate([order, more])
    cells = kernels.trace(state, ends) if found else np.empty((0, 2), dtype=np.int64)
    return SearchResult(
        status="reached" if found else "no_path",
        cells=cells,
        length=path_length(cells) * grid.resolution if found else float("nan"),
        fallback=again,
        seconds=time.perf_counter() - began,
        _order=order,
        _width=state.shape[1],
    )


def _attempt(
    free: GridMap, ends: tuple[int, int, int, int], options: Options, five: bool
) -> tuple[NDArray[np.uint8], bool, NDArray[np.int32]]:
    state = np.full((free.shape[0] + 2, free.shape[1] + 2), 128, dtype=np.uint8)
    np.left_shift(free.occupied.view(np.uint8), 7, out=state[1:-1, 1:-1])
    found, order = kernels.search(state, ends, options.choices(five, free.resolution))
    return state, found, order


def _nothing(status: str, began: float, grid: GridMap) -> SearchResult:
    return SearchResult(
        status=status,
        cells=np.empty((0, 2), dtype=np.int64),
        length=float("nan"),
        fallback=False,
        seconds=time.perf_counter() - began,
        _order=np.empty(0, dtype=np.int32),
        _width=grid.shape[1] + 2,
    )


def checked_cell(grid: GridMap, value: ArrayLike, name: str) -> tuple[int, int]:
    """A cell of the map as two ints, or a ValueError that names what is wrong."""
    cell = np.asarray(value)
    if cell.shape != (2,) or cell.dtype.kind not in "iuf" or not np.all(np.isfinite(cell)) or (cell % 1 != 0).any():
        raise ValueError(f"{name} must be two whole numbers x, y counted from 0, got {value!r}")
    if not grid.contains(cell):
        rows, cols = grid.shape
        raise ValueError(f"{name} {tuple(int(v) for v in cell)} lies outside the map of {cols} x {rows} cells")
    return int(cell[0]), int(cell[1])


def search_through(grid: GridMap, points: Sequence[ArrayLike], options: Options = ENHANCED) -> tuple[SearchResult, ...]:
    """The legs of a path through start, key nodes and goal in this order, each leg with lists of its own.

    A leg that fails is the last of the result, and its status says why. Thesis algorithm 4.1 (errata T20: there the
    closed list of a leg blocks the next one, and a leg that fails goes unnoticed). Raises ValueError for fewer than
    two points.
    """
    if len(points) < 2:
        raise ValueError(f"a path needs a start and a goal, got {len(points)} points")
    legs: list[SearchResult] = []
    for a, b in pairwise(points):
        legs.append(search(grid, a, b, options))
        if legs[-1].status != "reached":
            break
    return tuple(legs)


def path_length(cells: ArrayLike) -> float:
    """Length [cells] of a path through cells `(n, 2)`, straight and diagonal steps counted before they are added.

    >>> path_length([[0, 0], [1, 1], [2, 1]]).__round__(4)
    2.4142
    """
    moves = np.abs(np.diff(np.asarray(cells, dtype=float), axis=0))
    if len(moves) and moves.max() <= 1.0:
        diagonal = int((moves.sum(axis=1) == 2).sum())
        return float(int((moves.sum(axis=1) == 1).sum()) + diagonal * np.sqrt(2.0))
    return float(np.hypot(moves[:, 0], moves[:, 1]).sum())


def valid_path(grid: GridMap, cells: ArrayLike, options: Options = OPTIMAL) -> bool:
    """Whether cells `(n, 2)` are a path: free, one step from each to the next, no forbidden diagonal."""
    path = np.asarray(cells, dtype=np.int64).reshape(-1, 2)
    free = grid.inflate(options.safety_radius)
    inside = len(path) > 0 and bool(grid.contains(path).all()) and not free.occupied[path[0, 1], path[0, 0]]
    steps = np.diff(path, axis=0)
    legal = (np.abs(steps).max(axis=1) == 1) & (np.abs(steps).sum(axis=1) <= (1 if options.neighbours == 4 else 2))
    return (
        inside
        and bool(legal.all())
        and all(free.move_allowed(a, d, options.corners) for a, d in zip(path[:-1], steps, strict=True))
    )


def solve(grid: GridMap, problems: Sequence[Scenario], options: Options = QUICK) -> list[tuple[Scenario, SearchResult]]:
    """Every problem of a scenario file, with its answer. Raises ValueError for a scenario of another map."""
    for problem in problems:
        if problem.shape != grid.shape:
            (rows, cols), (r, c) = grid.shape, problem.shape
            raise ValueError(f"the scenario is for a map of {c} x {r} cells, this one has {cols} x {rows}")
    return [(problem, search(grid, problem.start, problem.goal, options)) for problem in problems]


def main(arguments: Sequence[str] | None = None) -> int:
    """Solve a scenario file and print a table by bucket; return 1 if a length differs from the file's."""
    parser = argparse.ArgumentParser(prog="python -m fuzzynav.planning.astar", description=main.__doc__)
    parser.add_argument("map", type=Path, help="MovingAI .map, ROS .yaml or ASCII .txt")
    parser.add_argument("scen", type=Path, help="MovingAI .scen for this map")
    parser.add_argument(
        "--preset",
        choices=("OPTIMAL", "QUICK", "DIJKSTRA", "TRADITIONAL"),
        default="QUICK",
        help="the benchmark's lengths are those of strict corners",
    )
    given = parser.parse_args(arguments)
    try:
        grid, problems = GridMap.load(given.map), read_scenarios(given.scen)
        if problems and Path(problems[0].map_name).name != given.map.name:
            raise ValueError(f"{given.scen} is for the map {problems[0].map_name}, not for {given.map.name}")
        kernels._warm()
        answers = solve(grid, problems, globals()[given.preset])
    except (ValueError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    return _report(answers)


def agrees(length: float, published: float) -> bool:
    """Whether a length equals that of a scenario file to 1e-4, or to the six digits that older files print.

    >>> agrees(390.00011, 390.0), agrees(9.0002, 9.0), agrees(float("nan"), 39.0)
    (True, False, False)
    """
    return bool(abs(length - published) <= max(1e-4, 5.1e-6 * published))


def _report(answers: Sequence[tuple[Scenario, SearchResult]]) -> int:
    """Print one line for each ten buckets and one for all; return 1 if a length is wrong by over 1e-4."""
    print(f"{'bucket':>9} {'problems':>9} {'length':>10} {'expanded':>9} {'ms':>8} {'ns/cell':>8} {'wrong':>6}")
    groups: dict[str, list[tuple[Scenario, SearchResult]]] = {}
    for pair in answers:
        low = pair[0].bucket // 10 * 10
        groups.setdefault(f"{low}-{low + 9}", []).append(pair)
    wrong = 0
    for name, pairs in {**groups, "all": list(answers)}.items():
        wrong = sum(not agrees(r.length, p.length) for p, r in pairs)
        searched, seconds = sum(r.searched for _, r in pairs), sum(r.seconds for _, r in pairs)
        length, n = sum(r.length for _, r in pairs), max(len(pairs), 1)
        print(
            f"{name:>9} {len(pairs):9d} {length / n:10.3f} {searched / n:9.0f} {seconds / n * 1e3:8.3f} "
            f"{seconds / max(searched, 1) * 1e9:8.0f} {wrong:6d}"
        )
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
