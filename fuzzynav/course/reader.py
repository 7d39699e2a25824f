"""What a notebook calls: show a source, check an answer, give a hint, open a solution, unfold the answer to a lab."""

from __future__ import annotations

import difflib
import importlib
import inspect
import os
import pkgutil
import re
import sys
import textwrap
from collections.abc import Callable, Iterable
from pathlib import Path
from types import ModuleType
from typing import Any

from IPython.display import display

import fuzzynav.course.answers
import fuzzynav.course.exercises
from fuzzynav import published
from fuzzynav.course.answers.answer import Answer, Folded
from fuzzynav.course.exercise import Exercise, Outcome, judge
from fuzzynav.course.folders import solutions_folder

__all__ = [
    "GRADE_MIME",
    "Line",
    "Source",
    "all_answers",
    "all_exercises",
    "answer",
    "check",
    "hint",
    "items",
    "show",
    "solution",
    "source_of",
]

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


def show(*objects: Any) -> None:
    """Display the source of functions, classes or modules of the package, as it is installed, wherever the call stands.

    A compiled function shows the Python that was compiled. Raises ValueError for an object that has no Python source.
    """
    display(source_of(*objects))


def source_of(*objects: Any) -> Source:
    """The source that `show` displays, titled with file and name: `fuzzynav/robot/model.py: move`."""
    if not objects:
        raise ValueError("say what to show, for example course.show(robot.move)")
    texts = [_source(thing) for thing in objects]
    files: dict[str, list[str]] = {}
    for thing in objects:
        file, name = _title(thing)
        files.setdefault(file, []).append(name)
    title = "; ".join(f"{file}: {', '.join(names)}".removesuffix(": ") for file, names in files.items())
    return Source("\n\n\n".join(texts), title)


def all_exercises() -> dict[str, Exercise]:
    """Every exercise of the chapters present, by id, in order."""
    found: dict[str, Exercise] = {}
    for module in _chapters(fuzzynav.course.exercises):
        for exercise in module.EXERCISES:
            if exercise.id in found:
                raise ValueError(f"exercise {exercise.id} is defined twice")
            found[exercise.id] = exercise
    return found


def all_answers() -> dict[str, Answer]:
    """The answer to every lab question of the chapters present, by id, in order."""
    found: dict[str, Answer] = {}
    for module in _chapters(fuzzynav.course.answers):
        for one in module.ANSWERS:
            if one.id in found:
                raise ValueError(f"the answer {one.id} is defined twice")
            found[one.id] = one
    return found


def _chapters(package: ModuleType) -> list[ModuleType]:
    names = sorted(m.name for m in pkgutil.iter_modules(package.__path__))
    return [importlib.import_module(f"{package.__name__}.{n}") for n in names if re.fullmatch(r"ch\d\d[ab]?", n)]


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
    """Hint `number` of an exercise, or a sentence that there is no such hint or no such exercise."""
    exercise = all_exercises().get(exercise_id)
    if exercise is None:
        return Line(_unknown("exercise", exercise_id, all_exercises()))
    count = len(exercise.hints)
    if number not in range(1, count + 1):
        numbers = "1" if count == 1 else f"1 to {count}"
        last = f'; after the last one comes course.solution("{exercise_id}")'
        return Line(f"Exercise {exercise_id} has the hint{'s' * (count > 1)} {numbers}, not {number!r}{last}.")
    follow = f'next: course.hint("{exercise_id}", {number + 1})' if number < count else "the last hint"
    return Line(f"Hint {number} of {count} ({follow}): {exercise.hints[number - 1]}")


def answer(answer_id: str) -> Folded | Line:
    """The answer to a lab's question, folded; or a sentence that names the nearest ones."""
    found = all_answers().get(answer_id)
    return found.folded() if found else Line(_unknown("answer", answer_id, all_answers()))


def items(notebook: str) -> published.Table:
    """The figures, tables and equations that the notebooks whose names begin with `notebook` reproduce."""
    where = published.reproduced_items()
    rows = [
        (i.id, i.kind, i.meaning, i.reproducible)
        for i in published.items().values()
        if any(name.startswith(notebook) for name in where.get(i.id, []))
    ]
    made = published.Table(rows, columns=["item", "kind", "meaning", "reproducible"])
    return published.Table(made.set_index("item"))


def solution(exercise_id: str) -> Source | Line:
    """The worked solution of an exercise, or a sentence that this edition holds none."""
    if exercise_id not in all_exercises():
        return Line(_unknown("exercise", exercise_id, all_exercises()))
    folder = solutions_folder()
    for file in sorted(folder.glob("*.py")) if folder else []:
        blocks = solution_blocks(file)
        if exercise_id in blocks:
            return Source(blocks[exercise_id], f"a solution of exercise {exercise_id}")
    return Line(
        f"The solution of exercise {exercise_id} is not part of this edition: the students' edition comes without "
        f'solutions. Ask your teacher, or take course.hint("{exercise_id}").'
    )


def solution_blocks(file: Path) -> dict[str, str]:
    """The code of each exercise in a solutions file, whose blocks begin with a line `# %% 03.1`."""
    parts = re.split(r"(?m)^# %% +(\d\d[ab]?\.\d+)\b.*$", file.read_text(encoding="utf-8"))
    return {name: code.strip() for name, code in zip(parts[1::2], parts[2::2], strict=True)}


def _exercise(exercise_id: str) -> Exercise:
    found = all_exercises()
    if exercise_id not in found:
        raise ValueError(_unknown("exercise", exercise_id, found))
    return found[exercise_id]


def _unknown(kind: str, name: object, known: Iterable[str]) -> str:
    """A sentence that there is no such id, with those of its chapter, else the nearest, else all."""
    names = list(known)
    same = [n for n in names if n.split(".")[0] == str(name).split(".")[0]]
    near = same or difflib.get_close_matches(str(name), names, n=5, cutoff=0.5) or names
    return f"there is no {kind} {name!r}; there are: {', '.join(near) or 'none yet'}"


def _source(thing: Any) -> str:
    plain: Callable[..., Any] | type = getattr(thing, "py_func", thing)
    plain = plain.fget if isinstance(plain, property) else inspect.unwrap(plain) if callable(plain) else plain
    if not (inspect.isfunction(plain) or inspect.ismethod(plain) or inspect.isclass(plain) or inspect.ismodule(plain)):
        raise ValueError(f"only functions, classes and modules have a source to show, not a {type(thing).__name__}")
    return textwrap.dedent(inspect.getsource(plain)).rstrip()


def _title(thing: Any) -> tuple[str, str]:
    """The file of a thing within the package, and its name there ('' for a whole module)."""
    if inspect.ismodule(thing):
        return _file(thing.__name__), ""
    plain: Any = thing.fget if isinstance(thing, property) else getattr(thing, "py_func", thing)
    return _file(plain.__module__), plain.__qualname__


def _file(module: str) -> str:
    package = hasattr(sys.modules[module], "__path__")
    return module.replace(".", "/") + ("/__init__.py" if package else ".py")
