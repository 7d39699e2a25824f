"""README says what is: its generated parts are as the data make them, its commands exist."""

import re
from pathlib import Path

from fuzzynav.course.readme import pages

HOME = Path(__file__).parent.parent
README = (HOME / "README.md").read_text(encoding="utf-8")


def test_generated_pages_are_as_the_data_make_them() -> None:
    for name, text in pages(HOME).items():
        assert text == (HOME / name).read_text(encoding="utf-8"), f"{name}: run `python -m fuzzynav.course.readme`"


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
