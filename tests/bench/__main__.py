"""The runner behind `make bench`: `python tests/bench [names]`.

Runs `rows()` of every `bench_<name>.py` in this folder, or of the named ones, prints one table, writes
`data/results/bench.csv` and docs/speed.md. A row holds: task, unit, ours, peer, peer_name, ratio (how many
times faster ours is), agreement (how the answers of both sides were compared). Both sides are measured in one run.
"""

import csv
import importlib
import sys
from pathlib import Path

from fuzzynav.course.readme import write_pages

HERE = Path(__file__).resolve().parent
HOME = HERE.parent.parent
RESULTS = HOME / "data" / "results" / "bench.csv"
FIELDS = ("task", "unit", "ours", "peer", "peer_name", "ratio", "agreement")


def show(value):
    """A number with three digits, anything else as it is."""
    if value is None:
        return "-"
    if isinstance(value, float):
        return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"
    return str(value)


def merge(rows, names):
    """The new rows, behind those of the file whose benchmark was not run now."""
    kept = []
    if RESULTS.exists() and names:
        with open(RESULTS, newline="", encoding="utf-8") as file:
            kept = [row for row in csv.DictReader(file) if row["bench"] not in names]
    return sorted(kept + rows, key=lambda row: row["bench"])


def main(arguments):
    """Run the named benchmarks, or all; 1 if one of them is unknown."""
    found = sorted(path.stem.removeprefix("bench_") for path in HERE.glob("bench_*.py"))
    unknown = sorted(set(arguments) - set(found))
    if unknown:
        print(f"no benchmark is called {', '.join(unknown)}; known: {', '.join(found)}")
        return 1
    sys.path.insert(0, str(HERE))
    rows = []
    for name in arguments or found:
        print(f"measuring {name} ...", flush=True)
        for row in importlib.import_module(f"bench_{name}").rows():
            rows.append({"bench": name, **row})
            print("  " + " | ".join(show(row[field]) for field in FIELDS), flush=True)
    table = [FIELDS, *(tuple(show(row[field]) for field in FIELDS) for row in rows)]
    widths = [max(len(line[k]) for line in table) for k in range(len(FIELDS))]
    print()
    for line in table:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip())
    RESULTS.parent.mkdir(parents=True, exist_ok=True)
    merged = merge(rows, set(arguments))  # reads the file, so before it is opened anew
    with open(RESULTS, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, ("bench", *FIELDS), lineterminator="\n")
        writer.writeheader()
        writer.writerows(merged)
    write_pages(HOME)
    print(f"\nwritten to {RESULTS.relative_to(HOME)} and docs/speed.md")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
