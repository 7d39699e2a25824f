"""Run an experiment over many cases; every row that came is kept, whatever happens to the others."""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, as_completed
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd
from tqdm import tqdm

from fuzzynav.batch.identity import ADDRESS, Label, label_of, refusal
from fuzzynav.batch.retry import once_more
from fuzzynav.batch.sheet import FORMULA, RESERVED, Row, Sheet, Value, decoded, encoded, frame, plain, record
from fuzzynav.batch.writer import only_writer

__all__ = ["Experiment", "run", "write_whole"]

Experiment = Callable[[Any], Row | Sequence[Row]]
Outcome = tuple[Any, list[dict[str, Any]], BaseException | None]  # a case, its rows, what it raised


def run(
    experiment: Experiment,
    cases: Sequence[Any],
    *,
    executor: Executor | None = None,
    path: str | Path | None = None,
    label: Label | None = None,
    chunk: int = 8,
    progress: bool = True,
) -> pd.DataFrame:
    """Table of what `experiment` returns for every case, in the order of `cases`.

    executor: None runs here on one core; otherwise any concurrent.futures executor (processes,
    `dask.distributed.Client(...).get_executor()`, mpi4py). path: a CSV file to which rows are added as they come; cases
    already in it are not run again, and other cases in it stay. The table is the same for every executor and however
    often the sweep was interrupted. The file's first line names the experiment, its parameters and its code: by
    `label_of`, or as `label` says.

    A case whose worker died is tried again, twice by itself. Raises ValueError for repeated cases, an empty list, a
    file of another experiment, parameter or code, or one that is being written; RuntimeError when cases failed: it
    names the first one, and all the other rows are in the file.
    """
    keys = _keys(cases)
    if chunk < 1:
        raise ValueError(f"chunk must be at least 1, got {chunk}")
    with contextlib.ExitStack() as stack:
        if path is not None:
            stack.enter_context(only_writer(Path(path)))
        store = _Store(None if path is None else Path(path), {} if path is None else label or label_of(experiment))
        left = [case for case, key in zip(cases, keys, strict=True) if key not in store.sheet.rows]
        failed: list[tuple[Any, BaseException]] = []
        with tqdm(
            total=len(keys), initial=len(keys) - len(left), disable=not progress, unit="case", leave=False
        ) as bar:
            for case, rows, error in _results(experiment, left, executor, chunk):
                if error is not None:
                    failed.append((case, error))
                else:
                    store.add(str(case), rows)
                bar.update()
        if failed:
            case, error = failed[0]
            message = f"{len(failed)} of {len(keys)} cases failed; the first, {case!r}: {type(error).__name__}: {error}"
            raise RuntimeError(message) from error
        return store.finish(keys, bool(left))


def _keys(cases: Sequence[Any]) -> list[str]:
    """How the cases are written; ValueError where that does not tell one from another."""
    keys = [str(case) for case in cases]
    if not keys:
        raise ValueError("no cases to run: give at least one seed or world")
    if len(set(keys)) != len(keys):
        raise ValueError("some cases print alike: each must be unlike the others, so that a sweep can resume")
    for case, key in zip(cases, keys, strict=True):
        if not isinstance(case, str) and ADDRESS.search(key):
            raise ValueError(f"the case {key[:80]} prints a place in memory, so that no sweep with it can resume: "
                             "give it a __str__, or use a seed")  # fmt: skip
        plain(key, "case")
    return keys


# --- running -----------------------------------------------------------------------------------


def _results(experiment: Experiment, cases: Sequence[Any], executor: Executor | None, chunk: int) -> Iterator[Outcome]:
    """Outcomes as they come."""
    work = partial(_run_chunk, experiment)
    if executor is None:
        for case in cases:
            yield from work([case])
        return
    lost: list[Any] = []  # cases whose chunk did not come back
    broken = False
    futures: dict[Future[Any], list[Any]] = {}
    try:
        for part in (list(cases[k : k + chunk]) for k in range(0, len(cases), chunk)):
            try:
                futures[executor.submit(work, part)] = part
            except BrokenExecutor:
                lost += part
                broken = True
        for future in as_completed(futures):
            error = future.exception()
            if error is None:
                yield from future.result()
            else:
                lost += futures[future]
                broken = broken or isinstance(error, BrokenExecutor)
        for case, outcome, death in once_more(work, lost, executor, broken):
            yield from [(case, [], death)] if outcome is None else outcome
    finally:
        for future in futures:
            future.cancel()


def _run_chunk(experiment: Experiment, cases: Sequence[Any]) -> list[Outcome]:
    """Every case of one chunk; what a case raises travels back beside the others' rows."""
    done: list[Outcome] = []
    for case in cases:
        try:
            rows = experiment(case)
        except Exception as error:  # whatever a reader's controller raises costs its own case only
            done.append((case, [], error))
        else:
            done.append((case, [dict(rows)] if isinstance(rows, Mapping) else [dict(row) for row in rows], None))
    return done


# --- keeping -----------------------------------------------------------------------------------


class _Store:
    """Rows by case, mirrored record by record in a CSV file when there is one."""

    def __init__(self, path: Path | None, label: Label) -> None:
        self.path = path
        self.sheet = Sheet(json.loads(json.dumps(label)), [], frozenset(), {}, True, "")
        if path is not None and path.exists():
            self._load(path)

    def _load(self, path: Path) -> None:
        found = decoded(path.read_bytes(), path.name)
        reason = refusal(path.name, found.label, self.sheet.label)
        if reason is not None:
            raise ValueError(reason)
        self.sheet = found
        if not found.whole:  # what an interruption cut off is run again
            write_whole(path, encoded(found, closed=False))

    def add(self, key: str, rows: list[dict[str, Any]]) -> None:
        """Keep the rows of one case, and append them to the file."""
        if not rows:
            raise ValueError(f"the experiment returned no row for case {key}")
        kept = [{name: plain(value, str(name)) for name, value in row.items()} for row in rows]
        if not self.sheet.columns:
            self._begin(kept[0])
        for row in kept:
            self._check(key, row)
        self.sheet.rows[key] = kept
        if self.path is not None:
            if self.sheet.checksum:  # the file is open again
                self.sheet.checksum = ""
                write_whole(self.path, encoded(self.sheet, closed=False))
                return
            lines = [record([key, *row.values(), int(k == len(kept) - 1)]) for k, row in enumerate(kept)]
            with self.path.open("a", encoding="utf-8", newline="") as file:
                file.write("".join(lines))

    def _begin(self, row: dict[str, Value]) -> None:
        """Take the columns of the first row, and write the file's first lines."""
        bad = [n for n in row if not isinstance(n, str) or not n or n.startswith(FORMULA) or n in RESERVED or "\n" in n]
        if bad or not row:
            what = f"a column {bad[0]!r}" if bad else "no column"
            raise ValueError(
                f"a row has {what}: names are texts that begin with a letter, other than case and complete"
            )
        self.sheet.columns = list(row)
        self.sheet.text = frozenset(name for name, value in row.items() if isinstance(value, str))
        if self.path is not None:
            write_whole(self.path, encoded(self.sheet, closed=False))

    def _check(self, key: str, row: dict[str, Value]) -> None:
        if list(row) != self.sheet.columns:
            raise ValueError(
                f"case {key} has columns {list(row)}, the earlier ones {self.sheet.columns}: rows must be alike"
            )
        for name, value in row.items():
            if isinstance(value, str) != (name in self.sheet.text):
                kinds = ("a text", "numbers") if isinstance(value, str) else ("a number", "texts")
                raise ValueError(f"case {key}: column {name!r} holds {kinds[0]} here and {kinds[1]} before")

    def finish(self, keys: Sequence[str], added: bool) -> pd.DataFrame:
        """The table in the order of `keys`; rows of other cases come before them in the file."""
        rows = self.sheet.rows
        if self.path is not None and (added or not self.sheet.checksum):
            mine = set(keys)
            others = [key for key in rows if key not in mine]
            self.sheet.rows = {key: rows[key] for key in (*others, *keys)}
            write_whole(self.path, encoded(self.sheet, closed=True))
        return frame(rows, keys)


def write_whole(path: Path, text: str) -> None:
    """Write a whole file in one step, so that an interruption leaves the old one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    part.write_text(text, encoding="utf-8", newline="")
    os.replace(part, path)
