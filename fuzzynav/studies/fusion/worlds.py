"""The planners of chapter 07 on the worlds of a public benchmark, BARN and DynaBARN, that nothing was tuned on.

A case is a text 'set/planner/tracking/top speed/world', a world of DynaBARN with its phase, as '4.7'.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from functools import partial
from typing import Any

from fuzzynav.data import folder
from fuzzynav.fusion import barn
from fuzzynav.fusion.guests import GUESTS
from fuzzynav.fusion.methods import METHODS
from fuzzynav.fusion.protocol import measure
from fuzzynav.fusion.task import Task
from fuzzynav.studies.reproduction import Reproduction
from fuzzynav.studies.study import Study

__all__ = ["CLASSES", "FUZZY", "PROMISED", "SPEEDS", "WORLD_STUDIES", "outcome"]

CLASSES = ("easy", "medium", "hard")  # of twenty worlds of DynaBARN each
SPEEDS = (2.0, 0.5)  # [m/s]
FUZZY = {"Efficient A* + fuzzy DWA": "fuzzy DWA, as printed", "Efficient A* + fuzzy DWA, tuned": "fuzzy DWA, tuned"}
FILES = ("benchmarks/barn300.npz", "benchmarks/dynabarn60.json")


def outcome(case: str) -> dict[str, Any]:
    """How one planner ends in one world. Raises ModuleNotFoundError for a guest that is not installed."""
    kind, name, tracking, speed, world = case.split("/")
    if name in GUESTS and importlib.util.find_spec("navground") is None:
        raise ModuleNotFoundError(f"{name} is a guest from navground: pip install navground")
    task = _task(kind, world, float(speed), tracking == "ideal")
    found = measure(task, GUESTS[name] if name in GUESTS else METHODS[name])
    number, _, phase = world.partition(".")
    reached = found["ending"] == "reached"
    return {
        "planner": FUZZY.get(name, name),
        "tracking": tracking,
        "speed": float(speed),
        "world": int(number),
        "phase": int(phase or 0),
        "class": CLASSES[int(number) // 20] if kind == "dynabarn" else "static",
        "ending": found["ending"],
        "time": round(float(found["time"]), 6),
        "clearance": round(float(found["clearance"]), 6),
        "score": round(float(barn.score(reached, found["time"], task.optimum)), 6),
    }


def _task(kind: str, world: str, speed: float, ideal: bool) -> Task:
    """The task of a case."""
    home = folder("benchmarks")
    if kind == "barn":
        return barn.static_task(home, int(world), top_speed=speed)
    number, phase = (int(part) for part in world.split("."))
    return barn.dynamic_task(home, number, phase, top_speed=speed, ideal=ideal)


def _published(what: str) -> float:
    """What the published runs of move_base's DWA give: "success", "contact", "late" or "metric"."""
    return barn.outcome(barn.published_runs(folder("benchmarks")))[what]


def _static() -> tuple[str, ...]:
    """BARN's own fifty test worlds; the paths of the fuzzy windows' planner are the straight line, without a map."""
    names = ("ours", "TDWA", *FUZZY)
    return tuple(
        f"barn/{name}/scans/{speed}/{n}" for speed in SPEEDS for name in names for n in barn.test_numbers("barn")
    )


def _dynamic(rows: Sequence[tuple[str, str, float]], numbers: Sequence[int]) -> list[str]:
    """Cases of rows planner, tracking and speed, in all phases of these worlds."""
    return [
        f"dynabarn/{name}/{tracking}/{speed}/{n}.{phase}"
        for name, tracking, speed in rows
        for n in numbers
        for phase in range(barn.PHASES)
    ]


def _ours() -> tuple[str, ...]:
    """Our planners on the held-out worlds, the one that evades on all of them at 2 m/s."""
    held, tuned = barn.test_numbers("dynabarn"), barn.tuning_numbers("dynabarn")
    both = ("ideal", "scans")
    evading = [("ours, evading", tracking, speed) for speed in SPEEDS for tracking in both]
    others = [("ours", tracking, SPEEDS[0]) for tracking in both]
    others += [(name, "ideal", SPEEDS[0]) for name in ("TDWA", "Efficient A* + fuzzy DWA, tuned")]
    return tuple(_dynamic(evading + others, held) + _dynamic(evading[:2], tuned))


def _guests() -> tuple[str, ...]:
    """The guests, who must be told where the movers are."""
    rows = [(name, "ideal", speed) for speed in SPEEDS for name in GUESTS]
    return tuple(_dynamic(rows, barn.test_numbers("dynabarn")))


PROTOCOL = {"held out": "BARN: worlds that 6 divides; DynaBARN: even worlds", "phases": barn.PHASES}
WORLD_STUDIES = (
    Study(name="barn_planners", experiment=outcome, cases=_static(), parameters=PROTOCOL, inputs=FILES[:1]),
    Study(name="dynabarn_planners", experiment=outcome, cases=_ours(), parameters=PROTOCOL, inputs=FILES[1:]),
    Study(name="dynabarn_guests", experiment=outcome, cases=_guests(), parameters=PROTOCOL, inputs=FILES[1:]),
)

PROMISED: tuple[Reproduction, ...] = tuple(
    Reproduction(
        claim=f"barn:c-dwa-{what}",
        measure=partial(_published, what),
        verdict="contradicts itself",
        because="the 500 runs that are published beside the promise give less; ours is what they give",
    )
    for what in ("success", "metric")
)
