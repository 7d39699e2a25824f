"""Monte Carlo localization: many guesses of the pose, weighed by a scan against a known map.

Each function takes a swarm and returns a new one; the random generator is passed, so that a seed fixes a run.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numba import njit
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

from fuzzynav.geometry import Array, read_only, sealed, wrap
from fuzzynav.localization.kalman import Belief, MotionNoise, sample_motions
from fuzzynav.maps.gridmap import GridMap, cells_across
from fuzzynav.maps.kernels import Record, framed
from fuzzynav.robot import move
from fuzzynav.sensors import Scan

__all__ = [
    "LikelihoodField",
    "MonteCarlo",
    "Swarm",
    "cluster",
    "drift",
    "effective_size",
    "likelihood_field",
    "log_likelihoods",
    "low_variance_resample",
    "recovery_share",
    "resample",
    "scatter",
    "spread",
    "step",
    "weigh",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class MonteCarlo:
    """Parameters of the filter.

    `hit_sigma` [m] is the spread of a beam's end about a surface, `random_share` the share of beams that end
    anywhere. `temper` is the exponent on the likelihood of a whole scan: neighbouring beams err together and
    must not be trusted as if they did not. `slow` and `fast` are the two forgetting rates of augmented recovery
    (both 0: no recovery). Raises ValueError for values out of range.
    """

    hit_sigma: float = 0.15  # [m]
    random_share: float = 0.15
    temper: float = 0.3
    beams: int = 30  # used of each scan, evenly spaced
    resample_below: float = 0.5  # of the effective size over the number of particles
    slow: float = 0.02
    fast: float = 0.2

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            low_open = field.name in ("hit_sigma", "temper", "beams", "random_share")
            top = np.inf if field.name in ("hit_sigma", "beams") else 1.0
            if not (np.isfinite(value) and value <= top and (value > 0 if low_open else value >= 0)):
                raise ValueError(f"MonteCarlo.{field.name} is out of its range: {value}")
        if self.slow > self.fast:
            raise ValueError(f"MonteCarlo.slow {self.slow} must not exceed fast {self.fast}")


@dataclass(frozen=True, slots=True, eq=False)
class Swarm:
    """Particles: poses `(n, 3)`, weights `(n,)` with the sum 1, and the two averages of recovery (0: not yet known).

    Both arrays are read-only. Raises ValueError if there is no particle, a pose is not finite, or the weights are no
    weights.
    """

    poses: Array
    weights: Array
    slow: float = 0.0
    fast: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "poses", read_only(self.poses))
        object.__setattr__(self, "weights", read_only(self.weights))
        if self.poses.ndim != 2 or self.poses.shape[1:] != (3,) or len(self.poses) == 0:
            raise ValueError(f"a swarm needs poses (n, 3) with n >= 1, got shape {self.poses.shape}")
        if self.weights.shape != self.poses.shape[:1] or not np.isfinite(self.poses).all():
            raise ValueError("a swarm needs finite poses and one weight for each")
        if not (np.all(self.weights >= 0) and abs(self.weights.sum() - 1.0) < 1e-9):
            raise ValueError("the weights of a swarm must not be negative and must have the sum 1")


@dataclass(frozen=True, slots=True, eq=False)
class LikelihoodField:
    """Log likelihood of a beam that ends in each cell, `(rows, cols)`, read-only, and what it was made from."""

    log: Array
    grid: GridMap
    resolution: float
    floor: float  # of a beam that ends outside the map

    def __post_init__(self) -> None:
        object.__setattr__(self, "log", read_only(self.log))


# --- making swarms -----------------------------------------------------------------------------


def scatter(grid: GridMap, n: int, rng: Generator) -> Swarm:
    """`n` equally likely particles anywhere on the free cells of a map, with any heading.

    Both averages of recovery start at 1, a perfect match, so that the first scans keep sending out random particles
    until some of them match. Raises ValueError if n is not positive or no cell is free.
    """
    if n < 1:
        raise ValueError(f"a swarm needs at least one particle, got n = {n}")
    return Swarm(_anywhere(grid, n, rng), np.full(n, 1.0 / n), 1.0, 1.0)


def _anywhere(grid: GridMap, n: int, rng: Generator) -> Array:
    """Poses `(n, 3)` drawn evenly from the free cells."""
    rows, cols = np.nonzero(~grid.occupied)
    if len(rows) == 0:
        raise ValueError("the map has no free cell to put a particle on")
    pick = rng.integers(len(rows), size=n)
    xy = (np.stack([cols[pick], rows[pick]], axis=-1) + rng.random((n, 2))) * grid.resolution + grid.origin
    return np.column_stack([xy, rng.uniform(-np.pi, np.pi, n)])


def spread(belief: Belief, n: int, rng: Generator) -> Swarm:
    """`n` equally likely particles drawn from a Gaussian belief."""
    if n < 1:
        raise ValueError(f"a swarm needs at least one particle, got n = {n}")
    poses = rng.multivariate_normal(belief.mean, belief.covariance, size=n, method="eigh")
    poses[:, 2] = wrap(poses[:, 2])
    return Swarm(poses, np.full(n, 1.0 / n))


# --- one cycle ---------------------------------------------------------------------------------


def drift(swarm: Swarm, motion: ArrayLike, noise: MotionNoise, rng: Generator) -> Swarm:
    """Every particle driven by the motion (advance [m], turn [rad]) of odometry, each with noise of its own."""
    moved = np.asarray(motion, dtype=float)
    if moved.shape != (2,) or not np.isfinite(moved).all():
        raise ValueError(f"a motion is a finite advance and turn, got {moved.tolist()}")
    each = sample_motions(np.broadcast_to(moved, (len(swarm.poses), 2)), noise, rng)
    return replace(swarm, poses=move(swarm.poses, each, 1.0))


def likelihood_field(grid: GridMap, params: MonteCarlo, resolution: float = 0.05) -> LikelihoodField:
    """How likely a beam ends at each place of the map: a Gaussian of the distance to the nearest obstacle,
    mixed with `random_share` of beams that end anywhere; cells are cut to at most `resolution` [m].

    Raises ValueError for a resolution that is not positive or would cut the map into more than 25 million cells.

    >>> field = likelihood_field(GridMap.from_ascii("..#"), MonteCarlo(), 1.0)
    >>> field.log[0, 2].round(6), field.floor.round(3)             # on the obstacle, and far from it
    (np.float64(0.0), np.float64(-1.897))
    """
    rows, cols = grid.shape
    per_cell, _ = cells_across(grid.resolution, grid.resolution, resolution)
    cells_across(rows * per_cell, cols * per_cell, 1.0)  # refuses what would not fit in memory
    fine = GridMap(
        np.kron(grid.occupied, np.ones((per_cell, per_cell), dtype=bool)), grid.resolution / per_cell, grid.origin
    )
    distance = fine.distance_field(border=False)
    hit = np.exp(-0.5 * (distance / params.hit_sigma) ** 2)
    log = np.log((1.0 - params.random_share) * hit + params.random_share)
    return LikelihoodField(sealed(log), grid, fine.resolution, np.log(params.random_share))


@njit(cache=True)
def _score(
    poses: Array,
    beams: Array,
    log: Array,
    fine: float,
    floor: float,
    occupied: NDArray[np.bool_],
    frame: Record,
) -> Array:
    """Sum over the beams' ends `(b, 2)` in the body frame of the field's value, for each pose; floor off the map.

    `log` has cells of the side `fine` [m], the map `occupied` those of its `frame`.
    """
    rows, cols = log.shape
    out = np.empty(len(poses))
    for i in range(len(poses)):
        x, y = poses[i, 0] - frame[0].x, poses[i, 1] - frame[0].y
        c, s = np.cos(poses[i, 2]), np.sin(poses[i, 2])
        u, v = int(np.floor(x / frame[0].resolution)), int(np.floor(y / frame[0].resolution))
        if u < 0 or v < 0 or u >= occupied.shape[1] or v >= occupied.shape[0] or occupied[v, u]:
            out[i] = floor * len(beams)
            continue
        total = 0.0
        for j in range(len(beams)):
            col = int(np.floor((x + c * beams[j, 0] - s * beams[j, 1]) / fine))
            row = int(np.floor((y + s * beams[j, 0] + c * beams[j, 1]) / fine))
            inside = 0 <= row < rows and 0 <= col < cols
            total += log[row, col] if inside else floor
        out[i] = total
    return out


def log_likelihoods(poses: ArrayLike, scan: Scan, field: LikelihoodField, params: MonteCarlo) -> tuple[Array, int]:
    """Log likelihood `(n,)` of a scan from each pose, and the number of beams used.

    Beams that met nothing (inf) or failed (nan) say nothing here. A pose in an obstacle or off the map gets the
    likelihood of a scan of random beams.
    """
    hits = np.flatnonzero(scan.hits)
    if len(hits) > params.beams:
        hits = hits[np.linspace(0, len(hits) - 1, int(params.beams)).round().astype(int)]
    ends = np.stack([scan.ranges[hits] * np.cos(scan.angles[hits]), scan.ranges[hits] * np.sin(scan.angles[hits])], -1)
    where = sealed(np.ascontiguousarray(np.atleast_2d(np.asarray(poses, dtype=float))).view())
    frame = framed(field.grid.resolution, field.grid.origin)
    fine, floor = float(field.resolution), float(field.floor)
    return _score(where, ends, field.log, fine, floor, field.grid.occupied, frame), len(hits)


def weigh(swarm: Swarm, scan: Scan, field: LikelihoodField, params: MonteCarlo) -> Swarm:
    """The swarm with its weights multiplied by the tempered likelihood of the scan, and its recovery averages moved.

    A scan without a single hit changes nothing.
    """
    log, used = log_likelihoods(swarm.poses, scan, field, params)
    if used == 0:
        return swarm
    weights = swarm.weights * np.exp(params.temper * (log - log.max()))
    match = float(swarm.weights @ np.exp(log / used))  # geometric mean over the beams, in (0, 1]
    slow = swarm.slow + params.slow * (match - swarm.slow) if swarm.slow > 0 else match
    fast = swarm.fast + params.fast * (match - swarm.fast) if swarm.fast > 0 else match
    return Swarm(swarm.poses, weights / weights.sum(), slow, fast)


def effective_size(weights: ArrayLike) -> float:
    """Number of equally weighted particles that would say as much: 1 / sum of squares.

    >>> effective_size([0.5, 0.5, 0.0, 0.0])
    2.0
    """
    return float(1.0 / np.sum(np.asarray(weights, dtype=float) ** 2))


def low_variance_resample(weights: ArrayLike, rng: Generator) -> NDArray[np.int64]:
    """Indices `(n,)` drawn in proportion to the weights by one random comb of n equal teeth.

    A particle of weight w is drawn floor(n w) or ceil(n w) times.
    """
    w = np.asarray(weights, dtype=float)
    n = len(w)
    teeth = (rng.random() + np.arange(n)) / n
    total = np.cumsum(w)
    found: NDArray[np.int64] = np.minimum(np.searchsorted(total, teeth * total[-1], side="right"), n - 1)
    return found


def recovery_share(swarm: Swarm) -> float:
    """Share of particles to replace by random ones: how far the match of late falls below the long-term match."""
    return max(0.0, 1.0 - swarm.fast / swarm.slow) if swarm.slow > 0 else 0.0


def resample(swarm: Swarm, grid: GridMap, params: MonteCarlo, rng: Generator) -> Swarm:
    """The swarm drawn anew where its effective size is too small, with random particles where recovery asks."""
    n, share = len(swarm.poses), recovery_share(swarm)
    fresh = rng.random(n) < share if share > 0 else np.zeros(n, dtype=bool)
    if not fresh.any() and effective_size(swarm.weights) >= params.resample_below * n:
        return swarm
    poses = swarm.poses[low_variance_resample(swarm.weights, rng)].copy()
    poses[fresh] = _anywhere(grid, int(fresh.sum()), rng)
    return Swarm(poses, np.full(n, 1.0 / n), swarm.slow, swarm.fast)


def step(swarm: Swarm, scan: Scan, field: LikelihoodField, params: MonteCarlo, rng: Generator) -> tuple[Swarm, Belief]:
    """Weigh the swarm by a scan, read its estimate, and resample it; call `drift` for the motion before.

    The estimate is taken before random particles come in.
    """
    weighed = weigh(swarm, scan, field, params)
    return resample(weighed, field.grid, params, rng), cluster(weighed)


def cluster(swarm: Swarm, radius: float = 0.6) -> Belief:
    """Mean and covariance of the heaviest group of particles within `radius` [m] and 45 degrees of each other.

    The group is found on a coarse histogram of position and heading and centred by three rounds of averaging.
    """
    turned = np.column_stack([swarm.poses[:, :2], wrap(swarm.poses[:, 2])])
    cells = np.floor(turned / [radius, radius, np.pi / 4.0]).astype(np.int64)
    low = cells.min(axis=0)
    size = cells.max(axis=0) - low + 1
    _, which = np.unique((cells - low) @ [size[1] * size[2], size[2], 1], return_inverse=True)
    near = which == np.argmax(np.bincount(which, weights=swarm.weights))
    mean = _mean(swarm.poses[near], swarm.weights[near])
    for _ in range(3):
        gap = swarm.poses - mean
        turn = np.abs(wrap(gap[:, 2]))
        near = (np.hypot(gap[:, 0], gap[:, 1]) <= radius) & (turn <= np.pi / 4.0) & (swarm.weights > 0)
        if not near.any():
            break
        mean = _mean(swarm.poses[near], swarm.weights[near])
    near = near if near.any() else which == which[np.argmax(swarm.weights)]
    gap = swarm.poses[near] - mean
    gap[:, 2] = wrap(gap[:, 2])
    w = swarm.weights[near] / swarm.weights[near].sum()
    return Belief(mean, (gap * w[:, None]).T @ gap)


def _mean(poses: Array, weights: Array) -> Array:
    """Weighted mean pose with the heading averaged on the circle."""
    w = weights / weights.sum()
    heading = np.arctan2(w @ np.sin(poses[:, 2]), w @ np.cos(poses[:, 2]))
    return np.array([w @ poses[:, 0], w @ poses[:, 1], heading])


def _warm() -> None:
    """Compile the kernel."""
    grid = GridMap(np.zeros((2, 2), dtype=bool), 1.0)
    scan = Scan(angles=np.zeros(1), ranges=np.ones(1), range_max=2.0)
    log_likelihoods(np.zeros((1, 3)), scan, likelihood_field(grid, MonteCarlo(), 1.0), MonteCarlo())
