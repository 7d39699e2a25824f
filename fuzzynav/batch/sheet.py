"""The text form of a sweep: what the rows are, the names of the columns, one record a row; nothing is lost in it.

The first line is `# ` and a JSON object: the label of the experiment, under "text" the columns that hold texts, and in
a finished file under "rows" a checksum of all that follows. Other cells hold a whole number, a decimal number, True,
False, or nothing for nan. `complete` is 1 in a case's last row. A text that a spreadsheet would run as a formula, or
that begins with an apostrophe, is written with an apostrophe before it; reading takes it away.
"""

from __future__ import annotations

import csv
import hashlib
import io
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

__all__ = ["Row", "Sheet", "Value", "checksum_of", "decoded", "encoded", "frame", "plain", "read", "record", "sheet_of"]

Row = Mapping[str, Any]
Value = str | bool | int | float
FORMULA = ("=", "+", "-", "@", "\t", "\r", "'")
LONGEST = 100_000  # characters of a text, digits of a number: what readers of CSV files stand
RESERVED = ("case", "complete")


@dataclass(slots=True)
class Sheet:
    """What a file says: its label, the columns without `case` and `complete`, those that hold texts, rows by case.

    `whole` is False if the last case was cut off, `checksum` the text's own claim about its rows, "" without one.
    """

    label: dict[str, Any]
    columns: list[str]
    text: frozenset[str]
    rows: dict[str, list[dict[str, Value]]]
    whole: bool
    checksum: str


# --- cells -------------------------------------------------------------------------------------


def plain(value: object, column: str) -> Value:
    """A value as a text, a truth value, a whole or a decimal number; ValueError for anything else."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, str):
        if len(value) > LONGEST or any("\ud800" <= c <= "\udfff" for c in value):
            raise ValueError(f"column {column!r} holds a text too long or with half a character: it cannot be kept")
        return str(value)
    if isinstance(value, bool | float):
        return value
    if isinstance(value, int) and value.bit_length() < 10_000:
        return int(value)
    raise ValueError(
        f"column {column!r} holds {type(value).__name__} {str(value)[:60]!r}: give a text, a number (nan for a "
        "missing one) or a truth value"
    )


def _cell(value: Value) -> str:
    if isinstance(value, str):
        value = f"'{value}" if value.startswith(FORMULA) else value
        return '"' + value.replace('"', '""') + '"' if not value or any(c in value for c in ',"\r\n') else value
    if isinstance(value, float):
        return "" if math.isnan(value) else repr(float(value))
    return str(value)


def _number(cell: str) -> Value:
    if cell in ("", "True", "False"):
        return cell == "True" if cell else math.nan
    return float(cell) if any(c in cell for c in ".en") else int(cell)


def _text(cell: str) -> str:
    return cell[1:] if cell.startswith("'") else cell


def record(values: Iterable[Value]) -> str:
    """One record with its end of line."""
    return ",".join(map(_cell, values)) + "\n"


# --- files -------------------------------------------------------------------------------------


def _body(sheet: Sheet) -> str:
    """Everything below the first line."""
    lines = [record([*RESERVED[:1], *sheet.columns, *RESERVED[1:]])]
    for case, rows in sheet.rows.items():
        lines += [record([case, *row.values(), int(k == len(rows) - 1)]) for k, row in enumerate(rows)]
    return "".join(lines)


def checksum_of(sheet: Sheet) -> str:
    """What must stand in the first line for all that follows it."""
    return hashlib.sha256(_body(sheet).encode()).hexdigest()[:16]


def encoded(sheet: Sheet, closed: bool) -> str:
    """The whole text of a file; `closed` adds the checksum."""
    body = _body(sheet)
    head = {**sheet.label, "text": [c for c in sheet.columns if c in sheet.text]}
    if closed:
        head["rows"] = hashlib.sha256(body.encode()).hexdigest()[:16]
    return f"# {json.dumps(head, ensure_ascii=False)}\n{body}"


def decoded(data: bytes, name: str) -> Sheet:
    """A file's content read; a record cut off at its end, and a case without its last row, are left out.

    Raises ValueError, with the file's name and line, for a text that is no sweep.
    """
    head, _, body = _unicode(data, name).partition("\n")
    label = _label(head, name)
    text, claimed = frozenset(label.pop("text")), label.pop("rows", "")
    reader = csv.reader(io.StringIO(body, newline=""))
    names = next(reader, [])
    if names[:1] != ["case"] or names[-1:] != ["complete"]:
        return Sheet(label, [], text, {}, False, claimed)
    columns, rows, case_rows, whole = names[1:-1], {}, [], True
    kinds = [_text if c in text else _number for c in columns]
    for cells in reader:
        if len(cells) != len(names) or cells[-1] not in ("0", "1"):
            line = reader.line_num + 1
            if next(reader, None) is not None:
                raise ValueError(f"{name}, line {line}: {len(names)} fields are needed, found {len(cells)}")
            whole = False
            break
        case_rows.append({c: kind(cell) for c, kind, cell in zip(columns, kinds, cells[1:-1])})
        if cells[-1] == "1":
            rows[_text(cells[0])] = case_rows
            case_rows = []
    return Sheet(label, columns, text, rows, whole and not case_rows and body.endswith("\n"), claimed)


def _unicode(data: bytes, name: str) -> str:
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        if error.start < len(data) - 4:
            raise ValueError(f"{name} is not a sweep: byte {error.start} is not UTF-8") from None
        return data[: error.start].decode("utf-8")  # cut inside a character


def _label(head: str, name: str) -> dict[str, Any]:
    try:
        label = json.loads(head.removeprefix("# "))
    except ValueError:
        label = None
    if not isinstance(label, dict) or not isinstance(label.get("text"), list):
        raise ValueError(f"{name} does not begin with the line that says what a sweep's rows are: name another file")
    return label


def sheet_of(path: str | Path) -> Sheet:
    """The content of a sweep's CSV file. Raises FileNotFoundError with what would make it."""
    path = Path(path)
    if not path.exists():
        raise FileNotFoundError(f"{path.name} is not there yet: `make reproduce` runs the study that writes it")
    return decoded(path.read_bytes(), path.name)


def read(path: str | Path) -> pd.DataFrame:
    """The rows of a sweep's CSV file, of complete cases only, each value as the experiment gave it.

    Raises FileNotFoundError with what would make it, ValueError for a file that is no sweep.
    """
    path = Path(path)
    if path.exists():
        quick = _quickly(path.read_bytes(), path.name)
        if quick is not None:
            return quick
    sheet = sheet_of(path)
    return frame(sheet.rows, sheet.rows)


def _quickly(data: bytes, name: str) -> pd.DataFrame | None:
    """A finished file cut into cells by pandas' own parser, ten times as fast; None where that might lose something."""
    label = _label(data.partition(b"\n")[0].decode("utf-8", "replace"), name)
    if "rows" not in label or not data.endswith(b"\n") or b"\0" in data or b"\r" in data:
        return None
    table = pd.read_csv(io.BytesIO(data), skiprows=1, dtype="str", keep_default_na=False)
    for column in table:
        cells = table[column].tolist()
        kind = _text if column in ("case", *label["text"]) else _number
        values = {cell: kind(cell) for cell in set(cells)}
        table[column] = _column([values[cell] for cell in cells])
    return table.drop(columns="complete")


def frame(rows: Mapping[str, Sequence[Mapping[str, Value]]], cases: Iterable[str]) -> pd.DataFrame:
    """The rows of some cases as a table with the column `case` first."""
    flat = [(case, row) for case in cases for row in rows[case]]
    columns: dict[str, Any] = {"case": pd.Series([case for case, _ in flat], dtype="str")}
    for name in flat[0][1] if flat else ():
        columns[name] = _column([row[name] for _, row in flat])
    return pd.DataFrame(columns)


def _column(values: list[Value]) -> pd.Series[Any]:
    """One column; whole numbers that a float or 64 bits cannot hold stay Python's own."""
    kinds = set(map(type, values))
    if kinds == {str}:
        return pd.Series(values, dtype="str")
    whole = [v for v in values if isinstance(v, int)]
    if kinds <= {int, float} and max(map(abs, whole), default=0) < (2**53 if float in kinds else 2**63):
        return pd.Series(values, dtype=float if float in kinds else int)
    return pd.Series(values, dtype=bool if kinds == {bool} else object)
