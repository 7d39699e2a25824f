"""The closed loop and its record: limits, repeatability, named endings, contacts, noise, files."""

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav import dwa, simulate
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import THESIS, TURTLEBOT2, move, respects_limits
from fuzzynav.sensors import Odometry
from fuzzynav.simulate import IDEAL_LASER, Disturbance, Loop, Playback
from fuzzynav.simulate.record import Run
from fuzzynav.world import Mover, World
from tests.fuzzing import damages

EMPTY = World()


@dataclass
class Steady:
    """A controller that always wants the same."""

    wish: tuple[float, float] = (1.0, 0.0)
    status: str | None = None
    evidence: dict = field(default_factory=dict)

    def reset(self) -> None:
        self.calls = 0

    def __call__(self, observation):
        self.calls += 1
        return np.array(self.wish)


@dataclass
class Erratic(Steady):
    """A controller whose wishes are wild, from a seed."""

    seed: int = 0

    def reset(self) -> None:
        self.rng = np.random.default_rng(self.seed)

    def __call__(self, observation):
        return self.rng.normal(0.0, 3.0, 2)


def rocks(seed: int, count: int = 25) -> World:
    rng = np.random.default_rng(seed)
    return World(discs=np.column_stack([rng.uniform(3, 17, (count, 2)), rng.uniform(0.2, 0.6, count)]))


def same(a: Run, b: Run) -> bool:
    return (
        a.status == b.status
        and set(a.log) == set(b.log)
        and all(
            np.array_equal(x, y, equal_nan=True)
            for x, y in [
                (a.poses, b.poses),
                (a.commands, b.commands),
                (a.clearance, b.clearance),
                *((a.log[k], b.log[k]) for k in a.log),
            ]
        )
    )


# --- motion and limits ------------------------------------------------------------------------------


def test_straight_run_is_known() -> None:
    """0.2 m/s^2 up to 1 m/s: after n steps of 0.1 s the way is 0.1 (0.02 + 0.04 + ...)."""
    run = simulate.run(EMPTY, THESIS, Steady(), (0, 0, 0), (100, 0), t_max=6.0)
    assert run.status == "timeout"
    assert run.iterations == 60
    assert run.commands[49, 0] == pytest.approx(1.0)
    assert run.poses[-1, 0] == pytest.approx(0.1 * (0.02 * 50 * 51 / 2 + 10), abs=1e-9)
    assert run.length == pytest.approx(run.poses[-1, 0], abs=1e-9)
    assert run.duration == pytest.approx(6.0)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([THESIS, TURTLEBOT2]), st.sampled_from([0.05, 0.1, 0.3]))
def test_limits_hold_in_every_step(seed: int, robot, dt: float) -> None:
    run = simulate.run(EMPTY, robot, Erratic(seed=seed), (0, 0, 0), (100, 0), dt=dt, t_max=6.0)
    assert respects_limits(np.vstack([[0.0, 0.0], run.commands]), dt, robot)
    np.testing.assert_allclose(run.poses[1:], move(run.poses[:-1], run.commands, dt), atol=1e-12)


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10**6))
def test_dwa_keeps_the_limits_and_gets_what_it_asks_for(seed: int) -> None:
    run = simulate.run(rocks(seed), THESIS, dwa.Controller(THESIS), (1, 1), (19, 19), t_max=20.0)
    assert respects_limits(np.vstack([[0.0, 0.0], run.commands]), 0.1, THESIS)
    np.testing.assert_allclose(run.commands, run.log["wish"], atol=1e-12)


def test_motor_lag_delays_but_arrives_at_the_command() -> None:
    sharp = simulate.run(EMPTY, THESIS, Steady(), (0, 0, 0), (100, 0), t_max=10.0)
    soft = simulate.run(
        EMPTY, THESIS, Steady(), (0, 0, 0), (100, 0), t_max=10.0, disturbance=Disturbance(motor_lag=0.4)
    )
    assert soft.length < sharp.length
    assert soft.driven[-1, 0] == pytest.approx(1.0, abs=1e-3)
    finer = simulate.run(
        EMPTY, THESIS, Steady(), (0, 0, 0), (100, 0), dt=0.05, t_max=10.0, disturbance=Disturbance(motor_lag=0.4)
    )
    assert finer.length == pytest.approx(soft.length, rel=0.02)


# --- repeatability ----------------------------------------------------------------------------------


def test_same_seed_same_run_bit_for_bit() -> None:
    movers = (Mover.wander((8, 12), 0.5, 0.3), Mover.patrol([(4, 9), (12, 9)], 0.4, 0.3, yield_distance=1.0))
    world = World(discs=rocks(3).discs, bounds=(0, 20, 0, 20), movers=movers)
    noisy = {
        "laser": replace(IDEAL_LASER, noise=0.02, dropout=0.02),
        "odometry": Odometry(noise=(0.05, 0.05), bias=(0.01, -0.01)),
    }
    controller = dwa.Controller(THESIS)
    runs = [simulate.run(world, THESIS, controller, (1, 1), (19, 19), rng=7, t_max=25.0, **noisy) for _ in range(2)]
    assert same(*runs)
    other = simulate.run(world, THESIS, controller, (1, 1), (19, 19), rng=8, t_max=25.0, **noisy)
    assert not same(runs[0], other)


def test_noise_does_not_change_how_the_movers_walk() -> None:
    world = World(bounds=(0, 20, 0, 20), movers=(Mover.wander((8, 12), 0.5, 0.3),))
    standing = Steady((0.0, 0.0))
    plain = simulate.run(world, THESIS, standing, (1, 1), (19, 19), rng=3, t_max=10.0)
    noisy = simulate.run(
        world, THESIS, standing, (1, 1), (19, 19), rng=3, t_max=10.0, laser=replace(IDEAL_LASER, noise=0.1)
    )
    np.testing.assert_array_equal(plain.log["movers"], noisy.log["movers"])


def test_playback_repeats_the_run() -> None:
    first = simulate.run(rocks(5), THESIS, dwa.Controller(THESIS), (1, 1), (19, 19))
    again = simulate.run(rocks(5), THESIS, Playback(first), (1, 1), (19, 19))
    np.testing.assert_array_equal(first.poses, again.poses)
    assert again.status == first.status


def test_mirrored_world_mirrored_run() -> None:
    world = rocks(11)
    mirrored = World(discs=world.discs * (1, -1, 1))
    a = simulate.run(world, THESIS, dwa.Controller(THESIS), (1, 1), (19, 19), t_max=20.0)
    b = simulate.run(mirrored, THESIS, dwa.Controller(THESIS), (1, -1), (19, -19), t_max=20.0)
    np.testing.assert_allclose(b.poses[:, :2], a.poses[:, :2] * (1, -1), atol=1e-3)


# --- endings and contacts ---------------------------------------------------------------------------


def test_every_ending_has_its_name() -> None:
    wall = World(discs=[[3.0, 0.0, 0.5]])
    assert simulate.run(EMPTY, THESIS, Steady(), (0, 0, 0), (5, 0)).status == "reached"
    assert simulate.run(EMPTY, THESIS, Steady(), (0, 0), (0.2, 0)).status == "reached"
    assert simulate.run(wall, THESIS, Steady(), (0, 0, 0), (9, 0)).status == "collided"
    assert simulate.run(EMPTY, THESIS, Steady((0, 0)), (0, 0, 0), (9, 0)).status == "stalled"
    assert simulate.run(EMPTY, THESIS, Steady((0.5, 0.35)), (0, 0, 0), (99, 0), t_max=20.0).status == "timeout"
    assert simulate.run(EMPTY, THESIS, Steady(status="no_path"), (0, 0, 0), (9, 0)).status == "no_path"
    with pytest.raises(ValueError, match="use one of"):
        simulate.run(EMPTY, THESIS, Steady(status="tired"), (0, 0, 0), (9, 0))


def test_who_turns_on_the_spot_is_not_stalled_and_who_trembles_is() -> None:
    turning, still = Loop(stall_time=3.0), Loop(stall_time=3.0, stall_angle=4.0)
    assert (
        simulate.run(EMPTY, THESIS, Steady((0, 0.35)), (0, 0, 0), (9, 0), t_max=9.0, loop=turning).status == "timeout"
    )
    assert simulate.run(EMPTY, THESIS, Steady((0, 0.35)), (0, 0, 0), (9, 0), t_max=9.0, loop=still).status == "stalled"


def test_contact_is_seen_inside_a_step() -> None:
    """A disc grazed between two steps of 1 s still counts."""
    run = simulate.run(
        World(discs=[[1.55, 0.31, 0.02]]),
        replace(THESIS, acc_lim_x=9.0),
        Steady(),
        (0, 0, 0),
        (9, 0),
        dt=1.0,
        t_max=9.0,
    )
    assert run.status == "collided"
    assert run.min_clearance < 0


def test_a_mover_that_runs_past_inside_a_step_is_seen() -> None:
    """At 4 m/s and steps of 1 s it is 1.6 m away before the step, 2.4 m after it, and over the robot in between."""
    world = World(movers=(Mover.constant((0.0, -1.6), (0.0, 4.0), 0.1),))
    run = simulate.run(world, THESIS, Steady((0.0, 0.0)), (0, 0, 0), (9, 0), dt=1.0, t_max=1.0)
    assert run.contacts_standing == 1
    assert run.clearance[0] == pytest.approx(-THESIS.radius - 0.1)


def test_contacts_of_a_moving_and_of_a_standing_robot_are_counted_apart() -> None:
    world = World(movers=(Mover.constant((5, 0), (-0.5, 0.0), 0.3),))
    rest = simulate.run(world, THESIS, Steady((0, 0)), (0, 0, 0), (20, 0), t_max=14.0)
    assert (rest.contacts_moving, rest.contacts_standing) == (0, 1)
    assert rest.status == "timeout"
    drive = simulate.run(world, THESIS, Steady(), (0, 0, 0), (20, 0), t_max=14.0)
    assert (drive.contacts_moving, drive.status) == (1, "collided")
    on = simulate.run(world, THESIS, Steady(), (0, 0, 0), (20, 0), t_max=14.0, loop=Loop(stop_at_contact=False))
    assert on.contacts_moving == 1
    assert on.iterations == 140


def test_a_mover_that_yields_does_not_touch_a_standing_robot() -> None:
    world = World(movers=(Mover.constant((5, 0), (-0.5, 0.0), 0.3, yield_distance=1.0),))
    rest = simulate.run(world, THESIS, Steady((0, 0)), (0, 0, 0), (20, 0), t_max=14.0)
    assert rest.contacts_standing == 0


def test_a_run_may_end_as_struck() -> None:
    world = World(movers=(Mover.constant((5, 0), (-0.5, 0.0), 0.3),))
    told = {"t_max": 14.0, "loop": Loop(end_when_struck=True)}
    run = simulate.run(world, THESIS, Steady((0, 0)), (0, 0, 0), (20, 0), **told)
    assert (run.status, run.contacts_moving, run.contacts_standing, run.success) == ("struck", 0, 1, False)
    assert run.clearance[-1] <= 0.0 < run.clearance[:-1].min()
    assert simulate.run(world, THESIS, Steady(), (0, 0, 0), (20, 0), **told).status == "collided"
    polite = World(movers=(replace(world.movers[0], courtesy=0.1),))
    waited = simulate.run(polite, THESIS, Steady((0, 0)), (0, 0, 0), (20, 0), **told)
    assert (waited.status, waited.contacts_standing) == ("timeout", 0)
    assert 0.1 <= waited.min_clearance < 0.15 + 1e-9
    # it waits for who stands, not for who drives
    assert simulate.run(polite, THESIS, Steady(), (0, 0, 0), (20, 0), **told).status == "collided"


def test_a_robot_that_creeps_counts_as_standing_where_the_loop_says_so() -> None:
    creep, loop = Steady((0.04, 0.0)), Loop(end_when_struck=True, standing=0.05)
    world = World(movers=(Mover.constant((5, 0), (-0.5, 0.0), 0.3),))
    struck = simulate.run(world, THESIS, creep, (0, 0, 0), (20, 0), t_max=14.0, loop=loop)
    assert (struck.status, struck.contacts_moving, struck.contacts_standing) == ("struck", 0, 1)
    plain = simulate.run(world, THESIS, creep, (0, 0, 0), (20, 0), t_max=14.0, loop=replace(loop, standing=0.03))
    assert (plain.status, plain.contacts_moving, plain.contacts_standing) == ("collided", 1, 0)
    wall = World(bounds=(-1.0, 0.5, -1.0, 1.0))  # nothing ran into it: it crept into the wall
    crept = simulate.run(wall, THESIS, creep, (0, 0, 0), t_max=14.0, loop=loop)
    assert (crept.status, crept.contacts_moving, crept.contacts_standing) == ("collided", 1, 0)
    with pytest.raises(ValueError, match="standing"):
        Loop(standing=-0.1)


def test_a_mover_that_jumps_touches_only_where_it_lands() -> None:
    around = [[0, -2, 0], [1, -2, 3], [2, 2, 3], [3, 2, 0]]  # and back to (-2, 0), over the robot
    world = World(movers=(Mover.timed(around, 0.3, phase=0.05),))
    over = simulate.run(world, THESIS, Steady((0, 0)), (0, 0, 0), t_max=9.0)
    assert over.contacts_standing == 0
    assert over.min_clearance == pytest.approx(2.0 - 0.3 - THESIS.radius, abs=0.01)
    t = np.mod(0.05 + over.t, 3.0)
    expected = [np.interp(t, [0, 1, 2, 3], row) for row in ([-2, -2, 2, 2], [0, 3, 3, 0])]
    np.testing.assert_allclose(over.log["movers"][:, 0].T, expected, atol=1e-9)
    onto = World(movers=(Mover.timed([[0, 0, 1], [1, 3, 0]], 0.3, phase=0.55),))
    landed = simulate.run(onto, THESIS, Steady((0, 0)), (0, 0.6, 0), t_max=9.0, loop=Loop(end_when_struck=True))
    assert landed.status == "struck"
    assert landed.duration == pytest.approx(0.5)


def test_dwa_in_a_dead_end_gets_a_name() -> None:
    """Goal behind a U: without recovery the run is stalled; with it, it escapes or is a local minimum."""
    y = np.arange(-1.2, 1.21, 0.1)
    sides = [np.column_stack([np.arange(2.0, 4.0, 0.1), np.full(20, s * 1.2)]) for s in (-1, 1)]
    cup = np.vstack([np.column_stack([np.full(y.size, 4.0), y]), *sides])
    world = World(discs=np.column_stack([cup, np.full(len(cup), 0.1)]))
    plain = simulate.run(world, THESIS, dwa.Controller(THESIS), (0, 0), (8, 0))
    assert plain.status == "stalled"
    assert plain.contacts_moving == 0
    trying = dwa.Controller(THESIS, stuck=dwa.Stuck(tries=2))
    run = simulate.run(world, THESIS, trying, (0, 0), (8, 0))
    assert run.status == "reached"
    assert run.contacts_moving == 0
    assert run.log["recovering"].any()


def test_recovery_that_finds_no_way_names_the_local_minimum() -> None:
    bearing = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    ring = World(discs=np.column_stack([2 * np.cos(bearing), 2 * np.sin(bearing), np.full(60, 0.15)]))
    run = simulate.run(ring, THESIS, dwa.Controller(THESIS, stuck=dwa.Stuck(tries=1)), (0, 0), (8, 0))
    assert run.status == "local_minimum"
    assert run.contacts_moving == 0


# --- sensing ----------------------------------------------------------------------------------------


class Spy(Steady):
    """Keeps what it was shown."""

    def reset(self) -> None:
        self.seen = []

    def __call__(self, observation):
        self.seen.append(observation)
        return np.array(self.wish)


def test_ideal_scan_lies_on_the_surfaces() -> None:
    spy = Spy()
    world = World(discs=[[3.0, 1.0, 0.5]], unknown_discs=[[2.0, -2.0, 0.3]])
    simulate.run(world, THESIS, spy, (0, 0, 0.3), (9, 0), t_max=2.0)
    for o in spy.seen:
        assert np.abs(world.clearance(o.points)).max() < 1e-9
        assert o.range_max == 10.0
        assert np.isinf(o.ranges[~np.isfinite(o.ranges)]).all()
    assert (np.hypot(*(spy.seen[0].points - (2, -2)).T) < 0.3 + 1e-9).any()  # unknown obstacles are seen too


def test_tracker_tells_the_velocity_of_movers_only() -> None:
    spy = Spy((0.0, 0.0))
    world = World(discs=[[3.0, 1.0, 0.5]], movers=(Mover.constant((3, -2), (0.0, 0.4), 0.3),))
    simulate.run(world, THESIS, spy, (0, 0, 0), (9, 0), t_max=1.0, track_movers=True)
    o = spy.seen[0]
    fast = np.hypot(*o.point_velocities.T) > 0
    assert 0 < fast.sum() < fast.size
    np.testing.assert_allclose(o.point_velocities[fast], [[0.0, 0.4]] * fast.sum())
    assert (np.abs(np.hypot(*(o.points[fast] - (3, -2)).T) - 0.3) < 1e-9).all()


def test_tracker_tells_all_movers_seen_or_not() -> None:
    behind = Mover.timed([[0, 9, 0], [4, 9, 2]], 0.4, phase=1.0)
    world = World(discs=[[3.0, 0.0, 0.5]], movers=(Mover.constant((3, -2), (0.0, 0.4), 0.3), behind))
    for laser in (IDEAL_LASER, None):
        spy = Spy((0.0, 0.0))
        simulate.run(world, THESIS, spy, (0, 0, 0), (9, 0), t_max=1.0, track_movers=True, laser=laser)
        for o in spy.seen:
            there = [[3, -2 + 0.4 * o.time, 0, 0.4, 0.3], [9, 0.5 * (1 + o.time), 0, 0.5, 0.4]]
            np.testing.assert_allclose(o.movers, there, atol=1e-12)
            assert not o.faults()
    alone, untold = Spy(), Spy()
    simulate.run(EMPTY, THESIS, alone, (0, 0, 0), (9, 0), t_max=0.3, track_movers=True)
    simulate.run(world, THESIS, untold, (0, 0, 0), (9, 0), t_max=0.3)
    assert alone.seen[0].movers.shape == (0, 5)
    assert untold.seen[0].movers is None


def test_drifting_odometry_believes_wrongly_and_noise_moves_the_points() -> None:
    spy = Spy()
    world = World(discs=[[6.0, 2.0, 0.5]])
    run = simulate.run(world, THESIS, spy, (0, 0, 0), (60, 0), t_max=9.0, odometry=Odometry(bias=(0.05, 0.0)))
    assert run.log["believed"][-1, 0] == pytest.approx(1.05 * run.poses[-1, 0])
    assert np.abs(world.clearance(spy.seen[-1].points)).max() > 0.2
    exact = simulate.run(world, THESIS, Spy(), (0, 0, 0), (60, 0), t_max=9.0)
    np.testing.assert_array_equal(exact.log["believed"], exact.poses)


def test_no_scanner_no_points() -> None:
    spy = Spy()
    simulate.run(rocks(1), THESIS, spy, (1, 1), (19, 19), t_max=0.5, laser=None)
    assert spy.seen[0].points.shape == (0, 2)


# --- the record -------------------------------------------------------------------------------------


def circle(n: int = 63, v: float = 0.5, omega: float = 0.25) -> Run:
    commands = np.tile([v, omega], (n, 1))
    poses = [np.zeros(3)]
    for c in commands:
        poses.append(move(poses[-1], c, 0.1))
    return Run(
        t=np.arange(n + 1) * 0.1,
        poses=np.array(poses),
        commands=commands,
        clearance=np.full(n, 1.5),
        log={},
        status="timeout",
    )


@pytest.mark.parametrize("dt", [0.1, 0.02])
def test_jerk_of_a_speed_that_rises_with_the_square_of_time(dt: float) -> None:
    """v = 0.3 t^2 has the jerk 0.6 m/s^3 throughout: over 2 s its square adds up to 0.72, at any step."""
    n = round(2.0 / dt) + 2
    run = replace(
        circle(n), t=np.arange(n + 1) * dt, commands=np.stack([0.3 * (np.arange(n) * dt) ** 2, np.zeros(n)], 1)
    )
    assert run.jerk == pytest.approx(0.72)


def test_metrics_of_a_circle_are_known() -> None:
    run = circle()
    assert run.length == pytest.approx(0.5 * 6.3)
    assert run.chord_length < run.length
    assert run.smoothness == pytest.approx(0.25 * run.length)  # curvature 1/2: squared 1/4
    assert run.jerk == 0.0
    assert run.turns == 1
    assert run.min_clearance == 1.5
    assert run.rms_error([[0, 0], [9, 0]]) > 0
    assert run.rms_error(run.poses) == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(ValueError, match="two points"):
        run.rms_error([[0, 0]])


def test_turns_ignores_wiggles() -> None:
    def with_headings(headings) -> Run:
        poses = np.column_stack([np.zeros((len(headings), 2)), headings])
        n = len(headings) - 1
        return Run(
            t=np.arange(n + 1) * 0.1,
            poses=poses,
            commands=np.zeros((n, 2)),
            clearance=np.ones(n),
            log={},
            status="timeout",
        )

    assert with_headings(np.linspace(0, 0.1, 20)).turns == 0
    assert with_headings(np.concatenate([np.linspace(0, 1, 20), np.linspace(1, 0, 20)])).turns == 2
    assert with_headings(np.linspace(0, 1, 20) + 0.05 * (-1) ** np.arange(20)).turns == 1
    assert with_headings(np.linspace(3.0, 3.5, 20) - 2 * np.pi * (np.linspace(3.0, 3.5, 20) > np.pi)).turns == 1


def test_a_run_survives_its_file(tmp_path) -> None:
    world = World(discs=rocks(2).discs, movers=(Mover.constant((9, 0), (0.0, 0.3), 0.3),))
    run = simulate.run(world, THESIS, dwa.Controller(THESIS), (1, 1), (19, 19), t_max=5.0)
    run.save(tmp_path / "run.npz")
    back = Run.load(tmp_path / "run.npz")
    assert same(run, back)
    assert back.metrics() == run.metrics()
    np.testing.assert_array_equal(back.goal, [19, 19])
    frames = list(back.frames(every=10))
    assert [k for k, _, _ in frames] == [0, 10, 20, 30, 40, 50]
    assert frames[-1][2].shape == (1, 2)
    with np.load(tmp_path / "run.npz", allow_pickle=False) as file:
        assert all(file[name].dtype != object for name in file.files)


def test_a_file_that_holds_no_run_is_refused(tmp_path) -> None:
    np.savez(tmp_path / "other.npz", t=np.zeros(3))
    with pytest.raises(ValueError, match="does not hold a run"):
        Run.load(tmp_path / "other.npz")
    with pytest.raises(FileNotFoundError):
        Run.load(tmp_path / "none.npz")


def test_damaged_files_of_runs_are_refused_in_a_sentence(tmp_path) -> None:
    circle().save(tmp_path / "run.npz")
    whole, rng, said = (tmp_path / "run.npz").read_bytes(), np.random.default_rng(0), []
    for _ in range(300):
        (tmp_path / "bad.npz").write_bytes(damages(whole, rng))
        try:
            Run.load(tmp_path / "bad.npz")
        except ValueError as error:
            said.append(str(error))
    assert len(said) > 200
    assert all(text.startswith("bad.npz does not hold a run: ") for text in said)


def test_a_run_that_could_not_be_read_again_is_not_made() -> None:
    good = circle()
    for name, wrong in (
        ("t", good.t[:-1]),
        ("poses", good.poses[:, :2]),
        ("clearance", good.clearance[:3]),
        ("goal", [1.0]),
    ):
        with pytest.raises(ValueError, match=f"{name} must be numbers of shape"):
            replace(good, **{name: wrong})
    with pytest.raises(ValueError, match="plain arrays; log_notes"):
        replace(good, log={"notes": np.array([object()])}).save("never.npz")


def test_a_run_without_steps_has_finite_metrics() -> None:
    run = simulate.run(EMPTY, THESIS, Steady(), (0, 0), (0.1, 0))
    assert run.iterations == 0
    assert run.length == run.duration == run.smoothness == run.jerk == 0.0
    assert run.metrics()["turns"] == 0


# --- bad input --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("change", "message"), [
    ({"start": (3.0, 0.0)}, "cannot start"), ({"goal": (3.0, 0.0)}, "inside an obstacle"),
    ({"goal": (99.0, 0.0)}, "outside the world"), ({"goal": (np.nan, 0.0)}, "finite"), ({"t_max": 0.0}, "t_max"),
    ({"dt": 0.0}, "dt"), ({"dt": -0.1}, "dt"), ({"start": (0.0,)}, "finite"), ({"start": (6.0, 0.0)}, "mover"),
])  # fmt: skip
def test_one_clear_error(change: dict, message: str) -> None:
    world = World(discs=[[3.0, 0.0, 0.5]], bounds=(-10, 10, -10, 10), movers=(Mover.constant((6, 0), (0, 0), 0.3),))
    given_ = {"start": (0.0, 0.0), "goal": (8.0, 3.0), **change}
    start, goal = given_.pop("start"), given_.pop("goal")
    with pytest.raises(ValueError, match=message):
        simulate.run(world, THESIS, Steady(), start, goal, **given_)


def test_a_controller_that_answers_nonsense_is_named() -> None:
    for wish in ((np.nan, 0.0), (1.0,), (np.inf, 0.0)):
        with pytest.raises(ValueError, match="controller returned"):
            simulate.run(EMPTY, THESIS, Steady(wish), (0, 0), (5, 0))


@pytest.mark.parametrize("wrong", [{"noise": (-0.1, 0.0)}, {"noise": (0.1,)}, {"bias": (np.nan, 0.0)}])
def test_bad_odometry_is_refused(wrong: dict) -> None:
    with pytest.raises(ValueError, match=f"Odometry.{next(iter(wrong))}"):
        Odometry(**wrong)


def test_what_is_no_controller_is_named() -> None:
    class Nameless:
        def __call__(self, observation):
            return 0.0, 0.0

    with pytest.raises(ValueError, match=r"reset.*status.*evidence"):
        simulate.run(EMPTY, THESIS, Nameless(), (0, 0), (5, 0))


def test_a_controller_cannot_change_the_truth() -> None:
    class Meddler(Steady):
        """Writes into everything it is told, and uses one array for all its commands."""

        def reset(self) -> None:
            self.wish_array = np.zeros(2)

        def __call__(self, observation):
            for array in (observation.velocity, observation.pose, observation.goal, observation.ranges):
                array[:] = 7.0
            self.wish_array += (0.1, 0.05)
            return self.wish_array

    run = simulate.run(EMPTY, THESIS, Meddler(), (0, 0, 0), (50, 0), t_max=2.0)
    assert respects_limits(np.vstack([[0.0, 0.0], run.commands]), 0.1, THESIS)
    np.testing.assert_allclose(run.log["wish"], np.arange(1, 21)[:, None] * [0.1, 0.05])
    np.testing.assert_array_equal(run.goal, [50, 0])


# --- disturbances -----------------------------------------------------------------------------------


@pytest.mark.parametrize("change", [
    {"slip": 0.3}, {"delay": 0.3}, {"right_radius": 0.05}, {"left_radius": -0.05}, {"motor_lag": 0.3},
])  # fmt: skip
def test_every_disturbance_of_the_plant_bends_the_way(change: dict) -> None:
    plain = simulate.run(EMPTY, THESIS, Steady(), (0, 0, 0), None, t_max=5.0, laser=None)
    bent = simulate.run(
        EMPTY, THESIS, Steady(), (0, 0, 0), None, t_max=5.0, laser=None, disturbance=Disturbance(**change)
    )
    np.testing.assert_array_equal(plain.commands, bent.commands)
    assert plain.driven is plain.commands
    assert np.abs(plain.poses[-1] - bent.poses[-1]).max() > 0.01
    np.testing.assert_allclose(bent.poses[1], move(bent.poses[0], bent.driven[0], 0.1), atol=1e-15)


def test_the_noise_of_the_measured_pose_stays_out_of_the_truth() -> None:
    spy, noise = Spy(), Disturbance(position_noise=0.1, heading_noise=0.2)
    run = simulate.run(EMPTY, THESIS, spy, (0, 0, 0), None, t_max=60.0, laser=None, disturbance=noise)
    np.testing.assert_array_equal(run.poses[:, 1:], 0.0)
    gaps = np.array([o.pose for o in spy.seen]) - run.poses[:-1]
    np.testing.assert_allclose(gaps.std(axis=0), [0.1, 0.1, 0.2], rtol=0.15)


def test_a_run_begins_with_the_speed_it_is_given() -> None:
    run = simulate.run(
        EMPTY, THESIS, Steady((0.5, 0.0)), (0, 0, 0), None, t_max=1.0, laser=None, loop=Loop(velocity=(0.5, 0.0))
    )
    assert run.length == pytest.approx(0.5)
    assert run.status == "timeout"


def test_a_late_command_acts_late_and_the_first_speed_holds_meanwhile() -> None:
    run = simulate.run(
        EMPTY, TURTLEBOT2, Steady((0.2, 0.0)), (0, 0, 0), None, t_max=1.0, laser=None,
        disturbance=Disturbance(delay=0.3), loop=Loop(velocity=(0.1, 0.0)),
    )  # fmt: skip
    np.testing.assert_allclose(run.driven[:4, 0], [0.1, 0.1, 0.1, 0.2])


@dataclass
class Rising(Steady):
    """A controller that wants ever more."""

    def __call__(self, observation):
        self.calls += 1
        return np.array([0.1 + 0.01 * self.calls, 0.0])


def test_what_acts_late_is_the_command_of_then() -> None:
    run = simulate.run(
        EMPTY, TURTLEBOT2, Rising(), (0, 0, 0), None, t_max=1.0, laser=None,
        disturbance=Disturbance(delay=0.3), loop=Loop(velocity=(0.1, 0.0)),
    )  # fmt: skip
    np.testing.assert_allclose(run.commands[:, 0], 0.11 + 0.01 * np.arange(10))
    np.testing.assert_allclose(run.driven[3:, 0], run.commands[:-3, 0])


def test_a_scanner_that_is_dead_sees_nothing_and_says_so() -> None:
    spy = Spy()
    simulate.run(rocks(1), THESIS, spy, (1, 1), (19, 19), t_max=0.5, laser=replace(IDEAL_LASER, beams=0))
    assert spy.seen[0].ranges.shape == (0,)
    assert spy.seen[0].points.shape == (0, 2)


# --- against a reference ----------------------------------------------------------------------------


def test_a_run_knows_its_errors_against_a_reference() -> None:
    run = circle()
    with pytest.raises(ValueError, match="followed no reference"):
        _ = run.errors
    shifted = run.poses + [0.3, -0.4, 2 * np.pi + 0.1]
    led = replace(run, log={"wanted": shifted})
    np.testing.assert_allclose(led.errors, np.tile([0.3, -0.4, 0.1], (64, 1)), atol=1e-9)
    assert led.rms_distance == pytest.approx(0.5)
    assert led.max_distance == pytest.approx(0.5)
    np.testing.assert_allclose(led.rms, [0.3, 0.4, 0.1])
    late = led.after(3.0)
    assert (len(late.t), len(late.commands), late.t[0]) == (34, 33, pytest.approx(3.0))
    assert len(late.wanted) == 34
    assert led.effort(TURTLEBOT2) == 0.0


def test_grid_world_ends_at_its_walls() -> None:
    world = World(grid=GridMap(np.zeros((10, 10), dtype=bool)))
    run = simulate.run(world, THESIS, Steady(), (1.5, 5, 0), (5, 9.4), t_max=30.0)
    assert run.status == "collided"
    assert run.poses[-1, 0] > 9.6
