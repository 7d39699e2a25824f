"""Pictures of potential fields: obstacles, forces, surfaces, walks, and counts over the exponent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon
from matplotlib.quiver import Quiver
from mpl_toolkits.mplot3d import Axes3D
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array
from fuzzynav.plot.base import COLORS, CYCLE, draw_goal
from fuzzynav.potential import Gains, Walk, force, potential

__all__ = ["draw_counts", "draw_forces", "draw_obstacles", "draw_potential", "draw_walks", "lattice"]

MARKS = ("o", "s", "^", "D", "v")


def lattice(low: ArrayLike, high: ArrayLike, count: int) -> Array:
    """Points `(count, count, 2)` [m] of a square lattice from one corner to the other."""
    a, b = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    xs, ys = (np.linspace(a[k], b[k], count) for k in (0, 1))
    return np.stack(np.meshgrid(xs, ys), axis=-1)


def draw_obstacles(ax: Axes, obstacles: ArrayLike, *, least: float = 0.06) -> PatchCollection:
    """Obstacles as rows x1, y1, x2, y2, radius; a point is drawn with a radius of `least` [m]."""
    shapes: list[Circle | Polygon] = []
    for x1, y1, x2, y2, r in np.asarray(obstacles, dtype=float).reshape(-1, 5):
        size = max(r, least)
        shapes += [Circle((x1, y1), size), Circle((x2, y2), size)]
        along = np.array([x2 - x1, y2 - y1])
        if along.any():
            side = size * np.array([-along[1], along[0]]) / np.hypot(*along)
            ends = np.array([[x1, y1], [x2, y2]])
            shapes.append(Polygon(np.vstack([ends + side, ends[::-1] - side])))
    made = PatchCollection(shapes, facecolor=COLORS["obstacle"], edgecolor="none", zorder=3)
    ax.add_collection(made)
    return made


def draw_forces(
    ax: Axes, points: Array, goal: ArrayLike, obstacles: ArrayLike, gains: Gains, *, radius: float = 0.0
) -> Quiver:
    """Directions of the force at points `(rows, columns, 2)`, all arrows of one length."""
    found = force(points, goal, obstacles, gains, radius)
    size = np.maximum(np.hypot(found[..., 0], found[..., 1]), 1e-12)[..., None]
    unit = found / size
    return ax.quiver(
        points[..., 0], points[..., 1], unit[..., 0], unit[..., 1], color="0.6", pivot="mid", zorder=1, width=0.003
    )


def draw_potential(
    ax: Axes3D, points: Array, goal: ArrayLike, obstacles: ArrayLike, gains: Gains, *, cut: float, title: str = ""
) -> Array:
    """The potential over points `(rows, columns, 2)` as a surface, cut at `cut`; returns the drawn heights."""
    height = np.minimum(potential(points, goal, obstacles, gains), cut)
    ax.plot_surface(points[..., 0], points[..., 1], height, cmap="cividis", linewidth=0, rcount=80, ccount=80)
    ax.set(xlabel="x [m]", ylabel="y [m]", zlabel="U", title=title)
    return height


def draw_walks(ax: Axes, walks: Mapping[str, Walk], goal: ArrayLike, obstacles: ArrayLike) -> list[Line2D]:
    """Walks of several methods over one scene, each with how it ends in the legend."""
    draw_obstacles(ax, obstacles)
    draw_goal(ax, np.asarray(goal, dtype=float))
    lines = []
    for color, dash, (name, walk) in zip(CYCLE, ("-", "--", "-.", ":"), walks.items(), strict=False):
        label = f"{name}: {walk.status.replace('_', ' ')}, {walk.iterations} iterations"
        (line,) = ax.plot(*walk.places.T, color=color, linestyle=dash, linewidth=1.4, label=label, zorder=4)
        ax.plot(*walk.places[-1], "x" if walk.status != "reached" else "o", color=color, zorder=5)
        lines.append(line)
    ax.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), frameon=False)
    return lines


def draw_counts(ax: Axes, exponents: Sequence[float], counts: Mapping[str, ArrayLike]) -> list[Line2D]:
    """Iterations over the exponent n of the distance factor, one line for each name."""
    lines = []
    for color, mark, (name, values) in zip(CYCLE, MARKS, counts.items(), strict=False):
        (line,) = ax.plot(exponents, np.asarray(values, dtype=float), mark + "-", color=color, label=name, markersize=4)
        lines.append(line)
    ax.set(xlabel="exponent $n$", ylabel="iterations")
    ax.legend(loc="upper right")
    return lines
