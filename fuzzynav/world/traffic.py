"""Where the movers of a world are, and where they are a step later."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array
from fuzzynav.world import kernels
from fuzzynav.world.movers import MOTIONS
from fuzzynav.world.world import World

__all__ = ["MoverState", "movers_between", "movers_start", "movers_step"]


NOBODY = np.array([np.inf, np.inf, 0.0])  # where no robot is


@dataclass(frozen=True, slots=True, eq=False)
class MoverState:
    """Where the movers of a world are; `positions` and `velocities` are `(m, 2)`."""

    world: World
    positions: Array  # (m, 2) [m]
    velocities: Array  # (m, 2) [m/s]
    targets: Array  # (m, 2) [m], where a wandering mover walks to
    travelled: Array  # (m,) [m], walked so far; [s] of its loop for a timed mover
    fleet: kernels.Fleet = field(repr=False)  # the movers as the kernels read them


def movers_start(world: World, rng: np.random.Generator | int | None = None) -> MoverState:
    """State of the movers at time 0; wandering ones draw their first target from `rng`."""
    rng, fleet = np.random.default_rng(rng), _fleet(world)
    starts = np.array([m.start for m in world.movers]).reshape(-1, 2)
    targets = starts.copy()
    for k, mover in enumerate(world.movers):
        if mover.motion == "wander":
            targets[k] = _draw_target(world, starts[k], mover.radius, rng)
    travelled = np.array([m.phase for m in world.movers], dtype=float)
    _, velocities, _, _ = kernels.advance(fleet, starts, targets, travelled, 0.0, NOBODY, False)
    return MoverState(world, starts, velocities, targets, travelled, fleet)


def movers_step(
    state: MoverState,
    dt: float,
    robot_pose: ArrayLike | None,
    rng: np.random.Generator,
    radius: float = 0.0,
    stands: bool = False,
) -> MoverState:
    """State after `dt` [s]; movers that yield look at the robot's pose `(3,)`, None where there is no robot.

    Courteous ones wait for a robot that stands, a disc of this radius [m]. A mover that reaches its random target waits
    there for the rest of the step and draws the next one. Raises ValueError if dt is not positive.
    """
    if not dt > 0:
        raise ValueError(f"dt must be positive seconds, got {dt}")
    if not state.world.movers:
        return state
    robot, stands = NOBODY, bool(stands and robot_pose is not None)
    if robot_pose is not None:
        robot = np.append(np.asarray(robot_pose, dtype=float)[:2], radius)
    positions, velocities, travelled, arrived = kernels.advance(
        state.fleet, state.positions, state.targets, state.travelled, float(dt), robot, stands
    )
    targets = state.targets
    if arrived.any():
        targets = targets.copy()
        for k in np.flatnonzero(arrived):
            targets[k] = _draw_target(state.world, positions[k], state.world.movers[k].radius, rng)
    return MoverState(state.world, positions, velocities, targets, travelled, state.fleet)


def movers_between(old: MoverState, new: MoverState, share: float) -> Array:
    """Positions `(m, 2)` [m] at a share (0 to 1) of the step from `old` to `new`; who jumps is never between."""
    return np.asarray(
        kernels.between(new.fleet, old.positions, new.positions, old.travelled, new.travelled, float(share))
    )


def _fleet(world: World) -> kernels.Fleet:
    """The movers of a world as the kernels read them."""
    movers, rows = world.movers, [np.reshape(m.frames, (-1, 3)) for m in world.movers]
    corners = np.array([max(len(m.waypoints), len(m.frames)) for m in movers], dtype=np.int64)
    most = max(corners.max(initial=0), 1)
    way, frames = np.zeros((len(movers), most, 2)), np.zeros((len(movers), most, 3))
    for k, mover in enumerate(movers):
        way[k, : len(mover.waypoints)] = np.reshape(mover.waypoints, (-1, 2))
        frames[k, : len(rows[k])] = rows[k]
    return kernels.Fleet(
        np.array([MOTIONS.index(m.motion) for m in movers], dtype=np.int64),
        np.array([m.radius for m in movers]),
        np.array([m.velocity for m in movers]).reshape(-1, 2),
        np.array([m.speed for m in movers]),
        way,
        frames,
        corners,
        np.array([m.yield_distance for m in movers]),
        np.array([m.courtesy for m in movers]),
    )


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
