"""Compiled: the Kalman filter of a track, what a match costs, how tracks begin and end, and the proof of motion."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fuzzynav.fusion.clusters import GROUP, NOBODY, Row, Rows, at_bearing, fit_disc, looked_past
from fuzzynav.geometry import Array
from fuzzynav.maps.kernels import Record

__all__ = ["FAR", "TRACK", "decide", "judge", "kalman_correct", "kalman_predict", "kalman_step", "propose", "settle"]

FAR = 1e6  # cost of a pair that is none
RIM = 0.05  # [m] a hit this near to the rim of a disc that is expected may belong to it
SURE = 0.01  # [m] no radius is known better: nothing is a perfect disc
ODD = 0.05  # [m] radii that differ by this much may still be one disc
TRACK = np.dtype(
    (
        np.record,
        [
            ("id", "i8"),
            ("match", "i8"),  # the cluster that it is matched with, -1: none
            ("state", "f8", (4,)),  # x, y [m] and their rates [m/s]
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


@njit(cache=True)
def kalman_predict(mean: Array, cov: Array, dt: float, q: float) -> tuple[Array, Array]:
    """State x, y, vx, vy and its covariance a time dt [s] later; q [m^2/s^3]: density of white acceleration noise."""
    step, noise = np.eye(4), np.zeros((4, 4))
    for k in range(2):
        step[k, k + 2] = dt
        noise[k, k], noise[k + 2, k + 2] = q * dt**3 / 3.0, q * dt
        noise[k, k + 2] = noise[k + 2, k] = q * dt**2 / 2.0
    return step @ mean, step @ cov @ step.T + noise


@njit(cache=True)
def kalman_correct(mean: Array, cov: Array, z: Array, r: Array) -> tuple[Array, Array]:
    """State and covariance after the place z (2,) [m] was measured with covariance r (2, 2)."""
    seen = np.ascontiguousarray(cov[:2])
    gain = np.linalg.solve(seen[:, :2] + r, seen).T
    after = cov - gain @ seen
    return mean + gain @ (z - mean[:2]), 0.5 * (after + after.T)


@njit(cache=True)
def kalman_step(mean: Array, cov: Array, z: Array, dt: float, q: float, r: Array) -> tuple[Array, Array]:
    """One step of the constant-velocity filter: predict by dt [s], correct by the measured place z."""
    ahead, doubt = kalman_predict(mean, cov, dt, q)
    return kalman_correct(ahead, doubt, z, r)


@njit(cache=True)
def _surprise(track: Row, group: Row, more: float) -> tuple[float, float]:
    """Squared Mahalanobis distance of a disc and minus twice its log likelihood; `more`: variance added."""
    mean, cov = track.state, track.cov
    xx, xy, yy = cov[0, 0] + group.xx + more, cov[0, 1] + group.xy, cov[1, 1] + group.yy + more
    dx, dy = group.x - mean[0], group.y - mean[1]
    det = xx * yy - xy * xy
    squared = (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / det
    return squared, squared + np.log(det)


@njit(cache=True)
def _turn(rules: Record) -> tuple[float, float]:
    """Standard deviation [m/s] of each component of a sudden change of velocity, and what believing in it costs.

    The difference of two velocities within the bound; odds of a turn against going on.
    """
    share = rules[0].turn_share
    return rules[0].velocity_bound / np.sqrt(2.0), 2.0 * np.log((1.0 - share) / share)


@njit(cache=True)
def _allow(track: Row, moment: Array, rules: Record) -> None:
    """Add to the doubt about a place what odometry may err in one step: it shifts and turns all that is seen."""
    away = np.hypot(track.state[0] - moment[0], track.state[1] - moment[1])
    more = (rules[0].drift * (moment[7] + away * moment[8])) ** 2
    track.cov[0, 0] += more
    track.cov[1, 1] += more


@njit(cache=True)
def propose(tracks: Rows, beams: Rows, groups: Rows, moment: Array, rules: Record) -> tuple[Rows, Rows, Array]:
    """Tracks predicted to this moment, clusters with what is carved out of large ones, and costs (m, n) of matches.

    A match costs the better of going on and of a sudden turn, and what the radii differ. `moment`: the pose of the
    scan, its time and the time since the one before, the way [m] and turn [rad] of the robot so far and since then.
    What odometry may have erred since then is added to the doubt of `tracks`, in place.
    """
    now, dt = tracks.copy(), moment[4]
    for i in range(now.size):
        _allow(tracks[i], moment, rules)
        mean, cov = kalman_predict(tracks[i].state, tracks[i].cov, dt, rules[0].acceleration)
        now[i].state[:], now[i].cov[:] = mean, cov
        now[i].match = -1
    groups = _carve(now, beams, groups, moment, rules)
    costs = np.full((now.size, groups.size), FAR)
    jump, price = _turn(rules)
    for i in range(now.size):
        for k in range(groups.size):
            if groups[k].misfit == np.inf:
                continue
            _, calm = _surprise(now[i], groups[k], 0.0)
            squared, wild = _surprise(now[i], groups[k], (jump * dt) ** 2)
            if squared <= rules[0].gate:
                doubt = groups[k].spread ** 2 + now[i].spread ** 2 + ODD**2
                costs[i, k] = min(calm, wild + price) + (groups[k].radius - now[i].radius) ** 2 / doubt
    return now, groups, costs


@njit(cache=True)
def _carve(now: Rows, beams: Rows, groups: Rows, moment: Array, rules: Record) -> Rows:
    """Clusters, and those hits of clusters that are no disc which lie on the rim of a mover expected there.

    So two movers that touch in the scan, or one beside a wall, are still seen apart.
    """
    m = beams.size
    unclear = np.full(m, -1)
    for k in range(groups.size):
        if groups[k].misfit == np.inf:
            unclear[groups[k].first : groups[k].first + groups[k].count] = k
    near, best = np.full(m, -1), np.full(m, np.inf)
    for i in range(now.size):
        if not now[i].moving:
            continue
        x, y, radius = now[i].state[0], now[i].state[1], now[i].radius
        dx, dy = x - moment[0], y - moment[1]
        away = np.hypot(dx, dy)
        middle = at_bearing(beams, np.arctan2(dy, dx))
        rim = min(RIM + 2.0 * np.sqrt(0.5 * (now[i].cov[0, 0] + now[i].cov[1, 1])), 0.3)
        half = np.arcsin(min((radius + rim) / max(away, 1e-9), 1.0))
        for way in range(2):
            j, turned = middle, 0.0
            for _ in range(m // 2):
                if turned > half:
                    break
                if unclear[j] >= 0:
                    miss = abs(np.hypot(beams[j].x - x, beams[j].y - y) - radius)
                    if miss < min(rim, best[j]):
                        near[j], best[j] = i, miss
                turned += beams[j].gap
                j = (j + 1 if way == 0 else j - 1) % m
    more = np.empty(m, dtype=GROUP)
    n = first = 0
    for j in range(m):
        if j < m - 1 and near[j + 1] == near[j] and unclear[j + 1] == unclear[j]:
            continue
        count = j + 1 - first
        if near[j] >= 0 and count >= rules[0].witnesses:
            whole, part, track = groups[unclear[j]], more[n], now[near[j]]
            part.first, part.count, part.carved = first, count, 1
            part.right_open = whole.right_open if whole.first == first else 0
            part.left_open = whole.left_open if whole.first + whole.count == j + 1 else 0
            fit_disc(beams, part, moment, track.radius, track.spread, rules)
            n += 1 if part.misfit <= rules[0].misfit_max else 0
        first = j + 1
    return np.concatenate((groups, more[:n])) if n else groups


@njit(cache=True)
def settle(
    old: Rows, now: Rows, beams: Rows, groups: Rows, moment: Array, rules: Record, next_id: int
) -> tuple[Rows, int]:
    """Correct the tracks `now` by their matches, end and begin tracks, give beams their owners; the next free id."""
    rule, time = rules[0], moment[3]
    taken = np.zeros(groups.size, dtype=np.bool_)
    lives = np.ones(now.size, dtype=np.bool_)
    for i in range(now.size):
        track = now[i]
        if track.match >= 0:
            taken[track.match] = True
            fit_disc(beams, groups[track.match], moment, track.radius, track.spread, rules)
            _correct(old[i], track, groups[track.match], moment, rules)
            _own(beams, groups[track.match], track)
        else:
            if looked_past(beams, moment, track.state[0], track.state[1], 0.0):
                track.absent += moment[4]
            kept = track.absent <= rule.patience and time - track.seen <= rule.coast
            lives[i] = kept and track.hits >= rule.confirm
    fresh = np.empty(groups.size, dtype=TRACK)
    n = 0
    for k in range(groups.size):
        group = groups[k]
        if taken[k] or group.carved or group.misfit == np.inf or beams[group.first].owner != NOBODY:
            continue
        inside = -1
        for i in range(now.size):
            if now[i].match >= 0 and np.hypot(now[i].state[0] - group.x, now[i].state[1] - group.y) < now[i].radius:
                inside = i
        if inside >= 0:  # another part of what is tracked, seen past something nearer
            _own(beams, group, now[inside])
            continue
        _begin(fresh[n], group, time, rules)
        fresh[n].id = next_id
        _own(beams, group, fresh[n])
        next_id += 1
        n += 1
    return np.concatenate((now[lives], fresh[:n])), next_id


@njit(cache=True)
def _correct(old: Row, now: Row, group: Row, moment: Array, rules: Record) -> None:
    """One step of the filter from `old`, with the noise of a sudden turn where that explains the disc better."""
    rule, dt = rules[0], moment[4]
    jump, price = _turn(rules)
    _, calm = _surprise(now, group, 0.0)
    _, wild = _surprise(now, group, (jump * dt) ** 2 / 3.0)
    q = rule.acceleration if calm <= wild + price else jump**2 / dt
    r = np.array([[group.xx, group.xy], [group.xy, group.yy]])
    mean, cov = kalman_step(old.state, old.cov, np.array([group.x, group.y]), dt, q, r)
    speed = np.hypot(mean[2], mean[3])
    if speed > rule.velocity_bound:
        mean[2:] *= rule.velocity_bound / speed
    now.state[:], now.cov[:] = mean, cov
    if not group.carved:
        now.radius, now.spread = group.radius, max(group.spread, SURE)
    now.seen, now.absent = moment[3], 0.0
    now.hits += 1
    now.proof -= group.carved  # what is carved out of a wall must prove anew that it moves


@njit(cache=True)
def _begin(track: Row, group: Row, time: float, rules: Record) -> None:
    """A track of one disc, with any velocity within the bound."""
    track.match, track.hits, track.moving = -1, 1, 0
    track.born, track.seen, track.absent, track.proof = time, time, 0.0, 0.0
    track.state[0], track.state[1], track.state[2], track.state[3] = group.x, group.y, 0.0, 0.0
    track.cov[:] = np.eye(4) * (0.25 * rules[0].velocity_bound ** 2)
    track.cov[0, 0], track.cov[1, 1] = group.xx, group.yy
    track.cov[0, 1] = track.cov[1, 0] = group.xy
    track.radius, track.spread = group.radius, group.spread


@njit(cache=True)
def _own(beams: Rows, group: Row, track: Row) -> None:
    """Give the hits of a cluster to a track."""
    for j in range(group.first, group.first + group.count):
        beams[j].owner = track.id


@njit(cache=True)
def _proof(ids: NDArray[np.int64], beams: Rows, moment: Array, then: Rows, past: Array, rules: Record) -> Array:
    """Share of each track's hits that lie where an earlier scan looked past, or of its earlier ones that this does."""
    counts = np.zeros((ids.size, 4))
    way, turn = rules[0].drift * (moment[5] - past[5]), rules[0].drift * (moment[6] - past[6])
    for k in range(2):
        mine = then if k else beams
        other, seen_from = (beams, moment) if k else (then, past)
        for j in range(mine.size):
            beam = mine[j]
            if beam.owner >= 0:
                i = np.searchsorted(ids, beam.owner)
                if i < ids.size and ids[i] == beam.owner:
                    margin = rules[0].free_margin + way + turn * beam.range
                    counts[i, 2 * k] += 1.0
                    counts[i, 2 * k + 1] += looked_past(other, seen_from, beam.x, beam.y, margin)
    shares = np.zeros(ids.size)
    for i in range(ids.size):
        for k in range(2):
            if counts[i, 2 * k] >= rules[0].witnesses and counts[i, 2 * k + 1] > 1.0:  # one beam proves nothing
                shares[i] = max(shares[i], counts[i, 2 * k + 1] / counts[i, 2 * k])
    return shares


@njit(cache=True)
def judge(tracks: Rows, beams: Rows, moment: Array, then: Rows, past: Array, shares: Array, rules: Record) -> Array:
    """Shares of proof of motion by one more earlier scan: each the larger of `shares` and of what this scan shows."""
    ids = np.empty(tracks.size, dtype=np.int64)
    for i in range(tracks.size):
        ids[i] = tracks[i].id
    return np.maximum(shares, _proof(ids, beams, moment, then, past, rules))


@njit(cache=True)
def decide(tracks: Rows, beams: Rows, shares: Array, time: float, size: int, rules: Record) -> NDArray[np.int64]:
    """Decide which tracks move, and tell for each beam of the scan the row of its track among the confirmed ones."""
    rule = rules[0]
    out, row = np.full(size, -1), 0
    for i in range(tracks.size):
        track = tracks[i]
        if track.seen == time:
            speed = np.hypot(track.state[2], track.state[3])
            doubt = np.sqrt(0.5 * (track.cov[2, 2] + track.cov[3, 3]))
            step = min(shares[i] / rule.proof_share, 2.0) if shares[i] >= rule.proof_share else -0.5
            track.proof = min(max(track.proof + step, 0.0), rule.proofs + 1.0)
            if track.moving:
                track.moving = speed > 0.5 * rule.speed_min and track.proof > 0.0
            else:
                track.moving = speed > max(rule.speed_min, 2.0 * doubt) and track.proof >= rule.proofs
        if track.hits >= rule.confirm:
            for j in range(beams.size):
                if beams[j].owner == track.id:
                    out[beams[j].which] = row
            row += 1
    return out


def _warm() -> None:
    """Compile the step; the tracker's warming compiles the rest."""
    kalman_step(np.zeros(4), np.eye(4), np.zeros(2), 0.1, 0.1, np.eye(2))
