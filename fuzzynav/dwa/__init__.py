"""The dynamic window approach: which speeds can be reached, which can stop, which is best (chapter 06)."""

from fuzzynav.dwa.controller import Controller, Stuck, nearest_of
from fuzzynav.dwa.decision import REASONS, Field, Plan, blind_spots, plan
from fuzzynav.dwa.steps import (
    TABLE_3_3,
    TABLE_4_1,
    Params,
    admissible,
    admissible_as_printed,
    arcs,
    brake,
    distance_score,
    end_clearance,
    free_distance,
    heading_score,
    normalise,
    objective,
    speed_score,
    step,
    step_as_printed,
    stopping_distance,
    window,
    window_as_printed,
)
from fuzzynav.dwa.weights import INPUTS, OUTPUTS, FuzzyWeights, fuzzy_controller, inputs_of, retuned

__all__ = [
    "INPUTS", "OUTPUTS", "REASONS", "TABLE_3_3", "TABLE_4_1", "Controller", "Field", "FuzzyWeights",
    "Params", "Plan", "Stuck", "admissible", "admissible_as_printed", "arcs", "blind_spots", "brake", "distance_score",
    "end_clearance", "free_distance", "fuzzy_controller", "heading_score", "inputs_of", "nearest_of", "normalise",
    "objective", "plan", "retuned", "speed_score", "step", "step_as_printed", "stopping_distance", "window",
    "window_as_printed",
]  # fmt: skip
