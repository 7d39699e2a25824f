"""The flat tables of a fuzzy system: packed into two arrays for the way into compiled code, and named again inside.

Every array that crosses from Python costs a call some tenths of a microsecond; a name inside a kernel costs nothing.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fuzzynav.geometry import Array

__all__ = ["Parts", "Tables", "pack", "unpack"]

Codes = NDArray[np.int64]


class Tables(NamedTuple):
    """A fuzzy system as compiled code takes it (`FuzzySystem.tables`, for `engine.infer_one`); read-only."""

    codes: Codes
    numbers: Array


class Parts(NamedTuple):
    """The tables by name; i counts inputs, o outputs, t terms (inputs' first), r rules, s concluded sets.

    The columns have names in `codes`. An output that is sampled has rows in `sampled`, an exact one corners in `knots`
    and the lines between them.
    """

    n_input_terms: int
    terms: Codes  # (t, 4): SHAPE, OWNER, FIRST, PAIRS
    propositions: Codes  # (p, 1 + hedges): TERM (-1: any), FIRST_HEDGE ...
    program: Codes  # (k, 5): an operation and its operands
    consequents: Codes  # (c, 2 + hedges): RULE, SET, FIRST_CONCLUSION_HEDGE ..., sorted by set
    slots: Codes  # (s, 4): SLOT_OUTPUT, SLOT_TERM, IMPLICATION, MERGE
    outputs: Codes  # (o, 6): FIRST_SET, SETS, AGGREGATION, DEFUZZIFIER, QUADRATURE, SAMPLES
    ranges: Array  # (i, 3): LOW, HIGH, LOCKED
    numbers: Array  # (t, 5): up to four parameters, HEIGHT
    lists: Array  # (l,) numbers of discrete and linear terms
    weights: Array  # (r,)
    settings: Array  # (o, 6): low, high, default, centre, lock_range, lock_previous
    sampled: Array  # (o, 2 + sets, samples): PLACES from the centre, WEIGHTS, FIRST_ROW ...
    knots: Array  # (o, m)
    lines: Array  # (o, m - 1, sets, 2)


N_PARTS = len(Parts._fields) - 1
HEAD = 1 + 5 * N_PARTS  # the number of input terms; then of each part where it begins, and four sizes


def pack(parts: Parts) -> Tables:
    """The parts, end to end, in two read-only arrays; `unpack` is the inverse."""
    head = np.zeros((N_PARTS, 5), dtype=np.int64)
    at = {"i": HEAD, "f": 0}
    flat: dict[str, list[Any]] = {"i": [np.array([parts.n_input_terms]), head.reshape(-1)], "f": []}
    for place, part in zip(head, parts[1:], strict=True):
        kind = part.dtype.kind
        place[:] = [at[kind], *part.shape, *[1] * (4 - part.ndim)]
        at[kind] += part.size
        flat[kind].append(part.reshape(-1))
    tables = Tables(np.concatenate(flat["i"]).astype(np.int64), np.concatenate(flat["f"]))
    for array in tables:
        array.setflags(write=False)
    return tables


@njit(cache=True)
def _line(flat: Any, place: Codes) -> Any:
    return flat[place[0] : place[0] + place[1]]


@njit(cache=True)
def _table(flat: Any, place: Codes) -> Any:
    return flat[place[0] : place[0] + place[1] * place[2]].reshape(place[1], place[2])


@njit(cache=True)
def _block(flat: Array, place: Codes) -> Array:
    size = place[1] * place[2] * place[3]
    return flat[place[0] : place[0] + size].reshape(place[1], place[2], place[3])


@njit(cache=True)
def _blocks(flat: Array, place: Codes) -> Array:
    size = place[1] * place[2] * place[3] * place[4]
    return flat[place[0] : place[0] + size].reshape(place[1], place[2], place[3], place[4])


@njit(cache=True)
def unpack(codes: Codes, numbers: Array) -> Parts:
    """The parts of packed tables, as views."""
    head = codes[1:HEAD].reshape(N_PARTS, 5)
    return Parts(
        codes[0], _table(codes, head[0]), _table(codes, head[1]), _table(codes, head[2]), _table(codes, head[3]),
        _table(codes, head[4]), _table(codes, head[5]), _table(numbers, head[6]), _table(numbers, head[7]),
        _line(numbers, head[8]), _line(numbers, head[9]), _table(numbers, head[10]), _block(numbers, head[11]),
        _table(numbers, head[12]), _blocks(numbers, head[13]),
    )  # fmt: skip


def _warm() -> None:
    whole, real = np.zeros((1, 1), np.int64), np.zeros((1, 1))
    parts = Parts(
        1, whole, whole, whole, whole, whole, whole, real, real, real[0], real[0], real, real[None], real,
        real[None, None],
    )  # fmt: skip
    unpack(*pack(parts))
