"""Moving obstacles from laser scans: clusters, discs, assignment, a Kalman filter for each, and what counts as moving.

The tracker knows no truth: places and velocities are in the frame of the believed pose, and an error of odometry
enters them as it enters the pose. A jump of the believed pose looks like a jump of everything that stands.

Standing things do not keep still in a scan: of a wall or a block another part is seen from every place, and the middle
of what is seen wanders. A track therefore counts as moving only where the scans prove it: its hits lie where an earlier
scan looked through, or the present scan looks through places that it hit before, and its velocity exceeds its own
uncertainty. Nothing that stands does the first, however its visible part changes.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from fuzzynav import checks
from fuzzynav.control import Observation
from fuzzynav.fusion import clusters, filters
from fuzzynav.fusion.clusters import RULES, Rows
from fuzzynav.fusion.filters import GAINS, TRACK, kalman_step
from fuzzynav.geometry import Array, sealed
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.maps.kernels import Record, framed

__all__ = ["TrackParams", "Tracker", "Tracks", "kalman_step"]

NO_CHART = (sealed(np.zeros((0, 0), dtype=np.bool_)), sealed(np.zeros((0, 0))), framed(1.0, (0.0, 0.0)))


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackParams:
    """What the tracker believes of scanner and movers. Raises ValueError for values out of range."""

    range_noise: float = 0.01  # [m] standard deviation of a range
    radius_min: float = 0.1  # [m] discs are fitted between these two
    radius_max: float = 0.75
    radius_mean: float = 0.35  # [m] believed of a disc never seen before, with its standard deviation
    radius_spread: float = 0.2
    misfit_max: float = 0.04  # [m] root mean square distance of hits from the rim of what still is a disc
    beams_min: int = 2  # a cluster has at least so many
    bridge: float = 3.5  # [gaps between beams] so far apart two beams are still neighbours: two may be lost
    chart_tolerance: float = 0.15  # [m] a hit this near to the chart's surfaces is explained by them
    velocity_bound: float = 2.0  # [m/s] nothing is faster; estimates are cut to it
    acceleration: float = 0.05  # [m^2/s^3] spectral density of the white acceleration noise between turns
    turn_share: float = 0.02  # of the steps have a sudden turn or stop, by a velocity of any size within the bound
    gate: float = 13.8  # squared Mahalanobis distance that 1 of 1000 right pairs exceeds (chi-square, 2 degrees)
    confirm: int = 3  # matches until a track is told
    coast: float = 2.0  # [s] a hidden track lives on
    patience: float = 0.25  # [s] a track lives on while scans look through the place where it should be
    look_back: tuple[float, float] = (0.3, 1.0)  # [s] ages of the scans that prove motion
    free_margin: float = 0.05  # [m] seen free means by more than this
    proof_share: float = 0.34  # of the hits of a track prove it moving
    proofs: int = 2  # scans with proof make it a mover
    speed_min: float = 0.06  # [m/s] slower than this nothing moves

    def __post_init__(self) -> None:
        checks.positive_fields(self, leave=("look_back", "turn_share", "proof_share"))
        checks.share(turn_share=self.turn_share, proof_share=self.proof_share)
        if not (self.radius_min < self.radius_max and self.beams_min >= 2 and 0.0 < self.turn_share < 1.0):
            raise ValueError(f"radius_min < radius_max, beams_min >= 2 and 0 < turn_share < 1 expected, got {self}")
        if len(self.look_back) != 2 or not 0.0 < self.look_back[0] <= self.look_back[1] < np.inf:
            raise ValueError(f"look_back must be two rising times, got {self.look_back}")

    def rules(self) -> Record:
        """The part that kernels read scans by."""
        return sealed(np.array([tuple(getattr(self, name) for name in RULES.names or ())], dtype=RULES))

    def gains(self) -> Record:
        """The part that kernels filter by."""
        jump = self.velocity_bound / np.sqrt(2.0)  # each component of the difference of two velocities in the bound
        cost = 2.0 * np.log((1.0 - self.turn_share) / self.turn_share)
        return sealed(np.array([(self.acceleration, jump, cost, self.gate, self.velocity_bound)], dtype=GAINS))


@dataclass(frozen=True, slots=True, eq=False)
class Tracks:
    """What the tracker tells of one moment, a row for each confirmed track, in the frame of the believed pose.

    `labels` `(k,)` holds for each beam of the scan the row of the track that it hit, -1 for none.
    """

    ids: NDArray[np.int64]  # (m,) never used twice
    centers: Array  # (m, 2) [m]
    velocities: Array  # (m, 2) [m/s]
    radii: Array  # (m,) [m]
    covariances: Array  # (m, 4, 4) of x, y and their rates
    ages: Array  # (m,) [s]
    unseen: Array  # (m,) [s] since it was last matched
    moving: NDArray[np.bool_]  # (m,) proved to move
    labels: NDArray[np.int64]  # (k,)

    @property
    def movers(self) -> Array:
        """Rows `(n, 5)` x, y, vx, vy, radius of what moves, as in `Observation.movers`."""
        return np.column_stack([self.centers, self.velocities, self.radii])[self.moving]


@dataclass(frozen=True, slots=True, eq=False)
class _Past:
    """A scan that was seen: when, from where, its beams, and the track that each of them hit."""

    time: float
    pose: Array
    beams: Rows
    ids: NDArray[np.int64]


class Tracker:
    """Follows moving discs through scans; call `update` once for every scan, `reset` before every run."""

    def __init__(self, params: TrackParams = TrackParams()) -> None:
        self.params = params
        self.rules, self.gains = params.rules(), params.gains()
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self.tracks = np.zeros(0, dtype=TRACK)
        self.time = -np.inf
        self.next_id = 0
        self.past: deque[_Past] = deque()

    def update(self, observation: Observation, chart: GridMap | None = None) -> Tracks:
        """The tracks after one more scan; what the chart explains is nobody's hit.

        Raises ValueError for an observation that is worthless or holds no scan, and for a time that does not grow.
        """
        fault = observation.faults()
        if fault or observation.ranges is None or observation.angles is None:
            raise ValueError(f"a tracker needs a scan and a pose: {fault or 'there is no scan'}")
        time = float(observation.time)
        if not self.time < time < np.inf:
            raise ValueError(f"time must grow from scan to scan, got {time} after {self.time}: reset between runs")
        pose = np.array(observation.pose, dtype=float)
        ranges, angles = np.array(observation.ranges, dtype=float), np.array(observation.angles, dtype=float)
        mask, field, frame = NO_CHART if chart is None else _read(chart)
        beams, groups = clusters.segment(
            ranges, angles, pose, float(observation.range_max), mask, field, frame, self.rules
        )
        owners = self._match(time, pose, beams, groups)
        self._judge(time, pose, beams, owners)
        self.time = time
        return self._told(ranges.size, beams, owners)

    def _match(self, time: float, pose: Array, beams: Rows, groups: Rows) -> NDArray[np.int64]:
        """Correct, begin and end tracks; for each beam the id of the track that it hit."""
        found = clusters.discs(beams, groups, pose, self.rules)
        old, dt = self.tracks, time - self.time
        owner = np.full(groups.size, -1)
        if old.size:
            now = filters.ahead(old, dt, self.gains)
            cost = filters.costs(now, found, dt, self.gains)
            pairs = np.column_stack(linear_sum_assignment(cost))
            pairs = pairs[cost[pairs[:, 0], pairs[:, 1]] < filters.FAR]
            fits = filters.refit(now, pairs, beams, groups, pose, self.rules)
            filters.correct(old, now, fits, pairs, time, dt, self.gains)
            owner[pairs[:, 1]] = now["id"][pairs[:, 0]]
            old = now[self._alive(now, time, dt, pose, beams)]
        self.tracks = old
        self._begin(time, found, owner)
        return filters.owners(beams, groups, owner)

    def _alive(self, now: Rows, time: float, dt: float, pose: Array, beams: Rows) -> NDArray[np.bool_]:
        """Which tracks live on: matched, or hidden not too long, or only just seen through."""
        lost = now["seen"] < time
        x, y = np.array(now["mean"][:, 0]), np.array(now["mean"][:, 1])
        now["absent"] += dt * (lost & clusters.seen_free(x, y, beams, pose, 0.0))
        kept = (now["absent"] <= self.params.patience) & (time - now["seen"] <= self.params.coast)
        return ~lost | (kept & (now["hits"] >= self.params.confirm))

    def _begin(self, time: float, found: Rows, owner: NDArray[np.int64]) -> None:
        """A track for each disc that is nobody's; one inside a disc that is tracked is a part of that."""
        free = np.flatnonzero((owner < 0) & np.isfinite(found["misfit"]))
        fresh = np.zeros(free.size, dtype=TRACK)
        count = 0
        doubt = 0.25 * self.params.velocity_bound**2  # each component of any velocity within the bound
        for k in free:
            disc = found[k]
            away = np.hypot(self.tracks["mean"][:, 0] - disc["x"], self.tracks["mean"][:, 1] - disc["y"])
            within = np.flatnonzero((away < self.tracks["radius"]) & (self.tracks["seen"] == time))
            if within.size:
                owner[k] = self.tracks["id"][within[0]]
                continue
            track = fresh[count]
            track["id"], track["born"], track["seen"], track["hits"] = self.next_id, time, time, 1
            track["mean"] = disc["x"], disc["y"], 0.0, 0.0
            track["cov"] = np.diag([disc["xx"], disc["yy"], doubt, doubt])
            track["cov"][0, 1] = track["cov"][1, 0] = disc["xy"]
            track["radius"], track["spread"] = disc["radius"], disc["spread"]
            owner[k], self.next_id, count = self.next_id, self.next_id + 1, count + 1
        self.tracks = np.concatenate([self.tracks, fresh[:count]])

    def _judge(self, time: float, pose: Array, beams: Rows, owners: NDArray[np.int64]) -> None:
        """Which tracks move: scans prove it, and their velocity is more than its doubt."""
        p, tracks = self.params, self.tracks
        share = np.zeros(tracks.size)
        for age in p.look_back:
            then = next((s for s in reversed(self.past) if time - s.time >= age - 1e-9), None)
            if then is not None and tracks.size:
                ids = np.array(tracks["id"])
                seen = filters.proofs(ids, beams, owners, pose, then.beams, then.ids, then.pose, p.free_margin)
                share = np.maximum(share, seen)
        speed = np.hypot(tracks["mean"][:, 2], tracks["mean"][:, 3])
        doubt = np.sqrt(0.5 * (tracks["cov"][:, 2, 2] + tracks["cov"][:, 3, 3]))
        seen_now = tracks["seen"] == time
        proof = np.clip(tracks["proof"] + np.where(share >= p.proof_share, 1.0, -0.5), 0.0, p.proofs + 1.0)
        tracks["proof"] = np.where(seen_now, proof, tracks["proof"])
        fast = speed > np.maximum(p.speed_min, 2.0 * doubt)
        begins = (tracks["proof"] >= p.proofs) & fast
        stays = (tracks["moving"] > 0) & (speed > 0.5 * p.speed_min) & (tracks["proof"] > 0.0)
        tracks["moving"] = np.where(seen_now, begins | stays, tracks["moving"])
        self.past.append(_Past(time, pose, beams, owners))
        while len(self.past) > 1 and time - self.past[1].time >= p.look_back[1]:
            self.past.popleft()

    def _told(self, size: int, beams: Rows, owners: NDArray[np.int64]) -> Tracks:
        """The confirmed tracks."""
        told = self.tracks[self.tracks["hits"] >= self.params.confirm]
        rows = np.full(self.next_id + 1, -1)  # the last stands for id -1
        rows[told["id"]] = np.arange(told.size)
        labels = np.full(size, -1)
        labels[beams["which"]] = rows[owners]
        mean = told["mean"]
        return Tracks(
            ids=np.array(told["id"]),
            centers=mean[:, :2].copy(),
            velocities=mean[:, 2:].copy(),
            radii=np.array(told["radius"]),
            covariances=np.array(told["cov"]),
            ages=self.time - told["born"],
            unseen=self.time - told["seen"],
            moving=told["moving"] > 0,
            labels=labels,
        )


def _read(chart: GridMap) -> tuple[NDArray[np.bool_], Array, Record]:
    return chart.occupied, chart.field_in_cells(), framed(chart.resolution, chart.origin)


def _warm() -> None:
    """Compile every kernel by following one disc through three scans."""
    tracker, angles, point = Tracker(), np.linspace(-0.3, 0.3, 31), np.zeros(2)
    for k in range(3):
        tracker.update(
            Observation(
                time=0.1 * k,
                pose=np.zeros(3),
                velocity=point,
                goal=point,
                points=np.zeros((0, 2)),
                ranges=np.where(np.abs(angles) < 0.2, 2.0, np.inf),
                angles=angles,
                range_max=5.0,
            )
        )
