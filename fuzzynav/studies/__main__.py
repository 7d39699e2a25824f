"""Run the long studies: `python -m fuzzynav.studies [NAME ...]`; what is current is left as it is.

`--fresh` makes all of it anew, `--check` recomputes a sample of rows, `--accept` takes stale files over whose sample
comes out exactly: after a change of the code that should change no result.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from fuzzynav.data import folder
from fuzzynav.studies import claims_of, topics
from fuzzynav.studies.study import Study, accept, differences, run, state


def studies() -> tuple[Study, ...]:
    """The studies of every topic, in alphabetical order of the topics."""
    return tuple(study for topic in topics() for study in getattr(claims_of(topic), "STUDIES", ()))


def _made_anew() -> Path:
    """Names the studies that an interrupted `--fresh` has behind it."""
    return folder("results") / ".made_anew"


def _make(study: Study, fresh: bool, processes: int) -> None:
    found, notes = state(study), _made_anew()
    if fresh and notes.exists() and study.name in notes.read_text(encoding="utf-8").split():
        fresh = False
    if found == "current" and not fresh:
        print(f"{study.name}: current")
        return
    print(f"{study.name}: {'made anew' if found == 'current' else found}", flush=True)
    moved = run(study, fresh, processes)
    print(f"{study.name}: {f'{moved} of its old rows changed' if moved else 'done'}")
    if fresh:
        with notes.open("a", encoding="utf-8") as file:
            file.write(f"{study.name}\n")


def _sampled(study: Study, count: int, take: bool) -> bool:
    """Compare a sample with what comes out now, and take the file over where asked; whether all of it agrees."""
    try:
        wrong = accept(study, count) if take else differences(study, count)
    except (FileNotFoundError, ValueError) as error:
        wrong = [str(error)]
    print(f"{study.name}: {'; '.join(wrong) or 'a sample comes out as stored'}", flush=True)
    return not wrong


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the studies named, or all of them; 2 for an unknown name, 1 where a sample differs."""
    known = {study.name: study for study in studies()}
    parser = argparse.ArgumentParser(prog="python -m fuzzynav.studies", description="run the long studies")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"default: all ({', '.join(known) or 'none yet'})")
    parser.add_argument("--fresh", action="store_true", help="make also what is current")
    parser.add_argument("--check", action="store_true", help="recompute a sample of each file and compare")
    parser.add_argument("--accept", action="store_true", help="take stale files over if a sample comes out exactly")
    parser.add_argument("--rows", type=int, default=10, help="cases in a sample (default 10)")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1, help="workers (default: every core)")
    asked = parser.parse_args(arguments)
    unknown = [name for name in asked.names if name not in known]
    if unknown:
        print(f"fuzzynav: there is no study {unknown[0]}; there are: {', '.join(known)}", file=sys.stderr)
        return 2
    chosen = [known[name] for name in asked.names] or list(known.values())
    if asked.check or asked.accept:
        return 0 if all([_sampled(study, asked.rows, asked.accept) for study in chosen]) else 1
    for study in chosen:
        _make(study, asked.fresh, asked.processes)
    if asked.fresh:
        _made_anew().unlink(missing_ok=True)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("fuzzynav: interrupted; the same command goes on where it stopped")
