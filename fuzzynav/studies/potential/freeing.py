"""Does Fuzzy-APF free a trapped robot? Its rules in every reading, and rules of ours, on a thousand traps.

The rules of ours were tuned on traps TRAINED, everything is judged on traps from JUDGED on. Every walk may take STEPS;
what counts is who reaches the goal, and who touches something.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from fuzzynav.data import folder
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.potential import IMPROVED, Escape, Steps, walk
from fuzzynav.potential.traps import RADIUS, trap
from fuzzynav.studies.study import Study

__all__ = ["JUDGED", "OURS", "READINGS", "STEPS", "TRAINED", "TRAPS", "TRAP_STUDY", "escapes", "one_trap", "rules"]

TRAINED, JUDGED, TRAPS = range(200), 10_000, 1000
STEPS = Steps(most=20_000)  # 200 m, 18 times the straight way
# ours, found by the study `apf_tuning`
OURS: Mapping[str, Any] = {
    "angle": 2.72,
    "gain": 73.4,
    "strong": 20.0,
    "far": 5.2,
    "hold": 113,
    "growth": 1.26,
    "cycle": 3,
}
READINGS: Mapping[str, dict[str, Any]] = {
    "as printed, target one step away": {"radius": 0.01},
    "as printed, target 1 m away": {"radius": 1.0},
    "as printed, target 5 m away": {"radius": 5.0},
    "from the goal's direction, 1 m": {"radius": 1.0, "goalward": True},
    "from the goal's direction, 5 m": {"radius": 5.0, "goalward": True},
    "the same, sides change and holds grow": {"radius": 5.0, "goalward": True, "turns": True, "growth": 1.3},
}


@cache
def rules(name: str) -> FuzzySystem:
    """A rule base of data/fuzzy."""
    return FuzzySystem.load(folder("fuzzy") / f"{name}.fll")


def escapes() -> dict[str, Escape | None]:
    """What is compared: no escape, the printed rules as they may be read, and ours."""
    printed = {name: Escape(rules=rules("fuzzy_apf_table_1"), **given) for name, given in READINGS.items()}
    ours = Escape(rules=rules("ours_apf_escape"), goalward=True, turns=True, most=1000, **OURS)
    forgetful = replace(ours, turns=False, growth=1.0, cycle=1)
    return {"no escape": None, **printed, "ours, without memory": forgetful, "ours": ours}


def one_trap(case: str) -> dict[str, Any]:
    """How a walk ends; case: 'seed/method'."""
    seed, _, method = case.partition("/")
    scene = trap(int(seed))
    made = walk(scene.start, scene.goal, scene.obstacles, IMPROVED, STEPS, escape=escapes()[method], radius=RADIUS)
    return {
        "seed": int(seed),
        "method": method,
        "kind": scene.kind,
        "status": made.status,
        "length": round(made.length, 6),
        "traps": len(made.trapped),
        "left": round(float(np.hypot(*(made.places[-1] - scene.goal))), 6),
    }


def _cases() -> tuple[str, ...]:
    methods = ("no escape", *READINGS, "ours, without memory", "ours")
    return tuple(f"{JUDGED + k}/{method}" for k in range(TRAPS) for method in methods)


TRAP_STUDY = Study(
    name="apf_traps",
    experiment=one_trap,
    cases=_cases(),
    parameters={"robot radius [m]": RADIUS, "iterations": STEPS.most, "judged from": JUDGED},
    inputs=("fuzzy/fuzzy_apf_table_1.fll", "fuzzy/ours_apf_escape.fll"),
)
