"""What the documents print: every number, figure, table and equation, read from `data/published/`."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from typing import TypeVar

from fuzzynav.data import folder

__all__ = ["Claim", "Item", "claim", "claims", "item", "items", "parse"]

Entry = TypeVar("Entry")


@dataclass(frozen=True, slots=True)
class Claim:
    """One printed number or statement; `value` is a float, a bool or the printed text."""

    id: str
    source_item: str
    environment: str
    method: str
    quantity: str
    unit: str
    printed: str
    better: str
    note: str

    @property
    def value(self) -> float | bool | str:
        """The printed value; fractions of pi are numbers."""
        return parse(self.printed)

    @property
    def decimals(self) -> int:
        """Number of printed decimals; fractions of pi count as three."""
        if "pi" in self.printed:
            return 3
        return len(self.printed.partition(".")[2]) if isinstance(self.value, float) else 0

    @property
    def is_comparison(self) -> bool:
        """Whether it states a change or a comparison: a rate or a length has no direction."""
        words = "than|below|fewer|better|more|less|shorter|cheaper|reduction|increase|grow"
        return " vs " in self.method or re.search(rf"\b({words})\b", self.quantity) is not None


@dataclass(frozen=True, slots=True)
class Item:
    """One figure, table or equation of a document."""

    id: str
    source: str
    kind: str
    chapter: str
    meaning: str
    reproducible: str
    topic: str
    note: str


def parse(text: str) -> float | bool | str:
    """The printed text as a number or a truth value where it is one.

    >>> parse("24.73"), parse("true"), parse("High"), round(parse("pi/4"), 4)
    (24.73, True, 'High', 0.7854)
    """
    if text in ("true", "false"):
        return text == "true"
    match = re.fullmatch(r"(-?)pi(?:/(\d+))?", text)
    if match:
        return (-1.0 if match[1] else 1.0) * math.pi / int(match[2] or 1)
    try:
        return float(text)
    except ValueError:
        return text


@cache
def claims() -> dict[str, Claim]:
    """Every claim by id, in file order."""
    return {row[0]: Claim(*row) for row in _rows("claims.csv", len(fields(Claim)))}


@cache
def items() -> dict[str, Item]:
    """Every figure, table and equation by id, in file order."""
    return {row[0]: Item(*row) for row in _rows("items.csv", len(fields(Item)))}


def claim(claim_id: str) -> Claim:
    """One claim; raises ValueError for an unknown id.

    >>> claim("thesis:c-3.4-S1-TA-len").value
    24.73
    """
    return _known(claims(), claim_id, "claim")


def item(item_id: str) -> Item:
    """One figure, table or equation; raises ValueError for an unknown id."""
    return _known(items(), item_id, "item")


def _rows(name: str, width: int) -> list[list[str]]:
    path = folder("published") / name
    with path.open(encoding="utf-8", newline="") as stream:
        rows = [row for row in csv.reader(stream) if row][1:]
    for number, row in enumerate(rows, start=2):
        if len(row) != width:
            raise ValueError(f"data/published/{name}, row {number}: {width} fields are needed, found {len(row)}")
    return rows


def _known(table_: Mapping[str, Entry], key: str, what: str) -> Entry:
    if key not in table_:
        stem = key.split("-")[0]
        near = [k for k in table_ if k.startswith(stem)][:3]
        raise ValueError(f"there is no published {what} '{key}'; near it: {', '.join(near) or 'nothing'}")
    return table_[key]
