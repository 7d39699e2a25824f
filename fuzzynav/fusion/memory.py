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


class Memory:
    """The map that a planner searches: cells of `resolution` [m], blocked by the given map or by what was seen.

    Without a given map it covers `reach` [m] around the first pose and the goal. A cell in which a beam ended is
    blocked; it is free again as soon as a beam passes over its centre. What no beam met counts as free.
    """

    def __init__(self, chart: GridMap | None, resolution: float = 0.1, reach: float = 6.0) -> None:
        self.chart, self.wanted, self.reach = chart, resolution, reach
        self.reset()

    def reset(self) -> None:
        """Forget what was seen."""
        self.resolution, self.origin = self.wanted, np.zeros(2)
        self.known = self.seen = np.zeros((0, 0), dtype=np.bool_)
        self.changes = 0  # how many cells were entered or freed so far

    def enter(self, observation: Observation, standing: Mask) -> None:
        """Take a scan into the map; `standing` says which of its beams may be entered, all of them may free cells."""
        if not self.known.size:
            self._begin(observation)
        if observation.ranges is None or observation.angles is None:
            return
        frame = np.array([self.resolution, *self.origin])
        pose, ranges = np.asarray(observation.pose, dtype=float), np.asarray(observation.ranges, dtype=float)
        self.changes += enter(
            self.seen, self.known, frame, pose, ranges, observation.angles, standing, float(observation.range_max)
        )

    def grid(self, discs: Array | None = None) -> GridMap:
        """The map now; rows x, y, radius [m] of `discs` are blocked too."""
        blocked = self.known | self.seen
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
        self.seen = np.zeros_like(self.known)


@njit(cache=True)
def enter(
    seen: Mask, known: Mask, frame: Array, pose: Array, ranges: Array, angles: Array, standing: Mask, reach: float
) -> int:
    """Free the seen cells that a beam passed over, block those in which one ended; how many cells changed."""
    step, n, changed = frame[0], ranges.size, 0
    width = (angles[n - 1] - angles[0]) / (n - 1) if n > 1 else 1.0
    for j in range(seen.shape[0]):
        for i in range(seen.shape[1]):
            if not seen[j, i]:
                continue
            dx, dy = frame[1] + (i + 0.5) * step - pose[0], frame[2] + (j + 0.5) * step - pose[1]
            bearing = np.arctan2(dy, dx) - pose[2]
            k = int(np.round(((bearing - angles[0]) % (2.0 * np.pi)) / width))
            k = 0 if k >= n and k * width > 2.0 * np.pi - 0.75 * width else k
            if k < n and not np.isnan(ranges[k]) and min(ranges[k], reach) > np.hypot(dx, dy) + step:
                seen[j, i] = False
                changed += 1
    for k in range(n):
        if not standing[k] or not np.isfinite(ranges[k]) or ranges[k] >= reach:
            continue
        far = ranges[k] + 1e-3 * step
        i = int(np.floor((pose[0] + far * np.cos(pose[2] + angles[k]) - frame[1]) / step))
        j = int(np.floor((pose[1] + far * np.sin(pose[2] + angles[k]) - frame[2]) / step))
        if 0 <= i < seen.shape[1] and 0 <= j < seen.shape[0] and not (seen[j, i] or known[j, i]):
            seen[j, i] = True
            changed += 1
    return changed


def _warm() -> None:
    """Compile the loop for the types used in practice."""
    cells = np.zeros((2, 2), dtype=np.bool_)
    enter(cells, cells, np.array([1.0, 0.0, 0.0]), np.zeros(3), np.ones(3), np.ones(3), np.ones(3, dtype=np.bool_), 9.0)
