"""Planners compared over a set of tasks, a reader's own among them: `python -m fuzzynav.benchmark` (chapter 07)."""

from fuzzynav.benchmark.cases import Case, cases_of, code_label, run_case
from fuzzynav.benchmark.planners import named, names
from fuzzynav.benchmark.tasks import PARTS, SETS, TaskSet

__all__ = ["PARTS", "SETS", "Case", "TaskSet", "cases_of", "code_label", "named", "names", "run_case"]
