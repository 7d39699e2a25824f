"""MovingAI's `.map` and `.scen` files. Memory: at most 10 times the file for a map, 30 times for scenarios."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from fuzzynav.maps.mapdata import MapData, check_cells, has
from fuzzynav.maps.text import is_number, is_whole, read_lines, shown, write_whole

__all__ = ["Scenario", "read_movingai", "read_scenarios", "write_movingai"]

_PASSABLE, _BLOCKED = ".GS", "@OTW"


class Scenario(NamedTuple):
    """One line of a `.scen` file; cells x, y counted from the lower left, as in GridMap; length in cells."""

    bucket: int
    map_name: str
    shape: tuple[int, int]
    start: tuple[int, int]
    goal: tuple[int, int]
    length: float


def read_movingai(path: str | Path) -> MapData:
    """Map from an octile `.map` file: `.`, G and S are passable; @, O, T and W are blocked.

    Raises ValueError with the line number for anything else, and for a map of more than 25 million cells.
    """
    lines = read_lines(path)
    _expect(path, lines, 0, "type octile")
    height, width = _header_number(path, lines, 1, "height"), _header_number(path, lines, 2, "width")
    _expect(path, lines, 3, "map")
    check_cells(f"{path}, line 3", height, width)
    rows = lines[4:]
    while len(rows) > height and not rows[-1].strip():
        rows.pop()
    if len(rows) != height:
        raise ValueError(f"{path}, line {len(rows) + 4}: {len(rows)} map rows, but the header says height {height}")
    for n, row in enumerate(rows, start=5):
        if len(row) != width:
            raise ValueError(f"{path}, line {n}: {len(row)} cells, but the header says width {width}")
        wrong = set(row) - set(_PASSABLE + _BLOCKED)
        if wrong:
            raise ValueError(f"{path}, line {n}: {min(wrong)!r} is not a terrain; allowed: {_PASSABLE} {_BLOCKED}")
    cells = np.frombuffer("".join(rows).encode("ascii"), dtype=np.uint8).reshape(height, width)
    return MapData(np.isin(cells, np.frombuffer(_BLOCKED.encode("ascii"), dtype=np.uint8))[::-1].copy())


def write_movingai(path: str | Path, data: MapData) -> None:
    """Write an octile `.map`. Raises ValueError if the map has what the format cannot hold."""
    if data.resolution != 1.0 or tuple(data.origin) != (0.0, 0.0) or has(data.unknown):
        raise ValueError(f"{path}: a .map file holds neither resolution, origin nor unknown cells; save a .yaml")
    rows = ["".join("@" if cell else "." for cell in row) for row in data.occupied[::-1]]
    header = ["type octile", f"height {len(rows)}", f"width {len(rows[0])}", "map"]
    write_whole(path, "\n".join([*header, *rows, ""]).encode("ascii"))


def read_scenarios(path: str | Path) -> list[Scenario]:
    """Problems of a `.scen` file of version 1, cells turned to GridMap's count. Raises ValueError with the line."""
    lines = read_lines(path)
    if lines[0].split() not in (["version", "1"], ["version", "1.0"]):
        raise ValueError(f"{path}, line 1: expected 'version 1', got {shown(lines[0])}")
    return [_scenario(path, n, line) for n, line in enumerate(lines[1:], start=2) if line.strip()]


def _scenario(path: str | Path, n: int, line: str) -> Scenario:
    fields = line.split("\t") if "\t" in line else line.split()
    if (
        len(fields) != 9
        or not fields[1]
        or not all(is_whole(word) for word in (fields[0], *fields[2:8]))
        or not is_number(fields[8])
    ):
        raise ValueError(
            f"{path}, line {n}: expected bucket, map, width, height, start x y, goal x y, length and nothing else, "
            f"whole numbers of 0 or more before the length; got {shown(line, 100)}"
        )
    bucket, width, height, sx, sy, gx, gy = (int(word) for word in (fields[0], *fields[2:8]))
    length = float(fields[8])
    if not (sx < width and gx < width and sy < height and gy < height):
        raise ValueError(f"{path}, line {n}: start, goal or both lie outside the {width} x {height} map")
    if not (np.isfinite(length) and length >= 0):
        raise ValueError(f"{path}, line {n}: length must be finite and not negative, got {length}")
    return Scenario(bucket, fields[1], (height, width), (sx, height - 1 - sy), (gx, height - 1 - gy), length)


def _expect(path: str | Path, lines: list[str], n: int, wanted: str) -> None:
    if len(lines) <= n or lines[n].split() != wanted.split():
        got = shown(lines[n]) if len(lines) > n else "the end of the file"
        raise ValueError(f"{path}, line {n + 1}: expected {wanted!r}, got {got}")


def _header_number(path: str | Path, lines: list[str], n: int, word: str) -> int:
    words = lines[n].split() if len(lines) > n else []
    if len(words) != 2 or words[0] != word or not is_whole(words[1]) or int(words[1]) == 0:
        raise ValueError(f"{path}, line {n + 1}: expected '{word} N' with N from 1 to 999999999")
    return int(words[1])
