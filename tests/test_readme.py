"""README says what is: its generated parts are as the data make them, its commands exist."""

import re
from collections import Counter
from pathlib import Path

from fuzzynav.course.readme import ledger_table, meanings, pages
from fuzzynav.documents import claims
from fuzzynav.published import ledger
from fuzzynav.studies.reproduction import VERDICTS

HOME = Path(__file__).parent.parent
README = (HOME / "README.md").read_text(encoding="utf-8")


def test_generated_pages_are_as_the_data_make_them() -> None:
    for name, text in pages(HOME).items():
        assert text == (HOME / name).read_text(encoding="utf-8"), f"{name}: run `python -m fuzzynav.course.readme`"


def test_a_changed_count_of_verdicts_is_found() -> None:
    row = next(line for line in README.splitlines() if line.startswith("| thesis |"))
    false = re.sub(r"\d+", lambda m: str(int(m[0]) + 1), row, count=1)
    assert row in pages(HOME)["README.md"]
    assert false not in pages(HOME)["README.md"]


def test_one_row_for_each_document_with_every_verdict() -> None:
    table = ledger_table(ledger()).splitlines()
    heads = [cell.strip() for cell in table[0].strip("|").split("|")]
    assert heads == ["document", *VERDICTS]
    rows = {
        r[0]: [int(n) for n in r[1:]] for r in ([c.strip() for c in line.strip("|").split("|")] for line in table[2:])
    }
    wanted = Counter(c.id.partition(":")[0] for c in claims().values())
    assert {name: sum(counts) for name, counts in rows.items()} == wanted
    assert all(f"- *{word}*" in meanings() for word in VERDICTS)


def test_every_verb_named_exists_and_every_verb_is_helped() -> None:
    makefile = (HOME / "Makefile").read_text(encoding="utf-8")
    verbs = set(re.findall(r"^\.PHONY: (.*)$", makefile, re.M)[0].split())
    named = set(re.findall(r"`?make ([a-z]+)", README))
    assert named <= verbs
    helped = set(re.findall(r'@echo "make ([a-z]+)', makefile))
    assert helped == verbs - {"help"}


def test_links_resolve() -> None:
    for target in re.findall(r"\]\(([^)#:]+)\)", README):
        assert (HOME / target).exists(), target


def test_readme_begins_with_what_a_newcomer_needs() -> None:
    heads = re.findall(r"(?m)^## (.+)$", README)
    assert heads[:2] == ["Two commands", "The course"]
    assert README.count("\n") < 150, "long tables stand in docs/"
