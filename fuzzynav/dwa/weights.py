"""The fuzzy dynamic window approach: a rule base sets the three weights anew in every step."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.control import Observation
from fuzzynav.dwa.controller import Controller, Stuck
from fuzzynav.dwa.decision import Field
from fuzzynav.dwa.steps import TABLE_3_3, Params
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.geometry import Array, wrap
from fuzzynav.robot import Robot

__all__ = ["INPUTS", "OUTPUTS", "FuzzyWeights", "fuzzy_controller", "inputs_of", "retuned"]

INPUTS = ("headGoal", "distObs", "velRob")
OUTPUTS = ("alpha", "beta", "gamma")
AHEAD = 1e-9  # [deg] a heading is never known so exactly (ours)
UNIVERSES = np.array([[0.0, 180.0], [0.0, 15.0], [0.0, 1.0]])  # thesis section 3.5.1


def inputs_of(observation: Observation, nearest: float) -> Array:
    """Inputs `(3,)` of the rule base: angle to the goal [deg], nearest obstacle [m], speed [m/s], cut to their ranges.

    An obstacle beyond sight counts as the far end of its range; an angle within AHEAD as straight ahead, so that no
    rule fires for the last digit of a heading.
    """
    x, y, theta = np.asarray(observation.pose, dtype=float)
    dx, dy = np.asarray(observation.goal, dtype=float)[:2] - (x, y)
    head = abs(float(np.degrees(wrap(np.arctan2(dy, dx) - theta))))
    head = head if head > AHEAD else 0.0
    speed = abs(float(np.asarray(observation.velocity)[0]))
    return np.clip([head, min(nearest, 15.0), speed], UNIVERSES[:, 0], UNIVERSES[:, 1])


class FuzzyWeights:
    """Weights from a rule base, for `dwa.Controller(weigh=...)`.

    Where no rule fires, or all three weights come out as 0, the nominal weights hold and the step is reported as
    uncovered (errata T40).
    Raises ValueError unless the system has the inputs headGoal, distObs, velRob and the outputs alpha, beta, gamma.
    """

    def __init__(self, system: FuzzySystem, nominal: ArrayLike = TABLE_3_3.weights) -> None:
        self.system, self.nominal = system, np.asarray(nominal, dtype=float)
        named = tuple(v.name for v in system.inputs), tuple(v.name for v in system.outputs)
        if set(named[0]) != set(INPUTS) or set(named[1]) != set(OUTPUTS):
            raise ValueError(f"{system.name} maps {named[0]} to {named[1]}; needed: {INPUTS} to {OUTPUTS}")
        self._in = [INPUTS.index(name) for name in named[0]]
        self._out = [named[1].index(name) for name in OUTPUTS]

    def at(self, inputs: ArrayLike) -> tuple[Array, bool]:
        """Weights `(3,)` for headGoal [deg], distObs [m], velRob [m/s], and whether any rule fired."""
        row = np.asarray(inputs, dtype=float)
        result = self.system.evaluate(*(float(row[k]) for k in self._in))
        if not float(np.max(result.firing)) > 0.0:
            return self.nominal.copy(), False
        values = np.array([float(np.asarray(result.values[k])) for k in self._out])
        weights = np.where(np.isfinite(values), np.maximum(values, 0.0), self.nominal)
        return (weights, True) if weights.sum() > 0.0 else (self.nominal.copy(), False)

    def __call__(self, observation: Observation, nearest: float) -> tuple[Array, bool]:
        """Weights for this step, and whether a rule covered it."""
        return self.at(inputs_of(observation, nearest))


def fuzzy_controller(
    robot: Robot,
    system: FuzzySystem,
    params: Params = TABLE_3_3,
    *,
    field: Field | None = None,
    stuck: Stuck | None = None,
    keep: bool = False,
) -> Controller:
    """A dynamic window controller whose weights come from a rule base; the parameters' weights are its fallback."""
    return Controller(robot, params, weigh=FuzzyWeights(system, params.weights), field=field, stuck=stuck, keep=keep)


def retuned(system: FuzzySystem, middles: dict[str, float], widths: dict[str, float]) -> FuzzySystem:
    """The rule base with other triangles: for each input the peak of its middle set and the reach of all three.

    A reach of 1 is the shipped overlap, where every set ends at its neighbour's peak.
    """
    changed = {}
    for variable in system.inputs:
        low, high = variable.low, variable.high
        peak, reach = middles[variable.name], widths[variable.name]
        left, right = reach * (peak - low), reach * (high - peak)
        corners = ((low, low, low + left), (peak - left, peak, peak + right), (high - right, high, high))
        for term, numbers in zip(variable.terms, corners, strict=True):
            changed[variable.name, term.name] = numbers
    return system.with_terms(changed)
