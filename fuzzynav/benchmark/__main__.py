"""Command line: `python -m fuzzynav.benchmark scenes --method ours my_module:my_planner --cases 1000 --out report`."""

from __future__ import annotations

import argparse
import contextlib
import shlex
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from functools import partial
from pathlib import Path

from fuzzynav import batch
from fuzzynav.benchmark.cases import cases_of, code_label, run_case
from fuzzynav.benchmark.planners import named, names
from fuzzynav.benchmark.report import Comparison, page, summary_table
from fuzzynav.benchmark.tasks import PARTS, SETS, TaskSet
from fuzzynav.fusion.protocol import ENDINGS, STEP_LIMIT
from fuzzynav.fusion.scenes import ROBOTS

SCENES_ONLY, WORLDS_ONLY = ("robot", "courteous"), ("folder", "top_speed", "part")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m fuzzynav.benchmark",
        description="compare planners over a set of tasks; writes runs.csv (resumes), summary.csv and report.html",
        epilog=f"planners of the course: {', '.join(map(repr, names()))}",
    )
    parser.add_argument("set", help=f"{', '.join(SETS)}")
    parser.add_argument("folder", nargs="?", help="of BARN and DynaBARN, files or a checkout (default: the course's)")
    parser.add_argument("--method", nargs="+", required=True, metavar="NAME", help="planners, or module:object")
    parser.add_argument("--cases", type=int, help="how many tasks (default: all, of scenes 100)")
    parser.add_argument("--seed", type=int, default=0, help="of the first scene, elsewhere of the scanner's noise")
    parser.add_argument("--processes", type=int, default=1, help="worker processes (default 1)")
    parser.add_argument("--dask", metavar="ADDRESS", help="of a Dask scheduler, whose workers run the cases")
    parser.add_argument("--out", default="benchmark", metavar="DIR", help="folder of the report (default benchmark)")
    parser.add_argument("--ideal", action="store_true", help="planners are told where the movers are")
    parser.add_argument("--courteous", action="store_true", default=None, help="movers stop before a standing robot")
    parser.add_argument("--robot", help=f"of scenes: {', '.join(ROBOTS)}")
    parser.add_argument("--top-speed", type=float, help="[m/s] of BARN and DynaBARN (default 2)")
    parser.add_argument("--part", help=f"of BARN's and DynaBARN's worlds: {', '.join(PARTS)} (default {PARTS[0]})")
    parser.add_argument("--step-limit", type=float, default=STEP_LIMIT, help="[s] for an answer (default 1)")
    parser.add_argument("--players", type=int, default=2, help="worst cases of each planner to play (default 2)")
    return parser


def _tasks(asked: argparse.Namespace) -> TaskSet:
    """The set of tasks that was asked for; ValueError for an option that belongs to another set."""
    given = {n: getattr(asked, n) for n in (*SCENES_ONLY, *WORLDS_ONLY) if getattr(asked, n) is not None}
    tasks = TaskSet(kind=asked.set, seed=asked.seed, ideal=asked.ideal, **given)
    for name in WORLDS_ONLY if asked.set == "scenes" else SCENES_ONLY:
        if name in given:
            raise ValueError(f"{name.replace('_', '-')} does not belong to {asked.set}: leave it out")
    return tasks


def _checked(asked: argparse.Namespace) -> tuple[str, ...]:
    """The planners, found and told apart; ValueError for a number or a name that cannot be meant."""
    for name, least in (("processes", 1), ("players", 0)):
        if getattr(asked, name) < least:
            raise ValueError(f"--{name} must be at least {least}, got {getattr(asked, name)}")
    if not asked.step_limit > 0:
        raise ValueError(f"--step-limit must be positive seconds, got {asked.step_limit}")
    if asked.dask is not None and asked.processes > 1:
        raise ValueError("--processes and --dask exclude each other: the cluster has its own workers")
    if len(set(asked.method)) != len(asked.method):
        raise ValueError(f"each planner once, got {', '.join(asked.method)}")
    for method in asked.method:
        named(method)
    return tuple(asked.method)


@contextlib.contextmanager
def _executor(processes: int, dask: str | None) -> Iterator[Executor | None]:
    """Where the cases run: here, on processes, or on a Dask cluster."""
    if dask is not None:
        try:
            from distributed import Client
        except ModuleNotFoundError:
            raise ValueError("--dask needs the library distributed: pip install 'fuzzynav[scale]'") from None
        try:
            client = Client(dask, timeout=10)
        except (OSError, TimeoutError) as error:
            raise ValueError(f"no Dask scheduler answers at {dask}: {error}") from None
        with client:
            yield client.get_executor()
    elif processes > 1:
        with ProcessPoolExecutor(processes) as pool:
            yield pool
    else:
        yield None


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the comparison; 0 when it is done or its worlds are not there, 2 for a request that cannot be met."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    asked = _parser().parse_args(words)
    try:
        tasks, methods = _tasks(asked), _checked(asked)
        reason = tasks.lacking()
        if reason:
            print(f"fuzzynav: skipped, {reason}")
            return 0
        cases, out = cases_of(tasks, methods, asked.cases), Path(asked.out)
        label = code_label(tasks, methods, asked.step_limit)
        experiment = partial(run_case, tasks=tasks, step_limit=asked.step_limit)
        with _executor(asked.processes, asked.dask) as executor:
            table = batch.run(experiment, cases, executor=executor, path=out / "runs.csv", label=label, chunk=4)
        command = f"python -m fuzzynav.benchmark {shlex.join(words)}"
        found = Comparison(tasks=tasks, methods=methods, table=table, command=command, step_limit=asked.step_limit)
        totals = summary_table(found)
        batch.write_whole(out / "summary.csv", totals.to_csv(index=False))
        batch.write_whole(out / "report.html", page(found, asked.players))
    except KeyboardInterrupt:
        print("fuzzynav: stopped; the rows so far are kept, and the same command goes on from there", file=sys.stderr)
        return 130
    except (ValueError, RuntimeError, OSError) as error:
        print(f"fuzzynav: {error}", file=sys.stderr)
        return 2
    print(totals[["method", "runs", *ENDINGS]].to_string(index=False))
    print(f"{out / 'report.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
