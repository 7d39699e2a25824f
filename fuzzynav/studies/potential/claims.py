"""Fuzzy-APF: what each printed number measures here."""

from __future__ import annotations

from functools import cache, partial

import numpy as np
import pandas as pd

from fuzzynav import batch, documents
from fuzzynav.data import folder
from fuzzynav.potential import AS_PRINTED, CLASSICAL, IMPROVED, Steps, discs, walk
from fuzzynav.studies.potential.freeing import TRAP_STUDY
from fuzzynav.studies.potential.layouts import EXPONENTS, LAYOUT_STUDY, SOUGHT, START_GOAL, counts
from fuzzynav.studies.potential.tuning import TUNING_STUDY
from fuzzynav.studies.reproduction import Reproduction
from fuzzynav.studies.study import Study

__all__ = ["REPRODUCTIONS", "STUDIES", "beside_the_goal", "layout_rows", "sought_counts"]

FEW = 2.0  # counts: places are sought on a lattice of 1 cm, one step of each axis
TABLES = {"3": "table 3", "4": "table 4"}
_MACHINE = "seconds of another machine, without a unit of work"
_FREE = "places and number of the obstacles, tolerance at the goal"
_SOUGHT = "point obstacles were sought until the fourteen counts of the table came near; steps on each axis (errata A7)"


def layout_rows() -> pd.DataFrame:
    """Counts of the layouts that nobody sought."""
    return batch.read(folder("results") / "apf_layouts.csv")


@cache
def sought_counts(environment: str) -> dict[int, float]:
    """Iterations by exponent in the environment that was sought for a table, "3", "4", "5-e1" or "5-e2"."""
    points, tolerance = SOUGHT[environment]
    exponents = (0, 10) if environment.startswith("5") else EXPONENTS
    return dict(zip(exponents, counts(np.array(points), tolerance, exponents).tolist(), strict=True))


def _near(printed: float, exponent: int) -> tuple[int, int]:
    """How many of the layouts that nobody sought come within FEW counts, of those that arrive."""
    found = layout_rows()[f"n{exponent}"].dropna()
    return int(((found - printed).abs() <= FEW).sum()), len(found)


def _value(claim_id: str) -> float:
    return float(documents.claim(claim_id).value)


def _iterations(claim_id: str, environment: str, exponent: int) -> Reproduction:
    return Reproduction(
        claim=claim_id,
        measure=lambda: sought_counts(environment)[exponent],
        tolerance=FEW,
        shows="fitted",
        free=_FREE,
        because=_SOUGHT,
        holds_for=partial(_near, _value(claim_id), exponent),
    )


def beside_the_goal(seed: int) -> tuple[bool, bool]:
    """Whether the classical field fails, and the improved one arrives, with two points beside the goal."""
    rng = np.random.default_rng([8, seed])
    angles, away = rng.uniform(-np.pi, np.pi, 2), rng.uniform(0.3, 1.5, 2)
    points = discs(np.array([8.0, 8.0]) + away[:, None] * np.column_stack([np.cos(angles), np.sin(angles)]))
    plain, better = (walk(*START_GOAL, points, gains, Steps()) for gains in (CLASSICAL, IMPROVED))
    return plain.status != "reached", better.status == "reached"


@cache
def _unreachable() -> tuple[int, int]:
    """Of the scenes whose goal the classical field does not reach, how many the improved one does."""
    found = [beside_the_goal(seed) for seed in range(200)]
    return sum(fails and arrives for fails, arrives in found), sum(fails for fails, _ in found)


def _trapped() -> tuple[int, int]:
    """In how many of the layouts that nobody sought the improved field does not arrive."""
    found = layout_rows()["n10"]
    return int(found.isna().sum()), len(found)


def _shorter() -> bool:
    """Whether the improved field needs fewer iterations than the classical one, where both arrive, in the mean."""
    both = layout_rows()[["n0", "n10"]].dropna()
    less = both["n0"] - both["n10"]
    return bool(less.mean() - 1.96 * less.std() / np.sqrt(len(less)) > 0.0)


def _shorter_counts() -> tuple[int, int]:
    both = layout_rows()[["n0", "n10"]].dropna()
    return int((both["n10"] < both["n0"]).sum()), len(both)


def _factor_at_the_goal() -> bool:
    """Whether k_imp of eq 8 vanishes with the distance: a millimetre before the goal nothing is left of k."""
    d = 1e-3
    return bool(IMPROVED.repel * (d / (d + 1.0)) ** IMPROVED.exponent < 1e-25)


def _place(point: tuple[float, float]) -> str:
    return f"[{point[0]:g},{point[1]:g}]"


REPRODUCTIONS: tuple[Reproduction, ...] = (
    *(
        Reproduction(
            claim=f"fuzzy-apf:c-2-{name}", measure=measure, tolerance=0.0, shows="input", because="as printed",
            holds_for="nothing else is free",
        )
        for name, measure in (
            ("att", lambda: CLASSICAL.attract), ("rep", lambda: CLASSICAL.repel), ("rho", lambda: CLASSICAL.influence),
            ("step", lambda: AS_PRINTED.step), ("max", lambda: AS_PRINTED.most),
            ("start", lambda: _place(START_GOAL[0])), ("end", lambda: _place(START_GOAL[1])),
        )
    ),
    *(_iterations(f"fuzzy-apf:c-{table}-n{n}-iter", table, n) for table in TABLES for n in EXPONENTS),
    *(
        Reproduction(claim=f"fuzzy-apf:c-{table}-n{n}-time", verdict="not testable", because=_MACHINE)
        for table in TABLES
        for n in EXPONENTS
    ),
    *(
        _iterations(f"fuzzy-apf:c-5-{world}-{who}-iter", f"5-{world}", exponent)
        for world in ("e1", "e2")
        for who, exponent in (("APF", 0), ("FUZZY_APF", 10))
    ),
    *(
        Reproduction(claim=f"fuzzy-apf:c-5-{world}-{who}-time", verdict="not testable", because=_MACHINE)
        for world in ("e1", "e2")
        for who in ("APF", "FUZZY_APF")
    ),
    Reproduction(
        claim="fuzzy-apf:c-n10",
        verdict="contradicts itself",
        because="10 has the fewest iterations in table 4 only; in table 3 they fall to 14, and 10 takes longest (A12)",
    ),
    Reproduction(
        claim="fuzzy-apf:c-shorter",
        measure=_shorter,
        because="iterations where both arrive, no trap among them; of smoothness nothing is printed (A14)",
        free=_FREE,
        holds_for=_shorter_counts,
    ),
    Reproduction(
        claim="fuzzy-apf:c-angle",
        verdict="contradicts itself",
        because="section 3.2 has 0 to pi/3, the discussion 0 to 30 degrees (A10)",
    ),
    Reproduction(
        claim="fuzzy-apf:c-envs",
        verdict="contradicts itself",
        because="figures 14 to 17 and table 5 show two; figures 18 and 19 are not there (A14)",
    ),
    Reproduction(
        claim="fuzzy-apf:c-unreach",
        measure=lambda: _unreachable()[0] > 0,
        because="two points beside the goal; of all that the classical field does not reach",
        free="places of the points",
        holds_for=_unreachable,
    ),
    Reproduction(
        claim="fuzzy-apf:c-trap",
        measure=lambda: _trapped()[0] > 0,
        because="two to six points anywhere: the improved field alone does not arrive",
        free="places and number of the obstacles",
        holds_for=_trapped,
    ),
    Reproduction(
        claim="fuzzy-apf:c-extra-15",
        measure=_factor_at_the_goal,
        because="eq 8 as it stands: a millimetre before the goal less than 1e-25 of k is left",
    ),
)  # fmt: skip

STUDIES: tuple[Study, ...] = (LAYOUT_STUDY, TUNING_STUDY, TRAP_STUDY)
