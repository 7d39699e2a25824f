"""Points that move: known answers, dense sampling, and plans that can brake before whatever keeps its velocity."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav import dwa, simulate
from fuzzynav.control import Observation
from fuzzynav.dwa.contact import STILL
from fuzzynav.dwa.moving import moving_contact, near_moving
from fuzzynav.robot import THESIS, TURTLEBOT2, limit, move
from fuzzynav.simulate import Loop
from fuzzynav.world import Mover, World

DISC = np.empty((0, 2))
SQUARE = np.array([[-0.3, -0.2], [0.3, -0.2], [0.3, 0.2], [-0.3, 0.2]])
FAR = 1e3
SEEDS = st.integers(0, 2**32)


def meet(v, omega, points, drift, *, corners=DISC, hold=np.inf, loss=0.0, until=FAR, more=0.0, pose=(0, 0, 0)):
    """Time of the first contact of a disc of 0.3 m, or of a footprint."""
    rows = np.array(points, float).reshape(-1, 2), np.array(drift, float).reshape(-1, 2)
    holds = np.hypot(*np.vstack([[[0.3, 0.0]], corners]).T).max()  # the disc that holds the robot
    _, moving, _ = near_moving(np.array(pose, float), *rows, holds, np.inf, np.inf)
    return moving_contact(float(v), float(omega), moving, corners, hold, loss, until, more)


def told(points, drift=None, *, velocity=(0.5, 0.0), goal=(10, 0)) -> Observation:
    return Observation(
        time=0.0,
        pose=np.zeros(3),
        velocity=np.array(velocity, float),
        points=np.array(points, float).reshape(-1, 2),
        point_velocities=None if drift is None else np.array(drift, float).reshape(-1, 2),
        goal=np.array(goal, float),
    )


# --- known answers --------------------------------------------------------------------------------


def test_times_on_a_straight_line_are_known() -> None:
    assert meet(0.5, 0.0, [3, 0], [-0.5, 0]) == pytest.approx(2.7, abs=1e-5)  # head-on
    assert meet(0.2, 0.0, [-2, 0], [1.0, 0]) == pytest.approx(1.7 / 0.8, abs=1e-5)  # overtaken from behind
    assert meet(0.0, 0.0, [-2, 0], [0.5, 0]) == pytest.approx(3.4, abs=1e-5)  # caught up while it stands
    assert meet(-0.5, 0.0, [-3, 0], [0.5, 0]) == pytest.approx(2.7, abs=1e-5)  # backwards
    assert meet(0.5, 0.0, [2, 0], [0.6, 0]) == np.inf  # it drives away
    assert meet(0.5, 0.0, [3, 0], [-0.5, 0], until=2.6) == np.inf  # later than asked for
    assert meet(0.5, 0.0, [0.2, 0], [0.6, 0]) == 0.0  # inside already
    assert meet(0.5, 0.0, [[3, 0], [2, 0], [9, 0]], [[-0.5, 0]] * 3) == pytest.approx(1.7, abs=1e-5)
    assert meet(0.5, 0.0, [1, 3], [0, -0.5], pose=(1, 0, np.pi / 2)) == pytest.approx(2.7, abs=1e-5)


def test_a_crossing_that_falls_between_two_steps_is_met() -> None:
    """At steps of 0.1 s the point is 1 m to the right of the robot, then 1 m to the left."""
    t = np.arange(0.0, 1.0, 0.1)
    assert np.hypot(1 - 2 * t, -9 + 20 * t).min() > 0.9
    roots = np.roots([404.0, -364.0, 82.0 - 0.09])  # (1 - 2 t)^2 + (20 t - 9)^2 = 0.3^2
    assert meet(2.0, 0.0, [1, -9], [0, 20]) == pytest.approx(roots.min(), abs=1e-6)


def test_a_point_that_keeps_its_place_on_a_circle_is_met_on_the_circle() -> None:
    """On a circle of radius 1 a point that hardly moves is met where the closed form says."""
    still = dwa.free_distance([0, 0, 0], [[0.5, 0.5]], [[0.0, 2.0]], 0.3)[0]
    assert meet(0.5, 0.5, [0, 2], [1e-9, 0]) * 0.5 == pytest.approx(still, abs=1e-5)


def test_braking_may_avoid_a_contact_or_cause_one() -> None:
    """Braking at 0.2 from 0.5 m/s takes 2.5 s and 0.625 m; a point at 0.5 m/s comes 1.25 m nearer meanwhile."""
    brake = {"hold": 0.0, "loss": 0.2, "until": 2.5}
    assert meet(0.5, 0.0, [2.18, 0], [-0.5, 0], **brake) == np.inf
    time = meet(0.5, 0.0, [2.1, 0], [-0.5, 0], **brake)
    assert 0.5 * time - 0.1 * time**2 + 0.5 * time == pytest.approx(1.8, abs=1e-5)
    crossing = [1.0, -1.6], [0.0, 1.0]  # meets who drives on and spares who brakes
    assert meet(0.8, 0.0, *crossing) < 2.0
    assert meet(0.8, 0.0, *crossing, hold=0.0, loss=1.0, until=0.8) == np.inf
    late = [0.55, -2.0], [0.0, 1.0]  # the other way round
    assert meet(0.8, 0.0, *late) == np.inf
    assert meet(0.8, 0.0, *late, hold=0.0, loss=0.4, until=2.0) < 2.0


def test_more_room_is_kept_but_never_more_than_there_is() -> None:
    assert meet(0.0, 0.0, [2, 0], [-1, 0], more=0.2) == pytest.approx(1.5, abs=1e-5)
    assert meet(0.0, 0.0, [0.4, 0], [1, 0], more=0.2) == np.inf  # near, and it leaves
    assert meet(0.0, 0.0, [0.4, 0], [-0.1, 0], more=0.2) < 1e-3  # near, and it comes
    for corners in (DISC, SQUARE):
        assert meet(0.5, 0.2, [0.45, 0.0], [0.6, 0.0], corners=corners, until=1.0, more=0.4) == np.inf


# --- against dense sampling -------------------------------------------------------------------------


def gaps(v, omega, row, drift, times, hold, loss, corners):
    """Distance at every time, by walking the arc: way by the trapezoids of the speed, pose by `move`."""
    speed = v * np.clip(1 - loss * np.maximum(times - hold, 0.0) / max(abs(v), 1e-12), 0, 1) if loss else v + 0 * times
    way = np.r_[0.0, np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(times))]
    at = move([0, 0, 0], (v, omega), way / v) if v else move([0, 0, 0], (0.0, omega), times)
    apart = row + drift * times[:, None] - at[:, :2]
    if not len(corners):
        return np.hypot(*apart.T) - 0.3
    c, s = np.cos(at[:, 2]), np.sin(at[:, 2])
    inside = np.column_stack([c * apart[:, 0] + s * apart[:, 1], c * apart[:, 1] - s * apart[:, 0]])
    return np.hypot(*np.maximum(np.abs(inside) - SQUARE[2], 0.0).T)


@settings(max_examples=150, deadline=None)
@given(SEEDS, st.booleans(), st.booleans())
def test_contact_agrees_with_dense_sampling(seed: int, brakes: bool, square: bool) -> None:
    rng = np.random.default_rng(seed)
    v, omega, until = rng.uniform(-1, 1), rng.choice([0.0, 1.0]) * rng.uniform(-1.5, 1.5), 4.0
    hold, loss = (rng.uniform(0, 0.5), rng.uniform(0.2, 2.5)) if brakes else (np.inf, 0.0)
    corners = SQUARE if square else DISC
    for _ in range(5):
        row, drift = rng.uniform(-2.5, 2.5, 2), rng.normal(0, 0.7, 2)
        found = meet(v, omega, row, drift, corners=corners, hold=hold, loss=loss, until=until)
        times = np.linspace(0.0, min(found, until), 4001)
        near = gaps(v, omega, row, drift, times, hold, loss, corners)
        assert near[:-1].min() > -1e-5 or found == 0.0
        if found < np.inf and found > 0.0:
            assert -1e-5 < near[-1] < 1e-3  # early where its steps do not settle, never late


@settings(max_examples=60, deadline=None)
@given(SEEDS, st.booleans(), st.booleans())
def test_neighbours_of_one_velocity_are_met_as_if_each_were_alone(seed: int, brakes: bool, square: bool) -> None:
    rng = np.random.default_rng(seed)
    v, omega, around = rng.uniform(-1, 1), rng.uniform(-0.5, 0.5), rng.uniform(0, 2 * np.pi, (3, 9))
    points = rng.uniform(-3, 3, (3, 1, 2)) + 0.4 * np.stack([np.cos(around), np.sin(around)], axis=-1)
    drift = np.repeat(rng.normal(0, 0.6, (3, 2)), 9, axis=0)
    told_to = {"corners": SQUARE if square else DISC, "until": 4.0, "more": 0.05}
    told_to |= {"hold": 0.1, "loss": 0.5} if brakes else {}
    alone = [meet(v, omega, p, d, **told_to) for p, d in zip(points.reshape(-1, 2), drift, strict=True)]
    together = meet(v, omega, points, drift, **told_to)
    if brakes:  # it is asked whether, not when
        assert (together < np.inf) == (min(alone) < np.inf)
    elif min(alone) == np.inf:
        assert together == np.inf
    else:
        assert together == pytest.approx(min(alone), abs=1e-4)


# --- plans ----------------------------------------------------------------------------------------


def test_points_that_stand_give_the_same_plan_to_the_last_bit() -> None:
    points = np.random.default_rng(1).uniform(-3, 3, (60, 2))
    points = points[np.hypot(*points.T) > 0.6]
    plain, zero = dwa.plan(told(points), THESIS), dwa.plan(told(points, 0 * points), THESIS)
    for name in ("samples", "scores", "raw", "totals", "reasons", "free", "known", "command", "nearest"):
        assert np.array_equal(getattr(plain, name), getattr(zero, name), equal_nan=True)


@settings(max_examples=40, deadline=None)
@given(SEEDS)
def test_mirrored_scene_mirrored_plan(seed: int) -> None:
    rng, flip = np.random.default_rng(seed), np.array([1.0, -1.0])
    points, drift = rng.uniform(-4, 4, (12, 2)), rng.normal(0, 0.4, (12, 2))
    drift[:4] = 0.0
    goal, velocity = rng.uniform(-5, 5, 2), np.array([rng.uniform(0, 1), rng.uniform(-0.3, 0.3)])
    one = dwa.plan(told(points, drift, velocity=velocity, goal=goal), THESIS)
    other = dwa.plan(told(points * flip, drift * flip, velocity=velocity * flip, goal=goal * flip), THESIS)
    order = np.lexsort((one.samples[:-1, 1], one.samples[:-1, 0]))
    back = np.lexsort((-other.samples[:-1, 1], other.samples[:-1, 0]))
    np.testing.assert_allclose(one.samples[order], other.samples[back] * flip, atol=1e-12)
    np.testing.assert_allclose(one.free[order], other.free[back], atol=1e-5)
    np.testing.assert_array_equal(one.reasons[order], other.reasons[back])
    np.testing.assert_allclose(one.command, other.command * flip, atol=1e-9)


@settings(max_examples=60, deadline=None)
@given(SEEDS, st.sampled_from([THESIS, TURTLEBOT2]))
def test_who_drives_an_admissible_sample_can_brake_before_all_that_keeps_its_velocity(seed: int, robot) -> None:
    rng, params = np.random.default_rng(seed), dwa.Params(margin=0.02)
    points, drift = rng.uniform(-2.5, 2.5, (10, 2)), rng.normal(0, 0.5, (10, 2))
    keep = np.hypot(*points.T) > robot.radius + 0.05
    points, drift = points[keep], drift[keep]
    velocity = np.array([rng.uniform(0, robot.max_vel_x), rng.uniform(-0.3, 0.3)])
    made = dwa.plan(told(points, drift, velocity=velocity), robot, params)
    chosen = made.samples[made.admissible]
    for sample in chosen[:: max(len(chosen) // 8, 1)]:
        pose, command, time = np.zeros(3), sample, 0.0
        while abs(command[0]) > STILL:
            for share in np.linspace(0.0, 1.0, 11):
                at = move(pose, command, share * params.dt)[:2]
                apart = np.hypot(*(points + drift * (time + share * params.dt) - at).T)
                assert apart.min(initial=np.inf) >= robot.radius
            pose, time = move(pose, command, params.dt), time + params.dt
            wish = dwa.brake(command, robot, params.dt)
            np.testing.assert_allclose(limit(wish, command, robot, params.dt), wish, atol=1e-12)
            command = wish


def test_who_comes_head_on_is_refused_earlier_and_who_leads_later() -> None:
    ahead = [[1.4, 0.0]]
    stands = dwa.plan(told(ahead), THESIS)
    comes, leads = (dwa.plan(told(ahead, [[u, 0.0]]), THESIS) for u in (-0.5, 0.5))
    straight = np.flatnonzero(np.abs(stands.samples[:-1, 1]) < 1e-12)
    assert stands.admissible[straight].all()
    assert not comes.admissible[straight].any()
    assert leads.admissible[straight].all()
    fast = straight[np.argmax(stands.samples[straight, 0])]
    assert comes.free[fast] == pytest.approx(0.52 / 1.02 * 1.1, abs=1e-5)
    assert stands.free[fast] == pytest.approx(1.1)
    assert leads.free[fast] == np.inf  # 0.02 m/s faster: not within the horizon
    assert comes.nearest == stands.nearest == leads.nearest == pytest.approx(1.1)


def test_standing_scores_nothing_where_it_would_be_struck() -> None:
    for u, clear in ((-0.5, 0.0), (0.5, 1.0)):
        made = dwa.plan(told([[0.0, 1.3]], [[0.0, u]], velocity=(0.0, 0.0)), THESIS)
        still = np.abs(made.samples[:, 0]) < STILL
        assert still.any() and made.admissible[still].all()
        np.testing.assert_allclose(made.raw[still, 1], clear)


def test_the_clearance_at_the_end_is_that_of_then() -> None:
    params = dwa.Params(distance="end", sim_time=2.0)
    made = dwa.plan(told([[1.0, 5.0]], [[0.0, -2.0]], velocity=(0.5, 0.0)), THESIS, params)
    k = np.flatnonzero(np.abs(made.samples - (0.5, 0.0)).max(axis=1) < 1e-9)[0]
    assert made.raw[k, 1] == pytest.approx(1.0 - THESIS.radius)  # (1, 0) against (1, 1)


def test_a_robot_told_the_velocities_touches_nobody_while_it_drives() -> None:
    """Movers that keep their velocity, on open ground: whatever the robot does, it stands before it is touched."""
    kept = dict(t_max=40.0, loop=Loop(stop_at_contact=False))
    params = dwa.Params(margin=0.03, blind=False, sim_time=2.0, v_resolution=0.02, omega_resolution=0.05)
    hits = np.zeros(2, dtype=int)
    for seed in range(6):
        rng = np.random.default_rng(seed)
        start, aim = rng.uniform((3, -4), (14, 4), (6, 2)), rng.uniform((2, -1), (12, 1), (6, 2))
        flown = aim - start
        movers = [
            Mover.constant(p, d / np.hypot(*d) * rng.uniform(0.2, 0.5), 0.3) for p, d in zip(start, flown, strict=True)
        ]
        for k, tracked in enumerate((True, False)):
            controller = dwa.Controller(TURTLEBOT2, params)
            run = simulate.run(
                World(movers=movers), TURTLEBOT2, controller, (0, 0), (16, 0), track_movers=tracked, rng=seed, **kept
            )
            hits[k] += run.contacts_moving
    assert hits[0] == 0 < hits[1]


@pytest.mark.parametrize("drift", [[[0.0, 0.0]], [[0.0, 0.0], [np.nan, 0.0]], [[0.0], [0.0]]])
def test_bad_velocities_are_refused(drift) -> None:
    made = replace(told([[1, 0], [2, 0]]), point_velocities=np.array(drift))
    with pytest.raises(ValueError, match="point_velocities must be 2 finite rows"):
        dwa.plan(made, THESIS)
