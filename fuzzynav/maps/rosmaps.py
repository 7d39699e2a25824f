"""Maps of ROS map_server: a `.yaml` file and the image that it names.

Of YAML only what such a file needs is read: one block of fields, each a plain value or a list of plain values. So no
anchor, nesting or tag can make a small file large. Memory: the `.yaml` has at most 20 kB, the image at most
25 million cells, 12 bytes for each.
"""

from __future__ import annotations

import io
import struct
import warnings
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image

from fuzzynav.maps.mapdata import MAX_CELLS, MapData, check_place
from fuzzynav.maps.text import numbers, read_bytes, shown, text_of, write_whole

__all__ = ["read_ros_map", "write_ros_map"]

FREE, OCCUPIED, UNKNOWN = 254, 0, 205  # grey values that map_server's saver writes
OCCUPIED_THRESH, FREE_THRESH = 0.65, 0.196
_FIELDS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode")
_LARGEST_YAML, _MOST_BRACKETS = 20_000, 10  # bytes of the file, opened in one line of it
_BROKEN = (OSError, SyntaxError, ValueError, EOFError, struct.error, zlib.error, OverflowError, IndexError, KeyError)


class _Field(NamedTuple):
    """The values of a field as they are written, whether they were a list or in quotes, and where they stand."""

    words: list[str]
    is_list: bool
    quoted: bool
    line: int


def read_ros_map(path: str | Path) -> MapData:
    """Map from a map_server `.yaml` and the image that it names, in trinary mode.

    occ = (255 - p) / 255, or p / 255 with negate; above occupied_thresh a cell is occupied, below free_thresh free,
    else unknown. The image must lie inside the folder of the `.yaml`. Raises ValueError naming file, line and field.
    """
    fields = _fields(path)
    mode = fields.get("mode")
    if mode is not None and mode.words != ["trinary"]:
        raise ValueError(f"{path}, line {mode.line}: mode: only trinary is read, got {shown(mode.words)}")
    (resolution,) = _numbers(path, fields, "resolution", 1)
    check_place(f"{path}, line {fields['resolution'].line}", resolution)
    x, y, yaw = _numbers(path, fields, "origin", 3)
    check_place(f"{path}, line {fields['origin'].line}", origin=(x, y))
    if yaw != 0.0:
        raise ValueError(f"{path}: origin: a turned map (yaw {yaw}) is not read; the third number must be 0")
    high = _numbers(path, fields, "occupied_thresh", 1)[0] if "occupied_thresh" in fields else OCCUPIED_THRESH
    low = _numbers(path, fields, "free_thresh", 1)[0] if "free_thresh" in fields else FREE_THRESH
    if not 0 <= low <= high <= 1:
        raise ValueError(f"{path}: free_thresh {low} and occupied_thresh {high} must rise within 0 .. 1")
    grey, channels = _grey(path, fields["image"])
    shade = np.arange(255 * channels + 1) / channels
    chance = (shade if _negate(path, fields) else 255.0 - shade) / 255.0
    occupied, free = (chance > high)[grey], (chance < low)[grey]
    unknown = ~occupied & ~free
    return MapData(occupied[::-1].copy(), resolution, (x, y), unknown[::-1].copy() if unknown.any() else None)


def _numbers(path: str | Path, fields: dict[str, _Field], name: str, count: int) -> tuple[float, ...]:
    """One field as finite numbers, or a ValueError."""
    field = fields[name]
    where = f"{path}, line {field.line}: {name}"
    if field.is_list != (count > 1):
        wanted = f"a list of {count} numbers" if count > 1 else "1 number(s), not a list"
        raise ValueError(f"{where}: expected {wanted}, got {shown(field.words)}")
    if field.quoted:
        raise ValueError(f"{where}: expected {count} number(s) without quotes, got {shown(field.words)}")
    found = numbers(field.words, count, where)
    for word in field.words:
        if len(word.lstrip("+-")) > 1 and word.lstrip("+-")[0] == "0" and word.lstrip("+-")[1].isdigit():
            raise ValueError(f"{where}: a number does not begin with a 0 before other digits, got {shown(word)}")
    return found


def _negate(path: str | Path, fields: dict[str, _Field]) -> bool:
    """The field negate: 0 or 1, or as ROS 2 writes it, false or true."""
    field = fields.get("negate", _Field(["0"], False, False, 0))
    said = {"0": False, "1": True, "0.0": False, "1.0": True, "false": False, "true": True}
    word = field.words[0].lower() if len(field.words) == 1 else ""
    if field.is_list or field.quoted or word not in said:
        raise ValueError(f"{path}, line {field.line}: negate must be 0 or 1, got {shown(field.words)}")
    return said[word]


def _fields(path: str | Path) -> dict[str, _Field]:
    """The fields of the file by their names. Raises ValueError with the line."""
    text = text_of(read_bytes(path, _LARGEST_YAML), path)
    found: dict[str, _Field] = {}
    for name, field in _pairs(_events(text, path), path):
        if name in found:
            raise ValueError(f"{path}, line {field.line}: field {name!r} stands here for the second time")
        if name not in _FIELDS:
            raise ValueError(f"{path}, line {field.line}: {shown(name)} is not one of {', '.join(_FIELDS)}")
        found[name] = field
    for needed in ("image", "resolution", "origin"):
        if needed not in found:
            raise ValueError(f"{path}: field {needed!r} is missing")
    return found


def _events(text: str, path: str | Path) -> Iterator[yaml.Event]:
    """What the YAML says, piece by piece; raises ValueError with the line where it cannot be read."""
    for n, line in enumerate(text.split("\n"), start=1):
        if line.count("[") + line.count("{") > _MOST_BRACKETS:
            raise ValueError(f"{path}, line {n}: not readable as YAML of a map: over {_MOST_BRACKETS} brackets open")
    try:
        yield from yaml.parse(text, Loader=yaml.SafeLoader)
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        mark = getattr(error, "problem_mark", None)
        where = f", line {mark.line + 1}" if mark else ""
        what = " ".join(str(getattr(error, "problem", None) or getattr(error, "reason", None) or error).split())
        raise ValueError(f"{path}{where}: not readable as YAML: {what[:200]}") from error


def _pairs(events: Iterator[yaml.Event], path: str | Path) -> Iterator[tuple[str, _Field]]:
    """Names and fields of the one block in a stream of YAML events; raises ValueError for anything else."""
    for wanted in (yaml.StreamStartEvent, yaml.DocumentStartEvent, yaml.MappingStartEvent):
        event = next(events)
        if not isinstance(event, wanted):
            raise ValueError(f"{path}: expected fields image, resolution, origin")
    _bare(event, path)
    while not isinstance(event := next(events), yaml.MappingEndEvent):
        name, line = _scalar(event, path).value, event.start_mark.line + 1
        event = next(events)
        if isinstance(event, yaml.SequenceStartEvent):
            _bare(event, path)
            inside: list[yaml.ScalarEvent] = []
            while not isinstance(event := next(events), yaml.SequenceEndEvent):
                inside.append(_scalar(event, path))
            yield name, _Field([e.value for e in inside], True, any(e.style for e in inside), line)
        else:
            scalar = _scalar(event, path)
            yield name, _Field([scalar.value], False, bool(scalar.style), line)
    next(events)
    if not isinstance(event := next(events), yaml.StreamEndEvent):
        raise ValueError(f"{path}, line {event.start_mark.line + 1}: a second document begins here, one is read")


def _bare(event: yaml.Event, path: str | Path) -> None:
    """Refuse anchors, aliases and tags."""
    if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None) or getattr(event, "tag", None):
        line = event.start_mark.line + 1
        raise ValueError(f"{path}, line {line}: not readable as YAML of a map: anchors, aliases and tags are not read")


def _scalar(event: yaml.Event, path: str | Path) -> yaml.ScalarEvent:
    """The event if it is one bare value; raises ValueError otherwise."""
    _bare(event, path)
    if not isinstance(event, yaml.ScalarEvent):
        line = event.start_mark.line + 1
        raise ValueError(f"{path}, line {line}: a field holds one value or one list of values, nothing deeper")
    return event


def _grey(path: str | Path, field: _Field) -> tuple[NDArray[np.integer], int]:
    """Sum of the channels `(rows, cols)` of the image beside a yaml file, and their number: map_server averages."""
    image, name = _image(path, field)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with Image.open(image, formats=("PPM", "PNG")) as picture:
                if picture.width * picture.height > MAX_CELLS:
                    raise ValueError(f"{picture.height} x {picture.width} cells, at most {MAX_CELLS} are read")
                mode = {"1": "L", "P": "RGB"}.get(picture.mode, picture.mode)
                if mode not in ("L", "LA", "RGB", "RGBA"):
                    raise ValueError(f"{mode} pixels, expected 8 bits a channel")
                pixels = np.asarray(picture.convert(mode))
    except (*_BROKEN, Image.DecompressionBombError, Warning) as error:
        raise ValueError(
            f"{path}: image {shown(name)} is damaged or not a PGM or PNG: {shown(str(error), 200)}"
        ) from error
    return (pixels, 1) if pixels.ndim == 2 else (pixels.sum(axis=-1, dtype=np.uint16), pixels.shape[2])


def _image(path: str | Path, field: _Field) -> tuple[Path, str]:
    """Where the image lies, and its name."""
    name = field.words[0] if field.words and not field.is_list else ""
    kinds = [] if field.quoted else yaml.SafeLoader.yaml_implicit_resolvers.get(name[:1], [])
    if not name or any(pattern.match(name) for _, pattern in kinds):
        raise ValueError(f"{path}, line {field.line}: image must be a file name, got {shown(field.words)}")
    folder = Path(path).resolve().parent
    try:
        image = (folder / name).resolve()
        inside, there = image.is_relative_to(folder), image.is_file()
    except (OSError, RuntimeError, ValueError) as error:
        why = shown(getattr(error, "strerror", None) or str(error), 100)
        raise ValueError(f"{path}, line {field.line}: image {shown(name)} cannot be a file: {why}") from error
    if not inside:
        raise ValueError(f"{path}: image {shown(name)} lies outside the folder of the yaml file")
    if not there:
        raise FileNotFoundError(f"{path}: image {shown(name)} is not there")
    return image, name


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
    write_whole(target, picture.getvalue())
    write_whole(path, text.encode("utf-8"))
