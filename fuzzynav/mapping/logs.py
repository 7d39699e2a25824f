"""Recorded robot logs as pose graphs: a reader of g2o and TORO text, and the log of the MIT Killian Court.

The package rtb-data brings the Killian log: 3873 laser scans and 4987 measured motions between the poses.
"""

from __future__ import annotations

import zipfile
from dataclasses import dataclass, field
from importlib import resources
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fuzzynav.geometry import Array, read_only

__all__ = ["ScanLog", "killian", "parse_g2o", "read_g2o"]

LARGEST = 200_000_000  # bytes of text that are read from an archive
_SCAN_HEAD = 9  # words of a ROBOTLASER1 line before its ranges, with the tag
# order of the upper triangle of the information matrix, over x, y, theta
_G2O, _TORO = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)), ((0, 0), (0, 1), (1, 1), (2, 2), (0, 2), (1, 2))


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
        return self.edges[:, 1] - self.edges[:, 0] == 1


@dataclass(slots=True)
class _Parts:
    """What has been read so far."""

    name: str
    poses: list[list[float]] = field(default_factory=list)
    pose_lines: list[int] = field(default_factory=list)
    edges: list[tuple[int, int, int]] = field(default_factory=list)  # from, to, line
    motions: list[list[float]] = field(default_factory=list)
    information: list[Array] = field(default_factory=list)
    heads: list[tuple[float, ...]] = field(default_factory=list)
    ranges: list[Array] = field(default_factory=list)


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

    Raises ValueError with file and line for what cannot be read, FileNotFoundError where there is no file.
    """
    file = Path(path)
    if not file.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    content = file.read_bytes()
    if file.suffix == ".zip":
        return parse_g2o(_from_archive(content, str(path)), str(path))
    try:
        return parse_g2o(content.decode("ascii"), str(path))
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not a text file (byte {error.start})") from error


def _from_archive(content: bytes, name: str) -> str:
    """The text of the one log in an archive, read in memory."""
    try:
        with zipfile.ZipFile(BytesIO(content)) as archive:
            members = [
                m
                for m in archive.infolist()
                if m.filename.endswith((".g2o", ".toro", ".graph")) and not m.filename.startswith("__MACOSX")
            ]
            if len(members) != 1:
                raise ValueError(f"{name}: expected one .g2o file in the archive, found {len(members)}")
            if members[0].file_size > LARGEST:
                raise ValueError(f"{name}: {members[0].filename} has over {LARGEST} bytes")
            return archive.read(members[0]).decode("ascii")
    except (zipfile.BadZipFile, UnicodeDecodeError, EOFError) as error:
        raise ValueError(f"{name}: the archive is damaged: {error}") from error


def parse_g2o(text: str, name: str = "the log") -> ScanLog:
    """Log from the lines VERTEX_SE2, EDGE_SE2, ROBOTLASER1 of g2o, or VERTEX2 and EDGE2 of TORO.

    Vertices are numbered 0, 1, 2, ... in the order of the file; a scan belongs to the vertex before it. Comments
    and FIX are passed over. Raises ValueError with the line number for anything else, and for a log cut short.

    >>> parse_g2o("VERTEX_SE2 0 0 0 0\\nVERTEX_SE2 1 1 0 0\\nEDGE_SE2 0 1 1 0 0 9 0 0 9 0 99").motions.tolist()
    [[1.0, 0.0, 0.0]]
    """
    parts = _Parts(name)
    readers = {"VERTEX_SE2": _vertex, "VERTEX2": _vertex, "EDGE_SE2": _edge, "EDGE2": _edge, "ROBOTLASER1": _scan}
    for n, line in enumerate(text.split("\n"), start=1):
        words = line.split()
        if not words or words[0].startswith("#") or words[0] == "FIX":
            continue
        if words[0] not in readers:
            raise ValueError(f"{name}, line {n}: {words[0]!r} is not one of {', '.join(readers)}")
        readers[words[0]](parts, words, n)
    return _finish(parts)


def _numbers(parts: _Parts, words: list[str], n: int, what: str) -> list[float]:
    """Words as finite floats, or a ValueError that names the line."""
    try:
        values = [float(w) for w in words]
    except ValueError as error:
        raise ValueError(f"{parts.name}, line {n}: {what}: {error}") from error
    if not np.isfinite(values).all():
        raise ValueError(f"{parts.name}, line {n}: {what}: a number is not finite")
    return values


def _count(parts: _Parts, words: list[str], n: int, wanted: int) -> None:
    if len(words) != wanted:
        raise ValueError(
            f"{parts.name}, line {n}: {words[0]} needs {wanted - 1} numbers, this line has "
            f"{len(words) - 1}; is the log cut here?"
        )


def _vertex(parts: _Parts, words: list[str], n: int) -> None:
    _count(parts, words, n, 5)
    number, *pose = _numbers(parts, words[1:], n, words[0])
    if number != len(parts.poses):
        raise ValueError(f"{parts.name}, line {n}: vertex {words[1]} where {len(parts.poses)} is due")
    parts.poses.append(pose)
    parts.pose_lines.append(n)


def _edge(parts: _Parts, words: list[str], n: int) -> None:
    _count(parts, words, n, 12)
    first, second, *rest = _numbers(parts, words[1:], n, words[0])
    parts.edges.append((int(first), int(second), n))
    parts.motions.append(rest[:3])
    matrix = np.zeros((3, 3))
    for (i, j), value in zip(_G2O if words[0] == "EDGE_SE2" else _TORO, rest[3:], strict=True):
        matrix[i, j] = matrix[j, i] = value
    parts.information.append(matrix)


def _scan(parts: _Parts, words: list[str], n: int) -> None:
    """ROBOTLASER1 type start field_of_view step range_max accuracy remission beams ranges ..."""
    head = _numbers(parts, words[1:_SCAN_HEAD], n, "ROBOTLASER1")
    if len(head) < _SCAN_HEAD - 1 or head[-1] < 1 or len(words) < _SCAN_HEAD + int(head[-1]):
        promised = int(head[-1]) if len(head) == _SCAN_HEAD - 1 else "its"
        raise ValueError(
            f"{parts.name}, line {n}: ROBOTLASER1 promises {promised} ranges, the line has "
            f"{max(len(words) - _SCAN_HEAD, 0)}; is the log cut here?"
        )
    if len(parts.ranges) + 1 != len(parts.poses):
        raise ValueError(f"{parts.name}, line {n}: a scan must follow its own vertex")
    if parts.heads and tuple(head) != parts.heads[0]:
        raise ValueError(f"{parts.name}, line {n}: the scanner differs from the one of the first scan")
    parts.heads.append(tuple(head))
    parts.ranges.append(np.array(_numbers(parts, words[_SCAN_HEAD : _SCAN_HEAD + int(head[-1])], n, "a range")))


def _finish(parts: _Parts) -> ScanLog:
    """The log as arrays, once it is known to be whole."""
    if not parts.poses:
        raise ValueError(f"{parts.name}: the log holds no vertex")
    if parts.ranges and len(parts.ranges) != len(parts.poses):
        raise ValueError(
            f"{parts.name}, line {parts.pose_lines[len(parts.ranges)]}: vertex {len(parts.ranges)} has no "
            "scan; is the log cut here?"
        )
    if not parts.edges:
        raise ValueError(
            f"{parts.name}, line {parts.pose_lines[-1]}: no edge follows the last vertex; is the log cut here?"
        )
    for first, second, n in parts.edges:
        if not (0 <= first < len(parts.poses) and 0 <= second < len(parts.poses) and first != second):
            raise ValueError(
                f"{parts.name}, line {n}: edge {first} to {second}, but vertices go from 0 to {len(parts.poses) - 1}"
            )
    angles, ranges, range_max = _scanner(parts)
    return ScanLog(
        np.array(parts.poses),
        np.array([e[:2] for e in parts.edges]),
        np.array(parts.motions),
        np.array(parts.information),
        angles,
        ranges,
        range_max,
    )


def _scanner(parts: _Parts) -> tuple[Array, Array, float]:
    """Beam angles [rad], ranges `(n, b)` [m] with nan for no return, and the largest range."""
    if not parts.ranges:
        return np.empty(0), np.empty((len(parts.poses), 0)), float("inf")
    _, start, _, step, range_max, *_ = parts.heads[0]
    ranges: Array = np.stack(parts.ranges)
    if (ranges < 0).any():
        raise ValueError(f"{parts.name}: a range is negative")
    angles: Array = start + step * np.arange(ranges.shape[1], dtype=float)
    return angles, np.where(ranges < range_max, ranges, np.nan), range_max
