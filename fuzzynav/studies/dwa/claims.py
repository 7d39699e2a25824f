"""Thesis 3, local planning: our choices for figures 3.15 and 3.16 and table 3.5, and what was measured.

The thesis prints neither the map, nor start and goal, dt, d_max, robot radius, goal tolerance, or any membership
breakpoint. Ours: random maps of 20 x 20 cells; the one shown is the map, among the maps searched, on which both
planners arrive and come nearest to the four printed numbers.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from fuzzynav import batch, documents, simulate
from fuzzynav.control import Observation
from fuzzynav.dwa.controller import Controller
from fuzzynav.dwa.decision import Field, Plan
from fuzzynav.dwa.fast import RULES, drive, shipped
from fuzzynav.dwa.steps import TABLE_3_3
from fuzzynav.dwa.weights import FuzzyWeights
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.robot import THESIS
from fuzzynav.simulate.record import Run
from fuzzynav.studies.dwa import comparison, safety, tuning
from fuzzynav.studies.dwa.comparison import GOAL, MID_RANGE, START, TIME_LIMIT, random_map
from fuzzynav.studies.reproduction import Interval, Reproduction
from fuzzynav.studies.study import Study
from fuzzynav.world import World

__all__ = [
    "AS_THESIS",
    "CASE",
    "REPRODUCTIONS",
    "SCENES",
    "STUDIES",
    "fuzzy_run",
    "gain",
    "plain_run",
    "scene",
    "small_scene",
    "success_rate",
    "two_planners",
    "weight_words",
]

AS_THESIS = replace(TABLE_3_3, distance="end")  # Dist from the end of the arc, as printed; braking on the arc
CASE = "0.05/30136"  # found by the study dwa_scenes
SCENES = tuple(f"{density}/{seed}" for seed in range(30000, 30250) for density in ("0.05", "0.10"))
OURS = "map, start, goal, dt 0.1 s, radius 0.3 m, d_max 2 m, goal tolerance 0.5 m, breakpoints, default weights"


@cache
def scene() -> tuple[World, Field]:
    """The world of figure 3.15, ours, and its distance field."""
    grid = random_map(CASE)
    return World(grid=grid), Field.of(grid)


def small_scene(velocity: tuple[float, float] = (0.8, 0.0)) -> Observation:
    """Two round obstacles before a robot that drives: the scene of figure 3.9, ours."""
    turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    rims = [
        np.column_stack([x + r * np.cos(turn), y + r * np.sin(turn)])
        for x, y, r in ((2.1, 0.45, 0.35), (1.6, -1.0, 0.3))
    ]
    return Observation(
        time=0.0, pose=np.zeros(3), velocity=np.array(velocity), points=np.vstack(rims), goal=np.array([5.0, 1.0])
    )


def _controller(fuzzy: bool, keep: bool) -> Controller:
    """Traditional or fuzzy; where no rule fires the fuzzy one takes the middle of each range."""
    system = FuzzySystem.load(RULES / "thesis_table_3_2.fll")
    weigh = FuzzyWeights(system, MID_RANGE) if fuzzy else None
    return Controller(THESIS, AS_THESIS, weigh=weigh, field=scene()[1], keep=keep)


@cache
def _run(fuzzy: bool) -> tuple[Run, tuple[Plan, ...]]:
    controller = _controller(fuzzy, keep=True)
    run = simulate.run(scene()[0], THESIS, controller, START, GOAL, t_max=TIME_LIMIT, laser=None)
    return run, tuple(controller.plans)


def plain_run() -> tuple[Run, tuple[Plan, ...]]:
    """The run of figure 3.15a with every plan: weights of table 3.3."""
    return _run(False)


def fuzzy_run() -> tuple[Run, tuple[Plan, ...]]:
    """The run of figure 3.15b with every plan: weights of table 3.2."""
    return _run(True)


def two_planners(case: str) -> dict[str, Any]:
    """Both planners on one map, scored as the thesis prints it; one row of the search for the map of figure 3.15."""
    grid = random_map(case)
    world, field = World(grid=grid), Field.of(grid)
    plain = drive(world, START, GOAL, AS_THESIS, field=field, t_max=TIME_LIMIT)
    row: dict[str, Any] = {"density": case.split("/")[0], "plain": plain.status}
    if plain.status != "reached":
        return {
            **row,
            "fuzzy": "not tried",
            "misfit": np.nan,
            "plain_iterations": 0,
            "plain_length": np.nan,
            "fuzzy_iterations": 0,
            "fuzzy_length": np.nan,
        }
    fuzzy = drive(
        world,
        START,
        GOAL,
        replace(AS_THESIS, weights=MID_RANGE),
        field=field,
        t_max=TIME_LIMIT,
        rules=shipped("thesis_table_3_2"),
    )
    found = [plain.iterations, plain.length, fuzzy.iterations, fuzzy.length]
    documents = [_printed(f"c-3.5-{who}-{what}") for who in ("TDWA", "FDWA") for what in ("iter", "len")]
    off = np.abs(np.array(found) / documents - 1.0) @ [1.0, 5.0, 1.0, 5.0]
    return {
        **row,
        "fuzzy": fuzzy.status,
        "misfit": round(float(off), 4),
        "plain_iterations": plain.iterations,
        "plain_length": round(plain.length, 3),
        "fuzzy_iterations": fuzzy.iterations,
        "fuzzy_length": round(fuzzy.length, 3),
    }


def _printed(name: str) -> float:
    return float(documents.claim(f"thesis:{name}").value)


# --- what was printed -------------------------------------------------------------------------------


def gain(what: str) -> float:
    """Reduction [%] from the traditional to the fuzzy run, of length or iterations."""
    before, after = (float(getattr(run()[0], what)) for run in (plain_run, fuzzy_run))
    return 100.0 * (before - after) / before


def success_rate(method: str) -> float:
    """Share of the 500 maps with 5 % blocked cells on which a method arrives [%]."""
    table = comparison.comparison("end")
    rows = table[(table["method"] == method) & (table["density"].astype(float) == 0.05)]
    return 100.0 * float(rows["success"].mean())


def weight_words(run: Run, fast: bool) -> str:
    """The weights in words, thirds of [0, 1]: mean over the first second, or over the steps above half top speed."""
    chosen = run.commands[:, 0] > 0.5 * THESIS.max_vel_x if fast else run.t[:-1] < 1.0
    names = ("low", "moderate", "high")
    means = [float(np.asarray(run.log[w])[chosen].mean()) for w in ("alpha", "beta", "gamma")]
    return "; ".join(f"{w} {names[min(int(3 * m), 2)]}" for w, m in zip(("alpha", "beta", "gamma"), means, strict=True))


def calmer() -> bool:
    """Whether both v and omega vary less in total in the fuzzy run."""
    return bool((fuzzy_run()[0].variation < plain_run()[0].variation).all())


def _less(what: str) -> Interval:
    """How much less the fuzzy planner needs than the plain one: mean and 95 % interval over the maps both pass."""
    table = comparison.comparison("end")
    rows = table[table["density"] == 0.05]
    found = batch.paired(rows, "method", "printed .8 .1 .1", "fuzzy 9, else mid-range", what)
    return -found["mean"], -found["high"], -found["low"]


def _maps_with(what: str, printed: float) -> tuple[int, int]:
    """On how many of the searched maps on which both arrive the reduction is the printed one, to 0.005 %."""
    table = batch.read(comparison.RESULTS / "dwa_scenes.csv")
    both = table[table["fuzzy"] == "reached"]
    found = 100.0 * (1.0 - both[f"fuzzy_{what}"] / both[f"plain_{what}"])
    return int(((found - printed).abs() <= 0.005).sum()), len(both)


def _densities_with(method: str) -> tuple[int, int]:
    """On how many of the three densities of blocked cells a method always arrives."""
    table = comparison.comparison("end")
    rates = table[table["method"] == method].groupby("density")["success"].mean()
    return int((rates == 1.0).sum()), len(rates)


def _both_arrive() -> str:
    rows = batch.read(comparison.RESULTS / "dwa_comparison.csv")
    rows = rows[(rows["scored"] == "end") & (rows["density"] == "0.05")]
    wide = rows.pivot_table(index="case", columns="method", values="success")
    both = wide["printed .8 .1 .1"].astype(bool) & wide["fuzzy 9, else mid-range"].astype(bool)
    return f"both arrive on {int(both.sum())} of {len(wide)} maps"


def _maps_at(column: str, printed: float, within: float) -> tuple[int, int]:
    table = batch.read(comparison.RESULTS / "dwa_scenes.csv")
    both = table[table["fuzzy"] == "reached"]
    return int(((both[column] - printed).abs() <= within).sum()), len(both)


TIMES = (
    "seconds of another machine: 0.2789 s for an iteration of the plain planner and 0.1002 s with a fuzzy "
    "inference on top cannot both be planning time (errata T44)"
)
ONE_SCENE = "looked at on one map"
ONE_MAP = "one map of ours; the printed one is not available"

REPRODUCTIONS: tuple[Reproduction, ...] = (
    Reproduction(claim="thesis:c-3.5-TDWA-time", verdict="not testable", because=TIMES),
    Reproduction(
        claim="thesis:c-3.5-TDWA-len",
        measure=lambda: plain_run()[0].length,
        because=ONE_MAP,
        free=OURS,
        holds_for=lambda: _maps_at("plain_length", 27.364, 0.005),
    ),
    Reproduction(
        claim="thesis:c-3.5-TDWA-iter",
        measure=lambda: plain_run()[0].iterations,
        because=ONE_MAP,
        free=OURS,
        holds_for=lambda: _maps_at("plain_iterations", 765, 0.005),
    ),
    Reproduction(
        claim="thesis:c-3.5-TDWA-succ",
        measure=lambda: success_rate("printed .8 .1 .1"),
        holds_for=lambda: _densities_with("printed .8 .1 .1"),
        free=OURS,
        because="500 random maps with 5 % blocked cells; the number of printed trials is not known",
    ),
    Reproduction(claim="thesis:c-3.5-FDWA-time", verdict="not testable", because=TIMES),
    Reproduction(
        claim="thesis:c-3.5-FDWA-len",
        measure=lambda: fuzzy_run()[0].length,
        because=ONE_MAP,
        free=OURS,
        holds_for=lambda: _maps_at("fuzzy_length", 25.521, 0.005),
    ),
    Reproduction(
        claim="thesis:c-3.5-FDWA-iter",
        measure=lambda: fuzzy_run()[0].iterations,
        because=ONE_MAP,
        free=OURS,
        holds_for=lambda: _maps_at("fuzzy_iterations", 323, 0.005),
    ),
    Reproduction(
        claim="thesis:c-3.5-FDWA-succ",
        measure=lambda: success_rate("fuzzy 9, else mid-range"),
        holds_for=lambda: _densities_with("fuzzy 9, else mid-range"),
        free=OURS,
        because="500 random maps with 5 % blocked cells; the number of printed trials is not known",
    ),
    Reproduction(claim="thesis:c-3.5-pct-1", verdict="not testable", because=TIMES),
    Reproduction(
        claim="thesis:c-3.5-pct-2",
        measure=lambda: gain("length"),
        because=ONE_MAP + "; seeded: metres less on the maps with 5 % blocked cells on which both arrive",
        free=OURS,
        direction=lambda: _less("length"),
        beside=_both_arrive,
        holds_for=lambda: _maps_with("length", 6.74),
    ),
    Reproduction(
        claim="thesis:c-3.5-pct-3",
        measure=lambda: gain("iterations"),
        because=ONE_MAP + "; seeded: iterations less on the maps with 5 % blocked cells on which both arrive",
        free=OURS,
        direction=lambda: _less("iterations"),
        beside=_both_arrive,
        holds_for=lambda: _maps_with("iterations", 57.78),
    ),
    Reproduction(
        claim="thesis:c-3.5-caption",
        verdict="contradicts itself",
        because="the caption announces two environments, the table holds one (errata T26)",
    ),
    Reproduction(
        claim="thesis:c-3.16-smooth",
        measure=calmer,
        because="total variation of v and of omega",
        free=OURS,
        holds_for=ONE_SCENE,
    ),
    Reproduction(
        claim="thesis:c-3.16-weights-start",
        measure=lambda: weight_words(fuzzy_run()[0], False),
        holds_for=ONE_SCENE,
        free=OURS,
        because="no rule of table 3.2 has (Medium, High, Low); a blend might (errata T41)",
    ),
    Reproduction(
        claim="thesis:c-3.16-weights-fast",
        measure=lambda: weight_words(fuzzy_run()[0], True),
        holds_for=ONE_SCENE,
        free=OURS,
        because="no rule of table 3.2 has gamma High with beta Medium (errata T41)",
    ),
)

_CLOSE = {"": (2e-3, 2e-3)}  # rows are rounded to the millimetre
_FIXED, _TUNED = "results/dwa_fixed_search.csv", "fuzzy/ours_dwa_tuned.fll"
_BASES = ("fuzzy/thesis_table_3_2.fll", "fuzzy/thesis_table_3_2_completed.fll")
_DENSITIES = {"densities": list(comparison.DENSITIES)}

STUDIES: tuple[Study, ...] = (
    Study(
        name="dwa_scenes", experiment=two_planners, cases=SCENES, inputs=_BASES[:1], tolerance=_CLOSE,
        parameters={"densities": ["0.05", "0.10"], "seeds": "30000 to 30249"},
    ),
    Study(
        name="dwa_fixed_search", experiment=comparison.score_weights, cases=comparison.fixed_weights(),
        tolerance=_CLOSE, parameters={**_DENSITIES, "seeds": "10000 to 10024", "step": 0.05},
    ),
    Study(
        name="dwa_tuning", experiment=tuning.score_generation, cases=tuning.generations, inputs=(_FIXED,),
        tolerance=_CLOSE, after=tuning.save_best,
        parameters={**_DENSITIES, "generations": tuning.GENERATIONS, "seeds": "10000 to 10024, held 20000 to 20049"},
    ),
    Study(
        name="dwa_comparison", experiment=comparison.compare, cases=comparison.CASES, inputs=(*_BASES, _FIXED),
        tolerance=_CLOSE, parameters={**_DENSITIES, "seeds": "0 to 499"},
    ),
    Study(
        name="dwa_comparison_tuned", experiment=comparison.compare_tuned, cases=comparison.CASES,
        inputs=(_TUNED, _FIXED), tolerance=_CLOSE, parameters={**_DENSITIES, "seeds": "0 to 499"},
    ),
    Study(
        name="dwa_safety", experiment=safety.outcome, cases=range(safety.SEEDS), tolerance=_CLOSE,
        parameters={"seeds": "0 to 9999", "seconds": safety.T_MAX},
    ),
    Study(
        name="dwa_noise", experiment=safety.noisy_outcome, cases=range(safety.NOISY_SEEDS), tolerance=_CLOSE,
        parameters={"seeds": "0 to 59", "seconds": safety.T_MAX},
    ),
)  # fmt: skip
