"""The answers to the labs of chapter 03."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fuzzynav.course.answers.answer import Answer
from fuzzynav.studies.fuzzy import SpeedSets, planner, rule_base, speed_system

__all__ = ["ANSWERS"]


def _speed(distance: float, error: float, **sets: float) -> float:
    return float(speed_system(replace(SpeedSets(), **sets))(distance, error)[0])


def _gap() -> str:
    sets = {"near_end": 0.5, "medium_left": 1.0}
    d = np.round(np.arange(0.0, 4.001, 0.05), 2)
    silent = d[[bool(np.isnan(_speed(float(x), 0.0, **sets))) for x in d]]
    return f"""From {silent[0]:.1f} to {silent[-1]:.1f} m no rule fires, and there is no speed at all.
    Just before, at 0.45 m, the speed is {_speed(0.45, 0.0, **sets):.2f} m/s, and just behind, at 1.05 m,
    {_speed(1.05, 0.0, **sets):.2f} m/s, although Near and Medium have almost faded: the centroid forgets how weakly
    a rule fires. With an error above 0 rule 4 speaks at every distance and hides the gap. A triangle whose left
    foot has passed its peak is refused, with a sentence."""


def _narrow() -> str:
    wide, thin = _speed(1.0, 30.0), _speed(1.0, 30.0, slow_end=0.02)
    return f"""Because the output is the balance point of areas. Clipped at the same height, a narrower Slow has
    less area and pulls less, so that Middle wins: at 1 m and 30 degrees the speed rises from {wide:.3f} to
    {thin:.3f} m/s. The width of a conclusion is its weight; a singleton, as in Takagi-Sugeno systems, would not
    have this effect."""


def _surface() -> str:
    grid, at = np.linspace(0.0, 1.0, 101), (0.8, 0.3, 0.5)
    spans = []
    for k in range(3):
        point = [np.full(101, v) for v in at]
        point[k] = grid
        v = planner()(*point)[0]
        spans.append((float(np.min(v)), float(np.max(v))))
    return f"""The obstacle, which is not on an axis: from the worked example D_obs alone moves the speed between
    {spans[2][0]:.2f} and {spans[2][1]:.2f} m/s, D_G and D_S between {spans[0][0]:.2f} and {spans[0][1]:.2f}. The
    steps show once the sets hardly overlap, below a sigma of about 0.1: between two centres one rule then speaks
    nearly alone, and the surface becomes flat terraces with steep edges. At 0.3 all rules speak at once, and little
    is left of any of them."""


def _widened() -> str:
    table = rule_base("thesis_table_3_2")
    heading, speed = np.linspace(0.0, 180.0, 61), np.linspace(0.0, 1.0, 61)
    for width in np.round(np.arange(1.0, 3.01, 0.05), 2):
        changed = {}
        for variable in table.inputs:
            for term in variable.terms:
                a, b, c = term.parameters
                changed[term] = replace(term, parameters=(b - width * (b - a), b, b + width * (c - b)))
        inputs = (replace(v, terms=tuple(changed[t] for t in v.terms)) for v in table.inputs)
        wide = replace(table, inputs=tuple(inputs))
        firing = wide.evaluate(heading[None, :], 6.0, speed[:, None]).firing.max(axis=-1)
        if firing.min() > 0.0:
            break
    return f"""No. From a width of {width:.2f} on nothing is orange, but in the corners the strongest rule speaks
    with {firing[-1, 0]:.2f} only, and it is a rule for another pairing of heading and speed: at heading 0 and full
    speed the rules of a slow robot, or of one that looks the other way, decide. A weak rule answers as loudly as a
    strong one. The gap is closed by rules that know what to do there, as in exercise 03.5, not by sets that reach
    further."""


ANSWERS = (
    Answer("03.lab1", _gap),
    Answer(
        "03.lab2",
        """Small must end where Large begins or before, for instance both at 45 degrees or Small at 40 and Large at
        50. But then nobody speaks in between: at exactly 45 in the first case, from 40 to 50 in the second, there
        is no speed when the obstacle is far. Sets of neighbours must overlap; that two rules share a point is not a
        fault but what makes the answer smooth.""",
    ),
    Answer("03.lab3", _narrow),
    Answer("03.lab4", _surface),
    Answer("03.lab5", _widened),
)
