"""What every picture of the course shares: style, colours, robots, paths, maps and boxes.

Functions take the axes first and return the artists they made, so that a lab can move them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from cycler import cycler
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.colors import ListedColormap
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch, FancyBboxPatch
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array

if TYPE_CHECKING:
    from fuzzynav.maps.gridmap import GridMap

__all__ = [
    "COLORS",
    "CYCLE",
    "Block",
    "RobotMark",
    "arrow",
    "block",
    "diagram",
    "draw_discs",
    "draw_goal",
    "draw_grid",
    "draw_path",
    "draw_robot",
    "metric_axes",
    "style",
]

COLORS: dict[str, str] = {
    "robot": "#0072B2",
    "path": "#D55E00",
    "reference": "#009E73",
    "obstacle": "#4D4D4D",
    "mover": "#E69F00",
    "goal": "#CC79A7",
    "accent": "#56B4E9",
    "free": "#F0E442",
    "unknown": "#BBBBBB",
}
CYCLE: tuple[str, ...] = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#4D4D4D")
DPI = 90


def style() -> None:
    """Set the course's look for all figures drawn after this call.

    The line cycle changes colour and dash together, so that curves stay apart in grey.
    """
    dashes = ["-", "--", "-.", ":", "-", "--", "-."]
    mpl.rcParams.update(
        {
            "figure.dpi": DPI,
            "savefig.dpi": "figure",
            "figure.figsize": (6.4, 3.8),
            "figure.constrained_layout.use": True,
            "figure.constrained_layout.w_pad": 0.08,
            "font.size": 10.0,
            "axes.titlesize": 10.5,
            "axes.labelsize": 10.0,
            "xtick.labelsize": 9.0,
            "ytick.labelsize": 9.0,
            "legend.fontsize": 9.0,
            "legend.framealpha": 0.9,
            "axes.prop_cycle": cycler(color=list(CYCLE)) + cycler(linestyle=dashes),
            "axes.spines.top": False,
            "axes.spines.right": False,
            "axes.grid": True,
            "axes.axisbelow": True,
            "grid.color": "#DDDDDD",
            "grid.linewidth": 0.6,
            "lines.linewidth": 1.6,
            "image.cmap": "cividis",
            "image.interpolation": "nearest",
        }
    )


def metric_axes(ax: Axes, bounds: Sequence[float] | None = None, *, title: str = "") -> Axes:
    """Axes for a plan view: equal scales, x [m] and y [m]; bounds are xmin, xmax, ymin, ymax [m]."""
    ax.set_aspect("equal", adjustable="box")
    ax.set(xlabel="x [m]", ylabel="y [m]")
    if bounds is not None:
        ax.set(xlim=(bounds[0], bounds[1]), ylim=(bounds[2], bounds[3]))
    if title:
        ax.set_title(title)
    return ax


@dataclass(frozen=True, slots=True)
class RobotMark:
    """The drawing of one robot, a disc of its true size and a line for its heading."""

    disc: Circle
    heading: Line2D

    @property
    def artists(self) -> tuple[Artist, Artist]:
        """The two artists, for a lab's list of what changed."""
        return self.disc, self.heading

    def place(self, pose: ArrayLike) -> None:
        """Move the drawing to `pose` x [m], y [m], theta [rad]."""
        x, y, theta = np.asarray(pose, dtype=float)
        self.disc.center = (float(x), float(y))
        r = self.disc.get_radius()
        self.heading.set_data([x, x + r * np.cos(theta)], [y, y + r * np.sin(theta)])


def draw_robot(ax: Axes, pose: ArrayLike, radius: float, *, role: str = "robot", label: str = "") -> RobotMark:
    """A robot of radius [m] at `pose`, drawn to scale; `place` of the returned mark moves it."""
    disc = Circle((0.0, 0.0), radius, facecolor=COLORS[role], edgecolor="black", linewidth=0.8, alpha=0.8, zorder=5)
    if label:
        disc.set_label(label)
    ax.add_patch(disc)
    (heading,) = ax.plot([], [], color="white", linestyle="-", linewidth=1.6, zorder=6)
    mark = RobotMark(disc, heading)
    mark.place(pose)
    return mark


def draw_path(
    ax: Axes, points: ArrayLike, *, role: str = "path", label: str = "", linestyle: str = "-", marker: str = ""
) -> Line2D:
    """A polyline `(n, 2)` or the track of poses `(n, 3)` [m]; an empty one may be filled by set_data."""
    xy = np.asarray(points, dtype=float)
    xy = xy.reshape(0, 2) if xy.size == 0 else xy
    (line,) = ax.plot(
        xy[:, 0], xy[:, 1], color=COLORS[role], linestyle=linestyle, marker=marker, markersize=3.5, zorder=4
    )
    if label:
        line.set_label(label)
    return line


def draw_goal(ax: Axes, point: ArrayLike, *, tolerance: float | None = None) -> tuple[Artist, ...]:
    """A star at the goal `(2,)` [m], with the circle of its tolerance [m] where one is given."""
    x, y = np.asarray(point, dtype=float)
    (star,) = ax.plot(
        [x],
        [y],
        linestyle="",
        marker="*",
        markersize=13,
        color=COLORS["goal"],
        markeredgecolor="black",
        markeredgewidth=0.6,
        zorder=6,
    )
    if tolerance is None:
        return (star,)
    ring = ax.add_patch(Circle((x, y), tolerance, fill=False, linestyle="--", edgecolor=COLORS["goal"], zorder=5))
    return star, ring


def draw_grid(ax: Axes, gridmap: GridMap, *, lines: bool = False) -> AxesImage:
    """The occupied cells of a map in the obstacle colour, to scale; `lines` draws the cell borders."""
    rows, cols = gridmap.occupied.shape
    x0, y0 = gridmap.origin
    extent = (x0, x0 + cols * gridmap.resolution, y0, y0 + rows * gridmap.resolution)
    image = ax.imshow(
        gridmap.occupied,
        cmap=ListedColormap(["white", COLORS["obstacle"]]),
        vmin=0,
        vmax=1,
        origin="lower",
        extent=extent,
        interpolation="nearest",
        zorder=1,
    )
    ax.grid(False)
    if lines:
        for x in np.linspace(extent[0], extent[1], cols + 1):
            ax.axvline(float(x), color="#CCCCCC", linewidth=0.4, zorder=2)
        for y in np.linspace(extent[2], extent[3], rows + 1):
            ax.axhline(float(y), color="#CCCCCC", linewidth=0.4, zorder=2)
    metric_axes(ax, extent)
    return image


def draw_discs(ax: Axes, discs: ArrayLike, *, role: str = "obstacle") -> PatchCollection:
    """Discs `(n, 3)` of x, y, radius [m], to scale."""
    circles = [Circle((x, y), r) for x, y, r in np.asarray(discs, dtype=float).reshape(-1, 3)]
    collection = PatchCollection(circles, facecolor=COLORS[role], edgecolor="black", linewidth=0.6, zorder=2)
    ax.add_collection(collection)
    return collection


@dataclass(frozen=True, slots=True)
class Block:
    """A box of a block diagram; the anchors are points `(2,)` for arrows to start and end at."""

    center: Array
    size: tuple[float, float]
    patch: FancyBboxPatch

    def at(self, right: float, up: float) -> Array:
        """The point at these fractions of half the width and half the height from the centre."""
        return self.center + np.array([right * self.size[0], up * self.size[1]]) / 2.0

    @property
    def left(self) -> Array:
        """Middle of the left side."""
        return self.at(-1.0, 0.0)

    @property
    def right(self) -> Array:
        """Middle of the right side."""
        return self.at(1.0, 0.0)

    @property
    def top(self) -> Array:
        """Middle of the upper side."""
        return self.at(0.0, 1.0)

    @property
    def bottom(self) -> Array:
        """Middle of the lower side."""
        return self.at(0.0, -1.0)


def diagram(ax: Axes, width: float, height: float) -> Axes:
    """Empty axes for boxes and arrows, `width` by `height` units with equal scales."""
    ax.set(xlim=(0.0, width), ylim=(0.0, height))
    ax.set_aspect("equal")
    ax.axis("off")
    return ax


def block(
    ax: Axes,
    center: ArrayLike,
    text: str,
    *,
    size: tuple[float, float] = (2.0, 0.9),
    role: str = "",
    fontsize: float = 9.0,
) -> Block:
    """A box with text, `size` (width, height) in axes units; `role` tints it with that colour."""
    c = np.asarray(center, dtype=float)
    face = COLORS[role] + "40" if role else "#F4F4F4"
    patch = FancyBboxPatch(
        (c[0] - size[0] / 2, c[1] - size[1] / 2),
        *size,
        boxstyle="round,pad=0,rounding_size=0.12",
        facecolor=face,
        edgecolor=COLORS[role] if role else "#333333",
        linewidth=1.2,
        zorder=3,
    )
    ax.add_patch(patch)
    ax.text(c[0], c[1], text, ha="center", va="center", fontsize=fontsize, zorder=4)
    return Block(c, size, patch)


def arrow(
    ax: Axes,
    start: ArrayLike,
    end: ArrayLike,
    text: str = "",
    *,
    bend: float = 0.0,
    linestyle: str = "-",
    offset: tuple[float, float] = (0.0, 0.15),
) -> FancyArrowPatch:
    """An arrow between two points `(2,)`, with text beside its middle; `bend` curves it to the right."""
    a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    patch = FancyArrowPatch(
        (a[0], a[1]),
        (b[0], b[1]),
        arrowstyle="-|>",
        mutation_scale=12,
        color="#333333",
        linewidth=1.2,
        linestyle=linestyle,
        shrinkA=0,
        shrinkB=0,
        zorder=2,
        connectionstyle=f"arc3,rad={bend}",
    )
    ax.add_patch(patch)
    if text:
        middle = (a + b) / 2.0 + offset
        ax.text(middle[0], middle[1], text, ha="center", va="center", fontsize=8.5, zorder=5)
    return patch
