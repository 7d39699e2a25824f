"""The generated pages: README's chapters and counts, every verdict by source, every measured speed.

`python -m fuzzynav.course.readme` writes them: README.md between its markers, docs/ledger.md and docs/speed.md whole;
with `--picture` it also draws README's picture anew.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from fuzzynav.course.folders import course_root, write_whole
from fuzzynav.course.overview import chapters
from fuzzynav.plot.cover import save_cover
from fuzzynav.published import Row, items, ledger, reproduced_items
from fuzzynav.studies.reproduction import MEANING, VERDICTS

__all__ = [
    "bench_table",
    "claims_table",
    "items_line",
    "ledger_line",
    "ledger_table",
    "meanings",
    "pages",
    "rendered",
    "speed_line",
    "write_pages",
]

LEDGER, SPEED = "docs/ledger.md", "docs/speed.md"


def pages(root: Path) -> dict[str, str]:
    """Every generated page by its path below `root`."""
    rows, speeds = ledger(), _speeds(root / "data" / "results" / "bench.csv")
    parts = {
        "chapters": chapters().markdown("notebooks/"),
        "items": items_line(),
        "ledger": ledger_line(rows),
        "bench": speed_line(speeds),
    }
    return {
        "README.md": rendered((root / "README.md").read_text(encoding="utf-8"), parts),
        LEDGER: "# Published against reproduced\n\n"
        "Every printed number of the documents beside ours; `make reproduce` prints the same with the reasons.\n\n"
        f"{ledger_table(rows)}\n\n{meanings()}\n\n{claims_table(rows)}\n",
        SPEED: "# Speed\n\n"
        "`make bench` measures both sides in one run. On two shared cores (treat times as ratios):\n\n"
        f"{bench_table(speeds)}\n",
    }


def write_pages(root: Path) -> None:
    """Write every generated page below `root`."""
    for name, text in pages(root).items():
        (root / name).parent.mkdir(exist_ok=True)
        write_whole(root / name, text)


def items_line() -> str:
    """How many figures, tables and equations of the documents the notebooks show today."""
    known, shown = items(), reproduced_items()
    never = sum(item.reproducible == "no" and item.id not in shown for item in known.values())
    return (
        f"Today the notebooks show {len(shown)} of the documents' {len(known)} figures, tables and equations; "
        f"{never} cannot be rebuilt (photographs and the like)."
    )


def ledger_line(rows: Sequence[Row]) -> str:
    """How many claims have each verdict, in one line."""
    counts = Counter(row.verdict for row in rows)
    said = ", ".join(f"{counts[v]} {v}" for v in VERDICTS if counts[v])
    return f"{len(rows)} printed numbers: {said}. Every one of them: [{LEDGER}]({LEDGER}).\n\n" + ledger_table(rows)


def ledger_table(rows: Sequence[Row]) -> str:
    """Markdown: how many claims of each document have each verdict."""
    counts: dict[str, Counter[str]] = {}
    for row in rows:
        counts.setdefault(row.source.partition(":")[0], Counter())[row.verdict] += 1
    head = "| document | " + " | ".join(VERDICTS) + " |\n|---|" + "---:|" * len(VERDICTS) + "\n"
    lines = [f"| {name} | " + " | ".join(str(c[v]) for v in VERDICTS) + " |" for name, c in sorted(counts.items())]
    return head + "\n".join(lines)


def meanings() -> str:
    """Markdown: what each verdict means."""
    return "\n".join(f"- *{word}*: {text}" for word, text in MEANING.items())


def claims_table(rows: Sequence[Row]) -> str:
    """Markdown: every claim that has a verdict, with the printed value and ours."""
    head = "| claim | quantity | printed | ours | verdict |\n|---|---|---:|---:|---|\n"
    lines = [
        f"| {row.claim} | {_cell(row.quantity)} | {_cell(row.published)} | {_cell(row.ours)} | {row.verdict} |"
        for row in rows
        if row.verdict != "not yet"
    ]
    return head + "\n".join(lines)


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


def speed_line(rows: Sequence[dict[str, str]]) -> str:
    """The largest ratio that was measured, in one line."""
    if not rows:
        return "Not measured yet: run `make bench`."
    best = max(rows, key=lambda row: float(row["ratio"] or 0.0))
    return (
        f"{len(rows)} measurements beside other programs; the best: {best['task']}, "
        f"{_number(best['ratio'])} times as fast as {best['peer_name']}. All of them: [{SPEED}]({SPEED})."
    )


def _speeds(path: Path) -> list[dict[str, str]]:
    """The rows that `make bench` wrote to `path`; none if it was not run."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def bench_table(rows: Sequence[dict[str, str]]) -> str:
    """Markdown: every measured row."""
    head = "| task | unit | ours | peer | | ratio | agreement |\n|---|---|---:|---:|---|---:|---|\n"
    lines = [
        f"| {r['task']} | {r['unit']} | {_number(r['ours'])} | {_number(r['peer'])} | {r['peer_name']} "
        f"| {_number(r['ratio'])} | {r['agreement']} |"
        for r in rows
    ]
    return head + "\n".join(lines)


def rendered(readme: str, parts: dict[str, str]) -> str:
    """README's text with its generated parts put in; raises ValueError if a marker is missing."""
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
    parser = argparse.ArgumentParser(prog="python -m fuzzynav.course.readme", description="the generated pages")
    parser.add_argument("--picture", action="store_true", help="draw data/readme.png anew")
    root = course_root()
    if parser.parse_args().picture:
        save_cover(root / "data" / "readme.png")
    write_pages(root)
    print("README.md and docs/ are up to date")
    return 0


if __name__ == "__main__":
    sys.exit(main())
