"""The scenes of the global planners: reconstructed maps with their ends, and what the thesis' planners do there.

Rasters, starts and goals of thesis 3 and rasters of thesis 4 are ours (data/maps/README.md).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fuzzynav import smoothing
from fuzzynav.data import folder
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar, visibility
from fuzzynav.planning.astar import Options, SearchResult
from fuzzynav.smoothing import simplify

__all__ = [
    "SCENES_3",
    "SCENES_4",
    "Planned",
    "Scene",
    "curve_of",
    "efficient",
    "enhanced",
    "optimum",
    "random_scene",
    "traditional",
]

MAPS = folder("maps")
Cells = NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """A map with start and goal cells, counted from 0, and the choices that the printed numbers ask for there."""

    name: str
    start: tuple[int, int]
    goal: tuple[int, int]
    traditional: Options = astar.TRADITIONAL
    safety_radius: float = 0.5  # [m] of the enhanced search

    @property
    def grid(self) -> GridMap:
        """The map."""
        return _load(self.name)


@cache
def _load(name: str) -> GridMap:
    return GridMap.load(MAPS / f"{name}.map")


_NO_CUT = replace(astar.TRADITIONAL, corners="strict")
SCENES_3 = {
    "S1": Scene(name="thesis_ch3_scenario1", start=(1, 2), goal=(16, 17)),
    "S2": Scene(name="thesis_ch3_scenario2", start=(3, 5), goal=(18, 18)),
    "S1 no cut": Scene(name="thesis_ch3_scenario1_nocut", start=(0, 3), goal=(19, 14), traditional=_NO_CUT),
}
SCENES_4 = {
    "M1": Scene(name="thesis_ch4_map1_touching", start=(2, 2), goal=(17, 18), traditional=_NO_CUT, safety_radius=0.0),
    "M1 Manhattan": Scene(
        name="thesis_ch4_map1_manhattan",
        start=(2, 2),
        goal=(17, 18),
        traditional=replace(_NO_CUT, heuristic="manhattan"),
    ),
    "M2": Scene(name="thesis_ch4_map2", start=(2, 2), goal=(17, 18), traditional=_NO_CUT),
    "M2 cut": Scene(name="thesis_ch4_map2_cut", start=(2, 2), goal=(17, 18)),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Planned:
    """A search, the nodes kept of its path, and their length [m]."""

    search: SearchResult
    nodes: Cells
    length: float


def traditional(scene: Scene) -> Planned:
    """The traditional A*: the raw path is the answer."""
    found = astar.search(scene.grid, scene.start, scene.goal, scene.traditional)
    return Planned(search=found, nodes=found.cells, length=found.length)


def efficient(scene: Scene, options: Options = astar.EFFICIENT) -> Planned:
    """Thesis 3: the efficient search and the key nodes of section 3.3.4."""
    corners = scene.traditional.corners
    found = astar.search(scene.grid, scene.start, scene.goal, replace(options, corners=corners))
    kept = simplify.key_nodes(found.cells, scene.grid, corners=corners)
    return Planned(search=found, nodes=kept, length=astar.path_length(kept))


def enhanced(scene: Scene, options: Options = astar.ENHANCED) -> Planned:
    """Thesis 4: the enhanced search at the safety radius and the two steps of section 4.2.2.2."""
    radius = scene.safety_radius
    found = astar.search(scene.grid, scene.start, scene.goal, replace(options, safety_radius=radius))
    kept = simplify.prune(found.cells, scene.grid, radius)
    return Planned(search=found, nodes=kept, length=astar.path_length(kept))


def curve_of(scene: Scene, nodes: Cells) -> Array:
    """The clamped B-spline `(400, 2)` [m] on the nodes, with points in the middle of the legs where they are few."""
    points = scene.grid.center_of(nodes)
    while len(points) < 4:
        points = np.insert(points, np.arange(1, len(points)), (points[:-1] + points[1:]) / 2.0, axis=0)
    return smoothing.bspline(points).points(400)


def optimum(scene: Scene, radius: float = 0.0, corners: str = "strict") -> float:
    """Length [m] of the shortest path of all for a disc of this radius."""
    start, goal = scene.grid.center_of([scene.start, scene.goal])
    return visibility.shortest(scene.grid, start, goal, radius, corners).length


def random_scene(seed: int, density: float) -> tuple[GridMap, tuple[int, int], tuple[int, int]]:
    """A 20 x 20 map with independent occupied cells; start (2, 2) and goal (17, 18) are free."""
    rng = np.random.default_rng([seed, round(100 * density)])
    occupied = rng.random((20, 20)) < density
    occupied[2, 2] = occupied[18, 17] = False
    return GridMap(occupied), (2, 2), (17, 18)
