"""Passive separation, the exact condition on the arc, and what holds between them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav.dwa.steps import brake
from fuzzynav.fusion import ROBOTS, passive_separation, reached_by_then, static_separation, stays_clear
from fuzzynav.geometry import Array
from fuzzynav.robot import PIONEER_3DX, THESIS, TURTLEBOT2, TURTLEBOT3_BURGER, Robot, move

FOUR = (THESIS, TURTLEBOT2, PIONEER_3DX, TURTLEBOT3_BURGER)
ANGLE = st.floats(-np.pi, np.pi)


def braked(sample: Array, robot: Robot, dt: float) -> Array:
    """Speeds of every step: the sample, then the emergency candidate again and again."""
    rows = [np.asarray(sample, dtype=float)]
    while abs(rows[-1][0]) > 1e-9:
        rows.append(brake(rows[-1], robot, dt))
    return np.array(rows)


def least_by_sampling(sample: Array, hazards: Array, bound: float, robot: Robot, dt: float) -> float:
    """Least gap to all that hazards can reach, at 50 moments of every step: another way to the same answer."""
    pose, time, least = np.zeros(3), 0.0, np.inf
    for speed in braked(sample, robot, dt)[:-1] if abs(sample[0]) > 0 else []:
        for u in np.linspace(0.0, 1.0, 50):
            at = move(pose, speed, u * dt)
            gaps = np.hypot(*(hazards[:, :2] - at[:2]).T) - hazards[:, 2] - robot.radius - bound * (time + u * dt)
            least = min(least, float(gaps.min()))
        pose, time = move(pose, speed, dt), time + dt
    return least


@pytest.mark.parametrize(
    ("robot", "v", "expected"),
    [
        (THESIS, 1.0, 5.30), (THESIS, 0.2, 0.74), (PIONEER_3DX, 1.2, 4.74), (PIONEER_3DX, 0.2, 0.54),
        (TURTLEBOT2, 0.65, 0.47), (TURTLEBOT2, 0.2, 0.21), (TURTLEBOT3_BURGER, 0.22, 0.22),
    ],
)  # fmt: skip
def test_known_separations(robot: Robot, v: float, expected: float) -> None:
    assert float(passive_separation(v, 0.5, robot, 0.1)) == pytest.approx(expected, abs=0.005)


def test_by_hand() -> None:
    # 1 m/s, V 0.5, A = b = 0.2, e = 0.1: 2.5 + 2.5 + 2 (0.001 + 0.15) = 5.302; without movers 2.5 + 2 (0.001 + 0.1)
    assert float(passive_separation(1.0, 0.5, THESIS, 0.1)) == pytest.approx(5.302, abs=1e-12)
    assert float(static_separation(1.0, THESIS, 0.1)) == pytest.approx(2.702, abs=1e-12)
    assert reached_by_then([1.0, 0.0], 0.5, THESIS, 0.1) == pytest.approx(0.5 * 5.0)  # 50 steps of 0.02 m/s
    assert reached_by_then([0.0, 0.3], 0.5, THESIS, 0.1) == 0.0


@given(v=st.floats(0.0, 1.0), more=st.floats(0.01, 0.5), bound=st.floats(0.0, 2.0))
def test_separation_grows_with_every_danger(v: float, more: float, bound: float) -> None:
    near = passive_separation(v, bound, TURTLEBOT2, 0.1)
    assert passive_separation(v + more, bound, TURTLEBOT2, 0.1) > near
    assert passive_separation(v, bound + more, TURTLEBOT2, 0.1) > near
    assert passive_separation(v, bound, TURTLEBOT2, 0.1 + more) > near
    assert near >= static_separation(v, TURTLEBOT2, 0.1)


@settings(max_examples=200)
@given(st.data())
def test_the_arc_condition_is_weaker_than_the_theorem(data: st.DataObject) -> None:
    """Whoever is further away than the separation, along x or along y, is no danger on any arc."""
    robot = data.draw(st.sampled_from(FOUR))
    bound, dt = data.draw(st.floats(0.0, 1.0)), data.draw(st.sampled_from([0.05, 0.1, 0.2]))
    v = data.draw(st.floats(0.0, robot.max_vel_x))
    sample = np.array([v, data.draw(st.floats(-1.0, 1.0)) * robot.max_vel_theta])
    away = float(passive_separation(v, bound, robot, dt)) + robot.radius + 0.3
    aside = data.draw(st.floats(-3.0, 3.0))
    place = (away, aside) if data.draw(st.booleans()) else (aside, away)
    rows = braked(sample, robot, dt)
    straight = (rows[:-1, 1] == 0).all() or bool(np.isclose(rows[1, 0], max(v - robot.dec_lim_x * dt, 0.0)))
    if straight:  # the theorem brakes at full; a wheel that must stop turning as well brakes more slowly
        assert stays_clear([0, 0, 0], sample, [[*place, 0.3]], bound, robot, dt)


@settings(max_examples=300)
@given(st.data())
def test_the_arc_condition_agrees_with_dense_sampling(data: st.DataObject) -> None:
    robot = data.draw(st.sampled_from([*FOUR, *ROBOTS.values()]))
    bound = data.draw(st.floats(0.0, 1.0))
    v = data.draw(st.floats(-1.0, 1.0)) * robot.max_vel_x
    v = v if abs(v) > 1e-6 else 0.0  # less than a nm/s counts as standing: sooner here than where it brakes to the end
    sample = np.array([v, data.draw(st.floats(-1.0, 1.0)) * robot.max_vel_theta])
    hazards = np.array(
        [
            [data.draw(st.floats(-3, 3)), data.draw(st.floats(-3, 3)), data.draw(st.floats(0.0, 0.5))]
            for _ in range(data.draw(st.integers(1, 4)))
        ]
    )
    least = least_by_sampling(sample, hazards, bound, robot, 0.1)
    said = stays_clear([0, 0, 0], sample, hazards, bound, robot, 0.1)
    if abs(least) > 0.02:  # sampled at 50 moments a step, and a gap of 0.1 mm counts as contact
        assert said == (least > 0)


def test_a_brush_in_passing_is_not_stepped_over() -> None:
    """Hazards beside the arc of a fast robot, touched by 2 to 10 cm for a moment, and clear again when it stands."""
    rng, brushed = np.random.default_rng(4), 0
    for _ in range(150):
        sample = np.array([rng.uniform(0.5, 1.0), rng.uniform(-0.3, 0.3)]) * [THESIS.max_vel_x, 1.0]
        at = move(np.zeros(3), sample, rng.uniform(0.2, 1.5))
        side, radius = rng.choice([-1.0, 1.0]), rng.uniform(0.0, 0.1)
        aside = THESIS.radius + radius - rng.uniform(0.02, 0.1)
        place = at[:2] + side * aside * np.array([-np.sin(at[2]), np.cos(at[2])])
        hazards, bound = np.array([[*place, radius]]), rng.uniform(0.0, 0.02)
        if least_by_sampling(sample, hazards, bound, THESIS, 0.1) < -0.02:
            brushed += 1
            assert not stays_clear([0, 0, 0], sample, hazards, bound, THESIS, 0.1)
    assert brushed > 100


@settings(max_examples=100)
@given(x=st.floats(-5, 5), y=st.floats(-5, 5), theta=ANGLE, far=st.floats(0.5, 3.0), side=ANGLE)
def test_moving_and_mirroring_the_scene_changes_nothing(
    x: float, y: float, theta: float, far: float, side: float
) -> None:
    place = np.array([far * np.cos(side), far * np.sin(side)])
    sample, robot = np.array([0.5, 0.8]), ROBOTS["turtlebot2"]
    here = stays_clear([0, 0, 0], sample, [[*place, 0.3]], 0.5, robot, 0.1)
    c, s = np.cos(theta), np.sin(theta)
    there = [x + c * place[0] - s * place[1], y + s * place[0] + c * place[1], 0.3]
    near = abs(least_by_sampling(sample, np.array([[*place, 0.3]]), 0.5, robot, 0.1)) < 1e-3
    assert near or stays_clear([x, y, theta], sample, [there], 0.5, robot, 0.1) == here
    assert near or stays_clear([0, 0, 0], sample * [1, -1], [[place[0], -place[1], 0.3]], 0.5, robot, 0.1) == here


def test_what_stands_still_is_always_clear() -> None:
    for sample in ([0.0, 0.0], [0.0, 3.0]):
        assert stays_clear([0, 0, 0], sample, [[0.1, 0.0, 0.5]], 9.0, TURTLEBOT2, 0.1)


def test_a_braking_robot_stays_on_what_it_checked() -> None:
    """The tail of a checked motion is checked: one step later, against movers that came as near as they can."""
    rng, robot, dt, bound = np.random.default_rng(7), ROBOTS["turtlebot2"], 0.1, 0.5
    kept = 0
    for _ in range(3000):
        sample = np.array([rng.uniform(-0.65, 0.65), rng.uniform(-3.0, 3.0)])
        hazard = np.array([*rng.uniform(-1.5, 1.5, 2), 0.3])
        if abs(sample[0]) < 0.05 or not stays_clear([0, 0, 0], sample, [hazard], bound, robot, dt):
            continue
        pose = move(np.zeros(3), sample, dt)
        to_robot = pose[:2] - hazard[:2]
        walked = hazard[:2] + bound * dt * to_robot / np.hypot(*to_robot)
        gap = np.hypot(*(walked - pose[:2])) - 0.3 - robot.radius
        assert gap > 0
        later = brake(sample, robot, dt)
        assert stays_clear(pose, later, [[*walked, 0.3 - 2e-4]], bound, robot, dt)
        kept += 1
    assert kept > 500


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: passive_separation(-0.1, 0.5, THESIS, 0.1), "0 m/s or more"),
        (lambda: passive_separation(0.1, -0.5, THESIS, 0.1), "0 m/s or more"),
        (lambda: passive_separation(0.1, 0.5, THESIS, 0.0), "dt positive"),
        (lambda: stays_clear([0, 0, 0], [np.nan, 0], [[1, 0, 0.3]], 0.5, THESIS, 0.1), "the sample"),
        (lambda: stays_clear([0, 0, 0], [0.1, 0], [[np.nan, 0, 0.3]], 0.5, THESIS, 0.1), "hazards"),
    ],
)
def test_bad_input_is_named(call, said: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ValueError, match=said):
        call()
