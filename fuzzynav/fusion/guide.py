"""Where to: the map that remembers, the way over it, the sub-goal of the moment, and when to seek a new way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fuzzynav.checks import not_negative, positive
from fuzzynav.control import Observation
from fuzzynav.fusion.memory import Memory
from fuzzynav.fusion.route import Route, clear_from, route, target_of
from fuzzynav.fusion.sensed import Surroundings
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning.astar import OPTIMAL, Options

__all__ = ["Guide", "Planning"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Planning:
    """How the way over the map is sought, and when anew; all ours.

    Times of inf switch off: `every` the search anew, `check` the look whether the way is still free, `patience` the
    ways round movers. Raises ValueError for lengths and times that are not positive, and for no rooms.
    """

    options: Options = OPTIMAL
    resolution: float = 0.1  # [m] of the map that remembers
    rooms: tuple[float, ...] = (0.25, 0.15, 0.1, 0.08, 0.06, 0.04, 0.02, 0.0, -0.02, -0.04)  # [m] beyond the radius
    enters: bool = True  # what the scanner finds is entered into the map
    wary: float = 0.0  # [m] more room beside what only the scanner knows, where movers are about
    every: float = 2.0  # [s]
    check: float = 0.5  # [s]
    patience: float = 3.0  # [s] without progress, until movers count as obstacles of the way
    around: float = 8.0  # [s] for which they do
    beside: float = 0.2  # [m] that the way keeps from them
    near: float = 5.0  # [m] movers further away do not count
    progress: float = 0.3  # [m] by which the way must have become shorter
    slack: float = 0.01  # [m] beyond the robot's radius that a view of a turning point must be free
    explained: float = 0.15  # [m] a hit this near to the known map belongs to it

    def __post_init__(self) -> None:
        positive(resolution=self.resolution, progress=self.progress, near=self.near)
        for name in ("wary", "around", "beside", "explained"):
            not_negative(**{name: getattr(self, name)})
        if not (self.every > 0 and self.check > 0 and self.patience > 0):
            raise ValueError(f"every, check and patience must be positive seconds or inf, got {self}")
        if not self.rooms or list(self.rooms) != sorted(self.rooms, reverse=True):
            raise ValueError(f"rooms must be metres, the widest first, got {self.rooms}")


class Guide:
    """Keeps the way to the goal while the map grows; `update` once a step, `reset` before every run."""

    def __init__(self, radius: float, planning: Planning, chart: GridMap | None, speed_bound: float) -> None:
        self.radius, self.planning = radius, planning
        self.fixed = speed_bound <= 0.0
        self.wary = planning.wary if speed_bound > 0.0 else 0.0
        self.memory = Memory(chart, planning.resolution, fades=speed_bound > 0.0)
        self.reset()

    def reset(self) -> None:
        """Forget everything that the last run left."""
        self.memory.reset()
        self.map: GridMap | None = None
        self.way: Route | None = None
        self.index = self.searches = self.seen = 0
        self.searched = self.looked = -np.inf
        self.best, self.since, self.until = np.inf, 0.0, -np.inf
        self.shut: list[Array] = []  # places that it could not get to, although nothing moves

    def update(self, observation: Observation, around: Surroundings) -> Array:
        """Take in what was seen; the point `(2,)` [m] to head for: the last turning point in view, or the goal."""
        here, goal = np.asarray(observation.pose, dtype=float)[:2], np.asarray(observation.goal, dtype=float)
        self.memory.enter(observation, around.standing & self.planning.enters)
        blocked = self._blocked(observation.time, here)
        waits = observation.time - self.since >= self.planning.patience
        if waits:
            self.until, self.since = observation.time + self.planning.around, observation.time
            if self.fixed and self.way is not None:
                self.shut.append(np.array([*self.way.points[self.index], self.memory.resolution]))
        if self.way is None or blocked or waits or observation.time - self.searched >= self.planning.every - 1e-9:
            self._search(observation.time, here, goal, around.movers)
        if self.way is None or self.map is None:
            return goal
        self.index = target_of(self.map, here, self.way, self.index, self.radius + self.planning.slack)
        self._note(observation.time, here)
        return np.asarray(self.way.points[self.index])

    def _blocked(self, now: float, here: Array) -> bool:
        """Whether the way is no longer free, looked at from time to time."""
        if self.way is None or now - self.looked < self.planning.check - 1e-9:
            return False
        self.looked = now
        if self.memory.changes == self.seen:
            return False
        self.seen = self.memory.changes
        return not clear_from(
            self.memory.grid(None, self.wary), here, self.way, self.index, self.radius + self.planning.slack
        )

    def _search(self, now: float, here: Array, goal: Array, movers: Array) -> None:
        """Seek a way over the map of this moment; the old one stays where there is none, and all places open again."""
        discs = np.array(self.shut) if self.shut else None
        if now < self.until and len(movers):
            close = np.hypot(*(movers[:, :2] - here).T) < self.planning.near
            discs = np.column_stack([movers[close, :2], movers[close, 4] + self.planning.beside])
        self.map, self.searched, self.looked = self.memory.grid(discs, self.wary), now, now
        self.searches += 1
        rooms = self.planning.rooms
        if now < self.until:  # stuck: no more gaps that may be too narrow, where there is another way
            rooms = tuple(room for room in rooms if room >= 0.0) or rooms
        found = route(self.map, here, goal, self.radius, rooms, self.planning.options)
        if found is not None:
            self.way, self.index = found, min(1, len(found.points) - 1)
        else:
            self.shut.clear()

    def _note(self, now: float, here: Array) -> None:
        """Note whether the way became shorter."""
        if self.way is None:
            return
        left = self.way.left(here, self.index)
        if left < self.best - self.planning.progress or left > self.best + self.planning.near:
            self.best, self.since = left, now
