"""One decision: what is refused and why, what is preferred, and that the mirrored scene gives the mirrored answer."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav.control import Observation
from fuzzynav.fusion import REASONS, ROBOTS, Params, Surroundings, decide, surroundings
from fuzzynav.fusion.kernels import least_gap
from fuzzynav.fusion.objective import improved_objective
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import move
from fuzzynav.sensors import Laser, laser_ideal
from fuzzynav.world import World

ROBOT = ROBOTS["turtlebot2"]
NONE = np.empty((0, 2))


def told(velocity: tuple[float, float] = (0.0, 0.0), theta: float = 0.0) -> Observation:
    return Observation(
        time=0.0, pose=np.array([0.0, 0.0, theta]), velocity=np.array(velocity), goal=np.array([9.0, 0.0]), points=NONE
    )


def around(points: Any = (), movers: Any = ()) -> Surroundings:
    rows = np.reshape(np.array(movers, dtype=float), (-1, 5))
    return Surroundings(
        points=np.reshape(np.array(points, dtype=float), (-1, 2)), border=NONE, radii=np.empty(0), holes=0,
        hazards=rows[:, [0, 1, 4]].copy(), movers=rows, standing=np.empty(0, dtype=bool),
    )  # fmt: skip


def test_with_nothing_around_it_speeds_up_straight_ahead() -> None:
    made = decide(told(), [9.0, 0.0], around(), ROBOT, Params(), 0.5)
    np.testing.assert_allclose(made.command, [ROBOT.acc_lim_x * 0.1, 0.0], atol=1e-9)
    assert (made.reasons == 0).all()
    assert not made.braking


def test_the_chosen_sample_maximises_the_objective_among_the_eligible() -> None:
    made = decide(
        told((0.4, 0.2)), [4.0, 1.0], around([[3.0, 0.4]], [[2.5, -1.5, 0.0, 0.4, 0.3]]), ROBOT, Params(), 0.5
    )
    kept = made.eligible
    totals = improved_objective(made.raw[kept], Params().weights)
    np.testing.assert_allclose(made.totals[kept], totals, rtol=1e-9)
    assert made.totals[made.chosen] >= totals.max() - 1e-9


@settings(max_examples=60)
@given(turn=st.floats(-3.1, 3.1), vx=st.floats(-0.5, 0.5), vy=st.floats(-0.5, 0.5))
def test_turning_the_world_changes_nothing(turn: float, vx: float, vy: float) -> None:
    """Target, what stands, and movers with their velocities, turned about the robot: the same samples and scores."""
    c, s = np.cos(turn), np.sin(turn)
    spin = np.array([[c, -s], [s, c]])
    points, mover = np.array([[2.0, 0.9], [1.5, -1.2]]), np.array([2.5, 0.4, vx, vy, 0.3])
    turned = np.concatenate([spin @ mover[:2], spin @ mover[2:4], mover[4:]])
    here = decide(told((0.4, 0.1)), [4.0, 1.0], around(points, [mover]), ROBOT, Params(), 0.5)
    there = decide(told((0.4, 0.1), turn), spin @ [4.0, 1.0], around(points @ spin.T, [turned]), ROBOT, Params(), 0.5)
    np.testing.assert_allclose(there.samples, here.samples, atol=1e-12)
    np.testing.assert_allclose(there.raw, here.raw, atol=1e-6)
    same = there.reasons == here.reasons
    assert same.mean() > 0.98  # a sample on the very rim of what is allowed may fall to either side


def test_a_mover_ahead_limits_the_speed_by_what_it_can_reach() -> None:
    gaps = {}
    for away in (0.9, 1.0, 1.2, 2.0):
        made = decide(told((0.4, 0.0)), [9.0, 0.0], around(movers=[[away, 0.0, 0.0, 0.0, 0.3]]), ROBOT, Params(), 0.5)
        fastest = made.samples[made.reasons == 0, 0].max(initial=-1.0)
        gaps[away] = fastest
        assert (made.reasons[(made.samples[:, 0] > fastest + 1e-9)] > 0).all()
    assert gaps[0.9] < gaps[1.2] <= gaps[2.0]
    assert gaps[2.0] == pytest.approx(0.65)


def test_every_reason_has_its_case() -> None:
    wall = decide(told((0.6, 0.0)), [9.0, 0.0], around([[0.35, 0.0]]), ROBOT, Params(), 0.5)
    assert REASONS[int(wall.reasons[-1])] == "cannot stop before contact"
    assert wall.braking
    near = decide(told((0.6, 0.0)), [9.0, 0.0], around(movers=[[0.8, 0.0, 0.0, 0.0, 0.3]]), ROBOT, Params(), 0.5)
    assert REASONS[int(near.reasons[:-1].max())] == "a mover could be there before the robot stands"
    dark = replace(around(), border=np.array([[0.36, 0.0]]), radii=np.array([0.0]))
    unseen = decide(told((0.6, 0.0)), [9.0, 0.0], dark, ROBOT, Params(), 0.5)
    assert "nothing was seen there" in {REASONS[int(k)] for k in unseen.reasons}


def test_guard_prediction_and_reserve_are_switched_off_by_their_values() -> None:
    rows = around(movers=[[0.9, 0.0, -0.5, 0.0, 0.3]])
    whole = decide(told((0.5, 0.0)), [9.0, 0.0], rows, ROBOT, Params(), 0.5)
    trusting = decide(told((0.5, 0.0)), [9.0, 0.0], rows, ROBOT, Params(guard=False), 0.5)
    assert (trusting.reasons == 3).sum() == 0 < (whole.reasons == 3).sum()
    blind = decide(told((0.5, 0.0)), [9.0, 0.0], rows, ROBOT, Params(sim_time=0.0), 0.5)
    assert np.isinf(blind.ways[:, 4]).all()
    assert not np.isinf(whole.ways[:, 4]).all()
    tight = decide(told((0.5, 0.0)), [9.0, 0.0], rows, ROBOT, Params(reserve=0.0), 0.5)
    assert (tight.reasons == 3).sum() < (whole.reasons == 3).sum()


@settings(max_examples=60)
@given(st.data())
def test_the_mirrored_scene_has_the_mirrored_decision(data: st.DataObject) -> None:
    number = st.floats(-3.0, 3.0)
    points = np.array([[data.draw(number), data.draw(number)] for _ in range(3)])
    rows = np.array([[data.draw(number), data.draw(number), data.draw(number), data.draw(number), 0.3]])
    rows[:, 2:4] *= 0.15
    speed, turn = round(data.draw(st.floats(0.0, 0.6)), 3), round(data.draw(st.floats(-1.0, 1.0)), 3)
    target = np.array([4.0, data.draw(number)])
    one = decide(told((speed, turn)), target, around(points, rows), ROBOT, Params(), 0.5)
    flip, wide = np.array([1.0, -1.0]), np.array([1.0, -1.0, 1.0, -1.0, 1.0])
    two = decide(told((speed, -turn)), target * flip, around(points * flip, rows * wide), ROBOT, Params(), 0.5)
    assert one.braking == two.braking
    mirrored = np.array(
        [np.flatnonzero(np.abs(two.samples[:-1] - s * flip).max(axis=1) < 1e-9) for s in one.samples[:-1]]
    )
    np.testing.assert_array_equal(one.reasons[:-1], two.reasons[mirrored[:, 0]])
    if not one.braking:
        assert np.nanmax(one.totals) == pytest.approx(np.nanmax(two.totals))


@settings(max_examples=80)
@given(
    v=st.floats(-0.5, 1.0), omega=st.floats(-1.0, 1.0), x=st.floats(-3, 3), y=st.floats(-3, 3), ux=st.floats(-1, 1),
    uy=st.floats(-1, 1),
)  # fmt: skip
def test_the_least_predicted_gap_agrees_with_dense_sampling(
    v: float, omega: float, x: float, y: float, ux: float, uy: float
) -> None:
    row = np.array([[x, y, ux, uy, 0.6]])
    gap, first = least_gap(v, omega, row, 3.0, 0.2, 0.1)
    times = np.linspace(0.0, 3.0, 3001)
    at = move(np.zeros(3), np.array([v, omega]), times)[:, :2]
    gaps = np.hypot(x + ux * times - at[:, 0], y + uy * times - at[:, 1]) - 0.6
    gaps -= min(0.1, np.hypot(ux, uy)) * times
    if (gaps <= -0.02).any():
        assert first <= times[np.flatnonzero(gaps <= -0.02)[0]] + 0.2
    elif gaps.min() > 0.04:
        assert np.isinf(first)
        assert gap == pytest.approx(gaps.min(), abs=0.04)


def scan_of(world: World, chart: GridMap | None, movers: Array | None) -> tuple[Observation, Surroundings]:
    pose = np.array([2.0, 5.0, 0.3])
    laser = Laser(beams=360, field_of_view=2.0 * np.pi, range_min=0.0, range_max=8.0, noise=0.0)
    scan = laser_ideal(world, pose, laser)
    seen = Observation(
        time=0.0, pose=pose, velocity=np.zeros(2), goal=np.zeros(2), points=scan.world_points(pose), ranges=scan.ranges,
        angles=scan.angles, range_max=8.0, movers=movers,
    )  # fmt: skip
    return seen, surroundings(seen, 0.3, 0.2, chart=chart, tracks=None, tell=0.15)


def test_only_what_the_map_does_not_explain_may_move() -> None:
    cells = np.zeros((10, 10), dtype=bool)
    cells[7, 4] = True
    chart = GridMap(cells)
    seen, found = scan_of(World(grid=chart, discs=[[5.0, 4.0, 0.4]]), chart, None)
    on_disc = np.abs(np.hypot(*(seen.points - [5.0, 4.0]).T) - 0.4) < 1e-6
    assert len(found.hazards) == on_disc.sum() > 5
    np.testing.assert_allclose(found.hazards[:, :2], seen.points[on_disc])
    assert len(found.points) == len(seen.points), "all of it stands in the way"
    np.testing.assert_array_equal(found.standing, on_disc)


def test_what_an_ideal_tracker_tells_is_the_hazard_and_its_hits_do_not_stand() -> None:
    rows = np.array([[5.0, 4.0, 0.1, 0.0, 0.4], [2.0, 9.0, 0.0, 0.0, 0.3]])
    grid = GridMap(np.zeros((10, 10), dtype=bool))
    seen, found = scan_of(World(grid=grid, discs=[[5.0, 4.0, 0.4]]), grid, rows)
    np.testing.assert_allclose(found.hazards, rows[:, [0, 1, 4]])
    assert 0 < len(seen.points) - len(found.points) < 60
    assert np.hypot(*(found.points - [5.0, 4.0]).T).min() > 0.42


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"weights": (1.0, 1.0, 1.0)}, "four"), ({"weights": (-1.0, 1.0, 1.0, 1.0)}, "four"), ({"dt": 0.0}, "dt"),
        ({"reserve": -0.1}, "reserve"), ({"v_samples": 1}, "2 x 3"), ({"aim_time": (2.0, 1.0)}, "aim_time"),
        ({"error": np.nan}, "error"),
    ],
)  # fmt: skip
def test_parameters_refuse_what_cannot_be(given: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Params(**given)
