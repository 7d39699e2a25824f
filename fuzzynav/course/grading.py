"""Grading: students' notebooks run with the untouched check cells, each with a time limit."""

from __future__ import annotations

import csv
import io
import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from typing import Any

import nbformat
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient
from nbclient.exceptions import CellTimeoutError, DeadKernelError
from nbformat import NotebookNode

from fuzzynav.course.exercise import Exercise
from fuzzynav.course.folders import notebooks_of, write_whole
from fuzzynav.course.handout import exercise_tag
from fuzzynav.course.reader import GRADE_MIME, all_exercises

__all__ = ["Grade", "grade_folder", "grade_notebook", "prepare", "write_grades"]

PREFIX = "from fuzzynav import course\n"  # a notebook may have given the name `course` to something else


@dataclass(frozen=True, slots=True)
class Grade:
    """One line of the result: who, which exercise, how many points, and why."""

    student: str
    exercise: str
    points: int
    sentence: str


@dataclass(frozen=True, slots=True)
class Task:
    """One notebook of one student, or the exercises of a notebook that was not handed in."""

    student: str
    path: Path | None
    reference: dict[str, Any]
    exercises: tuple[Exercise, ...]


def grade_folder(
    root: Path, handed_in: Path, *, seconds: int = 60, jobs: int = 1, progress: Callable[[int], object] | None = None
) -> list[Grade]:
    """Grades of every `handed_in/<student>/NN_*.ipynb`, by student and exercise.

    `seconds` limits each cell. `progress` is called with 1 after each notebook. Raises
    FileNotFoundError if the folder is missing, ValueError if it holds no students' folders.
    """
    tasks = list(list_tasks(root, handed_in))
    grades: list[Grade] = []
    with ThreadPoolExecutor(max_workers=max(1, jobs)) as pool:
        running = [pool.submit(_grade_task, root, task, seconds) for task in tasks]
        for future in as_completed(running):
            grades += future.result()
            if progress is not None:
                progress(1)
    order = {name: k for k, name in enumerate(all_exercises())}
    return sorted(grades, key=lambda g: (g.student, order[g.exercise]))


def list_tasks(root: Path, handed_in: Path) -> Iterator[Task]:
    """Everything there is to grade: each student and each notebook that has exercises."""
    if not handed_in.is_dir():
        raise FileNotFoundError(f"there is no folder {handed_in.name}; it must hold one folder for each student")
    students = sorted(p for p in handed_in.iterdir() if p.is_dir() and not p.name.startswith("."))
    if not students:
        raise ValueError(f"{handed_in.name} holds no folders; it must hold one folder for each student")
    known = all_exercises()
    for path in notebooks_of(root):
        reference = json.loads(path.read_text(encoding="utf-8"))
        names = [name for cell in reference["cells"] if (name := exercise_tag(cell, "check"))]
        if not names:
            continue
        group = tuple(known[name] for name in names)
        for student in students:
            found = sorted(student.rglob(path.name))
            yield Task(student.name, found[0] if found else None, reference, group)


def prepare(handed_in: NotebookNode, reference: dict[str, Any]) -> NotebookNode:
    """The student's notebook with the untouched check cells in place of whatever stands there.

    A check cell goes where the student's own stands, else behind the exercise, else at the end.
    """
    checks = {name: cell for cell in reference["cells"] if (name := exercise_tag(cell, "check"))}
    kept: list[NotebookNode] = []
    for cell in handed_in.cells:
        name = exercise_tag(cell, "check")
        if name in checks:
            kept.append(_check_cell(name, checks.pop(name)["source"]))
        elif not name:
            kept.append(cell)
    for name, cell in checks.items():
        places = [k for k, c in enumerate(kept) if exercise_tag(c, "exercise") == name]
        kept.insert(places[-1] + 1 if places else len(kept), _check_cell(name, cell["source"]))
    return nbformat.v4.new_notebook(cells=kept)


def grade_notebook(notebook: NotebookNode, names: Iterable[str], folder: Path, seconds: int) -> dict[str, Grade]:
    """Grades by exercise of a prepared notebook run in `folder`; student is left empty.

    A cell that crashes the kernel or runs too long is taken out, costs its own exercise, and the
    rest runs again without it.
    """
    lost: dict[str, str] = {}
    cells = list(notebook.cells)
    for _ in range(len(cells) + 1):
        run = nbformat.v4.new_notebook(cells=[nbformat.from_dict(dict(c)) for c in cells])
        stopped, reason = _run(run, folder, seconds)
        if stopped is None:
            break
        name = exercise_tag(cells[stopped], "exercise", "check")
        if name:
            lost[name] = reason
        cells.pop(stopped)
    return {name: _read(run, name, lost.get(name)) for name in names}


def write_grades(grades: Iterable[Grade], path: Path) -> None:
    """Write grades as CSV with the columns student, exercise, points, sentence; whole or not at all."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([f.name for f in fields(Grade)])
    writer.writerows(astuple(grade) for grade in grades)
    write_whole(path, stream.getvalue())


def _grade_task(root: Path, task: Task, seconds: int) -> list[Grade]:
    names = [exercise.id for exercise in task.exercises]
    if task.path is None:
        return [Grade(task.student, name, 0, f"Exercise {name}: no notebook handed in.") for name in names]
    try:
        notebook = nbformat.read(task.path, as_version=4)
    except (nbformat.reader.NotJSONError, nbformat.ValidationError, UnicodeDecodeError, KeyError, AttributeError):
        return [Grade(task.student, name, 0, f"Exercise {name}: the notebook cannot be read.") for name in names]
    with tempfile.TemporaryDirectory(prefix="fuzzynav-grade-") as scratch:
        folder = Path(scratch) / "notebooks"
        folder.mkdir()
        shutil.copytree(root / "data", Path(scratch) / "data")
        found = grade_notebook(prepare(notebook, task.reference), names, folder, seconds)
    return [Grade(task.student, name, found[name].points, found[name].sentence) for name in names]


def _check_cell(name: str, source: str | list[str]) -> NotebookNode:
    text = source if isinstance(source, str) else "".join(source)
    cell = nbformat.v4.new_code_cell(PREFIX + text, metadata={"tags": [f"check:{name}"]})
    cell.id = "check-" + name.replace(".", "-")
    return cell


def _run(notebook: NotebookNode, folder: Path, seconds: int) -> tuple[int | None, str]:
    """Run all cells; the index of a cell that stopped the run and why, or None."""
    manager = AsyncKernelManager(kernel_name="python3")
    client = NotebookClient(
        notebook,
        km=manager,
        timeout=seconds,
        allow_errors=True,
        store_widget_state=False,
        resources={"metadata": {"path": str(folder)}},
    )
    environment = {**os.environ, "FUZZYNAV_GRADE": "1"}
    index = 0
    try:
        with client.setup_kernel(env=environment, stderr=subprocess.DEVNULL):
            for index, cell in enumerate(notebook.cells):
                client.execute_cell(cell, index)
    except CellTimeoutError:
        return index, f"it ran longer than {seconds} s"
    except DeadKernelError:
        return index, "it ended Python"
    return None, ""


def _read(run: NotebookNode, name: str, lost: str | None) -> Grade:
    if lost is not None:
        return Grade("", name, 0, f"Exercise {name}: not yet. The answer did not finish: {lost}.")
    for cell in run.cells:
        if cell.cell_type == "code" and exercise_tag(cell, "check") == name:
            for output in cell.outputs:
                record = output.get("data", {}).get(GRADE_MIME)
                if record and record["exercise"] == name:
                    return Grade("", name, int(record["points"]), str(record["sentence"]))
            errors = [o for o in cell.outputs if o.output_type == "error"]
            if errors:
                return Grade(
                    "",
                    name,
                    0,
                    f"Exercise {name}: not yet. The answer is missing ({errors[-1].ename}: {errors[-1].evalue}).",
                )
    return Grade("", name, 0, f"Exercise {name}: the check gave no result.")
