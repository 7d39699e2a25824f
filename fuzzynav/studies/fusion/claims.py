"""Thesis 4, local planning: table 4.3, section 4.5 and figures 4.6 and 4.10, held against two studies.

Traditional DWA is driven on our maps with every setting that the thesis does not print, the fusion among 500
placements of unknown squares and movers on each printed map. What is shown as one run is the run that comes nearest to
the printed length; how often it comes out at all stands beside it.
"""

from __future__ import annotations

from functools import cache, partial

import numpy as np
import pandas as pd

from fuzzynav import batch, documents
from fuzzynav.data import folder
from fuzzynav.fusion.task import Task
from fuzzynav.simulate.record import Run
from fuzzynav.studies.fusion import placements, settings
from fuzzynav.studies.fusion.placements import MAPS
from fuzzynav.studies.fusion.scenes import SCENE_STUDIES
from fuzzynav.studies.fusion.worlds import PROMISED, WORLD_STUDIES
from fuzzynav.studies.reproduction import Interval, Measured, Reproduction
from fuzzynav.studies.study import Study

__all__ = [
    "CURED", "REPRODUCTIONS", "STUDIES", "arrived", "case_of", "endings", "fusion_run", "less", "nearest", "pairs",
    "placed_rows", "setting_rows", "traditional_run",
]  # fmt: skip

ROUNDING = 0.005 + 1e-9  # [m] of two decimals
CURED = "fusion, no orbit"
FUSIONS = ("fusion", CURED, "fusion, no orbit, equal")


def setting_rows(given: str) -> pd.DataFrame:
    """The settings of traditional DWA on our versions of a printed map, "M1" or "M2"."""
    table = batch.read(folder("results") / "fusion_settings.csv")
    return table[table["map"].isin(MAPS[given])]


def placed_rows(given: str, method: str) -> pd.DataFrame:
    """The placements of one planner on our versions of a printed map."""
    table = batch.read(folder("results") / "fusion_placements.csv")
    return table[table["map"].isin(MAPS[given]) & (table["method"] == method)]


def _printed(given: str, who: str) -> float:
    return float(documents.claim(f"thesis:c-4.3-{given}-{who}-len").value)


def arrived(given: str, who: str) -> pd.DataFrame:
    """The runs that arrive, of the planner that table 4.3 calls TDWA or IDWA."""
    rows = setting_rows(given) if who == "TDWA" else pd.concat([placed_rows(given, name) for name in FUSIONS])
    return rows[rows["success"] == 1]


def case_of(given: str, who: str) -> tuple[str, str]:
    """Case and planner of the run whose length [m] is nearest to the printed one; ties by the order of the file."""
    rows = arrived(given, who)
    best = rows.loc[(rows["length"] - _printed(given, who)).abs().round(6).idxmin()]
    return str(best["case"]), str(best.get("method", "TDWA"))


def nearest(given: str, who: str) -> float:
    """The length [m] nearest to the printed one."""
    rows = arrived(given, who)
    return float(rows["length"].loc[(rows["length"] - _printed(given, who)).abs().round(6).idxmin()])


def traditional_run(given: str) -> Run:
    """The run of figures 4.6 and 4.7: traditional DWA with the setting that comes nearest to the printed length."""
    return settings.traditional(case_of(given, "TDWA")[0])


def fusion_run(given: str) -> tuple[Run, Task]:
    """The run of figures 4.8 to 4.10 and its task: the fusion on the placement that comes nearest."""
    case, method = case_of(given, "IDWA")
    task = placements.task_of(case)
    return placements.drive(task, placements.planner(case, method)), task


def _holds(given: str, who: str) -> tuple[int, int]:
    """For how many of all runs, of settings or of the fusions on placements, the printed length comes out."""
    rows = setting_rows(given) if who == "TDWA" else pd.concat([placed_rows(given, name) for name in FUSIONS])
    good = (rows["success"] == 1) & ((rows["length"] - _printed(given, who)).abs() <= ROUNDING)
    return int(good.sum()), len(rows)


def endings(given: str, method: str) -> str:
    """How the runs of one planner end on one printed map, and the lengths of those that arrive, in words."""
    rows = setting_rows(given) if method == "settings" else placed_rows(given, method)
    good = rows.loc[rows["success"] == 1, "length"]
    text = f"{len(good)} of {len(rows)} arrive"
    if len(good):
        low, middle, high = (float(good.quantile(q)) for q in (0.25, 0.5, 0.75))
        text += f", {middle:.2f} m [{low:.2f}, {high:.2f}] (median, quartiles)"
    return text


def _beside(given: str, who: str) -> str:
    if who == "TDWA":
        return endings(given, "settings")
    return "; ".join(f"{name}: {endings(given, name)}" for name in FUSIONS)


@cache
def pairs(given: tuple[str, ...], method: str) -> pd.DataFrame:
    """The placements on which both this planner and traditional DWA arrive, a row each, columns by planner."""
    found = []
    for name in given:
        rows = [placed_rows(name, planner).set_index("case") for planner in (method, "TDWA")]
        joined = rows[0].merge(rows[1], how="left", left_index=True, right_index=True, suffixes=("_ours", "_theirs"))
        found.append(joined[(joined["success_ours"] == 1) & (joined["success_theirs"] == 1)])
    return pd.concat(found)


def less(given: tuple[str, ...], what: str, method: str = CURED) -> Interval:
    """How much less of a quantity the fusion needs than traditional DWA on the same placements, mean with interval.

    Bootstrap over the placements on which both arrive; nan where they are fewer than two.
    """
    both = pairs(given, method)
    gap = (both[f"{what}_theirs"] - both[f"{what}_ours"]).to_numpy(float)
    if len(gap) < 2:
        return float("nan"), float("nan"), float("nan")
    draws = gap[np.random.default_rng(0).integers(0, len(gap), (2000, len(gap)))].mean(axis=1)
    low, high = np.quantile(draws, [0.025, 0.975])
    return float(gap.mean()), float(low), float(high)


def _gain(given: str) -> float:
    """Reduction [%] of the length from the nearest run of one planner to that of the other."""
    before, after = nearest(given, "TDWA"), nearest(given, "IDWA")
    return 100.0 * (before - after) / before


def _gains(given: str) -> tuple[int, int]:
    """On how many of the placements that both pass the reduction is the printed one, to its rounding."""
    printed = float(documents.claim(f"thesis:c-4.3-pct-{given[1]}").value)
    both = pairs((given,), CURED)
    found = 100.0 * (1.0 - both["length_ours"] / both["length_theirs"])
    return int(((found - printed).abs() <= 0.005).sum()), len(both)


_BOTH = ("M1", "M2")
_QUANTITIES = ("variation_v", "variation_omega")


def _calmer() -> bool:
    """Whether total variations of v and of omega are both lower on the placements that both planners pass."""
    return all(less(_BOTH, what)[1] > 0.0 for what in _QUANTITIES)


def _calm_words() -> str:
    """Both total variations of the pairs, in words."""
    both = pairs(_BOTH, CURED)
    parts = []
    for what, name, unit in zip(_QUANTITIES, ("v", "omega"), ("m/s", "rad/s"), strict=True):
        mean, low, high = less(_BOTH, what)
        middle = [float(both[f"{what}_{who}"].median()) for who in ("ours", "theirs")]
        parts.append(
            f"{name}: {middle[0]:.2f} against {middle[1]:.2f} {unit}, less by {mean:.2f} [{low:.2f}, {high:.2f}]"
        )
    return f"{len(both)} placements; " + "; ".join(parts)


def _calm_pairs() -> tuple[int, int]:
    """On how many of those placements both are lower."""
    both = pairs(_BOTH, CURED)
    lower = [both[f"{what}_ours"] < both[f"{what}_theirs"] for what in _QUANTITIES]
    return int((lower[0] & lower[1]).sum()), len(both)


def _grade(given: str, who: str, what: str) -> Measured:
    """High or Low: of the two planners of table 4.3 on the same placements, the better one is High, the other Low.

    Smooth is the lower total variation of the turn, safe the larger least clearance, both in the mean of the pairs.
    """
    both = pairs((given,), CURED)
    column, sense = ("variation_omega", 1.0) if what == "smooth" else ("clearance", -1.0)
    ahead = sense * float((both[f"{column}_theirs"] - both[f"{column}_ours"]).mean()) > 0.0
    return "High" if ahead == (who == "IDWA") else "Low"


_SETTINGS = "raster; robot radius, d_max, heading at the start, dist along the arc or at its end, dt 0.1 s"
_PLACED = (
    "raster; where the unknown squares and movers stand, their size and speed; delta, the radius of a sub-goal, d_max"
)
_FREE = {"TDWA": _SETTINGS, "IDWA": f"{_PLACED}; the printed fusion, without its orbit, and with equal weights"}
_SOUGHT = "the nearest of all that was tried; rounding of two decimals"
_TIMES = (
    "seconds of another machine: read as driving time, 172.7 and 277.1 s need 0.15 and 0.10 m/s in the mean from a "
    "robot of 1 m/s; read as computing time they compare two programs (errata T44)"
)
_UNLIKE = "the printed runs are not alike: only the fusion has a global path, and unknown and moving obstacles (T25); "
_SEEDED = "seeded: metres less on the placements that both pass"

_CLAIMED = tuple((given, who) for given in MAPS for who in ("TDWA", "IDWA"))


def _length(claim: str, given: str, who: str) -> Reproduction:
    return Reproduction(
        claim=claim,
        measure=partial(nearest, given, who),
        shows="fitted",
        because=_SOUGHT,
        free=_FREE[who],
        beside=partial(_beside, given, who),
        holds_for=partial(_holds, given, who),
    )


REPRODUCTIONS: tuple[Reproduction, ...] = (
    *(_length(f"thesis:c-4.3-{given}-{who}-len", given, who) for given, who in _CLAIMED),
    *(_length(f"thesis:c-4.5text-{given[1]}-{who[0]}-len", given, who) for given, who in _CLAIMED),
    *(
        Reproduction(claim=name, verdict="not testable", because=_TIMES)
        for given, who in _CLAIMED
        for name in (f"thesis:c-4.3-{given}-{who}-time", f"thesis:c-4.5text-{given[1]}-{who[0]}-time")
    ),
    *(
        Reproduction(
            claim=f"thesis:c-4.3-{given}-{who}-{what}",
            measure=partial(_grade, given, who, what),
            free="the measure, which the thesis does not define: smooth is the lower total variation of the turn, safe "
            "the larger least clearance, of two planners on the same placements; " + _PLACED,
            because="of two grades one planner gets each, so that they stand or fall together",
            holds_for="a comparison over all placements that both pass",
        )
        for given, who in _CLAIMED
        for what in ("smooth", "safe")
    ),
    *(
        Reproduction(
            claim=f"thesis:c-4.3-pct-{given[1]}",
            measure=partial(_gain, given),
            shows="fitted",
            free=f"{_SETTINGS}; {_PLACED}",
            because=_UNLIKE + more + _SEEDED,
            direction=partial(less, (given,), "length"),
            holds_for=partial(_gains, given),
        )
        for given, more in (
            ("M1", ""),
            ("M2", "the printed cells give 4.56 %, and 4.57 only within their rounding; "),
        )
    ),
    *(
        Reproduction(claim=f"thesis:c-4.3-pct-{number}", verdict="not testable", because="a ratio of " + _TIMES)
        for number in (3, 4)
    ),
    Reproduction(
        claim="thesis:c-4.6-alpha",
        verdict="contradicts itself",
        because="table 4.1 prints alpha 0.05, the smallest of 0.05, 0.2 and 0.3 (errata T42)",
    ),
    Reproduction(
        claim="thesis:c-4.6-beta",
        verdict="contradicts itself",
        because="table 4.1 prints one set of weights for both maps (errata T42)",
    ),
    Reproduction(
        claim="thesis:c-4.10-smooth",
        measure=_calmer,
        because="total variation of v and of omega, both, in the mean of the placements that both planners pass",
        free=_PLACED,
        beside=_calm_words,
        holds_for=_calm_pairs,
    ),
    *PROMISED,
)

_CLOSE = {"": (2e-3, 2e-3)}  # rows are rounded to the millimetre
_RASTERS = tuple(f"maps/thesis_ch4_{name}.map" for name in ("map1_touching", "map1_manhattan", "map2", "map2_cut"))

STUDIES: tuple[Study, ...] = (
    Study(
        name="fusion_settings", experiment=settings.one_setting, cases=settings.CASES, inputs=_RASTERS,
        tolerance=_CLOSE, parameters={"seconds": settings.TIME_LIMIT},
    ),
    Study(
        name="fusion_placements", experiment=placements.one_placement, cases=placements.CASES, inputs=_RASTERS,
        tolerance=_CLOSE, parameters={"seeds": f"0 to {placements.PLACEMENTS - 1}", "seconds": placements.TIME_LIMIT},
    ),
    *SCENE_STUDIES,
    *WORLD_STUDIES,
)  # fmt: skip
