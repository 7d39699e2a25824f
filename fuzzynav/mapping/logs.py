"""Recorded robot logs as pose graphs: a reader of g2o and TORO text, and the log of the MIT Killian Court.

The package rtb-data brings the Killian log: 3873 laser scans and 4987 measured motions between the poses.
"""

from __future__ import annotations

import struct
import zipfile
import zlib
from array import array
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import resources
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fuzzynav.geometry import Array, read_only
from fuzzynav.maps.text import is_whole, read_bytes, shown, text_of

__all__ = ["ScanLog", "killian", "parse_g2o", "read_g2o"]

LARGEST = 100_000_000  # bytes of text
LONGEST_LINE = 1_000_000  # characters
SMALL, RATIO = 1_000_000, 20  # bytes that an archive may always unpack to, and how many times its own size
_SCAN_HEAD = 9  # words of a ROBOTLASER1 line before its ranges, with the tag
# order of the upper triangle of the information matrix, over x, y, theta
_G2O, _TORO = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)), ((0, 0), (0, 1), (1, 1), (2, 2), (0, 2), (1, 2))
_BROKEN = (
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    NotImplementedError,
    RuntimeError,
    OSError,
    EOFError,
    ValueError,
    LookupError,
    OverflowError,
)


@dataclass(frozen=True, slots=True, eq=False)
class ScanLog:
    """Poses, measured motions between them, and one laser scan at each pose (no scans: zero beams).

    Pose `edges[k, 1]` was measured from pose `edges[k, 0]` as `motions[k]`, with the information (inverse
    covariance) `information[k]`. A range is nan where the scanner reported none. The arrays are read-only.
    """

    poses: Array  # (n, 3) as stored in the file
    edges: NDArray[np.int64]  # (m, 2)
    motions: Array  # (m, 3) in the frame of the first pose
    information: Array  # (m, 3, 3)
    angles: Array  # (b,) [rad] in the body frame
    ranges: Array  # (n, b) [m]
    range_max: float  # [m]

    def __post_init__(self) -> None:
        for name in ("poses", "motions", "information", "angles", "ranges"):
            object.__setattr__(self, name, read_only(getattr(self, name)))
        object.__setattr__(self, "edges", read_only(self.edges, np.int64))

    @property
    def odometry_edges(self) -> NDArray[np.bool_]:
        """Which edges `(m,)` join a pose to the next one."""
        return np.asarray(self.edges[:, 1] - self.edges[:, 0] == 1)


@dataclass(slots=True)
class _Parts:
    """What has been read so far: flat numbers, eight bytes each, and the lines they stand in."""

    name: str
    poses: array[float] = field(default_factory=lambda: array("d"))
    pose_lines: array[int] = field(default_factory=lambda: array("q"))
    edges: array[int] = field(default_factory=lambda: array("q"))  # from, to
    edge_lines: array[int] = field(default_factory=lambda: array("q"))
    motions: array[float] = field(default_factory=lambda: array("d"))
    information: array[float] = field(default_factory=lambda: array("d"))  # 3 x 3 each
    head: list[float] = field(default_factory=list)  # of every scan: what stands before its ranges
    ranges: array[float] = field(default_factory=lambda: array("d"))
    scans: int = 0

    def refuse(self, line: int, what: str) -> ValueError:
        """The error that names the line."""
        return ValueError(f"{self.name}, line {line}: {what}")


def killian() -> ScanLog:
    """The log of the MIT Killian Court: about 2 km through the ground floor, 180 beams to a scan.

    Raises FileNotFoundError if the package rtb-data is not installed.
    """
    try:
        archive = resources.files("rtbdata") / "data" / "killian.g2o.zip"
        content = archive.read_bytes()
    except (ModuleNotFoundError, FileNotFoundError) as error:
        raise FileNotFoundError("the Killian log comes with the package rtb-data: pip install rtb-data") from error
    return parse_g2o(_from_archive(content, "killian.g2o.zip"), "killian.g2o")


def read_g2o(path: str | Path) -> ScanLog:
    """Log from a `.g2o` or TORO text file, or from a `.zip` that holds one.

    Memory: at most 15 times the text, which has at most 100 MB; an archive may unpack to 20 times its own size, or
    1 MB. Raises ValueError with file and line for what cannot be read, FileNotFoundError where there is no file.
    """
    content = read_bytes(path, LARGEST)
    zipped = Path(path).suffix.lower() == ".zip"
    return parse_g2o(_from_archive(content, str(path)) if zipped else text_of(content, path), str(path))


def _from_archive(content: bytes, name: str) -> str:
    """The text of the one log in an archive, read in memory and no further than it may be long."""
    longest = min(max(SMALL, RATIO * len(content)), LARGEST)
    with _intact(name):
        archive = zipfile.ZipFile(BytesIO(content))
    member = _the_log(archive, name)
    with _intact(name), archive.open(member) as file:
        told = file.read(longest + 1)
    if len(told) > longest:
        raise ValueError(f"{name}: {shown(member.filename)} unpacks to over {longest} bytes, more than a log does")
    return text_of(told, f"{name}: {shown(member.filename)}")


@contextmanager
def _intact(name: str) -> Iterator[None]:
    """Whatever a damaged archive makes zipfile raise, as a ValueError with the file's name."""
    try:
        yield
    except _BROKEN as error:
        raise ValueError(f"{name}: the archive is damaged: {shown(str(error), 100)}") from error


def _the_log(archive: zipfile.ZipFile, name: str) -> zipfile.ZipInfo:
    """The one log of an archive, if it is stored or deflated in the clear; raises ValueError otherwise."""
    endings = (".g2o", ".toro", ".graph")
    logs = [m for m in archive.infolist() if m.filename.endswith(endings) and not m.filename.startswith("__MACOSX")]
    if len(logs) != 1:
        raise ValueError(f"{name}: expected one .g2o file in the archive, found {len(logs)}")
    if logs[0].flag_bits & 1:
        raise ValueError(f"{name}: {shown(logs[0].filename)} is encrypted")
    if logs[0].compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ValueError(f"{name}: {shown(logs[0].filename)} must be stored or deflated in the archive")
    return logs[0]


def parse_g2o(text: str, name: str = "the log") -> ScanLog:
    """Log from the lines VERTEX_SE2, EDGE_SE2, ROBOTLASER1 of g2o, or VERTEX2 and EDGE2 of TORO.

    Vertices are numbered 0, 1, 2, ... in the order of the file; a scan belongs to the vertex before it. Comments
    and FIX are passed over. Raises ValueError with the line number for anything else, and for a log cut short.

    >>> parse_g2o("VERTEX_SE2 0 0 0 0\\nVERTEX_SE2 1 1 0 0\\nEDGE_SE2 0 1 1 0 0 9 0 0 9 0 99").motions.tolist()
    [[1.0, 0.0, 0.0]]
    """
    parts = _Parts(name)
    readers = {"VERTEX_SE2": _vertex, "VERTEX2": _vertex, "EDGE_SE2": _edge, "EDGE2": _edge, "ROBOTLASER1": _scan}
    for n, line in enumerate(_lines(text.removeprefix("\ufeff")), start=1):
        if len(line) > LONGEST_LINE:
            raise parts.refuse(n, f"over {LONGEST_LINE} characters; is this a log?")
        words = line.split()
        if not words or words[0].startswith("#") or words[0] == "FIX":
            continue
        if words[0] not in readers:
            raise parts.refuse(n, f"{shown(words[0])} is not one of {', '.join(readers)}")
        if not line.isascii() or "_" in line.removeprefix(words[0]):
            raise parts.refuse(n, f"{words[0]}: numbers are plain digits, without underscores")
        readers[words[0]](parts, words, n)
    return _finish(parts)


def _lines(text: str) -> Iterator[str]:
    """The lines one after the other, so that the text is not held twice."""
    start = 0
    while start <= len(text):
        end = text.find("\n", start)
        end = len(text) if end < 0 else end
        yield text[start : min(end, start + LONGEST_LINE + 1)]
        start = end + 1


def _numbers(parts: _Parts, words: list[str], n: int, what: str) -> list[float]:
    """Words as finite floats, or a ValueError that names the line."""
    try:
        values = [float(w) for w in words]
    except ValueError as error:
        raise parts.refuse(n, f"{what}: {str(error)[:100]}") from error
    if not np.isfinite(values).all():
        raise parts.refuse(n, f"{what}: a number is not finite")
    return values


def _whole(parts: _Parts, words: list[str], n: int, what: str) -> list[int]:
    """Words as whole numbers of 0 or more, or a ValueError that names the line."""
    wrong = [w for w in words if not is_whole(w)]
    if wrong:
        raise parts.refuse(n, f"{what} must be whole numbers of 0 or more, got {shown(wrong[0])}")
    return [int(w) for w in words]


def _count(parts: _Parts, words: list[str], n: int, wanted: int) -> None:
    if len(words) != wanted:
        raise parts.refuse(
            n, f"{words[0]} needs {wanted - 1} numbers, this line has {len(words) - 1}; is the log cut here?"
        )


def _vertex(parts: _Parts, words: list[str], n: int) -> None:
    _count(parts, words, n, 5)
    (number,) = _whole(parts, words[1:2], n, "the numbers of vertices")
    if number != len(parts.pose_lines):
        raise parts.refuse(n, f"vertex {number} where {len(parts.pose_lines)} is due")
    parts.poses.extend(_numbers(parts, words[2:], n, words[0]))
    parts.pose_lines.append(n)


def _edge(parts: _Parts, words: list[str], n: int) -> None:
    _count(parts, words, n, 12)
    parts.edges.extend(_whole(parts, words[1:3], n, "the vertices of an edge"))
    parts.edge_lines.append(n)
    values = _numbers(parts, words[3:], n, words[0])
    parts.motions.extend(values[:3])
    matrix = [0.0] * 9
    for (i, j), value in zip(_G2O if words[0] == "EDGE_SE2" else _TORO, values[3:], strict=True):
        matrix[3 * i + j] = matrix[3 * j + i] = value
    parts.information.extend(matrix)


def _scan(parts: _Parts, words: list[str], n: int) -> None:
    """ROBOTLASER1 type start field_of_view step range_max accuracy remission beams ranges ..."""
    if len(words) < _SCAN_HEAD:
        raise parts.refuse(n, "ROBOTLASER1 promises its ranges, but is cut before; is the log cut here?")
    head = _numbers(parts, words[1:_SCAN_HEAD], n, "ROBOTLASER1")
    (beams,) = _whole(parts, words[_SCAN_HEAD - 1 : _SCAN_HEAD], n, "the number of beams")
    told = words[_SCAN_HEAD : _SCAN_HEAD + beams]
    if beams < 1 or len(told) < beams:
        raise parts.refuse(n, f"ROBOTLASER1 promises {beams} ranges, the line has {len(told)}; is the log cut here?")
    if not (head[3] != 0.0 and head[4] > 0.0):
        raise parts.refuse(n, f"the step between beams must not be 0 and the largest range positive, got {head[3:5]}")
    if parts.scans + 1 != len(parts.pose_lines):
        raise parts.refuse(n, "a scan must follow its own vertex")
    if parts.head and head != parts.head:
        raise parts.refuse(n, "the scanner differs from the one of the first scan")
    ranges = _numbers(parts, told, n, "a range")
    if min(ranges) < 0.0:
        raise parts.refuse(n, f"a range is negative: {min(ranges)}")
    parts.head = head
    parts.ranges.extend(ranges)
    parts.scans += 1


def _finish(parts: _Parts) -> ScanLog:
    """The log as arrays, once it is known to be whole."""
    count = len(parts.pose_lines)
    if not count:
        raise ValueError(f"{parts.name}: the log holds no vertex")
    if parts.scans and parts.scans != count:
        raise parts.refuse(parts.pose_lines[parts.scans], f"vertex {parts.scans} has no scan; is the log cut here?")
    if not parts.edges:
        raise parts.refuse(parts.pose_lines[-1], "no edge follows the last vertex; is the log cut here?")
    edges = np.array(parts.edges, dtype=np.int64).reshape(-1, 2)
    wrong = np.flatnonzero((edges >= count).any(axis=1) | (edges[:, 0] == edges[:, 1]))
    if len(wrong):
        first, second = edges[wrong[0]]
        raise parts.refuse(
            parts.edge_lines[wrong[0]], f"edge {first} to {second}, but vertices go from 0 to {count - 1}"
        )
    angles, ranges, range_max = _scanner(parts)
    motions = np.array(parts.motions).reshape(-1, 3)
    return ScanLog(np.array(parts.poses).reshape(-1, 3), edges, motions, _information(parts), angles, ranges, range_max)


def _information(parts: _Parts) -> Array:
    """The information `(m, 3, 3)`, which is the inverse of a covariance and therefore not negative."""
    matrices = np.array(parts.information).reshape(-1, 3, 3)
    scale = np.maximum(np.abs(matrices).max(axis=(1, 2)), np.finfo(float).tiny)
    wrong = np.flatnonzero(np.linalg.eigvalsh(matrices / scale[:, None, None])[:, 0] < -1e-9)
    if len(wrong):
        raise parts.refuse(parts.edge_lines[wrong[0]], "the information of an edge must not be negative")
    return matrices


def _scanner(parts: _Parts) -> tuple[Array, Array, float]:
    """Beam angles [rad], ranges `(n, b)` [m] with nan for no return, and the largest range."""
    if not parts.scans:
        return np.empty(0), np.empty((len(parts.pose_lines), 0)), float("inf")
    _, start, _, step, range_max, *_ = parts.head
    ranges: Array = np.array(parts.ranges).reshape(parts.scans, -1)
    angles: Array = start + step * np.arange(ranges.shape[1], dtype=float)
    return angles, np.where(ranges < range_max, ranges, np.nan), range_max
