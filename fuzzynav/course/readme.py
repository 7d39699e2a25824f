"""The generated parts of README: chapters, verdicts of the ledger, measured speed.

`python -m fuzzynav.course.readme` writes them between their markers; with `--picture` it also draws
README's picture anew.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections import Counter
from pathlib import Path

from fuzzynav.course.chapters import chapters
from fuzzynav.course.folders import course_root, write_whole
from fuzzynav.plot.cover import save_cover
from fuzzynav.published import ledger
from fuzzynav.studies.reproduction import MEANING, VERDICTS

__all__ = ["bench_table", "ledger_table", "rendered"]


def ledger_table() -> str:
    """Markdown: how many claims of each document have each verdict, and what the verdicts mean."""
    counts: dict[str, Counter[str]] = {}
    for row in ledger():
        counts.setdefault(row.source.partition(":")[0], Counter())[row.verdict] += 1
    head = "| document | " + " | ".join(VERDICTS) + " |\n|---|" + "---:|" * len(VERDICTS) + "\n"
    lines = [f"| {name} | " + " | ".join(str(c[v]) for v in VERDICTS) + " |" for name, c in sorted(counts.items())]
    return head + "\n".join(lines) + "\n\n" + "\n".join(f"- *{word}*: {text}" for word, text in MEANING.items())


def bench_table(path: Path) -> str:
    """Markdown: the last measurement that `make bench` wrote to `path`."""
    if not path.exists():
        return "Not measured yet: run `make bench`."
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    head = "| task | unit | ours | peer | | ratio | agreement |\n|---|---|---:|---:|---|---:|---|\n"
    lines = [
        f"| {r['task']} | {r['unit']} | {_number(r['ours'])} | {_number(r['peer'])} | {r['peer_name']} "
        f"| {_number(r['ratio'])} | {r['agreement']} |"
        for r in rows
    ]
    return head + "\n".join(lines)


def rendered(readme: str, root: Path) -> str:
    """README's text with its generated parts made anew; raises ValueError if a marker is missing."""
    parts = {
        "chapters": chapters().markdown("notebooks/"),
        "ledger": ledger_table(),
        "bench": bench_table(root / "data" / "results" / "bench.csv"),
    }
    for name, text in parts.items():
        if f"<!-- {name}: generated -->\n" not in readme or f"<!-- /{name} -->" not in readme:
            raise ValueError(f"README.md has lost its markers for '{name}'")
        before, _, rest = readme.partition(f"<!-- {name}: generated -->\n")
        after = rest.partition(f"<!-- /{name} -->")[2]
        readme = f"{before}<!-- {name}: generated -->\n{text}\n<!-- /{name} -->{after}"
    return readme


def _number(text: str) -> str:
    try:
        value = float(text)
    except ValueError:
        return text or "-"
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


def main() -> int:
    """Write README.md anew, and its picture where asked."""
    parser = argparse.ArgumentParser(prog="python -m fuzzynav.course.readme", description="README's generated parts")
    parser.add_argument("--picture", action="store_true", help="draw data/readme.png anew")
    root = course_root()
    if parser.parse_args().picture:
        save_cover(root / "data" / "readme.png")
    path = root / "README.md"
    write_whole(path, rendered(path.read_text(encoding="utf-8"), root))
    print("README.md is up to date")
    return 0


if __name__ == "__main__":
    sys.exit(main())
