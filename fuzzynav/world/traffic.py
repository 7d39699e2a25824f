"""Where the movers of a world are, and where they are a step later."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array
from fuzzynav.world import kernels
from fuzzynav.world.movers import MOTIONS
from fuzzynav.world.world import World

__all__ = ["MoverState", "movers_start", "movers_step"]


@dataclass(frozen=True, slots=True, eq=False)
class MoverState:
    """Where the movers of a world are; `positions` and `velocities` are `(m, 2)`."""

    world: World
    positions: Array  # (m, 2) [m]
    velocities: Array  # (m, 2) [m/s]
    targets: Array  # (m, 2) [m], where a wandering mover walks to
    travelled: Array  # (m,) [m], walked so far
    fleet: kernels.Fleet = field(repr=False)  # the movers as the kernels read them


def movers_start(world: World, rng: np.random.Generator | int | None = None) -> MoverState:
    """State of the movers at time 0; wandering ones draw their first target from `rng`."""
    movers, rng = world.movers, np.random.default_rng(rng)
    count, corners = len(movers), max([len(m.waypoints) for m in movers], default=0)
    way, starts = np.zeros((count, max(corners, 1), 2)), np.zeros((count, 2))
    for k, mover in enumerate(movers):
        starts[k] = mover.start
        way[k, : len(mover.waypoints)] = np.reshape(mover.waypoints, (-1, 2))
    fleet = kernels.Fleet(
        np.array([MOTIONS.index(m.motion) for m in movers], dtype=np.int64),
        np.array([m.radius for m in movers]),
        np.array([m.velocity for m in movers]).reshape(-1, 2),
        np.array([m.speed for m in movers]),
        way,
        np.array([len(m.waypoints) for m in movers], dtype=np.int64),
        np.array([m.yield_distance for m in movers]),
    )
    targets = starts.copy()
    for k, mover in enumerate(movers):
        if mover.motion == "wander":
            targets[k] = _draw_target(world, starts[k], mover.radius, rng)
    travelled = np.zeros(count)
    _, velocities, _, _ = kernels.advance(fleet, starts, targets, travelled, 0.0, np.full(2, np.inf))
    return MoverState(world, starts, velocities, targets, travelled, fleet)


def movers_step(state: MoverState, dt: float, robot_pose: ArrayLike | None, rng: np.random.Generator) -> MoverState:
    """State after `dt` [s]; movers that yield look at the robot's pose `(3,)`, None where there is no robot.

    A mover that reaches its random target waits there for the rest of the step and draws the next one.
    Raises ValueError if dt is not positive.
    """
    if not dt > 0:
        raise ValueError(f"dt must be positive seconds, got {dt}")
    if not state.world.movers:
        return state
    robot = np.full(2, np.inf) if robot_pose is None else np.array(robot_pose, dtype=float)[:2]
    positions, velocities, travelled, arrived = kernels.advance(
        state.fleet, state.positions, state.targets, state.travelled, float(dt), robot
    )
    targets = state.targets
    if arrived.any():
        targets = targets.copy()
        for k in np.flatnonzero(arrived):
            targets[k] = _draw_target(state.world, positions[k], state.world.movers[k].radius, rng)
    return MoverState(state.world, positions, velocities, targets, travelled, state.fleet)


def _draw_target(world: World, start: Array, radius: float, rng: np.random.Generator) -> Array:
    """A random point that a disc can walk to straight; `start` where 100 draws find none."""
    xmin, xmax, ymin, ymax = world.bounds or (0.0, 0.0, 0.0, 0.0)
    for _ in range(100):
        target = rng.uniform([xmin, ymin], [xmax, ymax])
        steps = max(int(np.ceil(np.hypot(*(target - start)) / (0.5 * radius))), 1)
        line = start + np.linspace(0.0, 1.0, steps + 1)[1:, None] * (target - start)
        if (world.clearance(line, []) >= 1.05 * radius).all():
            return target
    return start
