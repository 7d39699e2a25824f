"""A long study: run it, see whether its file is current, recompute a sample of it, take it over after a refactoring.

The file `data/results/NAME.csv` says in its first line which study, parameters and code made it, and what the input
files held. It is current if all of that is so now, if it has every case, and if its checksum fits. "Code" is what
`batch.code_of` covers: the experiment and all that it rests on in this package, without layout, comments and places.
"""

from __future__ import annotations

import hashlib
import math
import os
import zlib
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from fuzzynav import batch
from fuzzynav.data import folder

__all__ = ["Study", "accept", "changed", "differences", "label_of", "path_of", "run", "sample", "state"]

CLOCK = 30.0  # factor within which times of two machines, or of one machine under load, are taken to agree
Tolerance = tuple[float, float]  # relative, absolute


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """One long study, written to `data/results/<name>.csv`.

    experiment: from a case to its rows; it also takes the case as the file writes it. cases: these, or a function that
    finds them. parameters: what a reader of the file should know. inputs: files below data/ that the experiment reads.
    timed: columns that hold times of the machine. tolerance: relative and absolute, of numbers recomputed on another
    processor, by the beginning of the case ("" for all others). row: one row by its case and number, where a whole case
    takes long. after: what is made of the finished table.
    """

    name: str
    experiment: batch.Experiment
    cases: Sequence[Any] | Callable[[], Sequence[Any]]
    parameters: Mapping[str, Any] = field(default_factory=dict)
    inputs: tuple[str, ...] = ()
    timed: tuple[str, ...] = ()
    tolerance: Mapping[str, Tolerance] = field(default_factory=lambda: {"": (1e-3, 1e-6)})
    row: Callable[[str, int], batch.Row] | None = None
    after: Callable[[pd.DataFrame], None] | None = None


def path_of(study: Study, place: Path | None = None) -> Path:
    """The file of a study, in data/results or another folder."""
    return (place or folder("results")) / f"{study.name}.csv"


def label_of(study: Study) -> batch.Label:
    """What the first line of a study's file says now."""
    parts = [study.experiment, *([study.cases] if callable(study.cases) else [])]
    codes = [batch.code_of(part.__module__, part.__qualname__) for part in parts]
    inputs = {name: _content(folder(name.split("/")[0]).parent / name) for name in study.inputs}
    code = codes[0] if len(codes) == 1 else hashlib.sha256("".join(codes).encode()).hexdigest()[:16]
    return {"study": study.name, "parameters": dict(study.parameters), "inputs": inputs, "code": code}


def _content(path: Path) -> str:
    """Eight digits for what a file holds; the first line of a study's file does not count."""
    if not path.exists():
        return "missing"
    data = path.read_bytes().replace(b"\r\n", b"\n")
    rows = data.partition(b"\n")[2] if path.suffix == ".csv" else data
    return hashlib.sha256(rows).hexdigest()[:8]


def state(study: Study, place: Path | None = None) -> str:
    """'current', 'missing', 'unfinished', or a sentence that says why the file is stale."""
    path = path_of(study, place)
    if not path.exists():
        return "missing"
    sheet = batch.sheet_of(path)
    reason = batch.refusal(path.name, sheet.label, label_of(study))
    if reason is not None:
        return reason.partition(": name another")[0]
    if sheet.checksum and sheet.checksum != batch.checksum_of(sheet):
        return f"{path.name} was changed by hand: its checksum does not fit its rows"
    absent = not callable(study.cases) and any(str(case) not in sheet.rows for case in study.cases)
    return "unfinished" if absent or not sheet.checksum else "current"


def run(study: Study, fresh: bool = False, processes: int = 1, place: Path | None = None) -> int:
    """Make what is missing or stale, or all if `fresh`; how many rows of the old file changed.

    A new edition grows in `NAME.new.csv` and replaces the old file when it is whole, so that an interruption loses
    neither. Studies of time run in this process alone.
    """
    path = path_of(study, place)
    found = state(study, place)
    if found == "current" and not fresh:
        return 0
    target = path if found in ("missing", "unfinished") else path.with_name(f"{study.name}.new.csv")
    label, cases = label_of(study), study.cases() if callable(study.cases) else study.cases
    if target != path and target.exists() and batch.refusal("", batch.sheet_of(target).label, label):
        target.unlink()  # begun with other code
    if processes == 1 or study.timed:
        table = batch.run(study.experiment, cases, path=target, label=label)
    else:
        with ProcessPoolExecutor(processes) as pool:
            table = batch.run(study.experiment, cases, path=target, label=label, executor=pool)
    moved = 0 if target == path else changed(study, path, target)
    if target != path:
        os.replace(target, path)
    if study.after is not None:
        study.after(table)
    return moved


def changed(study: Study, old: Path, new: Path) -> int:
    """How many rows of the old file the new one has otherwise, or not at all; times may differ as times do."""
    rows = batch.sheet_of(new).rows
    before = batch.sheet_of(old).rows
    return sum(
        k >= len(rows.get(case, ())) or _unlike(study, case, row, rows[case][k], exact=True) is not None
        for case, kept in before.items()
        for k, row in enumerate(kept)
    )


def sample(study: Study, rows: Mapping[str, Sequence[Any]], count: int) -> list[tuple[str, int]]:
    """Cases by a seed of the study's name, in the file's order, and the number of one of the rows of each."""
    rng = np.random.default_rng(zlib.crc32(study.name.encode()))
    cases = list(rows)
    chosen = sorted(rng.choice(len(cases), min(count, len(cases)), replace=False))
    return [(cases[k], int(rng.integers(len(rows[cases[k]])))) for k in chosen]


def differences(study: Study, count: int, exact: bool = False, place: Path | None = None) -> list[str]:
    """Recompute a seeded sample of `count` cases; a sentence for each row that comes out otherwise.

    exact: to the last digit, as on the machine that made the file; else within the study's tolerance.
    """
    stored = batch.sheet_of(path_of(study, place)).rows
    found = []
    for case, which in sample(study, stored, count):
        if study.row is not None:
            pairs = [(stored[case][which], study.row(case, which))]
        else:
            made = study.experiment(case)
            fresh = [made] if isinstance(made, Mapping) else list(made)
            if len(fresh) != len(stored[case]):
                found.append(f"{study.name}, case {case}: {len(stored[case])} rows are stored, {len(fresh)} come out")
            pairs = list(zip(stored[case], fresh, strict=False))
        found += [text for old, new in pairs if (text := _unlike(study, case, old, new, exact))]
    return found


def _unlike(study: Study, case: str, old: batch.Row, new: batch.Row, exact: bool) -> str | None:
    """The first column in which two rows differ, in words; None if they agree."""
    if list(old) != list(new):
        return f"{study.name}, case {case}: the columns are {', '.join(old)}; {', '.join(new)} come out"
    start = max((s for s in study.tolerance if case.startswith(s)), key=len, default="")
    for name, value in old.items():
        within = (0.0, 0.0) if exact else study.tolerance.get(start, (0.0, 0.0))
        if not (_in_time(value, new[name]) if name in study.timed else _near(value, new[name], *within)):
            return f"{study.name}, case {case}: {name} is stored as {value}; {new[name]} comes out"
    return None


def _near(old: Any, new: Any, relative: float, absolute: float) -> bool:
    if isinstance(old, str) or isinstance(new, str):
        return bool(old == new)
    if math.isnan(old) or math.isnan(new):
        return math.isnan(old) and math.isnan(new)
    return bool(old == new) or abs(old - new) <= max(relative * abs(old), absolute)


def _in_time(old: Any, new: Any) -> bool:
    return bool(0.0 < old < CLOCK * new and new < CLOCK * old)


def accept(study: Study, count: int = 10, place: Path | None = None) -> list[str]:
    """After a change of the code that should change no result: if a sample agrees exactly, take the file over.

    Then the first line says the code, parameters and inputs of now. Returns what differs, and leaves the file, if
    anything does. Raises ValueError for a file that is missing, unfinished or changed by hand.
    """
    path = path_of(study, place)
    found = state(study, place)
    sheet = batch.sheet_of(path) if path.exists() else None
    if sheet is None or not sheet.checksum or sheet.checksum != batch.checksum_of(sheet):
        raise ValueError(f"{study.name} cannot be taken over: {found}")
    wrong = differences(study, count, exact=True, place=place)
    if not wrong and found != "current":
        sheet.label = label_of(study)
        batch.write_whole(path, batch.encoded(sheet, closed=True))
    return wrong
