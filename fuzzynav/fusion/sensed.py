"""What a robot knows of its surroundings at one moment: what stands, what may move, what is predicted to move.

Where an ideal tracker tells the movers, they alone may move. Otherwise no scan is trusted to tell a mover that waits
from a block: every point that the map does not explain may move, and the tracks of a tracker serve the prediction only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzynav.control import Observation
from fuzzynav.dwa.sight import border
from fuzzynav.fusion.tracks import Tracks
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap

__all__ = ["Surroundings", "surroundings"]

Mask = NDArray[np.bool_]

NO_POINTS, NO_RADII, NO_ROWS = np.empty((0, 2)), np.empty(0), np.empty((0, 5))
OWN = 0.02  # [m] a hit this near to a mover's rim is its own; scans are noisy


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Surroundings:
    """What is around a robot, in the world as it believes it.

    `border` (with `radii`; the first `holes` of its points bound gaps between beams) is where the ground that the scan
    has shown ends. `standing` says which of the scan's hits belong to nothing that moves and to no known map.
    """

    points: Array  # (n, 2) [m] hits that stand, or are taken to
    border: Array  # (b, 2) [m]
    radii: Array  # (b,) [m]
    holes: int
    hazards: Array  # (h, 3) x, y, radius [m] of what may move in any direction
    movers: Array  # (m, 5) x, y, velocity, radius of what is predicted
    standing: Mask  # (hits,)


def surroundings(
    observation: Observation,
    radius: float,
    thinnest: float,
    *,
    chart: GridMap | None,
    tracks: Tracks | None,
    tell: float,
    trusts: bool = False,
) -> Surroundings:
    """Sort the hits of a scan for a robot of `radius` [m]; hits nearer than `tell` [m] to the chart belong to it.

    One that `trusts` its tracker takes the tracks as an ideal tracker's: they alone may move.
    """
    points = np.ascontiguousarray(observation.points, dtype=float).reshape(-1, 2)
    known = np.zeros(len(points), dtype=np.bool_)
    if chart is not None and len(points):
        known = chart.distance(points) < tell
    movers = NO_ROWS
    if observation.movers is not None:
        movers = np.ascontiguousarray(observation.movers, dtype=float).reshape(-1, 5)
        own, hazards = _hits_of(points, movers), np.ascontiguousarray(movers[:, [0, 1, 4]])
        still = points[~own]
    else:
        own, still = np.zeros(len(points), dtype=np.bool_), points
        hazards = np.column_stack([points[~known], np.zeros(int((~known).sum()))])
        if tracks is not None and observation.ranges is not None:
            labels = tracks.labels[np.isfinite(observation.ranges)]
            own = (labels >= 0) & np.append(tracks.moving, False)[labels]
            movers = np.ascontiguousarray(tracks.movers)
        if trusts:
            still, hazards = points[~own], np.ascontiguousarray(movers[:, [0, 1, 4]])
    rim, radii, holes = _border(observation, radius, thinnest)
    return Surroundings(
        points=still, border=rim, radii=radii, holes=holes, hazards=hazards, movers=movers, standing=~(own | known)
    )


def _hits_of(points: Array, movers: Array) -> Mask:
    """Which points lie on the rim of a mover, or inside it."""
    if not len(points) or not len(movers):
        return np.zeros(len(points), dtype=np.bool_)
    away = np.hypot(points[:, None, 0] - movers[:, 0], points[:, None, 1] - movers[:, 1]) - movers[:, 4]
    return np.asarray(away.min(axis=1) < OWN)


def _border(observation: Observation, radius: float, thinnest: float) -> tuple[Array, Array, int]:
    """Border of what the beams have crossed; none without a scan."""
    if observation.ranges is None or observation.angles is None:
        return NO_POINTS, NO_RADII, 0
    ranges = np.ascontiguousarray(observation.ranges, dtype=float)
    angles = np.ascontiguousarray(observation.angles, dtype=float)
    pose, reach = np.asarray(observation.pose, dtype=float), float(observation.range_max)
    found: tuple[Array, Array, int] = border(ranges, angles, pose, reach, radius, NO_POINTS, thinnest)
    return found
