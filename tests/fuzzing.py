"""Seeded damage for files under test: bytes flipped or exchanged, the end cut off, a stretch doubled or left out.

>>> import numpy as np
>>> damages(b"Engine: planner", np.random.default_rng(0)) != b"Engine: planner"
True
"""

from __future__ import annotations

import numpy as np

__all__ = ["damages"]


def damages(data: bytes, rng: np.random.Generator) -> bytes:
    """The bytes after one damage of a kind drawn from `rng`; never the bytes themselves.

    The kinds are drawn alike: one to eight bytes turned into any others, or into bytes that occur elsewhere in the
    data (text stays text), everything from some place on cut off, a stretch written twice, a stretch left out; short
    stretches are as likely as long ones. Raises ValueError for empty data.
    """
    if not data:
        raise ValueError("empty data cannot be damaged; give at least one byte")
    kind = rng.integers(5)
    if kind < 2:
        return _exchanged(data, rng, known=kind == 1)
    if kind == 2:
        return data[: rng.integers(len(data))]
    first = int(rng.integers(len(data)))
    last = first + int(np.exp(rng.uniform(0.0, np.log(len(data) - first))) + 0.5)
    return data[:last] + data[first:] if kind == 3 else data[:first] + data[last:]


def _exchanged(data: bytes, rng: np.random.Generator, known: bool) -> bytes:
    """One to eight bytes, each at a place of its own, made other ones: `known` ones of the data, or any."""
    result = bytearray(data)
    count = min(int(rng.integers(1, 9)), len(data))
    for at in rng.choice(len(data), size=count, replace=False):
        others = sorted(set(data) - {data[at]}) if known else []
        result[at] = others[rng.integers(len(others))] if others else data[at] ^ int(rng.integers(1, 256))
    return bytes(result)
