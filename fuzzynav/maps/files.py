"""Readers and writers of map files: MovingAI `.map` and `.scen`, ROS map_server `.yaml` with its image, ASCII.

Every reader returns rows from the lowest y upwards, whatever the order in the file. Every writer writes a temporary
file and renames it, so that a file is whole or untouched.
"""

from __future__ import annotations

import io
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image

__all__ = [
    "MapData",
    "Scenario",
    "format_ascii",
    "load",
    "parse_ascii",
    "read_ascii",
    "read_movingai",
    "read_ros_map",
    "read_scenarios",
    "save",
    "write_ascii",
    "write_movingai",
    "write_ros_map",
]

FREE, OCCUPIED, UNKNOWN = 254, 0, 205  # grey values that map_server's saver writes
OCCUPIED_THRESH, FREE_THRESH = 0.65, 0.196
_PASSABLE, _BLOCKED = ".GS", "@OTW"
_ASCII = {"#": 1, ".": 0, " ": 0, "?": 2}


class MapData(NamedTuple):
    """What a map file holds; `occupied` and `unknown` are `(rows, cols)` booleans, row 0 lowest."""

    occupied: NDArray[np.bool_]
    resolution: float = 1.0
    origin: tuple[float, float] = (0.0, 0.0)
    unknown: NDArray[np.bool_] | None = None


class Scenario(NamedTuple):
    """One line of a `.scen` file; cells x, y counted from the lower left, as in GridMap; length in cells."""

    bucket: int
    map_name: str
    shape: tuple[int, int]
    start: tuple[int, int]
    goal: tuple[int, int]
    length: float


def load(path: str | Path) -> MapData:
    """Read a map by the ending of its name. Raises ValueError for an unknown ending."""
    return _by_ending(path, {".map": read_movingai, ".yaml": read_ros_map, ".yml": read_ros_map, ".txt": read_ascii})(
        path
    )


def save(path: str | Path, data: MapData) -> None:
    """Write a map in the format that the ending of its name asks for. Raises ValueError for an unknown ending."""
    _by_ending(path, {".map": write_movingai, ".yaml": write_ros_map, ".yml": write_ros_map, ".txt": write_ascii})(
        path, data
    )


def _by_ending(path: str | Path, handlers: dict[str, Callable[..., Any]]) -> Callable[..., Any]:
    ending = Path(path).suffix.lower()
    if ending not in handlers:
        hint = "; load the .yaml that names the image" if ending in (".pgm", ".png") else ""
        raise ValueError(f"{path}: a map file ends in {', '.join(handlers)}, not in {ending!r}{hint}")
    return handlers[ending]


# -- MovingAI


def read_movingai(path: str | Path) -> MapData:
    """Map from an octile `.map` file: `.`, G and S are passable; @, O, T and W are blocked.

    Raises ValueError with the line number for anything else.
    """
    lines = _lines(path)
    _expect(path, lines, 0, "type octile")
    height, width = _header_number(path, lines, 1, "height"), _header_number(path, lines, 2, "width")
    _expect(path, lines, 3, "map")
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
    cells = np.array([list(row) for row in rows])
    return MapData(np.isin(cells, list(_BLOCKED))[::-1].copy())


def write_movingai(path: str | Path, data: MapData) -> None:
    """Write an octile `.map`. Raises ValueError if the map has what the format cannot hold."""
    if data.resolution != 1.0 or tuple(data.origin) != (0.0, 0.0) or _has(data.unknown):
        raise ValueError(f"{path}: a .map file holds neither resolution, origin nor unknown cells; save a .yaml")
    rows = ["".join("@" if cell else "." for cell in row) for row in data.occupied[::-1]]
    header = ["type octile", f"height {len(rows)}", f"width {len(rows[0])}", "map"]
    _write(path, "\n".join([*header, *rows, ""]).encode("ascii"))


def read_scenarios(path: str | Path) -> list[Scenario]:
    """Problems of a `.scen` file, cells turned to GridMap's count. Raises ValueError with the line number."""
    lines = _lines(path)
    if not lines or lines[0].split()[:1] != ["version"]:
        raise ValueError(f"{path}, line 1: expected 'version 1'")
    return [_scenario(path, n, line) for n, line in enumerate(lines[1:], start=2) if line.strip()]


def _scenario(path: str | Path, n: int, line: str) -> Scenario:
    fields = line.split("\t") if "\t" in line else line.split()
    try:
        bucket, name = int(fields[0]), fields[1]
        width, height, sx, sy, gx, gy = (int(v) for v in fields[2:8])
        length = float(fields[8])
    except (ValueError, IndexError) as error:
        raise ValueError(
            f"{path}, line {n}: expected bucket, map, width, height, start x y, goal x y, length: {error}"
        ) from error
    if not (0 <= sx < width and 0 <= gx < width and 0 <= sy < height and 0 <= gy < height and np.isfinite(length)):
        raise ValueError(f"{path}, line {n}: start, goal or length lies outside the {width} x {height} map")
    return Scenario(bucket, name, (height, width), (sx, height - 1 - sy), (gx, height - 1 - gy), length)


# -- ASCII


def parse_ascii(text: str, name: str = "the drawing") -> MapData:
    """Map drawn with '#' occupied, '.' or blank free, '?' unknown; the top line has the highest y.

    Lines `resolution R` and `origin X Y` may stand before the drawing. Raises ValueError with the line number.
    """
    lines = [line.rstrip("\r") for line in text.split("\n")]
    resolution, first = 1.0, 0
    origin: tuple[float, ...] = (0.0, 0.0)
    for first, line in enumerate(lines):
        words = line.split()
        if words[:1] == ["resolution"]:
            (resolution,) = _numbers(words[1:], 1, f"{name}, line {first + 1}: resolution")
        elif words[:1] == ["origin"]:
            origin = _numbers(words[1:], 2, f"{name}, line {first + 1}: origin")
        elif line:
            break
    rows = lines[first:]
    while rows and not rows[-1]:
        rows.pop()
    for n, row in enumerate(rows, start=first + 1):
        wrong = set(row) - set(_ASCII)
        if wrong:
            raise ValueError(f"{name}, line {n}: {min(wrong)!r} is not one of '#', '.', ' ', '?'")
        if len(row) != len(rows[0]):
            raise ValueError(f"{name}, line {n}: {len(row)} cells, but the first row has {len(rows[0])}")
    if not rows:
        raise ValueError(f"{name}: no cells")
    codes = np.array([[_ASCII[c] for c in row] for row in rows[::-1]])
    return MapData(codes == 1, resolution, (origin[0], origin[1]), codes == 2 if (codes == 2).any() else None)


def format_ascii(occupied: NDArray[np.bool_], unknown: NDArray[np.bool_] | None = None) -> str:
    """The characters that `parse_ascii` reads, the top line with the highest y."""
    seen = np.where(occupied, "#", ".") if unknown is None else np.where(unknown, "?", np.where(occupied, "#", "."))
    return "\n".join("".join(row) for row in seen[::-1])


def read_ascii(path: str | Path) -> MapData:
    """Map from a text drawing. Raises ValueError with the line number."""
    return parse_ascii("\n".join(_lines(path)), str(path))


def write_ascii(path: str | Path, data: MapData) -> None:
    """Write a text drawing, with resolution and origin before it where they are not 1 and 0."""
    head = "" if data.resolution == 1.0 else f"resolution {data.resolution!r}\n"
    if tuple(data.origin) != (0.0, 0.0):
        head += f"origin {float(data.origin[0])!r} {float(data.origin[1])!r}\n"
    _write(path, (head + format_ascii(data.occupied, data.unknown) + "\n").encode("ascii"))


# -- ROS map_server


def read_ros_map(path: str | Path) -> MapData:
    """Map from a map_server `.yaml` and the image that it names, in trinary mode.

    occ = (255 - p) / 255, or p / 255 with negate; above occupied_thresh a cell is occupied, below free_thresh free,
    else unknown. The image must lie inside the folder of the `.yaml`. Raises ValueError naming file and field.
    """
    fields = _yaml_fields(path)
    if fields.get("mode", "trinary") != "trinary":
        raise ValueError(f"{path}: mode: only trinary is read, got {fields['mode']!r}")
    (resolution,) = _numbers([fields["resolution"]], 1, f"{path}: resolution")
    if resolution <= 0:
        raise ValueError(f"{path}: resolution must be positive, got {resolution}")
    x, y, yaw = _numbers(fields["origin"], 3, f"{path}: origin")
    if yaw != 0.0:
        raise ValueError(f"{path}: origin: a turned map (yaw {yaw}) is not read; the third number must be 0")
    (negate,) = _numbers([fields.get("negate", 0)], 1, f"{path}: negate")
    if negate not in (0.0, 1.0):
        raise ValueError(f"{path}: negate must be 0 or 1, got {negate}")
    (high,) = _numbers([fields.get("occupied_thresh", OCCUPIED_THRESH)], 1, f"{path}: occupied_thresh")
    (low,) = _numbers([fields.get("free_thresh", FREE_THRESH)], 1, f"{path}: free_thresh")
    if not 0 <= low <= high <= 1:
        raise ValueError(f"{path}: free_thresh {low} and occupied_thresh {high} must rise within 0 .. 1")
    grey = _grey(path, fields["image"])
    chance = (grey if negate else 255.0 - grey) / 255.0
    occupied = chance > high
    unknown = ~occupied & ~(chance < low)
    return MapData(occupied[::-1].copy(), resolution, (x, y), unknown[::-1].copy() if unknown.any() else None)


def _yaml_fields(path: str | Path) -> dict[str, Any]:
    try:
        fields = yaml.safe_load("\n".join(_lines(path)))
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f", line {mark.line + 1}" if mark else ""
        raise ValueError(f"{path}{where}: not readable as YAML: {getattr(error, 'problem', error)}") from error
    if not isinstance(fields, dict):
        raise ValueError(f"{path}: expected fields image, resolution, origin")
    for needed in ("image", "resolution", "origin"):
        if needed not in fields:
            raise ValueError(f"{path}: field {needed!r} is missing")
    return fields


def _grey(path: str | Path, name: Any) -> NDArray[np.float64]:
    """Grey values `(rows, cols)` of the image beside a yaml file, channels averaged as map_server does."""
    folder = Path(path).resolve().parent
    if not isinstance(name, str) or not name:
        raise ValueError(f"{path}: image must be a file name, got {name!r}")
    image = (folder / name).resolve()
    if not image.is_relative_to(folder):
        raise ValueError(f"{path}: image {name!r} lies outside the folder of the yaml file")
    if not image.is_file():
        raise FileNotFoundError(f"{path}: image {name!r} is not there")
    try:
        with Image.open(image, formats=("PPM", "PNG")) as picture:
            mode = {"1": "L", "P": "RGB"}.get(picture.mode, picture.mode)
            if mode not in ("L", "LA", "RGB", "RGBA"):
                raise ValueError(f"{mode} pixels, expected 8 bits a channel")
            pixels = np.asarray(picture.convert(mode), dtype=float)
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise ValueError(f"{path}: image {name!r} is damaged or not a PGM or PNG: {error}") from error
    return pixels if pixels.ndim == 2 else pixels.mean(axis=-1)


def write_ros_map(path: str | Path, data: MapData, image: str = ".pgm") -> None:
    """Write a map_server `.yaml` and, beside it, its `.pgm` or `.png` with the values 254, 0 and 205."""
    if image not in (".pgm", ".png"):
        raise ValueError(f"image must be '.pgm' or '.png', got {image!r}")
    grey = np.where(data.occupied, OCCUPIED, FREE).astype(np.uint8)
    if data.unknown is not None:
        grey[data.unknown] = UNKNOWN
    picture, target = io.BytesIO(), Path(path).with_suffix(image)
    Image.fromarray(np.ascontiguousarray(grey[::-1])).save(picture, format="PPM" if image == ".pgm" else "PNG")
    fields = {
        "image": target.name,
        "resolution": float(data.resolution),
        "origin": [float(data.origin[0]), float(data.origin[1]), 0.0],
        "negate": 0,
        "occupied_thresh": OCCUPIED_THRESH,
        "free_thresh": FREE_THRESH,
    }
    text = yaml.safe_dump(fields, sort_keys=False, default_flow_style=None)
    _write(target, picture.getvalue())
    _write(path, text.encode("utf-8"))


# -- shared


def _has(mask: NDArray[np.bool_] | None) -> bool:
    return mask is not None and bool(mask.any())


def _lines(path: str | Path) -> list[str]:
    """Lines of a text file without their ends, LF or CRLF."""
    file = Path(path)
    if not file.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    try:
        text = file.read_bytes().decode("utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not a text file ({error.reason} at byte {error.start})") from error
    return [line.removesuffix("\r") for line in text.removesuffix("\n").split("\n")]


def _expect(path: str | Path, lines: list[str], n: int, wanted: str) -> None:
    if len(lines) <= n or lines[n].split() != wanted.split():
        got = repr(lines[n]) if len(lines) > n else "the end of the file"
        raise ValueError(f"{path}, line {n + 1}: expected {wanted!r}, got {got}")


def _header_number(path: str | Path, lines: list[str], n: int, word: str) -> int:
    words = lines[n].split() if len(lines) > n else []
    if len(words) != 2 or words[0] != word or not words[1].isdecimal() or int(words[1]) == 0:
        raise ValueError(f"{path}, line {n + 1}: expected '{word} N' with N of at least 1")
    return int(words[1])


def _numbers(values: Any, count: int, what: str) -> tuple[float, ...]:
    """The values as finite floats, or a ValueError that begins with `what`."""
    if not isinstance(values, list | tuple) or len(values) != count:
        raise ValueError(f"{what}: expected {count} number(s), got {values!r}")
    try:
        numbers = tuple(float(v) for v in values)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{what}: expected {count} number(s), got {values!r}") from error
    if not np.isfinite(numbers).all():
        raise ValueError(f"{what}: expected finite numbers, got {values!r}")
    return numbers


def _write(path: str | Path, content: bytes) -> None:
    """Write a file whole or not at all."""
    target = Path(path)
    if not target.parent.is_dir():
        raise FileNotFoundError(f"{path}: the folder {target.parent} does not exist")
    handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(temporary, 0o644)
        os.replace(temporary, target)
    except OSError:
        Path(temporary).unlink(missing_ok=True)
        raise
