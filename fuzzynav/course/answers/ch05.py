"""The answers to the labs of chapter 05."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fuzzynav import smoothing
from fuzzynav.course.answers.answer import Answer
from fuzzynav.maps import GridMap
from fuzzynav.planning import astar
from fuzzynav.smoothing import simplify
from fuzzynav.studies.planning import claims, maps

__all__ = ["ANSWERS"]


def _paint() -> str:
    scene = maps.SCENES_3["S1"]
    occupied = np.array(scene.grid.occupied)
    occupied[12, 11] = True
    grid = GridMap(occupied, scene.grid.resolution, scene.grid.origin)
    plain, quick = (astar.search(grid, scene.start, scene.goal, o) for o in (astar.TRADITIONAL, astar.EFFICIENT))
    return f"""One. With a single wall cell at column 11, row 12, which blocks the short way, the traditional search
    needs {plain.searched} cells and the efficient one {quick.searched}: it leaves out three directions, ends in the
    dead end, and must begin again with all eight. It is the only free cell of this map that does so alone."""


def _choose() -> str:
    scene = maps.SCENES_4["M2"]

    def found(heuristic: str, weight: float) -> astar.SearchResult:
        return astar.search(
            scene.grid, scene.start, scene.goal, replace(astar.OPTIMAL, heuristic=heuristic, weight=weight)
        )

    best = found("octile", 0.0)
    weights = [w / 10 for w in range(41)]
    longer = next(w for w in weights if found("manhattan", w).length > best.length + 1e-6)
    return f"""With the octile heuristic weight 1 searches {found("octile", 1.0).searched} cells in place of
    {best.searched}, weight 1.5 {found("octile", 1.5).searched}, and the path stays {best.length:.2f} m long at every
    weight: on this map the weight is free. Only Manhattan makes it longer, {found("manhattan", longer).length:.2f}
    m from weight {longer:.1f} on. On other maps it is not: exercise 05.4 asks how much may be paid."""


def _film() -> str:
    plain, quick = claims.plan("S2", "TA").search, claims.plan("S2", "EA").search
    leaves = next(k for k, (a, b) in enumerate(zip(plain.cells, quick.cells, strict=False)) if tuple(a) != tuple(b))
    x, y = (int(v) for v in quick.cells[leaves - 1])
    return f"""At once: from cell ({x}, {y}) it climbs diagonally towards the goal, up to row 9, and must come down
    again to row 8 to pass the corner. The traditional path keeps to its row and saves that: {plain.length:.3f} m
    against {quick.length:.3f} m. For this it expands {quick.searched} cells instead of {plain.searched}."""


def _safety() -> str:
    scene = maps.SCENES_4["M2 cut"]
    rows = {}
    for radius in (0.5, 0.55, 0.75, 0.85):
        options = replace(astar.ENHANCED, safety_radius=radius)
        cells = astar.search(scene.grid, scene.start, scene.goal, options).cells
        smooth = smoothing.free_bspline(
            scene.grid.center_of(simplify.prune(cells, scene.grid, radius)), scene.grid, radius
        )
        sharp = float(np.abs(smooth.spline.curvature(smooth.spline.parameters(300))).max())
        rows[radius] = (smooth.spline.length, sharp)
    return f"""At 0.55 m the path takes another way, and the curve grows from {rows[0.5][0]:.2f} to
    {rows[0.55][0]:.2f} m; at 0.75 m it changes once more. The curvature does not follow the length:
    {rows[0.5][1]:.1f} 1/m before the first jump, {rows[0.55][1]:.1f} behind it, and {rows[0.85][1]:.1f} at 0.85 m,
    where the checked curve squeezes past a corner: a turning radius of {1 / rows[0.85][1]:.1f} m. From 1.55 m on
    the start itself is too near."""


def _eta() -> str:
    def measure(speed: float, push: float = 0.0) -> tuple[float, float]:
        curve = smoothing.eta3([0.0, 0.0, 0.0], (4.0, 3.0, 0.0), [speed, speed, push, -push])
        return curve.length, float(np.abs(curve.curvature(np.linspace(0.0, 1.0, 201))).max())

    first, less, both = measure(5.0), measure(4.5), measure(2.0, 20.0)
    return f"""None alone: from {first[0]:.2f} m and {first[1]:.2f} 1/m speeds of 4.5 m give {less[0]:.2f} m and
    {less[1]:.2f} 1/m, which is next to nothing, and lower ones bend more. Two together do: speeds of 2 m and eta_3
    = 20 m give {both[0]:.2f} m and {both[1]:.2f} 1/m. Small speeds let the curve turn early, and the accelerations
    stretch its middle."""


ANSWERS = (
    Answer("05.lab1", _paint),
    Answer("05.lab2", _choose),
    Answer("05.lab3", _film),
    Answer("05.lab4", _safety),
    Answer("05.lab5", _eta),
)
