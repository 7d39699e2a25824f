"""One case of a comparison: a planner and a task, as a row; workers on other machines import this and no picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from fuzzynav.batch import Label, label_of
from fuzzynav.benchmark.planners import named
from fuzzynav.benchmark.tasks import TaskSet
from fuzzynav.fusion.protocol import PROTOCOL, STEP_LIMIT, Driven, drive

__all__ = ["Case", "cases_of", "code_label", "planner_code", "run_again", "run_case"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A planner's name and a task's."""

    method: str
    item: str

    def __str__(self) -> str:
        return f"{self.item} {self.method}"


def cases_of(tasks: TaskSet, methods: Sequence[str], count: int | None = None) -> list[Case]:
    """Every planner on every task, task by task."""
    return [Case(method=method, item=item) for item in tasks.items(count) for method in methods]


def run_case(case: Case, tasks: TaskSet, step_limit: float = STEP_LIMIT) -> dict[str, Any]:
    """The row of one case; the item, its class and the planner come first."""
    row = run_again(case, tasks, step_limit).row
    return {"method": case.method, "item": case.item, "group": tasks.group(case.item), **row}


def run_again(case: Case, tasks: TaskSet, step_limit: float = STEP_LIMIT) -> Driven:
    """What came of one case, with its run."""
    task = tasks.task(case.item)
    return drive(task, named(case.method), seed=tasks.noise(case.item), step_limit=step_limit)


def planner_code(method: str) -> str:
    """A planner's name, parameters and code in short. Raises ValueError for one that prints a place in memory."""
    label = label_of(named(method))
    inside = ", ".join(f"{name}={value}" for name, value in label["parameters"].items())
    return f"{label['experiment']}({inside}) {label['code']}"


def code_label(tasks: TaskSet, methods: Sequence[str], step_limit: float = STEP_LIMIT) -> Label:
    """What rows must have in common to stand in one file: protocol, tasks, planners and their code."""
    planners = {f"planner {method}": planner_code(method) for method in methods}
    parameters = {"protocol": PROTOCOL, **tasks.parameters(), "step_limit": str(step_limit), **planners}
    return {"experiment": "fuzzynav.benchmark", "parameters": parameters, "code": tasks.code()}
