"""What a notebook calls: show a source, check an answer, give a hint, open a solution."""

from __future__ import annotations

import importlib
import inspect
import os
import pkgutil
import re
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any

from IPython.display import display

import fuzzynav.course.exercises
from fuzzynav import published
from fuzzynav.course.exercise import Exercise, Outcome, judge
from fuzzynav.course.folders import solutions_folder

__all__ = ["GRADE_MIME", "Source", "all_exercises", "check", "hint", "items", "show", "solution"]

GRADE_MIME = "application/vnd.fuzzynav.grade+json"


class Source:
    """Python source that Jupyter shows highlighted and a terminal shows plain."""

    def __init__(self, text: str, title: str) -> None:
        self.text, self.title = text.rstrip(), title

    def __repr__(self) -> str:
        return f"# {self.title}\n{self.text}"

    def _repr_markdown_(self) -> str:
        fence = "````" if "```" in self.text else "```"
        return f"`{self.title}`\n\n{fence}python\n{self.text}\n{fence}"


class Line:
    """One line of text for the reader."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __repr__(self) -> str:
        return self.text


def show(*objects: Any) -> Source:
    """The source of functions, classes or modules of the package, as it is installed.

    Raises ValueError for an object that has no Python source.
    """
    if not objects:
        raise ValueError("say what to show, for example course.show(robot.move)")
    texts = [_source(thing) for thing in objects]
    return Source("\n\n\n".join(texts), ", ".join(_title(thing) for thing in objects))


def all_exercises() -> dict[str, Exercise]:
    """Every exercise of the chapters present, by id, in order."""
    found: dict[str, Exercise] = {}
    names = sorted(m.name for m in pkgutil.iter_modules(fuzzynav.course.exercises.__path__))
    for name in names:
        if re.fullmatch(r"ch\d\d[ab]?", name):
            for exercise in importlib.import_module(f"fuzzynav.course.exercises.{name}").EXERCISES:
                if exercise.id in found:
                    raise ValueError(f"exercise {exercise.id} is defined twice")
                found[exercise.id] = exercise
    return found


def check(exercise_id: str, answer: Any) -> Outcome:
    """Check an answer and say in one line what is right or wrong.

    With FUZZYNAV_GRADE=1 a failure raises AssertionError with the same sentence, and the points
    are displayed for a grading program.
    """
    outcome = judge(_exercise(exercise_id), answer)
    if os.environ.get("FUZZYNAV_GRADE") == "1":
        record = {"exercise": outcome.exercise, "points": outcome.points, "sentence": outcome.sentence}
        display({GRADE_MIME: record, "text/plain": outcome.sentence}, raw=True)
        if not outcome.points:
            raise AssertionError(outcome.sentence)
    return outcome


def hint(exercise_id: str, number: int = 1) -> Line:
    """Hint `number` of an exercise; raises ValueError if there is no such hint."""
    hints = _exercise(exercise_id).hints
    if not 1 <= number <= len(hints):
        raise ValueError(f"exercise {exercise_id} has hints 1 to {len(hints)}, not {number}")
    follow = f'next: course.hint("{exercise_id}", {number + 1})' if number < len(hints) else "the last hint"
    return Line(f"Hint {number} of {len(hints)} ({follow}): {hints[number - 1]}")


def items(notebook: str) -> published.Table:
    """The figures, tables and equations that the notebooks whose names begin with `notebook` reproduce."""
    where = published.reproduced_items()
    rows = [
        (i.id, i.kind, i.meaning, i.reproducible)
        for i in published.items().values()
        if any(name.startswith(notebook) for name in where.get(i.id, []))
    ]
    return published.Table(rows, columns=["item", "kind", "meaning", "reproducible"]).set_index("item")


def solution(exercise_id: str) -> Source | Line:
    """The worked solution of an exercise, or a sentence that this edition holds none."""
    _exercise(exercise_id)
    folder = solutions_folder()
    for file in sorted(folder.glob("*.py")) if folder else []:
        blocks = solution_blocks(file)
        if exercise_id in blocks:
            return Source(blocks[exercise_id], f"a solution of exercise {exercise_id}")
    return Line(f"The solution of exercise {exercise_id} is not part of this edition; ask your teacher.")


def solution_blocks(file: Path) -> dict[str, str]:
    """The code of each exercise in a solutions file, whose blocks begin with a line `# %% 03.1`."""
    parts = re.split(r"(?m)^# %% +(\d\d[ab]?\.\d+)\b.*$", file.read_text(encoding="utf-8"))
    return {name: code.strip() for name, code in zip(parts[1::2], parts[2::2], strict=True)}


def _exercise(exercise_id: str) -> Exercise:
    found = all_exercises()
    if exercise_id not in found:
        known = ", ".join(found) or "none yet"
        raise ValueError(f"there is no exercise '{exercise_id}'; there are: {known}")
    return found[exercise_id]


def _source(thing: Any) -> str:
    plain: Callable[..., Any] | type = getattr(thing, "py_func", thing)
    plain = plain.fget if isinstance(plain, property) else inspect.unwrap(plain) if callable(plain) else plain
    if not (inspect.isfunction(plain) or inspect.ismethod(plain) or inspect.isclass(plain) or inspect.ismodule(plain)):
        raise ValueError(f"only functions, classes and modules have a source to show, not a {type(thing).__name__}")
    return textwrap.dedent(inspect.getsource(plain)).rstrip()


def _title(thing: Any) -> str:
    if inspect.ismodule(thing):
        return thing.__name__
    plain: Any = thing.fget if isinstance(thing, property) else thing
    return f"{plain.__module__}.{plain.__qualname__}"
