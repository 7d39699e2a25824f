"""Compiled: the Kalman filter of a track, what a match costs, and the proof that something moves."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fuzzynav.fusion.clusters import DISC, Row, Rows, fit_disc, seen_free
from fuzzynav.geometry import Array
from fuzzynav.maps.kernels import Record

__all__ = [
    "FAR",
    "GAINS",
    "TRACK",
    "ahead",
    "correct",
    "costs",
    "kalman_correct",
    "kalman_predict",
    "kalman_step",
    "owners",
    "proofs",
    "refit",
]

FAR = 1e6  # cost of a pair that is none
TRACK = np.dtype(
    (
        np.record,
        [
            ("id", "i8"),
            ("mean", "f8", (4,)),  # x, y [m] and their rates [m/s]
            ("cov", "f8", (4, 4)),
            ("radius", "f8"),
            ("spread", "f8"),  # [m] standard deviation of the radius
            ("born", "f8"),
            ("seen", "f8"),  # [s] when it was last matched
            ("absent", "f8"),  # [s] for how long the scans have looked through it
            ("hits", "i8"),
            ("proof", "f8"),  # scans that showed it moving, forgotten one by one
            ("moving", "i8"),
        ],
    )
)
GAINS = np.dtype(
    (np.record, [("acceleration", "f8"), ("jump", "f8"), ("jump_cost", "f8"), ("gate", "f8"), ("bound", "f8")])
)


@njit(cache=True)
def kalman_predict(mean: Array, cov: Array, dt: float, q: float) -> tuple[Array, Array]:
    """State x, y, vx, vy and its covariance a time dt [s] later; q [m^2/s^3]: density of white acceleration noise."""
    step, noise = np.eye(4), np.zeros((4, 4))
    for k in range(2):
        step[k, k + 2] = dt
        noise[k, k], noise[k, k + 2], noise[k + 2, k + 2] = q * dt**3 / 3.0, q * dt**2 / 2.0, q * dt
        noise[k + 2, k] = noise[k, k + 2]
    return step @ mean, step @ cov @ step.T + noise


@njit(cache=True)
def kalman_correct(mean: Array, cov: Array, z: Array, r: Array) -> tuple[Array, Array]:
    """State and covariance after the place z (2,) [m] was measured with covariance r (2, 2)."""
    gain = np.linalg.solve(cov[:2, :2] + r, np.ascontiguousarray(cov[:2])).T
    after = cov - gain @ np.ascontiguousarray(cov[:2])
    return mean + gain @ (z - mean[:2]), 0.5 * (after + after.T)


@njit(cache=True)
def kalman_step(mean: Array, cov: Array, z: Array, dt: float, q: float, r: Array) -> tuple[Array, Array]:
    """One step of the constant-velocity filter: predict by dt [s], correct by the measured place z."""
    ahead, doubt = kalman_predict(mean, cov, dt, q)
    return kalman_correct(ahead, doubt, z, r)


@njit(cache=True)
def _surprise(mean: Array, cov: Array, disc: Row, more: float) -> tuple[float, float]:
    """Squared Mahalanobis distance of a disc and minus twice its log likelihood; `more`: variance added."""
    xx, xy, yy = cov[0, 0] + disc.xx + more, cov[0, 1] + disc.xy, cov[1, 1] + disc.yy + more
    dx, dy = disc.x - mean[0], disc.y - mean[1]
    det = xx * yy - xy * xy
    squared = (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / det
    return squared, squared + np.log(det)


@njit(cache=True)
def ahead(tracks: Rows, dt: float, gains: Record) -> Rows:
    """All tracks a time later."""
    out = tracks.copy()
    for k in range(tracks.size):
        mean, cov = kalman_predict(tracks[k].mean, tracks[k].cov, dt, gains[0].acceleration)
        out[k].mean[:], out[k].cov[:] = mean, cov
    return out


@njit(cache=True)
def costs(tracks: Rows, found: Rows, dt: float, gains: Record) -> Array:
    """Cost (m, n) of matching each predicted track with each disc: the better of going on and of a sudden turn."""
    gain = gains[0]
    out = np.full((tracks.size, found.size), FAR)
    turned = (gain.jump * dt) ** 2
    for i in range(tracks.size):
        for k in range(found.size):
            if found[k].misfit == np.inf:
                continue
            squared, wild = _surprise(tracks[i].mean, tracks[i].cov, found[k], turned)
            if squared <= gain.gate:
                _, calm = _surprise(tracks[i].mean, tracks[i].cov, found[k], 0.0)
                other = found[k].spread ** 2 + tracks[i].spread ** 2 + 0.0025
                out[i, k] = min(calm, wild + gain.jump_cost) + (found[k].radius - tracks[i].radius) ** 2 / other
    return out


@njit(cache=True)
def correct(
    old: Rows,
    now: Rows,
    fits: Rows,
    pairs: NDArray[np.int64],
    time: float,
    dt: float,
    gains: Record,
) -> None:
    """Correct the predicted tracks `now` by their discs, in place; pairs (p, 2): track, disc."""
    gain = gains[0]
    r = np.empty((2, 2))
    for p in range(pairs.shape[0]):
        i = pairs[p, 0]
        fit = fits[p]
        r[0, 0], r[0, 1], r[1, 0], r[1, 1] = fit.xx, fit.xy, fit.xy, fit.yy
        _, calm = _surprise(now[i].mean, now[i].cov, fit, 0.0)
        _, wild = _surprise(now[i].mean, now[i].cov, fit, (gain.jump * dt) ** 2 / 3.0)
        q = gain.acceleration if calm <= wild + gain.jump_cost else gain.jump**2 / dt
        mean, cov = kalman_step(old[i].mean, old[i].cov, np.array([fit.x, fit.y]), dt, q, r)
        speed = np.hypot(mean[2], mean[3])
        if speed > gain.bound:
            mean[2:] *= gain.bound / speed
        now[i].mean[:], now[i].cov[:] = mean, cov
        now[i].radius, now[i].spread = fit.radius, max(fit.spread, 0.01)
        now[i].seen, now[i].absent = time, 0.0
        now[i].hits += 1


@njit(cache=True)
def refit(
    tracks: Rows,
    pairs: NDArray[np.int64],
    beams: Rows,
    groups: Rows,
    pose: Array,
    rules: Record,
) -> Rows:
    """The disc of each pair anew, now that the radius is known from the track."""
    out = np.empty(pairs.shape[0], dtype=DISC)
    for p in range(pairs.shape[0]):
        track = tracks[pairs[p, 0]]
        fit_disc(beams, groups[pairs[p, 1]], pose, track.radius, track.spread, rules, out[p])
    return out


@njit(cache=True)
def owners(beams: Rows, groups: Rows, owner: NDArray[np.int64]) -> NDArray[np.int64]:
    """For each beam of the slice order the owner of its cluster, -1 for none."""
    out = np.full(beams.size, -1)
    for k in range(groups.size):
        for j in range(groups[k].count):
            out[groups[k].first + j] = owner[k]
    return out


@njit(cache=True)
def proofs(
    ids: NDArray[np.int64],
    beams: Rows,
    mine: NDArray[np.int64],
    pose: Array,
    then: Rows,
    theirs: NDArray[np.int64],
    pose_then: Array,
    margin: float,
) -> Array:
    """Share of each track's hits that an earlier scan looked through, or of its earlier hits that this one does."""
    came = seen_free(beams["x"], beams["y"], then, pose_then, margin)
    left = seen_free(then["x"], then["y"], beams, pose, margin)
    out = np.zeros(ids.size)
    for k in range(ids.size):
        free = hits = 0
        for j in range(beams.size):
            if mine[j] == ids[k]:
                hits += 1
                free += came[j]
        share = free / hits if hits > 0 else 0.0
        free = hits = 0
        for j in range(then.size):
            if theirs[j] == ids[k]:
                hits += 1
                free += left[j]
        out[k] = max(share, free / hits if hits > 0 else 0.0)
    return out


def _warm() -> None:
    """Compile the step; the tracker's warming compiles the rest."""
    kalman_step(np.zeros(4), np.eye(4), np.zeros(2), 0.1, 0.1, np.eye(2))
