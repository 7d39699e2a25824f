"""Command line: `python -m fuzzynav.batch package.module:function --seeds 0:1000 --out sweep.csv`."""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import cast

from fuzzynav.batch.sweep import Experiment, run


def _experiment(text: str) -> Experiment:
    """The function named `package.module:function`."""
    module, _, name = text.partition(":")
    if not name:
        raise ValueError(f"name the experiment as package.module:function, got {text!r}")
    try:
        return cast(Experiment, getattr(importlib.import_module(module), name))
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
