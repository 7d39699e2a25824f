"""A* as a reader would write it, to be laid beside the compiled search of `astar`: the same choices, cell by cell."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from numpy.typing import ArrayLike

from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning.astar import checked_cell
from fuzzynav.planning.heuristics import STEPS

__all__ = ["PlainResult", "Step", "plain_astar"]

Cell = tuple[int, int]


class Step(NamedTuple):
    """One expansion: the cell taken, its g, h and f = g + h [cells], and the open list that it leaves behind."""

    node: Cell
    g: float
    h: float
    f: float
    waiting: tuple[Cell, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class PlainResult:
    """The path from start to goal, empty where there is none, and the table of every expansion in order."""

    path: tuple[Cell, ...]
    table: tuple[Step, ...]

    @property
    def expanded(self) -> tuple[Cell, ...]:
        """The cells in the order in which they were expanded."""
        return tuple(step.node for step in self.table)


def plain_astar(grid: GridMap, start: ArrayLike, goal: ArrayLike) -> PlainResult:
    """A* with an open and a closed list, as `astar.TRADITIONAL`: straight-line heuristic, eight neighbours, first come.

    For maps of a few hundred cells: the lowest f is sought through the whole open list. Raises ValueError as
    `astar.search`; an occupied start or goal has no path.

    >>> plain_astar(GridMap.from_ascii("...\\n.#.\\n..."), (0, 0), (2, 1)).path
    ((0, 0), (1, 0), (2, 1))
    """
    begin, end = checked_cell(grid, start, "start"), checked_cell(grid, goal, "goal")
    g, h, parent = {begin: 0.0}, {begin: math.dist(begin, end)}, {begin: begin}
    blocked = any(grid.occupied[y, x] for x, y in (begin, end))
    opened, closed, table = [] if blocked else [begin], set(), []
    while opened:
        node = min(opened, key=lambda cell: round(g[cell] + h[cell], 9))  # the first of those with the lowest f
        opened.remove(node)
        closed.add(node)
        for dx, dy in STEPS.tolist() if node != end else ():
            child = (node[0] + dx, node[1] + dy)
            new = g[node] + math.hypot(dx, dy)
            if child in closed or not grid.move_allowed(node, (dx, dy), "permissive"):
                continue
            if child not in g or new < g[child] - 1e-9:  # a better way: the cell comes last among its equals
                g[child], h[child], parent[child] = new, math.dist(child, end), node
                opened = [cell for cell in opened if cell != child] + [child]
        table.append(Step(node, g[node], h[node], g[node] + h[node], tuple(opened)))
        if node == end:
            break
    path = [end] if end in closed else []
    while path and path[-1] != begin:
        path.append(parent[path[-1]])
    return PlainResult(path=tuple(path[::-1]), table=tuple(table))
