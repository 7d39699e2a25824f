"""Run the long studies: `python -m fuzzynav.studies [NAME ...]`.

A topic's module lists its studies in `STUDIES`. Each writes `data/results/<name>.csv`, skips what is
already there, and can be interrupted at any moment.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from fuzzynav.studies import claims_of, topics
from fuzzynav.studies.reproduction import Study


def studies() -> tuple[Study, ...]:
    """The studies of every topic, in alphabetical order of the topics."""
    return tuple(study for topic in topics() for study in getattr(claims_of(topic), "STUDIES", ()))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the studies named, or all of them; 2 for an unknown name."""
    known = {study.name: study for study in studies()}
    parser = argparse.ArgumentParser(prog="python -m fuzzynav.studies", description="run the long studies")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"default: all ({', '.join(known) or 'none yet'})")
    asked = parser.parse_args(arguments).names or list(known)
    unknown = [name for name in asked if name not in known]
    if unknown:
        print(f"fuzzynav: there is no study {unknown[0]}; there are: {', '.join(known)}", file=sys.stderr)
        return 2
    for name in asked:
        print(f"study {name} -> data/results/{name}.csv (what is already there is kept)", flush=True)
        known[name].run()
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("fuzzynav: interrupted; the same command goes on where it stopped")
