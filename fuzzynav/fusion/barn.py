"""BARN and DynaBARN, the public yardstick of local planners: its worlds as tasks, its score, its published runs.

A folder is either a checkout of the repository `Daffan/the-barn-challenge` or holds the three small files that were
read out of one: `barn300.npz` (static worlds), `dynabarn60.json` (dynamic ones) and
`barn_move_base_dwa_500_runs.csv` (the published runs of move_base's DWA). A checkout has its moving obstacles only
inside compiled plugins, which are not read.

What is theirs: worlds, start, goal, tolerance, time limit, scanner, score. What is ours: the robot is the disc around
the whole Jackal (0.333 m, in dynamic worlds 0.30 m) without slip or lag; any touch ends the run, looked for at 50 Hz
where it matters; the clock runs from the first command; it may reverse at 0.5 m/s; movers walk straight between
their key frames; phase k of a dynamic world lets k times 3 s pass before the run begins.
"""

from __future__ import annotations

import json
import re
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from fuzzynav.fusion.task import Task
from fuzzynav.geometry import Array
from fuzzynav.robot import Robot
from fuzzynav.sensors import Laser
from fuzzynav.simulate.loop import Loop
from fuzzynav.simulate.record import DAMAGED
from fuzzynav.world import Mover, World

__all__ = [
    "PHASES",
    "dynamic_task",
    "jackal",
    "lacking",
    "outcome",
    "published_runs",
    "score",
    "static_task",
    "test_numbers",
    "tuning_numbers",
]

STATIC, DYNAMIC, RUNS = "barn300.npz", "dynabarn60.json", "barn_move_base_dwa_500_runs.csv"
SDF, PATHS, PLUGINS = (
    "jackal_helper/worlds/BARN",
    "jackal_helper/worlds/BARN/path_files",
    "jackal_helper/worlds/DynaBARN",
)
RAW = "res/dwa_out.txt"
WORLDS = {"barn": 300, "dynabarn": 60}
HELD_OUT = {"barn": 6, "dynabarn": 2}  # the report is on the numbers that this divides
PHASES = 10
PHASE_STEP = 3.0  # [s]
START, GOAL = (-2.25, 3.0, np.pi / 2.0), (-2.25, 13.0)
CELL, SHIFT = 0.15, (-4.575, 5.075)  # [m] of the provided paths' lattice, and where its cell (0, 0) lies
UTM = Laser(beams=720, field_of_view=np.radians(270.0), range_min=0.0, range_max=30.0, noise=0.001)
PROTOCOL_LOOP = Loop(goal_tolerance=1.0, stall_time=np.inf, end_when_struck=True)  # their only other ending is the time
T_MAX = 100.0  # [s]
TOP = 2.0  # [m/s] at which the score's best time is driven
MODEL = re.compile(r"<model\b.*?</model>", re.S)
POSE = re.compile(r"<pose[^>]*>\s*(\S+)\s+(\S+)")
RADIUS = re.compile(r"<cylinder>.*?<radius>\s*([^<\s]+)", re.S)


def jackal(top_speed: float, radius: float) -> Robot:
    """Clearpath's Jackal as the disc of `radius` [m] that contains it, limited to `top_speed` [m/s]."""
    return Robot(
        name="Jackal",
        wheel_radius=0.098,
        track=0.376,
        radius=radius,
        max_vel_x=top_speed,
        min_vel_x=-min(0.5, top_speed),
        max_vel_theta=1.57,
        acc_lim_x=10.0,
        dec_lim_x=10.0,
        acc_lim_theta=20.0,
        mass=17.0,
        inertia=0.63,
        source="accelerations and turning: the benchmark's DWA parameters; wheels and mass: Clearpath's data sheet; "
        "reversing, and inertia of a uniform box: ours",
    )


# --- tasks --------------------------------------------------------------------------------------


def static_task(folder: str | Path, number: int, *, top_speed: float = TOP) -> Task:
    """Static world `number` (0 to 299) as a task without a map: 10 m straight ahead, through standing discs.

    The optimum is the length of start, provided path and goal, which the score is counted by. Raises FileNotFoundError
    where the folder holds no such world, ValueError for a number that there is none of or a file that is damaged.
    """
    _known(number, "barn")
    home = Path(folder)
    if (home / STATIC).is_file():
        worlds, lengths = _packed(home / STATIC)
        discs, optimum = worlds[number], float(lengths[number])
    else:
        reason = lacking(home, "barn")
        if reason:
            raise FileNotFoundError(reason)
        discs = sdf_discs((home / SDF / f"world_{number}.world").read_text(encoding="utf-8"), f"world {number}")
        optimum = _path_length(home / PATHS / f"path_{number}.npy")
    return Task(
        name=f"barn {number}",
        world=World(discs=discs),
        robot=jackal(top_speed, 0.333),
        start=np.array(START),
        goal=np.array(GOAL),
        speed_bound=0.0,
        optimum=optimum,
        laser=UTM,
        t_max=T_MAX,
        loop=PROTOCOL_LOOP,
    )


def dynamic_task(
    folder: str | Path, number: int, phase: int = 0, *, top_speed: float = TOP, ideal: bool = False
) -> Task:
    """Dynamic world `number` (0-19 easy, 20-39 medium, 40-59 hard) as a task without a map, `phase` times 3 s late.

    Where a mover would touch the robot at its start, the phase begins as many tenths of a second later as it takes;
    the name says when. The planner is told the speed of the fastest mover; at the end of its loop a mover jumps back
    to its start, which no bound covers. The optimum is the straight line. `ideal`: the planner is told where the
    movers are. Raises FileNotFoundError where the folder does not hold the worlds, ValueError as `static_task`.
    """
    _known(number, "dynabarn")
    if not 0 <= phase < PHASES:
        raise ValueError(f"a phase is a number from 0 to {PHASES - 1}, got {phase}")
    reason = lacking(folder, "dynabarn")
    if reason:
        raise FileNotFoundError(reason)
    found = _dynamic(Path(folder) / DYNAMIC)
    frames = [np.array(keys, dtype=float) for _, keys in found["worlds"][number]]
    start, goal = np.array([*found["start"][:2], np.pi]), np.array(found["goal"], dtype=float)
    robot = jackal(top_speed, 0.30)
    begin, world = PHASE_STEP * phase, None
    while world is None or not world.clearance(start[:2]) > robot.radius:
        movers = tuple(Mover.timed(rows, float(found["mover_radius"]), phase=begin) for rows in frames)
        world = World(rectangles=np.array([[*wall, 0.0] for wall in found["walls"]]), movers=movers)
        begin = round(begin + 0.1, 1)
    return Task(
        name=f"dynabarn {number} phase {phase} from {begin - 0.1:.1f} s",
        world=world,
        robot=robot,
        start=start,
        goal=goal,
        speed_bound=max(_fastest(rows) for rows in frames),
        optimum=float(np.hypot(*(goal - start[:2]))),
        laser=UTM,
        ideal=ideal,
        t_max=T_MAX,
        loop=PROTOCOL_LOOP,
    )


def tuning_numbers(kind: str) -> tuple[int, ...]:
    """Worlds that a method may be tuned on: "barn", those that 6 does not divide; "dynabarn", the odd ones."""
    return tuple(n for n in range(_count(kind)) if n % HELD_OUT[kind])


def test_numbers(kind: str) -> tuple[int, ...]:
    """Worlds that are reported on, and never tuned on: "barn", the benchmark's own 50; "dynabarn", the even ones."""
    return tuple(range(0, _count(kind), HELD_OUT[kind]))


def lacking(folder: str | Path, kind: str) -> str:
    """Why a folder does not give the worlds of "barn" or "dynabarn"; empty where it does."""
    home = Path(folder)
    file, worlds = (STATIC, SDF) if _count(kind) == WORLDS["barn"] else (DYNAMIC, PLUGINS)
    if not home.is_dir():
        return f"there is no folder {home.name}: name one with {file}, or a checkout of Daffan/the-barn-challenge"
    if (home / file).is_file() or (kind == "barn" and (home / worlds / "world_0.world").is_file()):
        return ""
    if (home / worlds).is_dir():
        return f"{home.name} is a checkout whose moving obstacles are compiled plugins, which are not read: give {file}"
    return f"{home.name} holds neither {file} nor a checkout of Daffan/the-barn-challenge"


def _count(kind: str) -> int:
    if kind not in WORLDS:
        raise ValueError(f"the sets of worlds are {' and '.join(WORLDS)}, got {kind!r}")
    return WORLDS[kind]


def _known(number: int, kind: str) -> None:
    if not 0 <= number < _count(kind):
        raise ValueError(f"{kind} has worlds 0 to {WORLDS[kind] - 1}, got {number}")


# --- files --------------------------------------------------------------------------------------


@lru_cache(maxsize=4)
def _packed(path: Path) -> tuple[list[Array], Array]:
    """Discs of every static world, and the lengths of the provided paths."""
    try:
        with np.load(path, allow_pickle=False) as file:
            count, rows, cols = (int(n) for n in file["shape"])
            cells = np.unpackbits(file["occupied"])[: count * rows * cols].reshape(count, rows, cols)
            x0, y0, cell, radius = (float(file[name]) for name in ("x0", "y0", "cell", "radius"))
            lengths = np.asarray(file["optimal_length"], dtype=float)
    except DAMAGED as error:
        raise ValueError(f"{path.name} does not hold the static worlds: {error}") from None
    worlds = []
    for world in cells:
        row, col = np.nonzero(world)
        worlds.append(np.column_stack([x0 + col * cell, y0 + row * cell, np.full(len(row), radius)]))
    return worlds, lengths


@lru_cache(maxsize=4)
def _dynamic(path: Path) -> dict[str, Any]:
    """The file of dynamic worlds, looked at once."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        worlds = found["worlds"]
        whole = len(worlds) == WORLDS["dynabarn"] and {"mover_radius", "walls", "start", "goal"} <= found.keys()
        if not whole or not all(np.array(keys).shape[1:] == (3,) for movers in worlds for _, keys in movers):
            raise ValueError("it lacks a world, a key frame or what they share")
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise ValueError(f"{path.name} does not hold the dynamic worlds: {error}") from None
    return dict(found)


def sdf_discs(text: str, name: str) -> Array:
    """Rows x, y, radius [m] of the cylinders in an SDF world file; ValueError where there are none."""
    rows = []
    for model in MODEL.findall(text):
        pose, radius = POSE.search(model), RADIUS.search(model)
        if pose and radius:
            rows.append([float(pose[1]), float(pose[2]), float(radius[1])])
    if not rows:
        raise ValueError(f"{name} names no cylinder: it is no world of this benchmark")
    return np.array(rows)


def _path_length(path: Path) -> float:
    """Length [m] of start, provided path and goal."""
    cells = np.load(path, allow_pickle=False).astype(float)
    points = np.vstack([START[:2], cells * CELL + SHIFT, GOAL])
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def _fastest(frames: Array) -> float:
    """Greatest speed [m/s] between the key frames t, x, y of one loop."""
    steps = np.diff(frames, axis=0)
    return float((np.hypot(steps[:, 1], steps[:, 2]) / steps[:, 0]).max())


# --- score --------------------------------------------------------------------------------------


def score(success: ArrayLike, seconds: ArrayLike, optimum: ArrayLike) -> Array:
    """The benchmark's metric: 0.5 for a success within twice the best time, down to 0.125 from eight times on.

    The best time drives `optimum` [m] at 2 m/s; no success is 0, whatever its time. They broadcast.

    >>> score([True, True, True, False], [5.0, 20.0, 100.0, 5.0], 10.0).tolist()
    [0.5, 0.25, 0.125, 0.0]
    """
    best = np.asarray(optimum, dtype=float) / TOP
    won = np.asarray(success, dtype=bool)
    actual = np.where(won, np.asarray(seconds, dtype=float), 0.0)
    return np.asarray(won * best / np.clip(actual, 2.0 * best, 8.0 * best))


def published_runs(folder: str | Path) -> pd.DataFrame:
    """The published raw runs of move_base's DWA: world, success, collision, timeout, seconds; and `optimum` [m].

    Raises FileNotFoundError where the folder has no such file or no static worlds.
    """
    home = Path(folder)
    reason = lacking(home, "barn")
    if not reason and not (home / RUNS).is_file() and not (home / RAW).is_file():
        reason = f"{home.name} holds neither {RUNS} nor {RAW}"
    if reason:
        raise FileNotFoundError(reason)
    if (home / RUNS).is_file():
        table = pd.read_csv(home / RUNS)
    else:
        names = ["world", "success", "collision", "timeout", "seconds"]
        table = pd.read_csv(home / RAW, sep=r"\s+", header=None, usecols=range(5), names=names)
    lengths = {n: static_task(home, n).optimum for n in sorted(set(table["world"]))}
    return table.assign(optimum=table["world"].map(lengths))


def outcome(runs: pd.DataFrame) -> dict[str, float]:
    """Shares of success, contact and lateness in published runs, and the mean score."""
    return {
        "success": float(runs["success"].mean()),
        "contact": float(runs["collision"].mean()),
        "late": float(runs["timeout"].mean()),
        "metric": float(score(runs["success"], runs["seconds"], runs["optimum"]).mean()),
    }
