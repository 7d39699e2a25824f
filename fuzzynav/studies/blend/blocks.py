"""One block anywhere on the figure eight, a thousand times: the printed blend and the safe one on the same draws.

Case n is the block of seed n. Seeds from 100 000 on served to try the safe scheme, seeds 0 to 999 only to report.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from scipy import ndimage
from scipy.spatial import KDTree

from fuzzynav import batch, blend, simulate
from fuzzynav.blend.points import nearest_on
from fuzzynav.control import Observation
from fuzzynav.data import folder
from fuzzynav.geometry import Array
from fuzzynav.robot import TURTLEBOT2
from fuzzynav.simulate.record import Run
from fuzzynav.tracking.records import POSE
from fuzzynav.tracking.reference import FigureEight
from fuzzynav.world import Mover, World

__all__ = [
    "BLOCK_CASES",
    "LATE",
    "MOVER_CASES",
    "RESULTS",
    "SCHEMES",
    "block_of",
    "corridor_exists",
    "cross_track",
    "edge_distance",
    "mover_of",
    "one_block",
    "one_mover",
    "summary",
]

RESULTS = folder("results")
LATE = 10.0  # [s] after the last avoidance the robot must be back
BLOCK_CASES, MOVER_CASES = range(1000), range(200)
SCHEMES: dict[str, blend.PrintedScheme | blend.SafeScheme] = {
    "printed, gate ±45°": blend.PrintedScheme(),
    "printed, v_a = v_t": blend.PrintedScheme(keep_speed=1.0),
    "printed, gate ±22.5°": blend.PrintedScheme(gate=np.pi / 8.0),
    "gate widened to ±90°": blend.PrintedScheme(gate=np.pi / 2.0),
    "hard switch": blend.PrintedScheme(hard=True),
    "safe blend": blend.SafeScheme(),
}


@cache
def _lap() -> tuple[Array, Array, Array]:
    """Times, points and arc lengths along one lap of the curve."""
    t = np.linspace(0.0, blend.LAP, 20001)
    points = FigureEight(duration=blend.LAP).sample(t).position
    return t, points, np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def _near_curve(rng: np.random.Generator) -> tuple[Array, float]:
    """A point within 0.2 m of the curve, evenly along it, and the heading of the curve there."""
    t, _, arc = _lap()
    at = FigureEight(duration=blend.LAP).sample(np.interp(rng.uniform(0.0, arc[-1]), arc, t))
    theta, aside = float(at.theta), rng.uniform(-0.2, 0.2)
    return at.position + aside * np.array([-np.sin(theta), np.cos(theta)]), theta


def edge_distance(block: Array, points: Array) -> Array:
    """Distance `(n,)` [m] from points `(n, 2)` to the edge of a block, negative inside."""
    spare = np.empty(4)
    return np.array([nearest_on(block, p[0], p[1], spare) for p in points])


def block_of(seed: int) -> Array:
    """Block x, y, 0.2, 0.3, theta: centre within 0.2 m of the curve, edge 0.5 m or more from the start."""
    rng = np.random.default_rng(seed)
    while True:
        center, _ = _near_curve(rng)
        block = np.array([*center, 0.2, 0.3, rng.uniform(0.0, np.pi)])
        if edge_distance(block, np.zeros((1, 2)))[0] >= 0.5:
            return block


def corridor_exists(block: Array, margin: float = 0.1, step: float = 0.05) -> bool:
    """Whether the robot with `margin` [m] to spare can pass the block: the free part of the curve hangs together.

    Cells of a 6.4 m square whose centres are further than radius + margin from the block are free.
    """
    axis = np.arange(-3.2, 3.2 + step / 2.0, step)
    cells = np.stack(np.meshgrid(axis, axis), axis=-1)
    need = TURTLEBOT2.radius + margin
    free = edge_distance(block, cells.reshape(-1, 2)).reshape(cells.shape[:2]) >= need
    label, _ = ndimage.label(free)
    curve = _lap()[1][::50]
    inside = np.rint((curve[edge_distance(block, curve) >= need + step] + 3.2) / step).astype(int)
    return bool(len(inside)) and len({int(label[j, i]) for i, j in inside}) == 1


def cross_track(poses: Array) -> Array:
    """Distance `(n,)` [m] from poses to the nearest point of the curve, at any time."""
    return np.asarray(KDTree(_lap()[1]).query(poses[:, :2])[0])


def _outcome(run: Run) -> dict[str, Any]:
    """What one two-lap run came to."""
    late = run.t[:-1] >= blend.last_avoidance(run) + LATE - 1e-9
    distance = run.distance[:-1]
    done = run.status == "done" and late.any()
    rms = np.sqrt((distance[late] ** 2).mean()) if done else np.nan
    aside = np.sqrt((cross_track(run.poses[:-1][late]) ** 2).mean()) if done else np.nan
    return {
        "status": run.status,
        "clearance": _short(run.min_clearance),
        "late_rms": _short(rms),
        "late_cross_track": _short(aside),
        "max_error": _short(distance.max()),
        "max_cross_track": _short(cross_track(run.poses).max()),
        "length": _short(run.length),
        "delay": round(blend.delay(run), 1),
        "avoiding": round(float(run.log["avoiding"].sum() * 0.1), 1),
        "success": int(done and rms <= 0.05),
    }


def one_block(seed: int) -> list[dict[str, Any]]:
    """Rows of all schemes past the block of one seed: a lap with it and a lap without."""
    block = block_of(int(seed))
    corridor = int(corridor_exists(block))
    return [
        {"scheme": name, "corridor": corridor, **_outcome(blend.drive(scheme, block, laps=2.0))}
        for name, scheme in SCHEMES.items()
    ]


# --- moving obstacles --------------------------------------------------------------------------


def mover_of(seed: int) -> Mover:
    """Disc that patrols across the curve: radius 0.1 to 0.25 m, speed 0.05 to 0.25 m/s, 1 to 2 m long."""
    rng = np.random.default_rng(seed)
    while True:
        middle, theta = _near_curve(rng)
        way, half = theta + rng.uniform(0.25, 0.75) * np.pi, rng.uniform(0.5, 1.0)
        ends = middle + np.array([[-half], [half]]) * [np.cos(way), np.sin(way)]
        radius, speed = rng.uniform(0.1, 0.25), rng.uniform(0.05, 0.25)
        along = np.clip(-(ends[0] @ (ends[1] - ends[0])) / (2.0 * half) ** 2, 0.0, 1.0)
        if np.hypot(*(ends[0] + along * (ends[1] - ends[0]))) >= radius + 0.5:
            return Mover.patrol(ends, speed, radius)


class _Lap:
    """A controller that goes on where it stopped, until the reference has run to `until` [steps]."""

    def __init__(self, inner: blend.SafeBlend | blend.PrintedBlend, until: int) -> None:
        self.inner, self.until = inner, until
        self.status: str | None = None
        self.evidence: dict[str, float] = {}

    def reset(self) -> None:
        """Go on."""

    def __call__(self, observation: Observation) -> Array:
        """The command of the controller inside."""
        law = self.inner
        command = law(observation)
        if isinstance(law, blend.SafeBlend):
            now, k, weight = round(law.evidence["reference_time"] / 0.1), int(law.mind.index), float(law.mind.weight)
        else:
            now = round(observation.time / 0.1)
            k, weight = now + 1, law.evidence["F"]
        row = law.tracker.rows[min(now, law.tracker.steps)]
        gap = float(np.hypot(*([row.x, row.y] - observation.pose[:2])))
        self.evidence = {"gap": gap, "weight": weight}
        self.status = "reached" if k >= self.until else None
        return command


def one_mover(seed: int) -> list[dict[str, Any]]:
    """Rows of the printed and the safe blend past one patrolling disc that the sensor sees with its velocity."""
    world = World(movers=(mover_of(int(seed)),))
    rows = []
    for name in ("printed, gate ±45°", "safe blend"):
        eight, scheme = FigureEight(duration=2.0 * blend.LAP), blend.SafeScheme(moving=True)
        law = blend.SafeBlend(eight, scheme) if name == "safe blend" else blend.PrintedBlend(eight)
        rows.append({"scheme": name, **_two_laps(world, law)})
    return rows


def _two_laps(world: World, law: blend.SafeBlend | blend.PrintedBlend) -> dict[str, Any]:
    """One lap with the mover and, if nothing was touched, the lap behind it without."""
    lap, loop = round(blend.LAP / 0.1), simulate.Loop(stall_time=np.inf)
    laser = replace(simulate.IDEAL_LASER, beams=180, range_max=2.0)
    start = [law.tracker.rows[name][0] for name in POSE]
    law.reset()
    first = simulate.run(
        world, TURTLEBOT2, _Lap(law, lap), start, t_max=400.0, laser=laser, track_movers=True, loop=loop
    )
    row = {
        "status": first.status,
        "standing": first.contacts_standing,
        "clearance": _short(first.min_clearance),
        "seconds": round(first.duration, 1),
        "late_rms": np.nan,
        "success": 0,
    }
    if first.status != "reached" or first.contacts_standing:
        return row
    until = 2 * lap - 1 if isinstance(law, blend.SafeBlend) else lap  # the printed one reads the clock, from 0 anew
    second = simulate.run(
        World(), TURTLEBOT2, _Lap(law, until), first.poses[-1], t_max=200.0, laser=laser, track_movers=True, loop=loop
    )
    gap = np.concatenate([first.log["gap"], second.log["gap"]])
    weight = np.concatenate([first.log["weight"], second.log["weight"]])
    active = np.flatnonzero(weight > 0.0)
    late = gap[(int(active[-1]) + 1 if len(active) else 0) + round(LATE / 0.1) :]
    rms = float(np.sqrt((late**2).mean())) if second.status == "reached" else np.nan
    return {**row, "late_rms": _short(rms), "success": int(rms <= 0.05)}


# --- the studies -------------------------------------------------------------------------------


def summary(name: str = "blocks") -> Any:
    """One row a scheme: runs, contacts, runs back on the reference, least clearance, median and largest errors."""
    table = batch.read(RESULTS / f"avoidance_{name}.csv")
    if "corridor" in table:
        table = table[table["corridor"] == 1]
    groups = table.groupby("scheme", sort=False)
    whole = groups.agg(
        runs=("status", "size"),
        collided=("status", lambda s: int((s == "collided").sum())),
        back=("success", "sum"),
        least=("clearance", "min"),
        late_median=("late_rms", "median"),
        late_max=("late_rms", "max"),
    )
    return whole.round(4)


def _short(value: float) -> float:
    return float(f"{float(value):.4g}")
