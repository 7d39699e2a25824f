"""What a map file holds, and what every format asks of it."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["MapData", "check_cells", "check_place", "has"]

MAX_CELLS = 25_000_000  # of a map that is read from a file or cut finer
FINEST, COARSEST = 1e-6, 1e6  # [m] side of a cell
FARTHEST = 1e9  # [m] corner of a map


class MapData(NamedTuple):
    """What a map file holds; `occupied` and `unknown` are `(rows, cols)` booleans, row 0 lowest."""

    occupied: NDArray[np.bool_]
    resolution: float = 1.0
    origin: tuple[float, float] = (0.0, 0.0)
    unknown: NDArray[np.bool_] | None = None


def has(mask: NDArray[np.bool_] | None) -> bool:
    """Whether any cell of a mask is set."""
    return mask is not None and bool(mask.any())


def check_cells(where: str | Path, rows: int, cols: int) -> None:
    """Raise ValueError for a map of too many cells, before memory is taken for them."""
    if rows * cols > MAX_CELLS:
        raise ValueError(f"{where}: {rows} x {cols} cells are too many, at most {MAX_CELLS} are read")


def check_place(where: str, resolution: float | None = None, origin: tuple[float, ...] = ()) -> None:
    """Raise ValueError, beginning with `where`, for a size of cells or a corner that no map of a robot has."""
    if resolution is not None and not FINEST <= resolution <= COARSEST:
        raise ValueError(f"{where}: resolution must be positive, from {FINEST} to {COARSEST:g} m, got {resolution}")
    if not all(abs(value) <= FARTHEST for value in origin):
        raise ValueError(f"{where}: origin must lie within {FARTHEST:g} m, got {origin}")
