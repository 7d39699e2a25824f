"""The compiled search of the grid planners: take the cell with the lowest f = g + h, look at its neighbours, repeat.

Costs are whole numbers of 1e-12 cell, so that equal sums are equal; f is rounded to 1e-9 cell. The open list stands in
`openlist`. Taking and pushing are written out in the loop that uses them, with what they count in local variables:
an array that is handed to a small function is counted as in use and released again, which costs more than the work.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fuzzynav.planning.openlist import (
    CELL,
    FIFO,
    FIRST,
    KEY,
    LAST,
    LIFO,
    LOW_H,
    NEXT,
    QUEUE,
    ROOM,
    SUB,
    Long,
    Open,
    Short,
    before,
    down,
    drop,
    grown,
    longer,
    opened,
    slot,
    up,
)

__all__: list[str] = []

Bytes = NDArray[np.uint8]
Four = tuple[int, int, int, int]
Choices = tuple[int, float, float, bool, float, bool, bool, bool, bool, int, bool, bool]

_STRAIGHT, _DIAGONAL = 1_000_000_000_000, 1_414_213_562_373
_ROUND = 1000  # f is compared in 1e-9
_OCCUPIED, _CLOSED, _ENTERED = 128, 64, 15
_NOTHING, _FOUND, _FULL = range(3)
ZERO, EUCLIDEAN, MANHATTAN, OCTILE, CHEBYSHEV, ENHANCED = range(6)
# x, y of the eight steps: N, NE, E, SE, S, SW, W, NW; the odd ones are diagonal
_STEP_X, _STEP_Y = np.array([0, 1, 1, 1, 0, -1, -1, -1]), np.array([1, 1, 0, -1, -1, -1, 0, 1])


class Rules(NamedTuple):
    """The choices of a search, in the order of `Choices`."""

    heuristic: int
    weight: float
    log_base: float
    by_distance: bool
    resolution: float
    straight_line: bool  # the cost of a cell is its distance from the start
    four: bool
    five: bool
    strict: bool
    ties: int
    reopen: bool
    pruned: bool


class Ends(NamedTuple):
    """Start and goal as cells x, y."""

    start_x: int
    start_y: int
    goal_x: int
    goal_y: int


@njit(cache=True)
def kept(dx: float, dy: float, direction: int) -> bool:
    """Whether Table 3.1 keeps this direction: the sector of the goal's bearing, two to each side."""
    sector = int(np.floor((np.arctan2(float(dx), float(dy)) / (np.pi / 4.0)) + 0.5 + 1e-12)) % 8
    gap = (direction - sector) % 8
    return gap <= 2 or gap >= 6


@njit(cache=True)
def _octile(dx: int, dy: int) -> int:
    ax, ay = abs(dx), abs(dy)
    return _STRAIGHT * max(ax, ay) + (_DIAGONAL - _STRAIGHT) * min(ax, ay)


@njit(cache=True)
def _line(dx: int, dy: int) -> float:
    """Length [cells] of the straight line."""
    return float(np.sqrt(float(dx * dx + dy * dy)))


@njit(cache=True)
def _distance(dx: int, dy: int, ends: Ends, rules: Rules) -> int:
    """Heuristic [1e-12 cell] for the offset dx, dy [cells] to the goal, before it is weighted."""
    if rules.heuristic == ZERO:
        return 0
    if rules.heuristic == OCTILE:
        return _octile(dx, dy)
    if rules.heuristic == MANHATTAN:
        return _STRAIGHT * (abs(dx) + abs(dy))
    if rules.heuristic == CHEBYSHEV:
        return _STRAIGHT * max(abs(dx), abs(dy))
    line = _line(dx, dy)
    if rules.heuristic == ENHANCED:
        whole = _line(ends.goal_x - ends.start_x, ends.goal_y - ends.start_y)
        ratio = line / whole if whole > 0.0 else 0.0
        line *= (1.0 + ratio) * np.log(line * rules.resolution + 1.0) / np.log(rules.log_base)
    return int(np.rint(line * _STRAIGHT))


@njit(cache=True)
def estimate(dx: int, dy: int, ends: Ends, rules: Rules) -> int:
    """Heuristic [1e-12 cell] times its weight, and times e^P with P as `heuristics.distance_scale`."""
    h = _distance(dx, dy, ends, rules)
    if rules.by_distance:
        whole = abs(ends.goal_x - ends.start_x) + abs(ends.goal_y - ends.start_y)
        scale = min(1.0, (abs(dx) + abs(dy)) / whole) if whole > 0 else 0.0
        return int(np.rint(h * (rules.weight * np.exp(scale))))
    return int(np.rint(h * rules.weight)) if rules.weight != 1.0 else h


@njit(cache=True)
def _cost(g: int, x: int, y: int, d: int, ends: Ends, rules: Rules) -> int:
    """Cost [1e-12 cell] of the cell x, y entered by step d from one of cost g."""
    if rules.straight_line:
        return int(np.rint(_line(x - ends.start_x, y - ends.start_y) * _STRAIGHT))
    return g + (_DIAGONAL if d & 1 else _STRAIGHT)


@njit(cache=True)
def _natural(flat: Bytes, node: int, offsets: Long, d: int) -> int:
    """Directions, one bit each, that a cell entered by step d passes on: the others its parent reaches as cheaply."""
    if d & 1:
        return 1 << d | 1 << (d - 1) | 1 << ((d + 1) & 7)
    left = 1 << d
    if flat[node + offsets[(d + 5) & 7]] & _OCCUPIED:
        left |= 1 << ((d + 6) & 7) | 1 << ((d + 7) & 7)
    if flat[node + offsets[(d + 3) & 7]] & _OCCUPIED:
        left |= 1 << ((d + 2) & 7) | 1 << (d + 1)
    return left


@njit(cache=True)
def _place(x: int, y: int, width: int) -> int:
    """Index of the cell x, y in the rows of a map with a border."""
    return (y + 1) * width + x + 1


@njit(cache=True)
def search(state: Bytes, four: Four, choices: Choices) -> tuple[bool, Short]:
    """Best-first search; returns (found, expanded cells in order).

    state: (rows + 2, cols + 2) uint8, 128 where occupied and on the border, else 0; changed in place: bit 64 says
    closed, the low bits the direction + 1 by which a cell was entered. four, choices: as `Ends` and `Rules`.
    """
    ends, rules = Ends(*four), Rules(*choices)
    start = _place(ends.start_x, ends.start_y, state.shape[1])
    h = estimate(ends.goal_x - ends.start_x, ends.goal_y - ends.start_y, ends, rules)
    waiting = opened(start, (h + _ROUND // 2) // _ROUND, h if rules.ties == LOW_H else 0)
    cost, order, count = np.empty(state.size, dtype=np.int64), np.empty(state.size, dtype=np.int32), 0
    cost[start] = 0
    while True:
        outcome, count = _run(state, cost, order, count, waiting, ends, rules)
        if outcome != _FULL:
            return outcome == _FOUND, order[:count].copy()
        waiting = grown(waiting)
        if count == order.shape[0]:
            order = longer(order)


@njit(cache=True)
def _run(
    state: Bytes, cost: Long, order: Short, count: int, waiting: Open, ends: Ends, rules: Rules
) -> tuple[int, int]:
    """Expand cells until the goal is closed, nothing is open, or an array is full; returns why, and how many so far."""
    flat, width = state.ravel(), state.shape[1]
    entries, queues, heap, table, tally = waiting
    filled, known, in_heap, now, spare_entry, spare_queue = tally
    now_key, now_sub = queues[now, KEY], queues[now, SUB]
    offsets = _STEP_Y * width + _STEP_X
    start, goal = _place(ends.start_x, ends.start_y, width), _place(ends.goal_x, ends.goal_y, width)
    barred = _OCCUPIED if rules.reopen else _CLOSED  # a neighbour with such a state or above is left alone
    plain = rules.heuristic == OCTILE and rules.weight == 1.0 and not rules.by_distance
    outcome = _FULL
    while filled + ROOM <= entries.shape[0] and known + ROOM <= queues.shape[0] and count < order.shape[0]:
        # take the queue on top of the heap in hand, if the one in hand is empty or comes after it
        entry = queues[now, FIRST]
        if in_heap > 0 and (entry < 0 or before(heap[0, KEY], heap[0, SUB], now_key, now_sub)):
            other = heap[0, QUEUE]
            in_heap -= 1
            down(heap, in_heap)
            if entry >= 0:
                up(heap, in_heap, now_key, now_sub, now)
                in_heap += 1
            else:
                drop(table, queues, now)
                queues[now, FIRST], queues[now, LAST] = spare_queue, -1
                spare_queue = now
            now = other
            now_key, now_sub, entry = queues[now, KEY], queues[now, SUB], queues[now, FIRST]
        if entry < 0:
            outcome = _NOTHING
            break

        # take its first cell, and close it
        node = entries[entry, CELL]
        queues[now, FIRST] = entries[entry, NEXT]
        entries[entry, NEXT] = spare_entry
        spare_entry = entry
        if flat[node] & _CLOSED:
            continue
        flat[node] |= _CLOSED
        order[count] = node
        count += 1
        if node == goal:
            outcome = _FOUND
            break

        # look at its neighbours
        y, x = node // width - 1, node % width - 1
        left = 0x55 if rules.four else 0xFF  # the directions still to be looked at, one bit each
        if rules.pruned and node != start:
            left = _natural(flat, node, offsets, int(flat[node] & _ENTERED) - 1)
        for d in range(8):
            if not (left >> d) & 1:
                continue
            child = node + offsets[d]
            seen = flat[child]
            if seen >= barred:
                continue
            if rules.strict and d & 1 and (flat[node + offsets[d - 1]] | flat[node + offsets[(d + 1) & 7]]) & _OCCUPIED:
                continue
            if rules.five and not kept(ends.goal_x - x, ends.goal_y - y, d):
                continue
            cx, cy = x + _STEP_X[d], y + _STEP_Y[d]
            g = _cost(cost[node], cx, cy, d, ends, rules)
            if (seen & _ENTERED or child == start) and g >= cost[child]:
                continue
            cost[child] = g
            flat[child] = d + 1
            dx, dy = ends.goal_x - cx, ends.goal_y - cy
            h = _octile(dx, dy) if plain else estimate(dx, dy, ends, rules)

            # push it to the queue of its f, which may be new
            key, sub = (g + h + _ROUND // 2) // _ROUND, h if rules.ties == LOW_H else 0
            queue = now
            if key != now_key or sub != now_sub:
                at = slot(table, queues, key, sub)
                queue = table[at]
                if queue < 0:
                    queue = spare_queue
                    if queue >= 0:
                        spare_queue = queues[queue, FIRST]
                    else:
                        queue = known
                        known += 1
                    table[at] = queue
                    queues[queue, KEY], queues[queue, SUB], queues[queue, FIRST] = key, sub, -1
                if queues[queue, FIRST] < 0:
                    up(heap, in_heap, key, sub, queue)
                    in_heap += 1
            new = spare_entry
            if new >= 0:
                spare_entry = entries[new, NEXT]
            else:
                new = filled
                filled += 1
            first = queues[queue, FIRST]
            entries[new, CELL], entries[new, NEXT] = child, -1
            if first < 0:
                queues[queue, FIRST], queues[queue, LAST] = new, new
            elif rules.ties == LIFO:
                entries[new, NEXT] = first
                queues[queue, FIRST] = new
            else:
                entries[queues[queue, LAST], NEXT] = new
                queues[queue, LAST] = new
    tally[:] = filled, known, in_heap, now, spare_entry, spare_queue
    return outcome, count


@njit(cache=True)
def trace(state: Bytes, ends: Four) -> Long:
    """Cells (n, 2) x, y from start to goal, by the directions kept in `state`."""
    n = 1
    x, y = ends[2], ends[3]
    while x != ends[0] or y != ends[1]:
        d = int(state[y + 1, x + 1] & _ENTERED) - 1
        x, y = x - _STEP_X[d], y - _STEP_Y[d]
        n += 1
    cells = np.empty((n, 2), dtype=np.int64)
    x, y = ends[2], ends[3]
    for k in range(n - 1, -1, -1):
        cells[k, 0], cells[k, 1] = x, y
        d = int(state[y + 1, x + 1] & _ENTERED) - 1
        if k > 0:
            x, y = x - _STEP_X[d], y - _STEP_Y[d]
    return cells


def _warm() -> None:
    """Compile the kernels on a map of nine cells."""
    state = np.full((5, 5), _OCCUPIED, dtype=np.uint8)
    state[1:4, 1:4] = 0
    search(state, (0, 0, 2, 2), (OCTILE, 1.0, 10.0, False, 1.0, False, False, False, True, FIFO, False, False))
    trace(state, (0, 0, 2, 2))
    kept(1, 1, 0)
