"""Exercises of chapter 05: admissible heuristics, corners, costs, weights; turning points, spline ends, eta vectors."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

from fuzzynav import smoothing
from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar, heuristics
from fuzzynav.planning.astar import DIJKSTRA, Options, SearchResult
from fuzzynav.smoothing import simplify

__all__ = ["EXERCISES", "maps_of_05_4"]

Function = Callable[..., Any]
END = (4.0, 3.0, 0.0)  # of exercise 05.8
MOST_BENT, LONGEST = 0.8, 5.4  # [1/m], [m]
SHARE, EXCESS = 0.25, 0.05  # of exercise 05.4: cells searched against Dijkstra, length against the shortest


def _number(value: Any, what: str) -> float:
    try:
        number = float(np.asarray(value, dtype=float).reshape(()))
    except (TypeError, ValueError):
        raise Wrong(f"{what} should be one number, not {value!r:.60}.") from None
    if not np.isfinite(number):
        raise Wrong(f"{what} should be one finite number, not {value!r:.60}.")
    return number


def _random_map(rng: np.random.Generator, size: int, density: float) -> GridMap:
    occupied = rng.random((size, size)) < density
    occupied[0, 0] = occupied[-1, -1] = False
    return GridMap(occupied)


# --- 05.1


def _check_heuristic(answer: Function) -> str:
    """Never above the true length on an empty and on seeded maps, and never below the straight line."""
    for dx, dy in ((0, 0), (5, 0), (3, 3), (4, -3), (-2, 7), (-6, -1)):
        told = _number(answer(dx, dy), f"The heuristic at ({dx}, {dy})")
        best, line = float(heuristics.octile((dx, dy))), float(np.hypot(dx, dy))
        if told > best + 1e-9:
            raise Wrong(
                f"From ({dx}, {dy}) the goal is {best:.3f} steps away on an empty map, yours says {told:.3f}: "
                "a search with it may miss the shortest path."
            )
        if told < line - 1e-9:
            raise Wrong(
                f"From ({dx}, {dy}) even the straight line is {line:.3f} long, yours says only {told:.3f}: "
                "the search expands more cells than it must."
            )
    if _number(answer(4, -3), "The heuristic") < float(heuristics.octile((4, -3))) - 1e-9:
        raise Wrong("It is admissible, but from (4, -3) no path is shorter than 3 diagonal and 1 straight step.")
    return "It is the exact length on an empty map: no admissible heuristic that knows no obstacles expands less."


# --- 05.2


def _check_legal(answer: Function) -> str:
    """Every step from every free cell of seeded maps, the edge included."""
    rng = np.random.default_rng(52)
    for _ in range(6):
        grid = _random_map(rng, 5, 0.3)
        for y, x in np.argwhere(~grid.occupied).tolist():
            for dx, dy in heuristics.STEPS.tolist():
                wanted = grid.move_allowed((x, y), (dx, dy), "strict")
                told = answer(grid.occupied.copy(), x, y, dx, dy)
                if bool(told) != wanted:
                    rows = " / ".join(grid.to_ascii().split("\n"))
                    where = f"from ({x}, {y}) by ({dx}, {dy}) on the map {rows} (rows from y = 4 down to 0) "
                    if not grid.contains((x + dx, y + dy)):
                        raise Wrong(f"The step {where}leaves the map. Beware: index -1 is the last row.")
                    raise Wrong(f"The step {where}is {'legal' if wanted else 'not legal'}.")
    return "No step leaves the map, enters an obstacle or cuts a corner."


# --- 05.3


def _check_cost(answer: Function) -> str:
    """The cost of a child depends on how it was reached."""
    rng = np.random.default_rng(53)
    for _ in range(20):
        g = float(rng.uniform(0.0, 30.0))
        parent = rng.integers(0, 20, 2)
        child = parent + heuristics.STEPS[rng.integers(8)]
        told = _number(answer(g, tuple(parent.tolist()), tuple(child.tolist()), (0, 0)), "The cost")
        wanted = g + float(np.hypot(*(child - parent)))
        if abs(told - wanted) > 1e-9:
            straight = abs(told - float(np.hypot(*child))) < 1e-9
            why = (
                "that is the straight line from the start, however long the way was (T11)"
                if straight
                else "add the step to what the parent cost"
            )
            raise Wrong(
                f"The parent {tuple(parent.tolist())} cost {g:.2f}; its neighbour {tuple(child.tolist())} "
                f"costs {wanted:.2f}, not {told:.2f}: {why}."
            )
    return "The cost is accumulated along the way, and the branch 'better g' can fire."


# --- 05.4


@cache
def maps_of_05_4() -> tuple[tuple[GridMap, SearchResult], ...]:
    """Forty solvable maps of 30 x 30 cells, each with Dijkstra's answer from corner to corner."""
    rng = np.random.default_rng(54)
    found: list[tuple[GridMap, SearchResult]] = []
    while len(found) < 40:
        grid = _random_map(rng, 30, 0.25)
        best = astar.search(grid, (0, 0), (29, 29), DIJKSTRA)
        if best.status == "reached":
            found.append((grid, best))
    return tuple(found)


def _check_weight(answer: Any) -> str:
    """At most a quarter of Dijkstra's cells in the mean, and no path over 5 % longer."""
    if not isinstance(answer, Options):
        raise Wrong(f"The answer should be Options, such as replace(OPTIMAL, weight=1.0), not {type(answer).__name__}.")
    if answer.corners != "strict" or answer.neighbours != 8:
        raise Wrong("Keep strict corners and eight neighbours: another rule makes another problem.")
    cells, dijkstra, worst = 0, 0, 0.0
    for k, (grid, best) in enumerate(maps_of_05_4()):
        found = astar.search(grid, (0, 0), (29, 29), answer)
        if found.status != "reached":
            raise Wrong(f"On map {k} your search ends with {found.status}, though there is a path.")
        cells, dijkstra = cells + found.searched, dijkstra + best.searched
        worst = max(worst, found.length / best.length - 1.0)
    share = cells / dijkstra
    if share > SHARE:
        raise Wrong(
            f"It searches {100 * share:.0f} % of Dijkstra's cells, {100 * SHARE:.0f} % are asked for: "
            "let the heuristic weigh more."
        )
    if worst > EXCESS:
        raise Wrong(
            f"One of its paths is {100 * worst:.1f} % longer than the shortest, {100 * EXCESS:.0f} % are "
            "allowed: let the heuristic weigh less."
        )
    return f"{100 * share:.0f} % of Dijkstra's cells, and no path is more than {100 * worst:.1f} % too long."


# --- 05.5


def _check_shorten(answer: Function) -> str:
    """Kept indices on seeded paths: ends kept, every leg free, as few as the greedy rule keeps."""
    rng = np.random.default_rng(55)
    tried = 0
    while tried < 12:
        grid = _random_map(rng, 16, 0.2)
        cells = astar.search(grid, (0, 0), (15, 15)).cells
        if len(cells) < 3:
            continue
        tried += 1
        centers = grid.center_of(cells)

        def free(a: int, b: int, grid: GridMap = grid, centers: np.ndarray = centers) -> bool:
            return grid.clear_line(centers[a], centers[b], 0.3)

        told = _indices(answer(len(cells), free), len(cells))
        for a, b in pairwise(told):
            if not free(a, b):
                raise Wrong(f"You kept the nodes {a} and {b}, but the straight leg between them hits an obstacle.")
        wanted = len(simplify.shorten(cells, grid, 0.3))
        if len(told) > wanted:
            raise Wrong(
                f"Of {len(cells)} nodes you kept {len(told)}, {wanted} are enough: after a blocked leg go on "
                "from the last node that was in sight, not from the one that was not (T22)."
            )
    return "Every leg is free, and no node is kept that a free leg can skip."


def _indices(value: Any, count: int) -> list[int]:
    try:
        told = [int(k) for k in value]
    except (TypeError, ValueError):
        raise Wrong("The answer should be a list of the numbers of the kept nodes.") from None
    if told[:1] != [0] or told[-1:] != [count - 1]:
        raise Wrong(f"The path must begin with node 0 and end with node {count - 1}; yours are {told}.")
    if sorted(set(told)) != told:
        raise Wrong(f"The numbers must rise: {told} do not.")
    return told


# --- 05.6


def _check_ends(answer: Function) -> str:
    """The free spline on the returned points passes through both ends, along the first and the last leg."""
    rng = np.random.default_rng(56)
    for _ in range(10):
        points = np.cumsum(rng.uniform(0.3, 2.0, (int(rng.integers(4, 9)), 2)), axis=0)
        controls = np.asarray(answer(points.copy()), dtype=float)
        if controls.ndim != 2 or controls.shape[1:] != (2,):
            raise Wrong(f"The answer should be control points (n, 2), not an array of shape {controls.shape}.")
        spline = smoothing.bspline(controls, "free")
        met = spline.points(2)
        for name, end, given in (("start", met[0], points[0]), ("goal", met[1], points[-1])):
            gap = float(np.hypot(*(end - given)))
            if gap > 1e-6:
                raise Wrong(f"The curve misses the {name} by {gap:.3f} m: (P_0 + 4 P_1 + P_2)/6 must be that point.")
        if len(controls) > len(points) + 4:
            raise Wrong(f"{len(controls) - len(points)} points were added; one beyond each end is enough.")
        leg, leave = points[1] - points[0], spline.derivative(spline.span[0], 1)
        if abs(leg[0] * leave[1] - leg[1] * leave[0]) > 1e-6 or leg @ leave <= 0:
            raise Wrong("The curve starts at the right point but not along the first leg.")
    return "The curve starts and ends where the path does, along its legs."


# --- 05.7


def _check_second(answer: Function) -> str:
    """p''(0) of an eta-cubed curve from eta_1, eta_3, heading and curvature."""
    rng = np.random.default_rng(57)
    for _ in range(10):
        e1, e2, e3, theta, kappa = (float(v) for v in rng.uniform([0.5, 0.5, -3, -3, -1], [4, 4, 3, 3, 1]))
        curve = smoothing.eta3([0, 0, theta, kappa], [5, 1, 0], [e1, e2, e3])
        told = np.asarray(answer(e1, e3, theta, kappa), dtype=float).ravel()
        if told.shape != (2,):
            raise Wrong(f"The second derivative has two components, yours {told.size}.")
        wanted = curve.derivative(0.0, 2)
        if not np.allclose(told, wanted, atol=1e-9):
            tangent = np.array([np.cos(theta), np.sin(theta)])
            along, want = float(told @ tangent), float(wanted @ tangent)
            part = (
                f"along the curve it is {want:.3f}, yours {along:.3f}"
                if abs(along - want) > 1e-9
                else "along the curve it is right, across it is eta_1^2 times the curvature, to the left"
            )
            raise Wrong(f"At eta_1 = {e1:.2f}, eta_3 = {e3:.2f}, curvature {kappa:.2f}: {part}.")
    return "Tangential eta_3, normal eta_1 squared times the curvature: the printed eta_2 has no place there (T5)."


# --- 05.8


def _check_eta(answer: Any) -> str:
    """Two to six numbers whose curve bends and stretches little enough."""
    try:
        curve = smoothing.eta3([0.0, 0.0, 0.0], END, answer)
    except (TypeError, ValueError) as error:
        raise Wrong(f"This is no eta vector: {error}.") from None
    sharp = float(np.abs(curve.curvature(np.linspace(0.0, 1.0, 801))).max())
    if sharp > MOST_BENT:
        raise Wrong(
            f"The sharpest curvature is {sharp:.2f} 1/m, a turning radius of {1 / sharp:.2f} m; the robot "
            f"needs {1 / MOST_BENT:.2f} m, that is {MOST_BENT} 1/m."
        )
    if curve.length > LONGEST:
        raise Wrong(f"It turns gently enough but is {curve.length:.2f} m long; {LONGEST} m are allowed.")
    return f"Sharpest curvature {sharp:.2f} 1/m, length {curve.length:.2f} m."


EXERCISES: tuple[Exercise, ...] = (
    Exercise("05.1", "The best heuristic that knows no obstacles", 2, (
        "How many diagonal steps can a path to (dx, dy) have at most, and how many straight ones are left?",
        "Diagonal: the smaller of |dx|, |dy|. Straight: the difference. A diagonal step costs the square root of 2.",
    ), _check_heuristic),
    Exercise("05.2", "Do not cut the corner", 2, (
        "Three things can forbid a step: the edge of the map, the target cell, and for a diagonal the two side cells.",
        "occupied[y, x] with y = -1 is the last row. Test 0 <= x + dx < columns and 0 <= y + dy < rows first.",
    ), _check_legal),
    Exercise("05.3", "Find the bug: the cost that knows no way", 1, (
        "Take a wall between start and child. Does the printed cost change with the way around it?",
        "g of the child is g of the parent plus the length of one step.",
    ), _check_cost),
    Exercise("05.4", "Tune a weight to a specification", 2, (
        "Weight 1 is optimal and slow, weight 3 fast and wrong. Which quantity does the lab show beside the length?",
        "With the octile heuristic try 1.1, 1.2, 1.3.",
    ), _check_weight),
    Exercise("05.5", "Keep only the turning points", 3, (
        "Hold the last kept node and walk on until the leg to node k is blocked. Which node do you keep?",
        "Keep k - 1, and let it be the new base. At the end add the last node.",
    ), _check_shorten),
    Exercise("05.6", "A spline that starts at the start", 2, (
        "A uniform cubic spline starts at (C_0 + 4 C_1 + C_2) / 6. Put one point before P_0 so that this equals P_0.",
        "With C_1 = P_0 and C_2 = P_1 you need C_0 = 2 P_0 - P_1. The same beyond the goal.",
    ), _check_ends),
    Exercise("05.7", "The second derivative at the start", 2, (
        "Write p'' as a part along the heading and a part to its left.",
        "p'' = eta_3 t + eta_1^2 kappa n, with t = (cos, sin) and n = (-sin, cos) of the heading.",
    ), _check_second),
    Exercise("05.8", "Tune an eta vector to a robot", 2, (
        "Move the sliders of the eta lab. What do larger speeds do to the middle of the curve?",
        "Small speeds with a positive eta_3 and a negative eta_4 bend least: try eta_1 = eta_2 = 2.",
    ), _check_eta),
)  # fmt: skip
