"""One experiment for all tracking laws: same reference, starts, limits, disturbances and tuning effort.

The thesis names these laws and runs one of them; gains, cases and disturbances are ours.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import differential_evolution

from fuzzynav import batch, tracking
from fuzzynav.data import folder
from fuzzynav.geometry import Array, compose
from fuzzynav.robot import TURTLEBOT2
from fuzzynav.tracking.records import POSE, SPEEDS
from fuzzynav.tracking.reference import FigureEight, Reference

__all__ = [
    "better_share",
    "CONDITIONS",
    "CONTESTANTS",
    "EIGHT",
    "NOISES",
    "OBSERVERS",
    "OBSERVER_CASES",
    "RESULTS",
    "RIVAL_CASES",
    "Contestant",
    "bounds_table",
    "build",
    "compare",
    "observe",
    "score",
    "score_again",
    "start_pose",
    "trainee",
    "tune",
    "tuned",
    "wall_time",
]

RESULTS = folder("results")
EIGHT = FigureEight()
PRACTICE = FigureEight(duration=40.0)
HALF = 63.0  # [s] driven in the comparison: the second half of the lap is the mirror image of the first
SETTLED = 20.0  # [s] from here on the start error is forgotten
SEEDS = 200
CONDITIONS: dict[str, tracking.Disturbance] = {
    "ideal": tracking.UNDISTURBED,
    "noise": tracking.Disturbance(position_noise=0.01, heading_noise=0.02),
    "slip": tracking.Disturbance(slip=0.1),
    "delay": tracking.Disturbance(delay=0.2),
    "wheel radius": tracking.Disturbance(right_radius=0.02, left_radius=-0.02),
    "motor lag": tracking.Disturbance(motor_lag=0.3),
    "all": tracking.Disturbance(
        position_noise=0.01,
        heading_noise=0.02,
        slip=0.1,
        delay=0.2,
        right_radius=0.02,
        left_radius=-0.02,
        motor_lag=0.3,
    ),
}
LESSONS = (("ideal", 10_001), ("noise", 10_002), ("all", 10_003), ("all", 10_004))  # condition and seed
POPULATION, GENERATIONS = 24, 15  # the optimiser's budget: 360 trials for each law


@dataclass(frozen=True, slots=True)
class Contestant:
    """A law in the experiment: how it is made from its tunable values, and their ranges (searched on a log scale)."""

    make: Callable[[dict[str, float]], tracking.Law]
    ranges: dict[str, tuple[float, float]]


def _flat(law: type[tracking.Dfl | tracking.Flatness]) -> Contestant:
    def make(x: dict[str, float]) -> tracking.Law:
        return law(kp1=x["kp"], kp2=x["kp"], kd1=x["kd"], kd2=x["kd"])

    return Contestant(make, {"kp": (0.1, 20.0), "kd": (0.2, 10.0)})


def _pid(feed_forward: bool) -> Contestant:
    ranges = {
        "kp_v": (0.1, 10.0),
        "ki_v": (0.001, 5.0),
        "kd_v": (0.001, 1.0),
        "kp_omega": (0.1, 10.0),
        "ki_omega": (0.001, 5.0),
        "kd_omega": (0.001, 1.0),
        "k_y": (0.1, 20.0),
    }
    return Contestant(lambda x: tracking.Pid(feed_forward=feed_forward, **x), ranges)


_WEIGHTS = {"ahead": (0.1, 100.0), "left": (0.1, 100.0), "heading": (0.01, 10.0), "omega": (0.01, 10.0)}
CONTESTANTS: dict[str, Contestant] = {
    "DFL": _flat(tracking.Dfl),
    "linear flatness": _flat(tracking.Flatness),
    "Kanayama": Contestant(
        lambda x: tracking.Kanayama(**x),
        {"k1": (0.1, 10.0), "k2": (0.5, 200.0), "k3": (0.1, 10.0)},
    ),
    "PID": _pid(False),
    "PID + feed-forward": _pid(True),
    "LQR": Contestant(lambda x: tracking.Lqr(weights=tracking.Weights(**x)), _WEIGHTS),
    "sliding mode": Contestant(
        lambda x: tracking.Sliding(**x),
        {"k1": (0.01, 3.0), "phi1": (0.01, 1.0), "k2": (0.05, 5.0), "phi2": (0.03, 2.0), "c": (0.2, 20.0)},
    ),
    "MPC": Contestant(lambda x: tracking.Mpc(weights=tracking.Weights(**x)), _WEIGHTS),
}


def build(method: str, reference: Reference, values: dict[str, float]) -> tracking.Tracker:
    """The tracker of a contestant with these values."""
    return tracking.Tracker(reference, CONTESTANTS[method].make(values))


def start_pose(reference: Reference, seed: int) -> Array:
    """The start of run `seed`: up to 0.2 m and 0.5 rad off the reference, uniformly."""
    rng = np.random.default_rng([seed, 1])
    return compose(reference.sample(0.0).pose, rng.uniform(-1.0, 1.0, 3) * [0.2, 0.2, 0.5])


def score(tracker: tracking.Tracker) -> float:
    """Mean over the training cases of position RMS [m] + 0.1 heading RMS [rad] + 0.002 effort [rad/s^2]."""
    total = 0.0
    for condition, seed in LESSONS:
        start = start_pose(tracker.reference, seed)
        trace = tracking.follow(tracker, start, disturbance=CONDITIONS[condition], rng=seed)
        if trace.status != "done":
            return 10.0
        total += trace.rms_distance + 0.1 * float(trace.rms[2]) + 0.002 * trace.effort(TURTLEBOT2)
    return min(total / len(LESSONS), 10.0)


def trainee(method: str, logs: Array) -> float:
    """Score of a contestant at these natural logarithms of its values; 10 where it cannot be built."""
    values = dict(zip(CONTESTANTS[method].ranges, np.exp(logs).tolist(), strict=True))
    try:
        tracker = build(method, PRACTICE, values)
    except ValueError:  # gains that dt = 0.1 s cannot carry
        return 10.0
    return score(tracker)


def tune(method: str) -> list[dict[str, Any]]:
    """Best values of a contestant by differential evolution, 360 trials from one seeded population."""
    ranges = np.log(np.array(list(CONTESTANTS[method].ranges.values())))
    first = np.random.default_rng(7).uniform(ranges[:, 0], ranges[:, 1], (POPULATION, len(ranges)))
    found = differential_evolution(
        lambda x: trainee(method, x),
        ranges,
        init=first,
        maxiter=GENERATIONS - 1,
        tol=0.0,
        atol=0.0,
        polish=False,
        rng=np.random.default_rng(8),
    )
    values = dict(zip(CONTESTANTS[method].ranges, (float(f"{v:.4g}") for v in np.exp(found.x)), strict=True))
    worth = score(build(method, PRACTICE, values))
    return [
        {"parameter": name, "value": value, "score": round(worth, 6), "trials": int(found.nfev)}
        for name, value in values.items()
    ]


@cache
def tuned(method: str) -> dict[str, float]:
    """Tuned values of a contestant. Raises FileNotFoundError where the tuning has not been run."""
    table = batch.read(RESULTS / "tracking_gains.csv")
    mine = table[table["case"] == method]
    return dict(zip(mine["parameter"], mine["value"].astype(float), strict=True))


def score_again(method: str, which: int) -> dict[str, Any]:
    """One row of the tuning without the search: the values it found, scored anew."""
    parameter, value = list(tuned(method).items())[which]
    worth = round(score(build(method, PRACTICE, tuned(method))), 6)
    return {"parameter": parameter, "value": value, "score": worth, "trials": POPULATION * GENERATIONS}


@cache
def _ready(method: str) -> tracking.Tracker:
    return build(method, EIGHT, tuned(method))


def compare(case: str) -> list[dict[str, Any]]:
    """One row for each condition: the tuned law `method/seed` over half a lap of the figure eight."""
    method, number = case.split("/")
    seed, rows = int(number), []
    for condition, disturbance in CONDITIONS.items():
        start = start_pose(EIGHT, seed)
        trace = tracking.follow(_ready(method), start, disturbance=disturbance, rng=seed, duration=HALF)
        late = trace.after(SETTLED)
        rows.append(
            {
                "method": method,
                "condition": condition,
                "rms": _short(trace.rms_distance),
                "late_rms": _short(late.rms_distance),
                "late_max": _short(late.max_distance),
                "heading": _short(late.rms[2]),
                "effort": _short(trace.effort(TURTLEBOT2)),
            }
        )
    return rows


def better_share(table: pd.DataFrame, method: str, other: str, measure: str = "late_rms") -> pd.Series:
    """For each condition the share of seeds in which one method has the smaller measure than another."""
    seeds = table.assign(seed=table["case"].str.split("/").str[1])
    wide = seeds.pivot(index=["condition", "seed"], columns="method", values=measure)
    smaller = (wide[method] < wide[other]).groupby(level="condition").mean()
    return smaller.reindex(dict.fromkeys(table["condition"]))


def bounds_table(table: pd.DataFrame, quantity: str = "late_max", level: float = 0.95) -> pd.DataFrame:
    """Quantile of a quantity for each method (rows) and condition (columns)."""
    wide = table.pivot_table(
        index="method", columns="condition", values=quantity, sort=False, aggfunc=lambda v: float(np.quantile(v, level))
    )
    wide.columns.name = wide.index.name = None
    return wide


def wall_time(method: str) -> dict[str, Any]:
    """Microseconds of one call of the controller, and simulated seconds per second of its closed loop.

    The least of five medians and the quickest of five runs: what else the machine does is left out.
    """
    tracker, clock = _ready(method), time.perf_counter
    poses, speeds = (np.stack([tracker.rows[name] for name in names], axis=-1) for names in (POSE, SPEEDS))
    medians, spans = [], []
    for _ in range(5):
        times = []
        for k in range(300):
            now = tracking.seen(0.1 * k, poses[k] + 0.01, speeds[k])
            begin = clock()
            tracker(now)
            times.append(clock() - begin)
        begin = clock()
        tracking.follow(tracker)
        spans.append(clock() - begin)
        medians.append(float(np.median(times)))
    return {"microseconds": round(1e6 * min(medians), 1), "rate": round(EIGHT.duration / min(spans))}


RIVAL_CASES = tuple(f"{method}/{seed}" for method in CONTESTANTS for seed in range(SEEDS))
NOISES = (0.002, 0.005, 0.01, 0.02, 0.05)  # [m]
OBSERVERS: dict[str, Callable[[float], tracking.Observer | None]] = {
    "kinematics (2.14)": lambda noise: None,
    "differences": lambda noise: tracking.Differences(),
    "Luenberger": lambda noise: tracking.Luenberger(),
    "Kalman": lambda noise: tracking.Kalman(position_noise=noise),
}
OBSERVER_CASES = tuple(f"{name}/{noise}/{seed}" for name in OBSERVERS for noise in NOISES for seed in range(20))


def observe(case: str) -> list[dict[str, Any]]:
    """Rows of `observer/noise/seed`: DFL with the thesis' gains on half a lap, position noise [m], heading 0.01 rad."""
    name, level, seed = case.split("/")
    noise = float(level)
    tracker = tracking.Tracker(FigureEight(duration=63.0), tracking.Dfl(), observer=OBSERVERS[name](noise))
    disturbance = tracking.Disturbance(position_noise=noise, heading_noise=0.01)
    trace = tracking.follow(tracker, disturbance=disturbance, rng=int(seed))
    return [
        {
            "observer": name,
            "noise": noise,
            "rms": _short(trace.rms_distance),
            "effort": _short(trace.effort(TURTLEBOT2)),
        }
    ]


def _short(value: float) -> float:
    return float(f"{float(value):.5g}")
