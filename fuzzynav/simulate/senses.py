"""What of the world an experiment grants the controller: a scan, and what an ideal tracker tells."""

from __future__ import annotations

from typing import Any

import numpy as np

from fuzzynav.geometry import Array, to_world
from fuzzynav.sensors import EXACT, Laser, Odometry, Scan, laser_faults
from fuzzynav.world import MoverState, World
from fuzzynav.world.kernels import scan

__all__ = ["Senses"]


class Senses:
    """The sensors of one run; what does not change in it is worked out once."""

    def __init__(self, world: World, laser: Laser | None, odometry: Odometry, track_movers: bool) -> None:
        self.world, self.laser, self.odometry, self.track_movers = world, laser, odometry, track_movers
        self.radii = np.array([m.radius for m in world.movers])
        if laser is not None:
            self.angles = laser.angles
            self.cosines, self.sines = np.cos(self.angles), np.sin(self.angles)
            # a laser without faults draws nothing that anything else would miss
            self.faultless = laser.noise == 0.0 and laser.dropout == 0.0 and odometry == EXACT

    def told(self, truth: Array, pose: Array, traffic: MoverState, rng: np.random.Generator) -> dict[str, Any]:
        """The sensed fields of an Observation at the true pose, as the robot that believes `pose` takes them."""
        told: dict[str, Any] = {"points": np.empty((0, 2))}
        if self.laser is not None:
            ranges, owners = self._cast(truth, traffic, rng)
            hits = np.isfinite(ranges)
            points, met = np.empty((np.count_nonzero(hits), 2)), ranges[hits]
            points[:, 0], points[:, 1] = met * self.cosines[hits], met * self.sines[hits]
            told = {"points": to_world(pose, points), "ranges": ranges, "angles": self.angles.copy()}
            told["range_max"] = self.laser.range_max
            if self.track_movers:
                speeds = np.zeros((len(traffic.velocities) + 1, 2))
                speeds[:-1] = traffic.velocities  # the last, -1, is of what stands
                told["point_velocities"] = speeds[owners[hits]]
        if self.track_movers:
            told["movers"] = np.empty((len(self.radii), 5))
            told["movers"][:, :2], told["movers"][:, 2:4] = traffic.positions, traffic.velocities
            told["movers"][:, 4] = self.radii
        return told

    def _cast(self, truth: Array, traffic: MoverState, rng: np.random.Generator) -> tuple[Array, Any]:
        """Ranges [m] as the laser reports them, and the index of the mover that each true beam met or -1."""
        assert self.laser is not None
        discs = np.empty((len(self.radii), 3))
        discs[:, :2], discs[:, 2] = traffic.positions, self.radii
        seen, owners = scan(self.world.scene, discs, truth.reshape(1, 3), self.angles, self.laser.range_max)
        ranges: Array = seen[0]
        ranges[ranges >= self.laser.range_max] = np.inf
        ranges[ranges < self.laser.range_min] = -np.inf
        if not self.faultless:
            exact = Scan(angles=self.angles, ranges=ranges, range_max=self.laser.range_max)
            ranges = laser_faults(exact, self.laser, rng).ranges
        return ranges, owners[0]
