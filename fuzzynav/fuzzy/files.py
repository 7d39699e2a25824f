"""Files of fuzzy systems: FuzzyLite's `.fll` and MATLAB's `.fis`, read and written whole or not at all.

The formats themselves are in `fll`, `fllwriter`, `fis` and `fiswriter`; here stand the opening, the limits and the
errors that all share.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzynav.fuzzy.variable import MAX_RESOLUTION, QUADRATURES

if TYPE_CHECKING:
    from fuzzynav.fuzzy.system import FuzzySystem

__all__ = ["MAX_BYTES", "load", "save"]

MAX_BYTES = 4_000_000
"""Largest file that is read; a rule base of a thousand rules has 200 kB."""


def load(path: str | Path) -> FuzzySystem:
    """Read a fuzzy system from a .fll or .fis file.

    A `.fll` without our `#! quadrature` line gets FuzzyLite's arithmetic (midpoints), a `.fis` gets that of MATLAB's
    evalfis (plain sum of 101 points, the middle of the range where no rule fires): a file means the numbers that its
    own program prints. Raises FileNotFoundError, or ValueError with file, line, field and what would be right.
    """
    path = Path(path)
    kind = _suffix(path)
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    text = _text(path)
    if kind == ".fll":
        from fuzzynav.fuzzy import fll

        return fll.parse(text, str(path))
    from fuzzynav.fuzzy import fis

    return fis.parse(text, str(path))


def save(system: FuzzySystem, path: str | Path) -> None:
    """Write a fuzzy system to a .fll or .fis file.

    `load` gives an equal system back from a .fll, and one with the same answers from a .fis. The file is complete or,
    after an error, as it was before. Raises ValueError for what the format cannot say.
    """
    path = Path(path)
    if _suffix(path) == ".fll":
        from fuzzynav.fuzzy import fllwriter

        text = fllwriter.dump(system)
    else:
        from fuzzynav.fuzzy import fiswriter

        text = fiswriter.dump(system)
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with open(part, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def _suffix(path: Path) -> str:
    kind = path.suffix.lower()
    if kind not in (".fll", ".fis"):
        raise ValueError(f"{path}: a fuzzy system file must end in .fll (FuzzyLite) or .fis (MATLAB), got {kind!r}")
    return kind


def _text(path: Path) -> str:
    """Text of the file with line ends \\n and without a byte order mark."""
    with open(path, "rb") as file:
        raw = file.read(MAX_BYTES + 1)
    if len(raw) > MAX_BYTES:
        raise ValueError(f"{path}: larger than {MAX_BYTES} bytes; a fuzzy system file is text of a few hundred lines")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise ValueError(f"{path}, line {line}: not UTF-8 text (byte {error.start}); save the file as UTF-8") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


# what both parsers share


@contextmanager
def at(where: str, line: int, field: str = "") -> Iterator[None]:
    """Put file, line and field before the message of a ValueError raised inside."""
    try:
        yield
    except ValueError as error:
        raise fault(where, line, field, str(error)) from None


def fault(where: str, line: int, field: str, message: str) -> ValueError:
    """The one form of all errors about a file."""
    return ValueError(f"{where}, line {line}{', ' + field if field else ''}: {message}")


def number(text: str) -> float:
    """Float in any notation (1, .5, 1e-3, inf, -inf, nan). Raises ValueError."""
    try:
        if "_" in text:
            raise ValueError
        return float(text)
    except ValueError:
        raise ValueError(f"expected a number, got {text!r}") from None


def numbers(text: str) -> list[float]:
    """Floats separated by blanks. Raises ValueError."""
    return [number(word) for word in text.split()]


def show(value: float) -> str:
    """Shortest text that reads back as the same float; whole numbers without a point."""
    text = repr(float(value))
    return text.removesuffix(".0")


def boolean(text: str) -> bool:
    """True or false in FuzzyLite's spelling. Raises ValueError."""
    if text not in ("true", "false"):
        raise ValueError(f"expected true or false, got {text!r}")
    return text == "true"


def resolution(text: str) -> int:
    """Number of samples within the bounds. Raises ValueError."""
    if not (text.isascii() and text.isdigit() and len(text) < 10 and 2 <= int(text) <= MAX_RESOLUTION):
        raise ValueError(f"expected a whole number of samples from 2 to {MAX_RESOLUTION}, got {text!r}")
    return int(text)


def one_of(text: str, known: tuple[str, ...]) -> str:
    """The text itself. Raises ValueError that lists the known ones."""
    if text not in known:
        raise ValueError(f"expected one of {', '.join(known)}; got {text!r}")
    return text


def quadrature(text: str) -> str:
    """A known quadrature. Raises ValueError."""
    return one_of(text, QUADRATURES)


def is_plain(text: str) -> bool:
    """Whether the text survives on one line without quotes."""
    return text == text.strip() and text.isprintable() and not text.startswith('"')


def quote(text: str) -> str:
    """The text on one line: as it is, or as a JSON string where it must be."""
    return text if is_plain(text) else json.dumps(text)


def unquote(text: str) -> str:
    """Inverse of `quote`. Raises ValueError for a broken JSON string."""
    if not text.startswith('"'):
        return text
    try:
        value = json.loads(text)
    except (json.JSONDecodeError, RecursionError):
        raise ValueError(f"expected text, or a JSON string in double quotes, got {text!r}") from None
    if not isinstance(value, str):
        raise ValueError(f"expected text, or a JSON string in double quotes, got {text!r}")
    return value


def identifier(name: str) -> str:
    """The name as FuzzyLite reads it: letters, digits and _ only, no digit first."""
    word = "".join(c for c in name if c.isalnum() or c == "_") or "_"
    return f"_{word}" if word[0].isnumeric() else word


def same_number(a: float, b: float) -> bool:
    """Equality in which nan equals nan."""
    return a == b or (math.isnan(a) and math.isnan(b))
