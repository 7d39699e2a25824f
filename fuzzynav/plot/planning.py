"""Pictures of global planning: searches on a grid, steps and sectors, removed nodes, curves, and the study's spread."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.colors import ListedColormap
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array, cumulative_length
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import heuristics
from fuzzynav.planning.astar import SearchResult
from fuzzynav.planning.sampling import Sampled
from fuzzynav.plot.base import COLORS, CYCLE, arrow, block, diagram, draw_goal, draw_grid, draw_path
from fuzzynav.smoothing.splines import Spline

__all__ = [
    "draw_cells",
    "draw_compass",
    "draw_curvature",
    "draw_eta_family",
    "draw_heuristics",
    "draw_neighbours",
    "draw_nodes",
    "draw_planner_tree",
    "draw_printed_basis",
    "draw_removal",
    "draw_sampled",
    "draw_search",
    "draw_spline",
    "draw_start",
    "draw_study",
    "order_image",
]


def draw_start(ax: Axes, point: ArrayLike) -> Line2D:
    """A triangle at the start `(2,)` [m]."""
    x, y = np.asarray(point, dtype=float)
    (mark,) = ax.plot(
        [x],
        [y],
        linestyle="",
        marker="^",
        markersize=10,
        color=COLORS["robot"],
        markeredgecolor="black",
        markeredgewidth=0.6,
        zorder=6,
    )
    return mark


def draw_cells(
    ax: Axes, grid: GridMap, cells: ArrayLike, *, role: str = "accent", alpha: float = 0.45, inset: float = 0.06
) -> PatchCollection:
    """Cells `(n, 2)` x, y as tinted squares, a share `inset` smaller than a cell on each side."""
    corners = np.asarray(cells, dtype=float).reshape(-1, 2) * grid.resolution + grid.origin
    side, edge = grid.resolution * (1.0 - 2.0 * inset), grid.resolution * inset
    squares = [Rectangle((x + edge, y + edge), side, side) for x, y in corners]
    collection = PatchCollection(squares, facecolor=COLORS[role], edgecolor="none", alpha=alpha, zorder=2)
    ax.add_collection(collection)
    return collection


def draw_search(ax: Axes, grid: GridMap, result: SearchResult, *, title: str = "", path: bool = True) -> list[Artist]:
    """The map, the cells that a search expanded, its path, start and goal."""
    artists: list[Artist] = [draw_grid(ax, grid, lines=max(grid.shape) <= 40)]
    if result.searched:
        artists.append(draw_cells(ax, grid, result.expanded))
        artists.append(draw_start(ax, grid.center_of(result.expanded[0])))
    if len(result.cells):
        if path:
            artists.append(draw_path(ax, grid.center_of(result.cells), marker="."))
        artists += draw_goal(ax, grid.center_of(result.cells[-1]))
    if title:
        ax.set_title(title)
    return artists


def draw_nodes(ax: Axes, points: ArrayLike, *, role: str = "mover", label: str = "") -> Line2D:
    """Kept nodes `(n, 2)` [m] as squares."""
    p = np.asarray(points, dtype=float)
    (marks,) = ax.plot(
        p[:, 0],
        p[:, 1],
        linestyle="",
        marker="s",
        markersize=6,
        color=COLORS[role],
        markeredgecolor="black",
        markeredgewidth=0.6,
        zorder=5,
        label=label or None,
    )
    return marks


def order_image(ax: Axes, grid: GridMap, result: SearchResult) -> AxesImage:
    """An image whose value in a cell is the number of its expansion; set_clim(0, n) shows the first n."""
    order = np.full(grid.shape, np.nan)
    cells = result.expanded[::-1]
    order[cells[:, 1], cells[:, 0]] = np.arange(len(cells))[::-1]
    clear = (0.0, 0.0, 0.0, 0.0)
    colours = ListedColormap([COLORS["accent"] + "88"]).with_extremes(over=clear, bad=clear)
    return ax.imshow(order, cmap=colours, vmin=-1, vmax=len(cells), origin="lower", extent=grid.extent, zorder=2)


def draw_planner_tree(ax: Axes) -> None:
    """The kinds of path planning and their members, as section 1.6 lists them."""
    diagram(ax, 12.0, 6.2)
    root = block(ax, (6.0, 5.7), "path planning", size=(2.6, 0.7))
    kinds = {
        "global: whole map known": (
            (2.0, 4.3),
            "reference",
            ["graph: Dijkstra, A*,\nweighted A*", "sampling: RRT, PRM", "swarm: PSO, ACO, ABC"],
        ),
        "local: what sensors see": (
            (6.0, 4.3),
            "robot",
            ["velocities: DWA", "gaps: VFH\nbands: elastic, TEB", "forces: APF\nrules: fuzzy, learned"],
        ),
        "hybrid: both": (
            (10.0, 4.3),
            "mover",
            ["A* or Dijkstra + DWA", "PRM or RRT + TEB", "global APF + local\nfuzzy or MPC"],
        ),
    }
    for name, (center, role, members) in kinds.items():
        kind = block(ax, center, name, size=(3.3, 0.7), role=role)
        arrow(ax, root.bottom, kind.top)
        for k, member in enumerate(members):
            leaf = block(ax, (center[0], 3.1 - 1.1 * k), member, size=(3.3, 0.85), fontsize=8.5)
            ax.plot(
                [leaf.left[0] - 0.15, leaf.left[0]], [leaf.left[1]] * 2, color="#333333", linestyle="-", linewidth=1
            )
        ax.plot(
            [center[0] - 1.8, center[0] - 1.8, kind.left[0]],
            [0.9, center[1], center[1]],
            color="#333333",
            linestyle="-",
            linewidth=1,
        )


def draw_neighbours(ax: Axes, count: int, corners: str = "permissive") -> None:
    """A cell with its 4 or 8 steps; with "strict" an occupied cell takes away the diagonals past it."""
    occupied = np.zeros((3, 3), dtype=bool)
    occupied[2, 1] = corners == "strict"
    grid = GridMap(occupied)
    draw_grid(ax, grid, lines=True)
    for d, (dx, dy) in enumerate(heuristics.STEPS.tolist()):
        if count == 4 and d % 2:
            continue
        legal = grid.move_allowed((1, 1), (dx, dy), corners)
        tip = (1.5 + 0.85 * dx, 1.5 + 0.85 * dy)
        if not grid.occupied[1 + dy, 1 + dx]:
            ax.annotate(
                "",
                tip,
                (1.5, 1.5),
                arrowprops={
                    "arrowstyle": "-|>",
                    "linestyle": "-" if legal else ":",
                    "color": COLORS["path"] if legal else COLORS["unknown"],
                    "linewidth": 1.6,
                },
                zorder=4,
            )
    ax.plot([1.5], [1.5], "o", color=COLORS["robot"], zorder=5)
    ax.set(xticks=[0, 1, 2, 3], yticks=[0, 1, 2, 3])


def draw_compass(ax: Axes, offset: ArrayLike | None = None) -> None:
    """The eight directions with their compass names; for a goal at `offset` (2,) the five that Table 3.1 keeps."""
    kept = set(range(8)) if offset is None else set(heuristics.kept_directions(offset).tolist())
    for d, (dx, dy) in enumerate(heuristics.STEPS.tolist()):
        face = COLORS["accent"] + "60" if d in kept else "#EEEEEE"
        ax.add_patch(Rectangle((dx - 0.5, dy - 0.5), 1.0, 1.0, facecolor=face, edgecolor="#888888", zorder=1))
        ax.text(dx, dy, f"{45 * d:03d}T", ha="center", va="center", color="black" if d in kept else "#777777", zorder=3)
    ax.plot([0], [0], "o", color=COLORS["robot"], zorder=3)
    if offset is not None:
        x, y = np.asarray(offset, dtype=float) / np.abs(offset).max() * 1.45
        ax.annotate("", (x, y), (0, 0), arrowprops={"arrowstyle": "-|>", "color": COLORS["goal"], "linewidth": 2})
    ax.set(xlim=(-1.6, 1.6), ylim=(-1.6, 1.6), xticks=[], yticks=[], xlabel="east", ylabel="north")
    ax.set_aspect("equal")
    ax.grid(False)


def draw_removal(ax: Axes, grid: GridMap, before: ArrayLike, after: ArrayLike, *, title: str = "") -> None:
    """A path of cells `(n, 2)` before (dashed) and after (full) the removal of nodes."""
    draw_grid(ax, grid, lines=True)
    first, last = grid.center_of(before), grid.center_of(after)
    draw_path(ax, first, role="unknown", linestyle="--", marker="o")
    draw_path(ax, last, role="path")
    draw_nodes(ax, last)
    ax.set_title(title)


def draw_heuristics(ax: Axes, start: ArrayLike, goal: ArrayLike) -> dict[str, Array]:
    """Heuristic over true cost along the straight line from start to goal (diagonal or straight grid line)."""
    a, b = np.asarray(start, dtype=float), np.asarray(goal, dtype=float)
    u = np.linspace(0.0, 0.995, 200)
    offset, total = (b - a) * (1.0 - u)[:, None], b - a
    true = heuristics.octile(offset)
    curves = {
        "Euclidean": heuristics.euclidean(offset) / true,
        "Manhattan": heuristics.manhattan(offset) / true,
        "e^P Manhattan (eq 3.7)": np.exp(heuristics.distance_scale(offset, total))
        * heuristics.manhattan(offset)
        / true,
        "eq 4.4, base 10": heuristics.enhanced(offset, total) / true,
        "eq 4.4, base e": heuristics.enhanced(offset, total, math.e) / true,
    }
    for name, values in curves.items():
        ax.plot(heuristics.euclidean(offset), values, label=name)
    ax.axhline(1.0, color="black", linestyle="-", linewidth=0.8)
    ax.set(xlabel="straight line to the goal [m]", ylabel="heuristic / true cost", ylim=(0, None))
    ax.invert_xaxis()
    ax.legend(loc="upper right")
    return curves


def draw_sampled(ax: Axes, grid: GridMap, found: Sampled, *, title: str = "") -> None:
    """The tree, roadmap or swarm of a sampling planner under its path."""
    draw_grid(ax, grid)
    if isinstance(found.evidence, tuple):
        shown = found.evidence[:: max(1, len(found.evidence) // 25)]
        legs: Sequence[Array] = list(shown)
    else:
        legs = list(found.evidence)
    ax.add_collection(LineCollection(legs, colors=COLORS["accent"], linewidths=0.7, alpha=0.7, zorder=2))
    draw_path(ax, found.points, marker=".")
    ax.set_title(title)


def draw_spline(ax: Axes, spline: Spline, *, label: str = "", role: str = "goal", polygon: bool = True) -> list[Line2D]:
    """A B-spline over its control polygon."""
    lines = [draw_path(ax, spline.points(400), role=role, label=label)]
    if polygon:
        lines.append(draw_path(ax, spline.controls, role="unknown", linestyle="--", marker="s"))
    return lines


def draw_curvature(ax: Axes, curves: Mapping[str, tuple[Array, Array]], *, limit: float | None = None) -> None:
    """Curvature over arc length; curves by name, each (points `(n, 2)` [m], curvature `(n,)` [1/m])."""
    for name, (points, values) in curves.items():
        ax.plot(cumulative_length(points), values, label=name)
    if limit is not None:
        for side in (-limit, limit):
            ax.axhline(side, color="black", linestyle=":", linewidth=1)
    ax.set(xlabel="arc length [m]", ylabel="curvature [1/m]")
    if len(curves) > 1:
        ax.legend()


def draw_eta_family(axes: Sequence[Axes], family: Mapping[str, object]) -> None:
    """Eta-cubed curves by name: their shapes in the first axes, their curvature in the second."""
    u = np.linspace(0.0, 1.0, 201)
    for (name, curve), colour in zip(family.items(), CYCLE, strict=False):
        points = curve.derivative(u)  # type: ignore[attr-defined]
        axes[0].plot(points[:, 0], points[:, 1], color=colour, label=name)
        axes[1].plot(cumulative_length(points), curve.curvature(u), color=colour)  # type: ignore[attr-defined]
    axes[0].set(xlabel="x [m]", ylabel="y [m]")
    axes[0].set_aspect("equal", adjustable="datalim")
    axes[1].legend(*axes[0].get_legend_handles_labels(), loc="upper right")
    axes[1].set(xlabel="arc length [m]", ylabel="curvature [1/m]")


def draw_printed_basis(ax: Axes, right: Array, printed: Array, t: Array) -> None:
    """Four basis functions `(n, 4)`, right (full) and as printed (dotted), with both sums."""
    for k in range(4):
        ax.plot(t, right[:, k], color=CYCLE[k], linestyle="-")
        ax.plot(t, printed[:, k], color=CYCLE[k], linestyle=":")
    ax.plot(t, right.sum(axis=1), color="black", linestyle="-", label="sum, right")
    ax.plot(t, printed.sum(axis=1), color="black", linestyle=":", label="sum, as printed")
    ax.set(xlabel="t", ylabel="basis function")
    ax.legend()


def draw_study(
    ax: Axes, table: pd.DataFrame, columns: Mapping[str, Array], *, ylabel: str, by: str = "density"
) -> None:
    """Boxes of several quantities for each density, side by side; whiskers at 5 and 95 %."""
    groups = sorted(table[by].unique())
    width = 0.8 / len(columns)
    for k, (name, values) in enumerate(columns.items()):
        rows = [np.asarray(values)[(table[by] == g).to_numpy()] for g in groups]
        spots = np.arange(len(groups)) + (k - (len(columns) - 1) / 2.0) * width
        made = ax.boxplot(
            [r[np.isfinite(r)] for r in rows],
            positions=spots,
            widths=0.85 * width,
            whis=(5, 95),
            showfliers=False,
            patch_artist=True,
            medianprops={"color": "black"},
            manage_ticks=False,
        )
        for box in made["boxes"]:
            box.set(facecolor=CYCLE[k] + "90", edgecolor=CYCLE[k])
        ax.plot([], [], color=CYCLE[k], linestyle="-", linewidth=6, alpha=0.6, label=name)
    ax.set_xticks(np.arange(len(groups)), [f"{g:g}" for g in groups])
    ax.set(xlabel=f"{by} of occupied cells", ylabel=ylabel)
    ax.grid(axis="x", visible=False)
    ax.legend()
