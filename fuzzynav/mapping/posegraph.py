"""Poses from measured motions: chained one after the other, or all at once by least squares on the pose graph."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from fuzzynav.geometry import Array, compose, inverse, read_only, wrap
from fuzzynav.mapping.logs import ScanLog

__all__ = ["Solution", "chain", "residuals", "solve"]

Ids = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Corrected poses `(n, 3)`, the weighted squared error before each step and after the last, and whether the last
    step was below the tolerance. The arrays are read-only."""

    poses: Array
    errors: Array
    converged: bool

    def __post_init__(self) -> None:
        object.__setattr__(self, "poses", read_only(self.poses))
        object.__setattr__(self, "errors", read_only(self.errors))


def chain(log: ScanLog) -> Array:
    """Poses `(n, 3)` from the odometry edges alone, laid end to end from the first stored pose.

    Raises ValueError if a pose has no edge from the one before it.
    """
    given = log.edges[log.odometry_edges, 0]
    missing = np.setdiff1d(np.arange(len(log.poses) - 1), given)
    if len(missing):
        raise ValueError(f"no edge leads from pose {missing[0]} to pose {missing[0] + 1}: odometry is cut there")
    order, first = np.unique(given, return_index=True)
    motions = log.motions[log.odometry_edges][first][: len(order)]
    heading = log.poses[0, 2] + np.concatenate([[0.0], np.cumsum(motions[:, 2])])
    c, s = np.cos(heading[:-1]), np.sin(heading[:-1])
    steps = np.stack([c * motions[:, 0] - s * motions[:, 1], s * motions[:, 0] + c * motions[:, 1]], axis=-1)
    way = np.concatenate([[[0.0, 0.0]], np.cumsum(steps, axis=0)])
    return np.column_stack([log.poses[0, :2] + way, wrap(heading)])


def residuals(poses: ArrayLike, log: ScanLog) -> Array:
    """How far each measured motion misses the poses `(m, 3)`: the motion's end seen from where the poses put it."""
    p = np.asarray(poses, dtype=float)
    if p.shape != log.poses.shape or not np.isfinite(p).all():
        raise ValueError(f"poses must be finite with shape {log.poses.shape}, got {p.shape}")
    between = compose(inverse(p[log.edges[:, 0]]), p[log.edges[:, 1]])
    return compose(inverse(log.motions), between)


def solve(log: ScanLog, start: ArrayLike | None = None, steps: int = 30, tolerance: float = 1e-4) -> Solution:
    """Poses that fit all measured motions best in the least squares sense, by Gauss-Newton; the first pose stays.

    `start` is by default `chain(log)`. Ends when no pose moves by more than `tolerance` [m, rad]. A step that would
    raise the error is halved, at most ten times. Raises ValueError if the motions do not tell where every pose is.
    """
    poses = np.array(chain(log) if start is None else start, dtype=float)
    errors, moved = [_error(poses, log)], np.inf
    for _ in range(steps):
        delta = _step(poses, log)
        for _ in range(10):
            trial = poses + delta
            error = _error(trial, log)
            if error <= errors[-1] * (1.0 + 1e-12):
                break
            delta = delta / 2.0
        poses, moved = trial, float(np.abs(delta).max())
        errors.append(error)
        if moved < tolerance:
            break
    poses[:, 2] = wrap(poses[:, 2])
    return Solution(poses, np.array(errors), moved < tolerance)


def _error(poses: Array, log: ScanLog) -> float:
    e = residuals(poses, log)
    return float(np.einsum("ki,kij,kj->", e, log.information, e))


def _step(poses: Array, log: ScanLog) -> Array:
    """One Gauss-Newton step `(n, 3)`: the normal equations are sparse, as each edge joins two poses."""
    e = residuals(poses, log)
    by_first, by_second = _jacobians(poses, log)
    blocks, gradient = [], np.zeros((len(poses), 3))
    for side, jacobian in enumerate((by_first, by_second)):
        weighted = np.einsum("kji,kjl->kil", jacobian, log.information)
        np.add.at(gradient, log.edges[:, side], np.einsum("kij,kj->ki", weighted, e))
        for other, second in enumerate((by_first, by_second)):
            blocks.append((log.edges[:, side], log.edges[:, other], weighted @ second))
    normal = _assemble(blocks, 3 * len(poses))[3:, 3:]
    delta = np.zeros(3 * len(poses))
    try:
        factors = splu(csc_array(normal), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    except RuntimeError as error:
        raise ValueError(f"the motions of the log do not tell where every pose is: {error}") from error
    delta[3:] = factors.solve(-gradient.ravel()[3:])
    return delta.reshape(-1, 3)


def _jacobians(poses: Array, log: ScanLog) -> tuple[Array, Array]:
    """Derivatives `(m, 3, 3)` of the residuals by the first and the second pose of each edge."""
    a, b = poses[log.edges[:, 0]], poses[log.edges[:, 1]]
    turn, gap = a[:, 2] + log.motions[:, 2], b[:, :2] - a[:, :2]
    c, s = np.cos(turn), np.sin(turn)
    by_second = np.zeros((len(a), 3, 3))
    by_second[:, 0, 0] = by_second[:, 1, 1] = c
    by_second[:, 0, 1], by_second[:, 1, 0], by_second[:, 2, 2] = s, -s, 1.0
    by_first = -by_second
    by_first[:, 0, 2] = -s * gap[:, 0] + c * gap[:, 1]
    by_first[:, 1, 2] = -c * gap[:, 0] - s * gap[:, 1]
    return by_first, by_second


def _assemble(blocks: list[tuple[Ids, Ids, Array]], size: int) -> csc_array:
    """Sparse matrix from 3 x 3 blocks at the given pose numbers; blocks at the same place add up."""
    rows = np.concatenate([np.repeat(3 * r[:, None, None] + np.arange(3)[:, None], 3, axis=2) for r, _, _ in blocks])
    cols = np.concatenate([np.repeat(3 * c[:, None, None] + np.arange(3)[None, :], 3, axis=1) for _, c, _ in blocks])
    values = np.concatenate([v for _, _, v in blocks])
    return csc_array((values.ravel(), (rows.ravel(), cols.ravel())), shape=(size, size))
