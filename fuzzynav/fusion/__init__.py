"""Plan and react: a global path, a local window among moving obstacles, and what keeps both safe (chapter 07)."""

from fuzzynav.fusion.controller import Navigator
from fuzzynav.fusion.decision import EVADING, REASONS, Decision, Evasion, Params, decide
from fuzzynav.fusion.guide import Guide, Planning
from fuzzynav.fusion.hall import HALL, hall_task
from fuzzynav.fusion.memory import Memory
from fuzzynav.fusion.methods import METHODS, PathFollower
from fuzzynav.fusion.moments import Moment, Witness, watch
from fuzzynav.fusion.objective import DELTA, WEIGHTS, improved_objective, terms
from fuzzynav.fusion.printed import PRINTED, Printed
from fuzzynav.fusion.route import Route
from fuzzynav.fusion.scenes import GOAL, ROBOTS, SPEED_BOUND, START, scene_task
from fuzzynav.fusion.sensed import Surroundings, surroundings
from fuzzynav.fusion.separation import passive_separation, reached_by_then, static_separation, stays_clear
from fuzzynav.fusion.subgoals import (
    SubGoals,
    arc_cap,
    global_path,
    sub_goals,
    switched_by_radius,
    switched_by_view,
)
from fuzzynav.fusion.task import Method, Task
from fuzzynav.fusion.tracks import Tracker, TrackParams, Tracks, kalman_step

__all__ = [
    "DELTA", "EVADING", "GOAL", "HALL", "METHODS", "PRINTED", "REASONS", "ROBOTS", "SPEED_BOUND", "START", "WEIGHTS",
    "Decision", "Evasion", "Guide", "Memory", "Method", "Moment", "Navigator", "Params", "PathFollower", "Planning",
    "Printed", "Route", "SubGoals", "Surroundings", "Task", "TrackParams", "Tracker", "Tracks", "Witness", "arc_cap",
    "decide", "global_path", "hall_task", "improved_objective", "kalman_step", "passive_separation", "reached_by_then",
    "scene_task", "static_separation", "stays_clear", "sub_goals", "surroundings", "switched_by_radius",
    "switched_by_view", "terms", "watch",
]  # fmt: skip
