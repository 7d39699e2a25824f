"""Seeded damage for files under test: bytes flipped, the end cut off, a stretch doubled or left out.

>>> import numpy as np
>>> damages(b"Engine: planner", np.random.default_rng(0)) != b"Engine: planner"
True
"""

from __future__ import annotations

import numpy as np

__all__ = ["damages"]


def damages(data: bytes, rng: np.random.Generator) -> bytes:
    """The bytes after one damage of a kind drawn from `rng`; never the bytes themselves.

    The kinds are drawn alike: one to eight bytes replaced by others, everything from some place on cut off, a stretch
    written twice, a stretch left out. Raises ValueError for empty data.
    """
    if not data:
        raise ValueError("empty data cannot be damaged; give at least one byte")
    kind = rng.integers(4)
    if kind == 0:
        return _flipped(data, rng)
    if kind == 1:
        return data[: rng.integers(len(data))]
    first = int(rng.integers(len(data)))
    last = int(rng.integers(first, len(data))) + 1
    return data[:last] + data[first:] if kind == 2 else data[:first] + data[last:]


def _flipped(data: bytes, rng: np.random.Generator) -> bytes:
    """One to eight bytes exclusive-or'd with a number other than 0, each at a place of its own."""
    result = bytearray(data)
    count = min(int(rng.integers(1, 9)), len(data))
    for at in rng.choice(len(data), size=count, replace=False):
        result[at] ^= int(rng.integers(1, 256))
    return bytes(result)
