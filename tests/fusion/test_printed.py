"""The fusion as printed: what it chooses, what it takes for moving, and where its end points mislead it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav import simulate
from fuzzynav.control import Observation
from fuzzynav.dwa.steps import TABLE_4_1, brake, stopping_distance
from fuzzynav.fusion.printed import PRINTED, Printed, PrintedParams, told_apart
from fuzzynav.robot import THESIS, TURTLEBOT2, respects_limits
from fuzzynav.world import Mover, World

PATH = [[1.0, 1.0], [5.0, 1.0], [9.0, 4.0]]
EMPTY = World(bounds=(0.0, 25.0, 0.0, 18.0))


def seen(points: list = (), velocity: tuple = (0.5, 0.0), speeds: list | None = None) -> Observation:
    return Observation(
        time=0.0,
        pose=np.zeros(3),
        velocity=np.array(velocity),
        goal=np.array([9.0, 4.0]),
        points=np.array(points, dtype=float).reshape(-1, 2),
        point_velocities=None if speeds is None else np.array(speeds, dtype=float),
    )


def decision(observation: Observation, params: PrintedParams = PRINTED, ideal: bool = False, path: object = PATH):
    controller = Printed(THESIS, path, params, ideal=ideal, keep=True)
    controller(observation)
    return controller.plans[-1]


def test_it_follows_its_sub_goals_in_their_order() -> None:
    controller = Printed(THESIS, [[2.0, 9.0], [8.0, 10.0], [15.0, 8.0], [22.0, 9.0]], keep=True)
    run = simulate.run(EMPTY, THESIS, controller, [2.0, 9.0, 0.1], [22.0, 9.0])
    assert run.success
    assert respects_limits(run.commands, 0.1, THESIS)
    assert len(controller.plans) == run.iterations
    np.testing.assert_array_equal(np.unique(run.log["subgoal"]), [0, 1, 2])
    assert (np.diff(run.log["subgoal"]) >= 0).all()
    switch = int(np.argmax(run.log["subgoal"] > 0))
    assert np.hypot(*(run.poses[switch, :2] - controller.path[1])) <= PRINTED.switch
    assert np.hypot(*(run.poses[switch - 1, :2] - controller.path[1])) > PRINTED.switch


def test_every_command_is_the_best_admissible_sample() -> None:
    made = decision(seen([[2.2, 0.3], [3.0, -1.0]]))
    assert 0 < made.admissible.sum() < len(made.samples)
    assert made.admissible[made.chosen]
    assert made.totals[made.chosen] == pytest.approx(np.nanmax(made.totals))
    assert np.isnan(made.totals[~made.admissible]).all()
    np.testing.assert_array_equal(made.command, made.samples[made.chosen])


def test_the_end_point_lets_it_drive_at_a_wall() -> None:
    """Errata T35: 0.2 m before a post at 0.8 m/s, where stopping takes 1.6 m, it does not even slow down."""
    made = decision(seen([[0.5, 0.0]], velocity=(0.8, 0.0)), path=[[0, 0], [9, 0]])
    assert stopping_distance([[0.8, 0.0]], THESIS, 0.1)[0] > 1.6
    assert made.admissible[np.argmin(np.hypot(*(made.samples - (0.8, 0.0)).T))]
    assert made.command[0] >= 0.8


def test_what_moves_is_known_by_its_velocity_in_ideal_tasks_only() -> None:
    points, speeds = [[2.0, 0.0], [0.0, 2.0], [-1.0, 0.0]], [[0.0, 0.0], [0.0, -0.3], [0.0, 0.0]]
    standing, moving = told_apart(seen(points, speeds=speeds))
    assert standing.tolist() == [[2.0, 0.0], [-1.0, 0.0]]
    assert moving.tolist() == [[0.0, 2.0]]
    for unknown in (told_apart(seen(points, speeds=speeds), ideal=False), told_apart(seen(points))):
        assert [len(part) for part in unknown] == [3, 0]


def test_delta_weighs_only_what_moves() -> None:
    """A mover on the left: the more delta, the further right the choice; without velocities delta changes nothing."""
    where, speeds = [[1.6, 1.2]], [[0.0, 0.2]]
    bold, shy = (PrintedParams(weights=(0.5, 0.0, 0.1, delta)) for delta in (0.0, 2.0))
    chosen = {
        ideal: [decision(seen(where, speeds=speeds), p, ideal, [[0, 0], [9, 0]]).command for p in (bold, shy)]
        for ideal in (True, False)
    }
    assert chosen[True][1][1] < chosen[True][0][1] - 0.01
    np.testing.assert_array_equal(chosen[False][0], chosen[False][1])


@given(st.floats(0.0, 1.0), st.floats(-0.35, 0.35), st.integers(0, 10_000))
def test_every_command_can_be_reached_in_one_step(v: float, omega: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    made = decision(seen(rng.uniform(-3, 3, (30, 2)), velocity=(v, omega)))
    assert abs(made.command[0] - v) <= THESIS.acc_lim_x * 0.1 + 1e-9
    assert abs(made.command[1] - omega) <= THESIS.acc_lim_theta * 0.1 + 1e-9
    if made.braking:
        np.testing.assert_allclose(made.command, brake((v, omega), THESIS, 0.1))


@given(st.integers(0, 10_000))
def test_the_mirrored_scene_gives_the_mirrored_command(seed: int) -> None:
    """Where two samples are equally good the order of the window decides, so the goal stands aside."""
    points = np.random.default_rng(seed).uniform(-3, 4, (20, 2))
    there, back = (decision(seen(points * (1, s)), path=[[0, 0], [5.0, s * 1.3]]) for s in (1.0, -1.0))
    np.testing.assert_allclose(there.command * (1, -1), back.command, atol=1e-9)


def test_a_fault_brakes_and_a_missing_path_ends_the_run() -> None:
    blind = replace(seen([[2.0, 0.0]]), pose=np.full(3, np.nan))
    made = decision(blind)
    assert made.braking
    assert not made.admissible.any()
    assert made.command[0] == pytest.approx(0.48)
    lost = Printed(THESIS, np.empty((0, 2)))
    run = simulate.run(EMPTY, THESIS, lost, [1.0, 1.0, 0.0], PATH[-1])
    assert run.status == "no_path"


def test_a_reset_forgets_the_run_before() -> None:
    world = World(bounds=(0.0, 12.0, 0.0, 6.0), movers=(Mover.constant((5.0, 4.0), (0.0, -0.2), 0.3),))
    controller = Printed(THESIS, PATH, ideal=True)
    one, two = (simulate.run(world, THESIS, controller, [1.0, 1.0, 0.0], PATH[-1], track_movers=True) for _ in range(2))
    np.testing.assert_array_equal(one.poses, two.poses)
    assert one.log["subgoal"][0] == 0


def test_every_parameter_changes_a_decision() -> None:
    points, speeds = [[5.2, 2.4], [5.0, -0.6]], [[0.0, 0.0], [0.1, 0.1]]
    view = replace(seen(points, speeds=speeds), pose=np.array([3.2, 0.8, 0.1]))
    usual = decision(view, ideal=True)
    for change in (
        {"weights": (0.8, 0.2, 0.3, 0.2)},
        {"window": replace(TABLE_4_1, sim_time=2.0)},
        {"window": replace(TABLE_4_1, d_max=0.5)},
        {"switch": 3.0},
    ):
        other = decision(view, replace(PRINTED, **change), ideal=True)
        assert not np.array_equal(other.totals, usual.totals, equal_nan=True), change
    for bad in ({"weights": (0, 0, 0, 0)}, {"switch": 0.0}):
        with pytest.raises(ValueError, match=r"weights|switch"):
            replace(PRINTED, **bad)
    assert Printed(TURTLEBOT2, PATH).robot is TURTLEBOT2
