"""Fuzzy systems on disk: FuzzyLite's `.fll` and MATLAB's `.fis`, read and written whole or not at all.

The formats themselves are in `fll`, `fll_writer`, `fis` and `fis_writer`; here stand the opening and the limits.
"""

from __future__ import annotations

import os
from pathlib import Path

from fuzzynav.fuzzy.files import fis, fis_writer, fll, fll_writer
from fuzzynav.fuzzy.system import FuzzySystem

__all__ = ["MAX_BYTES", "load", "save"]

MAX_BYTES = 1_000_000
"""Largest file that is read; a rule base of a thousand rules has 200 kB."""

_FORMATS = {".fll": (fll.parse, fll_writer.dump), ".fis": (fis.parse, fis_writer.dump)}


def load(path: str | Path) -> FuzzySystem:
    """Read a fuzzy system from a .fll or .fis file.

    A `.fll` without our `#! quadrature` line gets FuzzyLite's arithmetic (midpoints), a `.fis` gets that of MATLAB's
    evalfis (plain sum of 101 points, the middle of the range where no rule fires): a file means the numbers that its
    own program prints. Raises FileNotFoundError, PermissionError, or ValueError with file, line, field and what would
    be right.
    """
    path = Path(path)
    parse, _ = _FORMATS[_suffix(path)]
    return parse(_text(path), str(path))


def save(system: FuzzySystem, path: str | Path) -> None:
    """Write a fuzzy system to a .fll or .fis file.

    `load` gives an equal system back from a .fll, and one with the same answers from a .fis. The file is complete or,
    after an error, as it was before. Raises ValueError for what the format cannot say, FileNotFoundError for a folder
    that does not exist, PermissionError for one that may not be written to.
    """
    path = Path(path)
    _, dump = _FORMATS[_suffix(path)]
    text = dump(system)
    if not path.parent.is_dir():
        raise FileNotFoundError(f"{path}: the folder {path.parent} does not exist")
    if path.is_dir():
        raise IsADirectoryError(f"{path}: there is a folder of that name")
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with open(part, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
        os.replace(part, path)
    except PermissionError:
        raise PermissionError(f"{path}: the folder {path.parent} may not be written to") from None
    finally:
        part.unlink(missing_ok=True)


def _suffix(path: Path) -> str:
    kind = path.suffix.lower()
    if kind not in _FORMATS:
        raise ValueError(f"{path}: a fuzzy system file must end in .fll (FuzzyLite) or .fis (MATLAB), got {kind!r}")
    return kind


def _text(path: Path) -> str:
    """Text of the file with line ends \\n and without a byte order mark."""
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    try:
        with open(path, "rb") as file:
            raw = file.read(MAX_BYTES + 1)
    except PermissionError:
        raise PermissionError(f"{path}: the file may not be read") from None
    if len(raw) > MAX_BYTES:
        line = raw.count(b"\n") + 1
        raise ValueError(
            f"{path}, line {line}: larger than {MAX_BYTES} bytes; a fuzzy system file is text of a few hundred lines"
        )
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise ValueError(f"{path}, line {line}: not UTF-8 text (byte {error.start}); save the file as UTF-8") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")
