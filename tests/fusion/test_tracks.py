"""The tracker of moving obstacles against known motion."""

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter

from fuzzynav.control import Observation
from fuzzynav.fusion.clusters import BEAM, NOBODY
from fuzzynav.fusion.filters import TRACK, judge, kalman_step
from fuzzynav.fusion.tracks import Tracker, TrackParams, Tracks
from fuzzynav.sensors import Laser, Scan, laser_scan
from fuzzynav.world import Mover, World, movers_start, movers_step

ROUND = Laser(beams=360, field_of_view=2.0 * np.pi, range_min=0.0, range_max=10.0, noise=0.01)
AHEAD = Laser(beams=720, field_of_view=1.5 * np.pi, range_min=0.0, range_max=10.0, noise=0.001)
DT = 0.1
USUAL = TrackParams()
STILL = np.zeros((40, 3))


def seen(time: float, pose: Any, scan: Scan) -> Observation:
    """An observation with nothing but a scan."""
    none = np.zeros(2)
    return Observation(
        time=time, pose=np.asarray(pose, dtype=float), velocity=none, goal=none, points=np.zeros((0, 2)),
        ranges=scan.ranges, angles=scan.angles, range_max=scan.range_max,
    )  # fmt: skip


def scans(world: World, poses: Any, laser: Laser = ROUND, seed: int = 0) -> tuple[list[Scan], np.ndarray, np.ndarray]:
    """Scans from the poses, and where the movers truly are and how they move."""
    rng, state, made, places, speeds = np.random.default_rng(seed), movers_start(world, 0), [], [], []
    for pose in poses:
        made.append(laser_scan(world, pose, laser, rng, state.positions))
        places.append(state.positions)
        speeds.append(state.velocities)
        state = movers_step(state, DT, pose, rng)
    return made, np.array(places), np.array(speeds)


def follow(
    world: World, poses: Any = STILL, laser: Laser = ROUND, params: TrackParams = USUAL, **known: Any
) -> tuple[list[Tracks], np.ndarray, np.ndarray]:
    """What a tracker tells along the poses, and the truth."""
    made, places, speeds = scans(world, poses, laser)
    tracker = Tracker(params)
    told = [tracker.update(seen(k * DT, poses[k], scan), **known) for k, scan in enumerate(made)]
    return told, places, speeds


def row_at(tracks: Tracks, place: Any, within: float = 0.3) -> int:
    """The track nearest to a place, -1 where none is within."""
    away = np.hypot(*(tracks.centers - place).T)
    return int(np.argmin(away)) if away.size and away.min() < within else -1


def drive(steps: int, speed: float = 0.8, turn: float = 0.3) -> np.ndarray:
    """Poses along a circle that begins at the origin."""
    t = DT * np.arange(steps)
    radius = speed / turn
    return np.stack([radius * np.sin(turn * t), radius * (1.0 - np.cos(turn * t)), turn * t], axis=-1)


def test_a_filter_step_is_that_of_filterpy() -> None:
    rng = np.random.default_rng(3)
    mean, half = rng.normal(size=4), rng.normal(size=(4, 4))
    cov, q, dt = half @ half.T + np.eye(4), 0.3, 0.25
    other = KalmanFilter(dim_x=4, dim_z=2)
    other.x, other.P = mean.copy(), cov.copy()
    other.F = np.eye(4) + dt * np.eye(4, k=2)
    other.Q = q * np.kron([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]], np.eye(2))
    other.H, other.R = np.eye(2, 4), np.array([[0.2, 0.05], [0.05, 0.1]])
    for _ in range(5):
        z = rng.normal(size=2)
        mean, cov = kalman_step(mean, cov, z, dt, q, other.R)
        other.predict()
        other.update(z)
        np.testing.assert_allclose(mean, other.x, atol=1e-12)
        np.testing.assert_allclose(cov, other.P, atol=1e-12)


@pytest.mark.parametrize("laser", [ROUND, AHEAD], ids=["360", "720"])
@pytest.mark.parametrize("poses", [STILL, drive(40)], ids=["standing", "driving"])
def test_a_constant_velocity_is_found(laser: Laser, poses: np.ndarray) -> None:
    velocity = np.array([0.6, 0.4])
    told, places, _ = follow(World(movers=(Mover.constant((2.5, 0.5), velocity, 0.4),)), poses, laser)
    first = told[1].ids[0]
    assert told[4].moving[0], "0.24 m of way are seen at once"
    for k in range(6, 40):
        now = told[k]
        assert now.ids.tolist() == [first] and now.moving[0] and now.unseen[0] == 0.0
        assert np.hypot(*(now.velocities[0] - velocity)) < (0.2 if k < 12 else 0.12)
        assert np.hypot(*(now.centers[0] - places[k, 0])) < 0.05
        assert now.ages[0] == pytest.approx(k * DT)
    assert told[-1].radii[0] == pytest.approx(0.4, abs=0.02)
    np.testing.assert_allclose(told[-1].movers, [[*told[-1].centers[0], *told[-1].velocities[0], told[-1].radii[0]]])


def test_the_doubt_is_honest() -> None:
    world = World(movers=(Mover.constant((-4.0, 3.0), (0.5, 0.1), 0.3), Mover.constant((4.0, 2.5), (0.1, -0.4), 0.5)))
    told, places, speeds = follow(world, np.zeros((80, 3)))
    squares = []
    for now, place, speed in zip(told[10:], places[10:], speeds[10:], strict=True):
        for i in range(2):
            row = row_at(now, place[i])
            error = np.concatenate([now.centers[row] - place[i], now.velocities[row] - speed[i]])
            squares.append(error @ np.linalg.solve(now.covariances[row], error))
    assert 0.3 < np.mean(squares) < 4.5, "4 of a perfect filter, less of one that expects turns"


def test_crossing_movers_keep_their_names() -> None:
    one, two = Mover.constant((-3.0, 3.0), (0.8, 0.0), 0.35), Mover.constant((3.0, 4.5), (-0.8, 0.0), 0.35)
    told, places, _ = follow(World(movers=(one, two)), np.zeros((75, 3)))
    names = [told[5].ids[row_at(told[5], place)] for place in places[5]]
    assert names[0] != names[1]
    for k in (70, 74):
        assert [told[k].ids[row_at(told[k], place)] for place in places[k]] == names
    hidden = [now.unseen[now.ids == names[1]] for now in told[30:45]]
    assert max(float(u[0]) for u in hidden) > 0.0, "the nearer one hid it for a while"


def test_movers_that_touch_in_the_scan_are_seen_apart() -> None:
    one, two = Mover.constant((-2.0, 3.0), (0.5, 0.0), 0.4), Mover.constant((2.0, 3.5), (-0.5, 0.0), 0.4)
    world = World(movers=(one, two))
    told, places, _ = follow(world, np.zeros((80, 3)))
    names = [told[12].ids[row_at(told[12], place)] for place in places[12]]
    mine = beams = 0
    for now, place in zip(told[12:], places[12:], strict=True):
        _, owners = world.cast_labelled(np.zeros(3), ROUND.angles, 10.0, place)
        row = int(np.flatnonzero(now.ids == names[0])[0])
        assert now.unseen[row] < 0.25, "the nearer one is never hidden"
        mine, beams = mine + int((now.labels[owners == 0] == row).sum()), beams + int((owners == 0).sum())
    assert mine / beams > 0.97, "its hits are its own, also while both make one cluster"
    assert [told[-1].ids[row_at(told[-1], place)] for place in places[-1]] == names


@pytest.mark.parametrize("velocity", [(0.0, 1.0), (0.5, 1.0), (1.0, 1.0), (0.0, 0.6)])
def test_a_wall_takes_no_name_from_what_went_behind_it(velocity: tuple[float, float]) -> None:
    world = World(movers=(Mover.constant((0.0, 1.5), velocity, 0.4),), rectangles=[[0.0, 4.0, 12.0, 0.2, 0.0]])
    told, _, _ = follow(world, np.zeros((80, 3)))
    assert told[15].moving.tolist() == [True]
    sunk = int((4.3 - 1.5) / velocity[1] / DT) + 1  # its nearest point is in the wall's face
    held = [bool((now.moving & (now.unseen == 0.0)).any()) for now in told[sunk:]]
    assert sum(held) <= 12, "the wall is taken for it for a second at most"
    assert not any(held[12:])


def test_what_is_hidden_coasts_and_is_found_again() -> None:
    world = World(movers=(Mover.constant((-2.0, 4.0), (1.0, 0.0), 0.3),), rectangles=[[0.0, 2.5, 1.2, 0.1, 0.0]])
    told, places, _ = follow(world, np.zeros((45, 3)))
    name = told[5].ids[row_at(told[5], places[5, 0])]
    rows = [np.flatnonzero(now.ids == name) for now in told[5:]]
    assert all(r.size == 1 for r in rows), "one track throughout"
    unseen = np.array([now.unseen[r[0]] for now, r in zip(told[5:], rows, strict=True)])
    assert unseen.max() > 0.8 and unseen[-1] == 0.0
    k = 5 + int(np.argmax(unseen))
    doubt = [told[i].covariances[rows[i - 5][0]][0, 0] for i in (k - 5, k)]
    assert doubt[1] > 2.0 * doubt[0], "doubt grows while nothing is seen"
    assert np.hypot(*(told[k].centers[rows[k - 5][0]] - places[k, 0])) < 0.25
    assert told[k].moving[rows[k - 5][0]]


@pytest.mark.parametrize("patience", [0.25, 0.65])
def test_what_leaves_is_forgotten_and_what_comes_is_new(patience: float) -> None:
    params = TrackParams(patience=patience)
    tracker, angles, told = Tracker(params), ROUND.angles, []
    there, gone = World(discs=[[3.0, 0.0, 0.4]]), World(discs=[[0.0, 4.0, 0.4]])
    for k in range(30):
        world = there if k < 10 or k >= 20 else gone
        ranges = world.cast(np.zeros(3), angles, 10.0)
        told.append(tracker.update(seen(k * DT, np.zeros(3), Scan(
            angles=angles, ranges=np.where(ranges < 10.0, ranges, np.inf), range_max=10.0))))  # fmt: skip
    assert row_at(told[9], [3.0, 0.0]) >= 0 and row_at(told[9], [0.0, 4.0]) < 0
    late = 10 + int(params.patience / DT)
    assert row_at(told[late - 1], [3.0, 0.0]) >= 0, "a miss is not yet the end"
    assert row_at(told[late], [3.0, 0.0]) < 0, "the scan looks through its place"
    assert row_at(told[late], [0.0, 4.0]) >= 0
    ids = {int(now.ids[row_at(now, [3.0, 0.0])]) for now in (told[9], told[29])}
    assert len(ids) == 2, "a name is never used twice"


def test_a_hidden_track_is_forgotten_in_the_end() -> None:
    params, pose = TrackParams(coast=1.0), np.zeros(3)
    tracker, blind = Tracker(params), Scan(angles=ROUND.angles, ranges=np.full(360, np.nan), range_max=10.0)
    world = World(discs=[[3.0, 0.0, 0.4]])
    for k in range(5):
        tracker.update(seen(k * DT, pose, laser_scan(world, pose, ROUND, np.random.default_rng(k))))
    left = [len(tracker.update(seen(k * DT, pose, blind)).ids) for k in range(5, 30)]
    assert left[:9] == [1] * 9 and left[11:] == [0] * len(left[11:])


@pytest.mark.parametrize("laser", [ROUND, AHEAD], ids=["360", "720"])
def test_nothing_moves_in_a_standing_world(laser: Laser) -> None:
    rng = np.random.default_rng(5)
    blocks = [[*p, *rng.uniform(0.3, 1.5, 2), rng.uniform(0.0, 3.0)] for p in rng.uniform(-8, 8, (30, 2))]
    posts = [[*p, rng.uniform(0.1, 0.4)] for p in rng.uniform(-8, 8, (20, 2))]
    world = World(
        rectangles=[b for b in blocks if not 1.0 < np.hypot(b[0], b[1] - 2.7) < 4.4],
        discs=[d for d in posts if not 1.5 < np.hypot(d[0], d[1] - 2.7) < 3.8],
        bounds=(-10, 10, -10, 10),
    )
    told, _, _ = follow(world, drive(250), laser)
    assert np.mean([len(now.ids) for now in told]) > 4.0
    assert sum(int(now.moving.sum()) for now in told) == 0


def test_what_odometry_may_err_is_no_motion() -> None:
    rng = np.random.default_rng(1)
    world = World(discs=[[*p, 0.3] for p in rng.uniform(-7, 7, (40, 2)) if np.hypot(p[0], p[1] - 2.7) > 3.6])
    poses = drive(200)
    wrong = poses.copy()
    wrong[:, 2] += 0.1 * np.cumsum(np.r_[0.0, np.random.default_rng(0).standard_normal(199) * np.diff(poses[:, 2])])
    made, _, _ = scans(world, poses)
    counts = []
    for params in (TrackParams(drift=0.1), USUAL):
        tracker = Tracker(params)
        counts.append(sum(int(tracker.update(seen(k * DT, wrong[k], s)).moving.sum()) for k, s in enumerate(made)))
    assert counts[0] == 0 < counts[1], "who is not told of the drift takes it for motion"


def test_a_reversal_is_noticed_at_once() -> None:
    world = World(movers=(Mover.patrol([[-1.5, 3.0], [1.5, 3.0]], 0.6, 0.35),))
    told, _, speeds = follow(world, np.zeros((140, 3)))
    turns = np.flatnonzero(np.abs(np.diff(speeds[:, 0, 0])) > 0.5) + 1
    assert len(turns) >= 2
    for k in turns:
        assert {tuple(now.ids) for now in told[k : k + 8]} == {tuple(told[k - 1].ids)}
        late = [np.hypot(*(now.velocities[0] - speeds[k, 0])) for now in told[k + 4 : k + 20]]
        assert max(late) < 0.2, f"{max(late):.2f} m/s wrong 0.4 s after the turn"


def test_no_estimate_is_faster_than_the_bound() -> None:
    world = World(movers=(Mover.constant((-3.0, 3.0), (1.2, 0.0), 0.35),))
    told, _, _ = follow(world, params=TrackParams(velocity_bound=0.5))
    speeds = [np.hypot(*now.velocities.T).max(initial=0.0) for now in told]
    assert 0.45 < max(speeds) <= 0.5 + 1e-12


def test_a_chart_takes_its_walls_away() -> None:
    scene = World(rectangles=[[2.0, 0.0, 0.5, 0.5, 0.3]], movers=(Mover.constant((-2, 2), (0.5, 0), 0.3),),
                  bounds=(-5, 5, -5, 5))  # fmt: skip
    chart = scene.known_grid(0.1)
    with_chart, places, _ = follow(scene, chart=chart)
    without, _, _ = follow(scene)
    assert row_at(without[-1], [2.0, 0.0]) >= 0 and len(with_chart[-1].ids) == 1
    assert row_at(with_chart[-1], places[-1, 0]) == 0


def test_labels_say_whose_hit_a_beam_is() -> None:
    world = World(movers=(Mover.constant((2.0, 1.0), (0.3, 0.0), 0.4), Mover.constant((-2, 2), (0.0, 0.4), 0.3)),
                  bounds=(-6, 6, -6, 6))  # fmt: skip
    poses = drive(30, 0.3)
    told, places, _ = follow(world, poses)
    _, owners = world.cast_labelled(poses[-1], ROUND.angles, 10.0, places[-1])
    rows = [row_at(told[-1], place) for place in places[-1]]
    assert np.mean(told[-1].labels[owners == 0] == rows[0]) > 0.95
    assert np.mean(told[-1].labels[owners == 1] == rows[1]) > 0.95
    assert not np.isin(told[-1].labels[owners < 0], rows).any()


def test_a_mirrored_scan_gives_mirrored_tracks() -> None:
    world = World(movers=(Mover.constant((2.0, 1.0), (0.3, 0.5), 0.4), Mover.constant((-2, 2), (0.4, 0.4), 0.3)),
                  rectangles=[[0.0, -3.0, 0.4, 0.3, 0.2]], bounds=(-6, 6, -6, 6))  # fmt: skip
    poses = drive(25)
    made, _, _ = scans(world, poses)
    one, two = Tracker(), Tracker()
    for k, scan in enumerate(made):
        flipped = Scan(angles=-scan.angles, ranges=scan.ranges, range_max=scan.range_max)
        a, b = one.update(seen(k * DT, poses[k], scan)), two.update(seen(k * DT, poses[k] * [1, -1, -1], flipped))
        assert len(a.ids) == len(b.ids)
        for i, center in enumerate(a.centers):
            j = row_at(b, center * [1, -1], 1e-6)
            assert j >= 0 and a.moving[i] == b.moving[j]
            np.testing.assert_allclose(b.velocities[j], a.velocities[i] * [1, -1], atol=1e-6)
            np.testing.assert_allclose(b.radii[j], a.radii[i], atol=1e-6)
            assert ((a.labels == i) == (b.labels == j)).all()


def test_the_same_scans_give_the_same_tracks() -> None:
    world = World(movers=(Mover.constant((2.0, 1.0), (0.3, 0.5), 0.4),), bounds=(-6, 6, -6, 6))
    made, _, _ = scans(world, STILL)
    tracker = Tracker()
    runs = []
    for _ in range(2):
        tracker.reset()
        runs.append([tracker.update(seen(k * DT, np.zeros(3), scan)) for k, scan in enumerate(made)])
    for a, b in zip(*runs, strict=True):
        for field in fields(Tracks):
            assert np.array_equal(getattr(a, field.name), getattr(b, field.name)), field.name


def test_beams_out_of_order_are_put_in_order() -> None:
    made, _, _ = scans(World(movers=(Mover.constant((-2.0, 0.1), (0.0, -0.4), 0.4),)), STILL)
    order = np.random.default_rng(2).permutation(360)
    one, two = Tracker(), Tracker()
    for k, scan in enumerate(made):
        mixed = Scan(angles=scan.angles[order] + 4.0 * np.pi, ranges=scan.ranges[order], range_max=scan.range_max)
        a, b = one.update(seen(k * DT, np.zeros(3), scan)), two.update(seen(k * DT, np.zeros(3), mixed))
        np.testing.assert_allclose(a.movers, b.movers, atol=1e-9)
        assert (a.labels[order] == b.labels).all()


@pytest.mark.parametrize(
    ("hits", "free", "drift", "share"),
    [(10, 0, 0.0, 0.0), (10, 1, 0.0, 0.0), (10, 2, 0.0, 0.2), (3, 3, 0.0, 0.0), (4, 4, 0.0, 1.0), (10, 2, 0.5, 0.0)],
)
def test_what_proves_motion(hits: int, free: int, drift: float, share: float) -> None:
    rules = TrackParams(drift=drift).rules()
    then, now = np.zeros(360, dtype=BEAM), np.zeros(360, dtype=BEAM)
    for beams in (then, now):  # a round wall 5 m away
        beams["bearing"] = beams["turn"] = np.arange(360) * 2.0 * np.pi / 360.0
        beams["gap"], beams["range"], beams["owner"] = 2.0 * np.pi / 360.0, 5.0, NOBODY
    now["range"][:free] = 4.0  # something came before it
    for beams in (then, now):
        beams["x"], beams["y"] = beams["range"] * np.cos(beams["bearing"]), beams["range"] * np.sin(beams["bearing"])
    now["owner"][:hits] = 7
    track = np.zeros(2, dtype=TRACK)
    track["id"] = 3, 7
    past, moment = np.zeros(9), np.array([0.0, 0.0, 0.0, 0.3, 0.1, 0.2, 0.5, 0.1, 0.2])  # it drove and turned since
    assert judge(track, now, moment, then, past, np.zeros(2), rules).tolist() == [0.0, share]
    then["owner"], now["owner"] = now["owner"].copy(), NOBODY
    now["range"], then["range"] = then["range"].copy(), now["range"].copy()
    for beams in (then, now):
        beams["x"], beams["y"] = beams["range"] * np.cos(beams["bearing"]), beams["range"] * np.sin(beams["bearing"])
    found = judge(track, now, moment, then, past, np.array([0.0, 0.1]), rules)
    assert found.tolist() == [0.0, max(share, 0.1)], "what left a place is seen by looking through it"


@pytest.mark.parametrize("field", [f.name for f in fields(TrackParams) if f.name != "patience"])
def test_every_parameter_has_an_effect(field: str) -> None:
    usual = getattr(USUAL, field)
    other: dict[str, Any] = {
        "radius_min": 0.5, "misfit_max": 0.004, "chart_tolerance": 1.0, "beams_min": 20, "bridge": 1.5, "gate": 1e-3,
        "velocity_bound": 0.4, "turn_share": 0.9, "confirm": 4, "coast": 0.2, "look_back": (0.5, 1.5), "drift": 0.2,
    }  # fmt: skip
    given = other.get(field, 2 * usual)
    world = World(
        movers=(
            Mover.patrol([[-3.0, 3.5], [3.0, 3.5]], 0.9, 0.3),
            Mover.patrol([[3.0, 1.5], [-3.0, 2.5]], 0.2, 0.4),
            Mover.constant((0.5, -3.0), (0.07, 0.0), 0.3),
        ),
        rectangles=[[0.0, 2.5, 1.2, 0.1, 0.0]],
        bounds=(-5, 5, -5, 5),
    )
    chart = World(rectangles=[[0.0, 2.5, 1.2, 0.1, 0.0]], bounds=(-5, 5, -5, 5)).known_grid(0.1)
    poses, laser = drive(60, 0.3, 0.1), replace(ROUND, dropout=0.05)
    a = follow(world, poses, laser, chart=chart)[0]
    b = follow(world, poses, laser, replace(USUAL, **{field: given}), chart=chart)[0]
    same = [np.array_equal(x.movers, y.movers) and np.array_equal(x.ids, y.ids) for x, y in zip(a, b, strict=True)]
    assert not all(same), f"{field} = {given} in place of {usual} changes nothing"


@pytest.mark.parametrize("beams", [0, 1, 2])
@pytest.mark.parametrize("reading", [2.0, np.nan, np.inf, -np.inf])
def test_a_poor_scan_is_no_fault(beams: int, reading: float) -> None:
    tracker = Tracker()
    scan = Scan(angles=np.linspace(0.0, 0.01, beams), ranges=np.full(beams, reading), range_max=5.0)
    for k in range(4):
        assert len(tracker.update(seen(k * DT, np.zeros(3), scan)).labels) == beams


def test_bad_input_is_one_clear_error() -> None:
    scan = scans(World(), STILL[:1])[0][0]
    good = seen(1.0, np.zeros(3), scan)
    tracker = Tracker()
    tracker.update(good)
    with pytest.raises(ValueError, match="there is none"):
        tracker.update(replace(good, time=2.0, ranges=None, angles=None))
    with pytest.raises(ValueError, match="3 finite numbers"):
        tracker.update(replace(good, time=2.0, pose=np.full(3, np.nan)))
    with pytest.raises(ValueError, match="one range for each finite angle"):
        tracker.update(replace(good, time=2.0, angles=np.zeros(3)))
    with pytest.raises(ValueError, match="range_max must be positive"):
        tracker.update(replace(good, time=2.0, range_max=0.0))
    with pytest.raises(ValueError, match="time must grow"):
        tracker.update(good)
    assert len(tracker.update(replace(good, time=2.0, goal=np.full(2, np.nan))).labels) == 360, "no goal is needed"
    tracker.reset()
    tracker.update(good)
    with pytest.raises(ValueError, match="look_back"):
        TrackParams(look_back=(1.0, 0.3))
    with pytest.raises(ValueError, match="radius_min < radius_max"):
        TrackParams(radius_min=0.8)
    with pytest.raises(ValueError, match="range_noise must be positive"):
        TrackParams(range_noise=0.0)
