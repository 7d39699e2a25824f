"""Exercises answer in a sentence; the handout scores nothing, the solutions score full."""

import csv
import json
import os
import shutil
import sys
from pathlib import Path

import nbformat
import numpy as np
import psutil
import pytest

from fuzzynav import course
from fuzzynav.course import Exercise, Wrong, grading
from fuzzynav.course import exercises as exercise_folder
from fuzzynav.course.__main__ import main
from fuzzynav.course.exercise import judge
from fuzzynav.course.folders import notebooks_of
from fuzzynav.course.grading import GradeFile, grade_folder, prepare, read_grade
from fuzzynav.course.handins import Reference, choose, hand_ins, read_cells
from fuzzynav.course.handout import exercise_tag, reset, student_notebook, student_readme, write_handout
from fuzzynav.course.reader import GRADE_MIME, solution_blocks

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
    monkeypatch.setattr(exercise_folder, "__path__", [*exercise_folder.__path__, str(extra)])
    package = tmp_path / "package" / "fuzzynav"  # what grading copies for the students' code
    shutil.copytree(HOME / "fuzzynav", package, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(extra / "ch98.py", package / "course" / "exercises")
    monkeypatch.setattr(grading, "PACKAGE", package)
    monkeypatch.chdir(root)
    yield root
    sys.modules.pop("fuzzynav.course.exercises.ch98", None)


@pytest.fixture
def whole_course(small_course):
    """The small course with the real data, which the chapters' checks read when they are imported."""
    shutil.rmtree(small_course / "data")
    (small_course / "data").symlink_to(HOME / "data")
    return small_course


def hand_in(folder: Path, student: str, book: nbformat.NotebookNode) -> None:
    (folder / student).mkdir(parents=True)
    nbformat.write(book, folder / student / "98_double.ipynb")


def test_grading_is_fair_to_everyone(whole_course, tmp_path):
    folder = tmp_path / "in"
    handout = write_handout(whole_course, tmp_path / "handout")
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
    found = {(g.student, g.exercise[-1]): g for g in grade_folder(whole_course, folder, seconds=12, jobs=2)}
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


def test_grade_command_writes_a_table(whole_course, tmp_path, capsys):
    hand_in(tmp_path / "in", "bob", notebook(SOLUTIONS))
    assert main(["grade", str(tmp_path / "in"), "--out", str(tmp_path / "grades.csv")]) == 0
    with (tmp_path / "grades.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert [r["points"] for r in rows] == list("12345")
    assert list(rows[0]) == ["student", "exercise", "points", "of", "sentence", "remark"]
    assert [r["of"] for r in rows] == list("12345")
    assert "1 students, 5 exercises" in capsys.readouterr().out


def reference() -> Reference:
    return Reference("98_double", tuple(notebook({}).cells), ())


def test_check_cells_return_to_their_places():
    book = notebook(SOLUTIONS)
    del book.cells[2]
    book.cells.insert(3, nbformat.v4.new_code_cell("more = 1"))
    cells = prepare(book.cells, reference())
    tags = [exercise_tag(c, "exercise", "check") for c in cells]
    assert tags[1:-5] == ["", "98.1", "98.1", "98.2", "", "98.2", "98.3", "98.3", "98.4", "98.4", "98.5", "98.5"]
    assert cells[0].source == "from fuzzynav import course"
    assert [exercise_tag(c, "again") for c in cells[-5:]] == [f"98.{k}" for k in range(1, 6)]


def test_a_second_or_foreign_check_cell_is_dropped():
    book = notebook(SOLUTIONS)
    book.cells += [code("course.points = 9", "check:98.1"), code("course.points = 9", "check:77.1")]
    assert not [c for c in prepare(book.cells, reference()) if "points = 9" in c.source]


def graded(*records: dict) -> nbformat.NotebookNode:
    data = [{"output_type": "display_data", "metadata": {}, "data": {GRADE_MIME: r}} for r in records]
    cell = code("", "check:98.1")
    cell.outputs = [nbformat.from_dict(d) for d in data]
    return cell


def test_only_the_record_of_the_exercise_counts_and_never_above_its_points():
    right = {"exercise": "98.1", "points": 2, "sentence": "right"}
    other = {"exercise": "98.2", "points": 1, "sentence": "other"}
    assert read_grade([graded(other, right)], "98.1", 2).points == 2
    for forged in ({**right, "points": 1000}, {**right, "points": "2"}, {**right, "points": -1}, other, [], "2"):
        assert read_grade([graded(forged)], "98.1", 2).points == 0, forged


CHEATS = {
    "checks": "course.check = lambda *a: print('full')",
    "judge": "from fuzzynav.course import reader, exercise\n"
    "reader.judge = exercise.judge = lambda e, a: exercise.Outcome(e.id, e.points, 'full')",
    "solutions": "from pathlib import Path; import fuzzynav\n"
    "exec(next((Path(fuzzynav.__file__).parents[1] / 'notebooks/solutions').glob('*.py')).read_text())",
    "package": "from pathlib import Path; import fuzzynav.course.exercises.ch98 as m\n"
    "Path(m.__file__).write_text('broken')",
}


def test_no_cheat_raises_points_or_reaches_others(whole_course, tmp_path):
    for name, source in CHEATS.items():
        hand_in(tmp_path / "in", name, notebook({1: source, 5: source}))
    hand_in(tmp_path / "in", "zoe", notebook(SOLUTIONS))
    points: dict[str, int] = {}
    for grade in grade_folder(whole_course, tmp_path / "in", seconds=30, jobs=2):
        points[grade.student] = points.get(grade.student, 0) + grade.points
    assert points == {**dict.fromkeys(CHEATS, 0), "zoe": 15}


def test_changed_files_of_the_course_are_put_back(tmp_path):
    file = tmp_path / "a.py"
    file.write_bytes(b"1")
    grade = grading.Grade("ann", "98.1", 1, 1, "right")
    assert grading._restored([grade], {file: b"1"}) == [grade]
    (noted,) = grading._restored([grade], {file: b"2"})
    assert file.read_bytes() == b"2"
    assert "put back: a.py" in noted.remark


def test_floods_and_children_are_ended_and_late_answers_count(whole_course, tmp_path):
    child = "import subprocess, sys\nsubprocess.Popen([sys.executable, '-c', 'import time; time.sleep(3217)'])"
    late = notebook({1: "while True:\n    print('x' * 1000)", 2: child})
    late.cells += [code(SOLUTIONS[3]), code("def f4(x):\n    return 2 * x")]
    hand_in(tmp_path / "in", "lea", late)
    grades = {g.exercise: g for g in grade_folder(whole_course, tmp_path / "in", seconds=40)}
    assert "printed more than 2 MB" in grades["98.1"].sentence
    assert [grades[f"98.{k}"].points for k in range(1, 6)] == [0, 0, 3, 4, 0]
    assert not [p for p in psutil.process_iter(["cmdline"]) if "time.sleep(3217)" in str(p.info["cmdline"])]


@pytest.mark.parametrize(
    "name", ["98_double (1).ipynb", "98_double-Copy1.ipynb", "98_double_smith.ipynb", "98.ipynb", "homework.ipynb"]
)
def test_renamed_files_are_found(tmp_path, name):
    folder = tmp_path / "ann"
    folder.mkdir()
    nbformat.write(notebook({}), folder / name)
    target = Reference("98_double", (), (DOUBLE,))
    choice = choose(hand_ins(tmp_path)["ann"], target)
    assert choice.path == folder / name
    assert bool(choice.remark) == ("98_double" not in name)


def test_copies_that_jupyter_or_the_course_made_never_count(tmp_path):
    for place in (".ipynb_checkpoints", "notebooks/.pristine", "notebooks/backup", "notebooks"):
        (tmp_path / "ann" / place).mkdir(parents=True, exist_ok=True)
        nbformat.write(notebook({}), tmp_path / "ann" / place / "98_double.ipynb")
    choice = choose(hand_ins(tmp_path)["ann"], Reference("98_double", (), (DOUBLE,)))
    assert choice.path == tmp_path / "ann" / "notebooks" / "98_double.ipynb"
    assert choice.remark == ""


def test_the_shallowest_then_the_newest_counts_and_that_is_said(tmp_path):
    for k, place in enumerate(("attempt1", "attempt2", "old/deep")):
        path = tmp_path / "ann" / place / "98_double.ipynb"
        path.parent.mkdir(parents=True)
        nbformat.write(notebook({}), path)
        os.utime(path, (1e9 + k, 1e9 + k))
    choice = choose(hand_ins(tmp_path)["ann"], Reference("98_double", (), (DOUBLE,)))
    assert choice.path == tmp_path / "ann" / "attempt2" / "98_double.ipynb"
    assert choice.remark == (
        "attempt2/98_double.ipynb was graded, not attempt1/98_double.ipynb, old/deep/98_double.ipynb"
    )


def test_a_flat_download_is_sorted_by_student(tmp_path):
    for name in ("mulleranna_123_456_98_double.ipynb", "smithbob_late_124_457_98_double-1.ipynb"):
        nbformat.write(notebook({}), tmp_path / name)
    assert list(hand_ins(tmp_path)) == ["mulleranna_123", "smithbob_124"]


GOOD_CELL = '{"cell_type": "code", "source": ["x = 1"], "metadata": {}, "outputs": []}'
MALFORMED = [
    "", "null", "1", '"text"', "[]", "{}", "{ cut", "<html>", '{"cells": null}', '{"cells": {}}', '{"cells": "x"}',
    '{"cells": 7}', '{"worksheets": 1}', "[" * 100_000, "\ufeff" + "{}", '{"metadata": []}', "NaN", "\x00",
]  # fmt: skip
DAMAGED = [
    "null", "1", '"text"', "[]", "{}", '{"cell_type": 3}', '{"cell_type": []}', '{"cell_type": "code"}',
    '{"cell_type": "code", "source": 7}', '{"cell_type": "code", "source": [7, null]}',
    '{"cell_type": "code", "source": {"a": 1}}', '{"cell_type": "code", "source": "y", "metadata": null}',
    '{"cell_type": "code", "source": "y", "metadata": []}', '{"cell_type": "code", "source": "y", "metadata": "t"}',
    '{"cell_type": "code", "source": "y", "metadata": {"tags": 5}}',
    '{"cell_type": "code", "source": "y", "metadata": {"tags": {"a": 1}}}',
    '{"cell_type": "code", "source": "y", "metadata": {"tags": [1, null, ["check:98.1"]]}}',
    '{"cell_type": "code", "source": "y", "outputs": 5}', '{"cell_type": "code", "source": "\\ud800"}',
    '{"cell_type": "markdown", "source": null}', '{"cell_type": "raw"}',
]  # fmt: skip


@pytest.mark.parametrize("text", MALFORMED, ids=range(len(MALFORMED)))
def test_a_malformed_notebook_is_one_sentence(tmp_path, text):
    path = tmp_path / "98_double.ipynb"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=r"^the notebook cannot be read: it .*$"):
        read_cells(path)


@pytest.mark.parametrize("cell", DAMAGED, ids=range(len(DAMAGED)))
def test_a_damaged_cell_costs_no_other(tmp_path, cell):
    path = tmp_path / "98_double.ipynb"
    path.write_text(f'{{"cells": [{cell}, {GOOD_CELL}]}}', encoding="utf-8")
    cells = read_cells(path)
    assert cells[-1].source == "x = 1"
    prepared = prepare(cells, reference())
    assert [exercise_tag(c, "check") for c in prepared if exercise_tag(c, "check")] == [f"98.{k}" for k in range(1, 6)]
    assert all(c.source.encode() is not None for c in prepared)


def test_old_and_utf16_notebooks(tmp_path):
    path = tmp_path / "98_double.ipynb"
    path.write_text('{"worksheets": [{"cells": [{"cell_type": "code", "input": "a = 1"}]}]}')
    assert [c.source for c in read_cells(path)] == ["a = 1"]
    path.write_text("{}", encoding="utf-16")
    with pytest.raises(ValueError, match="not JSON in UTF-8"):
        read_cells(path)


def test_rows_stay_when_the_run_is_interrupted_and_older_grades_are_kept(small_course, tmp_path, monkeypatch, capsys):
    out = tmp_path / "grades.csv"
    out.write_text("last week")
    for student in ("ann", "bob"):
        (tmp_path / "in" / student).mkdir(parents=True)

    def interrupted(futures):
        yield next(iter(futures))
        raise KeyboardInterrupt

    monkeypatch.setattr(grading, "as_completed", interrupted)
    assert main(["grade", str(tmp_path / "in"), "--out", str(out), "--notebook", "98"]) == 130
    assert "what was finished is kept" in capsys.readouterr().err
    assert [line[:8] for line in out.read_text().splitlines()[1:]] == [f"ann,98.{k}" for k in range(1, 6)]
    assert (tmp_path / "grades.1.csv").read_text() == "last week"
    GradeFile(out)
    assert (tmp_path / "grades.2.csv").exists()


def test_no_cell_of_the_table_is_a_formula(tmp_path):
    file = GradeFile(tmp_path / "grades.csv")
    file.append([grading.Grade("=HYPERLINK(1)", "98.1", 0, 1, "-1 is wrong", "@x")])
    assert file.path.read_text().splitlines()[1] == "'=HYPERLINK(1),98.1,0,1,'-1 is wrong,'@x"


def test_the_students_readme_promises_only_what_is_there():
    text = student_readme((HOME / "README.md").read_text(encoding="utf-8"))
    assert "make lab" in text
    for gone in ("make test ", "solutions/", "For teachers", "make grade", "not for students"):
        assert gone not in text, gone


def test_reset_of_a_notebook_that_is_not_utf8(small_course, tmp_path):
    edition = write_handout(small_course, tmp_path / "edition")
    mine = edition / "notebooks" / "98_double.ipynb"
    before = mine.read_bytes()
    mine.write_bytes("my own work".encode("utf-16"))
    ((path, backup),) = reset(edition, "98")
    assert path.read_bytes() == before
    assert backup is not None
    assert backup.read_bytes().decode("utf-16") == "my own work"


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
