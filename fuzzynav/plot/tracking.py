"""Pictures of trajectory tracking: the robot in its frames, the loop, paths, errors, speeds and comparisons."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Rectangle
from numpy.typing import ArrayLike

from fuzzynav.geometry import to_world
from fuzzynav.plot.base import COLORS, arrow, block, diagram, draw_path, draw_robot, metric_axes
from fuzzynav.robot import TURTLEBOT2, Robot
from fuzzynav.simulate.record import Run
from fuzzynav.tracking import yaw_rate_unguarded
from fuzzynav.tracking.reference import Reference

__all__ = [
    "draw_flat_loop",
    "draw_poles",
    "draw_reference",
    "draw_rivals",
    "draw_singularity",
    "draw_time_against_error",
    "draw_tracking_errors",
    "draw_tracking_path",
    "draw_tracking_speeds",
    "draw_unicycle",
    "draw_velocity_estimates",
]

BESIDE: dict[str, Any] = {"loc": "center left", "bbox_to_anchor": (1.0, 0.5)}  # a legend that covers no curve


def draw_unicycle(ax: Axes, robot: Robot = TURTLEBOT2) -> tuple[Artist, ...]:
    """The robot with its pose, body frame, wheels, r and L, drawn to scale."""
    pose = np.array([0.32, 0.24, 0.6])
    metric_axes(ax, (-0.05, 0.8, -0.05, 0.62))
    mark = draw_robot(ax, pose, robot.radius, role="unknown")
    mark.disc.set(zorder=1, alpha=0.35)
    mark.heading.set_visible(False)
    for side in (1.0, -1.0):
        corner = to_world(pose, [[-robot.wheel_radius, side * robot.track / 2.0 - 0.012]])[0]
        wheel = Rectangle(
            (corner[0], corner[1]),
            2.0 * robot.wheel_radius,
            0.024,
            angle=float(np.degrees(pose[2])),
            facecolor="black",
            zorder=7,
        )
        ax.add_patch(wheel)
    for tip, name in (((0.3, 0.0), "$X_l$"), ((0.0, 0.24), "$Y_l$")):
        end = to_world(pose, [tip])[0]
        arrow(ax, pose[:2], end)
        ax.text(end[0] + 0.015, end[1] + 0.015, name)
    ax.plot([pose[0], pose[0] + 0.2], [pose[1], pose[1]], color="black", linestyle=":", linewidth=1.0)
    ax.text(pose[0] + 0.14, pose[1] + 0.03, r"$\theta$")
    ax.text(pose[0] - 0.06, pose[1] - 0.035, "$(x, y)$")
    left, right = (to_world(pose, [[-0.11, side * robot.track / 2.0]])[0] for side in (1.0, -1.0))
    (span,) = ax.plot(
        [left[0], right[0]], [left[1], right[1]], color=COLORS["path"], linestyle="-", marker="o", markersize=3
    )
    label = 0.72 * left + 0.28 * right
    ax.text(label[0] - 0.035, label[1] - 0.02, "$L$", color=COLORS["path"])
    size = to_world(pose, [[robot.wheel_radius / 2.0, robot.track / 2.0 + 0.025]])[0]
    ax.text(size[0] - 0.02, size[1] + 0.01, "$2r$", fontsize=8)
    ax.set_title("World frame $X_g, Y_g$ and body frame $X_l, Y_l$")
    return mark.disc, span


def draw_flat_loop(ax: Axes) -> Axes:
    """Block diagram of feedback linearization for a reference: what is computed from what."""
    diagram(ax, 13.0, 4.8)
    size = (2.1, 1.0)
    ref = block(ax, (1.2, 3.2), "reference\n$z_{ref}, u_{ref}$", size=size, role="reference")
    gain = block(ax, (4.3, 3.2), "error gain\n$K(z_{ref}-z)$", size=size)
    comp = block(
        ax, (8.0, 3.2), "compensator\n$\\dot v, \\omega = F^{-1}u$\n$v=\\int\\dot v$", size=(2.4, 1.3), role="accent"
    )
    robot = block(ax, (11.7, 3.2), "robot\n$(x, y, \\theta)$", size=size, role="robot")
    flat = block(ax, (8.0, 0.9), "flat state\n$z=(x,\\dot x,y,\\dot y)$", size=(2.4, 1.0))
    arrow(ax, ref.right, gain.left, "$z_{ref}$")
    arrow(ax, gain.right, (5.92, 3.2))
    arrow(ax, (6.28, 3.2), comp.left, "$u$")
    ax.add_patch(Circle((6.1, 3.2), 0.18, facecolor="white", edgecolor="#333333", zorder=4))
    ax.text(6.1, 3.19, "+", ha="center", va="center", zorder=5)
    arrow(ax, comp.right, robot.left, "$v, \\omega$")
    arrow(ax, (11.7, 2.7), (11.7, 0.9))
    arrow(ax, (11.7, 0.9), flat.right, "$x, y, \\theta$")
    arrow(ax, comp.bottom, flat.top, "$v$", offset=(0.25, 0.0))
    arrow(ax, flat.left, (4.3, 0.9))
    arrow(ax, (4.3, 0.9), gain.bottom, "$z$", offset=(0.25, 0.0))
    arrow(ax, (1.2, 3.7), (1.2, 4.3))
    arrow(ax, (1.2, 4.3), (6.1, 4.3), "$u_{ref}$")
    arrow(ax, (6.1, 4.3), (6.1, 3.38))
    return ax


def draw_reference(ax: Axes, reference: Reference, *, n: int = 801, label: str = "reference") -> Line2D:
    """A reference trajectory as a dashed path."""
    points = reference.sample(np.linspace(0.0, reference.duration, n)).position
    metric_axes(ax)
    return draw_path(ax, points, role="reference", linestyle="--", label=label)


def draw_tracking_path(ax: Axes, run: Run, *, label: str = "driven") -> tuple[Line2D, Line2D]:
    """Reference (broad) and driven path (thin) of a run, its start marked with a disc, the legend beside."""
    metric_axes(ax)
    wanted = draw_path(ax, run.wanted, role="reference", label="reference")
    wanted.set(linewidth=4.0, alpha=0.5)
    driven = draw_path(ax, run.poses, role="path", label=label)
    ax.plot(*run.poses[0, :2], marker="o", color=COLORS["robot"], linestyle="", label="start")
    ax.legend(**BESIDE)
    return wanted, driven


def draw_tracking_errors(ax: Axes, run: Run, *, scale: float = 1e3) -> list[Line2D]:
    """Errors of x, y and theta over time in mm and mrad (scale 1 gives m and rad)."""
    units = ("mm", "mm", "mrad") if scale == 1e3 else ("m", "m", "rad")
    names = ("$x_d - x$", "$y_d - y$", r"$\theta_d - \theta$")
    lines = [
        ax.plot(run.t, scale * e, label=f"{name} [{unit}]")[0]
        for e, name, unit in zip(run.errors.T, names, units, strict=True)
    ]
    ax.set(xlabel="t [s]", ylabel=f"error [{units[0]}, {units[2]}]")
    ax.legend(**BESIDE)
    return lines


def draw_tracking_speeds(ax: Axes, run: Run) -> list[Line2D]:
    """Commands v and omega over time."""
    t = run.t[:-1]
    lines = [
        ax.plot(t, run.commands[:, 0], label="v [m/s]")[0],
        ax.plot(t, run.commands[:, 1], label=r"$\omega$ [rad/s]")[0],
    ]
    ax.set(xlabel="t [s]", ylabel="v [m/s], $\\omega$ [rad/s]")
    ax.legend(**BESIDE)
    return lines


def draw_singularity(ax: Axes, across: Sequence[float] = (0.005, 0.02, 0.05), v_min: float = 0.05) -> list[Line2D]:
    """Yaw rate of eq 5.2 against speed for some sideways demands [m/s^2], and where the guard takes over."""
    v = np.linspace(-0.3, 0.3, 1200)  # an even number of samples: never 0 itself
    lines = []
    for u in across:
        omega = yaw_rate_unguarded(np.tile([0.0, u], (len(v), 1)), 0.0, v)
        shown = np.where(np.abs(omega) > 3.5, np.nan, omega)
        lines.append(ax.plot(v, shown, label=f"$u_2$ = {u:g} m/s²")[0])
    ax.axvspan(-v_min, v_min, color=COLORS["unknown"], alpha=0.4, label=f"|v| < {v_min:g} m/s: guarded")
    ax.set(xlabel="v [m/s]", ylabel=r"$\omega$ [rad/s]", ylim=(-3.2, 3.2))
    ax.legend(loc="upper left")
    return lines


def draw_poles(ax: Axes, poles: ArrayLike, *, label: str = "poles") -> Line2D:
    """Poles [1/s] in the complex plane; the unstable half is shaded."""
    p = np.asarray(poles, dtype=complex).ravel()
    ax.axvspan(0.0, 2.0, color=COLORS["unknown"], alpha=0.4)
    ax.axhline(0.0, color="black", linewidth=0.6)
    (line,) = ax.plot(p.real, p.imag, linestyle="", marker="x", markersize=8, color=COLORS["path"], label=label)
    ax.set(xlabel="real part [1/s]", ylabel="imaginary part [1/s]", xlim=(-4.0, 0.6), ylim=(-2.5, 2.5))
    return line


def draw_rivals(ax: Axes, table: pd.DataFrame, *, unit: str = "mm", scale: float = 1e3) -> AxesImage:
    """A table of errors, methods (rows) by conditions (columns), as numbers on a logarithmic shade."""
    values = scale * table.to_numpy(float)
    image = ax.imshow(np.log10(values), cmap="cividis", aspect="auto")
    middle = float(np.log10(values).mean())
    for (row, column), value in np.ndenumerate(values):
        colour = "white" if np.log10(value) < middle else "black"
        ax.text(column, row, f"{value:.1f}", ha="center", va="center", color=colour, fontsize=8.5)
    ax.set_xticks(range(values.shape[1]), list(table.columns), rotation=20, ha="right")
    ax.set_yticks(range(values.shape[0]), list(table.index))
    ax.grid(False)
    ax.set_title(f"error [{unit}]")
    return image


def draw_time_against_error(ax: Axes, times: Mapping[str, float], errors: Mapping[str, float]) -> list[Line2D]:
    """Error [mm] against compute time of one step [us], one marker for each method; time is logarithmic."""
    lines = []
    for k, (name, marker) in enumerate(zip(times, "osD^vPX*", strict=False)):
        lines += ax.plot(
            [times[name]],
            [errors[name]],
            marker=marker,
            linestyle="",
            markersize=8,
            label=name,
            color=list(COLORS.values())[k % 7],
        )
    ax.set(xscale="log", ylim=(0.0, 1.15 * max(errors.values())), xlabel="time of one step [µs]", ylabel="error [mm]")
    ax.legend(**BESIDE)
    return lines


def draw_velocity_estimates(ax: Axes, table: pd.DataFrame) -> list[Line2D]:
    """Mean tracking error [mm] against position noise [mm], one line for each source of the derivatives."""
    means = table.groupby(["observer", "noise"], sort=False)["rms"].mean().unstack(0)
    lines = [
        ax.plot(1e3 * means.index.to_numpy(), 1e3 * means[name].to_numpy(), marker=marker, label=name)[0]
        for name, marker in zip(means.columns, "os^D", strict=False)
    ]
    ax.set(xscale="log", yscale="log", xlabel="position noise [mm]", ylabel="RMS distance [mm]")
    ax.set_xticks(1e3 * means.index.to_numpy(), [f"{1e3 * n:g}" for n in means.index])
    ax.xaxis.minorticks_off()
    ax.legend(loc="upper left")
    return lines
