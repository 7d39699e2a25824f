"""A fine map of what stands: the given map, and what the scanner added to it; what it sees through is taken out."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fuzzynav.control import Observation
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap

__all__ = ["Memory"]

Mask = NDArray[np.bool_]
Bytes = NDArray[np.int8]
HIT, MOST = 3, 9  # evidence of a scan that ends in a cell, and the most that a cell keeps


class Memory:
    """The map that a planner searches: cells of `resolution` [m], blocked by the given map or by what was seen.

    Without a given map it covers `reach` [m] around the first pose and the goal. A scan that ends in a cell speaks
    three times as loud for it as one that looks over its centre speaks against it; what no scan met counts as free.
    Where nothing moves (`fades` False), what was seen stays.
    """

    def __init__(self, chart: GridMap | None, resolution: float = 0.1, reach: float = 6.0, fades: bool = True) -> None:
        self.chart, self.wanted, self.reach, self.fades = chart, resolution, reach, fades
        self.reset()

    def reset(self) -> None:
        """Forget what was seen."""
        self.resolution, self.origin = self.wanted, np.zeros(2)
        self.known = np.zeros((0, 0), dtype=np.bool_)
        self.evidence = np.zeros((0, 0), dtype=np.int8)
        self.changes = 0  # how many cells were entered or freed so far

    def enter(self, observation: Observation, standing: Mask) -> None:
        """Take a scan into the map; `standing` says which of its hits may be entered, all beams may free cells."""
        if not self.known.size:
            self._begin(observation)
        if observation.ranges is None or observation.angles is None:
            return
        frame = np.array([self.resolution, *self.origin, float(self.fades)])
        pose, ranges = np.asarray(observation.pose, dtype=float), np.asarray(observation.ranges, dtype=float)
        entered = np.isfinite(ranges)
        entered[entered] = standing
        self.changes += enter(
            self.evidence, self.known, frame, pose, ranges, observation.angles, entered, float(observation.range_max)
        )

    def grid(self, discs: Array | None = None, wary: float = 0.0) -> GridMap:
        """The map now; what was seen is grown by `wary` [m], and rows x, y, radius [m] of `discs` are blocked too."""
        cells = round(wary / self.resolution)
        seen = self.evidence > 0
        for _ in range(cells):
            seen = _grown(seen)
        blocked = self.known | seen
        if discs is not None and len(discs):
            rows, cols = np.indices(blocked.shape)
            x, y = self.origin[0] + (cols + 0.5) * self.resolution, self.origin[1] + (rows + 0.5) * self.resolution
            for cx, cy, r in discs:
                blocked |= (x - cx) ** 2 + (y - cy) ** 2 <= r * r
        return GridMap(blocked, self.resolution, (float(self.origin[0]), float(self.origin[1])))

    def _begin(self, observation: Observation) -> None:
        """Lay out the cells."""
        if self.chart is not None:
            parts = max(round(self.chart.resolution / self.wanted), 1)
            self.resolution, self.origin = self.chart.resolution / parts, np.array(self.chart.origin)
            self.known = np.kron(self.chart.occupied, np.ones((parts, parts), dtype=np.bool_))
        else:
            ends = np.vstack([np.asarray(observation.pose)[:2], observation.goal])
            self.origin = ends.min(axis=0) - self.reach
            cols, rows = np.ceil((np.ptp(ends, axis=0) + 2.0 * self.reach) / self.resolution).astype(int)
            self.known = np.zeros((rows, cols), dtype=np.bool_)
        self.evidence = np.zeros(self.known.shape, dtype=np.int8)


def _grown(cells: Mask) -> Mask:
    """The cells and the eight around each."""
    wide = cells.copy()
    wide[:, 1:] |= cells[:, :-1]
    wide[:, :-1] |= cells[:, 1:]
    out = wide.copy()
    out[1:] |= wide[:-1]
    out[:-1] |= wide[1:]
    return out


@njit(cache=True)
def enter(
    evidence: Bytes, known: Mask, frame: Array, pose: Array, ranges: Array, angles: Array, standing: Mask, reach: float
) -> int:
    """Weaken the cells that a beam passed over, strengthen those in which one ended; how many changed sides.

    frame: resolution, x, y of the corner, and whether evidence fades.
    """
    changed, step = 0, frame[0]
    if frame[3] > 0.0:
        changed = _fade(evidence, frame, pose, ranges, angles, reach)
    for k in range(ranges.size):
        if not standing[k] or not np.isfinite(ranges[k]) or ranges[k] >= reach:
            continue
        far = ranges[k] + 1e-3 * step
        i = int(np.floor((pose[0] + far * np.cos(pose[2] + angles[k]) - frame[1]) / step))
        j = int(np.floor((pose[1] + far * np.sin(pose[2] + angles[k]) - frame[2]) / step))
        if 0 <= i < known.shape[1] and 0 <= j < known.shape[0] and not known[j, i]:
            changed += int(evidence[j, i] <= 0)
            evidence[j, i] = min(evidence[j, i] + HIT, MOST)
    return changed


@njit(cache=True)
def _fade(evidence: Bytes, frame: Array, pose: Array, ranges: Array, angles: Array, reach: float) -> int:
    """Weaken the seen cells over whose centres a beam passed; how many are free now."""
    step, n, changed = frame[0], ranges.size, 0
    width = (angles[n - 1] - angles[0]) / (n - 1) if n > 1 else 1.0
    for j in range(evidence.shape[0]):
        for i in range(evidence.shape[1]):
            if evidence[j, i] <= 0:
                continue
            dx, dy = frame[1] + (i + 0.5) * step - pose[0], frame[2] + (j + 0.5) * step - pose[1]
            bearing = np.arctan2(dy, dx) - pose[2]
            k = int(np.round(((bearing - angles[0]) % (2.0 * np.pi)) / width))
            k = 0 if k >= n and k * width > 2.0 * np.pi - 0.75 * width else k
            if k < n and not np.isnan(ranges[k]) and min(ranges[k], reach) > np.hypot(dx, dy) + step:
                evidence[j, i] -= 1
                changed += int(evidence[j, i] == 0)
    return changed


def _warm() -> None:
    """Compile the loop for the types used in practice."""
    cells, evidence = np.zeros((2, 2), dtype=np.bool_), np.zeros((2, 2), dtype=np.int8)
    yes = np.ones(3, dtype=np.bool_)
    enter(evidence, cells, np.array([1.0, 0.0, 0.0, 1.0]), np.zeros(3), np.ones(3), np.ones(3), yes, 9.0)
