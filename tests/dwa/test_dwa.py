"""The dynamic window: known arcs, reference implementations, safety properties, bad input."""

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from fuzzynav import dwa
from fuzzynav.control import Observation
from fuzzynav.dwa import contact as dwa_contact
from fuzzynav.dwa import kernels
from fuzzynav.dwa.decision import Params
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import THESIS, TURTLEBOT2, move, reachable

speeds = st.floats(0.0, 1.0)
turns = st.floats(-0.35, 0.35)


def seen(points=(), *, pose=(0, 0, 0), velocity=(0, 0), goal=(10, 0), **scan) -> Observation:
    pts = np.asarray(points, dtype=float).reshape(-1, 2)
    return Observation(
        time=0.0,
        pose=np.array(pose, float),
        velocity=np.array(velocity, float),
        points=pts,
        goal=np.array(goal, float),
        **scan,
    )


def stepped(pose, sample, points, radius, ds=0.0005, far=8.0):
    """First contact found by walking the arc in small strides."""
    v, omega = sample
    way = np.arange(0.0, far, ds)
    track = move(pose, (np.sign(v), omega / abs(v)), way)[:, None, :2]
    touch = np.flatnonzero(np.linalg.norm(track - points, axis=-1).min(axis=1) <= radius)
    return way[touch[0]] if touch.size else np.inf


# --- known answers --------------------------------------------------------------------------------


def test_straight_contact_is_the_gap() -> None:
    assert dwa.free_distance([0, 0, 0], [[0.5, 0.0]], [[2.0, 0.0]], 0.3)[0] == pytest.approx(1.7, abs=1e-12)
    assert dwa.free_distance([0, 0, 0], [[0.5, 0.0]], [[2.0, 0.31]], 0.3)[0] == np.inf
    assert dwa.free_distance([0, 0, 0], [[-0.5, 0.0]], [[2.0, 0.0]], 0.3)[0] == np.inf
    assert dwa.free_distance([0, 0, 0], [[-0.5, 0.0]], [[-2.0, 0.0]], 0.3)[0] == pytest.approx(1.7, abs=1e-12)


def test_circle_contact_is_known() -> None:
    """On a circle of radius 1 a point of its rim half-way round is met 2 asin(R/2) before it."""
    free = dwa.free_distance([0, 0, 0], [[0.5, 0.5]], [[0.0, 2.0]], 0.3)[0]
    assert free == pytest.approx(np.pi - 2 * np.arcsin(0.15), abs=1e-12)
    late = dwa.free_distance([0, 0, 0], [[0.5, 0.5]], [[-1.0, 1.0]], 0.3)[0]
    assert late == pytest.approx(1.5 * np.pi - 2 * np.arcsin(0.15), abs=1e-12)


def test_contact_on_nearly_straight_arcs_is_continuous() -> None:
    straight = dwa.free_distance([0, 0, 0], [[0.5, 0.0]], [[2.0, 0.1]], 0.3)[0]
    bent = dwa.free_distance([0, 0, 0], [[0.5, w] for w in (1e-14, 1e-11, 1e-9)], [[2.0, 0.1]], 0.3)
    np.testing.assert_allclose(bent, straight, atol=1e-8)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6))
def test_contact_agrees_with_walking_the_arc(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-3, 3, (6, 2))
    points = points[np.hypot(*points.T) > 0.35]
    if not len(points):
        return
    sample = (rng.choice([-1, 1]) * rng.uniform(0.1, 1), rng.uniform(-1.5, 1.5))
    slow = stepped(np.zeros(3), sample, points, 0.3, far=min(8.0, 2 * np.pi * abs(sample[0] / sample[1])))
    fast = dwa.free_distance([0, 0, 0], [sample], points, 0.3)[0]
    if np.isfinite(slow):
        assert fast == pytest.approx(slow, abs=2e-3)  # the walk notices a contact one stride late at most
    else:
        # a graze shorter than a stride may be missed by the walk, never by the closed form
        x, y, _ = move(np.zeros(3), (np.sign(sample[0]), sample[1] / abs(sample[0])), fast if np.isfinite(fast) else 0)
        assert not np.isfinite(fast) or fast >= 8.0 or np.hypot(*(points - (x, y)).T).min() <= 0.3 + 1e-9


def test_stopping_distance_is_the_sum_of_the_steps() -> None:
    v, total = 0.93, 0.0
    while v > 0:
        total += v * 0.1
        v = dwa.brake([v, 0.0], THESIS, 0.1)[0]
    assert dwa.stopping_distance([[0.93, 0.0]], THESIS, 0.1)[0] == pytest.approx(total, abs=1e-12)
    assert dwa.stopping_distance([[1.0, 0.0]], THESIS, 0.1)[0] == pytest.approx(1.0 / 0.4 + 0.05, abs=1e-12)


@settings(deadline=None)
@given(speeds, turns)
def test_braking_stays_on_the_arc_and_inside_the_limits(v: float, omega: float) -> None:
    state = np.array([v, omega])
    for _ in range(3000):
        low, high = reachable(state, THESIS, 0.1)
        after = dwa.brake(state, THESIS, 0.1)
        assert (after >= low - 1e-12).all()
        assert (after <= high + 1e-12).all()
        if abs(after[0]) > 1e-9:
            assert after[1] / after[0] == pytest.approx(state[1] / state[0], rel=1e-6, abs=1e-9)
        state = after
        if not state.any():
            return
    raise AssertionError("it never stops")


@settings(max_examples=50, deadline=None)
@given(st.floats(0.3, 4.0), speeds, turns)
def test_an_admissible_sample_stops_before_the_wall(gap: float, v: float, omega: float) -> None:
    """The braking distance is respected to 1e-9: what is admissible stops in time, a hair more does not."""
    point = move(np.zeros(3), (1.0, omega / max(v, 1e-3)), gap + 0.3)[None, :2]
    free = dwa.free_distance([0, 0, 0], [[v, omega]], point, 0.3)
    assume(np.hypot(*point[0]) > 0.3)
    if not dwa.admissible([[v, omega]], free, THESIS, 0.1)[0]:
        return
    pose, state = np.zeros(3), np.array([v, omega])
    while state[0] > 0:
        pose = move(pose, state, 0.1)
        state = dwa.brake(state, THESIS, 0.1)
    assert np.hypot(*(point[0] - pose[:2])) >= 0.3 - 1e-9


# --- the window -----------------------------------------------------------------------------------


@settings(deadline=None)
@given(speeds, turns)
def test_window_holds_both_ends_zero_and_the_emergency(v: float, omega: float) -> None:
    samples = dwa.window([v, omega], THESIS)
    low, high = reachable([v, omega], THESIS, 0.1)
    assert samples[:, 0].max() == pytest.approx(min(high[0], 1.0), abs=1e-12)
    assert samples[:, 0].min() == pytest.approx(max(low[0], 0.0), abs=1e-12)
    assert samples[:, 1].max() == pytest.approx(min(high[1], 0.35), abs=1e-12)
    assert samples[:, 1].min() == pytest.approx(max(low[1], -0.35), abs=1e-12)
    if low[1] < 0 < high[1]:
        assert (samples[:, 1] == 0.0).any()
    np.testing.assert_allclose(samples[-1], dwa.brake([v, omega], THESIS, 0.1), atol=1e-15)
    steps = np.diff(np.unique(samples[:-1, 1]))
    assert steps.max(initial=0.0) <= 0.017 + 1e-12


def test_window_of_a_robot_that_reverses_holds_zero() -> None:
    samples = dwa.window([0.05, 0.0], TURTLEBOT2)
    assert samples[:, 0].min() < 0 < samples[:, 0].max()
    assert (samples[:, 0] == 0.0).any()


def test_window_as_printed_never_starts() -> None:
    """Errata T31: steps of 0.1 m/s through a window 0.02 m/s wide leave its lower end, 0."""
    printed = Params(v_resolution=0.1, sampling="as_printed")
    velocity = np.zeros(2)
    for _ in range(20):
        velocity = dwa.plan(seen(velocity=velocity), THESIS, printed).command
    assert velocity[0] == 0.0
    closed = Params(v_resolution=0.1)
    for _ in range(60):
        velocity = dwa.plan(seen(velocity=velocity), THESIS, closed).command
    assert velocity[0] == 1.0


def test_top_speed_is_reached_exactly() -> None:
    velocity = np.zeros(2)
    for _ in range(60):
        velocity = dwa.plan(seen(velocity=velocity, goal=(1000, 0)), THESIS).command
    assert velocity[0] == 1.0
    assert velocity[1] == 0.0


def test_mirrored_world_mirrored_plan() -> None:
    rng = np.random.default_rng(5)
    for _ in range(50):
        points, goal = rng.uniform(-4, 4, (12, 2)), rng.uniform(-8, 8, 2)
        points = points[np.hypot(*points.T) > 0.4]
        v, omega = rng.uniform(0, 1), rng.uniform(-0.35, 0.35)
        a = dwa.plan(seen(points, velocity=(v, omega), goal=goal), THESIS)
        b = dwa.plan(seen(points * (1, -1), velocity=(v, -omega), goal=goal * (1, -1)), THESIS)
        np.testing.assert_allclose(b.command, a.command * (1, -1), atol=1e-12)


# --- the plan -------------------------------------------------------------------------------------


def reference(observation, params):
    """The plan by the open steps of dwa_steps, one for each equation."""
    pose, velocity = observation.pose, observation.velocity
    samples = dwa.window(velocity, THESIS, params)
    free = dwa.free_distance(pose, samples, observation.points, THESIS.radius)
    ok = dwa.admissible(samples, free, THESIS, params.dt)
    free = np.where(np.abs(samples[:, 0]) <= 1e-9, dwa.nearest_of(observation, THESIS), free)
    raw = np.stack(
        [
            dwa.heading_score(pose, samples, observation.goal, params.sim_time),
            dwa.distance_score(free, params.d_max),
            dwa.speed_score(samples),
        ],
        axis=-1,
    )
    shares = np.zeros_like(raw)
    shares[ok] = dwa.normalise(raw[ok])
    return samples, ok, raw, shares, np.where(ok, dwa.objective(shares, params.weights), np.nan)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), speeds, turns)
def test_kernel_and_open_steps_agree(seed: int, v: float, omega: float) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-4, 4, (rng.integers(0, 40), 2))
    points = points[np.hypot(*points.T) > 0.3]
    params = Params(weights=tuple(rng.uniform(0, 1, 3)))
    observation = seen(points, velocity=(v, omega), goal=rng.uniform(-9, 9, 2))
    made = dwa.plan(observation, THESIS, params)
    samples, ok, raw, shares, totals = reference(observation, params)
    np.testing.assert_array_equal(made.samples, samples)
    np.testing.assert_array_equal(made.admissible, ok)
    np.testing.assert_allclose(made.raw, raw, atol=1e-9)
    np.testing.assert_allclose(made.scores, shares, atol=1e-12)
    np.testing.assert_allclose(made.totals, totals, atol=1e-12)
    if ok.any():
        assert totals[made.chosen] >= np.nanmax(totals) - 1e-9
        assert not made.braking


def test_obstacle_inside_the_braking_distance_lowers_the_speed() -> None:
    made = dwa.plan(seen([[1.5, 0.0]], velocity=(1.0, 0.0)), THESIS)
    assert made.command[0] < 1.0
    assert made.braking or made.admissible[made.chosen]


def test_nothing_admissible_brakes_on_the_same_arc() -> None:
    ring = np.array([[np.cos(a), np.sin(a)] for a in np.linspace(-np.pi, np.pi, 90)]) * 0.5
    made = dwa.plan(seen(ring, velocity=(0.8, 0.2)), THESIS)
    assert made.braking
    assert not made.admissible.any()
    assert made.command[0] == pytest.approx(0.78)
    assert made.command[1] / made.command[0] == pytest.approx(0.25)
    assert np.isnan(made.totals).all()
    assert set(made.reasons) == {kernels.NO_STOP}


def test_obstacle_inside_the_robot_stops_it() -> None:
    made = dwa.plan(seen([[0.1, 0.0]], velocity=(0.5, 0.0)), THESIS)
    assert made.braking
    assert made.command[0] == pytest.approx(0.48)
    rest = dwa.plan(seen([[0.1, 0.0]]), THESIS)
    assert rest.command[0] == 0.0


def test_printed_bound_lets_the_robot_run_into_a_wall() -> None:
    """Errata T35: 0.5 m before a wall point, v = 1 passes the printed bound, though stopping takes 2.5 m."""
    sample, point = np.array([[1.0, 0.0]]), [[0.5, 0.0]]
    end = dwa.end_clearance([0, 0, 0], sample, point, 0.0, 3.0)
    assert end[0] == pytest.approx(2.5)
    assert dwa.admissible_as_printed(sample, end, THESIS)[0]
    assert not dwa.admissible(sample, dwa.free_distance([0, 0, 0], sample, point, 0.0), THESIS, 0.1)[0]
    slim, observation = replace(THESIS, radius=0.1), seen([[0.3, 0.0]], velocity=(0.98, 0.0))
    assert dwa.plan(observation, slim, Params(bound="as_printed", distance="end")).command[0] > 0.98
    assert dwa.plan(observation, slim).command[0] < 0.98


def test_printed_turn_bound_spares_right_turns() -> None:
    """Errata T34: no absolute value in the printed bound."""
    samples = np.array([[0.1, 0.35], [0.1, -0.35]])
    assert dwa.admissible_as_printed(samples, [0.05, 0.05], THESIS).tolist() == [False, True]


def test_step_as_printed_runs_along_the_diagonal() -> None:
    """Errata T32."""
    np.testing.assert_allclose(dwa.step([0, 0, 0], [1, 0], 0.0, 1.0), [1, 0, 0])
    np.testing.assert_allclose(dwa.step_as_printed([0, 0, 0], [1, 0], 0.0, 1.0), [1, 1, 0])


def test_scores_are_shares_and_guard_the_zero_sum() -> None:
    """Errata T38."""
    np.testing.assert_allclose(dwa.normalise([180, 170, 160, 150, 140]), [0.225, 0.2125, 0.2, 0.1875, 0.175])
    assert (dwa.normalise([0.0, 0.0]) == 0.0).all()
    made = dwa.plan(seen([]), THESIS)
    np.testing.assert_allclose(made.scores[made.admissible].sum(axis=0), [1, 1, 1], atol=1e-12)


def test_every_parameter_has_an_effect() -> None:
    points = np.array([[1.5, 0.2], [1.9, -0.4], [0.9, -0.8]])
    angles = np.linspace(-np.pi, np.pi, 8, endpoint=False)
    observation = seen(points, velocity=(0.6, 0.1), goal=(4, 2), ranges=np.full(8, 3.0), angles=angles, range_max=3.0)
    base, seeing = Params(blind=False), Params(thinnest=1.5)
    other = {
        "weights": (0.1, 0.1, 0.8),
        "sim_time": 1.0,
        "dt": 0.2,
        "v_resolution": 0.02,
        "omega_resolution": 0.05,
        "d_max": 1.0,
        "margin": 0.4,
        "reaction": 1.0,
        "distance": "end",
        "bound": "as_printed",
        "sampling": "as_printed",
        "blind": True,
        "thinnest": 1.0,
        "footprint": ((0.4, -0.3), (0.4, 0.3), (-0.4, 0.3), (-0.4, -0.3)),
    }
    assert set(other) == {f.name for f in fields(Params)}
    for name, value in other.items():
        first = seeing if name == "thinnest" else base
        before = dwa.plan(observation, THESIS, first)
        after = dwa.plan(observation, THESIS, replace(first, **{name: value}))
        same = before.samples.shape == after.samples.shape and all(
            np.array_equal(getattr(before, f), getattr(after, f), equal_nan=True)
            for f in ("samples", "totals", "reasons", "free", "known")
        )
        assert not same, f"{name} changes nothing"


def test_lengths_and_times_scale() -> None:
    """Twice the lengths at twice the times: the same decision."""
    points, goal = np.array([[1.2, 0.5], [1.9, -0.4]]), np.array([4.0, 2.0])
    big = replace(THESIS, radius=0.6, max_vel_theta=0.175, acc_lim_x=0.1, dec_lim_x=0.1, acc_lim_theta=0.87 / 4)
    scaled = Params(sim_time=6.0, dt=0.2, omega_resolution=0.0085, d_max=4.0)
    a = dwa.plan(seen(points, velocity=(0.45, 0.1), goal=goal), THESIS)
    b = dwa.plan(seen(2 * points, velocity=(0.45, 0.05), goal=2 * goal), big, scaled)
    np.testing.assert_allclose(b.command, a.command * (1, 0.5), atol=1e-12)


# --- other shapes of obstacles and robots -----------------------------------------------------------


def test_field_and_points_agree() -> None:
    occupied = np.zeros((80, 80), dtype=bool)
    occupied[38:42, 60:64] = True
    grid = GridMap(occupied, 0.1)
    field = dwa.Field.of(grid, 0.02)
    edge = np.array([[6.0 + 0.02 * i, 3.8 + 0.02 * j] for i in range(21) for j in range(21)])
    pose = np.array([4.5, 4.0, 0.0])
    points = dwa.plan(seen(edge, pose=pose, velocity=(0.5, 0.1), goal=(7, 6)), THESIS)
    map_ = dwa.plan(seen([], pose=pose, velocity=(0.5, 0.1), goal=(7, 6)), THESIS, field=field)
    near = points.free < 2.0
    assert near.any()
    assert (map_.free[near] <= points.free[near] + 1e-9).all()  # from below
    np.testing.assert_allclose(map_.free[near], points.free[near], atol=0.08)
    assert map_.nearest == pytest.approx(points.nearest, abs=0.03)


def test_square_footprint_fits_where_its_disc_does_not() -> None:
    square = ((0.2, -0.2), (0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2))
    walls = np.array([[x, side * 0.25] for x in np.linspace(-1, 3, 81) for side in (-1, 1)])
    disc = replace(THESIS, radius=0.283)
    blocked = dwa.plan(seen(walls, velocity=(0.3, 0.0)), disc)
    free = dwa.plan(seen(walls, velocity=(0.3, 0.0)), disc, Params(footprint=square))
    assert blocked.braking
    assert not free.braking
    assert free.command[0] > 0.3


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_polygon_with_many_corners_is_the_disc(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angles = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    corners = 0.3 * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    points = rng.uniform(-2, 2, (4, 2))
    points = points[np.hypot(*points.T) > 0.35]
    near, _ = dwa_contact.near_points(np.zeros(3), points, np.zeros(len(points)), 0.3, np.inf)
    v, omega = rng.choice([-1, 1]) * rng.uniform(0.1, 1), rng.choice([0.0, 1.0]) * rng.uniform(-1, 1)
    disc, polygon = dwa_contact.arc_contact(v, omega, near), dwa_contact.polygon_contact(v, omega, near, corners)
    if np.isfinite(disc) and np.isfinite(polygon):
        assert polygon == pytest.approx(disc, abs=0.02)


def test_footprint_turning_in_place_stops_before_its_corner_touches() -> None:
    bar = ((0.5, -0.1), (0.5, 0.1), (-0.5, 0.1), (-0.5, -0.1))
    params = Params(footprint=bar)
    hit = dwa.plan(seen([[0.4, 0.12]], velocity=(0.0, 0.3), goal=(0, 5)), THESIS, params)
    turning = (hit.samples[:, 0] == 0.0) & (hit.samples[:, 1] > 0.25)
    assert turning.any()
    assert set(hit.reasons[turning]) == {kernels.NO_TURN_STOP}


# --- what no beam has crossed -----------------------------------------------------------------------


def test_blind_spots_cover_the_shadow_behind_an_edge() -> None:
    angles = np.linspace(-np.pi, np.pi, 720, endpoint=False)
    ranges = np.where(np.abs(angles) < 0.2, 1.0, np.inf)
    border, radii = dwa.blind_spots(seen(ranges=ranges, angles=angles, range_max=4.0), THESIS)
    for bearing in (-0.2, 0.2):
        for r in np.arange(1.05, 4.0, 0.1):
            gaps = np.hypot(*(border - r * np.array([np.cos(bearing), np.sin(bearing)])).T) - radii
            assert gaps.min() < 0.02, f"the line of sight is open at {r} m"
    inside = np.hypot(*(border - np.array([2.0, 1.5])).T) - radii
    assert inside.min() > 0.3  # what the beams crossed stays free


def test_robot_does_not_outrun_its_sight() -> None:
    """Nothing in sight, but sight ends at 1.5 m: the speed stays below what stops within it."""
    angles = np.linspace(-np.pi, np.pi, 720, endpoint=False)
    velocity, scan = np.zeros(2), {"ranges": np.full(720, np.inf), "angles": angles, "range_max": 1.5}
    for _ in range(80):
        velocity = dwa.plan(seen(velocity=velocity, goal=(100, 0), **scan), THESIS).command
    need = dwa.stopping_distance([velocity], THESIS, 0.1)[0]
    assert 0.9 < need <= 1.5 - 0.3
    blind = Params(blind=False)
    for _ in range(80):
        velocity = dwa.plan(seen(velocity=velocity, goal=(100, 0), **scan), THESIS, blind).command
    assert velocity[0] == 1.0


def test_nan_and_inf_ranges_are_no_obstacles_but_no_licence() -> None:
    angles = np.linspace(-np.pi, np.pi, 360, endpoint=False)
    ranges = np.full(360, np.inf)
    ranges[170:190] = np.nan
    border, radii = dwa.blind_spots(seen(ranges=ranges, angles=angles, range_max=5.0), THESIS)
    assert np.isfinite(border).all()
    assert np.isfinite(radii).all()
    assert (radii >= 0).all()
    empty = dwa.blind_spots(seen(ranges=np.full(360, np.nan), angles=angles, range_max=5.0), THESIS)
    assert np.hypot(*empty[0].T) == pytest.approx(THESIS.radius, abs=0.002)  # unseen ground begins at its own rim


# --- bad input --------------------------------------------------------------------------------------


@pytest.mark.parametrize("wrong", [
    {"weights": (0, 0, 0)}, {"weights": (-1, 1, 1)}, {"weights": (1, 1)}, {"weights": (np.nan, 1, 1)}, {"dt": 0.0},
    {"sim_time": 0.05}, {"d_max": -1.0}, {"v_resolution": 0.0}, {"margin": -0.1}, {"distance": "ends"},
    {"footprint": ((0, 0), (1, 0), (1, 1))}, {"omega_resolution": np.inf},
])  # fmt: skip
def test_bad_parameters_are_refused(wrong: dict) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong)).split("_")[0]):
        Params(**wrong)


def test_goal_reached_or_behind_gives_finite_scores() -> None:
    for goal in ((0, 0), (-5, 0)):
        made = dwa.plan(seen([], goal=goal), THESIS)
        assert np.isfinite(made.raw).all()
        assert made.chosen >= 0


# --- what small changes of the kernels would break ----------------------------------------------------


def test_admissible_includes_the_exact_stop() -> None:
    need = dwa.stopping_distance([[0.5, 0.0]], THESIS, 0.1)
    assert dwa.admissible([[0.5, 0.0]], need, THESIS, 0.1)[0]
    assert not dwa.admissible([[0.5, 0.0]], need - 1e-9, THESIS, 0.1)[0]


def test_end_clearance_is_never_negative() -> None:
    assert dwa.end_clearance([0, 0, 0], [[1.0, 0.0]], [[3.0, 0.0]], 0.3, 3.0)[0] == 0.0


def test_whole_steps_of_braking_end_with_the_last() -> None:
    """From v = 3 drops: 3 + 2 + 1 drops, each for dt; a step of 0 is not driven."""
    for steps in (1, 2, 5):
        assert dwa.stopping_distance([[0.02 * steps, 0.0]], THESIS, 0.1)[0] == pytest.approx(
            0.1 * 0.02 * steps * (steps + 1) / 2, abs=1e-12
        )


def test_slow_turning_acceleration_needs_a_longer_look() -> None:
    """Where stopping the turn takes longer than stopping the way, obstacles beyond v^2/2a still count."""
    robot = replace(THESIS, acc_lim_x=2.0, dec_lim_x=2.0, acc_lim_theta=0.05)
    params = Params(d_max=0.1)
    wall = move(np.zeros(3), (1.0, 0.3), 2.0)[None, :2]
    made = dwa.plan(seen(wall, velocity=(1.0, 0.3)), robot, params)
    bent = (made.samples[:, 0] > 0.99) & (made.samples[:, 1] > 0.29)
    assert bent.any()
    assert set(made.reasons[bent]) == {kernels.NO_STOP}


@pytest.mark.parametrize(("right", "left"), [(300, 100), (100, 300)])
def test_a_jump_takes_the_wider_of_two_gaps(right: int, left: int) -> None:
    angles = np.concatenate([np.linspace(-np.pi, 0.0, right, False), np.linspace(0.0, np.pi, left, False)])
    ranges = np.full(400, 1.5)
    border, radii = dwa.blind_spots(seen(ranges=ranges, angles=angles, range_max=4.0), THESIS)
    at = np.flatnonzero(np.hypot(*(border - (1.5, 0.0)).T) < 1e-9)
    assert radii[at].max() == pytest.approx(1.5 * np.pi / 100)


def test_march_through_a_field_goes_all_the_way_round() -> None:
    """The obstacle lies three quarters along the circle."""
    occupied = np.zeros((100, 100), dtype=bool)
    occupied[69:71, 39:41] = True  # around (-1, 1) of the robot's frame, on its circle of radius 1
    field = dwa.Field.of(GridMap(occupied, 0.1, (-5.0, -6.0)), 0.02)
    slow = replace(THESIS, max_vel_theta=2.0, acc_lim_theta=30.0)
    made = dwa.plan(seen([], velocity=(0.5, 0.5), goal=(0, 1)), slow, Params(d_max=7.0), field=field)
    k = np.argmin(np.abs(made.samples - (0.5, 0.5)).sum(axis=1))
    assert np.pi < made.free[k] < 2 * np.pi
