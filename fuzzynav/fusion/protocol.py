"""One task driven by one method, as one row: how it ended, how long it took, how near it came.

Every ending has its name, none hides another:

- `reached`     the goal
- `hit`         the robot touched something while it moved faster than 0.05 m/s, or touched something that stands
- `struck`      a mover ran into the robot, which stood
- `late`        everything else: the time was over, the robot stood still, the planner gave up
- `unsolvable`  no way leads to the goal past what stands; the method is not asked
- `failed`      the controller raised, answered no command, or thought too long

Rates are of all tasks that can be solved: a controller that fails gains nothing by it.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
import pandas as pd
from scipy import ndimage

from fuzzynav import simulate
from fuzzynav.batch import Sheet, checksum_of, proportion
from fuzzynav.control import Controller, Observation
from fuzzynav.fusion.task import Method, Task
from fuzzynav.geometry import Array
from fuzzynav.simulate.record import STATUSES, Run

__all__ = ["ENDINGS", "PROTOCOL", "TIMED", "Driven", "drive", "fingerprint", "measure", "solvable", "summary"]

PROTOCOL = "fuzzynav benchmark, protocol 1"
ENDINGS: tuple[str, ...] = ("reached", "hit", "struck", "late", "unsolvable", "failed")
RATED = ("reached", "hit", "struck", "late", "failed")
TIMED: tuple[str, ...] = ("step_median_ms", "step_p99_ms")  # columns of the clock: no two runs agree in them
MOVING = 0.05  # [m/s] slower than this the robot counts as standing
STEP_LIMIT = 1.0  # [s] for the controller's answer
STRIKES = 3  # answers beyond the limit before a controller is called too slow; the first, which compiles, is free
LATTICE = 0.05  # [m] between the points at which a world is searched for a way
MOST_CELLS = 4e6
ADDRESS = re.compile(r"\s*\bat 0x[0-9a-fA-F]+")
T = TypeVar("T")


@dataclass(frozen=True, slots=True, kw_only=True)
class Driven:
    """What came of a task: its row, and the run for a replay, None where there was none."""

    row: dict[str, Any]
    run: Run | None


def measure(task: Task, method: Method, *, seed: int = 0, step_limit: float = STEP_LIMIT) -> dict[str, Any]:
    """The row of `drive` alone, fit for `batch.run`."""
    return drive(task, method, seed=seed, step_limit=step_limit).row


def drive(task: Task, method: Method, *, seed: int = 0, step_limit: float = STEP_LIMIT) -> Driven:
    """Drive `task` by the controller that `method` makes; everything but the columns TIMED repeats exactly.

    A run ends at the first contact, whoever moved. `clearance` [m] is the least one before the step that ended the
    run, `ratio` the driven length over the optimum. A controller fails by name: what it raised, a command that is not
    two finite numbers, a status that has no name, or more than three answers that took over `step_limit` [s]; one that
    never answers is not stopped. Raises ValueError for a task that cannot begin, such as a start that touches
    something.
    """
    if not step_limit > 0:
        raise ValueError(f"step_limit must be positive seconds, got {step_limit}")
    if not solvable(task):
        return Driven(row=_row(task, seed, "unsolvable", "no_path"), run=None)
    watched: _Watched | None = None
    try:
        watched = _Watched(_asked(lambda: method(task)), step_limit)
        run = _run(task, watched, seed)
    except _Failure as failure:
        return Driven(row=_row(task, seed, "failed", "failed", watched=watched, reason=str(failure)), run=None)
    return Driven(row=_row(task, seed, _ending(run), run.status, watched=watched, run=run), run=run)


def _run(task: Task, controller: Controller, seed: int) -> Run:
    """The closed loop, ended by the first contact."""
    return simulate.run(
        task.world,
        task.robot,
        controller,
        task.start,
        task.goal,
        dt=task.dt,
        t_max=task.t_max,
        rng=seed,
        laser=task.laser,
        track_movers=task.ideal,
        loop=replace(task.loop, stop_at_contact=True, standing=MOVING, end_when_struck=True),
    )


def _ending(run: Run) -> str:
    """The name of how a run ended."""
    return {"reached": "reached", "collided": "hit", "struck": "struck"}.get(run.status, "late")


def _row(
    task: Task,
    seed: int,
    ending: str,
    status: str,
    *,
    watched: _Watched | None = None,
    reason: str = "",
    run: Run | None = None,
) -> dict[str, Any]:
    """Plain values, the same columns for every ending; nan where there is nothing to measure."""
    times = np.array(watched.times if watched is not None else [])
    before = run.clearance[:-1] if run is not None else np.empty(0)
    length = run.length if run is not None else np.nan
    return {
        "task": task.name,
        "seed": seed,
        "ending": ending,
        "status": status,
        "reason": reason,
        "time": run.duration if run is not None else np.nan,
        "length": length,
        "optimum": task.optimum,
        "ratio": length / task.optimum if task.optimum > 0 else np.nan,
        "clearance": float(before.min()) if len(before) else np.nan,
        "steps": run.iterations if run is not None else len(times),
        "step_median_ms": 1e3 * float(np.median(times)) if len(times) else np.nan,
        "step_p99_ms": 1e3 * float(np.quantile(times, 0.99)) if len(times) else np.nan,
    }


# --- the controller, watched --------------------------------------------------------------------


class _Failure(Exception):
    """What a controller did that no controller may do, in one line."""


def _asked(call: Callable[[], T]) -> T:
    """What a call returns; what it raises becomes one line that reads the same in every run."""
    try:
        return call()
    except Exception as error:  # whatever a reader's planner raises is that planner's result
        said = ADDRESS.sub("", " ".join(str(error).split()))[:300]
        raise _Failure(f"{type(error).__name__}: {said}") from error


class _Watched(Controller):
    """A controller whose answers are timed and looked at before anybody relies on them."""

    def __init__(self, inner: Controller, limit: float) -> None:
        lacking = [name for name in ("reset", "status", "evidence") if not hasattr(inner, name)]
        if lacking or not callable(inner):
            kind = type(inner).__name__
            raise _Failure(f"TypeError: the method made a {kind}, which is no controller; lacking: {lacking}")
        self.inner, self.limit = inner, limit
        self.times: list[float] = []
        self.slow = 0

    def reset(self) -> None:
        _asked(self.inner.reset)

    @property
    def status(self) -> str | None:
        named = _asked(lambda: self.inner.status)
        if named and str(named) not in STATUSES:
            raise _Failure(f"ValueError: status {str(named)[:40]!r} has no name, use one of {', '.join(STATUSES)}")
        return str(named) if named else None

    @property
    def evidence(self) -> Mapping[str, Any]:
        return _asked(lambda: dict(self.inner.evidence))

    def __call__(self, observation: Observation) -> Array:
        began = time.perf_counter()
        answer = _asked(lambda: np.array(self.inner(observation), dtype=float))
        self.times.append(time.perf_counter() - began)
        if answer.shape != (2,) or not np.isfinite(answer).all():
            raise _Failure(
                f"ValueError: the command {answer.tolist()} at {observation.time:.1f} s is not finite (v, w)"
            )
        self.slow += len(self.times) > 1 and self.times[-1] > self.limit
        if self.slow > STRIKES:
            raise _Failure(f"TimeoutError: more than {STRIKES} answers took over {self.limit:g} s each")
        return answer


# --- is there a way -----------------------------------------------------------------------------


def solvable(task: Task) -> bool:
    """Whether the robot's disc can get from the start to the goal past what stands; False is a proof.

    A finite optimum settles it, an infinite one denies it. Otherwise squares that may hold a free point are joined:
    each has a centre from which the nearest obstacle is less than half its diagonal too near. So a gap too narrow by
    as much may still count as a way, but a way is never overlooked. Movers are left out.
    """
    if not float(task.world.clearance(task.goal, [])) > 0 or np.isposinf(task.optimum):
        return False
    if np.isfinite(task.optimum):
        return True
    low, high = _box(task)
    size = max(LATTICE, float(np.sqrt(np.prod(high - low) / MOST_CELLS)))
    counts = np.ceil((high - low) / size).astype(int)
    x, y = (low[k] + size * (np.arange(counts[k]) + 0.5) for k in (0, 1))
    slack = size * np.sqrt(0.5)
    centres = np.stack(np.meshgrid(x, y), axis=-1)
    free = task.world.clearance(centres, []) > task.robot.radius - slack
    regions, _ = ndimage.label(free, structure=np.ones((3, 3)))
    column, row = np.minimum(((task.start[:2] - low) / size).astype(int), counts - 1)
    near = np.hypot(*np.moveaxis(centres - task.goal, -1, 0)) <= task.loop.goal_tolerance + slack
    return bool(regions[row, column]) and bool((regions[near] == regions[row, column]).any())


def _box(task: Task) -> tuple[Array, Array]:
    """Corners of the ground to search: the world's bounds, or all that stands with a free ring around it."""
    if task.world.bounds is not None:
        xmin, xmax, ymin, ymax = task.world.bounds
        return np.array([xmin, ymin]), np.array([xmax, ymax])
    scene = task.world.scene
    points = [task.start[None, :2], task.goal[None]]
    margin = 2.0 * task.robot.radius + task.loop.goal_tolerance + 4.0 * LATTICE
    for rows, reach in ((scene.discs, scene.discs[:, 2]), (scene.rectangles, np.hypot(*scene.rectangles[:, 2:4].T))):
        points += [rows[:, :2] - reach[:, None], rows[:, :2] + reach[:, None]]
    everything = np.concatenate(points)
    return everything.min(axis=0) - margin, everything.max(axis=0) + margin


# --- many rows ----------------------------------------------------------------------------------


def summary(table: pd.DataFrame, by: str = "method") -> pd.DataFrame:
    """One row a group: how many ended how, the share of each ending with its 95 % Wilson interval, medians.

    Shares are of the tasks that can be solved, `solvable`; medians of time, length, ratio and clearance are of those
    that reached the goal. nan where there is nothing to count. Raises ValueError for a table without the columns of
    `measure`.
    """
    missing = [c for c in (by, "ending", "time", "length", "ratio", "clearance", *TIMED) if c not in table]
    if missing:
        raise ValueError(f"no column {missing[0]!r} in the table; it has {', '.join(map(str, table.columns))}")
    rows = []
    for key, group in table.groupby(by, sort=False):
        counts = {name: int((group["ending"] == name).sum()) for name in ENDINGS}
        tried = len(group) - counts["unsolvable"]
        row: dict[str, Any] = {by: key, "runs": len(group), "solvable": tried, **counts}
        for name in RATED:
            rate, low, high = proportion(counts[name], tried) if tried else (np.nan,) * 3
            row |= {f"{name} rate": rate, f"{name} low": low, f"{name} high": high}
        won = group[group["ending"] == "reached"]
        row |= {f"median {name}": won[name].median() for name in ("time", "length", "ratio", "clearance")}
        row |= {f"median {name}": group[name].median() for name in TIMED}
        rows.append(row)
    return pd.DataFrame(rows)


def fingerprint(table: pd.DataFrame) -> str:
    """Sixteen hexadecimal digits of every cell that must repeat exactly: two people with the same have the same runs.

    Rows are taken in the order of their cases, wherever they stand.
    """
    kept = table.drop(columns=[c for c in TIMED if c in table])
    records = kept.sort_values("case", kind="stable") if "case" in kept else kept
    rows = {str(k): [dict(zip(kept.columns, values))] for k, values in enumerate(records.itertuples(index=False))}
    return checksum_of(Sheet({}, list(map(str, kept.columns)), frozenset(), rows, True, ""))
