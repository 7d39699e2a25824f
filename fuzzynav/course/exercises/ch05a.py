"""Exercises of chapter 05a: an admissible heuristic, corners, a cost, a weight tuned to a specification."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.course.exercises.answers import named, number, truth
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar, heuristics
from fuzzynav.planning.astar import DIJKSTRA, Options, SearchResult

__all__ = ["EXERCISES", "random_map"]

Function = Callable[..., Any]
Truths = NDArray[np.bool_]
SHARE, EXCESS = 0.25, 0.05  # of exercise 05.4: cells searched against Dijkstra, length against the shortest


def random_map(rng: np.random.Generator, size: int, density: float) -> GridMap:
    """A square map, its two corners free."""
    occupied = rng.random((size, size)) < density
    occupied[0, 0] = occupied[-1, -1] = False
    return GridMap(occupied)


# --- 05.1


def _check_heuristic(answer: Function) -> str:
    """The exact length on an empty map, for every offset within nine cells."""
    reach = np.arange(-9, 10)
    dx, dy = (v.ravel() for v in np.meshgrid(reach, reach))
    told = np.array([number(answer(int(x), int(y)), "The heuristic") for x, y in zip(dx, dy, strict=True)])
    best = heuristics.octile(np.column_stack([dx, dy]))
    if np.abs(told - best).max() <= 1e-9:
        return "It is the exact length on an empty map: no admissible heuristic that knows no obstacles expands less."
    long, short = np.maximum(np.abs(dx), np.abs(dy)), np.minimum(np.abs(dx), np.abs(dy))
    named(
        told,
        (np.hypot(dx, dy), "The straight line is admissible, but not as long as possible: a path on the grid turns."),
        (long + short, "Manhattan counts 2 for a diagonal step of 1.414: a search with it may miss the shortest path."),
        (long, "A diagonal step is longer than a straight one: yours counts both as 1."),
        (0 * long, "Zero is admissible and knows nothing: a search with it is Dijkstra's."),
        (
            long + np.sqrt(2) * short,
            "The diagonal steps already bring you nearer on both axes: take them off the straight.",
        ),
        (np.sqrt(2) * long, "Only as many diagonal steps as the shorter side are needed; the rest goes straight."),
        (
            np.maximum(dx, dy) - np.minimum(dx, dy) + np.sqrt(2) * np.minimum(dx, dy),
            "Offsets may be negative: a goal to the left is as far as one to the right.",
        ),
        (dx**2 + dy**2, "A square of a length is no length: it overestimates everything beyond one cell."),
    )
    k = int(np.argmax(np.abs(told - best)))
    where = f"({dx[k]}, {dy[k]})"
    if np.abs(told - best).max() < 2e-3 * best.max():
        if told[k] < best[k]:
            raise Wrong("The root of 2 is rounded down: admissible, yet a little too short; take np.sqrt(2) itself.")
        raise Wrong("The root of 2 is rounded up: then the heuristic exceeds the true length; take np.sqrt(2) itself.")
    if told[k] > best[k]:
        raise Wrong(
            f"From {where} the goal is {best[k]:.3f} steps away on an empty map, yours says {told[k]:.3f}: "
            "it overestimates, and the shortest path may be missed."
        )
    raise Wrong(
        f"From {where} no path is shorter than {best[k]:.3f} steps, yours says only {told[k]:.3f}: the search expands "
        "more cells than it must."
    )


# --- 05.2


def _check_legal(answer: Function) -> str:
    """Every step from every free cell of seeded maps, the edge included."""
    rng = np.random.default_rng(52)
    steps: list[tuple[GridMap, int, int, int, int]] = []
    for _ in range(6):
        grid = random_map(rng, 5, 0.3)
        free = np.argwhere(~grid.occupied).tolist()
        steps += [(grid, x, y, dx, dy) for y, x in free for dx, dy in heuristics.STEPS.tolist()]
    told = np.array([_said(answer(g.occupied.copy(), *step)) for g, *step in steps])
    wanted = np.array([g.move_allowed((x, y), (dx, dy), "strict") for g, x, y, dx, dy in steps])
    if not np.array_equal(told, wanted):
        _name_steps(told, wanted, steps)
    return "No step leaves the map, enters an obstacle or cuts a corner."


def _said(value: Any) -> bool:
    return value is not None and truth(value, "The answer")  # a function that returns nothing says no


def _name_steps(told: Truths, wanted: Truths, steps: list[tuple[GridMap, int, int, int, int]]) -> None:
    inside = np.array([g.contains((x + dx, y + dy)) for g, x, y, dx, dy in steps])
    target = np.array(
        [i and bool(g.occupied[y + dy, x + dx]) for i, (g, x, y, dx, dy) in zip(inside, steps, strict=True)]
    )
    free = inside & ~target
    shut = np.array(
        [
            f and bool(g.occupied[y, x + dx] and g.occupied[y + dy, x])
            for f, (g, x, y, dx, dy) in zip(free, steps, strict=True)
        ]
    )
    turned = np.array([GridMap(g.occupied.T).move_allowed((x, y), (dx, dy), "strict") for g, x, y, dx, dy in steps])
    named(
        told,
        (~wanted, "Yours says True where the step is forbidden, and False where it is legal."),
        (free, "Yours lets the robot cut corners: a diagonal step needs both side cells free."),
        (
            free & ~shut,
            "Yours forbids a diagonal only if both side cells are occupied: one is enough to touch the robot.",
        ),
        (turned, "x and y are swapped in yours: the array is indexed [y, x]."),
    )
    for wrong, sentence in (
        (told & ~inside, "leaves the map. Beware: index -1 is the last row"),
        (told & target, "ends in an obstacle"),
        (told & free & ~wanted, "cuts a corner"),
        (~told & wanted, "is legal"),
    ):
        if wrong.any():
            g, x, y, dx, dy = steps[int(np.argmax(wrong))]
            rows = " / ".join(g.to_ascii().split("\n"))
            raise Wrong(f"From ({x}, {y}) the step ({dx}, {dy}) on the map {rows} (top row y = 4) {sentence}.")


# --- 05.3


def _check_cost(answer: Function) -> str:
    """The cost of a child depends on how it was reached."""
    rng = np.random.default_rng(53)
    g, parents = rng.uniform(0.0, 30.0, 40), rng.integers(0, 20, (40, 2))
    children = parents + heuristics.STEPS[rng.integers(8, size=40)]
    cases = zip(g.tolist(), parents.tolist(), children.tolist(), strict=True)
    told = np.array([number(answer(cost, tuple(p), tuple(c), (0, 0)), "The cost") for cost, p, c in cases])
    step = np.hypot(*(children - parents).T)
    if np.abs(told - g - step).max() <= 1e-9:
        return "The cost is accumulated along the way, and the branch 'better g' can fire."
    line = np.hypot(*children.T)
    named(
        told,
        (line, "That is the straight line from the start, however long the way was (T11)."),
        (g + line, "The parent's cost already holds the way from the start: add only the step from parent to child."),
        (step, "That is the step alone; the way to the parent has a cost too."),
        (g, "That is the cost of the parent; the step to the child is missing."),
        (g + 1.0, "Every step counts 1 in yours; a diagonal one is longer."),
        (g + np.abs(children - parents).sum(axis=1), "A diagonal step counts 2 in yours; it is the root of 2."),
        (g - step, "A step makes the way longer: add it."),
        (np.abs(children).sum(axis=1), "That is the Manhattan distance from the start: a detour would cost nothing."),
    )
    k = int(np.argmax(np.abs(told - g - step)))
    if np.abs(told - g - step).max() < 2e-3:
        raise Wrong("The root of 2 is rounded in yours: over a long way that adds up; take np.sqrt(2) or np.hypot.")
    raise Wrong(
        f"The parent {tuple(parents[k].tolist())} cost {g[k]:.3f}; its neighbour {tuple(children[k].tolist())} costs "
        f"{g[k] + step[k]:.3f}, not {told[k]:.3f}."
    )


# --- 05.4


@cache
def maps_of_05_4() -> tuple[tuple[GridMap, SearchResult], ...]:
    """Forty solvable maps of 30 x 30 cells, each with Dijkstra's answer from corner to corner."""
    rng = np.random.default_rng(54)
    found: list[tuple[GridMap, SearchResult]] = []
    while len(found) < 40:
        grid = random_map(rng, 30, 0.25)
        best = astar.search(grid, (0, 0), (29, 29), DIJKSTRA)
        if best.status == "reached":
            found.append((grid, best))
    return tuple(found)


def _check_weight(answer: Any) -> str:
    """At most a quarter of Dijkstra's cells in the mean, and no path over 5 % longer."""
    if not isinstance(answer, Options):
        raise Wrong(f"Give Options, such as replace(astar.OPTIMAL, weight=1.0), not a {type(answer).__name__}.")
    if answer.corners != "strict":
        raise Wrong("Keep strict corners: with another corner rule other paths are legal.")
    if answer.neighbours != 8:
        raise Wrong("Keep eight neighbours: with four every path is longer.")
    if answer.safety_radius > 0:
        raise Wrong("Keep the safety radius 0: it closes passages that the forty maps need.")
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
)  # fmt: skip
