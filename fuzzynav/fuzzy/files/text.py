"""What the readers and writers of fuzzy system files share: errors with file, line and field, and words to values."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from contextlib import contextmanager

from fuzzynav.fuzzy.variable import MAX_RESOLUTION, QUADRATURES

__all__ = [
    "at",
    "boolean",
    "fault",
    "identifier",
    "is_plain",
    "named",
    "number",
    "numbers",
    "quadrature",
    "quote",
    "resolution",
    "same_number",
    "shortened",
    "show",
    "unquote",
]  # fmt: skip


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
        if "_" in text or not text.isascii():
            raise ValueError
        return float(text)
    except ValueError:
        raise ValueError(f"expected a number, got {shortened(text)!r}") from None


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
        raise ValueError(f"expected true or false, got {shortened(text)!r}")
    return text == "true"


def resolution(text: str) -> int:
    """Number of samples within the bounds. Raises ValueError."""
    if not (text.isascii() and text.isdigit() and len(text) < 10 and 2 <= int(text) <= MAX_RESOLUTION):
        raise ValueError(f"expected a whole number of samples from 2 to {MAX_RESOLUTION}, got {shortened(text)!r}")
    return int(text)


def quadrature(text: str) -> str:
    """A known quadrature. Raises ValueError that lists the known ones."""
    if text not in QUADRATURES:
        raise ValueError(f"expected one of {', '.join(QUADRATURES)}; got {shortened(text)!r}")
    return text


def named(text: str, words: dict[str, str], what: str) -> str:
    """Our name for a word of the format; `words` holds the format's word for each of our names.

    Raises ValueError that lists the known words.
    """
    for ours, theirs in words.items():
        if text == theirs:
            return ours
    raise ValueError(f"unknown {what} {shortened(text)!r}; known: {', '.join(words.values())}")


def shortened(text: str) -> str:
    """The text, or the first 60 letters of a long one."""
    return text if len(text) <= 60 else f"{text[:60]}..."


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
        raise ValueError(f"expected text, or a JSON string in double quotes, got {shortened(text)!r}") from None
    if not isinstance(value, str):
        raise ValueError(f"expected text, or a JSON string in double quotes, got {shortened(text)!r}")
    return value


def identifier(name: str) -> str:
    """The name as FuzzyLite reads it: letters, digits and _ only, no digit first."""
    word = "".join(c for c in name if c.isalnum() or c == "_") or "_"
    return f"_{word}" if word[0].isnumeric() else word


def same_number(a: float, b: float) -> bool:
    """Equality in which nan equals nan."""
    return a == b or (math.isnan(a) and math.isnan(b))
