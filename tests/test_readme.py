"""README says what is: its generated parts are as the data make them, its commands exist."""

import re
from pathlib import Path

from fuzzynav.course.readme import rendered

HOME = Path(__file__).parent.parent
README = (HOME / "README.md").read_text(encoding="utf-8")


def test_generated_parts_are_up_to_date() -> None:
    def steady(text: str) -> str:  # counts of verdicts: some claims compare times measured now
        return re.sub(r"(?m)^\| [^|]+ \|( \d+ \|){6}$", "", text)

    assert steady(rendered(README, HOME)) == steady(README), "run `python -m fuzzynav.course.readme`"


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
