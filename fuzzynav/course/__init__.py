"""The course around the algorithms: sources, exercises, hints, solutions, answers to labs, handout and grading."""

from fuzzynav.course.exercise import Exercise, Outcome, Wrong
from fuzzynav.course.overview import chapters
from fuzzynav.course.reader import all_answers, all_exercises, answer, check, hint, items, show, solution
from fuzzynav.course.readiness import ready

__all__ = [
    "Exercise",
    "Outcome",
    "Wrong",
    "all_answers",
    "all_exercises",
    "answer",
    "chapters",
    "check",
    "hint",
    "items",
    "ready",
    "show",
    "solution",
]
