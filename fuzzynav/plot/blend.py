"""Pictures of tracking blended with avoidance: the schemes as boxes, the weight F, runs past a block, the study."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon
from numpy.typing import ArrayLike

from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.geometry import Array, to_world
from fuzzynav.plot.base import COLORS, arrow, block, diagram, draw_path, metric_axes
from fuzzynav.robot import TURTLEBOT2
from fuzzynav.simulate.record import Run

__all__ = [
    "block_corners",
    "draw_blend_design",
    "draw_blend_errors",
    "draw_blend_flowchart",
    "draw_blend_framework",
    "draw_blend_path",
    "draw_blend_speeds",
    "draw_block",
    "draw_block_map",
    "draw_gate",
    "draw_schemes",
    "draw_weight",
    "shade_avoidance",
    "weight_surface",
]


def block_corners(shape: ArrayLike) -> Array:
    """Corners `(4, 2)` [m] of a block x, y, width, height, theta."""
    x, y, width, height, theta = np.asarray(shape, dtype=float)
    corners = 0.5 * np.array([[-width, -height], [width, -height], [width, height], [-width, height]])
    return to_world(np.array([x, y, theta]), corners)


def draw_block(ax: Axes, shape: ArrayLike, *, label: str = "") -> Polygon:
    """A block x, y, width, height, theta [m, rad] in plan."""
    patch = Polygon(block_corners(shape), closed=True, facecolor=COLORS["obstacle"], edgecolor="black", zorder=3)
    if label:
        patch.set_label(label)
    ax.add_patch(patch)
    return patch


def draw_blend_path(ax: Axes, run: Run, shape: ArrayLike, *, label: str = "driven") -> tuple[Line2D, Line2D]:
    """Reference (dashed), driven path, the stretch with avoidance thick, the block, and a cross at a contact."""
    metric_axes(ax)
    draw_path(ax, run.wanted, role="reference", linestyle="--", label="reference")
    driven = draw_path(ax, run.poses, role="path", label=label)
    points = np.where(run.log["weight"][:, None] > 0.0, run.poses[:-1, :2], np.nan)
    part = draw_path(ax, points, role="robot", label="avoidance takes part")
    part.set(linewidth=3.0, alpha=0.7)
    draw_block(ax, shape, label="block")
    if run.status == "collided":
        x, y = run.poses[-1, :2]
        ax.add_patch(Circle((x, y), TURTLEBOT2.radius, fill=False, edgecolor=COLORS["path"], linewidth=1.5, zorder=6))
        ax.plot([x], [y], marker="x", markersize=9, color="black", linestyle="", zorder=7, label="contact")
    return driven, part


def shade_avoidance(ax: Axes, run: Run, *, label: str = "avoidance takes part") -> None:
    """A grey band over the times at which avoidance has a part in the command."""
    active = np.flatnonzero(np.diff(np.concatenate([[0], (run.log["weight"] > 0.0).astype(int), [0]])))
    for k, (a, b) in enumerate(zip(active[::2], active[1::2], strict=True)):
        ax.axvspan(run.t[a], run.t[b], color=COLORS["unknown"], alpha=0.5, linewidth=0, label=label if k == 0 else "")


def _legend_above(ax: Axes) -> None:
    """A legend in room made for it above the curves."""
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.35 * (high - low))
    ax.legend(loc="upper center", ncols=2, fontsize=7.5, columnspacing=1.0)


def draw_blend_errors(ax: Axes, run: Run) -> list[Line2D]:
    """Errors of x, y [m] and theta [rad] over time, the time of avoidance shaded."""
    shade_avoidance(ax, run)
    names = ("$x_d - x$ [m]", "$y_d - y$ [m]", r"$\theta_d - \theta$ [rad]")
    lines = [ax.plot(run.t, e, label=name)[0] for e, name in zip(run.errors.T, names, strict=True)]
    ax.set(xlabel="t [s]", ylabel="error [m, rad]")
    _legend_above(ax)
    return lines


def draw_blend_speeds(ax: Axes, run: Run) -> list[Line2D]:
    """Commands v and omega over time, the time of avoidance shaded."""
    shade_avoidance(ax, run)
    lines = [
        ax.plot(run.t[:-1], run.commands[:, 0], label="v [m/s]")[0],
        ax.plot(run.t[:-1], run.commands[:, 1], label=r"$\omega$ [rad/s]")[0],
    ]
    ax.set(xlabel="t [s]", ylabel="v [m/s], $\\omega$ [rad/s]")
    _legend_above(ax)
    return lines


def draw_weight(ax: Axes, run: Run) -> list[Line2D]:
    """F and the share of avoidance in the command over time."""
    lines = [ax.plot(run.t[:-1], run.log["F"], label="F")[0], ax.plot(run.t[:-1], run.log["weight"], label="share")[0]]
    ax.set(xlabel="t [s]", ylabel="F, share", ylim=(-0.03, 1.05))
    ax.legend(loc="upper right", fontsize=8)
    return lines


def weight_surface(system: FuzzySystem, n: tuple[int, int] = (41, 61)) -> Array:
    """F over distance 0 to 2 m (rows) and bearing -4 to 4 rad (columns)."""
    d, b = np.meshgrid(np.linspace(0.0, 2.0, n[0]), np.linspace(-4.0, 4.0, n[1]), indexing="ij")
    return np.asarray(system(d, b)[0])


def draw_gate(ax: Axes, surface: Array, *, gate: float = np.pi / 4.0, d0: float = 0.7) -> AxesImage:
    """F as a picture over bearing and distance, with the gate of the printed scheme as a white frame."""
    image = ax.imshow(
        surface, origin="lower", extent=(-4.0, 4.0, 0.0, 2.0), aspect="auto", vmin=0.0, vmax=1.0, cmap="cividis"
    )
    ax.plot([-gate, -gate, gate, gate], [0.0, d0, d0, 0.0], color="white", linestyle="-", linewidth=1.5)
    ax.set(xlabel=r"bearing $\theta_{obs}$ [rad]", ylabel="distance [m]", xlim=(-4, 4), ylim=(0, 2))
    ax.grid(False)
    return image


def draw_schemes(ax: Axes, table: pd.DataFrame) -> None:
    """Of each scheme: share of runs that end back on the reference, without contact, and share with a contact."""
    runs = table["runs"].to_numpy(float)
    names, y = list(table.index), np.arange(len(table))[::-1]
    back, hit = 100 * table["back"].to_numpy() / runs, 100 * table["collided"].to_numpy() / runs
    ax.barh(y, back, color=COLORS["reference"], label="no contact, back on the reference")
    ax.barh(y, hit, left=100 - hit, color=COLORS["path"], hatch="//", edgecolor="white", label="contact")
    for place, value in zip(y, back, strict=True):
        ax.text(101.5, place, f"{value:.1f}", va="center", fontsize=9)
    ax.set_yticks(y, names)
    ax.set(xlabel="share of runs [%]", xlim=(0, 112))
    ax.legend(loc="upper center", bbox_to_anchor=(0.4, -0.22), ncols=2, fontsize=8.5)


def draw_block_map(ax: Axes, blocks: ArrayLike, hit: ArrayLike, curve: ArrayLike) -> None:
    """Block positions of a study on the curve: a cross where the robot touched the block, a dot where it did not."""
    places, touched = np.asarray(blocks, dtype=float), np.asarray(hit, dtype=bool)
    metric_axes(ax)
    draw_path(ax, curve, role="reference", linestyle="--")
    for mask, role, marker, name in ((touched, "path", "x", "contact"), (~touched, "robot", "o", "no contact")):
        if mask.any():
            ax.plot(*places[mask, :2].T, linestyle="", marker=marker, markersize=4, color=COLORS[role], label=name)


def draw_blend_framework(ax: Axes) -> Axes:
    """The control framework inside ROS: tracking, avoidance and the fuzzy fusion between sensors and wheels."""
    diagram(ax, 13.0, 6.2)
    size = (2.5, 1.0)
    reference = block(ax, (1.5, 5.0), "reference\n(eq 5.11)", size=size, role="reference")
    dfl = block(ax, (5.2, 5.0), "tracking: DFL\n(eq 5.1, 5.2)", size=size, role="accent")
    avoid = block(ax, (5.2, 3.2), "avoidance\n(eq 5.5)", size=size, role="accent")
    fuzzy = block(ax, (5.2, 1.4), "fuzzy weight\n(table 5.1)", size=size, role="accent")
    fusion = block(ax, (9.0, 3.2), "fusion\n(eq 5.6)", size=size, role="free")
    robot = block(ax, (11.8, 1.4), "robot\n/cmd_vel, /odom", size=(2.2, 1.0), role="robot")
    sensor = block(ax, (1.5, 1.4), "range sensor\n/scan", size=size, role="obstacle")
    arrow(ax, reference.right, dfl.left)
    arrow(ax, dfl.right, fusion.top, "$v_t, \\omega_t$", offset=(0.55, 0.25))
    arrow(ax, avoid.right, fusion.left, "$v_a, \\omega_a$", offset=(0.0, 0.28))
    arrow(ax, fuzzy.right, fusion.bottom, "F", offset=(0.4, -0.1))
    arrow(ax, sensor.right, fuzzy.left)
    arrow(ax, sensor.top, avoid.left, "$d, \\theta_o$", offset=(-0.4, 0.2))
    arrow(ax, fusion.right, robot.top, "$v, \\omega$", offset=(0.3, 0.3))
    ax.plot([11.8, 11.8, 3.4, 3.4], [0.9, 0.35, 0.35, 4.6], color="#333333", linestyle="-", linewidth=1.2, zorder=1)
    arrow(ax, (3.4, 4.6), (3.95, 4.75))
    ax.text(8.0, 0.45, "pose", ha="center", fontsize=8.5)
    return ax


def draw_blend_design(ax: Axes) -> Axes:
    """The fuzzy controller of the blend: two inputs, six rules, one output."""
    diagram(ax, 13.0, 3.2)
    size = (2.3, 1.2)
    first = block(ax, (3.6, 1.6), "fuzzification\n2 + 3 terms", size=size, role="accent")
    rules = block(ax, (6.7, 1.6), "six rules\n(table 5.1), min", size=size, role="accent")
    last = block(ax, (9.8, 1.6), "centroid of\nLittle, More, Lots", size=size, role="accent")
    for y, name in ((2.0, "distance $d$"), (1.2, r"bearing $\theta_o$")):
        arrow(ax, (1.2, y), (2.45, y))
        ax.text(1.1, y, name, ha="right", va="center", fontsize=9)
    arrow(ax, first.right, rules.left)
    arrow(ax, rules.right, last.left)
    arrow(ax, last.right, (12.2, 1.6))
    ax.text(12.3, 1.6, "F", va="center", fontsize=10)
    ax.set_xlim(-0.8, 13.0)
    return ax


def draw_blend_flowchart(ax: Axes) -> Axes:
    """The loop of the printed controller, one pass per control step."""
    diagram(ax, 12.0, 6.4)
    start = block(ax, (2.2, 5.6), "read pose and scan", size=(3.0, 0.8), role="obstacle")
    dfl = block(ax, (2.2, 4.1), "DFL: $v_t, \\omega_t$", size=(3.0, 0.8), role="accent")
    ask = block(ax, (2.2, 2.6), "$d \\leq d_0$ and\n$|\\theta_o| \\leq 45°$ ?", size=(3.0, 1.0), role="free")
    track = block(ax, (2.2, 0.7), "F = 0", size=(2.0, 0.8))
    avoid = block(ax, (6.4, 2.6), "eq 5.5: $\\omega_a$\ntable 5.1: F", size=(2.6, 1.0), role="accent")
    fuse = block(ax, (6.4, 0.7), "eq 5.6: $v, \\omega$", size=(2.6, 0.8), role="accent")
    send = block(ax, (10.2, 0.7), "send to wheels", size=(2.4, 0.8), role="robot")
    arrow(ax, start.bottom, dfl.top)
    arrow(ax, dfl.bottom, ask.top)
    arrow(ax, ask.right, avoid.left, "yes")
    arrow(ax, ask.bottom, track.top, "no", offset=(0.3, 0.0))
    arrow(ax, avoid.bottom, fuse.top)
    arrow(ax, track.right, fuse.left)
    arrow(ax, fuse.right, send.left)
    ax.plot([10.2, 10.2], [1.1, 5.6], color="#333333", linestyle="-", linewidth=1.2)
    arrow(ax, (10.2, 5.6), start.right, "next step, 0.1 s later", offset=(0.0, 0.22))
    return ax
