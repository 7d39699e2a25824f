"""The closed loop of `simulate.run` compiled, for what the long studies need: a static world and exact odometry.

The robot knows the map as a distance field, or sees the world with an ideal laser. A study drives tens of thousands
of runs; a test holds this loop and the open one together, step by step.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from fuzzynav.data import folder
from fuzzynav.dwa.contact import STILL, Chart, field_at
from fuzzynav.dwa.controller import Stuck
from fuzzynav.dwa.decision import NO_CHART, NO_POINTS, NO_RADII, Field, prepared
from fuzzynav.dwa.kernels import decide, is_blind, window
from fuzzynav.dwa.sight import border
from fuzzynav.dwa.steps import TABLE_3_3, Params
from fuzzynav.dwa.weights import AHEAD, INPUTS, OUTPUTS
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.fuzzy.compiled import Tables
from fuzzynav.fuzzy.engine import infer_one
from fuzzynav.geometry import Array
from fuzzynav.robot import THESIS, Robot
from fuzzynav.robot.kernels import arc, limit, wrap
from fuzzynav.sensors import Laser
from fuzzynav.simulate.loop import Loop
from fuzzynav.simulate.record import Run
from fuzzynav.world import World
from fuzzynav.world.kernels import Scene, clearance, scan

__all__ = ["RULES", "drive", "shipped", "tables_of"]

RULES = folder("fuzzy")
STATUSES = ("timeout", "collided", "reached", "blind", "stalled")
TIMEOUT, COLLIDED, REACHED, BLIND, STALLED = range(5)
NO_SCAN = (NO_POINTS, NO_POINTS, NO_POINTS, NO_RADII, 0)  # no points, no border of what was seen

BEAMS = np.dtype((np.record, [("range_min", "f8"), ("range_max", "f8"), ("scanned", "?")]))
ENDS = np.dtype(
    (
        np.record,
        [
            ("steps", "i8"),
            ("goal_tolerance", "f8"),  # [m]
            ("stall_steps", "i8"),
            ("stall_distance", "f8"),  # [m]
            ("stall_angle", "f8"),  # [rad]
            ("blind_steps", "i8"),
        ],
    )
)


def tables_of(system: FuzzySystem) -> Tables:
    """The flat tables of a weight system; raises ValueError unless its variables stand in the thesis's order."""
    named = tuple(v.name for v in system.inputs), tuple(v.name for v in system.outputs)
    if named != (INPUTS, OUTPUTS):
        raise ValueError(f"{system.name} maps {named[0]} to {named[1]}; needed: {INPUTS} to {OUTPUTS}, in this order")
    return system.tables


@cache
def shipped(name: str) -> Tables:
    """The tables of a rule base in data/fuzzy."""
    return tables_of(FuzzySystem.load(RULES / f"{name}.fll"))


def drive(
    world: World,
    start: ArrayLike,
    goal: ArrayLike,
    params: Params = TABLE_3_3,
    *,
    field: Field | None = None,
    rules: Tables | None = None,
    robot: Robot = THESIS,
    laser: Laser | None = None,
    t_max: float = 120.0,
    loop: Loop | None = None,
) -> Run:
    """Drive with fixed weights, or with those of `rules` and the parameters' weights where no rule fires.

    The log holds alpha, beta, gamma, uncovered (no rule fired) and braking (nothing was admissible) of every step.
    laser None: the field alone says what is in the way. The world must stand still, the laser must be ideal, the
    footprint the disc. Movers, faults of the laser and another loop are for `simulate.run`: ValueError.
    """
    loop = loop or Loop()
    _refuse(world, params, laser, loop)
    a, b = _posed(start, goal, loop), np.asarray(goal, dtype=float)
    ready = prepared(robot, params)
    poses, commands, weights, clearances, notes, status = _drive(
        world.scene,
        NO_CHART if field is None else field.chart,
        (a, b[:2].copy()),
        ready.limits,
        ready.settings,
        (ready.weights, rules or shipped("thesis_table_3_2"), rules is not None),
        _beams(laser),
        _ends(loop, params.dt, t_max),
    )
    return Run(
        t=params.dt * np.arange(len(poses), dtype=float),
        poses=poses,
        commands=commands,
        clearance=clearances,
        log=_log(weights, notes),
        status=STATUSES[status],
        goal=b[:2].copy(),
        radius=robot.radius,
        contacts_moving=int(status == COLLIDED),
    )


def _posed(start: ArrayLike, goal: ArrayLike, loop: Loop) -> Array:
    """The start with a heading: its own, the loop's, or towards the goal."""
    a, b = np.asarray(start, dtype=float), np.asarray(goal, dtype=float)
    if a.size == 3:
        return a
    return np.append(a, np.arctan2(b[1] - a[1], b[0] - a[0]) if loop.heading is None else loop.heading)


def _log(weights: Array, notes: NDArray[np.bool_]) -> dict[str, Array]:
    """What the controller would have given as evidence, step by step."""
    columns = np.column_stack([weights, notes.astype(float)]).T
    return dict(zip(("alpha", "beta", "gamma", "uncovered", "braking"), columns, strict=True))


def _refuse(world: World, params: Params, laser: Laser | None, loop: Loop) -> None:
    """Raise ValueError for what only the open loop can drive."""
    faulty = laser is not None and (laser.noise > 0.0 or laser.dropout > 0.0)
    if world.movers or faulty or params.footprint or params.sampling != "closed":
        raise ValueError("the compiled loop knows no movers, faults of the laser, footprint or printed sampling")
    if not loop.stop_at_contact or any(loop.velocity) or loop.by_euler:
        raise ValueError("the compiled loop starts at rest, drives exact arcs and ends at a contact")


def _beams(laser: Laser | None) -> tuple[Array, Array]:
    """Angles of the beams, and one BEAMS record."""
    if laser is None:
        return NO_RADII, np.array([(0.0, np.inf, False)], dtype=BEAMS)
    return laser.angles, np.array([(laser.range_min, laser.range_max, True)], dtype=BEAMS)


def _ends(loop: Loop, dt: float, t_max: float) -> Array:
    """When a run ends: one ENDS record."""
    steps = int(np.floor(t_max / dt + 1e-9))
    stall = steps + 1 if np.isinf(loop.stall_time) else int(np.ceil(loop.stall_time / dt - 1e-9))
    blind = int(np.ceil(Stuck().blind / dt - 1e-9))
    return np.array([(steps, loop.goal_tolerance, stall, loop.stall_distance, loop.stall_angle, blind)], dtype=ENDS)


@njit(cache=True)
def _sense(scene: Scene, pose: Array, beams: Any, size: float, settings: Any, charted: bool) -> tuple[Any, float]:
    """What the laser shows, as `decide` takes it, and the nearest point.

    The border is left out where a map says what the beams do not show.
    """
    angles, laser = beams[0], beams[1][0]
    if not laser.scanned:
        return NO_SCAN, np.inf
    seen, _ = scan(scene, np.empty((0, 3)), pose.reshape(1, 3), angles, laser.range_max)
    ranges, points, count, nearest = seen[0], np.empty((angles.size, 2)), 0, np.inf
    c, s = np.cos(pose[2]), np.sin(pose[2])
    for i in range(angles.size):
        if ranges[i] >= laser.range_max:
            ranges[i] = np.inf
        elif ranges[i] < laser.range_min:
            ranges[i] = -np.inf
        else:
            x, y = ranges[i] * np.cos(angles[i]), ranges[i] * np.sin(angles[i])
            points[count, 0], points[count, 1] = c * x - s * y + pose[0], s * x + c * y + pose[1]
            nearest = min(nearest, np.hypot(points[count, 0] - pose[0], points[count, 1] - pose[1]))
            count += 1
    if charted or not settings.blind:
        return (points[:count], NO_POINTS, NO_POINTS, NO_RADII, 0), nearest
    rim, radii, holes = border(ranges, angles, pose, laser.range_max, size, NO_POINTS, settings.thinnest)
    return (points[:count], NO_POINTS, rim, radii, holes), nearest


@njit(cache=True)
def _weigh(pose: Array, goal: Array, speed: float, near: float, mind: Any, out: Array) -> bool:
    """Weights for one state into `out`; whether a rule fired. mind: nominal weights, rules, whether they are used."""
    nominal, tables, _ = mind
    head = abs(np.degrees(wrap(np.arctan2(goal[1] - pose[1], goal[0] - pose[0]) - pose[2])))
    head = min(head, 180.0) if head > AHEAD else 0.0
    inputs = np.array([head, min(max(near, 0.0), 15.0), min(abs(speed), 1.0)])  # as `weights.inputs_of` cuts them
    values = np.empty(3)
    out[:] = nominal
    if infer_one(tables, inputs, values) <= 0.0:
        return False
    for k in range(3):
        if np.isfinite(values[k]):
            out[k] = max(values[k], 0.0)
    if out.sum() > 0.0:
        return True
    out[:] = nominal
    return False


@njit(cache=True)
def _least(scene: Scene, pose: Array, v: float, omega: float, dt: float, radius: float) -> float:
    """Least clearance of the rim during a step, as the open loop looks for it."""
    none, least, at = np.empty((0, 3)), np.inf, np.empty((1, 2))
    at[0, 0], at[0, 1], _ = arc(pose[0], pose[1], pose[2], v, omega, dt)
    end = float(clearance(scene, none, at)[0] - radius)
    if end > abs(v) * dt + 0.05:
        return end
    for u in (0.2, 0.4, 0.6, 0.8):
        at[0, 0], at[0, 1], _ = arc(pose[0], pose[1], pose[2], v, omega, u * dt)
        least = min(least, clearance(scene, none, at)[0] - radius)
    return min(end, least)


@njit(cache=True)
def _stalled(poses: Array, n: int, ends: Any) -> bool:
    """Whether the last steps led nowhere."""
    first = n - ends.stall_steps
    if first < 0:
        return False
    far, turned = 0.0, 0.0
    for i in range(first, n + 1):
        far = max(far, np.hypot(poses[i, 0] - poses[first, 0], poses[i, 1] - poses[first, 1]))
        turned = max(turned, abs(wrap(poses[i, 2] - poses[first, 2])))
    return bool(far < ends.stall_distance and turned < ends.stall_angle)


@njit(cache=True)
def _ending(poses: Array, n: int, goal: Array, touching: bool, blind: int, ends: Any) -> int:
    """The status that ends the run after n steps; TIMEOUT where none does."""
    if touching:
        return COLLIDED
    if np.hypot(goal[0] - poses[n, 0], goal[1] - poses[n, 1]) <= ends.goal_tolerance:
        return REACHED
    if blind > ends.blind_steps:
        return BLIND
    return STALLED if _stalled(poses, n, ends) else TIMEOUT


@njit(cache=True)
def _drive(
    scene: Scene, charted: Any, course: Any, limits: Array, settings: Array, mind: Any, beams: Any, ends: Array
) -> tuple[Array, Array, Array, Array, NDArray[np.bool_], int]:
    """Poses, commands, weights, clearances, (uncovered, braking) of every step, and the status.

    course: start pose and goal; beams: angles and one record; mind as in `_weigh`.
    """
    (start, goal), (values, frame), lim, own, end = course, charted, limits[0], settings[0], ends[0]
    chart = Chart(values, frame[0], frame[1], frame[2])
    poses, commands, weights = np.empty((end.steps + 1, 3)), np.empty((end.steps, 2)), np.empty((end.steps, 3))
    clearances, notes = np.empty(end.steps), np.zeros((end.steps, 2), dtype=np.bool_)
    w, pose, ruled = mind[0].copy(), start.copy(), mind[2]
    poses[0] = pose
    v = omega = 0.0
    n = blind = 0
    status = _ending(poses, 0, goal, False, 0, end)
    while n < end.steps and status == TIMEOUT:
        sensed, near = _sense(scene, pose, beams, lim.radius, own, values.size > 0)
        if values.size:
            near = min(near, field_at(pose[0], pose[1], chart))
        if ruled:
            notes[n, 0] = not _weigh(pose, goal, v, near - lim.radius, mind, w)
        samples = window(v, omega, lim, own)
        made = decide(samples, pose, goal, sensed, charted, (limits, NO_POINTS), settings, w)
        reasons, best = made[2], made[5]
        notes[n, 1] = best < 0
        chosen = samples.shape[0] - 1 if best < 0 else best
        wish, turn = samples[chosen, 0], samples[chosen, 1]
        stands = abs(wish) <= STILL and abs(turn) <= STILL and is_blind(samples, reasons)
        blind = blind + 1 if stands else 0
        v, omega = limit(wish, turn, v, omega, lim, own.dt)
        clearances[n] = _least(scene, pose, v, omega, own.dt, lim.radius)
        pose = np.array(arc(pose[0], pose[1], pose[2], v, omega, own.dt))
        commands[n, 0], commands[n, 1] = v, omega
        weights[n], poses[n + 1] = w, pose
        touching = clearances[n] <= 0.0 and abs(v) > STILL
        n += 1
        status = _ending(poses, n, goal, touching, blind, end)
    return poses[: n + 1], commands[:n], weights[:n], clearances[:n], notes[:n], status


def _warm() -> None:
    """Compile the loop for the types used in practice."""
    yard, there = World(bounds=(0, 10, 0, 10)), ((1.0, 1.0), (9.0, 9.0))
    scanner = Laser(beams=8, field_of_view=2.0 * np.pi, noise=0.0)
    drive(yard, *there, t_max=0.2, field=Field(np.full((40, 40), 5.0), 0.25), laser=scanner)
