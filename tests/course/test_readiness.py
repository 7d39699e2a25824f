"""The start page: the map of the course and the check of the computer."""

import csv
import re

from fuzzynav import course
from fuzzynav.course import readiness
from fuzzynav.course.overview import CHAPTERS, CourseMap
from fuzzynav.course.readiness import Finding, Readiness


def test_the_map_lists_every_chapter_and_links_those_present(tmp_path):
    (tmp_path / "notebooks").mkdir()
    for name in ("00_start_here", "05a_search", "05b_smoothing"):
        (tmp_path / "notebooks" / f"{name}.ipynb").write_text("{}")
    table = CourseMap(tmp_path).markdown("notebooks/")
    assert table.count("\n") == len(CHAPTERS) + 1
    assert "[00 Start here](notebooks/00_start_here.ipynb)" in table
    assert "[05a](notebooks/05a_search.ipynb), [05b](notebooks/05b_smoothing.ipynb)" in table
    assert "03 Fuzzy sets and inference (to come)" in table
    assert repr(CourseMap(tmp_path)) == "Course map: 00 Start here, 05 Global planning"


def test_every_notebook_is_on_the_map(home):
    numbers = {c.number for c in CHAPTERS}
    assert {p.name[:2] for p in (home / "notebooks").glob("*.ipynb")} <= numbers
    assert all(10 <= c.minutes <= 90 and c.question.endswith("?") for c in CHAPTERS)


def test_sections_named_on_the_map_are_of_the_thesis(home):
    with (home / "data/published/items.csv").open(encoding="utf-8") as stream:
        known = {row["chapter"] for row in csv.DictReader(stream) if row["source"] == "thesis"}
    for chapter in CHAPTERS:
        for section in re.findall(r"\d\.\d", chapter.source):
            assert section[0] in known


def test_this_computer_is_ready_or_says_what_is_missing():
    report = course.ready()
    assert [f.part for f in report.findings] == ["Python", "Packages", "Compiled kernels", "Sliders", "Published data"]
    faults = [f for f in report.findings if not f.well and f.part != "Compiled kernels"]
    assert not faults, repr(report)
    assert "| Part | State | In words |" in report._repr_markdown_()


def test_an_old_python_is_named():
    assert readiness.python((3, 10)) == Finding("Python", False, "this is 3.10, the course needs 3.11 or newer")
    assert readiness.python((3, 13)).well


def test_missing_and_untested_packages_are_named():
    missing = readiness.packages(("numpy", "no-such-package"), {})
    assert not missing.well
    assert "not installed: no-such-package; close Jupyter and run `make lab` again" in missing.words
    other = readiness.packages(("numpy",), {"numpy": {"0.1", "0.2"}})
    assert other.well
    assert "(tested with 0.1 or 0.2)" in other.words
    assert readiness.packages(("numpy",), {}).words == "all installed, in the versions that were tested"


def test_kernels_that_are_not_compiled_are_named(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    cold = readiness.kernels(("fuzzynav.control",))
    assert not cold.well
    assert "python -m fuzzynav.warm" in cold.words
    (tmp_path / "control.f-1.py311.nbi").write_text("")
    assert readiness.kernels(("fuzzynav.control",)).well
    assert not readiness.kernels(("fuzzynav.no_such_module",)).well


def test_missing_widgets_and_data_are_findings(tmp_path, monkeypatch):
    monkeypatch.setattr(readiness, "_version", lambda name: None)
    assert "ipywidgets" in readiness.widgets().words

    def lost():
        raise FileNotFoundError("no course found")

    monkeypatch.setattr(readiness, "course_root", lost)
    finding = readiness._checked("Published data", readiness.data)
    assert not finding.well
    assert "no course found" in finding.words


def test_the_closing_sentence_names_the_faults():
    report = Readiness((Finding("Python", True, "x"), Finding("Sliders", False, "y")))
    assert report.sentence == "Something is missing: sliders. The table says what to do."
    assert "**missing**" in report._repr_markdown_()
