"""The set of small wrong changes still fits the code of today."""

import ast
import re
import shlex
from pathlib import Path

import pytest

from tests.mutants import MUTANTS, Mutant, changed, imports

ROOMS = {
    "robot", "maps", "fuzzy", "world", "sensors", "localization", "mapping", "planning", "potential", "smoothing",
    "simulate", "tracking", "dwa", "blend", "fusion", "batch", "studies", "published", "course",
}  # fmt: skip


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda m: f"{m.room}: {m.why}")
def test_every_change_applies_and_is_python(home: Path, mutant: Mutant) -> None:
    text = (home / mutant.path).read_text(encoding="utf-8")
    wrong = changed(mutant, text)
    assert ast.dump(ast.parse(wrong)) != ast.dump(ast.parse(text))


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda m: f"{m.room}: {m.why}")
def test_every_change_names_tests_that_exist(home: Path, mutant: Mutant) -> None:
    words = shlex.split(mutant.tests)
    files = [word for word in words if word.endswith(".py")]
    assert files and all((home / name).exists() for name in files)
    wishes = re.findall(r"[a-z_]\w+", words[words.index("-k") + 1]) if "-k" in words else []
    text = "".join((home / name).read_text(encoding="utf-8") for name in files)
    assert all(wish in text for wish in wishes if wish not in ("and", "or", "not"))


def test_there_are_sixty_in_all_rooms_and_no_two_alike() -> None:
    counted = [m for m in MUTANTS if not m.equivalent]
    assert len(counted) >= 60
    assert {m.room for m in counted} == ROOMS
    assert len({(m.path, m.old, m.new) for m in MUTANTS}) == len({m.why for m in MUTANTS}) == len(MUTANTS)


def test_the_files_that_a_file_imports_from_are_found() -> None:
    text = "from fuzzynav.a import b\n    from fuzzynav import g  # now\nfrom fuzzynav.c import (\n  d,\n  e as f,\n)\n"
    known = [f"fuzzynav/{name}" for name in ("a.py", "c/__init__.py", "c/d.py", "c/e.py", "g/__init__.py", "h.py")]
    assert imports(text, known) == set(known[:-1])
