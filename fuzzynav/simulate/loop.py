"""The one closed loop of the course: a world, a robot, what it senses, a controller, and a record of it all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.control import Controller, Observation
from fuzzynav.geometry import Array, wrap
from fuzzynav.robot import Robot, limit, motor_lag, move
from fuzzynav.simulate.record import STATUSES, Run
from fuzzynav.world import World, movers_start, movers_step

__all__ = ["IDEAL", "STATUSES", "Loop", "Playback", "Run", "Sensing", "run", "stands_free"]

STILL = 1e-9  # [m/s] slower than this is standing


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensing:
    """What a controller may know: one scan of limited range and the odometry, ideal unless noise is given.

    A beam that meets nothing reads inf. Raises ValueError for a range that is not positive or a
    negative noise.
    """

    beams: int = 360
    field_of_view: float = 2.0 * np.pi  # [rad] centred on the heading
    range_max: float = 10.0  # [m]
    range_noise: float = 0.0  # [m] standard deviation of one range
    dropout: float = 0.0  # share of beams that read nan
    speed_noise: tuple[float, float] = (0.0, 0.0)  # standard deviation of measured v and omega, as a share of them
    speed_bias: tuple[float, float] = (0.0, 0.0)  # constant share by which odometry misjudges v and omega
    velocities: bool = False  # an ideal tracker gives every point the velocity of what it lies on

    def __post_init__(self) -> None:
        if self.beams < 0 or not self.range_max > 0:
            raise ValueError(f"beams must be 0 or more and range_max positive, got {self.beams} and {self.range_max}")
        if not 0 < self.field_of_view <= 2.0 * np.pi + 1e-12:
            raise ValueError(f"field_of_view must lie in (0, 2 pi], got {self.field_of_view}")
        if self.range_noise < 0 or min(self.speed_noise) < 0 or not 0 <= self.dropout < 1:
            raise ValueError("noise must not be negative, and dropout must lie in [0, 1)")

    @property
    def angles(self) -> Array:
        """Beam angles `(beams,)` [rad] in the body frame; a full circle does not repeat its first beam."""
        full = self.field_of_view > 2.0 * np.pi - 1e-9
        return np.linspace(-0.5, 0.5, self.beams, endpoint=not full) * self.field_of_view


IDEAL = Sensing()


@dataclass(frozen=True, slots=True, kw_only=True)
class Loop:
    """How a run is driven and when it ends; times in seconds, lengths in metres."""

    goal_tolerance: float = 0.5
    stall_time: float = 15.0  # stalled: in this time the robot went less than stall_distance away
    stall_distance: float = 0.05
    stall_angle: float = 0.2  # [rad] and turned by less than this
    motor_lag: float = 0.0  # time constant of the motors behind the limited command; 0: the command is the speed
    stop_at_contact: bool = True
    heading: float | None = None  # [rad] at the start; None: towards the goal, where start has no heading

    def __post_init__(self) -> None:
        if not (self.goal_tolerance > 0 and self.stall_time > 0 and self.stall_distance >= 0 and self.motor_lag >= 0):
            raise ValueError(f"tolerance and times must be positive, got {self}")


class Playback(Controller):
    """A controller that gives the commands of a recorded run once more."""

    def __init__(self, recorded: Run) -> None:
        self.commands = recorded.commands
        self.step = 0

    def reset(self) -> None:
        """Start from the first command."""
        self.step = 0

    def __call__(self, observation: Observation) -> Array:
        """The next recorded command; (0, 0) after the last."""
        self.step += 1
        return self.commands[self.step - 1] if self.step <= len(self.commands) else np.zeros(2)


def run(
    world: World,
    robot: Robot,
    controller: Controller,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    dt: float = 0.1,
    t_max: float = 120.0,
    rng: np.random.Generator | int | None = None,
    sensors: Sensing = IDEAL,
    loop: Loop | None = None,
) -> Run:
    """Drive `robot` from `start` (x, y[, theta]) until the goal, a contact, standing still, or t_max [s].

    The same arguments and seed give the same run, bit for bit; rng None is seed 0. Raises ValueError for times that
    are not positive, a start that touches something, or a goal that lies outside the world or inside an obstacle.
    """
    loop = loop or Loop()
    first, target = _checked(world, robot, start, goal, loop)
    if not (dt > 0 and t_max >= dt and np.isfinite(t_max)):
        raise ValueError(f"dt must be positive and t_max at least one step, got dt {dt} and t_max {t_max}")
    state = _State(world, robot, first, target, sensors, np.random.default_rng(0 if rng is None else rng))
    controller.reset()
    steps = int(np.floor(t_max / dt + 1e-9))
    status = "reached" if state.distance <= loop.goal_tolerance else ""
    for k in range(steps):
        if status:
            break
        wish = np.asarray(controller(state.observe(k * dt)), dtype=float)
        if wish.shape != (2,) or not np.isfinite(wish).all():
            raise ValueError(f"the controller returned {wish.tolist()} at {k * dt:.1f} s: give finite (v, omega)")
        state.advance(wish, k * dt, dt, loop)
        state.keep(controller.evidence, wish)
        status = _ending(state, controller, loop, dt)
    return state.run(status or "timeout", dt)


def stands_free(world: World, robot: Robot, point: ArrayLike) -> bool:
    """Whether the robot could stand at `point` [m] at time 0 without touching anything."""
    return bool(world.clearance(np.asarray(point, dtype=float)[:2]) > robot.radius)


def _checked(world: World, robot: Robot, start: ArrayLike, goal: ArrayLike, loop: Loop) -> tuple[Array, Array]:
    """Start pose and goal point, or one clear error."""
    a, b = np.asarray(start, dtype=float).ravel(), np.asarray(goal, dtype=float).ravel()
    if a.size not in (2, 3) or b.size not in (2, 3) or not (np.isfinite(a).all() and np.isfinite(b).all()):
        raise ValueError(f"start and goal must be finite (x, y) or (x, y, theta), got {a.tolist()} and {b.tolist()}")
    if not stands_free(world, robot, a):
        raise ValueError(f"the robot cannot start at ({a[0]:g}, {a[1]:g}): it would touch an obstacle or a mover")
    if not world.clearance(b[:2], []) > 0:
        raise ValueError(f"the goal ({b[0]:g}, {b[1]:g}) lies inside an obstacle or outside the world")
    towards = loop.heading if loop.heading is not None else float(np.arctan2(b[1] - a[1], b[0] - a[0]))
    return (a if a.size == 3 else np.append(a, towards)), b[:2]


class _State:
    """The truth of one run while it is made, and its record."""

    def __init__(
        self, world: World, robot: Robot, start: Array, goal: Array, sensors: Sensing, rng: np.random.Generator
    ) -> None:
        self.world, self.robot, self.goal, self.sensors = world, robot, goal, sensors
        self.traffic_rng, self.rng = rng.spawn(2)  # noise must not change how the movers walk
        self.pose, self.believed = start.copy(), start.copy()
        self.velocity = self.measured = self.command = np.zeros(2)
        self.traffic = movers_start(world, self.traffic_rng)
        self.movers = self.traffic.positions
        self.poses: list[Array] = [self.pose]
        self.commands: list[Array] = []
        self.clearances: list[float] = []
        self.track: dict[str, list[Any]] = {"believed": [self.believed], "movers": [self.movers], "wish": []}
        self.touching = False
        self.contacts = [0, 0]  # begun while driving, begun while standing

    @property
    def distance(self) -> float:
        """Way [m] to the goal."""
        return float(np.hypot(*(self.goal - self.pose[:2])))

    def observe(self, time: float) -> Observation:
        """What the sensors grant."""
        s = self.sensors
        angles = s.angles
        ranges, owners = self.world.cast_labelled(self.pose, angles, s.range_max, self.movers)
        hit = ranges < s.range_max
        if s.range_noise > 0:
            ranges = np.maximum(ranges + s.range_noise * self.rng.standard_normal(ranges.size), 0.0)
        ranges = np.where(hit, ranges, np.inf)
        if s.dropout > 0:
            ranges[self.rng.random(ranges.size) < s.dropout] = np.nan
        seen = np.isfinite(ranges)
        speeds = None
        if s.velocities:
            speeds = np.vstack([self.traffic.velocities, np.zeros(2)])[owners[seen]]  # -1: what stands
        return Observation(
            time=time,
            pose=self.believed.copy(),
            velocity=self.measured.copy(),
            points=_ends(self.believed, angles[seen], ranges[seen]),
            point_velocities=speeds,
            goal=self.goal.copy(),
            ranges=ranges,
            angles=angles,
            range_max=s.range_max,
        )

    def advance(self, wish: Array, time: float, dt: float, loop: Loop) -> None:
        """One step of truth: motors, robot, movers, contact, odometry."""
        driven = limit(wish, self.command, self.robot, dt)
        before, self.command = self.velocity, driven
        self.velocity = driven
        if loop.motor_lag > 0:
            tau = loop.motor_lag
            self.velocity = motor_lag(before, driven, tau, dt)
            driven = driven + (before - driven) * (tau / dt) * (1.0 - np.exp(-dt / tau))  # mean over the step
        start, old = self.pose, self.movers
        self.pose = move(start, driven, dt)
        self.traffic = movers_step(self.traffic, dt, self.pose, self.traffic_rng)
        self.movers = self.traffic.positions
        self.clearances.append(self._least_clearance(start, driven, dt, old))
        self._count_contact(abs(driven[0]) > STILL)
        self.commands.append(driven)
        self.poses.append(self.pose)
        self._odometry(driven, dt)

    def _least_clearance(self, start: Array, driven: Array, dt: float, old: Array) -> float:
        """Least clearance [m] of the rim during the step; looked at more closely where the step could matter."""
        radius, way = self.robot.radius, abs(driven[0]) * dt
        way += float(np.hypot(*(self.movers - old).T).max(initial=0.0))
        end = float(self.world.clearance(self.pose[:2], self.movers)) - radius
        if end > way + 0.05:
            return end
        shares = np.array([0.2, 0.4, 0.6, 0.8])
        points = move(start, driven, shares * dt)[:, :2]
        if not len(old):
            return min(end, float(self.world.clearance(points, old).min()) - radius)
        standing = [old + u * (self.movers - old) for u in shares]
        between = [float(self.world.clearance(p, m)) for p, m in zip(points, standing, strict=True)]
        return min(end, min(between) - radius)

    def _count_contact(self, moving: bool) -> None:
        """A contact counts once, when it begins; by whether the robot drove."""
        now = self.clearances[-1] <= 0.0
        if now and not self.touching:
            self.contacts[0 if moving else 1] += 1
        elif now and moving and not self.contacts[0]:
            self.contacts[0] += 1  # it drives on while something touches it
        self.touching = now

    def _odometry(self, driven: Array, dt: float) -> None:
        """Believed speed and pose: exact, or misjudged by bias and noise."""
        s = self.sensors
        if not (any(s.speed_noise) or any(s.speed_bias)):
            self.measured, self.believed = self.velocity, self.pose
            return
        factor = 1.0 + np.array(s.speed_bias) + np.array(s.speed_noise) * self.rng.standard_normal(2)
        self.measured = self.velocity * factor
        self.believed = move(self.believed, driven * factor, dt)

    def keep(self, evidence: Mapping[str, Any], wish: Array) -> None:
        """Record what the step left."""
        self.track["wish"].append(wish)
        self.track["believed"].append(self.believed)
        self.track["movers"].append(self.movers)
        for name, value in evidence.items():
            self.track.setdefault(name, []).append(value)

    def run(self, status: str, dt: float) -> Run:
        """The record as a Run."""
        n = len(self.commands)
        return Run(
            t=dt * np.arange(n + 1, dtype=np.float64),
            poses=np.array(self.poses),
            commands=np.array(self.commands).reshape(n, 2),
            clearance=np.array(self.clearances),
            log={k: np.array(v) for k, v in self.track.items()},
            status=status,
            goal=self.goal,
            radius=self.robot.radius,
            contacts_moving=self.contacts[0],
            contacts_standing=self.contacts[1],
        )


def _ends(pose: Array, angles: Array, ranges: Array) -> Array:
    """Ends `(n, 2)` [m] of beams seen from a pose."""
    bearing = pose[2] + angles
    return np.stack([pose[0] + ranges * np.cos(bearing), pose[1] + ranges * np.sin(bearing)], axis=-1)


def _ending(state: _State, controller: Controller, loop: Loop, dt: float) -> str:
    """The status that ends the run now, or ''."""
    if state.contacts[0] and loop.stop_at_contact:
        return "collided"
    if state.distance <= loop.goal_tolerance:
        return "reached"
    named = controller.status
    if named:
        return str(named)
    back = int(np.ceil(loop.stall_time / dt - 1e-9))
    if len(state.poses) > back:
        gone = np.array(state.poses[-back - 1 :]) - state.poses[-back - 1]
        turned = np.abs(wrap(gone[:, 2])).max()
        if np.hypot(gone[:, 0], gone[:, 1]).max() < loop.stall_distance and turned < loop.stall_angle:
            return "stalled"
    return ""
