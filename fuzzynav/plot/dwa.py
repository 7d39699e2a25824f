"""Pictures of local planning: worlds, velocity windows, candidate arcs, runs over time, and the boxes of the method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from numpy.typing import ArrayLike

from fuzzynav import dwa
from fuzzynav.batch import proportion
from fuzzynav.control import Observation
from fuzzynav.dwa.decision import Plan
from fuzzynav.dwa.steps import Params
from fuzzynav.geometry import Array
from fuzzynav.plot.base import COLORS, arrow, block, diagram, draw_robot, metric_axes
from fuzzynav.robot import Robot
from fuzzynav.simulate.record import Run

__all__ = [
    "ArcMark",
    "WindowMark",
    "arc_mark",
    "draw_candidates",
    "draw_run_weights",
    "draw_success",
    "draw_velocity_sets",
    "draw_window",
    "fuzzy_dwa_flowchart",
    "fuzzy_dwa_loop",
    "fuzzy_weight_tuner",
    "window_mark",
]


# --- the window -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class WindowMark:
    """The samples of one plan around the speed the robot has; `place` shows another plan."""

    scored: PathCollection
    refused: Line2D
    chosen: Line2D
    emergency: Line2D

    @property
    def artists(self) -> list[Artist]:
        """What a lab redraws."""
        return [self.scored, self.refused, self.chosen, self.emergency]

    def place(self, plan: Plan, velocity: ArrayLike) -> None:
        """Show the samples of `plan`, made at `velocity` (v, omega); scores are stretched over all colours."""
        points = (plan.samples - np.asarray(velocity, dtype=float))[:, ::-1]
        inner = slice(0, len(points) - 1)
        ok = plan.admissible[inner]
        totals = plan.totals[inner][ok]
        span = float(np.ptp(totals)) if len(totals) else 0.0
        self.scored.set_offsets(points[inner][ok])
        self.scored.set_array((totals - totals.min()) / span if span > 0 else np.full(len(totals), 0.5))
        self.refused.set_data(*points[inner][~ok].T)
        self.chosen.set_data(*points[[plan.chosen]].T)
        self.emergency.set_data(*points[-1:].T)


def window_mark(ax: Axes, robot: Robot, params: Params) -> WindowMark:
    """Empty axes of the window: omega and v, counted from what the robot drives now."""
    wide, high = robot.acc_lim_theta * params.dt, max(robot.acc_lim_x, robot.dec_lim_x) * params.dt
    ax.set(
        xlim=(1.25 * wide, -1.25 * wide),
        ylim=(-1.35 * high, 1.35 * high),
        xlabel=r"$\omega-\omega_c$ [rad/s], left turn to the left",
        ylabel="$v-v_c$ [m/s]",
    )
    scored = ax.scatter(
        [], [], c=[], s=55, marker="s", cmap="cividis", vmin=0.0, vmax=1.0, zorder=3, label="admissible, by score"
    )
    (refused,) = ax.plot([], [], "x", color="#999999", markersize=6, zorder=3, label="refused")
    (emergency,) = ax.plot(
        [], [], "v", color=COLORS["path"], markersize=8, markerfacecolor="none", zorder=4, label="full braking"
    )
    (chosen,) = ax.plot(
        [],
        [],
        "o",
        color=COLORS["goal"],
        markersize=13,
        markerfacecolor="none",
        markeredgewidth=2.2,
        zorder=5,
        label="chosen",
    )
    ax.set_title("squares by score, x refused, circle chosen,\ntriangle full braking", fontsize=9)
    return WindowMark(scored, refused, chosen, emergency)


def draw_window(ax: Axes, plan: Plan, velocity: ArrayLike, robot: Robot, params: Params) -> WindowMark:
    """The velocity window of one decision: admissible samples by score, refused ones, full braking, the choice."""
    mark = window_mark(ax, robot, params)
    mark.place(plan, velocity)
    return mark


def draw_velocity_sets(ax: Axes, observation: Observation, robot: Robot, params: Params, n: int = 61) -> AxesImage:
    """The sets of eq 3.15 in the plane of omega and v: what can be driven, what can stop, what can be reached."""
    v = np.linspace(max(robot.min_vel_x, 0.0), robot.max_vel_x, n)
    omega = np.linspace(-robot.max_vel_theta, robot.max_vel_theta, n)
    samples = np.stack(np.meshgrid(v, omega, indexing="ij"), axis=-1).reshape(-1, 2)
    free = dwa.free_distance(observation.pose, samples, observation.points, robot.radius)
    safe = dwa.admissible(samples, free, robot, params.dt).reshape(n, n)
    half_v, half_w = (v[1] - v[0]) / 2, (omega[1] - omega[0]) / 2
    image = ax.imshow(
        safe,
        origin="lower",
        aspect="auto",
        cmap="Greys_r",
        vmin=-0.6,
        vmax=1.0,
        zorder=1,
        extent=(omega[0] - half_w, omega[-1] + half_w, v[0] - half_v, v[-1] + half_v),
    )
    window = dwa.window(observation.velocity, robot, params)[:-1]
    (v0, w0), (v1, w1) = window.min(axis=0), window.max(axis=0)
    ax.add_patch(Rectangle((w0, v0), w1 - w0, v1 - v0, fill=False, edgecolor=COLORS["path"], linewidth=2, zorder=3))
    ax.plot(*np.asarray(observation.velocity)[::-1], "o", color=COLORS["robot"], zorder=4)
    ax.grid(False)
    ax.set(
        xlabel=r"$\omega$ [rad/s], left turn to the left",
        ylabel="$v$ [m/s]",
        xlim=(omega[-1] + half_w, omega[0] - half_w),
        ylim=(v[0] - half_v, v[-1] + half_v),
    )
    return image


# --- arcs -----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ArcMark:
    """The candidate arcs of one plan on the map; `place` shows another plan."""

    admissible: LineCollection
    refused: LineCollection
    chosen: Line2D
    sim_time: float

    @property
    def artists(self) -> list[Artist]:
        """What a lab redraws."""
        return [self.refused, self.admissible, self.chosen]

    def place(self, plan: Plan, pose: ArrayLike) -> None:
        """Show the arcs of `plan` from `pose`, each over the horizon or to its first contact."""
        lines = _lines(pose, plan, self.sim_time)
        self.admissible.set_segments([line for line, ok in zip(lines, plan.admissible, strict=True) if ok])
        self.refused.set_segments([line for line, ok in zip(lines, plan.admissible, strict=True) if not ok])
        self.chosen.set_data(*lines[plan.chosen].T)


def arc_mark(ax: Axes, sim_time: float) -> ArcMark:
    """Empty arcs for `place`."""
    admissible = LineCollection([], colors=COLORS["reference"], linewidths=0.9, alpha=0.7, zorder=3)
    refused = LineCollection([], colors="#999999", linewidths=0.9, linestyles=":", zorder=3)
    ax.add_collection(admissible)
    ax.add_collection(refused)
    (chosen,) = ax.plot([], [], color=COLORS["goal"], linestyle="-", linewidth=2.6, zorder=4)
    return ArcMark(admissible, refused, chosen, sim_time)


def _lines(pose: ArrayLike, plan: Plan, sim_time: float) -> list[Array]:
    """Polylines `(17, 2)` along each sample's arc, over the horizon or to first contact."""
    speed = np.maximum(np.abs(plan.samples[:, 0]), 1e-9)
    times = np.minimum(sim_time, plan.free / speed)
    shares = np.linspace(0.0, 1.0, 17)
    return [dwa.arcs(pose, plan.samples[[k]], shares * times[k])[0, :, :2] for k in range(len(speed))]


def draw_candidates(ax: Axes, observation: Observation, plan: Plan, robot: Robot, params: Params) -> ArcMark:
    """What the robot sees and the arcs it weighs: admissible, refused (cut at first contact) and chosen."""
    points = np.asarray(observation.points).reshape(-1, 2)
    ax.plot(points[:, 0], points[:, 1], ".", color=COLORS["obstacle"], markersize=4, zorder=3)
    mark = arc_mark(ax, params.sim_time)
    mark.place(plan, observation.pose)
    draw_robot(ax, observation.pose, robot.radius)
    metric_axes(ax)
    return mark


# --- runs -----------------------------------------------------------------------------------------


def draw_run_weights(ax: Axes, run: Run, *, title: str = "") -> list[Line2D]:
    """The three weights over time; a grey floor where no rule fired."""
    styles = (
        ("alpha", r"$\alpha$ heading", "robot", "-"),
        ("beta", r"$\beta$ clearance", "path", "--"),
        ("gamma", r"$\gamma$ speed", "reference", "-."),
    )
    lines = [
        ax.plot(run.t[:-1], run.log[name], color=COLORS[role], linestyle=dash, label=label)[0]
        for name, label, role, dash in styles
    ]
    bare = run.log["uncovered"] > 0
    ax.fill_between(
        run.t[:-1],
        0.0,
        1.0,
        where=bare,
        color=COLORS["unknown"],
        alpha=0.5,
        linewidth=0,
        zorder=0,
        label="no rule fires",
        step="mid",
    )
    ax.set(xlabel="t [s]", ylabel="weight", ylim=(0.0, 1.0), xlim=(0.0, max(run.duration, 1e-9)))
    if title:
        ax.set_title(title)
    ax.legend(loc="upper center", ncols=4)
    return lines


def draw_success(ax: Axes, table: pd.DataFrame, labels: Sequence[str] | None = None) -> list[Artist]:
    """Success rates by method and density with 95 % Wilson intervals."""
    densities = list(dict.fromkeys(table["density"]))
    methods = list(dict.fromkeys(table["method"]))
    made: list[Artist] = []
    for k, density in enumerate(densities):
        rows = table[table["density"] == density]
        rates = [proportion(int(g["success"].sum()), len(g)) for _, g in rows.groupby("method", sort=False)]
        rate, low, high = np.array(rates).T
        y = np.arange(len(methods)) + 0.25 * (k - 1)
        color = (COLORS["accent"], COLORS["robot"], COLORS["obstacle"])[k % 3]
        bars = ax.barh(
            y,
            rate,
            height=0.23,
            color=color,
            xerr=np.maximum([rate - low, high - rate], 0.0),
            error_kw={"elinewidth": 1.0},
            label=f"{100 * float(density):.0f} % blocked",
        )
        made += list(bars)
    ax.set_yticks(range(len(methods)), labels or methods)
    ax.invert_yaxis()
    ax.set(xlabel="share of maps on which the goal was reached", xlim=(0.0, 1.0))
    ax.legend(loc="lower right")
    return made


# --- boxes and arrows -----------------------------------------------------------------------------


def fuzzy_dwa_flowchart(ax: Axes) -> Axes:
    """The steps of one cycle, from the sensed points to the command and back."""
    diagram(ax, 13.0, 5.4)
    size = (2.15, 1.0)
    sense, window, safe, score, best = (
        block(ax, (1.2 + 2.62 * k, 3.1), text, size=size, role=role)
        for k, (text, role) in enumerate(
            (
                ("pose, speed,\nsensed points", ""),
                ("window $V_s, V_d$\n(3.15)", "accent"),
                ("stop in time?\n$V_a$ (3.15)", "accent"),
                ("scores\n(3.18-3.21)", "accent"),
                ("largest $G$\n(3.17)", "accent"),
            )
        )
    )
    fuzzy = block(ax, (6.44, 4.8), "rule base, table 3.2", size=(3.4, 0.9), role="goal")
    brake = block(ax, (6.44, 1.3), "none: brake\non the arc", size=size, role="path")
    drive = block(ax, (11.68, 1.3), "drive for\none step", size=size)
    for a, b in ((sense, window), (window, safe), (safe, score), (score, best)):
        arrow(ax, a.right, b.left)
    arrow(ax, sense.top, fuzzy.left, "heading, distance, speed", bend=-0.3, offset=(-0.75, 0.75))
    arrow(ax, fuzzy.right, best.top, r"$\alpha, \beta, \gamma$", bend=-0.3, offset=(0.9, 0.55))
    arrow(ax, safe.bottom, brake.top)
    arrow(ax, best.bottom, drive.top)
    arrow(ax, brake.right, drive.left)
    x, y = drive.bottom
    ax.plot([x, x, sense.bottom[0]], [y, 0.35, 0.35], color="#333333", linestyle="-", linewidth=1.2)
    arrow(ax, (sense.bottom[0], 0.34), sense.bottom)
    ax.text(6.44, 0.12, "until the goal is within its tolerance", ha="center", va="center", fontsize=8.5)
    return ax


def fuzzy_weight_tuner(ax: Axes) -> Axes:
    """The fuzzy tuner: three readings in, three weights out."""
    diagram(ax, 10.4, 3.9)
    inputs = [
        block(ax, (1.3, y), name, size=(2.0, 0.7))
        for y, name in ((3.2, "headGoal [deg]"), (2.1, "distObs [m]"), (1.0, "velRob [m/s]"))
    ]
    fuzzify = block(ax, (3.9, 2.1), "fuzzify:\n3 terms each", size=(1.7, 1.0), role="accent")
    infer = block(ax, (6.0, 2.1), "inference:\nmin, max", size=(1.6, 1.0), role="accent")
    rules = block(ax, (6.0, 3.4), "9 rules, table 3.2", size=(2.2, 0.7), role="goal")
    centroid = block(ax, (8.0, 2.1), "centroid", size=(1.4, 1.0), role="accent")
    for one in inputs:
        arrow(ax, one.right, fuzzify.left)
    arrow(ax, fuzzify.right, infer.left)
    arrow(ax, rules.bottom, infer.top)
    arrow(ax, infer.right, centroid.left)
    for y, name in ((3.0, r"$\alpha$"), (2.1, r"$\beta$"), (1.2, r"$\gamma$")):
        arrow(ax, centroid.right, (9.7, y))
        ax.text(9.95, y, name, ha="center", va="center", fontsize=11)
    return ax


def fuzzy_dwa_loop(ax: Axes) -> Axes:
    """The closed loop: the planner drives the robot, the map feeds the tuner of its weights."""
    diagram(ax, 10.4, 4.2)
    planner = block(ax, (3.6, 3.0), "dynamic window\napproach", size=(2.4, 1.0), role="accent")
    robot = block(ax, (7.4, 3.0), "robot", size=(1.6, 1.0), role="robot")
    world = block(ax, (7.4, 1.0), "map, sensed points", size=(2.4, 0.9))
    fuzzy = block(ax, (3.6, 1.0), "fuzzy tuner", size=(2.4, 0.9), role="goal")
    arrow(ax, (0.6, 3.0), planner.left, "goal", offset=(0.0, 0.22))
    arrow(ax, planner.right, robot.left, r"$v, \omega$", offset=(0.0, 0.25))
    arrow(ax, robot.bottom, world.top, "pose, speed", offset=(0.85, 0.0))
    arrow(ax, world.left, fuzzy.right, "headGoal,\ndistObs, velRob", offset=(0.05, -0.45))
    arrow(ax, fuzzy.top, planner.bottom, r"$\alpha, \beta, \gamma$", offset=(-0.65, 0.0))
    arrow(ax, world.at(-0.6, 1.0), planner.at(0.7, -1.0), "obstacles", offset=(0.35, 0.3))
    return ax
