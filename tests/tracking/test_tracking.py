"""Tracking laws: known answers, invariances, energies, limits, agreement between independent solutions, bad input."""

import time
from copy import deepcopy
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from fuzzynav import simulate, tracking
from fuzzynav.geometry import Array, compose, length, wrap
from fuzzynav.robot import PIONEER_3DX, THESIS, TURTLEBOT2, pose_rate, respects_limits
from fuzzynav.tracking import curves, kernels, reference
from fuzzynav.tracking.records import POSE, ROW, SPEEDS
from fuzzynav.world import World

EIGHT = reference.FigureEight()
SHORT = reference.FigureEight(duration=30.0)
ALL = (
    tracking.Dfl(),
    tracking.Flatness(),
    tracking.Kanayama(),
    tracking.Pid(),
    tracking.Lqr(),
    tracking.Sliding(),
    tracking.Mpc(),
)
COMPILED = ALL[:-1]
MOVING = [law for law in ALL if not isinstance(law, tracking.Lqr)]  # laws that stand a reference at rest
ROUGH = tracking.Disturbance(
    position_noise=0.01, heading_noise=0.02, slip=0.1, delay=0.2, right_radius=0.02, left_radius=-0.01, motor_lag=0.2
)
QUICK = replace(TURTLEBOT2, acc_lim_x=1e3, dec_lim_x=1e3, acc_lim_theta=1e3, max_vel_theta=1e2)  # no limit is met


def name_of(law: tracking.Law) -> str:
    return type(law).__name__


def columns(rows: Array, names: list[str]) -> Array:
    return np.stack([rows[name] for name in names], axis=-1)


unit = st.floats(-1, 1, allow_subnormal=False)
angle = st.floats(-3.1, 3.1, allow_subnormal=False)


# --- the theory of feedback linearization --------------------------------------------------------


def test_target_system_is_controllable_with_two_blocks() -> None:
    matrix = tracking.controllability()
    assert matrix.shape == (4, 4)
    assert np.linalg.matrix_rank(matrix) == 4
    assert np.all(np.linalg.matrix_power(tracking.CHAINS.a, 2) == 0)


@settings(max_examples=50, deadline=None)
@given(angle, st.floats(-2, 2).filter(lambda v: abs(v) > 1e-3), unit, unit)
def test_decoupling_matrix_and_its_inverse(theta: float, v: float, u1: float, u2: float) -> None:
    matrix = tracking.decoupling(theta, v)
    assert np.linalg.det(matrix) == pytest.approx(v)
    assert tracking.from_virtual([u1, u2], theta, v) == pytest.approx(np.linalg.solve(matrix, [u1, u2]), abs=1e-9)


def test_the_decoupling_matrix_is_the_derivative_of_the_velocity() -> None:
    theta, v, push, omega, h = 0.7, 0.3, 0.2, 0.5, 1e-6
    after = (v + h * push) * np.array([np.cos(theta + h * omega), np.sin(theta + h * omega)])
    before = (v - h * push) * np.array([np.cos(theta - h * omega), np.sin(theta - h * omega)])
    assert tracking.decoupling(theta, v) @ [push, omega] == pytest.approx((after - before) / (2 * h), abs=1e-8)


def test_rest_has_no_inverse() -> None:
    with pytest.raises(ValueError, match="v = 0"):
        tracking.from_virtual([0.0, 0.1], 0.0, 0.0)
    assert np.isinf(tracking.yaw_rate_unguarded([0.0, 0.1], 0.0, 0.0))


@settings(max_examples=40, deadline=None)
@given(st.floats(-4, -0.1), st.floats(-4, -0.1), st.floats(0.1, 4))
def test_gains_from_poles_give_these_poles(a: float, b: float, swing: float) -> None:
    for wanted in ([a, b], [a, a], [complex(a, swing), complex(a, -swing)]):
        gains = tracking.gains_from_poles(wanted)
        found = np.sort_complex(np.linalg.eigvals(tracking.closed_loop(gains)))
        assert found == pytest.approx(np.sort_complex(np.repeat(wanted, 2)), abs=2e-3)
        assert np.sort_complex(tracking.poles(gains)) == pytest.approx(found, abs=2e-3)


def test_printed_gains_have_the_poles_known_for_them() -> None:
    poles = tracking.poles(tracking.Dfl())
    assert abs(poles[0]) == pytest.approx(1.0)
    assert -poles[0].real / abs(poles[0]) == pytest.approx(0.35)


@pytest.mark.parametrize("kp_kd", [(1.0, 0.7), (4.0, 3.0), (0.5, 0.2), (0.3, 2.0)])
def test_largest_step_is_where_the_sampled_loop_loses_stability(kp_kd: tuple[float, float]) -> None:
    kp, kd = kp_kd
    edge = tracking.largest_step(tracking.Dfl(kp1=kp, kd1=kd, kp2=kp, kd2=kd))
    for factor, stable in ((0.99, True), (1.01, False)):
        radius = np.abs(np.linalg.eigvals(tracking.sampled_loop(kp, kd, factor * edge))).max()
        assert (radius < 1.0) == stable


def test_sampled_target_system_is_the_exact_one() -> None:
    system = tracking.CHAINS.discrete(0.3)
    x, u = np.array([1.0, -0.5, 2.0, 0.3]), np.array([0.4, -0.2])
    solved = solve_ivp(lambda _, z: tracking.CHAINS.rates(z, u), (0.0, 0.3), x, rtol=1e-10, atol=1e-12)
    assert system.a @ x + system.b @ u == pytest.approx(solved.y[:, -1], abs=1e-9)
    assert system.output(x, u) == pytest.approx([1.0, 2.0])


# --- the error dynamics, closed form against simulation ------------------------------------------


def test_on_a_straight_line_the_error_follows_the_sampled_closed_form_exactly() -> None:
    ref = reference.line((0.0, 0.0), 0.0, 0.3, 12.0)
    trace = tracking.follow(tracking.Tracker(ref, tracking.Dfl()), [-0.05, 0.0, 0.0])
    matrix = tracking.sampled_loop(1.0, 0.7, 0.1)
    state = np.array([-0.05, 0.0])
    for k in range(120):
        assert -trace.errors[k, 0] == pytest.approx(state[0], abs=1e-12)
        state = matrix @ state


@pytest.mark.parametrize("ref", [SHORT, reference.circle(1.0, 0.3, 30.0)], ids=["eight", "circle"])
def test_the_error_tends_to_the_closed_form_as_the_step_shrinks(ref: reference.Reference) -> None:
    gains, start = tracking.Dfl(), compose(ref.sample(0.0).pose, [0.02, -0.03, 0.05])
    gaps = []
    for dt in (0.02, 0.01, 0.005):
        tracker = tracking.Tracker(ref, gains, QUICK, dt)
        trace = tracking.follow(tracker, start, duration=15.0)
        z0 = tracking.flat_state(start, float(tracker.rows[0].v))
        wanted, _ = tracking.reference_state(ref.sample(0.0))
        exact = tracking.error_response(trace.t[::100], z0 - wanted, gains)
        gaps.append(np.abs(-trace.errors[::100, :2] - exact[:, [0, 2]]).max())
    assert gaps[-1] < 2e-4
    assert gaps[0] / gaps[1] == pytest.approx(2.0, rel=0.15)
    assert gaps[1] / gaps[2] == pytest.approx(2.0, rel=0.15)


def test_printed_gains_converge_from_everywhere_near_the_start() -> None:
    rng = np.random.default_rng(3)
    tracker = tracking.Tracker(EIGHT, tracking.Dfl())
    for _ in range(200):
        start = columns(tracker.rows, POSE)[0] + rng.uniform(-1, 1, 3) * [0.3, 0.3, np.pi]
        trace = tracking.follow(tracker, start)
        assert trace.after(40.0).max_distance < 0.005
        assert np.abs(trace.commands[:, 1]).max() <= TURTLEBOT2.max_vel_theta
        assert trace.commands[:, 0].min() >= 0.0


# --- invariances ---------------------------------------------------------------------------------


@pytest.mark.parametrize("law", ALL, ids=name_of)
def test_a_moved_scene_gives_the_same_commands(law: tracking.Law) -> None:
    motion = np.array([2.0, -1.0, 2.2])
    start = np.array([-0.1, 0.1, 0.3])
    still = tracking.follow(tracking.Tracker(SHORT, law), start, duration=20.0)
    moved = tracking.follow(tracking.Tracker(SHORT.moved(motion), law), compose(motion, start), duration=20.0)
    tolerance = 1e-3 if isinstance(law, tracking.Mpc) else 1e-7
    assert moved.commands == pytest.approx(still.commands, abs=tolerance)
    assert np.abs(wrap(moved.poses - compose(motion, still.poses))).max() < tolerance


@pytest.mark.parametrize("law", ALL, ids=name_of)
def test_a_full_turn_more_changes_nothing(law: tracking.Law) -> None:
    tracker = tracking.Tracker(SHORT, law)
    for pose in ([0.1, -0.1, 3.0], [0.1, -0.1, -3.1], [0.2, 0.0, 0.4]):
        plain, _ = tracker.step(tracker.start(), pose, tracker.row(1.0))
        turned, _ = tracker.step(tracker.start(), np.array(pose) + [0.0, 0.0, 2.0 * np.pi], tracker.row(1.0))
        assert turned == pytest.approx(plain, abs=1e-6)


@pytest.mark.parametrize("law", COMPILED, ids=name_of)
def test_a_mirrored_scene_gives_mirrored_commands(law: tracking.Law) -> None:
    left = tracking.Tracker(reference.circle(1.0, 0.3, 20.0), law)
    right = tracking.Tracker(
        reference.Along(curves.CircleCurve((0.0, 0.0), -1.0), curves.SpeedProfile([0, 20], [0.3, 0.3])), law
    )
    a = tracking.follow(left, compose(columns(left.rows, POSE)[0], [0.05, 0.1, 0.2]))
    b = tracking.follow(right, compose(columns(right.rows, POSE)[0], [0.05, -0.1, -0.2]))
    assert b.commands * [1.0, -1.0] == pytest.approx(a.commands, abs=1e-9)


# --- all laws ------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", ALL, ids=name_of)
def test_every_law_stays_on_an_exact_start_and_recovers_from_a_wrong_one(law: tracking.Law) -> None:
    tracker = tracking.Tracker(SHORT, law)
    bound = 0.15 if isinstance(law, tracking.Pid) else 0.01  # PID alone has no feed-forward and starts from nothing
    assert tracking.follow(tracker).max_distance < bound
    wrong = tracking.follow(tracker, [-0.15, 0.15, 0.9])
    assert wrong.distance[-1] < 0.05
    assert wrong.status == "done"


@pytest.mark.parametrize("robot", [TURTLEBOT2, PIONEER_3DX, THESIS], ids=lambda r: r.name)
@pytest.mark.parametrize("law", ALL, ids=name_of)
def test_limits_are_never_exceeded(law: tracking.Law, robot: object) -> None:
    tracker = tracking.Tracker(SHORT, law, robot=robot)
    trace = tracking.follow(tracker, [-0.4, 0.4, 2.5], disturbance=ROUGH, rng=5, duration=10.0)
    assert respects_limits(np.concatenate([columns(tracker.rows, SPEEDS)[:1], trace.commands]), tracker.dt, robot)


@pytest.mark.parametrize("law", ALL, ids=name_of)
def test_python_and_compiled_loop_are_the_same_run(law: tracking.Law) -> None:
    tracker = tracking.Tracker(SHORT, law)
    first = tracking.follow(tracker, [-0.1, 0.1, 0.3], disturbance=ROUGH, rng=7, duration=10.0)
    second = tracking.follow(tracker, [-0.1, 0.1, 0.3], disturbance=ROUGH, rng=7, duration=10.0, compiled=False)
    third = tracking.follow(tracker, [-0.1, 0.1, 0.3], disturbance=ROUGH, rng=8, duration=10.0)
    assert np.array_equal(first.poses, second.poses)
    assert np.array_equal(first.commands, second.commands)
    assert not np.array_equal(first.poses, third.poses)


@pytest.mark.parametrize("law", ALL, ids=name_of)
def test_a_step_changes_nothing_it_was_given(law: tracking.Law) -> None:
    tracker = tracking.Tracker(SHORT, law)
    state, pose, row = tracker.start(), np.array([0.1, 0.0, 0.3]), tracker.row(2.0)
    held = ("x", "y", "last", "outcome") if isinstance(law, tracking.Mpc) else ("gains", "memory")
    given = [getattr(state, name) for name in held] + [pose, row]
    before = deepcopy(given)
    first, second = tracker.step(state, pose, row), tracker.step(state, pose, row)
    for a, b in zip(before, [getattr(state, name) for name in held] + [pose, row], strict=True):
        assert repr(a) == repr(b)
    assert np.array_equal(first[0], second[0])
    assert all(repr(getattr(first[1], name)) == repr(getattr(second[1], name)) for name in held)


@pytest.mark.parametrize("law", MOVING, ids=name_of)
def test_a_reference_that_stops_and_reverses(law: tracking.Law) -> None:
    profile = curves.SpeedProfile([0, 2, 6, 8, 11, 13, 17, 19], [0, 0.3, 0.3, 0, 0, -0.3, -0.3, 0])
    ref = reference.Along(curves.CircleCurve((0.0, 0.0), 1.0), profile)
    tracker = tracking.Tracker(ref, law)
    trace = tracking.follow(tracker, compose(columns(tracker.rows, POSE)[0], [0.05, -0.05, 0.2]))
    assert trace.distance[-1] < (0.2 if isinstance(law, tracking.Pid) else 0.01)
    assert np.abs(trace.commands[:, 1]).max() < 2.0
    assert trace.commands[:, 0].min() < -0.25
    if isinstance(law, tracking.FlatGains):
        assert (trace.commands[:, 0] * tracker.rows["v"][1:] >= -1e-12).all()  # never against the reference
        standing = (trace.t[:-1] > 9.0) & (trace.t[:-1] < 10.9)
        assert np.abs(trace.commands[standing]).max() < 1e-9


@pytest.mark.parametrize("law", ALL, ids=name_of)
def test_a_line_driven_backwards_is_found_again_from_both_sides(law: tracking.Law) -> None:
    tracker = tracking.Tracker(reference.line((0.0, 0.0), 0.0, -0.3, 30.0), law)
    for side in (0.1, -0.1):
        trace = tracking.follow(tracker, [0.0, side, 0.1])
        assert trace.poses[-1] == pytest.approx([-9.0, 0.0, 0.0], abs=1e-3)
        assert trace.commands[-1] == pytest.approx([-0.3, 0.0], abs=1e-3)


def test_a_start_facing_backwards_turns_instead_of_driving_the_curve_backwards() -> None:
    trace = tracking.follow(tracking.Tracker(EIGHT, tracking.Dfl()), [0.0, 0.0, np.arctan2(0.5, 1.0) + np.pi])
    assert trace.commands[:, 0].min() >= 0.0
    assert trace.after(30.0).max_distance < 0.01


@pytest.mark.parametrize(
    ("disturbance", "bound"),
    [
        (tracking.Disturbance(delay=0.2), 0.06),
        (tracking.Disturbance(motor_lag=0.2), 0.03),
        (tracking.Disturbance(slip=0.1), 0.05),
        (tracking.Disturbance(right_radius=0.02, left_radius=-0.02), 0.05),
        (tracking.Disturbance(position_noise=0.005, heading_noise=0.01), 0.05),
    ],
)
def test_each_disturbance_acts_and_stays_bounded(disturbance: tracking.Disturbance, bound: float) -> None:
    for law in (tracking.Dfl(), tracking.Kanayama(), tracking.Sliding()):
        clean = tracking.follow(tracking.Tracker(EIGHT, law))
        hit = tracking.follow(tracking.Tracker(EIGHT, law), disturbance=disturbance, rng=1)
        assert clean.max_distance < hit.max_distance < bound


def test_the_plant_is_the_exact_arc() -> None:
    ref = reference.circle(1.0, 0.3, 2.0 * np.pi / 0.3, center=(0.0, 1.0))
    tracker = tracking.Tracker(ref, tracking.Kanayama(), dt=2.0 * np.pi / 0.3 / 100)
    trace = tracking.follow(tracker)
    assert trace.poses[-1, :2] == pytest.approx(trace.poses[0, :2], abs=1e-9)
    assert trace.length == pytest.approx(2.0 * np.pi, abs=1e-9)
    assert length(trace.poses) < trace.length


@pytest.mark.parametrize("law", MOVING, ids=name_of)
def test_the_course_loop_gives_the_same_run(law: tracking.Law) -> None:
    ref = reference.spline([[0, 0], [1, 0], [2, 1], [3, 1]], 0.3)  # from rest, as the course's loop starts
    start = np.array([0.05, -0.05, 0.2])
    whole = simulate.run(World(), TURTLEBOT2, tracking.Tracker(ref, law), start, [9.0, 9.0], dt=0.1, t_max=ref.duration)
    ours = tracking.follow(tracking.Tracker(ref, law), start)
    assert whole.status == "done"
    assert whole.poses == pytest.approx(ours.poses, abs=1e-9)
    assert whole.commands == pytest.approx(ours.commands, abs=1e-9)


def test_a_lap_takes_well_under_fifty_milliseconds() -> None:
    tracker = tracking.Tracker(EIGHT, tracking.Dfl())
    tracking.follow(tracker)
    times = []
    for _ in range(5):
        begin = time.perf_counter()
        tracking.follow(tracker)
        times.append(time.perf_counter() - begin)
    assert min(times) < 0.025


HALT = curves.SpeedProfile([0, 2, 5, 7, 10], [0, 0.3, 0.3, 0, 0])
STOPPING = reference.Along(curves.CircleCurve((0.0, 0.0), 1.0), HALT)
GAINS = [tracking.Dfl(v0=0.1), tracking.Kanayama(), tracking.Pid(), tracking.Sliding()]


@pytest.mark.parametrize(("law", "name"), [(g, f.name) for g in GAINS for f in fields(g) if f.name != "feed_forward"])
def test_no_gain_is_without_effect(law: tracking.Law, name: str) -> None:
    other = replace(law, **{name: 1.5 * getattr(law, name)})
    offset = compose(STOPPING.sample(0.0).pose, [-0.4, -0.3, 0.4])
    trackers = [tracking.Tracker(STOPPING, each) for each in (law, other)]
    runs = [tracking.follow(tracker, offset).commands for tracker in trackers]
    runs += [tracking.follow(tracker, disturbance=ROUGH, rng=1).commands for tracker in trackers]
    assert np.abs(runs[0] - runs[1]).max() > 1e-6 or np.abs(runs[2] - runs[3]).max() > 1e-6


@pytest.mark.parametrize("name", [f.name for f in fields(tracking.Weights)])
def test_no_weight_is_without_effect(name: str) -> None:
    other = replace(tracking.Weights(), **{name: 1.5 * getattr(tracking.Weights(), name)})
    start = [-0.1, 0.1, 0.2]
    for law in (tracking.Lqr, tracking.Mpc):
        trackers = [tracking.Tracker(SHORT, law(weights=w)) for w in (tracking.Weights(), other)]
        runs = [tracking.follow(tracker, start, duration=5.0).poses for tracker in trackers]
        assert np.abs(runs[0] - runs[1]).max() > 1e-5


@pytest.mark.parametrize("name", [f.name for f in fields(tracking.Disturbance)])
def test_no_disturbance_is_without_effect(name: str) -> None:
    hit = tracking.follow(
        tracking.Tracker(SHORT, tracking.Dfl()), disturbance=tracking.Disturbance(**{name: getattr(ROUGH, name)})
    )
    assert np.abs(hit.poses - tracking.follow(tracking.Tracker(SHORT, tracking.Dfl())).poses).max() > 1e-4


# --- a law of one's own --------------------------------------------------------------------------


class Chase:
    """Turn towards the reference and drive at its speed: all that a law needs."""

    def command(self, state: object, pose: Array, row: object) -> tuple[list[float], object]:
        ahead, left, turn = tracking.tracking_error(pose, [row.x, row.y, row.theta])
        return [row.v * np.cos(turn) + ahead, row.omega + 10.0 * row.v * left + 1.5 * np.sin(turn)], state


class Counting(Chase):
    """The same with a memory and a horizon."""

    horizon = 3

    def start(self, setting: tracking.Setting) -> int:
        return len(setting.rows)

    def command(self, state: int, pose: Array, row: Array) -> tuple[list[float], int]:
        assert row.shape == (3,)
        return super().command(state, pose, row[0])[0], state + 1


def test_a_law_of_ones_own_runs_wherever_the_courses_laws_do() -> None:
    start = [-0.1, 0.1, 0.3]
    built_in = tracking.follow(tracking.Tracker(SHORT, tracking.Kanayama()), start, disturbance=ROUGH, rng=3)
    own = tracking.follow(tracking.Tracker(SHORT, Chase()), start, disturbance=ROUGH, rng=3)
    assert own.poses == pytest.approx(built_in.poses, abs=1e-9)
    assert own.status == "done"
    tracker = tracking.Tracker(SHORT, Counting())
    again = tracking.follow(tracker, start, disturbance=ROUGH, rng=3)
    assert again.poses == pytest.approx(own.poses, abs=1e-12)
    assert tracker.state == len(tracker.rows) + tracker.steps
    loop = simulate.Loop(velocity=(SHORT.sample(0.0).v, SHORT.sample(0.0).omega))
    driven = simulate.run(World(), TURTLEBOT2, tracker, start, t_max=30.0, disturbance=ROUGH, rng=3, loop=loop)
    assert driven.status == "done"
    assert driven.poses == pytest.approx(own.poses, abs=1e-12)


def test_a_law_that_inherits_and_overrides_is_not_run_compiled() -> None:
    class Lazy(tracking.Kanayama):
        def command(self, state: object, pose: Array, row: object) -> tuple[Array, object]:
            command, after = super().command(state, pose, row)
            return 0.5 * command, after

    lazy, eager = (tracking.follow(tracking.Tracker(SHORT, law)) for law in (Lazy(), tracking.Kanayama()))
    assert lazy.commands[0, 0] == pytest.approx(0.5 * eager.commands[0, 0])


def test_a_command_that_is_not_finite_is_named() -> None:
    class Broken(Chase):
        def command(self, state: object, pose: Array, row: object) -> tuple[list[float], object]:
            return [np.nan, 0.0], state

    with pytest.raises(ValueError, match=r"returned \[nan, 0.0\] at 0.0 s"):
        tracking.follow(tracking.Tracker(SHORT, Broken()))


# --- the guards of the flat law ------------------------------------------------------------------


def test_the_compensator_speeds_up_and_brakes_as_the_robot_can() -> None:
    robot = replace(TURTLEBOT2, acc_lim_x=0.1, dec_lim_x=0.4)
    tracker = tracking.Tracker(reference.line((0.0, 0.0), 0.0, 0.3, 10.0), tracking.Dfl(kp1=9.0, kd1=6.0), robot)
    for offset, change in ((-1.0, 0.01), (1.0, -0.04)):  # behind the reference: speed up; ahead of it: brake
        command, _ = tracker.step(tracker.start(), [offset, 0.0, 0.0], tracker.row(0.0))
        assert command[0] - 0.3 == pytest.approx(change, abs=1e-12)


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("law", [tracking.Dfl(v0=0.05), tracking.Flatness(v0=0.05)], ids=name_of)
def test_the_turn_fades_without_a_jump_where_the_divisor_is_held(law: tracking.FlatGains, sense: float) -> None:
    commands = []
    for v in (0.05 * (1.0 + 1e-9), 0.05 * (1.0 - 1e-9)):
        state = tracking.Tracker(SHORT, law).start()
        state.memory["started"], state.memory["speed"] = True, sense * v
        row = np.array([(0.0, 0.05, sense * v, 0.0, 0.0, 0.0, 0.0, sense * v, 0.0)], dtype=ROW)[0]
        commands.append(law.command(state, [0.0, 0.0, 0.0], row)[0])
    assert commands[0] == pytest.approx(commands[1], abs=1e-6)
    assert commands[0][1] * sense > 0.5, "towards a reference on the left, driving backwards: turn right"


def test_the_largest_step_is_that_of_the_quicker_axis() -> None:
    slow, quick = (1.0, 0.7), (9.0, 5.0)
    for one, other in ((slow, quick), (quick, slow)):
        edge = tracking.largest_step(tracking.Dfl(kp1=one[0], kd1=one[1], kp2=other[0], kd2=other[1]))
        assert edge == tracking.largest_step(tracking.Dfl(kp1=9.0, kd1=5.0, kp2=9.0, kd2=5.0))
        radii = [np.abs(np.linalg.eigvals(tracking.sampled_loop(*pair, 0.999 * edge))).max() for pair in (one, other)]
        assert max(radii) < 1.0


# --- Kanayama, PID, sliding mode -----------------------------------------------------------------


@given(unit, unit, angle, st.floats(-1, 1), unit)
def test_tracking_error_turns_as_its_rate_says(x: float, y: float, theta: float, v_r: float, omega_r: float) -> None:
    pose, wanted, u, h = np.array([x, y, theta]), np.array([0.2, -0.1, 0.4]), np.array([0.3, -0.2]), 1e-6
    ahead = [p + h * pose_rate(p, c) for p, c in ((pose, u), (wanted, [v_r, omega_r]))]
    behind = [p - h * pose_rate(p, c) for p, c in ((pose, u), (wanted, [v_r, omega_r]))]
    slope = wrap(tracking.tracking_error(*ahead) - tracking.tracking_error(*behind)) / (2 * h)
    error = tracking.tracking_error(pose, wanted)
    assert slope == pytest.approx(tracking.error_rate(error, u, [v_r, omega_r]), abs=1e-5)


@given(unit, unit, angle, st.floats(-1, 1), unit, st.floats(0.1, 3), st.floats(0.1, 20), st.floats(0.1, 3))
def test_energy_of_the_law_of_eq_5_10_falls_as_its_formula_says(
    x: float, y: float, theta: float, v_r: float, omega_r: float, k1: float, k2: float, k3: float
) -> None:
    gains, error, h = tracking.Kanayama(k1=k1, k2=k2, k3=k3), np.array([x, y, theta]), 1e-6
    command = tracking.kanayama(error, [v_r, omega_r], gains)
    rate = tracking.error_rate(error, command, [v_r, omega_r])
    change = tracking.kanayama_energy(error + h * rate, gains) - tracking.kanayama_energy(error - h * rate, gains)
    expected = tracking.kanayama_energy_rate(error, gains)
    assert change / (2 * h) == pytest.approx(float(expected), abs=1e-4 * (1 + k1 + k2 + k3 / k2) ** 2)
    assert expected <= 0.0


def test_energy_never_grows_in_a_run() -> None:
    tracker = tracking.Tracker(EIGHT, tracking.Kanayama(), robot=QUICK, dt=0.01)
    trace = tracking.follow(tracker, [-0.2, 0.3, 1.5])
    energy = tracking.kanayama_energy(tracking.tracking_error(trace.poses, trace.wanted), tracker.law)
    assert np.diff(energy[energy > 1e-5]).max() < 1e-7
    assert energy[-1] < 1e-4 * energy[0]


def test_the_law_of_eq_5_10_does_not_stabilise_a_pose() -> None:
    assert np.array_equal(tracking.kanayama([0.0, 1.0, 0.0], [0.0, 0.0], tracking.Kanayama()), [0.0, 0.0])


@given(unit, unit, st.floats(-1.2, 1.2), st.floats(0.05, 0.6), st.floats(-0.5, 0.5), st.sampled_from([-1.0, 1.0]))
def test_sliding_law_reaches_its_surfaces_at_the_stated_rate(
    x: float, y: float, theta: float, v: float, omega: float, sense: float
) -> None:
    gains, error, wanted, h = tracking.Sliding(), np.array([x, y, theta]), np.array([sense * v, omega]), 1e-7
    slope = sense * gains.c / (1.0 + (gains.c * y) ** 2)
    if 1.0 + slope * x < 0.25:
        return  # the divisor is held there
    rate = tracking.error_rate(error, tracking.sliding(error, wanted, gains), wanted)
    ahead, behind = (tracking.sliding_surfaces(error + k * rate, wanted[0], gains) for k in (h, -h))
    s = tracking.sliding_surfaces(error, wanted[0], gains)
    reach = [gains.k1 * np.clip(s[0] / gains.phi1, -1, 1), gains.k2 * np.clip(s[1] / gains.phi2, -1, 1)]
    assert (ahead - behind) / (2 * h) == pytest.approx(-np.array(reach), abs=1e-4)


def test_sliding_surfaces_fall_and_then_the_error_does() -> None:
    tracker = tracking.Tracker(EIGHT, tracking.Sliding(), dt=0.01)
    trace = tracking.follow(tracker, [-0.3, 0.3, 1.0], duration=60.0)
    error = tracking.tracking_error(trace.poses, trace.wanted)
    energy = tracking.sliding_energy(tracking.sliding_surfaces(error, EIGHT.sample(trace.t).v, tracker.law))
    assert energy[400] < 1e-4 * energy[0]
    assert trace.distance[-1] < 1e-3


def test_printed_sliding_surfaces_hold_the_inputs_they_should_give() -> None:
    error, wanted = np.array([0.1, 0.2, 0.3]), np.array([0.3, 0.0])
    rates = [tracking.error_rate(error, u, wanted) for u in ([0.0, 0.0], [1.0, 0.0], [0.0, 1.0])]
    s = [tracking.sliding_surfaces_as_printed(error, rate, [1.0, 1.0, 1.0]) for rate in rates]
    assert s[1] - s[0] == pytest.approx([-1.0, 0.0, 0.0])
    assert s[2] - s[0] == pytest.approx([0.2, -0.1, -1.0])  # ds2/domega = -e1: nothing on the path


@settings(max_examples=40, deadline=None)
@given(unit, unit, angle, st.floats(0.0, 0.6), st.floats(-1, 1))
def test_kernels_give_what_the_plain_formulas_give(x: float, y: float, theta: float, v: float, omega: float) -> None:
    row = np.array([(0.0, 0.0, v, 0.0, 0.0, 0.0, 0.0, v, omega)], dtype=ROW)[0]
    error = tracking.tracking_error([x, y, theta], [0.0, 0.0, 0.0])
    wide = replace(TURTLEBOT2, max_vel_x=1e3, min_vel_x=-1e3, max_vel_theta=1e4)
    line = reference.line((0.0, 0.0), 0.0, 0.3, 1.0)
    for law, plain in ((tracking.Kanayama(), tracking.kanayama), (tracking.Sliding(), tracking.sliding)):
        tracker = tracking.Tracker(line, law, robot=wide)
        command, _ = tracker.step(tracker.start(), [x, y, theta], row)
        assert command == pytest.approx(plain(error, [v, omega], law), abs=1e-9)


def test_pid_kernel_gives_what_the_plain_formula_gives() -> None:
    gains = tracking.Pid(kp_v=1.0, ki_v=0.4, kd_v=0.1, kp_omega=2.0, ki_omega=0.3, kd_omega=0.2, k_y=1.5)
    tracker = tracking.Tracker(SHORT, gains)
    state, sums, last = tracker.start(), np.zeros(2), None
    for k in range(20):
        pose, row = np.array([0.02 * k - 0.1, 0.01 * k, 0.4]), tracker.rows[k]
        command, state = tracker.step(state, pose, row)
        e = tracking.tracking_error(pose, [row.x, row.y, row.theta])
        now = np.array([e[0], e[2] + 1.5 * e[1]])
        sums += 0.1 * now
        before = now if last is None else last
        expected = [
            tracking.pid(now[0], sums[0], before[0], (1.0, 0.4, 0.1), 0.1),
            tracking.pid(now[1], sums[1], before[1], (2.0, 0.3, 0.2), 0.1),
        ]
        assert command == pytest.approx(expected)
        last = now


def test_a_pid_integral_stops_at_the_limit() -> None:
    tracker = tracking.Tracker(SHORT, tracking.Pid())
    state = tracker.start()
    for _ in range(300):
        command, state = tracker.step(state, [-5.0, 0.0, 0.46], tracker.rows[0])
    assert command[0] == TURTLEBOT2.max_vel_x
    assert abs(state.memory["sum_v"][0]) < 1.0


def test_a_pid_integral_shrinks_also_where_the_output_is_at_its_limit() -> None:
    tracker = tracking.Tracker(SHORT, tracking.Pid(kp_v=0.1, ki_v=1.0, kd_v=0.0, feed_forward=True))
    state, row = tracker.start(), tracker.rows[0].copy()
    row.x, row.y, row.theta, row.v, row.omega = 0.0, 0.0, 0.0, 0.0, 0.0
    for _ in range(4):
        _, state = tracker.step(state, [-1.0, 0.0, 0.0], row)  # 1 m behind: the integral grows
    full = state.memory["sum_v"][0]
    row.v = TURTLEBOT2.max_vel_x
    command, state = tracker.step(state, [0.1, 0.0, 0.0], row)
    assert command[0] == TURTLEBOT2.max_vel_x
    assert state.memory["sum_v"][0] == pytest.approx(full - 0.1 * 0.1)


def test_feed_forward_removes_what_pid_alone_cannot() -> None:
    plain = tracking.follow(tracking.Tracker(EIGHT, tracking.Pid()))
    fed = tracking.follow(tracking.Tracker(EIGHT, tracking.Pid(feed_forward=True)))
    assert fed.rms_distance < 0.2 * plain.rms_distance


# --- LQR and MPC ---------------------------------------------------------------------------------


def test_lqr_gain_solves_riccati_and_stabilises() -> None:
    weights = tracking.Weights()
    a, b = tracking.error_model(0.2, 0.3)
    p, gain = tracking.riccati(a, b, weights), tracking.lqr_gain(0.2, 0.3, weights)
    rest = a.T @ p + p @ a - p @ b @ np.linalg.inv(weights.r) @ b.T @ p + weights.q
    assert np.abs(rest).max() < 1e-9
    assert np.linalg.eigvals(a - b @ gain).real.max() < 0.0


@settings(max_examples=25, deadline=None)
@given(unit, unit, unit, unit, unit)
def test_bellman_residual_is_zero_at_the_optimum_and_nowhere_below(
    x: float, y: float, theta: float, dv: float, dw: float
) -> None:
    weights, state = tracking.Weights(), np.array([x, y, theta])
    best = -tracking.lqr_gain(0.2, 0.1, weights) @ state
    assert tracking.bellman_residual(state, best, 0.2, 0.1, weights) == pytest.approx(0.0, abs=1e-8)
    assert tracking.bellman_residual(state, best + [dv, dw], 0.2, 0.1, weights) >= -1e-8


def test_lqr_cost_of_the_optimal_run_is_the_cost_to_go() -> None:
    weights, x, dt = tracking.Weights(), np.array([0.1, 0.2, -0.1]), 0.001
    a, b = tracking.error_model(0.2, 0.0)
    gain = tracking.lqr_gain(0.2, 0.0, weights)
    step = expm((a - b @ gain) * dt)
    states = [x]
    for _ in range(40000):
        states.append(step @ states[-1])
    errors = np.array(states)
    cost = tracking.lqr_cost(errors, -errors @ gain.T, weights, dt)
    assert cost == pytest.approx(x @ tracking.riccati(a, b, weights) @ x, rel=2e-3)


def test_the_robot_at_rest_is_not_controllable() -> None:
    with pytest.raises(ValueError, match="rank 2 of 3"):
        tracking.lqr_gain(0.0, 0.0, tracking.Weights())
    stops = reference.spline([[0, 0], [1, 0], [2, 1]], 0.3)
    with pytest.raises(ValueError, match=r"keeps moving.*not controllable"):
        tracking.Tracker(stops, tracking.Lqr())


@settings(max_examples=30, deadline=None)
@given(st.floats(-0.6, 0.6), st.floats(-1, 1))
def test_sampled_model_is_the_matrix_exponential(v: float, omega: float) -> None:
    a, b = tracking.error_model(v, omega)
    block = np.zeros((5, 5))
    block[:3, :3], block[:3, 3:] = a, b
    power = expm(block * 0.1)
    sampled = tracking.sampled_model(v, omega, 0.1)
    assert sampled[0] == pytest.approx(power[:3, :3], abs=1e-8)
    assert sampled[1] == pytest.approx(power[:3, 3:], abs=1e-8)


def test_lqr_and_mpc_agree_where_no_limit_is_active() -> None:
    ref = reference.line((0.0, 0.0), 0.4, 0.25, 20.0)
    mpc = tracking.Tracker(ref, tracking.Mpc(tolerance=1e-8, iterations=20000))
    gain = tracking.lqr_gain(0.25, 0.0, tracking.Weights(), dt=0.1)
    for offset in ([0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.005, -0.01, 0.02]):
        pose = compose(columns(mpc.rows, POSE)[10], offset)
        command, _ = mpc.step(mpc.start(), pose, mpc.row(1.0))
        assert command == pytest.approx([0.25, 0.0] - gain @ offset, abs=1e-5)

    fine = tracking.Tracker(ref, tracking.Mpc(tolerance=1e-8, iterations=20000), dt=0.01)
    lqr = tracking.Tracker(ref, tracking.Lqr(), dt=0.01)
    pose = compose(columns(lqr.rows, POSE)[100], [0.005, -0.01, 0.02])
    predicted, continuous = (law.step(law.start(), pose, law.row(1.0))[0] for law in (fine, lqr))
    assert continuous - [0.25, 0.0] == pytest.approx(predicted - [0.25, 0.0], rel=0.03)


def test_mpc_answer_is_the_best_of_its_own_cost() -> None:
    ref, weights = reference.circle(1.0, 0.3, 20.0), tracking.Weights()
    mpc = tracking.Tracker(ref, tracking.Mpc(tolerance=1e-8, iterations=20000, horizon=6))
    pose = compose(columns(mpc.rows, POSE)[0], [0.02, -0.02, 0.05])
    _, state = mpc.step(mpc.start(), pose, mpc.row(0.0))
    changes = state.x[18:30].reshape(6, 2)
    a, b = tracking.sampled_model(0.3, 0.3, 0.1)
    end = mpc.start().problem.terminal - weights.q

    def cost(du: Array) -> float:
        errors, e = [], np.array([0.02, -0.02, 0.05])
        for u in du:
            e = a @ e + b @ u
            errors.append(e)
        return tracking.mpc_cost(errors, du, weights) + float(e @ end @ e)

    best, rng = cost(changes), np.random.default_rng(0)
    assert all(cost(changes + 1e-3 * rng.standard_normal((6, 2))) > best for _ in range(100))


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32))
def test_bounds_of_the_predictive_program_are_those_of_the_command_itself(seed: int) -> None:
    """Its unknowns are distances from the wanted commands; speeds and their changes are bounded as they are driven."""
    rng = np.random.default_rng(seed)
    n, last, wanted, commands = 4, rng.uniform(-1, 1, 2), rng.uniform(-1, 1, (4, 2)), rng.uniform(-1, 1, (4, 2))
    bounds, low, high = np.array([[-0.8, -0.9], [0.7, 0.9], [0.5, 1.1]]), np.empty(7 * n), np.empty(7 * n)
    kernels.horizon(np.zeros(3), last, wanted, 0.1, bounds, np.empty(15 * n), low, high)
    moved = (commands - wanted).ravel()
    steps = moved - np.concatenate([np.zeros(2), moved[:-2]])
    driven = np.abs(np.diff(np.vstack([last, commands]), axis=0)).ravel()
    inside = (low[3 * n : 5 * n] <= moved) & (moved <= high[3 * n : 5 * n])
    assert inside.tolist() == ((bounds[0] <= commands) & (commands <= bounds[1])).ravel().tolist()
    inside = (low[5 * n :] <= steps) & (steps <= high[5 * n :])
    assert inside.tolist() == (driven <= np.tile(bounds[2], n)).tolist()


def test_mpc_keeps_limits_that_the_wish_would_break_and_names_what_cannot_be() -> None:
    slow = replace(TURTLEBOT2, max_vel_x=0.15, acc_lim_x=0.1, dec_lim_x=0.1)
    tracker = tracking.Tracker(reference.circle(2.0, 0.2, 20.0), tracking.Mpc(), robot=slow)
    trace = tracking.follow(tracker, duration=5.0)  # the reference is faster than the robot may be
    assert trace.commands[10:, 0].max() <= 0.15 + 1e-6
    # far above its limit: it cannot be inside after one step
    state = replace(tracker.start(), last=np.array([0.6, 0.0]))
    command, after = tracker.step(state, [0.0, 0.0, 0.0], tracker.row(0.0))
    assert after.outcome == "infeasible"
    assert after.evidence == {"mpc_solved": 0.0}
    assert command == pytest.approx([0.59, 0.0])
    assert tracker.start().outcome == "solved"


@pytest.mark.parametrize("pose", [[101.0, 0.0, 0.0], [1e30, 0.0, 0.0], [-1e300, 1e300, 1e300]])
def test_mpc_brakes_where_the_reference_is_out_of_reach_and_prints_nothing(pose: list[float], capfd: object) -> None:
    tracker = tracking.Tracker(SHORT, tracking.Mpc())
    command, after = tracker.step(tracker.start(), pose, tracker.row(0.0))
    assert after.outcome == "out of reach"
    assert np.array_equal(command, [0.0, 0.0])
    near, after = tracker.step(tracker.start(), [2.0, 0.0, 0.0], tracker.row(0.0))
    assert after.outcome == "solved"
    assert abs(near[0]) < TURTLEBOT2.max_vel_x + 0.02
    assert capfd.readouterr() == ("", "")


def test_mpc_warm_start_saves_iterations_and_reset_forgets_it() -> None:
    tracker = tracking.Tracker(SHORT, tracking.Mpc())
    first = tracking.follow(tracker, [-0.1, 0.1, 0.3], duration=5.0)
    again = tracking.follow(tracker, [-0.1, 0.1, 0.3], duration=5.0)
    assert np.array_equal(first.commands, again.commands)
    counts = []
    solve = tracker.start().problem.solver.solve
    tracker.start().problem.solver.solve = lambda **k: (answer := solve(**k), counts.append(answer.info.iter))[0]
    state, pose = tracker.start(), columns(tracker.rows, POSE)[0] + [0.02, 0.0, 0.0]
    _, warm = tracker.step(state, pose, tracker.row(0.0))
    tracker.step(warm, pose, tracker.row(0.0))
    assert counts[1] < counts[0]


# --- observers -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "observer", [tracking.Differences(), tracking.Luenberger(), tracking.Kalman()], ids=lambda o: type(o).__name__
)
def test_observers_find_the_velocity_of_a_clean_run(observer: tracking.Observer) -> None:
    trace = tracking.follow(tracking.Tracker(EIGHT, tracking.Dfl(), observer=observer), [0.1, -0.1, 0.3])
    assert trace.after(30.0).max_distance < 0.005
    again = tracking.follow(tracking.Tracker(EIGHT, tracking.Dfl(), observer=observer), [0.1, -0.1, 0.3])
    assert np.array_equal(trace.poses, again.poses)


@pytest.mark.parametrize("noise", [0.005, 0.02])
def test_models_beat_differences_under_noise(noise: float) -> None:
    def errors(observer: tracking.Observer) -> float:
        rng, t = np.random.default_rng(2), np.arange(600) * 0.1
        sample = EIGHT.sample(t)
        observer.reset()
        found = []
        for position, velocity, push in zip(sample.position, sample.velocity, sample.acceleration, strict=True):
            found.append(observer.update(position + noise * rng.standard_normal(2), velocity)[[1, 3]])
            observer.push(push)
        return float(np.sqrt(((np.array(found) - sample.velocity)[100:] ** 2).mean()))

    plain, fixed, kalman = (
        errors(o) for o in (tracking.Differences(), tracking.Luenberger(), tracking.Kalman(position_noise=noise))
    )
    assert plain == pytest.approx(np.sqrt(2.0) * noise / 0.1, rel=0.1)
    assert fixed < 0.35 * plain
    assert kalman < 0.35 * plain


def test_luenberger_gain_places_the_poles() -> None:
    gain = tracking.luenberger_gain((-3.0, -5.0), 0.1)
    step, seen = np.array([[1.0, 0.1], [0.0, 1.0]]), np.array([[1.0, 0.0]])
    poles = np.linalg.eigvals(step - np.outer(gain, seen @ step))
    assert np.sort(poles.real) == pytest.approx(np.exp([-0.5, -0.3]), abs=1e-9)


# --- bad input -----------------------------------------------------------------------------------


class Jump(reference.Reference):
    """A line that jumps sideways half way."""

    duration = 10.0

    def flat(self, t: object) -> Array:
        times = np.asarray(t, dtype=float)
        y = np.where(times > 5.0, 1.0, 0.0)
        zero = np.zeros_like(times)
        columns = [(0.2 * times, y), (zero + 0.2, zero), (zero, zero), (zero, zero)]
        return np.stack([np.stack(pair, axis=-1) for pair in columns], axis=-2)


class Still(reference.FigureEight):
    """A reference that never moves."""

    def flat(self, t: object) -> Array:
        return 0.0 * super().flat(t)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: tracking.Dfl(v0=0.0), "v0 must be positive"),
        (lambda: tracking.Dfl(v0=-0.1), "backwards"),
        (lambda: tracking.Dfl(kp1=0.0), "kp1 must be positive"),
        (lambda: tracking.Dfl(kd2=-1.0), "kd2 must be positive"),
        (lambda: tracking.Kanayama(k2=np.nan), "k2 must be positive"),
        (lambda: tracking.Pid(ki_v=-0.1), "ki_v must be finite and not negative"),
        (lambda: tracking.Sliding(phi1=0.0), "phi1 must be positive"),
        (lambda: tracking.Weights(omega=0.0), "weights must be positive"),
        (lambda: tracking.Mpc(horizon=0), "horizon"),
        (lambda: tracking.Disturbance(slip=1.0), "below 1"),
        (lambda: tracking.Disturbance(delay=-0.1), "delay"),
        (lambda: tracking.Tracker(EIGHT, tracking.Dfl(), dt=0.0), "dt must be positive"),
        (lambda: tracking.Tracker(EIGHT, tracking.Mpc(), dt=-0.1), "dt must be positive"),
        (
            lambda: tracking.Tracker(EIGHT, tracking.Dfl(), dt=1.5),
            "too large for these gains: the sampled loop is stable below 1.42 s",
        ),
        (lambda: tracking.Tracker(Jump(), tracking.Kanayama()), "jumps by 1 m at t = 5 s"),
        (lambda: tracking.Tracker(Still(), tracking.Sliding()), "zero speed|not finite"),
        (lambda: tracking.gains_from_poles([1.0, -1.0]), "left half-plane"),
        (lambda: tracking.luenberger_gain((-1.0, 1.0), 0.1), "negative"),
        (lambda: tracking.Kalman(position_noise=0.0), "positive"),
        (
            lambda: tracking.Tracker(reference.FigureEight(duration=1e12), tracking.Dfl()),
            "over 1,000,000 steps of 0.1 s",
        ),
        (lambda: reference.FigureEight(duration=1e12).length(), "at most 100000 s"),
        (lambda: EIGHT.length(np.nan), "at most 100000 s, not to nan s"),
        (lambda: tracking.Tracker(EIGHT, None), r"method command\(state, pose, row\), got None"),
        (lambda: tracking.Tracker(EIGHT, tracking.Pid(), observer=tracking.Kalman()), "serves Dfl and Flatness"),
        (lambda: tracking.Lqr(speeds=0), "1 to 33 speeds"),
        (lambda: tracking.lqr_gain(np.nan, 0.0, tracking.Weights()), "speeds of the reference .* finite"),
        (lambda: tracking.lqr_gain(np.inf, 0.0, tracking.Weights()), "speeds of the reference .* finite"),
        (lambda: tracking.lqr_gain(0.2, 0.0, tracking.Weights(), dt=-1.0), "dt must be positive"),
        (lambda: tracking.riccati(np.eye(2), np.eye(2), tracking.Weights()), "A must be 3 x 3 finite numbers"),
        (lambda: tracking.follow(tracking.Tracker(EIGHT, tracking.Dfl()), [0.0, np.nan, 0.0]), "finite pose"),
        (lambda: tracking.follow(tracking.Tracker(EIGHT, tracking.Dfl()), duration=0.0), "at least one step"),
    ],
)
def test_bad_input_says_what_is_wrong(make: object, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        make()  # type: ignore[operator]


@pytest.mark.parametrize("law", ALL, ids=name_of)
def test_a_pose_that_is_not_finite_is_refused_and_the_end_is_rest(law: tracking.Law) -> None:
    tracker = tracking.Tracker(SHORT, law)
    with pytest.raises(ValueError, match="not finite"):
        tracker(tracking.seen(0.0, np.array([0.0, np.nan, 0.0]), np.zeros(2)))
    after = tracker(tracking.seen(SHORT.duration + 0.1, np.zeros(3), np.zeros(2)))
    assert np.array_equal(after, [0.0, 0.0])


def test_a_time_off_the_grid_reads_the_reference_itself() -> None:
    tracker = tracking.Tracker(SHORT, tracking.Dfl())
    assert tracker.row(1.234) == SHORT.rows(np.array([1.234]))[0]
    ahead = tracking.Tracker(SHORT, tracking.Mpc()).row(29.95)
    assert ahead.shape == (15,)
    assert np.abs(ahead["v"][2:]).max() == 0.0
    assert ahead["v"][0] > 0.0
