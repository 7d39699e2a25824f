"""The course around the algorithms: sources shown, exercises, hints, solutions, handout and grading."""

from fuzzynav.course.exercise import Exercise, Outcome, Wrong
from fuzzynav.course.reader import check, exercises, hint, show, solution

__all__ = ["Exercise", "Outcome", "Wrong", "check", "exercises", "hint", "show", "solution"]
