"""The ledger: what the documents printed, what this package measures, and the verdict.

Verdict of a claim, first rule that fits:
1. a verdict set by hand with its reason ('contradicts itself', 'not testable');
2. the texts are equal, the truth values are equal, the number lies within the stated tolerance of the printed one
   (plus 1e-9), or fulfils a printed bound such as '> 90': what the reproduction says that agreement shows,
   'reproduced', 'fitted', 'input' or 'by definition';
3. 'direction holds': the claim is a change or a comparison, and on seeded cases the whole 95 % interval of the change
   lies on the printed side;
4. 'not reproduced'; 'not yet' where no reproduction exists, or its study was not run.
`fuzzynav.studies.reproduction.MEANING` says what each word means.
Run `python -m fuzzynav.published` to print all of it.
"""

from __future__ import annotations

import argparse
import csv
import json
import re
import sys
import textwrap
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path

import pandas as pd

from fuzzynav.data import folder
from fuzzynav.documents import Claim, Item, claim, claims, item, items
from fuzzynav.studies import claims_of, topics
from fuzzynav.studies.reproduction import VERDICTS, Measured, Reproduction, Verdict

__all__ = [
    "Claim",
    "Item",
    "Row",
    "Table",
    "claim",
    "claims",
    "item",
    "items",
    "ledger",
    "reproduced_items",
    "reproductions",
    "table",
    "verdict",
]


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the ledger, in words."""

    claim: str
    source: str
    quantity: str
    setting: str
    unit: str
    published: str
    ours: str
    verdict: str
    free: str
    holds_for: str
    why: str
    topic: str


class Table(pd.DataFrame):
    """A DataFrame that shows its texts in full."""

    @property
    def _constructor(self) -> type[Table]:
        return Table

    def __repr__(self) -> str:
        with pd.option_context("display.max_colwidth", 60, "display.width", 140, "display.max_rows", None):
            return str(super().__repr__())

    def _repr_html_(self) -> str | None:
        with pd.option_context("display.max_colwidth", None, "display.max_rows", None):
            found = super()._repr_html_()
        return None if found is None else str(found)


def reproductions() -> dict[str, tuple[Reproduction, ...]]:
    """The reproductions of each topic in `fuzzynav.studies`, by the topic's name ('dwa')."""
    modules = {topic: claims_of(topic) for topic in topics()}
    return {topic: m.REPRODUCTIONS for topic, m in modules.items() if hasattr(m, "REPRODUCTIONS")}


def verdict(published: Claim, ours: Measured, reproduction: Reproduction) -> Verdict:
    """The verdict on our value by the rules above; ValueError for a direction of what is no comparison."""
    if reproduction.verdict is not None:
        return reproduction.verdict
    if _agrees(published.value, ours, reproduction.tolerance):
        return reproduction.shows
    if reproduction.direction is None:
        return "not reproduced"
    if not published.is_comparison:
        raise ValueError(f"{published.id} states no change and no comparison: it has no direction")
    return "direction holds" if reproduction.direction()[1] > 0.0 else "not reproduced"


def table(topic: str) -> Table:
    """Published against reproduced for one topic; raises ValueError if it has no reproductions."""
    known = reproductions()
    if topic not in known:
        raise ValueError(f"topic {topic} has no reproductions; there are: {', '.join(known) or 'none yet'}")
    rows = [_row(r, topic) for r in known[topic]]
    shown = ["claim", "quantity", "setting", "unit", "published", "ours", "verdict", "free", "holds_for", "why"]
    made = Table([[getattr(row, key) for key in shown] for row in rows], columns=shown)
    return Table(made.set_index("claim"))


def ledger() -> list[Row]:
    """One row for each claim of the documents, in file order."""
    made = {r.claim: (r, topic) for topic, group in reproductions().items() for r in group}
    for claim_id in made:
        claim(claim_id)
    return [_row(*made[c.id]) if c.id in made else _open_row(c) for c in claims().values()]


def reproduced_items() -> dict[str, list[str]]:
    """The notebooks that reproduce each item, found by the cell tags `item:<id>`."""
    found: dict[str, list[str]] = {}
    for path in sorted((folder("published").parents[1] / "notebooks").glob("*.ipynb")):
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
            for tag in cell["metadata"].get("tags", []):
                if tag.startswith("item:") and path.stem not in found.setdefault(tag[5:], []):
                    found[tag[5:]].append(path.stem)
    return found


def _agrees(published: float | bool | str, ours: Measured, tolerance: float) -> bool:
    if isinstance(published, bool) or isinstance(ours, (bool, str)):
        return type(published) is type(ours) and published == ours
    if isinstance(published, float):
        return bool(abs(float(ours) - published) <= tolerance + 1e-9)
    bound = re.fullmatch(r"([<>])\s*([\d.]+)", published)
    if bound is None:
        return False
    return float(ours) > float(bound[2]) if bound[1] == ">" else float(ours) < float(bound[2])


def _row(reproduction: Reproduction, topic: str) -> Row:
    c = claim(reproduction.claim)
    try:
        ours = reproduction.measure() if reproduction.measure is not None else ""
    except FileNotFoundError as error:  # a study that was not run yet
        return replace(_open_row(c), why=str(error), topic=topic)
    ours = getattr(ours, "item", lambda: ours)()  # numpy's own scalars
    decision = verdict(c, ours, reproduction)
    return Row(
        c.id,
        c.source_item,
        c.quantity,
        _setting(c),
        c.unit,
        c.printed,
        _words(ours, c),
        decision,
        reproduction.free,
        _counted(reproduction.holds_for),
        _why(reproduction),
        topic,
    )


def _why(reproduction: Reproduction) -> str:
    """The reason, the change on seeded cases, and the same comparison on cases that nobody tuned."""
    parts = [reproduction.because]
    if reproduction.direction is not None:
        mean, low, high = reproduction.direction()
        parts.append(f"change on seeded cases {mean:+.1f} [{low:+.1f}, {high:+.1f}]")
    if reproduction.beside is not None:
        parts.append(f"beside it: {reproduction.beside()}")
    return "; ".join(part for part in parts if part)


def _counted(holds: Callable[[], tuple[int, int]] | str) -> str:
    if isinstance(holds, str):
        return holds
    count, of = holds()
    return f"{count} of {of}"


def _open_row(c: Claim) -> Row:
    return Row(c.id, c.source_item, c.quantity, _setting(c), c.unit, c.printed, "", "not yet", "", "", "", "")


def _setting(c: Claim) -> str:
    return ", ".join(part for part in (c.method, c.environment) if part not in ("", "-"))


def _words(ours: Measured, c: Claim) -> str:
    if isinstance(ours, str):
        return ours
    if isinstance(ours, bool):
        return "true" if ours else "false"
    digits = f"{round(float(ours), c.decimals + 1) + 0.0:.{c.decimals + 1}f}"
    return digits.rstrip("0").removesuffix(".")


def _heading(row: Row) -> str:
    document, _, name = row.source.partition(":")
    chapter = re.search(r"\d|[A-Z]", name)
    return f"{document}, chapter {chapter[0]}" if document == "thesis" and chapter else document


def _print_ledger(rows: Sequence[Row]) -> None:
    for heading in dict.fromkeys(_heading(row) for row in rows):
        print(f"\n{heading}\n{'-' * len(heading)}")
        for row in rows:
            if _heading(row) == heading:
                unit = "" if row.unit in ("-", "flag", "grade", "qualitative") else f" {row.unit}"
                print(f"{row.claim}  {row.quantity} ({row.setting or 'all'})")
                print(f"    published {row.published}{unit}; ours {row.ours or '-'}; {row.verdict}")
                holds = f"holds for {row.holds_for}" if row.holds_for[:1].isdigit() else row.holds_for
                more = "; ".join(part for part in (row.free and f"free: {row.free}", holds, row.why) if part)
                if more:
                    print(textwrap.fill(more, 116, initial_indent="    ", subsequent_indent="    "))


def _print_items() -> None:
    done = reproduced_items()
    missing = [i for i in items().values() if i.id not in done and i.reproducible != "no"]
    impossible = sum(i.reproducible == "no" for i in items().values())
    print(
        f"\nfigures, tables and equations: {len(done)} in notebooks, {len(missing)} not yet, "
        f"{impossible} cannot be (photographs and the like)"
    )
    for topic in dict.fromkeys(i.topic for i in missing):
        names = [i.id for i in missing if i.topic == topic]
        print(
            textwrap.fill(
                f"{topic} ({len(names)}): {', '.join(names)}",
                116,
                initial_indent="  ",
                subsequent_indent="    ",
                break_long_words=False,
                break_on_hyphens=False,
            )
        )


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the ledger, the counts and what no notebook shows yet; `--csv FILE` also writes the rows."""
    parser = argparse.ArgumentParser(prog="python -m fuzzynav.published", description="published against reproduced")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="also write the rows to this file")
    options = parser.parse_args(arguments)
    rows = ledger()
    _print_ledger(rows)
    counts = Counter(row.verdict for row in rows)
    print(f"\n{len(rows)} claims: " + ", ".join(f"{counts[v]} {v}" for v in VERDICTS if counts[v]))
    _print_items()
    if options.csv is not None:
        with options.csv.open("w", encoding="utf-8", newline="") as stream:
            writer = csv.writer(stream)
            writer.writerow([f.name for f in fields(Row)])
            writer.writerows(astuple(row) for row in rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
