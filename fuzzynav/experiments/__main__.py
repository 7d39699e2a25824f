"""Run the long studies: `python -m fuzzynav.experiments [NAME ...]`.

A chapter's module lists its studies in `STUDIES`. Each writes `data/results/<name>.csv`, skips what is
already there, and can be interrupted at any moment.
"""

from __future__ import annotations

import argparse
import importlib
import pkgutil
import sys
from collections.abc import Sequence

import fuzzynav.experiments
from fuzzynav.experiments.reproduction import Study


def studies() -> tuple[Study, ...]:
    """The studies of every chapter present, in the order of their modules."""
    names = sorted(m.name for m in pkgutil.iter_modules(fuzzynav.experiments.__path__) if m.name.startswith("chapter_"))
    modules = [importlib.import_module(f"fuzzynav.experiments.{name}") for name in names]
    return tuple(study for module in modules for study in getattr(module, "STUDIES", ()))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the studies named, or all of them; 2 for an unknown name."""
    known = {study.name: study for study in studies()}
    parser = argparse.ArgumentParser(prog="python -m fuzzynav.experiments", description="run the long studies")
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
