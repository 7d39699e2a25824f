"""What 1 stands for in our rules of escape: a thousand random choices, each on the traps that are kept for it."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from fuzzynav.potential import IMPROVED, Escape, walk
from fuzzynav.potential.traps import RADIUS, Trap, trap
from fuzzynav.studies.potential.freeing import STEPS, TRAINED, rules
from fuzzynav.studies.study import Study

__all__ = ["CANDIDATES", "TUNING_STUDY", "candidate", "one_candidate"]

CANDIDATES = 1000


def candidate(seed: int) -> dict[str, float]:
    """One choice: angle [rad], gain, force and distance [m] that 1 stands for, the hold [iterations], its growth,
    and how many sizes the angle takes."""
    rng = np.random.default_rng([5, seed])
    return {
        "angle": round(float(rng.uniform(1.5, 4.5)), 2),
        "gain": round(float(np.exp(rng.uniform(np.log(5.0), np.log(100.0)))), 1),
        "strong": float(rng.choice([5.0, 10.0, 20.0, 50.0])),
        "far": round(float(rng.uniform(3.5, 12.0)), 1),
        "hold": int(rng.integers(50, 600)),
        "growth": round(float(rng.uniform(1.0, 1.8)), 2),
        "cycle": int(rng.integers(1, 10)),
    }


@cache
def _scenes() -> tuple[Trap, ...]:
    """The traps for tuning."""
    return tuple(trap(seed) for seed in TRAINED)


def one_candidate(seed: int | str) -> dict[str, Any]:
    """How many of the traps for tuning a choice frees, of each kind, and how many of them it touches."""
    chosen = candidate(int(seed))
    escape = Escape(rules=rules("ours_apf_escape"), goalward=True, turns=True, most=1000, **chosen)  # type: ignore[arg-type]
    walks = [
        (scene.kind, walk(scene.start, scene.goal, scene.obstacles, IMPROVED, STEPS, escape=escape, radius=RADIUS))
        for scene in _scenes()
    ]
    freed = [made.length for _, made in walks if made.status == "reached"]
    return {
        **chosen,
        "freed": len(freed),
        "touched": sum(made.status == "collided" for _, made in walks),
        "length": round(float(np.median(freed)), 6) if freed else 0.0,
    }


TUNING_STUDY = Study(
    name="apf_tuning",
    experiment=one_candidate,
    cases=range(CANDIDATES),
    parameters={"traps": f"{TRAINED.start} to {TRAINED.stop - 1}"},
    inputs=("fuzzy/ours_apf_escape.fll",),
)
