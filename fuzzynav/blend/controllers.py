"""Tracking and obstacle avoidance under one robot: the thesis' fuzzy blend as printed, and a safe form of it.

Both take the same two ideas: feedback linearization drives, a fuzzy weight F says how much avoidance has to say.
The compiled steps stand in `avoidance`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzynav.blend import kernels
from fuzzynav.blend.points import MEMORY, _nearest_on, _remember
from fuzzynav.control import Observation
from fuzzynav.data import folder
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.fuzzy.packing import Tables
from fuzzynav.geometry import Array, wrap
from fuzzynav.robot import TURTLEBOT2, Robot
from fuzzynav.tracking.dfl import DflGains
from fuzzynav.tracking.kernels import DFL
from fuzzynav.tracking.reference import FigureEight, Reference
from fuzzynav.tracking.tracker import Tracker

__all__ = [
    "LAP",
    "FuzzyRun",
    "PrintedBlend",
    "PrintedScheme",
    "SafeBlend",
    "SafeScheme",
    "avoidance_yaw_rate",
    "blend",
    "drive",
    "hybrid",
    "reach_of",
    "rescaled",
    "rule_base",
    "safety_switch",
    "table_5_1",
]

LAP = 40.0 * np.pi  # [s] one lap of the figure eight
TABLE = folder("fuzzy") / "thesis_table_5_1.fll"
BEAMS = np.linspace(-np.pi, np.pi, 360, endpoint=False)


# --- the printed equations ---------------------------------------------------------------------


def avoidance_yaw_rate(bearing: ArrayLike, turn: float = 1.0) -> Array:
    """Yaw rate of avoidance: +turn [rad/s] for an obstacle ahead or on the right (bearing <= 0), else -turn.

    Source: thesis eq 5.5.

    >>> avoidance_yaw_rate([-0.3, 0.0, 0.3]).tolist()
    [1.0, 1.0, -1.0]
    """
    return np.where(np.asarray(bearing, dtype=float) <= 0.0, turn, -turn)


def blend(track: ArrayLike, avoid: ArrayLike, weight: ArrayLike) -> Array:
    """Command (1 - F) track + F avoid, `(..., 2)` as v [m/s], omega [rad/s].

    Source: thesis eq 5.6. Raises ValueError unless every weight lies in 0 to 1.

    >>> blend([0.2, 0.1], [0.0, 1.0], 0.5).tolist()
    [0.1, 0.55]
    """
    f = np.asarray(weight, dtype=float)
    if not ((f >= 0.0) & (f <= 1.0)).all():
        raise ValueError(f"the weight F must lie in 0 to 1, got {f.tolist()}")
    return (1.0 - f)[..., None] * np.asarray(track, dtype=float) + f[..., None] * np.asarray(avoid, dtype=float)


def safety_switch(distance: ArrayLike, safe_distance: float) -> Array:
    """S = 1.0 where the nearest obstacle is nearer than safe_distance [m], else 0.0.   Source: thesis eq 2.50."""
    return (np.asarray(distance, dtype=float) < safe_distance).astype(float)


def hybrid(track: ArrayLike, fuzzy: ArrayLike, switch: ArrayLike) -> Array:
    """Command (1 - S) track + S fuzzy for S of 0 or 1: the hard switch, applied to v and omega.

    Source: thesis eq 2.51 (errata T52: printed for accelerations and velocities together, which cannot be added).
    """
    s = np.asarray(switch, dtype=float)
    if not np.isin(s, (0.0, 1.0)).all():
        raise ValueError(f"the switch S must be 0 or 1, got {s.tolist()}")
    return blend(track, fuzzy, s)


# --- the rule base -----------------------------------------------------------------------------


@lru_cache(maxsize=1)
def table_5_1() -> FuzzySystem:
    """The rule base of table 5.1, from data/fuzzy."""
    return FuzzySystem.load(TABLE)


def rule_base(close: float = 0.5, far: float = 1.0, ahead: float = 1.0, peak: float = 0.5) -> FuzzySystem:
    """Table 5.1 with other breakpoints: Close ends from `close` to `far` [m], Zero spans +-ahead [rad], More at peak.

    Raises ValueError unless 0 < close < far < 2, 0 < ahead < 4 and 0 < peak < 1.
    """
    if not (0.0 < close < far < 2.0 and 0.0 < ahead < 4.0 and 0.0 < peak < 1.0):
        raise ValueError(f"need 0 < close < far < 2, 0 < ahead < 4, 0 < peak < 1: {close}, {far}, {ahead}, {peak}")
    return table_5_1().with_terms(
        {
            ("distObs", "Close"): (0.0, 0.0, close, far),
            ("distObs", "Far"): (close, far, 2.0, 2.0),
            ("thetaObs", "Negative"): (-4.0, -4.0, -ahead, 0.0),
            ("thetaObs", "Zero"): (-ahead, 0.0, ahead),
            ("thetaObs", "Positive"): (0.0, ahead, 4.0, 4.0),
            ("F", "Little"): (0.0, 0.0, peak),
            ("F", "More"): (0.0, peak, 1.0),
            ("F", "Lots"): (peak, 1.0, 1.0),
        }
    )


def reach_of(system: FuzzySystem) -> tuple[float, float]:
    """Least and greatest F that the rule base can give: the centroid never reaches 0 nor 1 (errata T60).

    >>> [round(f, 3) for f in reach_of(table_5_1())]
    [0.167, 0.833]
    """
    d, b = np.meshgrid(np.linspace(0.0, 2.0, 41), np.linspace(-4.0, 4.0, 81))
    f = system(d, b)[0]
    return float(np.nanmin(f)), float(np.nanmax(f))


def rescaled(weight: ArrayLike, system: FuzzySystem | None = None) -> Array:
    """F stretched so that the least value of the rule base becomes 0 and the greatest 1."""
    low, high = reach_of(system or table_5_1())
    return np.clip((np.asarray(weight, dtype=float) - low) / (high - low), 0.0, 1.0)


def _tables(system: FuzzySystem) -> Tables:
    """The rule base as the kernels read it. Raises ValueError unless it has two inputs and one output."""
    if len(system.inputs) != 2 or len(system.outputs) != 1:
        raise ValueError("the weight needs a rule base with two inputs, distance and bearing, and one output F")
    return system.tables


# --- what is chosen ----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedScheme:
    """The printed blend. Ours: d0, the half width of the gate as 45 deg, and the unit of the turn.

    Raises ValueError for values that are not positive, a gate over pi, or a share outside 0 to 1.
    """

    gate: float = np.pi / 4.0  # [rad] to each side of straight ahead
    d0: float = 0.7  # [m] from the robot's centre to the block
    keep_speed: float = 0.0  # v_a as a share of v_t: 0 as printed, 1 as remark 1 says (errata T59)
    turn: float = 1.0  # [rad/s]
    hard: bool = False  # the hard switch of section 2.5, without gate, d_safe = d0

    def __post_init__(self) -> None:
        if not (0.0 < self.gate <= np.pi and self.d0 > 0.0 and 0.0 <= self.keep_speed <= 1.0 and self.turn > 0.0):
            raise ValueError(f"gate in (0, pi], d0 and turn positive, keep_speed in 0 to 1, got {self}")

    @property
    def vector(self) -> Array:
        """The values as the kernels read them."""
        return np.array([self.gate, self.d0, self.keep_speed, self.turn, float(self.hard)])


@dataclass(frozen=True, slots=True, kw_only=True)
class SafeScheme:
    """The safe blend: who drives is decided by a forecast of tracking, how by F. All values ours.

    Raises ValueError for values that are not positive and finite, or leave < enter.
    """

    enter: float = 0.10  # [m] avoidance begins when tracking would come nearer than this to a sensed point
    leave: float = 0.12  # [m] and ends when tracking would keep this
    follow: float = 0.15  # [m] margin that the detour keeps
    enter_time: float = 6.0  # [s] how far the forecast looks while tracking
    leave_time: float = 8.0  # [s] and while avoiding
    cruise: float = 0.20  # [m/s] speed of the detour at F = 0
    creep: float = 0.08  # [m/s] and at F = 1
    gain: float = 2.0  # [1/s] yaw rate for a wrong heading, doubled at F = 1
    ahead: float = 0.3  # [m] least arc to the rejoin point
    stretch: float = 0.5  # [m] arc of reference that must be clear behind it
    look: float = 2.0  # [m] arc that is searched for it
    rate: int = 3  # the reference's time runs at most so many times as fast during the detour
    guard: float = 0.03  # [m] the last filter brakes before a point comes nearer
    fade: float = 0.4  # [s] in which avoidance takes over, and hands back
    reach: float = 2.0  # [m] range of the sensor that is used
    moving: bool = False  # remember nothing: every point may have moved on

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name != "moving" and not (np.isfinite(value) and value > 0):
                raise ValueError(f"{field.name} must be positive and finite, got {value}")
        if self.leave < self.enter:
            raise ValueError(f"leave must not be below enter, or the gate would chatter: {self.leave} < {self.enter}")

    def vector(self, system: FuzzySystem, radius: float) -> Array:
        """The values as the kernels read them, with the reach of the rule base and the robot's radius [m]."""
        return np.array(
            [
                self.enter,
                self.leave,
                self.follow,
                self.enter_time,
                self.leave_time,
                self.cruise,
                self.creep,
                self.gain,
                *reach_of(system),
                self.ahead,
                self.stretch,
                self.look,
                self.rate,
                self.guard,
                self.fade,
                self.reach,
                radius,
                float(self.moving),
            ]
        )


# --- controllers -------------------------------------------------------------------------------


class _Blend(Tracker):
    """What both controllers share: the tracker below, the rule base, and evidence of the last step."""

    kind = DFL

    def __init__(
        self, reference: Reference, system: FuzzySystem | None, gains: DflGains | None, robot: Robot, dt: float
    ) -> None:
        super().__init__(reference, (gains or DflGains()).vector, robot, dt)
        self.system = system or table_5_1()
        self.tables = _tables(self.system)
        self._evidence: dict[str, float] = {}

    @property
    def evidence(self) -> dict[str, float]:
        """Numbers of the last step."""
        return self._evidence

    @staticmethod
    def _points(observation: Observation) -> Array:
        """Sensed points (n, 4) with their velocities, 0 where unknown. Raises ValueError for a pose of nan."""
        if not np.isfinite(observation.pose).all():
            raise ValueError(f"the measured pose is not finite: {np.asarray(observation.pose).tolist()}")
        out = np.zeros((len(observation.points), 4))
        out[:, :2] = observation.points
        if observation.point_velocities is not None:
            out[:, 2:] = observation.point_velocities
        return out


class PrintedBlend(_Blend):
    """The thesis' controller: DFL, the turn of eq 5.5 inside the gate, both blended by F; as it is printed."""

    def __init__(
        self,
        reference: Reference,
        scheme: PrintedScheme | None = None,
        *,
        gains: DflGains | None = None,
        system: FuzzySystem | None = None,
        robot: Robot = TURTLEBOT2,
        dt: float = 0.1,
    ) -> None:
        super().__init__(reference, system, gains, robot, dt)
        self.scheme = scheme or PrintedScheme()

    def __call__(self, observation: Observation) -> Array:
        """Command for this observation; evidence: F."""
        track, points = super().__call__(observation), self._points(observation)
        out = np.zeros(2)
        f = kernels._printed(
            self.scheme.vector, self.tables, points, len(points), np.asarray(observation.pose), track, out
        )
        self._evidence = {"F": f}
        return out


class SafeBlend(_Blend):
    """DFL and avoidance, switched by a forecast with memory and weighted by F; the reference waits meanwhile.

    Avoidance takes over when tracking alone would come too near to a sensed point, and hands back when tracking
    would not: both questions are answered by driving the tracking law ahead in thought. Meanwhile the time of the
    reference follows the robot's progress along the curve, and the tracker's integrator follows the speed sent.
    """

    def __init__(
        self,
        reference: Reference,
        scheme: SafeScheme | None = None,
        *,
        gains: DflGains | None = None,
        system: FuzzySystem | None = None,
        robot: Robot = TURTLEBOT2,
        dt: float = 0.1,
    ) -> None:
        super().__init__(reference, system, gains, robot, dt)
        self.scheme = scheme or SafeScheme()
        self.parameters = self.scheme.vector(self.system, robot.radius)
        self.reset()

    def reset(self) -> None:
        """Forget the run before."""
        super().reset()
        self.memory, self.count, self.mind = np.empty((MEMORY, 4)), 0, np.zeros(10)
        self.mind[kernels.RELEASED] = -1e9
        self.last: Array | None = None

    def __call__(self, observation: Observation) -> Array:
        """Command for this observation; evidence: F, weight, avoiding, reference time [s]."""
        pose, seen = np.asarray(observation.pose, dtype=float), self._points(observation)
        k = int(self.mind[kernels.INDEX])
        if k >= self.steps:
            return np.zeros(2)
        seen = seen[np.hypot(seen[:, 0] - pose[0], seen[:, 1] - pose[1]) < self.scheme.reach]
        last = self.rows[0, 7:9].copy() if self.last is None else self.last
        self.count = _remember(self.memory, self.count, seen, pose, self.scheme.reach, self.scheme.moving)
        out = np.zeros(2)
        kernels._safe(
            self.parameters,
            self.mind,
            self.vector,
            self.state,
            self.tables,
            self.rows,
            self.memory,
            self.count,
            pose,
            last,
            observation.time,
            self.dt,
            self.limits,
            out,
        )
        kernels._limit(out, last, self.limits, self.dt)
        self.last = out.copy()
        m = self.mind
        self._evidence = {
            "F": float(m[kernels.FUZZY]),
            "weight": float(m[kernels.WEIGHT]),
            "avoiding": float(m[kernels.LATCHED]),
            "reference_time": k * self.dt,
        }
        return out


# --- the compiled run --------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class FuzzyRun:
    """A run of n steps past one block, with the evidence of every step."""

    t: Array  # (n + 1,) [s]
    poses: Array  # (n + 1, 3)
    wanted: Array  # (n, 3) the pose of the reference that the tracker was given at each step
    commands: Array  # (n, 2)
    weight: Array  # (n,) share of avoidance in the command
    fuzzy: Array  # (n,) F
    avoiding: NDArray[np.bool_]  # (n,) whether the gate was open
    clearance: Array  # (n,) [m] from the robot's rim to the block, inf once it is gone
    index: Array  # (n,) step of the reference
    status: str  # done, collided, timeout

    @property
    def length(self) -> float:
        """Length [m] of the driven path."""
        return float(np.abs(self.commands[:, 0]).sum() * (self.t[1] - self.t[0]))

    @property
    def min_clearance(self) -> float:
        """Least clearance [m] of the rim."""
        return float(self.clearance.min())

    @property
    def errors(self) -> Array:
        """Reference minus pose `(n, 3)`: x [m], y [m], heading [rad] wrapped."""
        gap = self.wanted - self.poses[:-1]
        return np.concatenate([gap[:, :2], wrap(gap[:, 2:])], axis=1)

    @property
    def distance(self) -> Array:
        """Distance `(n,)` [m] from the point of the reference that the tracker was given."""
        return np.hypot(*self.errors[:, :2].T)

    @property
    def delay(self) -> float:
        """Time [s] by which the reference lags behind the clock at the end."""
        dt = float(self.t[1] - self.t[0])
        return float((len(self.index) - 1 - self.index[-1]) * dt)

    @property
    def last_avoidance(self) -> float:
        """Time [s] after which avoidance had no more part in a command; 0 if it never had."""
        active = np.flatnonzero(self.weight > 0.0)
        return float(self.t[active[-1] + 1]) if len(active) else 0.0


def drive(
    scheme: PrintedScheme | SafeScheme,
    block: ArrayLike,
    *,
    reference: Reference | None = None,
    gains: DflGains | None = None,
    system: FuzzySystem | None = None,
    robot: Robot = TURTLEBOT2,
    laps_with_block: float = 1.0,
    laps: float = 1.0,
    dt: float = 0.1,
    limited: bool = True,
    euler: bool = False,
) -> FuzzyRun:
    """Drive a scheme round the reference past one block (x, y, width, height, theta), sensed ideally.

    A lap is 40 pi s; the block is taken away after `laps_with_block`. The printed scheme is told the exact nearest
    point of the block, the safe one sees the ends of 360 beams. Raises ValueError for a block that touches the start.
    """
    shape = np.asarray(block, dtype=float)
    if shape.shape != (5,) or not (np.isfinite(shape).all() and (shape[2:4] > 0).all()):
        raise ValueError(f"a block is x, y, width, height, theta with positive sizes, got {shape.tolist()}")
    curve = reference or FigureEight(duration=laps * LAP)
    tracker = _Blend(curve, system, gains, robot, dt)
    rows, start = tracker.rows, tracker.rows[0, [0, 1, 6]]
    if _nearest_on(shape, start[0], start[1], np.empty(4)) <= robot.radius:
        raise ValueError(f"the block at ({shape[0]:g}, {shape[1]:g}) touches the robot at its start")
    safe = isinstance(scheme, SafeScheme)
    most = tracker.steps + (int(120.0 / dt) if safe else 0)
    poses, commands, log = np.empty((most + 1, 3)), np.empty((most, 2)), np.empty((most, 7))
    P = scheme.vector(tracker.system, robot.radius) if isinstance(scheme, SafeScheme) else np.zeros(19)
    printed = scheme.vector if isinstance(scheme, PrintedScheme) else np.zeros(5)
    n = kernels._drive(
        safe,
        P,
        printed,
        tracker.vector,
        tracker.tables,
        rows,
        start,
        shape,
        round(laps_with_block * LAP / dt),
        BEAMS,
        robot.radius,
        dt,
        tracker.limits,
        limited,
        euler,
        poses,
        commands,
        log,
    )
    index = log[:n, 0].astype(int)
    status = "collided" if log[n - 1, 5] <= 0.0 else "done" if index[-1] >= tracker.steps - 1 else "timeout"
    return FuzzyRun(
        dt * np.arange(n + 1.0),
        poses[: n + 1],
        rows[index][:, [0, 1, 6]],
        commands[:n],
        log[:n, 1],
        log[:n, 2],
        log[:n, 3] > 0.0,
        log[:n, 5],
        index,
        status,
    )
