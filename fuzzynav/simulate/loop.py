"""The one closed loop of the course: a world, a robot, what it senses, a controller, and a record of it all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav import checks
from fuzzynav.control import Controller, Observation
from fuzzynav.geometry import Array, wrap
from fuzzynav.robot import Robot, body_speeds, kernels, limits_of, move
from fuzzynav.sensors import EXACT, Laser, Odometry
from fuzzynav.simulate.disturbance import UNDISTURBED, Disturbance
from fuzzynav.simulate.kernels import Walk, least_clearance
from fuzzynav.simulate.record import Run
from fuzzynav.simulate.senses import Senses
from fuzzynav.world import MoverState, World, movers_start, movers_step

__all__ = ["IDEAL_LASER", "Loop", "Playback", "run", "stands_free"]

STILL = 1e-9  # [m/s] slower than this is standing
FAR = 1e6  # [m] a robot that gets there has left every bound
IDEAL_LASER = Laser(beams=360, field_of_view=2.0 * np.pi, range_min=0.0, range_max=10.0, noise=0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Loop:
    """How a run is driven and when it ends; times in seconds, lengths in metres. inf switches an ending off."""

    goal_tolerance: float = 0.5
    stall_time: float = 15.0  # stalled: in this time the robot went less than stall_distance away
    stall_distance: float = 0.05
    stall_angle: float = 0.2  # [rad] and turned by less than this
    stop_at_contact: bool = True
    standing: float = 0.0  # [m/s] a robot that is no faster (to 1e-9) stands: what touches it then ran into it
    end_when_struck: bool = False
    heading: float | None = None  # [rad] at the start; None: towards the goal, where start has no heading
    velocity: tuple[float, float] = (0.0, 0.0)  # v [m/s], omega [rad/s] at the start
    by_euler: bool = False  # integrate as the thesis does, not along exact arcs

    def __post_init__(self) -> None:
        if not (self.goal_tolerance > 0 and self.stall_time > 0 and self.stall_distance >= 0):
            raise ValueError(f"tolerance and times must be positive, got {self}")
        checks.not_negative(standing=self.standing)
        checks.finite(self.velocity, "Loop.velocity (v, omega)", 2)


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
    goal: ArrayLike | None = None,
    *,
    dt: float = 0.1,
    t_max: float = 120.0,
    rng: np.random.Generator | int | None = None,
    laser: Laser | None = IDEAL_LASER,
    odometry: Odometry = EXACT,
    track_movers: bool = False,
    disturbance: Disturbance = UNDISTURBED,
    loop: Loop | None = None,
) -> Run:
    """Drive `robot` from `start` (x, y[, theta]) until the goal, a contact, standing still, or t_max [s].

    laser None: nothing is scanned. track_movers: an ideal tracker tells the movers, and the velocity of every point.
    goal None: the controller's status or t_max ends the run. The same arguments and seed give the same run, bit for
    bit; rng None is seed 0. Raises ValueError for times that are not positive, a start that touches something, a goal
    that lies outside the world or inside an obstacle, or an object that is no controller.
    """
    loop = loop or Loop()
    first, target = _checked(world, robot, start, goal, loop)
    lacking = [name for name in ("reset", "status", "evidence") if not hasattr(controller, name)]
    if lacking or not callable(controller):
        raise ValueError(f"a controller is callable and has reset(), status and evidence; lacking: {lacking}")
    if not (dt > 0 and t_max >= dt and np.isfinite(t_max)):
        raise ValueError(f"dt must be positive and t_max at least one step, got dt {dt} and t_max {t_max}")
    senses = Senses(world, laser, odometry, track_movers)
    state = _State(robot, first, target, senses, np.random.default_rng(0 if rng is None else rng))
    steps = int(np.floor(t_max / dt + 1e-9))
    state.disturb(disturbance, loop, steps, dt)
    controller.reset()
    status = "reached" if state.way <= loop.goal_tolerance else ""
    for k in range(steps):
        if status:
            break
        wish = np.array(controller(state.observe(k * dt)), dtype=float)
        if wish.shape != (2,) or not np.isfinite(wish).all():
            raise ValueError(f"the controller returned {wish.tolist()} at {k * dt:.1f} s: give finite (v, omega)")
        state.advance(wish, k, dt, loop)
        state.keep(controller.evidence, wish)
        status = _ending(state, controller.status, loop, dt)
    return state.run(status or "timeout", dt)


def stands_free(world: World, robot: Robot, point: ArrayLike) -> bool:
    """Whether the robot could stand at `point` [m] at time 0 without touching anything."""
    return bool(world.clearance(np.asarray(point, dtype=float)[:2]) > robot.radius)


def _checked(world: World, robot: Robot, start: ArrayLike, goal: ArrayLike | None, loop: Loop) -> tuple[Array, Array]:
    """Start pose and goal point (nan without a goal), or one clear error."""
    a = np.asarray(start, dtype=float).ravel()
    b = np.full(2, np.nan) if goal is None else np.asarray(goal, dtype=float).ravel()
    finite = np.isfinite(a).all() and (goal is None or np.isfinite(b).all())
    if a.size not in (2, 3) or b.size not in (2, 3) or not finite:
        raise ValueError(f"start and goal must be finite (x, y) or (x, y, theta), got {a.tolist()} and {b.tolist()}")
    if not stands_free(world, robot, a):
        raise ValueError(f"the robot cannot start at ({a[0]:g}, {a[1]:g}): it would touch an obstacle or a mover")
    if goal is not None and not world.clearance(b[:2], []) > 0:
        raise ValueError(f"the goal ({b[0]:g}, {b[1]:g}) lies inside an obstacle or outside the world")
    towards = loop.heading if loop.heading is not None else float(np.nan_to_num(np.arctan2(b[1] - a[1], b[0] - a[0])))
    return (a if a.size == 3 else np.append(a, towards)), b[:2]


class _State:
    """The truth of one run while it is made, and its record."""

    def __init__(self, robot: Robot, start: Array, goal: Array, senses: Senses, rng: np.random.Generator) -> None:
        self.robot, self.goal, self.senses, self.world = robot, goal, senses, senses.world
        self.root = rng
        self.traffic_rng, self.rng = rng.spawn(2)  # noise must not change how the movers walk
        self.pose, self.believed = start.copy(), start.copy()
        self.traffic = movers_start(self.world, self.traffic_rng)
        self.movers = self.traffic.positions
        self.limits = limits_of(robot)
        self.commands: list[Array] = []
        self.clearances: list[float] = []
        self.track: dict[str, list[Any]] = {"believed": [self.believed], "movers": [self.movers], "wish": []}
        self.touching = False
        self.contacts = [0, 0]  # begun while driving, begun while standing

    def disturb(self, disturbance: Disturbance, loop: Loop, steps: int, dt: float) -> None:
        """Draw what disturbs the run, and set the wheels turning as they turn at the start."""
        self.poses = np.empty((steps + 1, 3))
        self.poses[0] = self.pose
        self.plant = disturbance.plant(self.robot)[0]
        self.late = round(disturbance.delay / dt)
        self.noise, self.slip = np.zeros((steps, 3)), np.zeros((steps, 2))
        if disturbance != UNDISTURBED:
            self.noise, self.slip = disturbance.draws(steps, dt, self.root)
            self.track["driven"] = []
        self.first = np.array(loop.velocity, dtype=float)
        self.command, self.velocity, self.measured = self.first, self.first.copy(), self.first.copy()
        half = 0.5 * self.first[1] * self.robot.track
        self.wheels = (self.first[0] + np.array([half, -half])) / self.robot.wheel_radius

    @property
    def way(self) -> float:
        """Way [m] to the goal; nan without one."""
        return float(np.hypot(*(self.goal - self.pose[:2])))

    def observe(self, time: float) -> Observation:
        """What the sensors grant."""
        pose = self.believed + self.noise[len(self.commands)]
        told = self.senses.told(self.pose, pose, self.traffic, self.rng)
        return Observation(time=time, pose=pose, velocity=self.measured.copy(), goal=self.goal.copy(), **told)

    def advance(self, wish: Array, k: int, dt: float, loop: Loop) -> None:
        """Step k of truth: limits, delay, motors, robot, movers, contact, odometry."""
        last, self.command = self.command, wish.copy()
        kernels.limits(self.command.reshape(1, 2), last.reshape(1, 2), self.limits, dt)
        self.commands.append(self.command)
        acting = self.commands[k - self.late] if k >= self.late else self.first
        start, before, driven = self.pose, self.traffic, np.empty(2)
        self.pose = start.copy()
        kernels.drive(self.pose, self.wheels, acting, self.slip[k], self.plant, dt, loop.by_euler, driven)
        self.driven = driven
        self.velocity = body_speeds(self.wheels, self.robot) if "driven" in self.track else acting
        stands = bool(abs(driven[0]) <= loop.standing + STILL)
        self.traffic = movers_step(before, dt, self.pose, self.traffic_rng, self.robot.radius, stands)
        self.movers = self.traffic.positions
        self.clearances.append(self._least_clearance(start, driven, dt, before))
        self._count_contact(not stands, bool(abs(driven[0]) > STILL))
        self.poses[k + 1] = self.pose
        self._odometry(driven, dt)

    def _least_clearance(self, start: Array, driven: Array, dt: float, before: MoverState) -> float:
        """Least clearance [m] of the rim during the step."""
        now, world = self.traffic, self.world
        walk = Walk(before.positions, now.positions, before.travelled, now.travelled)
        radius = float(self.robot.radius)
        return float(least_clearance(world.scene, now.fleet, walk, start, self.pose, driven, float(dt), radius))

    def _count_contact(self, moving: bool, creeping: bool) -> None:
        """A contact counts once, when it begins; by whether the robot drove, or crept into what stands."""
        now = self.clearances[-1] <= 0.0
        if now and creeping and not moving:
            moving = bool(self.world.clearance(self.pose[:2], []) <= self.robot.radius)
        if now and not self.touching:
            self.contacts[0 if moving else 1] += 1
        elif now and moving and not self.contacts[0]:
            self.contacts[0] += 1  # it drives on while something touches it
        self.touching = now

    def _odometry(self, driven: Array, dt: float) -> None:
        """Believed speed and pose: exact, or misjudged by bias and noise."""
        if self.senses.odometry == EXACT:
            self.measured, self.believed = self.velocity, self.pose
            return
        factors = self.senses.odometry.factors(self.rng)
        self.measured, self.believed = self.velocity * factors, move(self.believed, driven * factors, dt)

    def keep(self, evidence: Mapping[str, Any], wish: Array) -> None:
        """Record what the step left."""
        self.track["wish"].append(wish)
        self.track["believed"].append(self.believed)
        self.track["movers"].append(self.movers)
        if "driven" in self.track:
            self.track["driven"].append(self.driven)
        for name, value in evidence.items():
            self.track.setdefault(name, []).append(value)

    def run(self, status: str, dt: float) -> Run:
        """The record as a Run."""
        n = len(self.commands)
        return Run(
            t=dt * np.arange(n + 1, dtype=np.float64),
            poses=self.poses[: n + 1].copy(),
            commands=np.array(self.commands).reshape(n, 2),
            clearance=np.array(self.clearances),
            log={k: np.array(v) for k, v in self.track.items()},
            status=status,
            goal=self.goal,
            radius=self.robot.radius,
            contacts_moving=self.contacts[0],
            contacts_standing=self.contacts[1],
        )


def _ending(state: _State, named: str | None, loop: Loop, dt: float) -> str:
    """The status that ends the run now, or ''; `named` is what the controller says."""
    if state.contacts[0] and loop.stop_at_contact:
        return "collided"
    if state.contacts[1] and loop.end_when_struck:
        return "struck"
    if state.way <= loop.goal_tolerance:
        return "reached"
    if named:
        return str(named)
    x, y, theta = state.pose.tolist()
    if not (abs(x) < FAR and abs(y) < FAR and abs(theta) < FAR):
        return "diverged"
    return "stalled" if np.isfinite(loop.stall_time) and _stalled(state, loop, dt) else ""


def _stalled(state: _State, loop: Loop, dt: float) -> bool:
    """Whether the last steps led nowhere."""
    back, n = int(np.ceil(loop.stall_time / dt - 1e-9)), len(state.commands)
    if n < back:
        return False
    gone = state.poses[n] - state.poses[n - back]
    if np.hypot(gone[0], gone[1]) > 1.001 * loop.stall_distance:
        return False  # the usual case, without a look at all of them
    gone = state.poses[n - back : n + 1] - state.poses[n - back]
    turned = np.abs(wrap(gone[:, 2])).max()
    return bool(np.hypot(gone[:, 0], gone[:, 1]).max() < loop.stall_distance and turned < loop.stall_angle)
