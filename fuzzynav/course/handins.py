"""What students handed in: the right file of each notebook, under whatever name, and its cells, however damaged."""

from __future__ import annotations

import json
import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat
from nbformat import NotebookNode

from fuzzynav.course.exercise import Exercise
from fuzzynav.course.folders import notebooks_of
from fuzzynav.course.handout import exercise_tag
from fuzzynav.course.reader import all_exercises

__all__ = ["Choice", "Reference", "choose", "hand_ins", "read_cells", "references"]

LARGEST = 50_000_000  # bytes of a notebook that is opened
LEFT_OUT = ("backup", "__MACOSX")
NUMBER = re.compile(r"(?<![0-9A-Za-z])\d\d[ab]?_")  # what the name of a notebook of the course begins with
CANVAS = re.compile(r"(?P<name>.+?)_(?:late_)?(?P<user>\d+)_\d+_(?P<file>.+)", re.I)


@dataclass(frozen=True, slots=True)
class Reference:
    """A notebook of the course that has exercises, as it was handed out."""

    stem: str
    cells: tuple[dict[str, Any], ...]
    exercises: tuple[Exercise, ...]


@dataclass(frozen=True, slots=True)
class Choice:
    """The file that counts for one notebook, or None, and a remark where that was a choice."""

    path: Path | None
    remark: str


def references(root: Path, chapter: str = "") -> list[Reference]:
    """The notebooks of a chapter ('' for all) that have exercises; raises ValueError if there is none."""
    known, found = all_exercises(), []
    for path in notebooks_of(root, chapter):
        cells = tuple(json.loads(path.read_text(encoding="utf-8"))["cells"])
        names = [name for cell in cells if (name := exercise_tag(cell, "check"))]
        if names:
            found.append(Reference(path.stem, cells, tuple(known[name] for name in names)))
    if not found:
        raise ValueError(f"no notebook that begins with '{chapter}' has exercises; say for example NB=03")
    return found


def hand_ins(handed_in: Path) -> dict[str, list[Path]]:
    """The notebooks of each student: one folder a student, or one flat folder with the students' names in the files'.

    Raises FileNotFoundError if the folder is missing, ValueError if it holds neither.
    """
    if not handed_in.is_dir():
        raise FileNotFoundError(f"there is no folder {handed_in.name}; it must hold one folder for each student")
    folders = sorted(p for p in handed_in.iterdir() if p.is_dir() and p.name[0] != "." and p.name != "__MACOSX")
    found = {folder.name: _notebooks(folder) for folder in folders}
    for path in sorted(handed_in.glob("*.ipynb")):
        found.setdefault(_student_of(path), []).append(path)
    if not found:
        raise ValueError(f"{handed_in.name} holds no folders; it must hold one folder for each student")
    return dict(sorted(found.items()))


def choose(files: list[Path], reference: Reference) -> Choice:
    """The file of one student that counts: by name, else by the exercises in it; the shallowest, then the newest."""
    number = reference.stem.split("_")[0]
    named = [p for p in files if re.search(rf"(?<![0-9A-Za-z]){re.escape(number)}(?![0-9A-Za-z])", p.stem)]
    unnamed = [p for p in files if not NUMBER.search(p.stem)]
    candidates = named or [p for p in unnamed if _holds(p, reference)]
    if not candidates:
        return Choice(None, "")
    best = min(candidates, key=lambda p: (len(p.parts), -p.stat().st_mtime, p.name))
    remark = "" if reference.stem in best.stem else f"found as {best.name}"
    if len(candidates) > 1:
        top = os.path.commonpath([p.parent for p in candidates])
        shown = {p: p.relative_to(top).as_posix() for p in candidates}
        remark = f"{shown[best]} was graded, not {', '.join(sorted(shown[p] for p in candidates if p != best))}"
    return Choice(best, remark)


def read_cells(path: Path) -> list[NotebookNode]:
    """The code cells of a handed-in notebook, nothing but their source and tags.

    What is damaged in outputs, metadata and other cells does not count. Raises ValueError with the reason if the file
    holds no cells at all.
    """
    if path.stat().st_size > LARGEST:
        raise ValueError(f"the notebook cannot be read: it is larger than {LARGEST // 1_000_000} MB")
    try:
        book = json.loads(path.read_bytes().decode("utf-8-sig"))
    except (ValueError, RecursionError):
        raise ValueError("the notebook cannot be read: it is not JSON in UTF-8") from None
    cells = book.get("cells") if isinstance(book, dict) else None
    if cells is None and isinstance(book, dict) and isinstance(book.get("worksheets"), list):
        cells = [c for sheet in book["worksheets"] if isinstance(sheet, dict) for c in _list(sheet.get("cells"))]
    if not isinstance(cells, list):
        raise ValueError("the notebook cannot be read: it has no list of cells")
    return [made for cell in cells if (made := _code(cell)) is not None]


def _code(cell: Any) -> NotebookNode | None:
    if not isinstance(cell, dict) or cell.get("cell_type") != "code":
        return None
    source = cell.get("source", cell.get("input", ""))
    if isinstance(source, list):
        source = "".join(line for line in source if isinstance(line, str))
    if not isinstance(source, str):
        return None
    metadata = cell.get("metadata")
    tags = [t for t in _list(metadata.get("tags") if isinstance(metadata, dict) else None) if isinstance(t, str)]
    sound = source.encode("utf-8", "replace").decode("utf-8")  # half a character cannot be sent to Python
    made: NotebookNode = nbformat.v4.new_code_cell(sound, metadata={"tags": tags})
    return made


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []


def _notebooks(folder: Path) -> list[Path]:
    """Every notebook below a student's folder but those that Jupyter, a reset or a students' edition put there."""

    def own(path: Path) -> bool:
        parts = path.relative_to(folder).parts
        return path.is_file() and not any(part.startswith(".") or part in LEFT_OUT for part in parts)

    return sorted(p for p in folder.rglob("*.ipynb") if own(p))


def _student_of(path: Path) -> str:
    """The student in the name of a file of a flat folder: what stands before the notebook's name."""
    canvas = CANVAS.fullmatch(path.stem)
    if canvas:
        return f"{canvas['name']}_{canvas['user']}"
    before = NUMBER.split(path.stem)[0].strip("_- ")
    return before or path.stem


def _holds(path: Path, reference: Reference) -> bool:
    """Whether a file holds an exercise of this notebook, by its tags or by its calls of `course.check`."""
    if path.stat().st_size > LARGEST:
        return False
    text = path.read_text(encoding="utf-8", errors="replace")
    return any(re.search(rf'(check|exercise):{re.escape(e.id)}"|check\(\\?["\']{re.escape(e.id)}\\?["\']', text)
               for e in reference.exercises)  # fmt: skip
