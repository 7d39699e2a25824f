"""Labs of global planning: the choices of a search on sliders, its expansion as a film, safety radius, eta vectors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from fuzzynav import smoothing
from fuzzynav.geometry import cumulative_length
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar
from fuzzynav.planning.astar import Options, SearchResult
from fuzzynav.plot.base import COLORS, draw_goal, draw_grid, draw_path
from fuzzynav.plot.blit import Update
from fuzzynav.plot.planning import draw_nodes, draw_start, order_image
from fuzzynav.smoothing import simplify

__all__ = ["eta_lab", "paint_picture", "safety_lab", "search_film", "search_lab"]

Cell = tuple[int, int]


def search_lab(figure: Figure, *, grid: GridMap, start: Cell, goal: Cell) -> Update:
    """A search whose heuristic, weight, neighbours, corner rule and safety radius are controls."""

    ax = figure.subplots()
    draw_grid(ax, grid, lines=True)
    marks = [draw_start(ax, grid.center_of(start)), *draw_goal(ax, grid.center_of(goal))]
    grown = ax.imshow(
        np.zeros(grid.shape),
        cmap="Greys",
        vmin=0,
        vmax=3,
        origin="lower",
        extent=grid.extent,
        zorder=1.5,
        alpha=np.zeros(grid.shape),
    )
    picture = order_image(ax, grid, astar.search(grid, start, goal))
    path = draw_path(ax, np.empty((0, 2)))

    def update(heuristic: str, weight: float, neighbours: str, corners: str, radius: float) -> tuple[list[Artist], str]:
        options = Options(
            heuristic=heuristic, weight=weight, neighbours=int(neighbours), corners=corners, safety_radius=radius
        )
        found = astar.search(grid, start, goal, options)
        best = astar.search(grid, start, goal, replace(options, heuristic="zero"))
        _show(grid, found, picture, path)
        extra = grid.inflate(radius).occupied & ~grid.occupied
        grown.set_array(extra.astype(float))
        grown.set_alpha(0.8 * extra)
        return [grown, picture, path, *marks], _words(found, best)

    return update


def _show(grid: GridMap, found: SearchResult, picture: object, path: object) -> None:
    order = np.full(grid.shape, np.nan)
    order[found.expanded[:, 1], found.expanded[:, 0]] = 0.0
    picture.set_data(order)  # type: ignore[attr-defined]
    picture.set_clim(-1, 1)  # type: ignore[attr-defined]
    path.set_data(*grid.center_of(found.cells).reshape(-1, 2).T)  # type: ignore[attr-defined]


def _words(found: SearchResult, best: SearchResult) -> str:
    """Counts and lengths of a search beside those of Dijkstra's under the same rules."""
    if found.status != "reached":
        name = found.status.replace("_", " ")
        return f"{name}; {found.searched} cells searched"
    excess = 100.0 * (found.length / best.length - 1.0)
    return (
        f"{found.searched} cells searched (Dijkstra {best.searched}), length {found.length:.2f} m, "
        f"{max(excess, 0.0):.1f} % over the shortest"
    )


def search_film(figure: Figure, *, grid: GridMap, results: Mapping[str, SearchResult]) -> Update:
    """The expansions of several searches as a film, side by side; `frame` is the number of cells expanded."""

    axes = np.atleast_1d(figure.subplots(1, len(results)))
    moving = []
    for ax, (name, found) in zip(axes, results.items(), strict=True):
        draw_grid(ax, grid, lines=True)
        marks: list[Artist] = [draw_start(ax, grid.center_of(found.expanded[0]))]
        if len(found.cells):
            marks += draw_goal(ax, grid.center_of(found.cells[-1]))
        ax.set_title(name)
        (head,) = ax.plot([], [], "s", color=COLORS["mover"], markersize=6, zorder=5)
        moving.append((found, order_image(ax, grid, found), head, draw_path(ax, np.empty((0, 2))), marks))

    def update(frame: int) -> tuple[list[Artist], str]:
        changed: list[Artist] = []
        for found, picture, head, path, marks in moving:
            done = frame >= found.searched
            picture.set_clim(-1, min(frame, found.searched) - 0.5)
            head.set_data(*grid.center_of(found.expanded[min(frame, found.searched) - 1])[:, None])
            path.set_data(*grid.center_of(found.cells if done else found.cells[:0]).reshape(-1, 2).T)
            changed += [picture, head, path, *marks]
        counts = [f"{name} {min(frame, r.searched)} of {r.searched}" for name, r in results.items()]
        return changed, "cells expanded: " + ", ".join(counts)

    return update


def safety_lab(figure: Figure, *, grid: GridMap, start: Cell, goal: Cell) -> Update:
    """Enhanced A* at a safety radius: raw path, kept nodes, checked curve, and the curve's curvature below."""

    ax, below = figure.subplots(2, 1, height_ratios=[3, 1])
    draw_grid(ax, grid, lines=True)
    draw_start(ax, grid.center_of(start))
    draw_goal(ax, grid.center_of(goal))
    raw = draw_path(ax, np.empty((0, 2)), role="unknown", linestyle="--")
    nodes = draw_nodes(ax, np.empty((0, 2)))
    curve = draw_path(ax, np.empty((0, 2)), role="goal")
    (bend,) = below.plot([], [], color=COLORS["goal"], linestyle="-")
    below.set(xlim=(0, 32), ylim=(-4, 4), xlabel="arc length [m]", ylabel="curvature [1/m]")

    def update(radius: float, base: float) -> tuple[list[Artist], str]:
        found = astar.search(grid, start, goal, replace(astar.ENHANCED, safety_radius=radius, log_base=base))
        for line in (raw, nodes, curve, bend):
            line.set_data([], [])
        changed: list[Artist] = [raw, nodes, curve, bend]
        if found.status != "reached":
            name = found.status.replace("_", " ")
            return changed, f"{name} at {radius:.2f} m"
        kept = grid.center_of(simplify.prune(found.cells, grid, radius))
        smooth = smoothing.free_bspline(kept, grid, radius)
        t = smooth.spline.parameters(300)
        points = smooth.spline.derivative(t)
        raw.set_data(*grid.center_of(found.cells).T)
        nodes.set_data(*kept.T)
        curve.set_data(*points.T)
        bend.set_data(cumulative_length(points), smooth.spline.curvature(t))
        return changed, (
            f"{found.searched} cells searched, {len(found.cells)} nodes, {len(kept)} kept, curve "
            f"{smooth.spline.length:.2f} m, least clearance {smoothing.least_clearance(points, grid):.2f} m"
        )

    return update


def eta_lab(figure: Figure, *, end: tuple[float, float, float] = (4.0, 3.0, 0.0)) -> Update:
    """An eta-cubed curve from the origin to `end` (x, y, theta), with its curvature below; the eta vector is free."""

    ax, below = figure.subplots(2, 1, height_ratios=[2, 1])
    ax.set(xlim=(-2.0, end[0] + 2.0), ylim=(-1.5, end[1] + 1.5), xlabel="x [m]", ylabel="y [m]", aspect="equal")
    draw_start(ax, (0.0, 0.0))
    draw_goal(ax, end[:2])
    below.set(xlim=(0, 12), ylim=(-6, 6), xlabel="arc length [m]", ylabel="curvature [1/m]")
    line = draw_path(ax, np.empty((0, 2)))
    (bend,) = below.plot([], [], color=COLORS["path"], linestyle="-")
    u = np.linspace(0.0, 1.0, 201)

    def update(speeds: float, accelerations: float, jerks: float, heading: float) -> tuple[list[Artist], str]:
        eta = [speeds, speeds, accelerations, -accelerations, jerks, jerks]
        curve = smoothing.eta3([0.0, 0.0, np.radians(heading)], end, eta)
        points, curvature = curve.derivative(u), curve.curvature(u)
        line.set_data(*points.T)
        bend.set_data(cumulative_length(points), curvature)
        return [line, bend], f"length {curve.length:.2f} m, sharpest curvature {np.abs(curvature).max():.2f} 1/m"

    return update


def paint_picture(figure: Figure, *, grid: GridMap, found: SearchResult, start: Cell, goal: Cell) -> Update:
    """The still picture of a painting lab, for readers without a kernel."""

    ax = figure.subplots()
    draw_grid(ax, grid, lines=True)
    draw_start(ax, grid.center_of(start))
    draw_goal(ax, grid.center_of(goal))
    picture = order_image(ax, grid, found)
    path = draw_path(ax, np.empty((0, 2)))

    def update() -> tuple[None, str]:
        _show(grid, found, picture, path)
        return None, ""

    return update
