"""Pictures of localization and mapping: poses with their doubt, swarms, occupancy grids and the other kinds of map."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.colors import ListedColormap
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d import Axes3D
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array, to_world
from fuzzynav.localization.kalman import Track, ellipse
from fuzzynav.localization.particles import Swarm
from fuzzynav.mapping.occupancy import OccupancyGrid
from fuzzynav.maps.kinds import Places
from fuzzynav.plot.base import COLORS, CYCLE, arrow, block, diagram, draw_robot, metric_axes

__all__ = [
    "draw_ellipses",
    "draw_nees",
    "draw_occupancy",
    "draw_outline",
    "draw_places",
    "draw_regions",
    "draw_rings",
    "draw_swarm",
    "draw_voxels",
    "ellipse_lines",
    "filter_cycle",
    "place_swarm",
    "pose_frame",
]


def pose_frame(ax: Axes, pose: ArrayLike, radius: float = 0.4) -> None:
    """The left half of figure 1.9: a robot's frame in the reference frame, with x, y and theta marked."""
    x, y, theta = (float(v) for v in np.asarray(pose, dtype=float))
    metric_axes(ax, (-0.6, x + 2.2, -0.6, y + 2.2))
    for base, length, names in (((0.0, 0.0, 0.0), 1.2, ("X", "Y")), ((x, y, theta), 1.1, ("x ahead", "y left"))):
        for k, name in enumerate(names):
            tip = to_world(base, [[length, 0.0] if k == 0 else [0.0, length]])[0]
            arrow(ax, base[:2], tip)
            ax.annotate(name, tip, textcoords="offset points", xytext=(5, 3), fontsize=9)
    draw_robot(ax, pose, radius)
    ax.plot([x, x, 0.0], [0.0, y, y], color="#777777", linestyle=":", linewidth=1.0)
    ax.text(x + 0.08, 0.15, f"x = {x:.1f} m", fontsize=9)
    ax.text(0.06, y + 0.1, f"y = {y:.1f} m", fontsize=9)
    sweep = np.linspace(0.0, theta, 30)
    ax.plot([x, x + 1.6], [y, y], color="#777777", linestyle=":", linewidth=1.0)
    ax.plot(x + 0.8 * np.cos(sweep), y + 0.8 * np.sin(sweep), color=COLORS["path"], linestyle="-")
    ax.text(x + 0.95, y + 0.15, f"$\\theta$ = {np.rad2deg(theta):.0f} deg", fontsize=9)


def filter_cycle(ax: Axes) -> None:
    """The right half of figure 1.9: odometry predicts, sensors and map correct, and the belief goes round."""
    diagram(ax, 10.0, 6.0)
    wheels = block(ax, (1.6, 4.8), "odometry\n(encoders)")
    sensors = block(ax, (1.6, 1.2), "scan, beacons,\nGPS, camera", size=(2.6, 0.9))
    predict = block(ax, (5.0, 4.8), "predict", role="robot")
    correct = block(ax, (5.0, 1.2), "correct", role="path")
    known = block(ax, (8.5, 1.2), "map")
    belief = block(ax, (8.5, 4.8), "pose and\nits doubt", role="reference")
    arrow(ax, wheels.right, predict.left)
    arrow(ax, sensors.right, correct.left)
    arrow(ax, known.left, correct.right)
    arrow(ax, predict.bottom, correct.top, "doubt grew", offset=(-0.9, 0.0))
    arrow(ax, correct.at(0.7, 1.0), belief.at(-1.0, -0.6), "doubt shrank", offset=(1.3, -0.35))
    arrow(ax, belief.left, predict.right)


def ellipse_lines(track: Track, every: int = 10, probability: float = 0.95) -> list[Array]:
    """Closed lines `(n, 2)` [m] round the positions of every so many beliefs, the last one among them."""
    picks = range(len(track.means) - 1, -1, -every)
    return [ellipse(track.means[k], track.covariances[k], probability, 37) for k in picks]


def draw_ellipses(ax: Axes, track: Track, *, every: int = 10, role: str = "path") -> LineCollection:
    """Ellipses that hold 95 % of the positions, for every so many beliefs of a track."""
    lines = LineCollection(ellipse_lines(track, every), colors=COLORS[role], linewidths=1.0, zorder=5)
    ax.add_collection(lines, autolim=False)
    return lines


def draw_nees(ax: Axes, values: ArrayLike, bounds: tuple[float, float], *, label: str = "") -> Line2D:
    """NEES over the steps, on a log scale, with the interval in which an honest filter stays 95 % of the time."""
    y = np.asarray(values, dtype=float)
    ax.axhspan(*bounds, color=COLORS["reference"], alpha=0.15, label="95 % of an honest filter")
    ax.axhline(3.0, color=COLORS["reference"], linestyle="--", linewidth=1.0)
    (line,) = ax.plot(np.arange(len(y)), y, color=COLORS["path"], linestyle="-", label=label or None)
    ax.set(yscale="log", xlabel="step", ylabel="NEES [-]", ylim=(0.03, 300.0))
    return line


def draw_swarm(ax: Axes, swarm: Swarm, *, role: str = "accent") -> PathCollection:
    """The particles of a swarm as dots."""
    return ax.scatter(swarm.poses[:, 0], swarm.poses[:, 1], s=4, color=COLORS[role], linewidths=0, zorder=4)


def place_swarm(dots: PathCollection, swarm: Swarm) -> None:
    """Move the dots of `draw_swarm` to another swarm."""
    dots.set_offsets(swarm.poses[:, :2])


def draw_occupancy(ax: Axes, grid: OccupancyGrid) -> AxesImage:
    """The chance of occupation in grey: white free, black occupied, middle grey not known."""
    rows, cols = grid.log_odds.shape
    x, y = grid.origin
    extent = (x, x + cols * grid.resolution, y, y + rows * grid.resolution)
    image = ax.imshow(
        grid.probability,
        cmap="gray_r",
        vmin=0.0,
        vmax=1.0,
        origin="lower",
        extent=extent,
        interpolation="nearest",
        zorder=1,
    )
    ax.grid(False)
    metric_axes(ax, extent)
    return image


def draw_outline(ax: Axes, lines: ArrayLike, *, role: str = "obstacle") -> LineCollection:
    """A metric map: wall faces `(n, 2, 2)` [m]."""
    walls = LineCollection(list(np.asarray(lines, dtype=float)), colors=COLORS[role], linewidths=1.6, zorder=3)
    ax.add_collection(walls)
    ax.autoscale_view()
    return walls


def draw_places(ax: Axes, found: Places, names: Sequence[str]) -> list[Artist]:
    """A topological map: places as named nodes, passages as edges through their doors."""
    artists: list[Artist] = []
    for (a, b), door in zip(found.passages, found.doors, strict=True):
        way = np.stack([found.centers[a], door, found.centers[b]])
        artists += ax.plot(way[:, 0], way[:, 1], color="#777777", linestyle="-", linewidth=1.4, zorder=2)
        artists += ax.plot(*door, marker="s", linestyle="", color=COLORS["mover"], markersize=5, zorder=3)
    for center, name in zip(found.centers, names, strict=True):
        artists += ax.plot(*center, marker="o", linestyle="", color=COLORS["robot"], markersize=9, zorder=4)
        artists.append(ax.annotate(name, center, textcoords="offset points", xytext=(8, 5), fontsize=9, zorder=5))
    return artists


def draw_regions(ax: Axes, found: Places, names: Sequence[str], extent: tuple[float, float, float, float]) -> AxesImage:
    """A semantic map: each place in its colour with its name; extent is that of the grid [m]."""
    tints = ["#FFFFFF", *(CYCLE[k % len(CYCLE)] + "55" for k in range(len(names)))]
    image = ax.imshow(
        found.labels,
        cmap=ListedColormap(tints),
        vmin=-0.5,
        vmax=len(names) + 0.5,
        origin="lower",
        extent=extent,
        interpolation="nearest",
        zorder=1,
    )
    for center, name in zip(found.centers, names, strict=True):
        ax.text(float(center[0]), float(center[1]), name, ha="center", va="center", fontsize=9, zorder=5)
    ax.grid(False)
    metric_axes(ax, extent)
    return image


def draw_rings(ax: Axes, anchors: ArrayLike, ranges: ArrayLike) -> list[Line2D]:
    """Circles of measured distance `(n,)` [m] round known anchors `(n, 2)` [m]."""
    t = np.linspace(0.0, 2.0 * np.pi, 181)
    out = []
    for (x, y), r in zip(np.asarray(anchors, dtype=float), np.asarray(ranges, dtype=float), strict=True):
        out += ax.plot(x + r * np.cos(t), y + r * np.sin(t), color=COLORS["accent"], linestyle="-", linewidth=1.0)
        ax.plot(x, y, marker="^", linestyle="", color=COLORS["goal"], markersize=8)
    return out


def draw_voxels(ax: Axes3D, cells: ArrayLike, size: float) -> None:
    """Cells `(n, 3)` of a map in three dimensions on 3-D axes, coloured by height."""
    centres = (np.asarray(cells, dtype=float) + 0.5) * size
    dots = ax.scatter(
        centres[:, 0],
        centres[:, 1],
        zs=centres[:, 2],
        c=centres[:, 2],
        marker="s",
        s=9,
        cmap="cividis",
        depthshade=False,
    )
    ax.figure.colorbar(dots, ax=ax, label="z [m]", shrink=0.6, pad=0.1)
    ax.set(xlabel="x [m]", ylabel="y [m]", zlabel="")
    ax.set_box_aspect(np.ptp(centres, axis=0) + size)
