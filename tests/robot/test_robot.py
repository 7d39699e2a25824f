"""Wheels, arcs, forces and limits of the differential-drive robot."""

from dataclasses import fields, replace

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav import robot as r
from fuzzynav.geometry import wrap
from fuzzynav.robot import kernels

PRESETS = [r.THESIS, r.TURTLEBOT2, r.TURTLEBOT3_BURGER, r.PIONEER_3DX]
speeds = st.floats(-2.0, 2.0)
commands = st.tuples(speeds, speeds).map(np.array)
poses = st.tuples(speeds, speeds, st.floats(-3.1, 3.1)).map(np.array)


@given(commands, st.sampled_from(PRESETS))
def test_wheels_and_body_are_inverse(command: np.ndarray, robot: r.Robot) -> None:
    assert np.allclose(r.body_speeds(r.wheel_speeds(command, robot), robot), command, atol=1e-12)


@given(commands, poses)
def test_yaw_rate_is_the_commanded_one_for_any_track(command: np.ndarray, pose: np.ndarray) -> None:
    """theta' = omega, not omega / track: the slip that a default track of 1 hides."""
    assert r.pose_rate(pose, command)[2] == command[1]
    for track in (0.1, 0.5, 2.0):
        robot = replace(r.TURTLEBOT2, track=track)
        assert r.body_speeds(r.wheel_speeds(command, robot), robot)[1] == pytest.approx(command[1], abs=1e-12)


def test_there_is_no_default_measure() -> None:
    with pytest.raises(TypeError):
        r.Robot(name="x")  # type: ignore[call-arg]


def test_printed_yaw_rate_is_half_the_right_one() -> None:
    wheels = [8.0, 3.0]
    assert r.yaw_rate_as_printed(wheels, r.TURTLEBOT2) == pytest.approx(r.body_speeds(wheels, r.TURTLEBOT2)[1] / 2)


def test_turning_radius_closes_appendix_a() -> None:
    omega, radius = sympy.symbols("omega R", real=True)
    track = sympy.Symbol("L", positive=True)
    right, left = omega * (radius + track / 2), omega * (radius - track / 2)
    assert sympy.simplify(track / 2 * (right + left) / (right - left) - radius) == 0
    rims = r.rims_from_turn(0.7, -1.3, r.PIONEER_3DX)
    assert r.turning_radius(rims, r.PIONEER_3DX) == pytest.approx(-1.3)
    assert r.body_from_rims(rims, r.PIONEER_3DX) == pytest.approx([-0.91, 0.7])
    assert r.turning_radius([0.3, 0.3], r.PIONEER_3DX) == np.inf
    assert np.isnan(r.turning_radius([0.0, 0.0], r.PIONEER_3DX))
    assert r.turning_radius([0.2, -0.2], r.PIONEER_3DX) == 0.0


SPEEDS = st.floats(-3.0, 3.0, allow_subnormal=False)  # half of the least subnormal is zero


@given(SPEEDS, SPEEDS)
def test_the_name_of_a_motion_agrees_with_the_motion(right: float, left: float) -> None:
    v, _omega = r.body_from_rims([right, left], r.TURTLEBOT2)
    name = r.motion_name(right, left, tolerance=0.0)
    assert ("forward" in name) == (v > 0)
    assert ("backward" in name) == (v < 0)
    turns_left = "turns left" in name or name.endswith("counter-clockwise")
    turns_right = "turns right" in name or name.endswith("spin clockwise")
    assert turns_left == (right > left)
    assert turns_right == (right < left)


def test_the_nine_rows_of_the_wheel_table() -> None:
    rows = {
        (1, 1): "forward, straight",
        (-1, -1): "backward, straight",
        (2, 1): "forward, heading turns left",
        (1, 2): "forward, heading turns right",
        (-1, -2): "backward, heading turns left",
        (-2, -1): "backward, heading turns right",
        (-1, 1): "spin clockwise",
        (1, -1): "spin counter-clockwise",
        (0, 0): "rest",
    }
    assert {pair: r.motion_name(*pair) for pair in rows} == rows
    for right, left in [(1.0, -1.0), (-1.0, 1.0)]:
        assert r.spin_name_as_printed(right, left) != r.motion_name(right, left)
    with pytest.raises(ValueError, match="finite"):
        r.motion_name(np.nan, 1.0)


@given(commands, poses, st.floats(0.01, 2.0))
def test_move_is_the_integral_of_the_rate(command: np.ndarray, pose: np.ndarray, dt: float) -> None:
    t, w = np.polynomial.legendre.leggauss(20)
    headings = pose[2] + command[1] * dt * (t + 1) / 2
    x, y = (command[0] * dt / 2 * (w * f(headings)).sum() for f in (np.cos, np.sin))
    end = r.move(pose, command, dt)
    assert np.allclose(end[:2], pose[:2] + [x, y], atol=1e-12)
    assert abs(wrap(end[2] - pose[2] - command[1] * dt)) < 1e-12


@given(commands, poses, st.floats(0.01, 2.0))
def test_two_halves_make_a_whole_and_back_is_home(command: np.ndarray, pose: np.ndarray, dt: float) -> None:
    whole, halves = r.move(pose, command, dt), r.move(r.move(pose, command, dt / 2), command, dt / 2)
    assert np.allclose(halves[:2], whole[:2], atol=1e-12)
    assert abs(wrap(halves[2] - whole[2])) < 1e-12
    home = r.move(whole, -command, dt)
    assert np.allclose(home[:2], pose[:2], atol=1e-12)
    assert abs(wrap(home[2] - pose[2])) < 1e-12


@given(commands, poses)
def test_a_full_turn_added_to_the_heading_changes_nothing(command: np.ndarray, pose: np.ndarray) -> None:
    turned = pose + [0.0, 0.0, 2 * np.pi]
    assert np.allclose(r.move(pose, command, 0.1), r.move(turned, command, 0.1), atol=1e-12)


@pytest.mark.parametrize("steps", [7, 100, 1000])
def test_a_closed_circle_returns_to_its_start(steps: int) -> None:
    pose = np.zeros(3)
    for _ in range(steps):
        pose = r.move(pose, [1.0, 1.0], 2 * np.pi / steps)
    assert np.abs([pose[0], pose[1], wrap(pose[2])]).max() < 1e-12


def test_midpoint_rule_overshoots_by_the_printed_factor() -> None:
    exact, middle = (f([0, 0, 0], [1.0, 0.2], 1.0) for f in (r.move, r.move_midpoint))
    assert np.hypot(*exact[:2]) / np.hypot(*middle[:2]) == pytest.approx(0.99833, abs=1e-5)
    assert exact[2] == middle[2]


def test_midpoint_rule_converges_with_the_square_of_the_step() -> None:
    def error(steps: int) -> float:
        pose = np.zeros(3)
        for _ in range(steps):
            pose = r.move_midpoint(pose, [1.0, 1.0], 2.0 / steps)
        return float(np.hypot(*(pose - r.move([0, 0, 0], [1.0, 1.0], 2.0))[:2]))

    assert error(10) / error(20) == pytest.approx(4.0, rel=0.02)


@given(commands, poses)
def test_rolling_motion_satisfies_the_constraints_and_a_slide_does_not(command: np.ndarray, pose: np.ndarray) -> None:
    robot = r.PIONEER_3DX
    rims = robot.wheel_radius * r.wheel_speeds(command, robot)
    rate = r.pose_rate(pose, command)
    assert r.rolls(pose, rate, rims, robot)
    aside = rate + 0.1 * np.array([-np.sin(pose[2]), np.cos(pose[2]), 0.0])
    assert not r.rolls(pose, aside, rims, robot)
    assert r.constraints(pose, aside, rims, robot)[0] == pytest.approx(0.1)
    spinning = r.constraints(pose, rate, rims + [0.2, 0.0], robot)
    assert spinning == pytest.approx([0.0, -0.2, 0.0], abs=1e-9)


def test_torque_doubles_need_the_full_separation() -> None:
    """Power balance: torque times wheel rate equals the rate of kinetic energy, only with L/(2r)."""
    robot, state, torques = r.PIONEER_3DX, np.array([0, 0, 0.3, 0.8, -1.1]), np.array([0.9, -0.4])
    forward, turn = r.accelerations(torques, robot)
    gained = robot.mass * state[3] * forward + robot.inertia * state[4] * turn
    assert gained == pytest.approx(float(torques @ r.wheel_speeds(state[3:], robot)))


def test_driving_under_constant_torque() -> None:
    robot = r.TURTLEBOT2
    straight = r.drive(np.zeros(5), [0.1, 0.1], 2.0, robot)
    a = 0.2 / (robot.mass * robot.wheel_radius)
    assert straight == pytest.approx([a * 2.0, 0.0, 0.0, 2 * a, 0.0])
    coasting = r.drive([0, 0, 0, 0.5, 0.4], [0.0, 0.0], 1.5, robot)
    assert coasting[:3] == pytest.approx(r.move([0, 0, 0], [0.5, 0.4], 1.5), abs=1e-9)
    turned = r.drive([0, 0, 2 * np.pi, 0.5, 0.4], [0.02, 0.01], 1.5, robot)
    assert turned == pytest.approx(r.drive([0, 0, 0, 0.5, 0.4], [0.02, 0.01], 1.5, robot), abs=1e-8)


def test_driving_against_many_small_steps() -> None:
    state = np.array([0.0, 0.0, 0.5, 0.3, -0.2])
    fine = state.copy()
    for _ in range(20000):
        middle = fine + 0.5 * 5e-5 * r.state_rate(fine, [0.03, 0.05], r.TURTLEBOT2)
        fine = fine + 5e-5 * r.state_rate(middle, [0.03, 0.05], r.TURTLEBOT2)
    assert r.drive(state, [0.03, 0.05], 1.0, r.TURTLEBOT2) == pytest.approx(fine, abs=1e-7)
    with pytest.raises(ValueError, match="finite"):
        r.drive(state, [np.nan, 0.0], 1.0, r.TURTLEBOT2)


def test_motor_lag_composes_and_settles() -> None:
    once = r.motor_lag([0.0, 1.0], [1.0, 0.0], 0.2, 0.3)
    twice = r.motor_lag(r.motor_lag([0.0, 1.0], [1.0, 0.0], 0.2, 0.1), [1.0, 0.0], 0.2, 0.2)
    assert np.allclose(once, twice)
    assert r.motor_lag(0.0, 1.0, 0.2, 100.0) == pytest.approx(1.0)
    with pytest.raises(ValueError, match="time_constant"):
        r.motor_lag(0.0, 1.0, 0.0, 0.1)


@given(commands, commands, st.sampled_from(PRESETS), st.floats(0.01, 1.0))
def test_a_limited_command_keeps_the_limits(wish: np.ndarray, last: np.ndarray, robot: r.Robot, dt: float) -> None:
    last = np.clip(last, [robot.min_vel_x, -robot.max_vel_theta], [robot.max_vel_x, robot.max_vel_theta])
    command = r.limit(wish, last, robot, dt)
    assert r.respects_limits([last, command], dt, robot)
    low, high = r.reachable(last, robot, dt)
    assert np.all(low <= last)
    assert np.all(last <= high)
    mirrored = r.limit(wish * [1, -1], last * [1, -1], robot, dt)
    assert mirrored == pytest.approx(command * [1, -1])


@given(commands, commands)
def test_more_time_is_never_less_reach(wish: np.ndarray, last: np.ndarray) -> None:
    short, long = (r.reachable(last, r.PIONEER_3DX, dt) for dt in (0.2, 0.3))
    assert np.all(long[0] <= short[0] + 1e-12)
    assert np.all(short[1] <= long[1] + 1e-12)
    both = r.reachable(r.reachable(last, r.PIONEER_3DX, 0.2)[1], r.PIONEER_3DX, 0.1)[1]
    assert both == pytest.approx(long[1], abs=1e-12)


def test_braking_uses_its_own_limit_and_reversing_speeds_up() -> None:
    robot = replace(r.PIONEER_3DX, acc_lim_x=0.5, dec_lim_x=2.0)
    assert r.limit([-1.0, 0.0], [0.8, 0.0], robot, 0.1)[0] == pytest.approx(0.6)
    assert r.limit([-1.0, 0.0], [0.1, 0.0], robot, 0.1)[0] == pytest.approx(-0.025)  # stops after 0.05 s
    assert r.limit([1.0, 0.0], [-0.1, 0.0], robot, 0.1)[0] == pytest.approx(0.025)
    assert r.limit([1.0, 0.0], [-0.8, 0.0], robot, 0.1)[0] == pytest.approx(-0.6)
    assert r.limit([1.0, 0.0], [1.9, 0.0], robot, 0.1)[0] == pytest.approx(1.7)  # too fast: brakes, does not jump


def test_a_heading_of_half_a_turn_is_told_in_one_way() -> None:
    for heading in (np.pi, -np.pi, 3.0 * np.pi):
        assert r.move([0.0, 0.0, heading], [0.0, 0.0], 1.0)[2] == pytest.approx(-np.pi, abs=1e-12)
        assert kernels.wrap(heading) == wrap(heading)


def test_motors_that_lag_drive_the_mean_of_their_speed() -> None:
    """From rest towards v for a time t the way is v (t - lag (1 - exp(-t/lag))), in however many steps."""
    plant = np.array([(0.035, 0.23, 0.1, 0.0, 0.0)], dtype=kernels.PLANT)[0]
    for steps in (1, 2, 5):
        pose, wheels = np.zeros(3), np.zeros(2)
        for _ in range(steps):
            kernels.drive(pose, wheels, np.array([0.3, 0.0]), np.zeros(2), plant, 0.2 / steps, False, np.empty(2))
        assert pose[0] == pytest.approx(0.3 * (0.2 - 0.1 * (1.0 - np.exp(-2.0))), rel=1e-12)
        assert wheels == pytest.approx(0.3 / 0.035 * (1.0 - np.exp(-2.0)), rel=1e-12)


@pytest.mark.parametrize(
    ("slip", "errors"), [((0.5, 0.0), (0, 0)), ((0.0, 0.5), (0, 0)), ((0, 0), (0.1, 0)), ((0, 0), (0, 0.1))]
)
def test_each_wheel_has_its_own_slip_and_radius(slip: tuple[float, float], errors: tuple[float, float]) -> None:
    plant, driven = np.array([(0.035, 0.23, 0.0, *errors)], dtype=kernels.PLANT)[0], np.empty(2)
    kernels.drive(
        np.zeros(3), np.zeros(2), np.array([0.2, 0.4]), np.array(slip, dtype=float), plant, 0.1, False, driven
    )
    right, left = 0.2 + 0.4 * 0.23 / 2.0, 0.2 - 0.4 * 0.23 / 2.0
    right, left = right * (1.0 - slip[0]) * (1.0 + errors[0]), left * (1.0 - slip[1]) * (1.0 + errors[1])
    assert driven == pytest.approx([(right + left) / 2.0, (right - left) / 0.23], rel=1e-12)


def test_respects_limits_finds_each_fault() -> None:
    robot, still = r.TURTLEBOT2, [0.0, 0.0]
    assert r.respects_limits([still, [0.25, 0.32]], 0.1, robot)
    for bad in ([0.26, 0.0], [0.0, 0.33], [np.nan, 0.0]):
        assert not r.respects_limits([still, bad], 0.1, robot)
    assert not r.respects_limits([[0.66, 0.0]], 0.1, robot)
    assert not r.respects_limits([[0.0, -3.15]], 0.1, robot)


@pytest.mark.parametrize(
    "bad", [{"track": 0.0}, {"mass": -1.0}, {"wheel_radius": np.nan}, {"min_vel_x": 0.1}, {"max_vel_x": np.inf}]
)
def test_impossible_robots_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(bad))):
        replace(r.TURTLEBOT2, **bad)


@pytest.mark.parametrize("bad", [([np.nan, 0.0], [0.0, 0.0], 0.1), ([0, 0], [np.inf, 0.0], 0.1), ([0, 0], [0, 0], 0.0)])
def test_bad_commands_are_refused(bad: tuple[list[float], list[float], float]) -> None:
    with pytest.raises(ValueError):
        r.limit(bad[0], bad[1], r.TURTLEBOT2, bad[2])


def answers(robot: r.Robot) -> tuple[object, ...]:
    """One output of each function, so that a field without effect is found."""
    ask = [[9.0, 9.0], [-9.0, -9.0]]
    return (
        r.wheel_speeds([0.3, 0.4], robot).tolist(),
        r.accelerations([0.2, 0.1], robot).tolist(),
        r.footprint([0, 0, 0], robot).tolist(),
        r.limit(ask, [[0.01, 0.0]] * 2, robot, 0.01).tolist(),
        r.limit(ask, [[0.01, 0.0]] * 2, robot, 100.0).tolist(),
        repr(robot),
    )


@pytest.mark.parametrize("field", [f.name for f in fields(r.Robot)])
def test_every_field_of_the_robot_has_an_effect(field: str) -> None:
    robot = r.PIONEER_3DX
    value = getattr(robot, field)
    changed = replace(robot, **{field: value + "x" if isinstance(value, str) else value * 1.1})
    same = slice(None) if isinstance(value, str) else slice(-1)
    assert answers(changed)[same] != answers(robot)[same]


def test_scaling_lengths_scales_the_motion() -> None:
    small, big = np.array([0.4, 0.9]), np.array([0.8, 0.9])
    assert np.allclose(r.move([0, 0, 0.2], small, 0.7)[:2] * 2, r.move([0, 0, 0.2], big, 0.7)[:2])
    robot = r.TURTLEBOT2
    double = replace(robot, wheel_radius=2 * robot.wheel_radius, track=2 * robot.track)
    assert np.allclose(r.wheel_speeds(small, robot), r.wheel_speeds(big, double))


def test_thesis_limits_are_the_published_ones() -> None:
    import csv
    from pathlib import Path

    with (Path(__file__).parents[2] / "data/published/claims.csv").open(encoding="utf-8") as file:
        claims = {row["id"]: row["value"] for row in csv.DictReader(file)}
    for robot, name in [(r.TURTLEBOT2, "TurtleBot2"), (r.PIONEER_3DX, "Pioneer")]:
        printed = [float(claims[f"thesis:c-5.4-{name}-{key}"]) for key in ("weight", "max_speed", "rotation_speed")]
        assert [robot.mass, robot.max_vel_x, robot.max_vel_theta] == printed
