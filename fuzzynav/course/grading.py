"""Grading: students' notebooks run with the untouched check cells, each with a time limit, away from the course."""

from __future__ import annotations

import csv
import os
import shutil
import tempfile
import threading
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path
from typing import Any

import nbformat
from nbformat import NotebookNode

from fuzzynav.course.execution import Stopped, end_all, run_cells
from fuzzynav.course.handins import Reference, choose, hand_ins, read_cells, references
from fuzzynav.course.handout import exercise_tag
from fuzzynav.course.reader import GRADE_MIME, all_exercises
from fuzzynav.lab.plain import Guard, plain_words
from fuzzynav.stale import PACKAGE

__all__ = ["Grade", "GradeFile", "Task", "grade_folder", "grade_notebook", "list_tasks", "prepare"]

# the course anew: a notebook may have put something else in the place of its functions
PREFIX = """import sys as _sys
for _name in [n for n in _sys.modules if n == "fuzzynav.course" or n.startswith("fuzzynav.course.")]:
    del _sys.modules[_name]
import fuzzynav.course as course
"""


@dataclass(frozen=True, slots=True)
class Grade:
    """One line of the result: who, which exercise, how many points of how many, why, and what the grader noticed."""

    student: str
    exercise: str
    points: int
    of: int
    sentence: str
    remark: str = ""


@dataclass(frozen=True, slots=True)
class Task:
    """One notebook of one student, or the exercises of a notebook that was not handed in."""

    student: str
    path: Path | None
    reference: Reference
    remark: str = ""


class GradeFile:
    """A CSV of grades: rows are there as soon as they are known, an older file is kept under a number.

    The columns are the fields of Grade. What a spreadsheet would take for a formula begins with an apostrophe.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.kept = path, self._keep_old(path)
        self._write("w", [[f.name for f in fields(Grade)]])

    def append(self, grades: Iterable[Grade]) -> None:
        """Add rows at the end."""
        self._write("a", [[harmless(value) for value in astuple(grade)] for grade in grades])

    def replace(self, grades: Iterable[Grade]) -> None:
        """Write the rows anew, in this order; whole or not at all."""
        fresh = GradeFile.__new__(GradeFile)
        fresh.path = self.path.with_name(self.path.name + ".new")
        fresh._write("w", [[f.name for f in fields(Grade)]])
        fresh.append(grades)
        os.replace(fresh.path, self.path)

    def _write(self, mode: str, rows: Sequence[Sequence[object]]) -> None:
        with self.path.open(mode, encoding="utf-8", newline="") as stream:
            csv.writer(stream, lineterminator="\n").writerows(rows)

    @staticmethod
    def _keep_old(path: Path) -> Path | None:
        if not path.exists():
            return None
        number = 1
        while (kept := path.with_name(f"{path.stem}.{number}{path.suffix}")).exists():
            number += 1
        path.rename(kept)
        return kept


def harmless(value: object) -> object:
    """A cell that no spreadsheet takes for a formula.

    >>> harmless("=1+1"), harmless("ann"), harmless(-1)
    ("'=1+1", 'ann', -1)
    """
    return "'" + value if isinstance(value, str) and value.lstrip()[:1] in ("=", "+", "-", "@") else value


def grade_folder(
    root: Path,
    handed_in: Path,
    *,
    chapter: str = "",
    seconds: int = 60,
    jobs: int = 1,
    report: Callable[[list[Grade]], object] | None = None,
) -> list[Grade]:
    """Grades of every notebook of a chapter ('' for all) in `handed_in/<student>/`, by student and exercise.

    `seconds` limits each cell; `report` gets the grades of each notebook as soon as they are known. Raises
    FileNotFoundError if the folder is missing, ValueError if it holds no hand-ins or the chapter has no exercises.
    """
    tasks = list_tasks(root, handed_in, chapter)
    grades: list[Grade] = []
    stop = threading.Event()
    pool = ThreadPoolExecutor(max_workers=max(1, jobs))
    guarded = {path: path.read_bytes() for path in PACKAGE.rglob("*.py")}
    try:
        running = [pool.submit(_grade_task, root, task, seconds, stop) for task in tasks]
        for future in as_completed(running):
            done = _restored(future.result(), guarded)
            grades += done
            if report is not None:
                report(done)
    finally:
        stop.set()
        end_all()
        pool.shutdown(cancel_futures=True)
    order = {name: k for k, name in enumerate(all_exercises())}
    return sorted(grades, key=lambda g: (g.student, order[g.exercise]))


def list_tasks(root: Path, handed_in: Path, chapter: str = "") -> list[Task]:
    """Everything there is to grade: each student and each notebook of the chapter that has exercises."""
    asked, students, tasks = references(root, chapter), hand_ins(handed_in), []
    for reference in asked:
        for student, files in students.items():
            choice = choose(files, reference)
            tasks.append(Task(student, choice.path, reference, choice.remark))
    return tasks


def prepare(handed_in: Iterable[NotebookNode], reference: Reference) -> list[NotebookNode]:
    """The student's code cells with the untouched check cells in place of whatever stands there.

    The set-up cell of the course comes first. A check cell goes where the student's own stands, else behind the
    exercise, else at the end; all run once more at the very end, for answers written below them.
    """
    checks = {name: _source(cell) for cell in reference.cells if (name := exercise_tag(cell, "check"))}
    left, kept = dict(checks), []
    for cell in handed_in:
        name = exercise_tag(cell, "check")
        if name in left:
            kept.append(_check_cell("check", name, left.pop(name)))
        elif not name:
            kept.append(cell)
    for name, source in left.items():
        places = [k for k, c in enumerate(kept) if exercise_tag(c, "exercise") == name]
        kept.insert(places[-1] + 1 if places else len(kept), _check_cell("check", name, source))
    first = next((_source(c) for c in reference.cells if c["cell_type"] == "code" and not _tagged(c)), "")
    again = [_check_cell("again", name, source) for name, source in checks.items()]
    return [nbformat.v4.new_code_cell(first), *kept, *again]


def grade_notebook(
    cells: list[NotebookNode],
    reference: Reference,
    folder: Path,
    seconds: int,
    stop: threading.Event | None = None,
) -> list[Grade]:
    """Grades of the prepared cells run in `folder`; student is left empty.

    A cell that crashes the kernel, runs too long or prints without end is taken out, costs its own exercise, and the
    rest runs again without it.
    """
    lost: dict[str, str] = {}
    cells = list(cells)
    run: list[NotebookNode] = []
    for _ in range(len(cells) + 1):
        if stop is not None and stop.is_set():
            break
        run = [nbformat.v4.new_code_cell(c.source, metadata=dict(c.metadata)) for c in cells]
        stopped: Stopped | None = run_cells(run, folder, seconds, stop)
        if stopped is None:
            break
        name = exercise_tag(cells[stopped.index], "exercise", "check")
        if name:
            lost[name] = stopped.reason
        cells.pop(stopped.index)
    return [read_grade(run, e.id, e.points, lost.get(e.id)) for e in reference.exercises]


def read_grade(run: Iterable[NotebookNode], name: str, of: int, lost: str | None = None) -> Grade:
    """The better of what the two runs of a check said; never more than the exercise is worth."""
    if lost is not None:
        return Grade("", name, 0, of, f"Exercise {name}: not yet. The answer did not finish: {lost}.")
    said: list[Grade] = []
    for cell in run:
        if exercise_tag(cell, "check", "again") == name:
            said += _said(cell.get("outputs", []), name, of)
    fallback = Grade("", name, 0, of, f"Exercise {name}: the check gave no result.")
    return max(said, key=lambda grade: grade.points, default=fallback)


def _said(outputs: Iterable[Any], name: str, of: int) -> list[Grade]:
    for output in outputs:
        record = output.get("data", {}).get(GRADE_MIME)
        if isinstance(record, dict) and record.get("exercise") == name and record.get("points") in range(of + 1):
            return [Grade("", name, int(record["points"]), of, str(record.get("sentence")))]
    errors = [o for o in outputs if o.get("output_type") == "error"]
    why = f"{errors[-1].ename}: {errors[-1].evalue}" if errors else ""
    return [Grade("", name, 0, of, f"Exercise {name}: not yet. The answer is missing ({why}).")] if errors else []


def _grade_task(root: Path, task: Task, seconds: int, stop: threading.Event) -> list[Grade]:
    def nothing(why: str) -> list[Grade]:
        return [
            Grade(task.student, e.id, 0, e.points, f"Exercise {e.id}: {why}.", task.remark)
            for e in task.reference.exercises
        ]

    if task.path is None:
        return nothing("no notebook handed in")
    guard = Guard()  # whatever a hand-in does, the others are graded
    with guard, tempfile.TemporaryDirectory(prefix="fuzzynav-grade-", ignore_cleanup_errors=True) as scratch:
        cells = prepare(read_cells(task.path), task.reference)
        folder = Path(scratch) / "notebooks"
        folder.mkdir()
        shutil.copytree(root / "data", Path(scratch) / "data")
        shutil.copytree(PACKAGE, Path(scratch) / "fuzzynav")  # no solutions beside it, and nothing to spoil
        found = grade_notebook(cells, task.reference, folder, seconds, stop)
        return [replace(grade, student=task.student, remark=task.remark) for grade in found]
    return nothing(plain_words(guard.error).rstrip(".") if guard.error else "it could not be graded")


def _restored(grades: list[Grade], guarded: dict[Path, bytes]) -> list[Grade]:
    """The grades; with a remark if the course's own files had to be put back."""
    changed = [path for path, text in guarded.items() if not path.exists() or path.read_bytes() != text]
    for path in changed:
        path.write_bytes(guarded[path])
    if not changed:
        return grades
    note = f"files of the course were changed while this ran and were put back: {', '.join(p.name for p in changed)}"
    return [replace(g, remark="; ".join(filter(None, (g.remark, note)))) for g in grades]


def _tagged(cell: dict[str, Any]) -> bool:
    return bool(exercise_tag(cell, "exercise", "check"))


def _source(cell: dict[str, Any]) -> str:
    source = cell["source"]
    return source if isinstance(source, str) else "".join(source)


def _check_cell(kind: str, name: str, source: str) -> NotebookNode:
    made: NotebookNode = nbformat.v4.new_code_cell(PREFIX + source, metadata={"tags": [f"{kind}:{name}"]})
    return made
