"""Pictures of the planner among movers: reachable discs, the window with its reasons, predictions, tracks, the map."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection, PolyCollection
from matplotlib.colors import ListedColormap, to_rgba
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from fuzzynav import dwa, fusion
from fuzzynav.control import Observation
from fuzzynav.dwa.kernels import braking
from fuzzynav.geometry import Array
from fuzzynav.plot.base import COLORS, draw_goal, draw_path, draw_robot, metric_axes
from fuzzynav.plot.runs import draw_world
from fuzzynav.robot import Robot, limits_of

__all__ = [
    "MapMark",
    "PredictionMark",
    "ReachMark",
    "ReasonMark",
    "braking_arc",
    "draw_ellipse",
    "draw_forbidden",
    "draw_moment",
    "draw_orbit",
    "draw_reachable",
    "draw_reasons",
    "draw_scan_hits",
    "draw_track",
    "forbidden",
    "map_mark",
    "prediction_mark",
    "reach_mark",
    "reason_mark",
]

AROUND = np.linspace(0.0, 2.0 * np.pi, 49)
RINGS = 4  # moments of a braking manoeuvre that are drawn
FEW = 6  # hazards; more, as the hits of a scan, are drawn without rings
Mask = NDArray[np.bool_]


def circles(discs: ArrayLike) -> list[Array]:
    """Outlines `(49, 2)` of discs, rows x, y, radius [m]; a radius below 0 is drawn as 0."""
    ring = np.column_stack([np.cos(AROUND), np.sin(AROUND)])
    rows = np.asarray(discs, dtype=float).reshape(-1, 3)
    return [row[:2] + max(row[2], 0.0) * ring for row in rows]


# --- what movers can reach ------------------------------------------------------------------------


def braking_arc(
    pose: ArrayLike, sample: ArrayLike, robot: Robot, dt: float, times: ArrayLike | None = None
) -> tuple[Array, Array]:
    """Moments `(k,)` [s] and poses `(k, 3)` of a robot that drives (v, omega) for dt [s] and then brakes on the arc.

    times: the moments, by default every dt until it stands.
    """
    v, omega = np.asarray(sample, dtype=float)
    drop = braking(float(v), float(omega), limits_of(robot)[0]) * dt
    steps = int(np.ceil(abs(v) / drop - 1e-12)) if v != 0.0 else 0
    t = np.arange(steps + 1) * dt if times is None else np.clip(np.asarray(times, dtype=float), 0.0, steps * dt)
    k = np.floor(t / dt + 1e-9)
    done = dt * (k * abs(v) - 0.5 * drop * k * (k - 1.0)) + (t - k * dt) * np.maximum(abs(v) - k * drop, 0.0)
    unit = np.array([[np.sign(v), omega / abs(v) if v != 0.0 else 0.0]])
    return np.asarray(t, dtype=float), np.array([dwa.arcs(pose, unit, [s])[0, 0] for s in done])


@dataclass(frozen=True, slots=True)
class ReachMark:
    """A robot that brakes on its arc, and all that the movers can have reached meanwhile; `place` shows another."""

    ground: PolyCollection
    rings: LineCollection
    bodies: LineCollection
    arc: Line2D

    @property
    def artists(self) -> list[Artist]:
        """What a lab redraws."""
        return [self.ground, self.rings, self.bodies, self.arc]

    def place(
        self, pose: ArrayLike, sample: ArrayLike, hazards: ArrayLike, bound: float, robot: Robot, dt: float
    ) -> None:
        """Show the sample (v, omega), and what hazards (rows x, y, radius [m]) of speed `bound` [m/s] can reach."""
        rows = np.asarray(hazards, dtype=float).reshape(-1, 3)
        t, line = braking_arc(pose, sample, robot, dt)
        moments, places = braking_arc(pose, sample, robot, dt, np.linspace(0.0, t[-1], RINGS))
        self.ground.set_verts(circles(rows + [0.0, 0.0, bound * t[-1]]))
        self.ground.set_facecolor(to_rgba(COLORS["mover"], 0.22 if len(rows) <= FEW else 0.05))
        ringed = rows if len(rows) <= FEW else rows[:0]
        self.rings.set_segments([c for s in moments for c in circles(ringed + [0.0, 0.0, bound * s])])
        self.bodies.set_segments(circles(np.column_stack([places[:, :2], np.full(len(places), robot.radius)])))
        self.arc.set_data(*line[:, :2].T)


def reach_mark(ax: Axes) -> ReachMark:
    """Empty marks for `place`."""
    ground = PolyCollection([], facecolors=to_rgba(COLORS["mover"], 0.22), edgecolors="none", zorder=2)
    rings = LineCollection([], colors=COLORS["mover"], linewidths=0.9, zorder=3)
    bodies = LineCollection([], colors=COLORS["robot"], linewidths=1.0, zorder=4)
    for one in (ground, rings, bodies):
        ax.add_collection(one)
    (arc,) = ax.plot([], [], color=COLORS["robot"], linestyle="-", linewidth=2.0, zorder=5)
    return ReachMark(ground, rings, bodies, arc)


def draw_reachable(
    ax: Axes, sample: ArrayLike, hazards: ArrayLike, speed_bound: float, robot: Robot, *, dt: float = 0.1
) -> ReachMark:
    """The braking arc of a robot at the origin, and the growing discs of the movers, from now until it stands."""
    mark, rows = reach_mark(ax), np.asarray(hazards, dtype=float).reshape(-1, 3)
    mark.place((0.0, 0.0, 0.0), sample, rows, speed_bound, robot, dt)
    ax.add_collection(PolyCollection(circles(rows), facecolors=COLORS["mover"], edgecolors="black", zorder=4))
    draw_robot(ax, (0.0, 0.0, 0.0), robot.radius)
    shown = np.vstack([*mark.rings.get_segments(), *mark.bodies.get_segments()])
    low, high = shown.min(axis=0) - 0.1, shown.max(axis=0) + 0.1
    metric_axes(ax, (low[0], high[0], low[1], high[1]))
    return mark


def forbidden(
    robot: Robot, hazards: ArrayLike, speed_bound: float, *, dt: float = 0.1, n: tuple[int, int] = (27, 41)
) -> tuple[Mask, Array, Array]:
    """Which speeds of a robot at the origin the guard refuses `(n_v, n_omega)`, and the v and omega of the grid."""
    v = np.linspace(0.0, robot.max_vel_x, n[0])
    omega = np.linspace(-robot.max_vel_theta, robot.max_vel_theta, n[1])
    here = (0.0, 0.0, 0.0)
    refused = [
        [not fusion.stays_clear(here, [one, turn], hazards, speed_bound, robot, dt) for turn in omega] for one in v
    ]
    return np.array(refused), v, omega


def draw_forbidden(ax: Axes, robot: Robot, hazards: ArrayLike, speed_bound: float) -> AxesImage:
    """The plane of omega and v: grey is what the guard refuses near the hazards, rows x, y, radius [m]."""
    refused, v, omega = forbidden(robot, hazards, speed_bound)
    image = ax.imshow(
        refused,
        origin="lower",
        aspect="auto",
        cmap=ListedColormap(["white", COLORS["mover"]]),
        vmin=0,
        vmax=1,
        extent=(omega[0], omega[-1], v[0], v[-1]),
        zorder=1,
    )
    ax.set(xlabel=r"$\omega$ [rad/s], left turn to the left", ylabel="$v$ [m/s]", xlim=(omega[-1], omega[0]))
    ax.grid(False)
    return image


# --- the window with its reasons ------------------------------------------------------------------

LOOKS = (  # of the samples that are not eligible, by reason; 0: admissible, but contact is predicted
    ("s", "none", COLORS["goal"], "contact predicted"),
    ("x", COLORS["obstacle"], COLORS["obstacle"], "cannot stop"),
    ("+", COLORS["unknown"], "#888888", "not seen"),
    ("^", COLORS["mover"], COLORS["mover"], "a mover could be there"),
)


@dataclass(frozen=True, slots=True)
class ReasonMark:
    """The samples of a decision around the speed the robot has, and why each is refused; `place` shows another."""

    scored: PathCollection
    refused: tuple[Line2D, ...]
    chosen: Line2D

    @property
    def artists(self) -> list[Artist]:
        """What a lab redraws."""
        return [self.scored, *self.refused, self.chosen]

    def place(self, made: fusion.Decision, velocity: ArrayLike) -> None:
        """Show a decision that was made at `velocity` (v, omega); scores are stretched over all colours."""
        points, ok = (made.samples - np.asarray(velocity, dtype=float))[:, ::-1], made.eligible
        totals = made.totals[ok]
        span = float(np.ptp(totals)) if len(totals) else 0.0
        self.scored.set_offsets(points[ok])
        self.scored.set_array((totals - totals.min()) / span if span > 0 else np.full(len(totals), 0.5))
        for reason, line in enumerate(self.refused):
            line.set_data(*points[(made.reasons == reason) & ~ok].T)
        self.chosen.set_data(*points[[made.chosen]].T)


def reason_mark(ax: Axes, robot: Robot, dt: float = 0.1) -> ReasonMark:
    """Empty axes of the window: omega and v, counted from what the robot drives now."""
    wide, high = robot.acc_lim_theta * dt, max(robot.acc_lim_x, robot.dec_lim_x) * dt
    scored = ax.scatter([], [], c=[], s=34, marker="s", cmap="cividis", vmin=0.0, vmax=1.0, zorder=3)
    refused = tuple(
        ax.plot([], [], look, color=edge, markerfacecolor=face, markersize=5, linestyle="", zorder=3, label=text)[0]
        for look, face, edge, text in LOOKS
    )
    (chosen,) = ax.plot(
        [], [], "o", color=COLORS["goal"], markersize=12, markerfacecolor="none", markeredgewidth=2.2, zorder=5
    )
    ax.set(
        xlim=(1.2 * wide, -1.2 * wide),
        ylim=(-1.2 * high, 1.2 * high),
        xlabel=r"$\omega-\omega_c$ [rad/s], left turn to the left",
        ylabel="$v-v_c$ [m/s]",
    )
    return ReasonMark(scored, refused, chosen)


def draw_reasons(ax: Axes, made: fusion.Decision, velocity: ArrayLike, robot: Robot, *, dt: float = 0.1) -> ReasonMark:
    """The window of one decision: what counts by score, what is refused and why, the choice."""
    mark = reason_mark(ax, robot, dt)
    mark.place(made, velocity)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2, fontsize=8.5, handletextpad=0.2)
    return mark


# --- prediction -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class PredictionMark:
    """Where movers are expected if they keep their velocities, a disc for every second; `place` shows others."""

    discs: LineCollection
    ways: LineCollection

    @property
    def artists(self) -> list[Artist]:
        """What a lab redraws."""
        return [self.discs, self.ways]

    def place(self, movers: ArrayLike, horizon: float, growth: float) -> None:
        """Show movers, rows x, y, vx, vy, radius; their discs grow by `growth` [m/s] until `horizon` [s]."""
        rows = np.asarray(movers, dtype=float).reshape(-1, 5)
        times = np.arange(1.0, horizon + 1e-9)
        ahead = [np.column_stack([rows[:, :2] + t * rows[:, 2:4], rows[:, 4] + growth * t]) for t in times]
        self.discs.set_segments([c for discs in ahead for c in circles(discs)])
        self.ways.set_segments([np.array([row[:2], row[:2] + horizon * row[2:4]]) for row in rows])


def prediction_mark(ax: Axes) -> PredictionMark:
    """Empty marks for `place`."""
    discs = LineCollection([], colors=COLORS["goal"], linewidths=1.0, linestyles="--", zorder=4)
    ways = LineCollection([], colors=COLORS["goal"], linewidths=1.4, zorder=4)
    ax.add_collection(discs)
    ax.add_collection(ways)
    return PredictionMark(discs, ways)


# --- the map that grows ---------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class MapMark:
    """The cells that the scanner entered into the map, the way over it and the sub-goal; `place` shows another."""

    image: AxesImage
    way: Line2D
    target: Line2D

    @property
    def artists(self) -> list[Artist]:
        """What a lab redraws."""
        return [self.image, self.way, self.target]

    def place(self, moment: fusion.Moment) -> None:
        """Show what was known at this moment."""
        self.image.set_data(np.where(moment.entered, 1.0, np.nan))
        self.way.set_data(*moment.way.T)
        self.target.set_data(*moment.decision.target[:, None])


def map_mark(ax: Axes, extent: Sequence[float]) -> MapMark:
    """Empty marks over a map that covers xmin, xmax, ymin, ymax [m]."""
    image = ax.imshow(
        np.full((2, 2), np.nan),
        origin="lower",
        extent=(extent[0], extent[1], extent[2], extent[3]),
        cmap=ListedColormap([COLORS["path"]]),
        interpolation="nearest",
        alpha=0.9,
        zorder=3,
    )
    way = draw_path(ax, np.empty((0, 2)), role="reference", linestyle="--", marker="o")
    (target,) = ax.plot([], [], "D", color=COLORS["goal"], markersize=8, markeredgecolor="black", zorder=6)
    return MapMark(image, way, target)


def draw_moment(ax: Axes, task: fusion.Task, moment: fusion.Moment, *, driven: ArrayLike | None = None) -> MapMark:
    """One moment of a run: the true world, the cells entered so far, the way over the map, the sub-goal, the robot."""
    draw_world(ax, task.world)
    mark = map_mark(ax, task.world.bounds or (0.0, 1.0, 0.0, 1.0))
    mark.place(moment)
    if driven is not None:
        draw_path(ax, driven)
    movers = moment.around.movers
    ax.add_collection(PolyCollection(circles(movers[:, [0, 1, 4]]), facecolors=COLORS["mover"], zorder=4))
    draw_goal(ax, task.goal)
    draw_robot(ax, moment.observation.pose, task.robot.radius)
    return mark


# --- from beams to a track ------------------------------------------------------------------------


def draw_scan_hits(ax: Axes, seen: Observation, which: Mask, *, beams: bool = True) -> list[Artist]:
    """The hits of some beams of a scan, `which` `(k,)`, and the beams themselves. Raises ValueError without a scan."""
    if seen.ranges is None or seen.angles is None:
        raise ValueError("there is no scan to draw")
    hit = which & np.isfinite(seen.ranges) & (seen.ranges < seen.range_max)
    bearing = seen.pose[2] + seen.angles[hit]
    ends = seen.pose[:2] + seen.ranges[hit, None] * np.column_stack([np.cos(bearing), np.sin(bearing)])
    made: list[Artist] = [*ax.plot(*ends.T, ".", color=COLORS["obstacle"], markersize=5, zorder=5)]
    if beams:
        lines = LineCollection([np.array([seen.pose[:2], end]) for end in ends], colors="#999999", linewidths=0.7)
        made.append(ax.add_collection(lines))
    return made


def draw_ellipse(
    ax: Axes, center: ArrayLike, cov: ArrayLike, *, sigmas: float = 2.0, role: str = "robot", label: str = ""
) -> Line2D:
    """The ellipse of so many standard deviations around an estimate (2,) with covariance (2, 2) [m^2]."""
    root = np.linalg.cholesky(np.asarray(cov, dtype=float))
    ring = np.asarray(center, dtype=float) + sigmas * np.column_stack([np.cos(AROUND), np.sin(AROUND)]) @ root.T
    (line,) = ax.plot(*ring.T, color=COLORS[role], linestyle="-", linewidth=1.8, zorder=6)
    if label:
        line.set_label(label)
    return line


def draw_track(ax: Axes, tracks: fusion.Tracks, k: int, *, ahead: float = 1.0) -> list[Artist]:
    """Track k: its disc, the 2-sigma ellipse of its centre, and its way in the next `ahead` [s] with that ellipse."""
    center, velocity = tracks.centers[k], tracks.velocities[k]
    later = center + ahead * velocity
    step = np.block([[np.eye(2), ahead * np.eye(2)], [np.zeros((2, 2)), np.eye(2)]])
    grown = (step @ tracks.covariances[k] @ step.T)[:2, :2]
    disc = LineCollection(circles([[*center, tracks.radii[k]]]), colors=COLORS["robot"], linewidths=1.2, zorder=5)
    made: list[Artist] = [ax.add_collection(disc)]
    made.append(draw_ellipse(ax, center, tracks.covariances[k][:2, :2]))
    made += ax.plot(*np.array([center, later]).T, color=COLORS["goal"], linestyle="-", zorder=6)
    made.append(draw_ellipse(ax, later, grown, role="goal"))
    return made


# --- the orbit ------------------------------------------------------------------------------------


def draw_orbit(ax: Axes, path: ArrayLike, target: ArrayLike, turn: float, *, radius: float) -> list[Artist]:
    """A path from the origin to a sub-goal, and the two circles of radius `turn` [m] that the robot cannot enter."""
    two = circles([[0.0, turn, turn], [0.0, -turn, turn]])
    zone = PolyCollection(two, facecolors=to_rgba(COLORS["unknown"], 0.35), edgecolors="#888888", zorder=1)
    ax.add_collection(zone)
    line = draw_path(ax, path)
    draw_robot(ax, (0.0, 0.0, 0.0), radius)
    metric_axes(ax)
    return [zone, line, *draw_goal(ax, target)]
