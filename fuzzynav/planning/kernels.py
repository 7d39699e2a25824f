"""The compiled search of the grid planners.

Costs are whole numbers of 1e-12 cell, so that equal sums are equal; f is rounded to 1e-9 cell. Cells with the same f
wait in one queue, and a heap holds each value of f once: a cell is pushed and taken in constant time wherever values
of f repeat, as they do on a grid. Queues and their entries are used again once empty, which keeps them in the cache.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__: list[str] = []

Bytes = NDArray[np.uint8]
Short = NDArray[np.int32]
Long = NDArray[np.int64]
Ends = tuple[int, int, int, int]
Choices = tuple[int, bool, bool, bool, bool, bool, int, bool, bool]

_STRAIGHT, _DIAGONAL = 1_000_000_000_000, 1_414_213_562_373
_ROUND = 1000  # f is compared in 1e-9
_OCCUPIED, _CLOSED, _ENTERED = 128, 64, 15
_KEY, _SUB, _FIRST, _LAST = range(4)
_EMPTY, _FOUND, _FULL = range(3)
ZERO, EUCLIDEAN, MANHATTAN, OCTILE, CHEBYSHEV, ENHANCED = range(6)
FIFO, LIFO, LOW_H = range(3)


@njit(cache=True)
def _kept(dx: int, dy: int, direction: int) -> bool:
    """Whether Table 3.1 keeps this direction: the sector of the goal's bearing, two to each side."""
    sector = int(np.floor((np.arctan2(float(dx), float(dy)) / (np.pi / 4.0)) + 0.5 + 1e-12)) % 8
    gap = (direction - sector) % 8
    return gap <= 2 or gap >= 6


@njit(cache=True)
def _estimate(
    dx: int,
    dy: int,
    total_x: int,
    total_y: int,
    kind: int,
    weight: float,
    by_distance: bool,
    log_base: float,
    resolution: float,
) -> int:
    """Weighted heuristic [1e-12 cell] for the offset dx, dy [cells] to the goal."""
    ax, ay = abs(dx), abs(dy)
    if kind == ZERO:
        return 0
    if kind == OCTILE:
        h = _STRAIGHT * max(ax, ay) + (_DIAGONAL - _STRAIGHT) * min(ax, ay)
    elif kind == MANHATTAN:
        h = _STRAIGHT * (ax + ay)
    elif kind == CHEBYSHEV:
        h = _STRAIGHT * max(ax, ay)
    else:
        line = np.sqrt(float(dx * dx + dy * dy))
        if kind == ENHANCED:
            whole = np.sqrt(float(total_x * total_x + total_y * total_y))
            ratio = line / whole if whole > 0.0 else 0.0
            line *= (1.0 + ratio) * np.log(line * resolution + 1.0) / np.log(log_base)
        h = int(np.rint(line * _STRAIGHT))
    if by_distance:
        whole = abs(total_x) + abs(total_y)
        scale = min(1.0, (ax + ay) / whole) if whole > 0 else 0.0
        return int(np.rint(h * (weight * np.exp(scale))))
    if weight != 1.0:
        return int(np.rint(h * weight))
    return h


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
def _home(key: int, sub: int, mask: int) -> int:
    """First place in the hash table to look at."""
    return (key ^ (key >> 9) ^ (key >> 21) ^ (sub >> 15) ^ (sub >> 27)) & mask


@njit(cache=True)
def _slot(table: Short, queues: Long, key: int, sub: int) -> int:
    """Place in the hash table that holds the queue of (key, sub), or the free one where it belongs."""
    mask = table.shape[0] - 1
    at = _home(key, sub, mask)
    while table[at] >= 0 and (queues[table[at], _KEY] != key or queues[table[at], _SUB] != sub):
        at = (at + 1) & mask
    return at


@njit(cache=True)
def _drop(table: Short, queues: Long, queue: int) -> None:
    """Take an empty queue out of the hash table and close the gap."""
    mask = table.shape[0] - 1
    hole = _slot(table, queues, queues[queue, _KEY], queues[queue, _SUB])
    at = (hole + 1) & mask
    while table[at] >= 0:
        home = _home(queues[table[at], _KEY], queues[table[at], _SUB], mask)
        if ((at - home) & mask) >= ((at - hole) & mask):
            table[hole] = table[at]
            hole = at
        at = (at + 1) & mask
    table[hole] = -1


@njit(cache=True)
def _up(heap: Long, size: int, key: int, sub: int, queue: int) -> None:
    """Put one queue into the heap of `size`."""
    at = size
    while at > 0:
        above = (at - 1) >> 1
        if heap[above, 0] < key or (heap[above, 0] == key and heap[above, 1] <= sub):
            break
        heap[at, 0], heap[at, 1], heap[at, 2] = heap[above, 0], heap[above, 1], heap[above, 2]
        at = above
    heap[at, 0], heap[at, 1], heap[at, 2] = key, sub, queue


@njit(cache=True)
def _down(heap: Long, size: int) -> None:
    """Close the gap at the top of the heap with its last element; `size` is what remains."""
    key, sub, queue = heap[size, 0], heap[size, 1], heap[size, 2]
    at = 0
    while 2 * at + 1 < size:
        below = 2 * at + 1
        if below + 1 < size and (
            heap[below + 1, 0] < heap[below, 0]
            or (heap[below + 1, 0] == heap[below, 0] and heap[below + 1, 1] < heap[below, 1])
        ):
            below += 1
        if key < heap[below, 0] or (key == heap[below, 0] and sub <= heap[below, 1]):
            break
        heap[at, 0], heap[at, 1], heap[at, 2] = heap[below, 0], heap[below, 1], heap[below, 2]
        at = below
    heap[at, 0], heap[at, 1], heap[at, 2] = key, sub, queue


@njit(cache=True)
def _longer(array: NDArray) -> NDArray:
    """The same array with room for twice as much."""
    out = np.empty((2 * array.shape[0],) + array.shape[1:], dtype=array.dtype)
    out[: array.shape[0]] = array
    return out


@njit(cache=True)
def _search(
    state: Bytes, ends: Ends, choices: Choices, weight: float, log_base: float, resolution: float
) -> tuple[bool, Short]:
    """Best-first search; returns (found, expanded cells in order).

    state: (rows + 2, cols + 2) uint8, 128 where occupied and on the border, else 0; changed in place: bit 64 says
    closed, the low bits the direction + 1 by which a cell was entered. ends: x, y of start and goal. choices: kind
    of heuristic, weight by distance, straight-line cost, four neighbours, five directions, strict corners, ties,
    reopening, pruning.
    """
    flat = state.ravel()
    start_x, start_y, goal_x, goal_y = ends
    kind, by_distance, ties = choices[0], choices[1], choices[6]
    cost = np.empty(flat.shape[0], dtype=np.int64)
    expanded = np.empty(flat.shape[0], dtype=np.int32)
    entries = np.empty((256, 2), dtype=np.int32)  # cell, next entry of its queue
    queues = np.empty((128, 4), dtype=np.int64)  # f, second key, first and last entry
    heap = np.empty((128, 3), dtype=np.int64)  # f, second key, queue
    table = np.full(512, -1, dtype=np.int32)
    total_x, total_y = goal_x - start_x, goal_y - start_y
    h = _estimate(total_x, total_y, total_x, total_y, kind, weight, by_distance, log_base, resolution)
    start = (start_y + 1) * state.shape[1] + start_x + 1
    entries[0] = start, -1
    queues[0] = (h + _ROUND // 2) // _ROUND, h if ties == LOW_H else 0, 0, 0
    table[_slot(table, queues, queues[0, _KEY], queues[0, _SUB])] = 0
    cost[start] = 0
    # entries, queues, queues in the heap, cells expanded, queue in hand, first unused entry, first unused queue
    tally = np.array([1, 1, 0, 0, 0, -1, -1])
    while True:
        outcome = _run(
            flat,
            state.shape[1],
            cost,
            expanded,
            entries,
            queues,
            heap,
            table,
            tally,
            ends,
            choices,
            weight,
            log_base,
            resolution,
        )
        if outcome != _FULL:
            return outcome == _FOUND, expanded[: tally[3]].copy()
        if tally[0] + 8 > entries.shape[0]:
            entries = _longer(entries)
        if tally[1] + 8 > queues.shape[0]:
            queues, heap = _longer(queues), _longer(heap)
            table = np.full(2 * table.shape[0], -1, dtype=np.int32)
            for q in range(tally[1]):
                if queues[q, _LAST] >= 0:
                    table[_slot(table, queues, queues[q, _KEY], queues[q, _SUB])] = q
        if tally[3] == expanded.shape[0]:
            expanded = _longer(expanded)


@njit(cache=True)
def _run(
    flat: Bytes,
    width: int,
    cost: Long,
    expanded: Short,
    entries: Short,
    queues: Long,
    heap: Long,
    table: Short,
    tally: Long,
    ends: Ends,
    choices: Choices,
    weight: float,
    log_base: float,
    resolution: float,
) -> int:
    """Expand cells until the goal is closed, nothing is open, or an array is full."""
    kind, by_distance, straight_cost, four, five, strict, ties, reopen, pruned = choices
    start_x, start_y, goal_x, goal_y = ends
    offsets = np.array([width, width + 1, 1, 1 - width, -width, -width - 1, -1, width - 1])
    step_x, step_y = np.array([0, 1, 1, 1, 0, -1, -1, -1]), np.array([1, 1, 0, -1, -1, -1, 0, 1])
    total_x, total_y = goal_x - start_x, goal_y - start_y
    start, goal = (start_y + 1) * width + start_x + 1, (goal_y + 1) * width + goal_x + 1
    barred = _OCCUPIED if reopen else _CLOSED  # a neighbour with such a state or above is left alone
    filled, known, in_heap, count, now, spare_entry, spare_queue = tally  # `now`, the queue in hand, is not in the heap
    now_key, now_sub = queues[now, _KEY], queues[now, _SUB]
    plain = kind == OCTILE and weight == 1.0 and not by_distance
    outcome = _EMPTY
    while True:
        if filled + 8 > entries.shape[0] or known + 8 > queues.shape[0] or count == expanded.shape[0]:
            outcome = _FULL
            break
        entry = queues[now, _FIRST]
        if in_heap > 0 and (entry < 0 or heap[0, 0] < now_key or (heap[0, 0] == now_key and heap[0, 1] < now_sub)):
            other = heap[0, 2]
            in_heap -= 1
            _down(heap, in_heap)
            if entry >= 0:
                _up(heap, in_heap, now_key, now_sub, now)
                in_heap += 1
            else:
                _drop(table, queues, now)
                queues[now, _FIRST], queues[now, _LAST] = spare_queue, -1
                spare_queue = now
            now = other
            now_key, now_sub, entry = queues[now, _KEY], queues[now, _SUB], queues[now, _FIRST]
        if entry < 0:
            break
        node = entries[entry, 0]
        queues[now, _FIRST] = entries[entry, 1]
        entries[entry, 1] = spare_entry
        spare_entry = entry
        if flat[node] & _CLOSED:
            continue
        flat[node] |= _CLOSED
        expanded[count] = node
        count += 1
        if node == goal:
            outcome = _FOUND
            break
        y, x = node // width - 1, node % width - 1
        g = cost[node]
        left = 0x55 if four else 0xFF  # the directions still to be looked at, one bit each
        if pruned and count > 1:
            left = _natural(flat, node, offsets, int(flat[node] & _ENTERED) - 1)
        for d in range(8):
            if not (left >> d) & 1:
                continue
            child = node + offsets[d]
            seen = flat[child]
            if seen >= barred:
                continue
            if strict and d & 1 and (flat[node + offsets[d - 1]] | flat[node + offsets[(d + 1) & 7]]) & _OCCUPIED:
                continue
            if five and not _kept(goal_x - x, goal_y - y, d):
                continue
            cx, cy = x + step_x[d], y + step_y[d]
            if straight_cost:
                ex, ey = cx - start_x, cy - start_y
                new = int(np.rint(np.sqrt(float(ex * ex + ey * ey)) * _STRAIGHT))
            else:
                new = g + (_DIAGONAL if d & 1 else _STRAIGHT)
            if (seen & _ENTERED or child == start) and new >= cost[child]:
                continue
            cost[child] = new
            flat[child] = d + 1
            if plain:
                ax, ay = abs(goal_x - cx), abs(goal_y - cy)
                h = _STRAIGHT * max(ax, ay) + (_DIAGONAL - _STRAIGHT) * min(ax, ay)
            else:
                h = _estimate(
                    goal_x - cx, goal_y - cy, total_x, total_y, kind, weight, by_distance, log_base, resolution
                )
            key = (new + h + _ROUND // 2) // _ROUND
            sub = h if ties == LOW_H else 0
            queue = now
            if key != now_key or sub != now_sub:
                at = _slot(table, queues, key, sub)
                queue = table[at]
                if queue < 0:
                    queue = spare_queue
                    if queue >= 0:
                        spare_queue = queues[queue, _FIRST]
                    else:
                        queue = known
                        known += 1
                    table[at] = queue
                    queues[queue, _KEY], queues[queue, _SUB], queues[queue, _FIRST] = key, sub, -1
                if queues[queue, _FIRST] < 0:
                    _up(heap, in_heap, key, sub, queue)
                    in_heap += 1
            new_entry = spare_entry
            if new_entry >= 0:
                spare_entry = entries[new_entry, 1]
            else:
                new_entry = filled
                filled += 1
            first = queues[queue, _FIRST]
            entries[new_entry, 0], entries[new_entry, 1] = child, -1
            if first < 0:
                queues[queue, _FIRST], queues[queue, _LAST] = new_entry, new_entry
            elif ties == LIFO:
                entries[new_entry, 1] = first
                queues[queue, _FIRST] = new_entry
            else:
                entries[queues[queue, _LAST], 1] = new_entry
                queues[queue, _LAST] = new_entry
    tally[0], tally[1], tally[2], tally[3], tally[4] = filled, known, in_heap, count, now
    tally[5], tally[6] = spare_entry, spare_queue
    return outcome


@njit(cache=True)
def _trace(state: Bytes, ends: Ends) -> Long:
    """Cells (n, 2) x, y from start to goal, by the directions kept in `state`."""
    dx, dy = np.array([0, 1, 1, 1, 0, -1, -1, -1]), np.array([1, 1, 0, -1, -1, -1, 0, 1])
    n = 1
    x, y = ends[2], ends[3]
    while x != ends[0] or y != ends[1]:
        d = int(state[y + 1, x + 1] & _ENTERED) - 1
        x, y = x - dx[d], y - dy[d]
        n += 1
    cells = np.empty((n, 2), dtype=np.int64)
    x, y = ends[2], ends[3]
    for k in range(n - 1, -1, -1):
        cells[k, 0], cells[k, 1] = x, y
        d = int(state[y + 1, x + 1] & _ENTERED) - 1
        if k > 0:
            x, y = x - dx[d], y - dy[d]
    return cells


def _warm() -> None:
    """Compile the kernels on a map of nine cells."""
    state = np.full((5, 5), _OCCUPIED, dtype=np.uint8)
    state[1:4, 1:4] = 0
    _search(state, (0, 0, 2, 2), (OCTILE, False, False, False, False, True, FIFO, False, False), 1.0, 10.0, 1.0)
    _trace(state, (0, 0, 2, 2))
    _kept(1, 1, 0)
