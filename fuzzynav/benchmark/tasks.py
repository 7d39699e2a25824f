"""The sets of tasks that planners are compared over: seeded scenes, BARN, DynaBARN."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fuzzynav.batch import code_of
from fuzzynav.data import folder
from fuzzynav.fusion import barn
from fuzzynav.fusion.scenes import ROBOTS, scene_task
from fuzzynav.fusion.task import Task

__all__ = ["PARTS", "SETS", "TaskSet"]

SETS: tuple[str, ...] = ("scenes", "barn", "dynabarn")
PARTS: tuple[str, ...] = ("held-out", "tuning", "all")
SCENES = 100  # where no number is asked for
CLASSES = ("easy", "medium", "hard")  # of twenty dynamic worlds each


@dataclass(frozen=True, kw_only=True)
class TaskSet:
    """Which tasks, and what the planner is granted in them. Raises ValueError for a choice that is not offered.

    An item names one task: "17" is a scene's seed or a static world's number, "17.3" a dynamic world and its phase.
    `seed` is that of the first scene, elsewhere of the scanner's noise.
    """

    kind: str = "scenes"
    folder: str = ""  # of BARN and DynaBARN; by default the one that travels with the course
    robot: str = "turtlebot2"  # of scenes
    ideal: bool = False  # the planner is told where the movers are
    courteous: bool = False  # movers of scenes stop before a robot that stands
    top_speed: float = barn.TOP  # [m/s] in BARN and DynaBARN
    part: str = "held-out"  # of BARN's and DynaBARN's worlds
    seed: int = 0

    def __post_init__(self) -> None:
        for name, value, offered in (
            ("set", self.kind, SETS),
            ("robot", self.robot, ROBOTS),
            ("part", self.part, PARTS),
        ):
            if value not in offered:
                raise ValueError(f"the {name} is one of {', '.join(offered)}, got {value!r}")
        if not (0.0 < self.top_speed < np.inf) or self.seed < 0:
            raise ValueError(f"give a positive top speed and a seed of 0 or more, got {self.top_speed} and {self.seed}")

    def lacking(self) -> str:
        """Why the tasks are not there; empty where they are."""
        return "" if self.kind == "scenes" else barn.lacking(self.home, self.kind)

    @property
    def home(self) -> str:
        """The folder of the worlds."""
        return self.folder or str(folder("benchmarks"))

    def items(self, count: int | None = None) -> tuple[str, ...]:
        """The first `count` tasks; all there are by default, of scenes a hundred."""
        most = np.inf if self.kind == "scenes" else len(self._numbers()) * (1 if self.kind == "barn" else barn.PHASES)
        if count is not None and not 1 <= count <= most:
            raise ValueError(f"{self.kind} has from 1 to {most} cases here, got {count}")
        if self.kind == "scenes":
            return tuple(str(self.seed + k) for k in range(count or SCENES))
        if self.kind == "barn":
            return tuple(str(n) for n in self._numbers())[:count]
        return tuple(f"{n}.{phase}" for phase in range(barn.PHASES) for n in self._numbers())[:count]

    def task(self, item: str) -> Task:
        """The task that an item names."""
        if self.kind == "scenes":
            return scene_task(int(item), robot=ROBOTS[self.robot], ideal=self.ideal, courteous=self.courteous)
        if self.kind == "barn":
            return replace(barn.static_task(self.home, int(item), top_speed=self.top_speed), ideal=self.ideal)
        number, phase = (int(part) for part in item.split("."))
        return barn.dynamic_task(self.home, number, phase, top_speed=self.top_speed, ideal=self.ideal)

    def noise(self, item: str) -> int:
        """The seed of a task's run."""
        return int(item) if self.kind == "scenes" else self.seed

    def group(self, item: str) -> str:
        """The class of a task: easy, medium or hard in DynaBARN, elsewhere all in one."""
        return CLASSES[int(item.split(".")[0]) // 20] if self.kind == "dynabarn" else "all"

    def parameters(self) -> dict[str, str]:
        """What the rows depend on, as texts that read the same on every machine."""
        scenes, worlds = ("robot", "courteous"), ("top_speed", "part", "seed", "worlds")
        names = ("kind", "ideal", *(scenes if self.kind == "scenes" else worlds))
        return {name: str(getattr(self, name)) for name in names}

    @cached_property
    def worlds(self) -> str:
        """Sixteen hexadecimal digits for what the files of the set say, whatever form they have."""
        first = [item for item in self.items() if item.endswith(".0") or "." not in item]
        whole = hashlib.sha256()
        for task in map(self.task, first):
            discs = np.round(task.world.discs, 6)
            rows = [discs[np.lexsort(discs.T)], np.round(task.world.rectangles, 6), np.round([task.optimum], 6)]
            movers = [np.round(m.frames, 6) for m in task.world.movers]
            for part in (*rows, *movers):
                whole.update(part.tobytes())
        return whole.hexdigest()[:16]

    def code(self) -> str:
        """Sixteen hexadecimal digits for the code that makes the tasks and judges the runs."""
        parts = (code_of("fuzzynav.benchmark.tasks", "TaskSet"), code_of("fuzzynav.fusion.protocol", "drive"))
        return hashlib.sha256(" ".join(parts).encode()).hexdigest()[:16]

    def _numbers(self) -> tuple[int, ...]:
        """The worlds of the part that was asked for."""
        parts = {"held-out": barn.test_numbers(self.kind), "tuning": barn.tuning_numbers(self.kind)}
        return tuple(sorted(parts["held-out"] + parts["tuning"])) if self.part == "all" else parts[self.part]
