"""Maps drawn with characters, as text or as a `.txt` file. Memory: at most 10 times the file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fuzzynav.maps.mapdata import MapData, check_cells, check_place
from fuzzynav.maps.text import numbers, read_lines, write_whole

__all__ = ["format_ascii", "parse_ascii", "read_ascii", "write_ascii"]

_CELLS = "#. ?"


def parse_ascii(text: str, name: str = "the drawing") -> MapData:
    """Map drawn with '#' occupied, '.' or blank free, '?' unknown; the top line has the highest y.

    Lines `resolution R` and `origin X Y`, each at most once, may stand before the drawing. Raises ValueError with
    the line number.
    """
    return _drawn(text.split("\n"), name)


def _drawn(lines: list[str], name: str) -> MapData:
    lines = [line.rstrip("\r") for line in lines]
    found, first = _places(lines, name)
    rows = lines[first:]
    while rows and not rows[-1]:
        rows.pop()
    if not rows:
        raise ValueError(f"{name}: no cells")
    check_cells(name, len(rows), len(rows[0]))
    for n, row in enumerate(rows, start=first + 1):
        wrong = set(row) - set(_CELLS)
        if wrong:
            raise ValueError(f"{name}, line {n}: {min(wrong)!r} is not one of '#', '.', ' ', '?'")
        if len(row) != len(rows[0]):
            raise ValueError(f"{name}, line {n}: {len(row)} cells, but the first row has {len(rows[0])}")
    codes = np.frombuffer("".join(rows).encode("ascii"), dtype=np.uint8).reshape(len(rows), -1)[::-1]
    unknown = codes == ord("?")
    origin = found.get("origin", (0.0, 0.0))
    return MapData(
        codes == ord("#"),
        found.get("resolution", (1.0,))[0],
        (origin[0], origin[1]),
        unknown if unknown.any() else None,
    )


def _places(lines: list[str], name: str) -> tuple[dict[str, tuple[float, ...]], int]:
    """What the lines before the drawing say of resolution and origin, and the place of its first line."""
    found: dict[str, tuple[float, ...]] = {}
    for first, line in enumerate(lines):
        word, *rest = line.split() or [""]
        where = f"{name}, line {first + 1}"
        if word not in ("resolution", "origin"):
            if line:
                return found, first
            continue
        if word in found:
            raise ValueError(f"{where}: {word} stands here for the second time")
        found[word] = numbers(rest, 1 if word == "resolution" else 2, f"{where}: {word}")
        check_place(where, found[word][0]) if word == "resolution" else check_place(where, origin=found[word])
    return found, len(lines)


def format_ascii(occupied: NDArray[np.bool_], unknown: NDArray[np.bool_] | None = None) -> str:
    """The characters that `parse_ascii` reads, the top line with the highest y."""
    seen = np.where(occupied, "#", ".") if unknown is None else np.where(unknown, "?", np.where(occupied, "#", "."))
    return "\n".join("".join(row) for row in seen[::-1])


def read_ascii(path: str | Path) -> MapData:
    """Map from a text drawing. Raises ValueError with the line number."""
    return _drawn(read_lines(path), str(path))


def write_ascii(path: str | Path, data: MapData) -> None:
    """Write a text drawing, with resolution and origin before it where they are not 1 and 0."""
    head = "" if data.resolution == 1.0 else f"resolution {data.resolution!r}\n"
    if tuple(data.origin) != (0.0, 0.0):
        head += f"origin {float(data.origin[0])!r} {float(data.origin[1])!r}\n"
    write_whole(path, (head + format_ascii(data.occupied, data.unknown) + "\n").encode("ascii"))
