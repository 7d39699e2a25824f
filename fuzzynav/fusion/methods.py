"""The planners that are compared, each as a function from a task to the controller that drives it.

All plan for the same robot and the same time step; what differs is said here. The resolution of a window is the
thesis's, coarser only where the robot's accelerations would make a window of more than SPEEDS by TURNS samples. The
horizon is the thesis's 3 s, for our own baselines no longer than half a turn takes at full rate: an arc that goes
round says nothing about where it leads.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial

import numpy as np

from fuzzynav.control import Controller, Observation
from fuzzynav.data import folder
from fuzzynav.dwa.controller import Controller as Window
from fuzzynav.dwa.controller import Stuck
from fuzzynav.dwa.steps import TABLE_3_3, Params
from fuzzynav.dwa.weights import FuzzyWeights
from fuzzynav.fusion.controller import Navigator
from fuzzynav.fusion.decision import EVADING
from fuzzynav.fusion.decision import Params as DecisionParams
from fuzzynav.fusion.guide import Planning
from fuzzynav.fusion.printed import PRINTED, Printed
from fuzzynav.fusion.subgoals import (
    Keep,
    arc_cap,
    capped,
    global_path,
    key_nodes,
    pruned,
    sub_goals,
    switched_by_view,
    turning_points,
)
from fuzzynav.fusion.task import Method, Task
from fuzzynav.fusion.tracks import Tracker, TrackParams
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.geometry import Array
from fuzzynav.planning.astar import EFFICIENT, ENHANCED, TRADITIONAL, Options
from fuzzynav.robot import Robot

__all__ = ["METHODS", "PathFollower", "fitted_params", "ours", "path_of", "printed_fusion"]

SPEEDS, TURNS = 15, 31  # samples of a window: at most these, and zero
BEST_FIXED = (0.2, 0.7, 0.1)  # of all fixed weights the best on the training maps of chapter 06
MARGIN = 0.1  # [m] that the baselines keep beyond stopping; without it they wedge themselves beside obstacles
OURS, PLANNING = DecisionParams(), Planning()
STRAIGHT = Planning(patience=np.inf, wary=0.1)  # evading: no ways round movers, and room beside unproved ones
LEAST_NOISE = 0.003  # [m] of a range: also a scanner without noise sees a disc as a polygon
RECOVERY = Stuck(tries=5)  # a baseline may turn away five times before it gives up


def fitted_params(params: Params, robot: Robot, dt: float) -> Params:
    """The parameters with this time step, and resolutions that keep any window to SPEEDS by TURNS samples.

    >>> from fuzzynav.robot import THESIS, TURTLEBOT2
    >>> fitted_params(TABLE_3_3, THESIS, 0.1) == TABLE_3_3
    True
    >>> round(fitted_params(TABLE_3_3, TURTLEBOT2, 0.1).v_resolution, 4)
    0.0357
    """
    gain = min(2.0 * max(robot.acc_lim_x, robot.dec_lim_x) * dt, robot.max_vel_x - robot.min_vel_x)
    spin = 2.0 * min(robot.acc_lim_theta * dt, robot.max_vel_theta)
    return replace(
        params,
        dt=dt,
        sim_time=max(params.sim_time, dt),
        v_resolution=max(params.v_resolution, gain / (SPEEDS - 1)),
        omega_resolution=max(params.omega_resolution, spin / (TURNS - 1)),
    )


def path_of(task: Task, options: Options, keep: Keep) -> Array:
    """The global path `(n, 2)` [m] on the task's map; without a map the goal alone, without a path nothing.

    The path keeps the safety radius, at least that of the robot; where that leaves none, the robot's own.
    """
    if task.chart is None:
        return np.array([task.start[:2], task.goal])
    safe = max(options.safety_radius, task.robot.radius)
    for radius in dict.fromkeys((safe, task.robot.radius)):
        found = global_path(task.chart, task.start, task.goal, replace(options, safety_radius=radius), keep)
        if len(found):
            return found
    return np.empty((0, 2))


class PathFollower(Controller):
    """A dynamic window that heads for one sub-goal of a path after the other.

    The next one is taken when it is in clear view, and no arc is driven faster than one that leads through the
    sub-goal. An empty path ends the run as no_path.
    """

    def __init__(self, task: Task, path: Array, window: Window) -> None:
        self.task, self.path, self.window = task, path, window
        self.reset()

    def reset(self) -> None:
        """Head for the first sub-goal again, and forget the run before."""
        self.window.reset()
        self.goals = sub_goals(self.path) if len(self.path) else None

    @property
    def status(self) -> str | None:
        """A reason to end the run: no path, or what the window says."""
        return self.window.status if self.goals is not None else "no_path"

    @property
    def evidence(self) -> dict[str, float]:
        """What the window says of its last call, and which sub-goal it headed for."""
        return {} if self.goals is None else {**self.window.evidence, "subgoal": float(self.goals.index)}

    def __call__(self, observation: Observation) -> Array:
        """Command (v [m/s], omega [rad/s]) for the next step."""
        if self.goals is None:
            return np.zeros(2)
        robot = self.task.robot
        if not observation.faults():
            self.goals = switched_by_view(self.goals, observation.pose, self.task.chart, robot.radius)
            cap = arc_cap(observation.pose, self.goals.current, robot.max_vel_theta)
            self.window.robot = capped(robot, cap, float(observation.velocity[0]), self.task.dt)
        return self.window(replace(observation, goal=self.goals.current))


@cache
def _rules(name: str) -> FuzzySystem:
    return FuzzySystem.load(folder("fuzzy") / f"{name}.fll")


def _window(task: Task, rules: str | None = None) -> Window:
    """The window of chapter 06: braking along the arc, the best fixed weights or those of a rule base, recovery."""
    horizon = min(TABLE_3_3.sim_time, np.pi / task.robot.max_vel_theta)
    params = fitted_params(replace(TABLE_3_3, weights=BEST_FIXED, sim_time=horizon, margin=MARGIN), task.robot, task.dt)
    weigh = None if rules is None else FuzzyWeights(_rules(rules), TABLE_3_3.weights)
    return Window(task.robot, params, weigh=weigh, stuck=RECOVERY)


def printed_fusion(task: Task) -> Printed:
    """The fusion of thesis chapter 4 as printed: enhanced A*, sub-goals by their distance, eq 4.13 and 4.15."""
    params = replace(PRINTED, window=fitted_params(PRINTED.window, task.robot, task.dt))
    return Printed(task.robot, path_of(task, ENHANCED, pruned), params, ideal=task.ideal)


def plain_window(task: Task) -> Window:
    """Traditional DWA: straight to the goal, without a map."""
    return _window(task)


def along_path(task: Task, options: Options, keep: Keep, rules: str | None = None) -> PathFollower:
    """A path, its sub-goals, and the window of chapter 06 between them."""
    return PathFollower(task, path_of(task, options, keep), _window(task, rules))


def ours(task: Task, params: DecisionParams = OURS, planning: Planning = PLANNING) -> Navigator:
    """The planner of this chapter; without a map it remembers on finer cells, and it tracks what no one tells it.

    Three standard deviations of a range are kept from what stands, and count as the error of what may move.
    """
    doubt = 3.0 * task.laser.noise
    tracker = None
    if not task.ideal and task.speed_bound > 0.0:
        noise = max(task.laser.noise, LEAST_NOISE)
        tracker = Tracker(TrackParams(range_noise=noise, velocity_bound=task.speed_bound))
        params = replace(params, error=max(params.error, doubt))
    return Navigator(
        task.robot,
        speed_bound=task.speed_bound,
        chart=task.chart,
        params=replace(params, dt=task.dt, margin=max(params.margin, doubt)),
        planning=planning if task.chart is not None else replace(planning, resolution=0.5 * planning.resolution),
        tracker=tracker,
    )


_STRICT = replace(TRADITIONAL, corners="strict")  # a disc cannot cut corners
_EFFICIENT = replace(EFFICIENT, corners="strict")

METHODS: dict[str, Method] = {
    "ours": ours,
    "ours, evading": partial(ours, params=EVADING, planning=STRAIGHT),
    "printed": printed_fusion,
    "TDWA": plain_window,
    "A* + DWA": partial(along_path, options=_STRICT, keep=turning_points),
    "Efficient A* + fuzzy DWA": partial(
        along_path, options=_EFFICIENT, keep=key_nodes, rules="thesis_table_3_2_completed"
    ),
    "Efficient A* + fuzzy DWA, tuned": partial(along_path, options=_EFFICIENT, keep=key_nodes, rules="ours_dwa_tuned"),
}
