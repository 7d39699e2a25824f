"""The planner of chapter 07: a way over the map, sub-goals on it, and a window that keeps clear of what may move."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fuzzynav.control import Observation
from fuzzynav.dwa.sight import border
from fuzzynav.fusion import kernels
from fuzzynav.fusion.decision import Decision, Params, settings_of
from fuzzynav.fusion.memory import Memory
from fuzzynav.fusion.route import Route, clear_from, route, target_of
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar
from fuzzynav.robot import Robot

__all__ = ["Navigator", "Planning"]

NO_POINTS, NO_RADII, NO_DISCS, NO_TRACKS = np.empty((0, 2)), np.empty(0), np.empty((0, 3)), np.empty((0, 5))


@dataclass(frozen=True, slots=True, kw_only=True)
class Planning:
    """How the way over the map is sought, and when anew; all ours."""

    options: astar.Options = astar.OPTIMAL
    resolution: float = 0.1  # [m] of the map
    rooms: tuple[float, ...] = (0.25, 0.1)  # [m] beyond the robot's radius, widest first
    every: float = 2.0  # [s] between two searches
    check: float = 0.5  # [s] between two looks whether the way is still free
    patience: float = 3.0  # [s] without progress, until movers count as obstacles of the way
    around: float = 8.0  # [s] for which they do
    progress: float = 0.3  # [m] by which the way must shorten to count as progress
    explained: float = 0.15  # [m] nearer than this to the known map a point belongs to it


class Navigator:
    """The planner of chapter 07 as a controller.

    `speed_bound` [m/s] is the one thing it is told about movers. It takes their places from the observation where an
    ideal tracker tells them, otherwise from its scans: then every point that the map does not explain may move.
    """

    def __init__(
        self,
        robot: Robot,
        params: Params | None = None,
        *,
        speed_bound: float,
        chart: GridMap | None = None,
        planning: Planning | None = None,
        tracker: object | None = None,
    ) -> None:
        self.robot, self.params, self.planning = robot, params or Params(), planning or Planning()
        self.speed_bound, self.chart, self.tracker = speed_bound, chart, tracker
        self.wary = 0.1 if self.params.guard and speed_bound > 0 else 0.0
        self.memory = Memory(chart, self.planning.resolution, fades=speed_bound > 0.0)
        self.reset()

    def reset(self) -> None:
        """Forget everything that the last run left."""
        self.memory.reset()
        if self.tracker is not None:
            self.tracker.reset()
        self.way: Route | None = None
        self.at, self.searches = 0, 0
        self.searched = self.looked = -np.inf
        self.map: GridMap | None = None
        self.changes = -1
        self.best, self.since, self.until = np.inf, 0.0, -np.inf
        self.decision: Decision | None = None
        self.status: str | None = None
        self.evidence: dict[str, float] = {}
        self.last = np.zeros(2)

    def __call__(self, observation: Observation) -> Array:
        """Command (v [m/s], omega [rad/s]) for the next step."""
        points = np.asarray(observation.points, dtype=float).reshape(-1, 2)
        movers, own, explained = self._movers(observation, points)
        self._remember(observation, ~(own | explained))
        here, goal = np.asarray(observation.pose, dtype=float)[:2], np.asarray(observation.goal, dtype=float)
        self._steer(observation.time, here, goal, movers)
        target = goal if self.way is None else self.way.points[self.at]
        sensed = self._sensed(observation, points, movers, own, explained)
        self.decision = self._decide(observation, target, sensed)
        self.last = self.decision.command
        return self.last

    def _movers(self, observation, points):
        explained = np.zeros(len(points), dtype=bool)
        if self.chart is not None and len(points):
            explained = self.chart.distance(points) < self.planning.explained
        if observation.movers is not None:
            movers = np.ascontiguousarray(observation.movers, dtype=float).reshape(-1, 5)
            away = np.hypot(points[:, None, 0] - movers[None, :, 0], points[:, None, 1] - movers[None, :, 1]) - movers[:, 4]
            own = (away < 0.02).any(axis=1) if len(movers) else np.zeros(len(points), dtype=bool)
            return movers, own, explained
        if self.tracker is not None:
            tracks = self.tracker.update(observation, self.chart)
            labels = tracks.labels[np.isfinite(observation.ranges)]
            own = (labels >= 0) & np.append(tracks.moving, False)[labels]
            return tracks.movers, own, explained
        return NO_TRACKS, np.zeros(len(points), dtype=bool), explained

    def _remember(self, observation, standing):
        if observation.ranges is None:
            return
        beams = np.zeros(len(observation.ranges), dtype=bool)
        beams[np.isfinite(observation.ranges)] = standing
        self.memory.enter(observation, beams)

    def _steer(self, now, here, goal, movers):
        plan = self.planning
        left = np.inf
        if self.way is not None:
            left = float(np.hypot(*(self.way.points[self.at] - here)) + np.hypot(*np.diff(self.way.points[self.at:], axis=0).T).sum())
        if left < self.best - plan.progress:
            self.best, self.since = left, now
        blocked = self.map is None or self.way is None
        anew = False
        if now - self.since >= plan.patience:
            self.until, self.since, anew = now + plan.around, now, True
        if now - self.looked >= plan.check - 1e-9 or anew:
            self.looked = now
            self.map = self.memory.grid(self._aside(here, movers) if now < self.until else None, self.wary)
            blocked = blocked or not clear_from(self.map, here, self.way, self.at, 0.05)
            if blocked or anew or now - self.searched >= plan.every:
                self._search(now, here, goal)
        if self.way is not None and self.map is not None:
            self.at = target_of(self.map, here, self.way, self.at, 0.05)

    def _aside(self, here, movers):
        near = np.hypot(*(movers[:, :2] - here).T) < 5.0
        return np.column_stack([movers[near, :2], movers[near, 4] + 0.1])

    def _search(self, now, here, goal):
        found = route(self.map, here, goal, self.robot.radius, self.planning.rooms, self.planning.options)
        self.searched = now
        self.searches += 1
        if found is not None:
            self.way, self.at = found, min(1, len(found.points) - 1)
            self.best = found.length

    def _sensed(self, observation, points, movers, own, explained):
        radius = self.robot.radius
        rim, radii, holes = border(
            np.ascontiguousarray(observation.ranges), np.ascontiguousarray(observation.angles), np.asarray(observation.pose),
            float(observation.range_max), radius, NO_POINTS, self.params.thinnest,
        )
        if observation.movers is not None:
            hazards = np.ascontiguousarray(movers[:, [0, 1, 4]])
            still = points[~own]
        else:
            loose = points[~explained]
            hazards = np.column_stack([loose, np.zeros(len(loose))])
            still = points
        if self.params.hidden:
            hazards = np.vstack([hazards, np.column_stack([rim, radii])])
        hazards[:, 2] += self.params.error
        tracks = np.ascontiguousarray(movers) if self.params.sim_time > 0 else NO_TRACKS
        return np.ascontiguousarray(still), rim, radii, holes, hazards, tracks

    def _decide(self, observation, target, sensed):
        limits, settings = settings_of(self.robot, self.params, self.speed_bound)
        here = np.asarray(observation.pose, dtype=float)
        dx, dy = target - here[:2]
        off = abs((np.arctan2(dy, dx) - here[2] + np.pi) % (2 * np.pi) - np.pi)
        cap = self.robot.max_vel_theta * np.hypot(dx, dy) / max(2.0 * np.sin(min(off, np.pi / 2)), 1e-9)
        lim = limits.copy()
        lim["v_high"] = min(float(lim["v_high"][0]), max(cap, 0.1))
        samples, raw, ways, reasons, shares, totals, best = kernels.decide(
            np.asarray(observation.velocity, dtype=float), here, target, sensed, lim, settings, np.array(self.params.weights)
        )
        chosen = len(samples) - 1 if best < 0 else best
        return Decision(samples[chosen].copy(), samples, raw, shares, totals, reasons, ways, chosen, best < 0)
