"""Text files as maps and logs are read from and written to: lines with their numbers, plain numbers, whole files.

A byte-order mark, as some editors put before a text, is passed over in every format.
"""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

__all__ = ["is_number", "is_whole", "numbers", "read_bytes", "read_lines", "shown", "text_of", "write_whole"]

LARGEST_FILE = 200_000_000  # bytes
_NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?", re.ASCII)
_WHOLE = re.compile(r"[0-9]{1,9}", re.ASCII)


def shown(value: object, length: int = 60) -> str:
    """The value as it stands in a message: in ASCII, cut where it is long."""
    text = ascii(value)
    return text if len(text) <= length else text[: length - 3] + "..."


def is_number(word: str) -> bool:
    """Whether a word is a decimal number: digits, point, exponent; no underscore, nothing of another alphabet."""
    return _NUMBER.fullmatch(word) is not None


def is_whole(word: str) -> bool:
    """Whether a word is a whole number from 0 to 999999999."""
    return _WHOLE.fullmatch(word) is not None


def numbers(words: Sequence[str], count: int, what: str) -> tuple[float, ...]:
    """The words as finite floats, or a ValueError that begins with `what`."""
    if len(words) != count or not all(is_number(word) for word in words):
        infinite = any(word.lower().lstrip("+-.") in ("inf", "nan", "infinity") for word in words)
        kind = "finite numbers" if infinite and len(words) == count else f"{count} number(s)"
        raise ValueError(f"{what}: expected {kind}, got {shown(' '.join(words))}")
    values = tuple(float(word) for word in words)
    if not np.isfinite(values).all():
        raise ValueError(f"{what}: expected finite numbers, got {shown(' '.join(words))}")
    return values


def read_bytes(path: str | Path, largest: int = LARGEST_FILE) -> bytes:
    """What a file holds. Raises FileNotFoundError, or another OSError or ValueError, in a sentence with its name."""
    try:
        if not Path(path).is_file():
            raise FileNotFoundError(f"{path}: no such file")
        size = Path(path).stat().st_size
        if size > largest:
            raise ValueError(f"{path}: {size} bytes are more than the {largest} that are read of such a file")
        return Path(path).read_bytes()
    except OSError as error:
        if error.errno is None:
            raise
        raise type(error)(f"{path}: cannot be read: {error.strerror}") from error


def text_of(content: bytes, name: str | Path) -> str:
    """The bytes as text in UTF-8, with or without a byte-order mark. Raises ValueError with the line."""
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise ValueError(f"{name}, line {line}: not a text file ({error.reason} at byte {error.start})") from error


def read_lines(path: str | Path) -> list[str]:
    """Lines of a text file without their ends, LF or CRLF."""
    text = text_of(read_bytes(path), path)
    return [line.removesuffix("\r") for line in text.removesuffix("\n").split("\n")]


def write_whole(path: str | Path, content: bytes) -> None:
    """Write a file whole or not at all. Raises an OSError of the same kind in a sentence where that cannot be done."""
    target = Path(path)
    if not target.parent.is_dir():
        raise FileNotFoundError(f"{path}: the folder {target.parent} does not exist")
    temporary = ""
    try:
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name[:100]}.")
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(temporary, 0o644)
        os.replace(temporary, target)
    except OSError as error:
        if temporary:
            Path(temporary).unlink(missing_ok=True)
        raise type(error)(f"{path}: could not be written: {error.strerror or error}") from error
