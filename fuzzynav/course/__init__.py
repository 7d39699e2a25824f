"""The course around the algorithms: sources shown, exercises, hints, solutions, handout and grading."""

from fuzzynav.course.exercise import Exercise, Outcome, Wrong
from fuzzynav.course.overview import chapters
from fuzzynav.course.reader import all_exercises, check, hint, items, show, solution
from fuzzynav.course.readiness import ready

__all__ = [
    "Exercise",
    "Outcome",
    "Wrong",
    "chapters",
    "check",
    "all_exercises",
    "hint",
    "items",
    "ready",
    "show",
    "solution",
]
