"""The open list of the compiled search: cells wait in queues by f, and a heap holds each value of f once.

A cell is pushed and taken in constant time wherever values of f repeat, as they do on a grid. Queues and their entries
are used again once empty, which keeps them in the cache. The queue in hand, from which cells are taken, stands outside
the heap; a hash table finds the queue of any other value.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__: list[str] = []

Short = NDArray[np.int32]
Long = NDArray[np.int64]

FIFO, LIFO, LOW_H = range(3)  # which of the cells with equal f is taken first
CELL, NEXT = range(2)  # of an entry
KEY, SUB, FIRST, LAST = range(4)  # of a queue: f, second key, first and last entry, -1 for none
QUEUE = 2  # of a place in the heap, after KEY and SUB
ENTRIES, QUEUES = range(2)  # the first two of the tally
ROOM = 8  # what may be pushed between two looks at the room that is left: a cell has eight neighbours


class Open(NamedTuple):
    """The arrays of an open list.

    tally: entries and queues ever used, queues in the heap, the queue in hand, and the first entry and the first queue
    that are free to be used again, -1 for none.
    """

    entries: Short  # (n, 2)
    queues: Long  # (m, 4)
    heap: Long  # (m, 3)
    table: Short  # (power of 2,) queue or -1
    tally: Long  # (6,)


@njit(cache=True)
def opened(cell: int, key: int, sub: int) -> Open:
    """An open list that holds one cell."""
    entries, queues = np.empty((256, 2), dtype=np.int32), np.empty((128, 4), dtype=np.int64)
    heap, table = np.empty((128, 3), dtype=np.int64), np.full(512, -1, dtype=np.int32)
    entries[0] = cell, -1
    queues[0] = key, sub, 0, 0
    table[slot(table, queues, key, sub)] = 0
    return Open(entries, queues, heap, table, np.array([1, 1, 0, 0, -1, -1]))


@njit(cache=True)
def grown(waiting: Open) -> Open:
    """The same list with room for more."""
    entries, queues, heap, table, tally = waiting
    if tally[ENTRIES] + ROOM > entries.shape[0]:
        entries = longer(entries)
    if tally[QUEUES] + ROOM > queues.shape[0]:
        queues, heap = longer(queues), longer(heap)
        table = np.full(2 * table.shape[0], -1, dtype=np.int32)
        for queue in range(tally[QUEUES]):
            if queues[queue, LAST] >= 0:
                table[slot(table, queues, queues[queue, KEY], queues[queue, SUB])] = queue
    return Open(entries, queues, heap, table, tally)


@njit(cache=True)
def longer(array: NDArray[Any]) -> NDArray[Any]:
    """The same array with room for twice as much."""
    out = np.empty((2 * array.shape[0],) + array.shape[1:], dtype=array.dtype)
    out[: array.shape[0]] = array
    return out


@njit(cache=True)
def before(key: int, sub: int, other_key: int, other_sub: int) -> bool:
    """Whether one pair of keys comes before another."""
    return key < other_key or (key == other_key and sub < other_sub)


@njit(cache=True)
def up(heap: Long, size: int, key: int, sub: int, queue: int) -> None:
    """Put one queue into the heap of `size`."""
    at = size
    while at > 0:
        above = (at - 1) >> 1
        if not before(key, sub, heap[above, KEY], heap[above, SUB]):
            break
        heap[at, KEY], heap[at, SUB], heap[at, QUEUE] = heap[above, KEY], heap[above, SUB], heap[above, QUEUE]
        at = above
    heap[at, KEY], heap[at, SUB], heap[at, QUEUE] = key, sub, queue


@njit(cache=True)
def down(heap: Long, size: int) -> None:
    """Close the gap at the top of the heap with its last element; `size` is what remains."""
    key, sub, queue = heap[size, KEY], heap[size, SUB], heap[size, QUEUE]
    at = 0
    while 2 * at + 1 < size:
        below = 2 * at + 1
        if below + 1 < size and before(heap[below + 1, KEY], heap[below + 1, SUB], heap[below, KEY], heap[below, SUB]):
            below += 1
        if not before(heap[below, KEY], heap[below, SUB], key, sub):
            break
        heap[at, KEY], heap[at, SUB], heap[at, QUEUE] = heap[below, KEY], heap[below, SUB], heap[below, QUEUE]
        at = below
    heap[at, KEY], heap[at, SUB], heap[at, QUEUE] = key, sub, queue


@njit(cache=True)
def _home(key: int, sub: int, mask: int) -> int:
    """First place in the hash table to look at."""
    return (key ^ (key >> 9) ^ (key >> 21) ^ (sub >> 15) ^ (sub >> 27)) & mask


@njit(cache=True)
def slot(table: Short, queues: Long, key: int, sub: int) -> int:
    """Place in the hash table that holds the queue of (key, sub), or the free one where it belongs."""
    mask = table.shape[0] - 1
    at = _home(key, sub, mask)
    while table[at] >= 0 and (queues[table[at], KEY] != key or queues[table[at], SUB] != sub):
        at = (at + 1) & mask
    return at


@njit(cache=True)
def drop(table: Short, queues: Long, queue: int) -> None:
    """Take an empty queue out of the hash table and close the gap."""
    mask = table.shape[0] - 1
    hole = slot(table, queues, queues[queue, KEY], queues[queue, SUB])
    at = (hole + 1) & mask
    while table[at] >= 0:
        home = _home(queues[table[at], KEY], queues[table[at], SUB], mask)
        if ((at - home) & mask) >= ((at - hole) & mask):
            table[hole] = table[at]
            hole = at
        at = (at + 1) & mask
    table[hole] = -1


def _warm() -> None:
    """Compile the list."""
    waiting = grown(opened(1, 2, 0))
    up(waiting.heap, 0, 1, 0, 0)
    down(waiting.heap, 0)
    drop(waiting.table, waiting.queues, 0)
