"""Dead reckoning, the extended Kalman filter, honesty, and the particle filter."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import chi2, kstest

from fuzzynav import localization as loc
from fuzzynav.geometry import to_world, wrap
from fuzzynav.localization import particles as mcl
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import move
from fuzzynav.sensors import Laser, Scan, dead_reckon, laser_scan

NOISE = loc.MotionNoise(travel_per_metre=4e-4, travel_per_radian=1e-4, turn_per_metre=1e-3, turn_per_radian=2e-3)
TURN = 2.0 * np.pi * np.array([0.0, 0.0, 1.0])
LANDMARKS = np.array([[2.0, 0.0], [0.0, 4.0], [5.0, 5.0], [-3.0, 1.0]])
ROOM = """
########################################
#..................#...................#
#..................#...................#
#..................#...................#
#......................................#
#......................................#
#..................#...................#
#..................#........####.......#
#..................#........####.......#
#..................#...................#
########..##########...................#
#......................................#
#......................................#
#...............................########
#.....###..............................#
#.....###..............................#
#......................................#
#.....................###..............#
#......................................#
########################################
"""
GRID = GridMap.from_ascii(ROOM, 0.25)
PARAMS = mcl.MonteCarlo()
FIELD = mcl.likelihood_field(GRID, PARAMS)
LASER = Laser(beams=90, field_of_view=2 * np.pi, range_max=6.0, noise=0.02)

speeds = st.floats(-1.5, 1.5)
poses = st.tuples(speeds, speeds, st.floats(-3.1, 3.1)).map(np.array)
motions = st.tuples(speeds, speeds).map(np.array)


# --- dead reckoning


@given(poses, motions)
def test_jacobians_against_differences(pose: np.ndarray, motion: np.ndarray) -> None:
    h = 1e-6
    by_pose, by_motion = loc.motion_jacobians(pose, motion)
    for k, step in enumerate(np.eye(3) * h):
        gap = move(pose + step, motion, 1.0) - move(pose - step, motion, 1.0)
        gap[2] = wrap(gap[2])
        assert np.allclose(gap / (2 * h), by_pose[:, k], atol=1e-8)
    for k, step in enumerate(np.eye(2) * h):
        gap = move(pose, motion + step, 1.0) - move(pose, motion - step, 1.0)
        gap[2] = wrap(gap[2])
        assert np.allclose(gap / (2 * h), by_motion[:, k], atol=1e-8)


def test_jacobians_join_where_the_series_takes_over() -> None:
    near, far = (loc.motion_jacobians([0, 0, 0.4], [1.0, t])[1] for t in (0.001 - 1e-12, 0.001 + 1e-12))
    assert np.allclose(near, far, atol=1e-12)


def test_covariance_against_monte_carlo() -> None:
    rng = np.random.default_rng(3)
    plan = np.tile([0.05, 0.04], (60, 1))
    start = loc.Belief([0.0, 0.0, 0.0], np.diag([1e-4, 1e-4, 1e-4]))
    told = loc.dead_reckoning(start, plan, NOISE)
    swarm = rng.multivariate_normal(start.mean, start.covariance, 20000)
    for motion in plan:
        swarm = move(swarm, loc.sample_motions(np.tile(motion, (20000, 1)), NOISE, rng), 1.0)
    swarm[:, 2] = told.means[-1, 2] + wrap(swarm[:, 2] - told.means[-1, 2])
    sampled = np.cov(swarm.T)
    spread = np.sqrt(np.diag(told.covariances[-1]))
    assert np.allclose(np.sqrt(np.diag(sampled)), spread, rtol=0.03)
    correlation = sampled / np.outer(spread, spread) - told.covariances[-1] / np.outer(spread, spread)
    assert np.abs(correlation).max() < 0.05


def test_doubt_does_not_depend_on_the_length_of_a_step() -> None:
    start = loc.Belief(np.zeros(3), np.diag([1e-4, 1e-4, 1e-4]))
    way = np.array([3.0, 1.5])
    few, many = (loc.dead_reckoning(start, np.tile(way / n, (n, 1)), NOISE).covariances[-1] for n in (400, 800))
    assert np.allclose(few, many, rtol=5e-3)


def test_doubt_never_shrinks_without_a_sighting_and_a_standing_robot_learns_nothing() -> None:
    start = loc.Belief(np.zeros(3), np.diag([1e-4, 1e-4, 1e-4]))
    told = loc.dead_reckoning(start, np.tile([0.1, 0.05], (50, 1)), NOISE)
    volume = np.linalg.det(told.covariances)
    assert np.all(np.diff(volume) > 0)
    still = loc.predict(start, [0.0, 0.0], NOISE)
    assert np.array_equal(still.covariance, start.covariance)
    assert np.allclose(told.means, dead_reckon([0, 0, 0], np.tile([0.1, 0.05], (50, 1))))


@given(poses, motions)
def test_a_full_turn_added_to_the_heading_changes_no_belief(pose: np.ndarray, motion: np.ndarray) -> None:
    cov = np.diag([0.01, 0.02, 0.005])
    one, two = (loc.predict(loc.Belief(p, cov), motion, NOISE) for p in (pose, pose + TURN))
    assert np.allclose(one.mean, two.mean, atol=1e-9)
    assert np.allclose(one.covariance, two.covariance, atol=1e-12)


def test_ellipse_holds_its_share() -> None:
    rng = np.random.default_rng(0)
    cov = np.array([[0.5, 0.3], [0.3, 0.4]])
    draws = rng.multivariate_normal([1.0, 2.0], cov, 20000)
    inside = np.einsum("ni,ij,nj->n", draws - [1, 2], np.linalg.inv(cov), draws - [1, 2]) <= chi2.ppf(0.9, 2)
    edge = loc.ellipse([1.0, 2.0], cov, 0.9)
    radii = np.einsum("ni,ij,nj->n", edge - [1, 2], np.linalg.inv(cov), edge - [1, 2])
    assert np.allclose(radii, chi2.ppf(0.9, 2))
    assert inside.mean() == pytest.approx(0.9, abs=0.01)


# --- extended Kalman filter


def kalman_run(seed: int, sensor: loc.LandmarkSensor, told: loc.MotionNoise, steps: int = 40) -> np.ndarray:
    """NEES along a run whose true noise is NOISE, filtered with the noise `told`."""
    rng = np.random.default_rng(seed)
    start = loc.Belief(np.zeros(3), np.diag([0.01, 0.01, 0.003]))
    belief, truth = start, rng.multivariate_normal(start.mean, start.covariance)
    squares = []
    for _ in range(steps):
        motion = np.array([0.1, 0.06])
        truth = move(truth, loc.sample_motions(motion, NOISE, rng), 1.0)
        belief = loc.predict(belief, motion, told)
        belief = loc.correct(belief, *loc.see_landmarks(truth, LANDMARKS, sensor, rng), LANDMARKS, sensor).belief
        squares.append(loc.nees(truth, belief.mean, belief.covariance))
    return np.array(squares)


@pytest.mark.parametrize("turn", [1e-7, 1e-4, -9e-4, 9.99e-4])
def test_a_nearly_straight_arc_has_the_exact_jacobian(turn: float) -> None:
    """Seen along its chord, the arc shortens by d/dturn sinc(turn/2) = -h/6 + h^3/60 - h^5/1680 with h = turn/2."""
    _, by_motion = loc.motion_jacobians([0.0, 0.0, -turn / 2.0], [1.0, turn])
    h = turn / 2.0
    assert by_motion[0, 1] == pytest.approx(-h / 6.0 + h**3 / 60.0 - h**5 / 1680.0, rel=1e-10)


def test_each_rate_of_noise_belongs_to_its_own_motion_and_number() -> None:
    noise = loc.MotionNoise(travel_per_metre=1.0, travel_per_radian=2.0, turn_per_metre=3.0, turn_per_radian=4.0)
    assert noise.variances([[1.0, 0.0], [0.0, 1.0], [-2.0, -1.0]]).tolist() == [[1.0, 3.0], [2.0, 4.0], [4.0, 10.0]]


def test_the_filter_is_honest_with_the_right_noise_and_caught_with_the_wrong() -> None:
    sensor = loc.LandmarkSensor()
    low, high = loc.nees_bounds(30, 0.999)
    honest = np.array([kalman_run(k, sensor, NOISE) for k in range(30)]).mean(axis=0)
    assert ((honest >= low) & (honest <= high)).mean() > 0.98
    boastful = loc.MotionNoise(travel_per_metre=0, travel_per_radian=0, turn_per_metre=0, turn_per_radian=0)
    wrong = np.array([kalman_run(k, sensor, boastful) for k in range(30)]).mean(axis=0)
    assert (wrong[-20:] > high).all()


def test_a_sighting_shrinks_the_doubt_as_information_adds() -> None:
    """Linear case, known answer: the posterior information is the sum of both."""
    sensor = loc.LandmarkSensor(sigma_range=0.1, sigma_bearing=0.02)
    belief = loc.Belief(np.zeros(3), np.diag([0.04, 0.04, 0.01]))
    seen = loc.expected(belief.mean, LANDMARKS[:1])
    after = loc.correct(belief, [0], seen, LANDMARKS, sensor)
    rows = np.array([[-1.0, 0.0, 0.0], [0.0, -0.5, -1.0]])
    information = np.linalg.inv(belief.covariance) + rows.T @ np.diag([1 / 0.1**2, 1 / 0.02**2]) @ rows
    assert np.allclose(after.belief.covariance, np.linalg.inv(information))
    assert np.allclose(after.belief.mean, 0.0)
    assert after.nis == pytest.approx(0.0)


def test_bearing_innovation_is_wrapped() -> None:
    sensor = loc.LandmarkSensor()
    belief = loc.Belief([0.0, 0.0, 0.0], np.diag([0.01, 0.01, 0.01]))
    behind = np.array([[-3.0, 0.0]])
    done = loc.correct(belief, [0], [[3.0, -np.pi + 0.01]], behind, sensor)
    again = loc.correct(belief, [0], [[3.0, np.pi + 0.01]], behind, sensor)
    assert abs(done.innovations[0, 1]) < 0.02
    assert np.allclose(done.belief.mean, again.belief.mean, atol=1e-9)
    assert np.hypot(*done.belief.mean[:2]) < 0.05


def test_order_of_the_sightings_does_not_matter_and_none_changes_nothing() -> None:
    sensor, rng = loc.LandmarkSensor(), np.random.default_rng(1)
    belief = loc.Belief([0.3, 0.2, 0.1], np.diag([0.05, 0.05, 0.02]))
    ids, seen = loc.see_landmarks([0.4, 0.1, 0.15], LANDMARKS, sensor, rng)
    forth = loc.correct(belief, ids, seen, LANDMARKS, sensor)
    back = loc.correct(belief, ids[::-1], seen[::-1], LANDMARKS, sensor)
    assert np.allclose(forth.belief.mean, back.belief.mean)
    nothing = loc.correct(belief, [], np.empty((0, 2)), LANDMARKS, sensor)
    assert nothing.belief is belief
    assert np.isnan(nothing.nis)


def test_innovations_of_an_honest_filter_are_chi_square() -> None:
    sensor, rng = loc.LandmarkSensor(), np.random.default_rng(5)
    cov = np.diag([1e-3, 1e-3, 1e-3])
    squares = []
    for _ in range(400):
        truth = rng.multivariate_normal(np.zeros(3), cov)
        ids, seen = loc.see_landmarks(truth, LANDMARKS, sensor, rng)
        squares.append(loc.correct(loc.Belief(np.zeros(3), cov), ids, seen, LANDMARKS, sensor).nis)
    assert kstest(squares, chi2(8).cdf).pvalue > 0.01


@pytest.mark.parametrize(
    ("ids", "seen", "word"),
    [
        ([9], [[1.0, 0.0]], "sighting"),
        ([0], [[np.nan, 0.0]], "sighting"),
        ([0, 1], [[1.0, 0.0]], "sighting"),
        ([0], [[1.0, 0.0]], "undefined"),
    ],
)
def test_bad_sightings_are_refused(ids: list[int], seen: list[list[float]], word: str) -> None:
    at = [2.0, 0.0, 0.0] if word == "undefined" else [0.0, 0.0, 0.0]
    with pytest.raises(ValueError, match=word):
        loc.correct(loc.Belief(at, np.eye(3)), ids, seen, LANDMARKS, loc.LandmarkSensor())


def test_other_bad_input_is_refused() -> None:
    with pytest.raises(ValueError, match="turn_per_metre"):
        loc.MotionNoise(turn_per_metre=-1.0)
    with pytest.raises(ValueError, match="sigma_range"):
        loc.LandmarkSensor(sigma_range=0.0)
    with pytest.raises(ValueError, match="finite"):
        loc.Belief([np.nan, 0, 0], np.eye(3))
    with pytest.raises(ValueError, match="negative variance"):
        loc.Belief([0, 0, 0], np.diag([1.0, 1.0, -1.0]))
    with pytest.raises(ValueError, match="motion"):
        loc.predict(loc.Belief([0, 0, 0], np.eye(3)), [np.nan, 0.0], NOISE)
    with pytest.raises(ValueError, match="singular"):
        loc.nees([0, 0, 0], [0, 0, 0], np.zeros((3, 3)))
    with pytest.raises(ValueError, match="runs"):
        loc.nees_bounds(0)
    with pytest.raises(ValueError, match="probability"):
        loc.ellipse([0, 0], np.eye(2), 1.0)


# --- particle filter


@settings(max_examples=50)
@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=50).filter(lambda w: sum(w) > 1e-3), st.integers(0, 99))
def test_low_variance_resampling_draws_each_particle_floor_or_ceil_times(weights: list[float], seed: int) -> None:
    w = np.array(weights) / sum(weights)
    drawn = np.bincount(mcl.low_variance_resample(w, np.random.default_rng(seed)), minlength=len(w))
    assert drawn.sum() == len(w)
    assert np.all(drawn >= np.floor(len(w) * w - 1e-9))
    assert np.all(drawn <= np.ceil(len(w) * w + 1e-9))


def test_effective_size_at_its_ends() -> None:
    assert mcl.effective_size(np.full(20, 1 / 20)) == pytest.approx(20.0)
    assert mcl.effective_size([1.0, 0.0, 0.0]) == 1.0


def test_field_and_score_by_hand() -> None:
    grid = GridMap.from_ascii("..........#", 0.1)
    params = replace(PARAMS, hit_sigma=0.1, random_share=0.2)
    field = mcl.likelihood_field(grid, params, 0.1)
    scan = Scan(angles=np.array([0.0, np.pi / 2, 0.1]), ranges=np.array([0.95, np.nan, np.inf]), range_max=2.0)
    poses = [[0.05, 0.05, 0.0], [0.05, 0.05, 2 * np.pi], [-0.05, 0.05, 0.0], [1.05, 0.05, 0.0], [0.05, 0.05, np.pi]]
    scores, used = mcl.log_likelihoods(poses, scan, field, params)
    assert used == 1
    assert scores[:2] == pytest.approx([0.0, 0.0])  # its end lies in the occupied cell
    assert scores[2:] == pytest.approx([np.log(0.2)] * 3)  # off the map, in the wall, looking out of the map
    assert field.log[0, 9] == pytest.approx(np.log(0.8 * np.exp(-0.5 * 0.5**2) + 0.2))


def test_score_against_plain_numpy() -> None:
    rng = np.random.default_rng(2)
    poses = mcl.scatter(GRID, 200, rng).poses
    scan = laser_scan(GRID, [2.5, 2.0, 0.3], LASER, rng)
    scores, used = mcl.log_likelihoods(poses, scan, FIELD, replace(PARAMS, beams=90))
    ends = np.array([to_world(pose, scan.points) for pose in poses])
    cells = np.floor(ends / FIELD.resolution).astype(int)
    inside = np.all((cells >= 0) & (cells < FIELD.log.shape[::-1]), axis=-1)
    cells = np.where(inside[..., None], cells, 0)
    plain = np.where(inside, FIELD.log[cells[..., 1], cells[..., 0]], FIELD.floor).sum(axis=1)
    assert used == scan.hits.sum()
    assert np.isclose(scores, plain).mean() > 0.99  # an end on a cell's border may fall either way


def drive(
    seed: int,
    *,
    known: bool,
    kidnapped: int | None = None,
    params: mcl.MonteCarlo = PARAMS,
    n: int = 1000,
    steps: int = 120,
) -> tuple[np.ndarray, mcl.Swarm]:
    """Position error [m] along a wandering run, and the last swarm."""
    rng = np.random.default_rng(seed)
    pose = np.array([2.5, 2.0, 0.0])
    swarm = mcl.scatter(GRID, n, rng)
    if known:
        swarm = mcl.spread(loc.Belief(pose, np.diag([0.04, 0.04, 0.02])), n, rng)
    errors = []
    for k in range(steps):
        motion = np.array([0.08, 0.09 * np.sin(k / 9)])
        if GRID.distance(move(pose, motion, 1.0)[:2]) < 0.25:
            motion = np.array([0.0, 0.4])
        pose = move(pose, loc.sample_motions(motion, NOISE, rng), 1.0)
        if k == kidnapped:
            pose = np.array([7.5, 3.8, -2.0])
        swarm = mcl.drift(swarm, motion, NOISE, rng)
        swarm, belief = mcl.step(swarm, laser_scan(GRID, pose, LASER, rng), FIELD, params, rng)
        errors.append(np.hypot(*(belief.mean - pose)[:2]))
    return np.array(errors), swarm


@pytest.mark.parametrize("seed", range(4))
def test_tracking_from_a_known_start(seed: int) -> None:
    errors, _ = drive(seed, known=True, n=500, steps=60)
    assert errors.max() < 0.2
    assert errors[10:].mean() < 0.08


def test_global_localization_finds_the_robot() -> None:
    found = [drive(seed, known=False, n=1500)[0][-20:].max() < 0.3 for seed in range(6)]
    assert sum(found) >= 5


def test_kidnapped_robot_is_found_with_recovery_and_lost_without() -> None:
    plain = replace(PARAMS, slow=0.0, fast=0.0)
    recovered = [drive(seed, known=True, kidnapped=30)[0][-15:].mean() < 0.3 for seed in range(4)]
    lost = [drive(seed, known=True, kidnapped=30, params=plain)[0][-15:].mean() > 0.5 for seed in range(4)]
    assert all(recovered)
    assert all(lost)


def test_same_seed_same_run_bit_for_bit() -> None:
    one, two = drive(7, known=False, n=300, steps=30), drive(7, known=False, n=300, steps=30)
    assert np.array_equal(one[0], two[0])
    assert np.array_equal(one[1].poses, two[1].poses)
    assert not np.array_equal(one[1].poses, drive(8, known=False, n=300, steps=30)[1].poses)


def test_functions_leave_their_arguments_alone() -> None:
    rng = np.random.default_rng(0)
    swarm = mcl.scatter(GRID, 50, rng)
    before = swarm.poses.copy(), swarm.weights.copy()
    scan = laser_scan(GRID, [2.5, 2.0, 0.0], LASER, rng)
    mcl.step(mcl.drift(swarm, [0.1, 0.1], NOISE, rng), scan, FIELD, PARAMS, rng)
    assert np.array_equal(before[0], swarm.poses)
    assert np.array_equal(before[1], swarm.weights)


def test_weights_and_groups_do_not_see_a_full_turn() -> None:
    rng = np.random.default_rng(0)
    swarm = mcl.spread(loc.Belief([2.5, 2.0, 3.1], np.diag([0.01, 0.01, 0.05])), 200, rng)
    turned = replace(swarm, poses=swarm.poses + TURN)
    scan = laser_scan(GRID, [2.5, 2.0, 3.1], LASER, rng)
    a, b = (mcl.weigh(s, scan, FIELD, PARAMS) for s in (swarm, turned))
    assert np.allclose(a.weights, b.weights, atol=1e-4)
    assert np.allclose(mcl.cluster(swarm).mean, mcl.cluster(turned).mean)
    assert abs(wrap(mcl.cluster(swarm).mean[2] - 3.1)) < 0.1


def test_cluster_takes_the_heavier_of_two_groups() -> None:
    rng = np.random.default_rng(0)
    small = mcl.spread(loc.Belief([2, 2, 0], np.eye(3) * 1e-3), 40, rng).poses
    big = mcl.spread(loc.Belief([7, 3, 1], np.eye(3) * 1e-3), 60, rng).poses
    found = mcl.cluster(mcl.Swarm(np.vstack([small, big]), np.full(100, 0.01)))
    assert found.mean == pytest.approx([7.0, 3.0, 1.0], abs=0.03)
    assert np.allclose(np.diag(found.covariance), 1e-3, rtol=0.6)


def test_a_scan_without_hits_changes_nothing() -> None:
    swarm = mcl.scatter(GRID, 10, np.random.default_rng(0))
    empty = Scan(angles=np.zeros(3), ranges=np.array([np.nan, np.inf, -np.inf]), range_max=5.0)
    assert mcl.weigh(swarm, empty, FIELD, PARAMS) is swarm


@pytest.mark.parametrize(
    "bad",
    [
        {"hit_sigma": 0.0},
        {"random_share": -0.1},
        {"random_share": 1.5},
        {"temper": 0.0},
        {"beams": 0},
        {"slow": 0.5, "fast": 0.1},
        {"resample_below": np.nan},
    ],
)
def test_bad_parameters_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="MonteCarlo"):
        mcl.MonteCarlo(**bad)


def test_bad_swarms_are_refused() -> None:
    rng = np.random.default_rng(0)
    full = GridMap(np.ones((2, 2), dtype=bool), 1.0)
    with pytest.raises(ValueError, match="no free cell"):
        mcl.scatter(full, 5, rng)
    with pytest.raises(ValueError, match="at least one"):
        mcl.scatter(GRID, 0, rng)
    with pytest.raises(ValueError, match="sum 1"):
        mcl.Swarm(np.zeros((2, 3)), np.ones(2))
    with pytest.raises(ValueError, match="finite"):
        mcl.Swarm(np.full((1, 3), np.nan), np.ones(1))
    with pytest.raises(ValueError, match="motion"):
        mcl.drift(mcl.scatter(GRID, 2, rng), [np.inf, 0.0], NOISE, rng)


# --- position from distances


@given(st.integers(0, 2**32))
def test_distances_to_anchors_give_the_position(seed: int) -> None:
    rng = np.random.default_rng(seed)
    anchors = np.array([[0.0, 0.0], [10.0, 0.0], [3.0, 8.0], [9.0, 7.0]]) + rng.uniform(-1, 1, (4, 2))
    at = rng.uniform(-5, 15, 2)
    assert loc.trilaterate(anchors, np.hypot(*(anchors - at).T)) == pytest.approx(at, abs=1e-6)


@pytest.mark.parametrize(
    ("anchors", "ranges", "words"),
    [
        ([[0, 0], [1, 0]], [1, 1], "three"),
        ([[0, 0], [1, 1], [2, 2]], [1, 1, 1], "one line"),
        ([[0, 0], [1, 0], [0, 1]], [1, 1], "three"),
        ([[0, 0], [1, 0], [0, 1]], [1, np.nan, 1], "finite"),
    ],
)
def test_positions_that_distances_cannot_give(anchors: list, ranges: list, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        loc.trilaterate(anchors, ranges)


# --- what small changes of the code must turn red


def test_the_match_of_a_scan_is_the_mean_over_particles_of_the_geometric_mean_over_beams() -> None:
    rng = np.random.default_rng(3)
    scan = laser_scan(GRID, [2.5, 2.0, 0.3], LASER, rng)
    few = Scan(angles=scan.angles[::9], ranges=scan.ranges[::9], range_max=scan.range_max)
    swarm = mcl.spread(loc.Belief([2.5, 2.0, 0.3], np.diag([0.04, 0.04, 0.02])), 50, rng)
    beams = [Scan(angles=few.angles[[k]], ranges=few.ranges[[k]], range_max=9.0) for k in np.flatnonzero(few.hits)]
    alone = np.exp([mcl.log_likelihoods(swarm.poses, beam, FIELD, PARAMS)[0] for beam in beams])
    wanted = swarm.weights @ alone.prod(axis=0) ** (1.0 / len(beams))
    weighed = mcl.weigh(swarm, few, FIELD, PARAMS)
    assert len(beams) > 3
    assert weighed.slow == weighed.fast == pytest.approx(wanted)


@pytest.mark.parametrize(
    "pose",
    [
        (-0.5, 1.5, 0.0),
        (3.5, 1.5, np.pi),
        (3.0, 1.5, np.pi),  # on the far edge, which belongs to the next cell
        (1.5, -0.5, np.pi / 2),
        (1.5, 3.5, -np.pi / 2),
        (1.5, 3.0, -np.pi / 2),
        (1.5, 1.5, 0.0),  # in the obstacle itself
    ],
)
def test_a_pose_that_cannot_be_is_as_likely_as_random_beams(pose: tuple[float, float, float]) -> None:
    """The one beam ends in the obstacle, which would be a perfect match."""
    field = mcl.likelihood_field(GridMap.from_ascii("...\n.#.\n..."), PARAMS, 1.0)
    length = 0.2 if pose[:2] == (1.5, 1.5) else 1.7
    scan = Scan(angles=np.zeros(1), ranges=np.array([length]), range_max=2.0)
    inside = [2.9, 1.5, np.pi], [0.5, 1.5, 0.0]
    assert mcl.log_likelihoods(inside, replace(scan, ranges=np.ones(1) * 1.3), field, PARAMS)[0].tolist() == [0.0, 0.0]
    assert mcl.log_likelihoods([pose], scan, field, PARAMS)[0].tolist() == [field.floor]


def test_recovery_replaces_its_share_of_the_particles() -> None:
    poses = np.tile([2.5, 2.0, 0.0], (2000, 1))
    swarm = mcl.Swarm(poses, np.full(2000, 1 / 2000), slow=1.0, fast=0.8)
    assert mcl.recovery_share(swarm) == pytest.approx(0.2)
    after = mcl.resample(swarm, GRID, PARAMS, np.random.default_rng(0))
    assert (after.poses != poses).any(axis=1).mean() == pytest.approx(0.2, abs=0.04)


@pytest.mark.parametrize("resolution", [0.0, -1.0, np.nan, 1e-5, 1e-300])
def test_a_field_of_an_absurd_resolution_is_refused(resolution: float) -> None:
    with pytest.raises(ValueError, match=r"resolution must be positive|resolution must be a positive|too many"):
        mcl.likelihood_field(GRID, PARAMS, resolution)


def test_nothing_inside_a_belief_or_a_swarm_can_be_written_to() -> None:
    rng, sensor = np.random.default_rng(0), loc.LandmarkSensor()
    belief = loc.Belief(np.zeros(3), np.eye(3))
    path = loc.dead_reckoning(belief, [[0.1, 0.0]], NOISE)
    seen = loc.correct(belief, [0], [[2.0, 0.0]], LANDMARKS, sensor)
    swarm = mcl.scatter(GRID, 5, rng)
    mine = np.full(5, 0.2)
    held = mcl.Swarm(np.zeros((5, 3)), mine)
    mine[0] = 9.0
    assert held.weights[0] == 0.2
    for array in (
        belief.mean,
        belief.covariance,
        path.means,
        path.covariances,
        seen.innovations,
        seen.belief.mean,
        swarm.poses,
        swarm.weights,
        mcl.drift(swarm, [0.1, 0.0], NOISE, rng).poses,
        FIELD.log,
        FIELD.grid.occupied,
    ):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
