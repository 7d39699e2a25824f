"""Reference trajectories: derivatives, the flat map, stops and reversals, bad input."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from fuzzynav.geometry import compose, length, wrap
from fuzzynav.robot import pose_rate
from fuzzynav.tracking import curves, reference

STOPS = curves.SpeedProfile([0, 2, 6, 8, 11, 13, 17, 19], [0, 0.3, 0.3, 0, 0, -0.3, -0.3, 0])
WAYPOINTS = [[0, 0], [1, 0], [2, 1], [3, 1], [3, 2]]
TIMES = np.linspace(0.0, 20.0, 41)
MAKERS = {
    "eight": lambda: reference.FigureEight(),
    "circle": lambda: reference.circle(1.5, 0.3, 30.0, center=(1.0, 2.0)),
    "clockwise": lambda: reference.circle(-0.5, 0.2, 30.0),
    "line": lambda: reference.line((1.0, -1.0), 2.0, 0.4, 20.0),
    "backwards": lambda: reference.line((1.0, -1.0), 2.0, -0.4, 20.0),
    "spline": lambda: reference.spline(WAYPOINTS, 0.3),
    "stops": lambda: reference.Along(curves.CircleCurve((0.0, 0.0), 1.0), STOPS),
    "recorded": lambda: reference.Recorded(TIMES, np.stack([np.sin(TIMES / 4), TIMES / 10], axis=-1)),
    "moved": lambda: reference.FigureEight().moved([1.0, -2.0, 2.5]),
}
finite = st.floats(-3, 3, allow_subnormal=False)


@pytest.mark.parametrize("name", MAKERS)
def test_each_derivative_is_that_of_the_one_before(name: str) -> None:
    ref = MAKERS[name]()
    h = 1e-4
    t = np.linspace(0.01, ref.duration - 0.01, 501)
    if name == "recorded":
        t = t[np.abs(t[:, None] - TIMES).min(axis=1) > 2 * h]  # the fifth derivative jumps at the recorded times
    flat, later, before = ref.flat(t), ref.flat(t + h), ref.flat(t - h)
    scale = np.abs(flat).max(axis=(0, 2)) + 1e-3
    for order in range(3):
        slope = (later[:, order] - before[:, order]) / (2 * h)
        tolerance = 1e-4 if name == "spline" else 1e-5
        assert np.abs(slope - flat[:, order + 1]).max() < tolerance * scale[order + 1] + 1e-6


@pytest.mark.parametrize("name", MAKERS)
def test_flat_map_there_and_back(name: str) -> None:
    ref = MAKERS[name]()
    sample = ref.sample(np.linspace(0.0, ref.duration, 1001))
    moving = np.abs(sample.v) > 1e-3
    flat = ref.flat(sample.t[moving])
    state = reference.pose_of_flat(flat, np.sign(sample.v[moving]))
    assert np.abs(reference.flat_of_pose(state) - flat).max() < 1e-12
    assert np.abs(wrap(state.pose[:, 2] - sample.theta[moving])).max() < 1e-9
    assert state.v == pytest.approx(sample.v[moving], abs=1e-12)
    assert state.omega == pytest.approx(sample.omega[moving], abs=1e-9)


@given(st.tuples(*[finite] * 7), st.floats(0.05, 2.0), st.sampled_from([-1.0, 1.0]))
def test_flat_map_back_and_there(values: tuple[float, ...], speed: float, direction: float) -> None:
    x, y, theta, v_dot, v_ddot, omega, omega_dot = (np.float64(v) for v in values)
    pose, v = np.array([x, y, wrap(theta)]), np.float64(direction * speed)
    state = reference.FlatState(pose, v, v_dot, v_ddot, omega, omega_dot)
    back = reference.pose_of_flat(reference.flat_of_pose(state), direction)
    size = 1.0 + max(abs(v) for v in values) ** 2 / speed**2
    assert np.abs(wrap(back.pose - state.pose)).max() < 1e-12 * size
    for name in ("v", "v_dot", "v_ddot", "omega", "omega_dot"):
        assert abs(getattr(back, name) - getattr(state, name)) < 1e-12 * size, name


@pytest.mark.parametrize("name", MAKERS)
def test_the_robot_that_drives_v_and_omega_stays_on_the_reference(name: str) -> None:
    ref = MAKERS[name]()
    end = min(ref.duration, 15.0)

    def rate(t: float, pose: np.ndarray) -> np.ndarray:
        s = ref.sample(t)
        return pose_rate(pose, [s.v, s.omega])

    solved = solve_ivp(rate, (0.0, end), ref.sample(0.0).pose, rtol=1e-8, atol=1e-9, max_step=0.25)
    assert np.hypot(*(solved.y[:2, -1] - ref.sample(end).position)) < 2e-4


def test_figure_eight_is_that_of_the_thesis() -> None:
    ref = reference.FigureEight()
    assert ref.length() == pytest.approx(18.9340, abs=5e-5)
    assert ref.length(40 * np.pi) == pytest.approx(2 * 9.429431, abs=1e-6)
    speed = ref.sample(np.linspace(0, 40 * np.pi, 100001)).v
    assert speed.min() == pytest.approx(2 * 0.034799, abs=1e-6)
    assert speed.max() == pytest.approx(2 * 0.111803, abs=1e-6)
    assert ref.sample(10 * np.pi).pose == pytest.approx([0.0, 2.0, np.pi], abs=1e-9) or ref.sample(
        10 * np.pi
    ).pose == pytest.approx([0.0, 2.0, -np.pi], abs=1e-9)


def test_a_reversing_reference_keeps_its_heading() -> None:
    ref = reference.Along(curves.LineCurve((0.0, 0.0), 0.3), STOPS)
    s = ref.sample(np.linspace(0.0, ref.duration, 200))
    assert s.theta == pytest.approx(0.3)
    assert s.v.min() == pytest.approx(-0.3, abs=1e-6)
    assert s.v.max() == pytest.approx(0.3, abs=1e-6)
    assert ref.sample(9.0).v == 0.0
    assert ref.sample(ref.duration).position == pytest.approx([0.0, 0.0], abs=1e-9)


def test_heading_just_after_a_reversal_is_that_of_the_acceleration() -> None:
    state = reference.pose_of_flat([[0, 0], [0, 0], [-1, 0], [0, 0.5]])
    assert abs(state.pose[2]) == pytest.approx(np.pi)
    assert state.v == 0.0
    assert np.isnan(reference.pose_of_flat(np.zeros((4, 2))).pose[2])


def test_a_moved_reference_is_the_reference_moved() -> None:
    ref, pose = reference.FigureEight(), np.array([3.0, -1.0, 0.7])
    t = np.linspace(0, 126, 50)
    assert ref.moved(pose).sample(t).pose == pytest.approx(compose(pose, ref.sample(t).pose), abs=1e-12)


@settings(max_examples=25, deadline=None)
@given(st.lists(st.tuples(st.floats(-4, 4), st.floats(-4, 4)), min_size=2, max_size=7), st.floats(0.1, 1.0))
def test_a_spline_passes_its_points_and_keeps_its_speed(points: list[tuple[float, float]], cruise: float) -> None:
    p = np.array(points)
    if np.hypot(*np.diff(p, axis=0).T).min() < 0.5:
        return
    try:
        ref = reference.spline(p, cruise)
    except ValueError:
        return  # a curve that turns back on itself is refused
    s = ref.sample(np.linspace(0.0, ref.duration, 4001))
    gaps = np.hypot(*(p[:, None] - s.position[None]).transpose(2, 0, 1)).min(axis=1)
    assert gaps.max() < 2e-3 * ref.curve.length + 1e-6
    assert (np.abs(s.v) < cruise * (1.0 + 1e-6)).all()
    assert s.v[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert length(s.position) == pytest.approx(ref.length(), rel=1e-2)


def test_a_short_way_never_reaches_the_cruising_speed() -> None:
    profile = curves.SpeedProfile.rest_to_rest(0.1, 1.0, 2.0)
    assert profile.extent[1] == pytest.approx(0.1)
    assert profile(2.0)[1] == pytest.approx(0.05)


def test_smoothing_a_noisy_record_comes_nearer_to_the_truth() -> None:
    rng = np.random.default_rng(4)
    t = np.linspace(0, 40, 401)
    truth = reference.FigureEight().sample(t).position
    noisy = truth + 0.01 * rng.standard_normal(truth.shape)
    rough, smooth = (reference.Recorded(t, noisy, smoothing=s).sample(t) for s in (0.0, 401 * 0.01**2))
    true_speed = reference.FigureEight().sample(t).v
    assert np.abs(smooth.v - true_speed).max() < 0.1 * np.abs(rough.v - true_speed).max()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: reference.FigureEight(amplitude=0.0), "amplitude must be positive"),
        (lambda: reference.FigureEight(duration=-1.0), "duration must be positive"),
        (lambda: reference.circle(0.0, 0.2, 10.0), "radius"),
        (lambda: reference.line((0, 0), 0.0, 0.0, 10.0), "zero speed"),
        (lambda: reference.line((0, 0), 0.0, np.nan, 10.0), "finite"),
        (lambda: reference.spline([[0, 0]], 0.3), "two or more"),
        (lambda: reference.spline([[0, 0], [1, 0], [1, 0]], 0.3), "way-points 1 and 2 coincide"),
        (lambda: reference.spline([[0, 0], [np.inf, 0]], 0.3), "finite"),
        (lambda: curves.SpeedProfile([0, 1, 1], [0, 1, 0]), "increase"),
        (lambda: curves.SpeedProfile([1, 2], [1, 1]), "start at 0"),
        (lambda: reference.Along(curves.SplineCurve(WAYPOINTS), curves.SpeedProfile([0, 99], [1, 1])), "curve from 0"),
        (lambda: reference.spline([[0, 0], [0, 1], [0, 0]], 0.3), "turns back on itself"),
        (lambda: reference.Recorded(TIMES, np.where(TIMES[:, None] < 10, [[0.0, 0.0]], [[5.0, 0.0]])), "jumps by 5 m"),
        (lambda: reference.Recorded(TIMES, np.zeros((41, 2))), "never moves"),
        (lambda: reference.Recorded(TIMES[::-1], np.zeros((41, 2))), "increase"),
        (lambda: reference.Recorded(TIMES[:3], np.zeros((3, 2))), "6 or more"),
    ],
)
def test_bad_references_say_what_is_wrong(make: object, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        make()  # type: ignore[operator]
