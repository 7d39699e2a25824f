"""Thousands of worlds: run an experiment over many cases on any executor, resume it, report it.

An experiment is a function from one case (a seed, or any value that prints the same every time) to
one row, or to several rows: dicts of plain values. It must be importable by name, so that other
processes and other machines can run it.
"""

from __future__ import annotations

import argparse
import importlib
import io
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy import stats
from tqdm import tqdm

from fuzzynav import __version__

__all__ = ["Experiment", "Row", "paired", "proportion", "read", "run", "summary"]

Row = Mapping[str, Any]
Experiment = Callable[[Any], Row | Sequence[Row]]


def run(
    experiment: Experiment,
    cases: Sequence[Any],
    *,
    executor: Executor | None = None,
    path: str | Path | None = None,
    chunk: int = 8,
    progress: bool = True,
) -> pd.DataFrame:
    """Table of what `experiment` returns for every case, in the order of `cases`.

    executor: None runs here on one core; otherwise any concurrent.futures executor (processes,
    `dask.distributed.Client(...).get_executor()`, mpi4py). path: a CSV file to which rows are
    appended as they come; cases already in it are not run again. The table is the same for every
    executor and however often the sweep was interrupted.

    Raises ValueError for repeated cases, an empty list, or a file of another experiment; RuntimeError
    when cases failed: it names the first one, and all the other rows are in the file.
    """
    keys = [str(case) for case in cases]
    if not keys:
        raise ValueError("no cases to run: give at least one seed or world")
    if len(set(keys)) != len(keys):
        raise ValueError("some cases print alike: each must be unlike the others, so that a sweep can resume")
    if chunk < 1:
        raise ValueError(f"chunk must be at least 1, got {chunk}")
    name = f"{experiment.__module__}.{getattr(experiment, '__qualname__', type(experiment).__name__)}"
    store = _Store(Path(path) if path is not None else None, name)
    left = [case for case, key in zip(cases, keys, strict=True) if key not in store.rows]
    failed: list[tuple[Any, BaseException]] = []
    with tqdm(total=len(keys), initial=len(keys) - len(left), disable=not progress, unit="case", leave=False) as bar:
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
    return store.finish(keys)


def _results(
    experiment: Experiment, cases: Sequence[Any], executor: Executor | None, chunk: int
) -> Iterator[tuple[Any, list[dict[str, Any]], BaseException | None]]:
    """(case, rows, error) as they come."""
    if executor is None:
        for case in cases:
            yield from _run_chunk(experiment, [case])
        return
    futures: list[Future[Any]] = [
        executor.submit(_run_chunk, experiment, list(cases[k : k + chunk])) for k in range(0, len(cases), chunk)
    ]
    try:
        for future in as_completed(futures):
            yield from future.result()
    finally:
        for future in futures:
            future.cancel()


def _run_chunk(
    experiment: Experiment, cases: Sequence[Any]
) -> list[tuple[Any, list[dict[str, Any]], BaseException | None]]:
    """Every case of one chunk; what a case raises travels back beside the others' rows."""
    done: list[tuple[Any, list[dict[str, Any]], BaseException | None]] = []
    for case in cases:
        try:
            rows = experiment(case)
        except Exception as error:  # whatever a reader's controller raises costs its own case only
            done.append((case, [], error))
        else:
            done.append((case, [dict(rows)] if isinstance(rows, Mapping) else [dict(row) for row in rows], None))
    return done


class _Store:
    """Rows by case, mirrored line by line in a CSV file when there is one."""

    def __init__(self, path: Path | None, experiment: str) -> None:
        self.path, self.experiment = path, experiment
        self.rows: dict[str, list[dict[str, Any]]] = {}
        self.columns: list[str] | None = None
        if path is not None and path.exists():
            self._load(path)

    def _header(self) -> str:
        return f"# fuzzynav {__version__}; experiment {self.experiment}; complete = 1 marks a case's last row\n"

    def _load(self, path: Path) -> None:
        text = path.read_text(encoding="utf-8")
        first, _, body = text.partition("\n")
        if f"; experiment {self.experiment};" not in first:
            raise ValueError(f"{path.name} does not hold results of {self.experiment}: name another file or remove it")
        body = body[: body.rfind("\n") + 1]  # a line cut by an interruption is run again
        if not body.strip():
            path.unlink()
            return
        table = pd.read_csv(io.StringIO(body), dtype={"case": str})
        self.columns = [c for c in table.columns if c not in ("case", "complete")]
        for key, group in table.groupby("case", sort=False):
            if group["complete"].iloc[-1]:
                self.rows[str(key)] = group[self.columns].to_dict("records")
        kept = [line for key, rows in self.rows.items() for line in self._lines(key, rows)]
        _replace(path, self._header() + ",".join(["case", *self.columns, "complete"]) + "\n" + "".join(kept))

    def _lines(self, key: str, rows: Sequence[Mapping[str, Any]]) -> list[str]:
        last = len(rows) - 1
        frame = pd.DataFrame([{"case": key, **row, "complete": int(k == last)} for k, row in enumerate(rows)])
        return frame.to_csv(index=False, header=False, lineterminator="\n").splitlines(keepends=True)

    def add(self, key: str, rows: list[dict[str, Any]]) -> None:
        """Keep the rows of one case, and append them to the file."""
        if not rows:
            raise ValueError(f"the experiment returned no row for case {key}")
        names = list(rows[0])
        if self.columns is None:
            self.columns = names
            if self.path is not None:
                self.path.parent.mkdir(parents=True, exist_ok=True)
                _replace(self.path, self._header() + ",".join(["case", *names, "complete"]) + "\n")
        if any(list(row) != self.columns for row in rows):
            raise ValueError(f"case {key} has columns {names}, the earlier ones {self.columns}: rows must be alike")
        self.rows[key] = rows
        if self.path is not None:
            with self.path.open("a", encoding="utf-8") as file:
                file.write("".join(self._lines(key, rows)))

    def finish(self, keys: Sequence[str]) -> pd.DataFrame:
        """The table in the order of `keys`; the file is put in that order too."""
        table = pd.DataFrame([{"case": key, **row} for key in keys for row in self.rows[key]])
        if self.path is None or self.columns is None:
            return _plain(table)
        lines = [line for key in keys for line in self._lines(key, self.rows[key])]
        _replace(self.path, self._header() + ",".join(["case", *self.columns, "complete"]) + "\n" + "".join(lines))
        return _plain(table)


def _plain(table: pd.DataFrame) -> pd.DataFrame:
    """The table as it would be read from its own CSV, so that memory and disk agree."""
    text = table.to_csv(index=False)
    return pd.read_csv(io.StringIO(text), dtype={"case": str})


def _replace(path: Path, text: str) -> None:
    """Write a whole file in one step, so that an interruption leaves the old one."""
    part = path.with_name(path.name + ".part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, path)


def read(path: str | Path) -> pd.DataFrame:
    """The complete rows of a sweep's CSV file. Raises FileNotFoundError with what would make it."""
    path = Path(path)
    if not path.exists():
        raise FileNotFoundError(f"{path.name} is not there yet: `make reproduce` runs the study that writes it")
    table = pd.read_csv(path, comment="#", dtype={"case": str})
    return table.drop(columns="complete")


def proportion(successes: int, trials: int, confidence: float = 0.95) -> tuple[float, float, float]:
    """Rate with its Wilson interval: (rate, low, high).

    >>> [round(x, 3) for x in proportion(90, 100)]
    [0.9, 0.826, 0.945]
    """
    if trials < 1:
        raise ValueError("a rate needs at least one trial")
    interval = stats.binomtest(successes, trials).proportion_ci(confidence, method="wilson")
    return successes / trials, float(interval.low), float(interval.high)


def summary(
    table: pd.DataFrame, by: str | Sequence[str], quantities: Sequence[str], success: str = "success"
) -> pd.DataFrame:
    """One row a group: runs, rate of success with its 95 % Wilson interval, medians among successes.

    Raises ValueError if a column is missing.
    """
    by = [by] if isinstance(by, str) else list(by)
    missing = [c for c in [*by, *quantities, success] if c not in table.columns]
    if missing:
        raise ValueError(f"no column {missing[0]!r} in the table; it has {', '.join(table.columns)}")
    rows = []
    for key, group in table.groupby(by, sort=False):
        won = group[success].astype(bool)
        rate, low, high = proportion(int(won.sum()), len(group))
        medians = {f"median {q}": group.loc[won, q].median() for q in quantities}
        rows.append({**dict(zip(by, key)), "runs": len(group), "success": rate, "low": low, "high": high, **medians})
    return pd.DataFrame(rows)


def paired(
    table: pd.DataFrame, by: str, first: str, second: str, quantity: str, success: str = "success"
) -> dict[str, float]:
    """Difference second - first of a quantity over the cases where both succeeded.

    Returns the number of pairs, the mean difference with its 95 % bootstrap interval (2000 draws,
    fixed seed), and the share of pairs in which `second` is smaller. nan without two pairs.
    """
    sides = [table[(table[by] == m) & table[success].astype(bool)].set_index("case")[quantity] for m in (first, second)]
    gap = (sides[1] - sides[0]).dropna().to_numpy(float)
    if len(gap) < 2:
        return {"pairs": len(gap), "mean": np.nan, "low": np.nan, "high": np.nan, "smaller": np.nan}
    rng = np.random.default_rng(0)
    draws = gap[rng.integers(0, len(gap), (2000, len(gap)))].mean(axis=1)
    low, high = np.quantile(draws, [0.025, 0.975])
    return {
        "pairs": len(gap),
        "mean": float(gap.mean()),
        "low": float(low),
        "high": float(high),
        "smaller": float((gap < 0).mean()),
    }


def _experiment(text: str) -> Experiment:
    """The function named `package.module:function`."""
    module, _, name = text.partition(":")
    if not name:
        raise ValueError(f"name the experiment as package.module:function, got {text!r}")
    try:
        return getattr(importlib.import_module(module), name)
    except (ModuleNotFoundError, AttributeError) as error:
        raise ValueError(f"there is no experiment {text}: {error}") from None


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line: `python -m fuzzynav.batch package.module:function --seeds 0:1000 --out sweep.csv`."""
    parser = argparse.ArgumentParser(prog="python -m fuzzynav.batch", description="run an experiment over many seeds")
    parser.add_argument("experiment", help="package.module:function, from a seed to a row")
    parser.add_argument("--seeds", default="0:100", help="first:last+1 (default 0:100)")
    parser.add_argument("--processes", type=int, default=1, help="worker processes (default 1)")
    parser.add_argument("--out", help="CSV file; an interrupted sweep resumes from it")
    asked = parser.parse_args(arguments)
    try:
        low, high = (int(part) for part in asked.seeds.split(":"))
        experiment = _experiment(asked.experiment)
        seeds = range(low, high)
        if asked.processes < 1:
            raise ValueError(f"--processes must be at least 1, got {asked.processes}")
        if asked.processes == 1:
            table = run(experiment, seeds, path=asked.out)
        else:
            with ProcessPoolExecutor(asked.processes) as pool:
                table = run(experiment, seeds, executor=pool, path=asked.out)
    except (ValueError, RuntimeError) as error:
        print(f"fuzzynav: {error}", file=sys.stderr)
        return 2
    print(table.describe().to_string())
    return 0


if __name__ == "__main__":
    sys.exit(main())
