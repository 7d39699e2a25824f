"""Mapping, logs, pose graphs and the other kinds of map."""

import zipfile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav import mapping
from fuzzynav.geometry import compose, inverse, wrap
from fuzzynav.localization.kalman import LandmarkSensor
from fuzzynav.mapping import logs, posegraph
from fuzzynav.maps import kinds
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.sensors import Laser
from fuzzynav.studies import localization as study
from fuzzynav.world import World

relaxed = settings(deadline=None, max_examples=30)
SEEDS = st.integers(0, 2**32)
SENSOR = mapping.InverseSensor(reach=6.0)
HIT, MISS = mapping.log_odds([0.7, 0.4])


# --- occupancy mapping


def one_beam(range_: float, sensor=SENSOR) -> np.ndarray:
    """Log odds of a corridor of ten cells of 1 m after one beam along it from the first."""
    return mapping.update(mapping.empty([0, 10, 0, 1], 1.0), [0.5, 0.5, 0.0], [range_], [0.0], sensor).log_odds[0]


def test_a_beam_clears_its_way_and_marks_its_end():
    assert one_beam(3.0) == pytest.approx([MISS] * 3 + [HIT] + [0] * 6)
    assert one_beam(0.2) == pytest.approx([HIT] + [0] * 9)
    assert one_beam(6.0) == pytest.approx([MISS] * 6 + [HIT] + [0] * 3)  # just at the reach


@pytest.mark.parametrize(("range_", "cleared"), [(np.inf, 7), (7.3, 7), (np.nan, 0), (-np.inf, 0)])
def test_beams_without_an_end(range_, cleared):
    # reach 6 m from x = 0.5 ends in cell 6, which is cleared too
    assert one_beam(range_) == pytest.approx([MISS] * cleared + [0] * (10 - cleared))


def test_a_cell_is_told_once_a_scan_and_an_end_outweighs_a_crossing():
    grid = mapping.empty([0, 10, 0, 1], 1.0)
    both = mapping.update(grid, [0.5, 0.5, 0.0], [3.0, 5.0, 3.1], [0.0, 0.001, -0.001], SENSOR).log_odds[0]
    assert both[3] == pytest.approx(HIT)
    assert both[:3] == pytest.approx([MISS] * 3)
    assert not grid.log_odds.any()


def test_chances_stay_within_their_limits_and_can_be_unlearned():
    grid = mapping.empty([0, 10, 0, 1], 1.0)
    poses, angles = np.tile([0.5, 0.5, 0.0], (50, 1)), [0.0]
    seen = mapping.update(grid, poses, np.full((50, 1), 3.0), angles, SENSOR)
    assert seen.probability[0, [0, 3, 9]] == pytest.approx([0.12, 0.97, 0.5])
    gone = mapping.update(seen, poses[:14], np.full((14, 1), 5.0), angles, SENSOR)
    assert gone.probability[0, 3] < 0.196


def slow_map(grid, poses, ranges, angles, sensor):
    """The same model by the supercover of the map, beam by beam."""
    plain = GridMap(np.zeros(grid.log_odds.shape, dtype=bool), grid.resolution, grid.origin)
    odds = grid.log_odds.copy()
    low, high = mapping.log_odds([sensor.low, sensor.high])
    for pose, scan in zip(poses, ranges, strict=True):
        ends, crossed = set(), set()
        for r, a in zip(scan, pose[2] + angles, strict=True):
            tip = pose[:2] + min(r, sensor.reach) * np.array([np.cos(a), np.sin(a)])
            cells = [tuple(c) for c in plain.line_cells(pose[:2], tip, "permissive").tolist()]
            last = tuple(plain.cell_of(tip).tolist())
            crossed |= set(cells) - ({last} if r <= sensor.reach else set())
            ends |= {last} if r <= sensor.reach else set()
        for told, step in ((ends, HIT), (crossed - ends, MISS)):
            for i, j in told:
                if 0 <= i < odds.shape[1] and 0 <= j < odds.shape[0]:
                    odds[j, i] = np.clip(odds[j, i] + step, low, high)
    return odds


@relaxed
@given(SEEDS)
def test_kernel_agrees_with_a_slow_map(seed):
    rng = np.random.default_rng(seed)
    poses = np.column_stack([rng.uniform(-0.5, 4.5, (6, 2)), rng.uniform(-4, 4, 6)])
    ranges, angles = rng.uniform(0, 4, (6, 8)), rng.uniform(-np.pi, np.pi, 8)
    grid, sensor = mapping.empty([0, 4, 0, 3], 0.25), mapping.InverseSensor(reach=3.0)
    fast = mapping.update(grid, poses, ranges, angles, sensor).log_odds
    assert np.allclose(fast, slow_map(grid, poses, ranges, angles, sensor), atol=1e-9)


def test_scans_of_a_known_room_give_the_room_back():
    poses, scans = study.tour_scans(Laser(beams=180, field_of_view=2 * np.pi, noise=0.0, range_max=9.0), every=3)
    grid = study.flat()
    made = mapping.update(mapping.empty(grid.extent, 0.1), poses, [s.ranges + 1e-6 for s in scans], scans[0].angles)
    decided = made.to_gridmap()
    assert not (decided.occupied & ~grid.occupied).any()
    seen_free = ~decided.occupied & ~decided.unknown
    assert (seen_free & ~grid.occupied).sum() > 0.95 * (~grid.occupied).sum()
    faces = World(grid=grid).cast(poses, scans[0].angles, 9.0)
    assert decided.occupied.sum() > 300
    assert np.isfinite(faces).all()


def test_map_is_as_large_as_its_scans():
    made = mapping.build([[0.0, 0.0, 0.0]], [[3.0, np.inf, np.nan]], [0.0, np.pi, np.pi / 2], SENSOR, 0.5)
    grid = made.to_gridmap()
    assert grid.extent[0] < -6.0
    assert grid.extent[1] > 3.0
    assert grid.is_occupied([3.1, 0.1])
    assert made.sharpness().occupied == 1


@pytest.mark.parametrize(
    ("poses", "ranges", "angles", "words"),
    [
        (np.zeros((0, 3)), np.zeros((0, 4)), np.zeros(4), "at least one scan"),
        (np.zeros((2, 3)), np.zeros((2, 0)), [], "at least one beam"),
        (np.zeros((2, 3)), np.zeros((3, 4)), np.zeros(4), "expected"),
        (np.zeros((2, 2)), np.zeros((2, 4)), np.zeros(4), "expected"),
        ([[0, 0, np.nan]], [[1.0]], [0.0], "finite"),
        ([[0, 0, 0]], [[1.0]], [np.inf], "finite"),
        ([[0, 0, 0]], [[-1.0]], [0.0], "scan 0 holds a negative range"),
    ],
)
def test_bad_scans_are_refused(poses, ranges, angles, words):
    with pytest.raises(ValueError, match=words):
        mapping.build(poses, ranges, angles)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: mapping.InverseSensor(hit=0.4), "rise"),
        (lambda: mapping.InverseSensor(high=1.0), "rise"),
        (lambda: mapping.InverseSensor(reach=0.0), "reach"),
        (lambda: mapping.empty([0, 0, 0, 1], 0.1), "bounds"),
        (lambda: mapping.empty([0, 1, 0, 1], 0.0), "resolution"),
        (lambda: mapping.empty([0, 1e5, 0, 1e5], 0.1), "too many"),
        (lambda: mapping.empty([0, 1, 0, 1], 1e-300), "too many"),
        (lambda: mapping.empty([-1e308, 1e308, 0, 1], 1.0), "too many"),
        (lambda: mapping.build([[0, 0, 0]], [[1.0]], [0.0], resolution=0.0), "resolution"),
        (lambda: mapping.build([[0, 0, 0]], [[1.0]], [0.0], resolution=1e-300), "bounds"),
        (lambda: mapping.build([[1e300, 0, 0]], [[1.0]], [0.0]), "bounds"),
        (lambda: mapping.log_odds(1.0), "between 0 and 1"),
        (lambda: mapping.voxels([[0, 0, 0]], 0.0), "size"),
    ],
)
def test_bad_parameters_are_refused(call, words):
    with pytest.raises(ValueError, match=words):
        call()


@given(st.floats(0.001, 0.999))
def test_odds_and_chances_are_inverse(p):
    assert mapping.probability(mapping.log_odds(p)) == pytest.approx(p)


def test_nothing_inside_a_map_or_a_log_can_be_written_to():
    _, log = square_log(0.0)
    found = kinds.places(study.flat(), 1.0)
    mine = np.zeros((2, 2))
    grid = mapping.OccupancyGrid(mine, 1.0, (0.0, 0.0))
    mine[:] = 1.0
    assert not grid.log_odds.any()
    for array in (
        grid.log_odds,
        mapping.update(grid, [0.5, 0.5, 0.0], [1.0], [0.0]).log_odds,
        *(getattr(log, name) for name in ("poses", "edges", "motions", "information")),
        posegraph.solve(log, steps=1).poses,
        posegraph.solve(log, steps=1).errors,
        *(getattr(found, name) for name in ("labels", "centers", "areas", "passages", "doors")),
    ):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    read = logs.parse_g2o("\n".join(little_log()))
    assert not any(array.flags.writeable for array in (read.angles, read.ranges, read.edges))


# --- logs


def little_log(scans: bool = True) -> list[str]:
    lines = []
    for k in range(3):
        lines.append(f"VERTEX_SE2 {k} {k} 0 0")
        if scans:
            lines.append("ROBOTLASER1 0 -1.5 3.0 1.0 50.0 0.1 0 4 1.0 2.0 51.2 3.0 0 0 0")
    return [*lines, "# edges", "EDGE_SE2 0 1 1 0 0 4 0 0 5 0 6", "EDGE_SE2 1 2 1 0 0 4 1 2 5 3 6", "FIX 0"]


def test_a_log_is_read_from_text_and_from_an_archive(tmp_path):
    (tmp_path / "a.g2o").write_text("\n".join(little_log()))
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.write(tmp_path / "a.g2o", "a.g2o")
    for name in ("a.g2o", "a.zip"):
        log = logs.read_g2o(tmp_path / name)
        assert log.poses[:, 0].tolist() == [0, 1, 2]
        assert log.angles == pytest.approx([-1.5, -0.5, 0.5, 1.5])
        assert np.array_equal(log.ranges[1], [1, 2, np.nan, 3], equal_nan=True)
        assert log.information[1].tolist() == [[4, 1, 2], [1, 5, 3], [2, 3, 6]]


def test_toro_names_and_its_order_of_the_information():
    log = logs.parse_g2o("VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nEDGE2 0 1 1 0 0 10 2 30 40 5 6")
    assert log.information[0].tolist() == [[10, 2, 5], [2, 30, 6], [5, 6, 40]]
    assert log.ranges.shape == (2, 0)


@pytest.mark.parametrize(
    ("cut", "words"),
    [
        (lambda t: t[:4] + [t[4][:8]], "line 5: 'VERTEX_S'"),
        (lambda t: t[:4] + ["VERTEX_SE2 2 2"], "line 5: VERTEX_SE2 needs 4 numbers, this line has 2; is the log cut"),
        (lambda t: t[:3] + [t[3][:44]], "line 4: ROBOTLASER1 promises 4 ranges, the line has 1; is the log cut"),
        (lambda t: t[:3] + ["ROBOTLASER1 0 -1.5"], "line 4: ROBOTLASER1 promises its ranges"),
        (lambda t: t[:5], "line 5: vertex 2 has no scan; is the log cut"),
        (lambda t: t[:6], "line 5: no edge follows the last vertex; is the log cut"),
        (lambda t: t[:7] + ["EDGE_SE2 0 1 1 0"], "line 8: EDGE_SE2 needs 11 numbers, this line has 4"),
        (lambda t: [*t, "EDGE_SE2 0 7 1 0 0 4 0 0 5 0 6"], "line 11: edge 0 to 7, but vertices go from 0 to 2"),
        (lambda t: [*t, "EDGE_SE2 0 1 1 0 x 4 0 0 5 0 6"], "line 11: EDGE_SE2: could not convert"),
        (lambda t: [*t, "EDGE_SE2 0 1 1 0 nan 4 0 0 5 0 6"], "line 11: EDGE_SE2: a number is not finite"),
        (lambda t: [*t, "VERTEX_SE3 0 1"], "line 11: 'VERTEX_SE3' is not one of"),
        (lambda t: ["VERTEX_SE2 4 0 0 0"], "line 1: vertex 4 where 0 is due"),
        (lambda t: [t[1]], "line 1: a scan must follow its own vertex"),
        (lambda t: [*t[:3], t[3].replace("50.0", "30.0")], "line 4: the scanner differs"),
        (lambda t: [line.replace("2.0", "-2.0") for line in t], "a range is negative"),
        (lambda t: [], "no vertex"),
    ],
)
def test_a_log_cut_or_damaged_names_the_line(cut, words):
    with pytest.raises(ValueError, match=words):
        logs.parse_g2o("\n".join(cut(little_log())), "a.g2o")


def test_archives_that_are_none(tmp_path):
    (tmp_path / "a.zip").write_bytes(b"PK\x03\x04 cut")
    with pytest.raises(ValueError, match="damaged"):
        logs.read_g2o(tmp_path / "a.zip")
    with zipfile.ZipFile(tmp_path / "b.zip", "w") as archive:
        archive.writestr("readme.txt", "nothing")
    with pytest.raises(ValueError, match="expected one"):
        logs.read_g2o(tmp_path / "b.zip")
    with pytest.raises(FileNotFoundError, match="no such file"):
        logs.read_g2o(tmp_path / "c.g2o")


# --- pose graphs


def square_log(noise: float, seed: int = 0) -> tuple[np.ndarray, logs.ScanLog]:
    """Twice round a square of 40 steps, with loops between the laps; the true poses and the log."""
    rng = np.random.default_rng(seed)
    motions = np.tile([1.0, 0.0, 0.0], (80, 1))
    motions[9::10, 2] = np.pi / 2
    truth = [np.zeros(3)]
    for motion in motions:
        truth.append(compose(truth[-1], motion))
    poses = np.array(truth)
    edges = np.array([(k, k + 1) for k in range(80)] + [(k, k + 40) for k in range(0, 41, 5)])
    told = compose(inverse(poses[edges[:, 0]]), poses[edges[:, 1]]) + noise * rng.standard_normal((len(edges), 3))
    information = np.tile(np.eye(3), (len(edges), 1, 1))
    return poses, logs.ScanLog(poses, edges, told, information, np.empty(0), np.empty((81, 0)), np.inf)


def test_exact_motions_give_the_true_poses():
    truth, log = square_log(0.0)
    assert np.allclose(posegraph.chain(log)[:, :2], truth[:, :2], atol=1e-9)
    found = posegraph.solve(log, truth + [[0.0, 0.0, 0.0], *np.full((80, 3), 0.2)])
    assert found.converged
    assert np.allclose(found.poses[:, :2], truth[:, :2], atol=1e-6)
    assert found.errors[-1] < 1e-9


def test_a_chain_lays_motions_end_to_end_also_sideways_ones():
    _, log = square_log(0.2, 3)
    pose, chained = log.poses[0], posegraph.chain(log)
    for k, motion in enumerate(log.motions[:80]):
        assert np.allclose(chained[k], pose, atol=1e-9)
        pose = compose(pose, motion)
    assert np.allclose(chained[-1], pose, atol=1e-9)


def test_loops_pull_the_poses_towards_the_truth():
    truth, log = square_log(0.03, 1)
    odometry, found = posegraph.chain(log), posegraph.solve(log)
    drift, left = (np.hypot(*(p - truth)[:, :2].T).mean() for p in (odometry, found.poses))
    assert left < 0.5 * drift
    assert np.all(np.diff(found.errors) <= 1e-9 * found.errors[0])


@given(SEEDS)
@relaxed
def test_solution_is_a_minimum(seed):
    _, log = square_log(0.02, seed)
    best = posegraph.solve(log, tolerance=1e-9)
    rng = np.random.default_rng(seed)
    for _ in range(5):
        step = 1e-3 * rng.standard_normal(best.poses.shape)
        step[0] = 0.0
        e = posegraph.residuals(best.poses + step, log)
        assert (e**2).sum() >= best.errors[-1]


def test_broken_chains_and_wrong_starts():
    _, log = square_log(0.0)
    cut = logs.ScanLog(log.poses, log.edges[1:], log.motions[1:], log.information[1:], log.angles, log.ranges, np.inf)
    with pytest.raises(ValueError, match="no edge leads from pose 0 to pose 1"):
        posegraph.chain(cut)
    with pytest.raises(ValueError, match="shape"):
        posegraph.solve(log, np.zeros((3, 3)))
    nothing = logs.ScanLog(log.poses, log.edges, log.motions, 0.0 * log.information, log.angles, log.ranges, np.inf)
    with pytest.raises(ValueError, match="do not tell where every pose is"):
        posegraph.solve(nothing)


# --- the Killian Court


@pytest.fixture(scope="module")
def court():
    return logs.killian()


def test_the_log_is_whole(court):
    assert court.ranges.shape == (3873, 180)
    assert court.edges.shape == (4987, 2)
    assert court.odometry_edges.sum() == 3872
    assert 0.0 < np.isnan(court.ranges).mean() < 0.02
    assert np.nanmax(court.ranges) < court.range_max == 50.0


def test_corrected_poses_agree_with_those_of_the_file_and_sharpen_the_map(court):
    odometry, found = posegraph.chain(court), posegraph.solve(court)
    gap = found.poses - court.poses
    assert found.converged
    assert np.hypot(*gap[:, :2].T).max() < 0.03
    assert np.abs(wrap(gap[:, 2])).max() < 0.015
    assert np.median(np.abs(wrap(gap[:, 2]))) < 0.001
    assert np.hypot(*(odometry - found.poses)[:, :2].T).max() > 100.0
    maps = [
        mapping.build(p[::4], court.ranges[::4], court.angles, resolution=0.25).sharpness()
        for p in (odometry, found.poses)
    ]
    assert maps[1].occupied < 0.9 * maps[0].occupied
    assert maps[1].seen < 0.85 * maps[0].seen


# --- other kinds of map


def test_outline_walks_round_every_solid():
    grid = GridMap.from_ascii(".....\n.##..\n.#...\n.....", 0.5)
    lines = kinds.outline(grid)
    lengths = np.abs(lines[:, 1] - lines[:, 0]).sum(axis=1)
    assert lengths.sum() == pytest.approx(8 * 0.5)
    assert len(lines) == 6
    assert np.all(grid.distance(lines.reshape(-1, 2), border=False) == 0.0)


def test_places_of_the_flat():
    grid = study.flat()
    found = kinds.places(grid, 1.0)
    names = kinds.name_places(found, grid, study.NAMES)
    assert sorted(names) == sorted(study.NAMES)
    passages = {frozenset((names[a], names[b])) for a, b in found.passages}
    assert passages == {frozenset(("corridor", n)) for n in ("kitchen", "lab", "office", "store")}
    assert found.areas.sum() == pytest.approx(0.01 * (~grid.occupied).sum())
    with pytest.raises(ValueError, match="in no place"):
        kinds.name_places(found, grid, {"wall": (0.0, 0.0)})
    with pytest.raises(ValueError, match="same place"):
        kinds.name_places(found, grid, {"a": (2.0, 5.6), "b": (2.1, 5.6)})
    with pytest.raises(ValueError, match="wider"):
        kinds.places(grid, 9.0)


# --- the runs of the notebook


def test_the_tour_is_free_and_repeats():
    motions, poses = study.tour()
    assert World(grid=study.flat()).clearance(poses[:, :2]).min() > 0.3
    assert len(poses) == len(motions) + 1
    assert np.array_equal(study.odometry_of(motions), study.odometry_of(motions))


def test_the_filter_of_the_hall_is_honest_only_at_its_true_noise():
    sensor = LandmarkSensor(range_max=5.0)
    mean = {
        trust: np.mean([study.ekf_run(sensor, trust=trust, seed=s)[2].mean() for s in range(12)])
        for trust in (0.3, 1.0, 3.0)
    }
    assert 2.0 < mean[1.0] < 4.0
    assert mean[0.3] > 6.0
    assert mean[3.0] < mean[1.0]


def test_a_kidnapped_robot_is_found_again_only_with_recovery():
    with_it, without = study.chase(kidnap=True), study.chase(kidnap=True, recovery=False)
    assert with_it.errors[30:38].max() < 0.5
    assert with_it.errors[-5:].max() < 0.3
    assert without.errors[-5:].min() > 1.0
