"""The closed loop of `simulate.run` compiled, for what the long studies need: a static world and exact odometry.

The robot knows the map as a distance field, or sees the world with an ideal scanner. A study drives tens of thousands
of runs; a test holds this loop and the open one together, step by step.
"""
# mypy: disallow_untyped_defs = False

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numba import njit
from numpy.typing import ArrayLike

from fuzzynav.data import folder
from fuzzynav.dwa.contact import STILL, _blind, _field_at
from fuzzynav.dwa.decision import NO_FIELD, NO_FRAME, NO_POINTS, NO_RADII, Field
from fuzzynav.dwa.kernels import _plan, _reachable, _window
from fuzzynav.dwa.steps import CHAPTER_3, Params, limits_of
from fuzzynav.dwa.weights import INPUTS, OUTPUTS
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.fuzzy.engine import infer_one
from fuzzynav.fuzzy.packing import Tables
from fuzzynav.geometry import Array
from fuzzynav.robot import THESIS, Robot
from fuzzynav.sensors import Laser
from fuzzynav.simulate.loop import Loop
from fuzzynav.world import World
from fuzzynav.world.kernels import clearance, scan

__all__ = ["Drive", "drive", "shipped", "tables_of"]

RULES = folder("fuzzy")
STATUS = ("timeout", "reached", "stalled", "collided")


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """One compiled run: as `simulate.Run`, without a log."""

    poses: Array  # (n + 1, 3)
    commands: Array  # (n, 2)
    weights: Array  # (n, 3)
    clearance: Array  # (n,) [m]
    status: str
    uncovered: int  # steps in which no rule fired
    braking: int  # steps in which nothing was admissible
    dt: float

    @property
    def iterations(self) -> int:
        """Number of control steps."""
        return len(self.commands)

    @property
    def length(self) -> float:
        """Length of the driven path [m]."""
        return float(np.abs(self.commands[:, 0]).sum() * self.dt)

    @property
    def min_clearance(self) -> float:
        """Least distance [m] from the rim to anything; inf for a run without steps."""
        return float(self.clearance.min(initial=np.inf))


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
    params: Params = CHAPTER_3,
    *,
    field: Field | None = None,
    rules: Tables | None = None,
    robot: Robot = THESIS,
    laser: Laser | None = None,
    t_max: float = 120.0,
    loop: Loop | None = None,
) -> Drive:
    """Drive with fixed weights, or with those of `rules` and the parameters' weights where no rule fires.

    laser None: the field alone says what is in the way. The world must stand still, the laser must be ideal, the
    footprint the disc. Movers, noise and disturbances are for
    `simulate.run`: ValueError.
    """
    loop = loop or Loop()
    faulty = laser is not None and (laser.noise or laser.dropout or laser.range_min)
    if world.movers or faulty or params.footprint or params.sampling != "closed":
        raise ValueError("the compiled loop knows no movers, noise, motor lag, footprint or printed sampling")
    a, b = np.asarray(start, dtype=float), np.asarray(goal, dtype=float)
    pose = a if a.size == 3 else np.append(a, np.arctan2(b[1] - a[1], b[0] - a[0]))
    given = rules or shipped("thesis_table_3_2")
    ends = np.array(
        [loop.goal_tolerance, np.ceil(loop.stall_time / params.dt - 1e-9), loop.stall_distance, loop.stall_angle]
    )
    known = (NO_FIELD, NO_FRAME) if field is None else (field.values, np.array([field.resolution, *field.origin]))
    switches = np.array([params.distance == "end", params.bound == "as_printed", rules is not None, params.blind])
    steps = int(np.floor(t_max / params.dt + 1e-9))
    weights = np.asarray(params.weights, dtype=float)
    poses, commands, used, clearance, status, uncovered, braking = _drive(
        world.scene,
        known,
        pose,
        b[:2].copy(),
        limits_of(robot),
        params.settings,
        switches,
        weights,
        given,
        steps,
        ends,
        np.empty(0) if laser is None else laser.angles,
        0.0 if laser is None else laser.range_max,
    )
    return Drive(poses, commands, used, clearance, STATUS[status], uncovered, braking, params.dt)


@njit(cache=True)
def _weights(inputs, nominal, tables, out):
    """Weights for one state into `out`; whether a rule fired."""
    values = np.empty(3)
    if infer_one(tables, inputs, values) <= 0.0:
        out[:] = nominal
        return False
    for k in range(3):
        out[k] = max(values[k], 0.0) if np.isfinite(values[k]) else nominal[k]
    return True


@njit(cache=True)
def _moved(pose, v, omega, dt):
    """`robot.move` for one pose."""
    turn = omega * dt
    x = np.pi * (turn / (2.0 * np.pi) if turn != 0.0 else 1e-20)
    chord, middle = v * dt * (np.sin(x) / x), pose[2] + turn / 2.0
    heading = (pose[2] + turn + np.pi) % (2.0 * np.pi) - np.pi
    return np.array([pose[0] + chord * np.cos(middle), pose[1] + chord * np.sin(middle), heading])


@njit(cache=True)
def _least(scene, pose, v, omega, dt, radius):
    """Least clearance of the rim during a step, as the open loop looks for it."""
    none, least = np.empty((0, 3)), np.inf
    after = _moved(pose, v, omega, dt)
    end = clearance(scene, none, after[:2].copy().reshape(1, 2))[0] - radius
    if end > abs(v) * dt + 0.05:
        return end
    for u in (0.2, 0.4, 0.6, 0.8):
        between = _moved(pose, v, omega, u * dt)[:2].copy().reshape(1, 2)
        least = min(least, clearance(scene, none, between)[0] - radius)
    return min(end, least)


@njit(cache=True)
def _stalled(poses, n, ends):
    """Whether the last steps led nowhere."""
    first = n - int(ends[1])
    if first < 0:
        return False
    far, turned = 0.0, 0.0
    for i in range(first, n + 1):
        far = max(far, (poses[i, 0] - poses[first, 0]) ** 2 + (poses[i, 1] - poses[first, 1]) ** 2)
        turned = max(turned, abs((poses[i, 2] - poses[first, 2] + np.pi) % (2.0 * np.pi) - np.pi))
    return np.sqrt(far) < ends[2] and turned < ends[3]


@njit(cache=True)
def _drive(scene, known, start, goal, limits, settings, switches, nominal, tables, steps, ends, angles, range_max):
    """Poses, commands, weights, clearances, status, uncovered and braking steps."""
    dt = settings[0]
    field, frame = known
    poses, commands, weights = np.empty((steps + 1, 3)), np.empty((steps, 2)), np.empty((steps, 3))
    clearances, w, pose = np.empty(steps), nominal.copy(), start.copy()
    points, border, radii, corners = NO_POINTS, NO_POINTS, NO_RADII, NO_POINTS
    full = angles.size > 2 and angles.size * (angles[1] - angles[0]) > 2.0 * np.pi - 1.5 * (angles[1] - angles[0])
    poses[0] = pose
    v = omega = 0.0
    uncovered = status = n = braking = 0
    for k in range(steps):
        nearest = np.inf
        if angles.size:
            seen, _ = scan(scene, np.empty((0, 3)), pose.reshape(1, 3), angles, range_max)
            ranges, count = seen[0], 0
            points = np.empty((angles.size, 2))
            for i in range(angles.size):
                if ranges[i] < range_max:
                    bearing = pose[2] + angles[i]
                    points[count, 0] = pose[0] + ranges[i] * np.cos(bearing)
                    points[count, 1] = pose[1] + ranges[i] * np.sin(bearing)
                    nearest = min(nearest, np.hypot(points[count, 0] - pose[0], points[count, 1] - pose[1]))
                    count += 1
                else:
                    ranges[i] = np.inf
            points = points[:count]
            if switches[3]:
                border, radii = _blind(ranges, angles, pose, range_max, full)
        if field.size:
            nearest = min(nearest, _field_at(pose[0], pose[1], field, frame[0], frame[1], frame[2]))
        if switches[2]:
            bearing = (np.arctan2(goal[1] - pose[1], goal[0] - pose[0]) - pose[2] + np.pi) % (2.0 * np.pi) - np.pi
            near = min(max(nearest - limits[6], 0.0), 15.0)
            inputs = np.array([min(abs(np.degrees(bearing)), 180.0), near, min(abs(v), 1.0)])
            uncovered += not _weights(inputs, nominal, tables, w)
        samples = _window(v, omega, limits, settings)
        _, _, _, _, _, best, _ = _plan(
            samples, pose, goal, points, border, radii, field, frame, corners, limits, settings, switches, w
        )
        braking += best < 0
        chosen = samples.shape[0] - 1 if best < 0 else best
        low, high, right, left = _reachable(v, omega, limits, dt)
        v, omega = min(max(samples[chosen, 0], low), high), min(max(samples[chosen, 1], right), left)
        clearances[k] = _least(scene, pose, v, omega, dt, limits[6])
        pose = _moved(pose, v, omega, dt)
        commands[k, 0], commands[k, 1] = v, omega
        weights[k], poses[k + 1] = w, pose
        n = k + 1
        if clearances[k] <= 0.0 and abs(v) > STILL:
            status = 3
        elif np.hypot(goal[0] - pose[0], goal[1] - pose[1]) <= ends[0]:
            status = 1
        elif _stalled(poses, n, ends):
            status = 2
        if status:
            break
    return poses[: n + 1], commands[:n], weights[:n], clearances[:n], status, uncovered, braking


def _warm() -> None:
    """Compile the loop for the types used in practice."""
    drive(
        World(bounds=(0, 10, 0, 10)),
        (1.0, 1.0),
        (9.0, 9.0),
        t_max=0.2,
        field=Field(np.full((40, 40), 5.0), 0.25),
        laser=Laser(beams=8, range_min=0.0, noise=0.0),
    )
