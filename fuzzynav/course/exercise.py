"""What an exercise is: its words, its points, its hints and the check of an answer."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Any

from fuzzynav.lab.plain import Guard, plain_words

__all__ = ["Exercise", "Outcome", "Wrong", "judge"]


class Wrong(Exception):
    """The answer is wrong; its message is one sentence that says what is wrong and what the limit is."""


class Unanswered(Exception):
    """The stub still stands as it was handed out."""


@dataclass(frozen=True, slots=True)
class Exercise:
    """One exercise; `check(answer)` returns a sentence of success or raises Wrong.

    Raises ValueError if the id is not like 03.1, or if points, title or hints are missing.
    """

    id: str
    title: str
    points: int
    hints: tuple[str, ...]
    check: Callable[[Any], str]

    def __post_init__(self) -> None:
        if not re.fullmatch(r"\d\d[ab]?\.\d+", self.id):
            raise ValueError(f"an exercise is named like 03.1, not '{self.id}'")
        if self.points < 1 or not self.title or not self.hints:
            raise ValueError(f"exercise {self.id} needs a title, at least one point and one hint")


@dataclass(frozen=True, slots=True)
class Outcome:
    """The outcome of one check: the exercise, the points earned and the sentence for the reader."""

    exercise: str
    points: int
    sentence: str

    def __repr__(self) -> str:
        return self.sentence


def judge(exercise: Exercise, answer: Any) -> Outcome:
    """Check an answer; nothing that the answer does raises from here."""
    guard = Guard()
    with guard:
        if unanswered(answer):
            raise Unanswered
        good = exercise.check(watched(answer))
        return Outcome(exercise.id, exercise.points, f"Exercise {exercise.id}: right. {good}".strip())
    return Outcome(exercise.id, 0, f"Exercise {exercise.id}: {_why(guard.error)}")


def unanswered(value: Any) -> bool:
    """Whether a value is the dots of a stub, or holds them."""
    if isinstance(value, (tuple, list)):
        return any(unanswered(v) for v in value)
    if isinstance(value, dict):
        return any(unanswered(v) for v in value.values())
    return value is Ellipsis


def watched(answer: Any) -> Any:
    """The answer; if it is a function, one that tells dots and errors of the learner apart from the check's own."""
    if not inspect.isroutine(answer):
        return answer

    @wraps(answer)
    def call(*args: Any, **kwargs: Any) -> Any:
        guard = Guard()
        value = None
        with guard:
            value = answer(*args, **kwargs)
        if guard.error is not None:
            raise Wrong(f"Your function stopped: {plain_words(guard.error)}.") from guard.error
        if unanswered(value):
            raise Unanswered
        return value

    return call


def _why(error: BaseException | None) -> str:
    if isinstance(error, Unanswered):
        return "not answered yet."
    if isinstance(error, Wrong):
        return f"not yet. {error}"
    if error is None:
        return "not yet."
    return f"not yet. The answer could not be used: {plain_words(error)}."
