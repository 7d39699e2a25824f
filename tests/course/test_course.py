"""Exercises answer in a sentence; the handout scores nothing, the solutions score full."""

import csv
import json
import os
import sys
from pathlib import Path

import nbformat
import numpy as np
import pytest

from fuzzynav import course
from fuzzynav.course import Exercise, Wrong
from fuzzynav.course import exercises as exercise_folder
from fuzzynav.course.__main__ import main
from fuzzynav.course.exercise import judge
from fuzzynav.course.folders import notebooks_of
from fuzzynav.course.grading import grade_folder, prepare
from fuzzynav.course.handout import exercise_tag, reset, student_notebook, write_handout
from fuzzynav.course.reader import solution_blocks

HOME = Path(__file__).parents[2]
EXERCISES = course.all_exercises()


def double(answer):
    for value in (0.0, 1.5, -2.0):
        if answer(value) != 2 * value:
            raise Wrong(f"at {value} m the double is {2 * value} m, not {answer(value)} m.")
    return "It doubles every length."


DOUBLE = Exercise("98.1", "Double a length", 2, ("Add it to itself.",), double)


# --- one answer ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("answer", "sentence"),
    [
        (lambda x: 2 * x, "Exercise 98.1: right. It doubles every length."),
        (lambda x: ..., "Exercise 98.1: not answered yet."),
        (lambda x: (..., 1), "Exercise 98.1: not answered yet."),
        (..., "Exercise 98.1: not answered yet."),
        ({"gain": ...}, "Exercise 98.1: not answered yet."),
        (lambda x: x, "Exercise 98.1: not yet. at 1.5 m the double is 3.0 m, not 1.5 m."),
        (
            lambda x: 1 / 0,
            "Exercise 98.1: not yet. Your function stopped: it divided by zero (ZeroDivisionError: division by zero).",
        ),
        (lambda: 1, "Exercise 98.1: not yet. Your function stopped: it got or used a value of the wrong kind"),
        (lambda x: sys.exit(), "Exercise 98.1: not yet. Your function stopped: it tried to end Python"),
        ("text", "Exercise 98.1: not yet. The answer could not be used: it got or used a value of the wrong kind"),
        (None, "Exercise 98.1: not yet. The answer could not be used"),
    ],
)
def test_every_answer_gets_its_sentence(answer, sentence):
    outcome = judge(DOUBLE, answer)
    assert outcome.sentence.startswith(sentence)
    assert "\n" not in repr(outcome)
    assert outcome.points == (2 if "right" in sentence else 0)


def test_a_learner_may_stop_a_long_check():
    def interrupted(x):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        judge(DOUBLE, interrupted)


def test_array_answers_are_not_taken_for_dots():
    exercise = Exercise("98.2", "t", 1, ("h",), lambda a: f"{np.sum(a)}")
    assert judge(exercise, np.ones(3)).points == 1


@pytest.mark.parametrize("wrong", [{"id": "3.1"}, {"points": 0}, {"hints": ()}, {"title": ""}])
def test_an_exercise_is_complete(wrong):
    good = {"id": "03.1", "title": "t", "points": 1, "hints": ("h",), "check": double}
    with pytest.raises(ValueError, match="exercise"):
        Exercise(**{**good, **wrong})


# --- the exercises of the chapters --------------------------------------------------------------


def test_an_unknown_exercise_is_named():
    with pytest.raises(ValueError, match=r"no exercise '77\.7'"):
        course.check("77.7", 1)


def chapters_with_exercises() -> list[Path]:
    found = []
    for path in notebooks_of(HOME):
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        if any(exercise_tag(cell, "check") for cell in cells):
            found.append(path)
    return found


CHAPTERS = chapters_with_exercises()


def run_exercises(path: Path, answers: dict[str, str]) -> dict[str, str]:
    """The sentence of every check in a notebook: set-up cell, exercises (with answers put in), checks; nothing else."""
    names: dict[str, object] = {"__name__": "__main__"}
    said = {}
    cells = [c for c in json.loads(path.read_text(encoding="utf-8"))["cells"] if c["cell_type"] == "code"]
    exec(compile("".join(cells[0]["source"]), path.name, "exec"), names)
    for cell in cells:
        source = "".join(cell["source"])
        if name := exercise_tag(cell, "exercise"):
            exec(compile(answers.get(name, source), f"{path.name} {name}", "exec"), names)
        if name := exercise_tag(cell, "check"):
            said[name] = repr(eval(source, names))
    return said


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda p: p.stem)
def test_untouched_exercises_score_nothing(path):
    said = run_exercises(path, {})
    assert said
    assert all(s == f"Exercise {name}: not answered yet." for name, s in said.items())


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda p: p.stem)
def test_solutions_score_full(path):
    blocks = solution_blocks(path.parent / "solutions" / f"{path.stem}.py")
    said = run_exercises(path, blocks)
    assert set(blocks) == set(said), "each exercise has one solution block"
    assert all(s.startswith(f"Exercise {name}: right.") for name, s in said.items()), said


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda p: p.stem)
def test_absurd_answers_get_a_sentence(path):
    for value in ("None", "lambda *a, **k: None", "lambda *a, **k: 'text'", "-1e9", "[]"):
        for name in (n for n in EXERCISES if any(n in "".join(c["source"]) for c in _checks(path))):
            said = judge(EXERCISES[name], eval(value))
            assert said.points == 0, f"{name} accepts {value}"
            assert said.sentence.startswith(f"Exercise {name}: not")
            assert "\n" not in said.sentence


def _checks(path: Path) -> list[dict]:
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return [c for c in cells if exercise_tag(c, "check")]


# --- handing out, grading, restoring ------------------------------------------------------------

MODULE = """
from fuzzynav.course import Exercise, Wrong

def double(answer):
    if answer(1.5) != 3.0:
        raise Wrong(f"the double of 1.5 m is 3.0 m, not {answer(1.5)} m.")
    return "It doubles."

EXERCISES = tuple(Exercise(f"98.{k}", f"Double {k}", k, ("Add.",), double) for k in range(1, 6))
"""


def code(source: str, *tags: str) -> dict:
    return nbformat.v4.new_code_cell(source, metadata={"tags": list(tags)} if tags else {})


def notebook(answers: dict[int, str]) -> nbformat.NotebookNode:
    cells = [code("from fuzzynav import course")]
    for k in range(1, 6):
        cells.append(code(answers.get(k, f"def f{k}(x):\n    return ..."), f"exercise:98.{k}"))
        cells.append(code(f'course.check("98.{k}", f{k})', f"check:98.{k}"))
    return nbformat.v4.new_notebook(cells=cells)


SOLUTIONS = {k: f"def f{k}(x):\n    return 2 * x" for k in range(1, 6)}


@pytest.fixture
def small_course(tmp_path, monkeypatch):
    """A course of one notebook with five exercises, known here and in the kernels that grading starts."""
    root = tmp_path / "course"
    for folder in ("notebooks/solutions", "data/published", "fuzzynav"):
        (root / folder).mkdir(parents=True)
    (root / "fuzzynav" / "__init__.py").write_text('"""A package."""\n')
    (root / "data" / "published" / "claims.csv").write_text("id\n")
    nbformat.write(notebook({}), root / "notebooks" / "98_double.ipynb")
    (root / "notebooks" / "solutions" / "98_double.py").write_text(
        "\n".join(f"# %% 98.{k}\n{text}" for k, text in SOLUTIONS.items())
    )
    extra = tmp_path / "extra"
    extra.mkdir()
    (extra / "ch98.py").write_text(MODULE)
    (extra / "sitecustomize.py").write_text(
        f"import fuzzynav.course.exercises as e\ne.__path__.append({str(extra)!r})\n"
    )
    monkeypatch.setattr(exercise_folder, "__path__", [*exercise_folder.__path__, str(extra)])
    monkeypatch.setenv("PYTHONPATH", str(extra) + os.pathsep + os.environ.get("PYTHONPATH", ""))
    monkeypatch.chdir(root)
    yield root
    sys.modules.pop("fuzzynav.course.exercises.ch98", None)


def hand_in(folder: Path, student: str, book: nbformat.NotebookNode) -> None:
    (folder / student).mkdir(parents=True)
    nbformat.write(book, folder / student / "98_double.ipynb")


def test_grading_is_fair_to_everyone(small_course, tmp_path):
    folder = tmp_path / "in"
    handout = write_handout(small_course, tmp_path / "handout")
    hand_in(folder, "ann", nbformat.read(handout / "notebooks" / "98_double.ipynb", 4))
    hand_in(folder, "bob", notebook(SOLUTIONS))
    trouble = notebook(
        {
            1: "def f1(x):\n    return x",
            2: "def f2(x):\n    while True: pass",
            3: "import os\nos._exit(1)",
            4: SOLUTIONS[4],
            5: "def f5(x):\n    return 7\nclass course:\n    check = print",
        }
    )
    del trouble.cells[8]  # the check cell of exercise 4
    trouble.cells[-1].source = 'print("all points")'
    hand_in(folder, "cleo", trouble)
    (folder / "dan").mkdir()
    (folder / "eve").mkdir()
    (folder / "eve" / "98_double.ipynb").write_text("{ cut in the mid")
    found = {(g.student, g.exercise[-1]): g for g in grade_folder(small_course, folder, seconds=12, jobs=2)}
    assert len(found) == 25
    assert [found["ann", k].points for k in "12345"] == [0] * 5
    assert found["ann", "1"].sentence == "Exercise 98.1: not answered yet."
    assert [found["bob", k].points for k in "12345"] == [1, 2, 3, 4, 5]
    assert [found["cleo", k].points for k in "12345"] == [0, 0, 0, 4, 0]
    assert found["cleo", "1"].sentence == "Exercise 98.1: not yet. the double of 1.5 m is 3.0 m, not 1.5 m."
    assert "longer than 12 s" in found["cleo", "2"].sentence
    assert "ended Python" in found["cleo", "3"].sentence
    assert "not 7 m" in found["cleo", "5"].sentence
    assert "no notebook handed in" in found["dan", "1"].sentence
    assert "cannot be read" in found["eve", "1"].sentence


def test_grade_command_writes_a_table(small_course, tmp_path, capsys):
    hand_in(tmp_path / "in", "bob", notebook(SOLUTIONS))
    assert main(["grade", str(tmp_path / "in"), "--out", str(tmp_path / "grades.csv")]) == 0
    with (tmp_path / "grades.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert [r["points"] for r in rows] == list("12345")
    assert list(rows[0]) == ["student", "exercise", "points", "sentence"]
    assert "1 students, 5 exercises" in capsys.readouterr().out


def test_check_cells_return_to_their_places():
    book = notebook(SOLUTIONS)
    reference = notebook({})
    del book.cells[2]
    book.cells.insert(3, nbformat.v4.new_code_cell("more = 1"))
    tags = [exercise_tag(c, "exercise", "check") for c in prepare(book, reference).cells]
    assert tags == ["", "98.1", "98.1", "98.2", "", "98.2", "98.3", "98.3", "98.4", "98.4", "98.5", "98.5"]


def test_nothing_to_grade_is_said(small_course, tmp_path, capsys):
    assert main(["grade", str(tmp_path / "nowhere")]) == 2
    assert "there is no folder nowhere" in capsys.readouterr().err
    (tmp_path / "empty").mkdir()
    assert main(["grade", str(tmp_path / "empty")]) == 2
    assert "one folder for each student" in capsys.readouterr().err


def test_handout_holds_no_solutions_and_replaces_the_old_whole(small_course, tmp_path):
    book = notebook({})
    book.cells[2].outputs = [nbformat.v4.new_output("stream", name="stdout", text="x")]
    book.cells[2].execution_count = 3
    nbformat.write(book, small_course / "notebooks" / "98_double.ipynb")
    target = tmp_path / "out"
    target.mkdir()
    (target / "old").write_text("old")
    write_handout(small_course, target)
    names = {p.relative_to(target).as_posix() for p in target.rglob("*") if p.is_file()}
    assert names == {
        "fuzzynav/__init__.py",
        "data/published/claims.csv",
        "notebooks/98_double.ipynb",
        "notebooks/.pristine/98_double.ipynb",
    }
    cells = json.loads((target / "notebooks/98_double.ipynb").read_text())["cells"]
    assert all(c["outputs"] == [] and c["execution_count"] is None for c in cells if exercise_tag(c, "check"))
    assert not list(tmp_path.glob(".handout-*"))


def test_a_failing_handout_leaves_the_old_one(small_course, tmp_path):
    target = tmp_path / "out"
    write_handout(small_course, target)
    (small_course / "notebooks" / "97_bad.ipynb").write_text("not json")
    with pytest.raises(ValueError, match="Expecting value"):
        write_handout(small_course, target)
    assert (target / "notebooks" / "98_double.ipynb").is_file()


def test_reset_in_a_students_edition_keeps_a_backup(small_course, tmp_path, capsys, monkeypatch):
    edition = write_handout(small_course, tmp_path / "edition")
    mine = edition / "notebooks" / "98_double.ipynb"
    before = mine.read_text()
    mine.write_text("my own work")
    monkeypatch.chdir(edition / "notebooks")
    assert main(["reset", "98"]) == 0
    assert mine.read_text() == before
    (backup,) = (edition / "notebooks" / "backup").iterdir()
    assert backup.read_text() == "my own work"
    assert backup.name in capsys.readouterr().out
    assert reset(edition, "98") == [(mine, None)]
    mine.unlink()
    reset(edition, "98")
    assert mine.read_text() == before


def test_reset_in_a_checkout_asks_git(small_course, capsys):
    import subprocess

    def git(*words):
        subprocess.run(
            ["git", "-c", "user.name=a", "-c", "user.email=a@b", *words],
            cwd=small_course,
            check=True,
            capture_output=True,
        )

    assert main(["reset", "98"]) == 2
    assert "neither a students' edition nor a git checkout" in capsys.readouterr().err
    git("init", "-q")
    git("add", "-A")
    git("commit", "-qm", "begin")
    path = small_course / "notebooks" / "98_double.ipynb"
    before = path.read_text()
    path.write_text("changed")
    assert main(["reset", "98"]) == 0
    assert path.read_text() == before
    assert main(["reset", "44"]) == 2
    assert "no notebook that begins with '44'" in capsys.readouterr().err


def test_a_missing_solution_is_said_politely(small_course):
    assert "return 2 * x" in repr(course.solution("98.2"))
    (small_course / "notebooks" / "solutions" / "98_double.py").unlink()
    (small_course / "notebooks" / "solutions").rmdir()
    assert "not part of this edition" in repr(course.solution("98.2"))


def test_grade_mode_raises_the_sentence(small_course, monkeypatch):
    monkeypatch.setenv("FUZZYNAV_GRADE", "1")
    with pytest.raises(AssertionError, match=r"the double of 1\.5 m is 3\.0 m"):
        course.check("98.1", lambda x: x)
    assert course.check("98.1", lambda x: 2 * x).points == 1


def test_students_keep_other_outputs(small_course):
    path = small_course / "notebooks" / "98_double.ipynb"
    book = notebook({})
    for cell in book.cells:
        cell.outputs = [nbformat.v4.new_output("stream", name="stdout", text="x")]
    nbformat.write(book, path)
    kept = [bool(cell["outputs"]) for cell in student_notebook(path)["cells"]]
    assert kept == [True] + [False] * 10
