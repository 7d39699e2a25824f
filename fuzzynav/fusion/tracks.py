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
from fuzzynav.fusion.filters import FAR, TRACK, kalman_step
from fuzzynav.geometry import Array, sealed
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.maps.kernels import Record, framed

__all__ = ["TrackParams", "Tracker", "Tracks", "kalman_step"]

TURN = 2.0 * np.pi
NO_CHART = (sealed(np.zeros((0, 0), dtype=np.bool_)), sealed(np.zeros((0, 0))), framed(1.0, (0.0, 0.0)))


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackParams:
    """What the tracker believes of scanner and movers. Raises ValueError for values out of range.

    A turn is a sudden change of velocity: where it explains a match better than going on, by the odds of turn_share,
    the filter forgets its velocity and finds the new one in two or three scans; between turns it may then be slow to
    change its mind, and smooth. Two or three beams may be a post that the scan before missed: no proof of motion.
    """

    range_noise: float = 0.01  # [m] standard deviation of a range
    radius_min: float = 0.15  # [m] discs are fitted between these two: movers of 0.2 to 0.6 m, and some room
    radius_max: float = 0.75
    radius_mean: float = 0.35  # [m] believed of a disc never seen before, with its standard deviation
    radius_spread: float = 0.2
    misfit_max: float = 0.04  # [m] root mean square distance of hits from the rim of what still is a disc: 4 sigma
    beams_min: int = 2  # a cluster has at least so many: a disc of 0.2 m at 10 m in a scan of 360
    bridge: float = 3.5  # [gaps between beams] so far apart two beams are still neighbours: two may be lost
    chart_tolerance: float = 0.15  # [m] a hit this near to the chart's surfaces is explained by them
    velocity_bound: float = 2.0  # [m/s] nothing is faster; estimates are cut to it
    acceleration: float = 0.02  # [m^2/s^3] spectral density of white acceleration noise: 0.14 m/s in a second
    turn_share: float = 0.05  # of the steps have a turn, by any velocity within the bound
    gate: float = 13.8  # squared Mahalanobis distance that 1 of 1000 right pairs exceeds (chi-square, 2 degrees)
    confirm: int = 2  # matches until a track is told: motion is proved apart, so that early is not rash
    coast: float = 2.0  # [s] a hidden track lives on
    patience: float = 0.25  # [s] a track lives on while scans look through the place where it should be
    look_back: tuple[float, ...] = (0.1, 0.3, 1.0)  # [s] ages of the scans that prove motion: the fast and the slow
    free_margin: float = 0.03  # [m] seen free means by more than this: 3 sigma
    proof_share: float = 0.2  # of the hits of a track prove it moving
    witnesses: int = 4  # hits that a track has at least in a scan that shall prove something
    proofs: float = 2.0  # so many proofs make a mover; twice the share counts twice
    speed_min: float = 0.06  # [m/s] slower than this nothing moves
    drift: float = 0.0  # share of its way and of its turn by which the believed pose may err from scan to scan

    def __post_init__(self) -> None:
        checks.positive_fields(self, may_be_zero=("drift",), leave=("look_back", "turn_share", "proof_share"))
        checks.share(turn_share=self.turn_share, proof_share=self.proof_share)
        if not (self.radius_min < self.radius_max and self.beams_min >= 2 and 0.0 < self.turn_share < 1.0):
            raise ValueError(f"radius_min < radius_max, beams_min >= 2 and 0 < turn_share < 1 expected, got {self}")
        ages = np.asarray(self.look_back, dtype=float)
        if not (ages.size and ages[0] > 0.0 and (np.diff(ages) > 0.0).all() and np.isfinite(ages).all()):
            raise ValueError(f"look_back must be positive rising times, got {self.look_back}")

    def rules(self) -> Record:
        """All that kernels read."""
        return sealed(np.array([tuple(getattr(self, name) for name in RULES.names or ())], dtype=RULES))


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


class Tracker:
    """Follows moving discs through scans; call `update` once for every scan, `reset` before every run.

    All it tells is in the frame of the believed pose, errors of odometry included.
    """

    def __init__(self, params: TrackParams = TrackParams()) -> None:
        self.params = params
        self.rules = params.rules()
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self.tracks = np.zeros(0, dtype=TRACK)
        self.time = -np.inf
        self.next_id = 0
        self.past: deque[tuple[Array, Rows]] = deque()  # moments and beams, oldest first

    def update(self, observation: Observation, chart: GridMap | None = None) -> Tracks:
        """The tracks after one more scan; what the chart explains is nobody's hit.

        Raises ValueError where there is no scan or no finite pose, and for a time that does not grow.
        """
        ranges, angles = _scan(observation)
        pose = checks.pose(observation.pose)
        time = float(observation.time)
        if not self.time < time < np.inf:
            raise ValueError(f"time must grow from scan to scan, got {time} after {self.time}: reset between runs")
        moment = self._moment(pose, time)
        mask, field, frame = NO_CHART if chart is None else _read(chart)
        reach = float(observation.range_max)
        beams, groups = clusters.observe(ranges, angles, moment, reach, mask, field, frame, self.rules)
        self._match(moment, beams, groups)
        labels = self._judge(moment, beams, ranges.size)
        self.time = time
        return self._told(labels)

    def _moment(self, pose: Array, time: float) -> Array:
        """Pose, time, time since the last scan; way [m] and turn [rad] of the robot so far, and since the last scan."""
        way = turn = before_way = before_turn = 0.0
        if self.past:
            last = self.past[-1][0]
            before_way, before_turn = last[5], last[6]
            way, turn = np.hypot(pose[0] - last[0], pose[1] - last[1]), abs(pose[2] - last[2]) % TURN
            turn = min(turn, TURN - turn)
        return np.array([*pose, time, time - self.time, before_way + way, before_turn + turn, way, turn])

    def _match(self, moment: Array, beams: Rows, groups: Rows) -> None:
        """Match tracks and clusters at the least cost; correct, end and begin tracks."""
        now, groups, cost = filters.propose(self.tracks, beams, groups, moment, self.rules)
        rows, columns = linear_sum_assignment(cost)
        good = cost[rows, columns] < FAR
        now["match"][rows[good]] = columns[good]
        self.tracks, self.next_id = filters.settle(self.tracks, now, beams, groups, moment, self.rules, self.next_id)

    def _judge(self, moment: Array, beams: Rows, size: int) -> NDArray[np.int64]:
        """Decide which tracks move; for each beam the row of its track among the confirmed ones, -1 for none."""
        shares, time = np.zeros(self.tracks.size), moment[3]
        for age in self.params.look_back:
            for past, then in reversed(self.past):
                if time - past[3] >= age - 1e-9:
                    shares = filters.judge(self.tracks, beams, moment, then, past, shares, self.rules)
                    break
        self.past.append((moment, beams))
        while len(self.past) > 1 and time - self.past[1][0][3] >= self.params.look_back[-1]:
            self.past.popleft()
        return filters.decide(self.tracks, beams, shares, time, size, self.rules)

    def _told(self, labels: NDArray[np.int64]) -> Tracks:
        """The confirmed tracks."""
        told = self.tracks[self.tracks["hits"] >= self.params.confirm]
        state = told["state"]
        return Tracks(
            ids=told["id"].copy(),
            centers=state[:, :2].copy(),
            velocities=state[:, 2:].copy(),
            radii=told["radius"].copy(),
            covariances=told["cov"].copy(),
            ages=self.time - told["born"],
            unseen=self.time - told["seen"],
            moving=told["moving"] > 0,
            labels=labels,
        )


def _scan(observation: Observation) -> tuple[Array, Array]:
    """Ranges and angles of the scan, as copies that kernels may take; raises ValueError where there is none."""
    if observation.ranges is None or observation.angles is None:
        raise ValueError("a tracker needs a scan, and there is none: give ranges and angles")
    ranges, angles = np.array(observation.ranges, dtype=float), np.array(observation.angles, dtype=float)
    if ranges.ndim != 1 or ranges.shape != angles.shape or not np.isfinite(angles).all():
        raise ValueError(f"a scan needs one range for each finite angle, got shapes {ranges.shape} and {angles.shape}")
    if not observation.range_max > 0.0:
        raise ValueError(f"range_max must be positive metres, got {observation.range_max}")
    return ranges, angles


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
