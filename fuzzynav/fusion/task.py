"""One problem of a navigator: a world, a robot, where it starts, where it shall go, and what it is told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fuzzynav.control import Controller
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import Robot
from fuzzynav.sensors import Laser
from fuzzynav.simulate.loop import IDEAL_LASER, Loop
from fuzzynav.world import World

__all__ = ["Method", "Task"]

PLAIN = Loop()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Task:
    """A problem that a planner is given.

    The planner may look at everything but `world`, which is the truth, and `optimum`. Raises ValueError for a start
    that is no pose, a goal that is no point, and bounds that are negative.
    """

    name: str
    world: World
    robot: Robot
    start: Array  # (3,) x [m], y [m], theta [rad]
    goal: Array  # (2,) [m]
    speed_bound: float  # [m/s] no mover is faster
    optimum: float = np.nan  # [m] the shortest way of a disc past what stands; nan where it is not known
    chart: GridMap | None = None  # the map that the planner is given
    laser: Laser = IDEAL_LASER
    ideal: bool = False  # the planner is told where the movers are and how they move
    dt: float = 0.1  # [s]
    t_max: float = 300.0  # [s]
    loop: Loop = PLAIN

    def __post_init__(self) -> None:
        for name, size in (("start", 3), ("goal", 2)):
            values = np.array(getattr(self, name), dtype=float)
            if values.shape != (size,) or not np.isfinite(values).all():
                raise ValueError(f"Task.{name} must be {size} finite numbers, got {values.tolist()}")
            values.setflags(write=False)
            object.__setattr__(self, name, values)
        if not (self.speed_bound >= 0 and 0 < self.dt <= self.t_max < np.inf):
            raise ValueError(
                f"a task needs a speed bound of 0 or more and 0 < dt <= t_max, got {self.speed_bound}, {self.dt} and "
                f"{self.t_max}"
            )


Method = Callable[[Task], Controller]  # makes the controller that drives one task
