"""The planners that are compared: each drives, none asks for more than it may, the window stays small for any robot."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav import simulate
from fuzzynav.control import Controller
from fuzzynav.dwa.steps import TABLE_3_3, window
from fuzzynav.fusion.methods import METHODS, SPEEDS, TURNS, PathFollower, fitted_params, path_of
from fuzzynav.fusion.printed import PRINTED, Cured, Printed
from fuzzynav.fusion.subgoals import capped, pruned
from fuzzynav.fusion.task import Task
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning.astar import ENHANCED
from fuzzynav.robot import THESIS, TURTLEBOT2, Robot, respects_limits
from fuzzynav.simulate.record import Run
from fuzzynav.world import World

WALL = GridMap.from_ascii("""
............
............
.....#......
.....#......
.....#......
.....#......
............
............""")
RACER = replace(TURTLEBOT2, acc_lim_x=10.0, dec_lim_x=10.0, acc_lim_theta=20.0, max_vel_x=2.0)
NAMES = [name for name in METHODS if not name.startswith("ours")]


def task(robot: Robot = TURTLEBOT2, chart: GridMap | None = WALL) -> Task:
    return Task(
        name="wall",
        world=World(grid=WALL),
        robot=robot,
        start=np.array([1.5, 4.0, 0.0]),
        goal=np.array([10.5, 4.0]),
        speed_bound=0.0,
        chart=chart,
        t_max=90.0,
    )


def driven(given_task: Task, controller: Controller) -> Run:
    return simulate.run(
        given_task.world,
        given_task.robot,
        controller,
        given_task.start,
        given_task.goal,
        dt=given_task.dt,
        t_max=given_task.t_max,
    )


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("robot", [THESIS, TURTLEBOT2, RACER], ids=lambda r: f"{r.name} {r.acc_lim_x}")
def test_every_planner_drives_any_robot_within_its_limits(name: str, robot: Robot) -> None:
    run = driven(replace(task(robot), t_max=25.0), METHODS[name](task(robot)))
    assert run.length > 1.0
    assert respects_limits(np.vstack([[0.0, 0.0], run.commands]), 0.1, robot)
    if name != "printed":  # whose end points let it drive into walls
        assert run.contacts_moving == 0
        assert run.min_clearance > 0.0


@pytest.mark.parametrize("name", [name for name in NAMES if "A*" in name])
@pytest.mark.parametrize("robot", [THESIS, TURTLEBOT2], ids=lambda r: r.name)
def test_who_follows_a_path_gets_round_the_wall(name: str, robot: Robot) -> None:
    controller = METHODS[name](task(robot))
    run = driven(task(robot), controller)
    assert run.success
    assert (np.diff(run.log["subgoal"]) >= 0).all()
    assert isinstance(controller, PathFollower)
    assert run.log["subgoal"][-1] == len(controller.path) - 2


@pytest.mark.parametrize("name", NAMES)
def test_without_a_map_the_goal_is_the_only_sub_goal(name: str) -> None:
    bare = task(chart=None)
    controller = METHODS[name](bare)
    run = driven(replace(bare, t_max=3.0), controller)
    assert not run.log.get("subgoal", np.zeros(1)).any()
    assert getattr(controller, "path", np.array([bare.start[:2], bare.goal])).tolist() == [[1.5, 4.0], [10.5, 4.0]]


@pytest.mark.parametrize("name", [name for name in NAMES if name != "TDWA" and not name.startswith("ours")])
def test_without_a_path_the_run_ends_as_such(name: str) -> None:
    closed = GridMap(np.array([[x == 4 for x in range(12)]] * 8))
    assert driven(task(), METHODS[name](task(chart=closed))).status == "no_path"


def test_the_second_run_is_the_first_again() -> None:
    for name in NAMES:
        controller = METHODS[name](task())
        one, two = (driven(replace(task(), t_max=8.0), controller) for _ in range(2))
        np.testing.assert_array_equal(one.poses, two.poses)


@given(
    st.floats(0.1, 20.0), st.floats(0.1, 20.0), st.floats(0.1, 30.0), st.floats(0.1, 3.0), st.floats(0.0, 3.0),
    st.floats(0.2, 6.0), st.floats(0.02, 0.5), st.tuples(st.floats(-1, 1), st.floats(-1, 1)),
)  # fmt: skip
def test_a_window_is_never_larger_than_said(
    gain: float, loss: float, spin: float, top: float, back: float, turn: float, dt: float, share: tuple
) -> None:
    robot = replace(
        THESIS, acc_lim_x=gain, dec_lim_x=loss, acc_lim_theta=spin, max_vel_x=top, min_vel_x=-back, max_vel_theta=turn
    )
    params = fitted_params(TABLE_3_3, robot, dt)
    v = share[0] * (top if share[0] > 0 else back)
    samples = window([v, share[1] * turn], robot, params)
    assert len(np.unique(samples[:-1, 0])) <= SPEEDS + 2  # both ends, the steps, and zero
    assert len(np.unique(samples[:-1, 1])) <= TURNS + 2


def test_the_robot_of_the_thesis_keeps_the_resolution_of_the_thesis() -> None:
    assert fitted_params(TABLE_3_3, THESIS, 0.1) == TABLE_3_3
    assert fitted_params(PRINTED.window, THESIS, 0.1) == PRINTED.window


@pytest.mark.parametrize("radius", [0.3, 0.5])
def test_the_path_keeps_the_robots_radius(radius: float) -> None:
    wide = replace(TURTLEBOT2, radius=radius)
    fine = GridMap(np.kron(WALL.occupied, np.ones((4, 4), dtype=bool)), 0.25)
    path = path_of(task(wide, fine), replace(ENHANCED, safety_radius=0.0), pruned)
    for a, b in pairwise(path):
        line = a + np.linspace(0.0, 1.0, 200)[:, None] * (b - a)
        assert fine.distance(line).min() >= radius - 0.13  # half a step between two cells may come nearer


def test_a_cap_brakes_no_harder_than_the_robot_can() -> None:
    slow = capped(THESIS, 0.1, 0.8, 0.1)
    assert slow.max_vel_x == pytest.approx(0.78)
    assert capped(THESIS, 0.5, 0.4, 0.1).max_vel_x == pytest.approx(0.5)
    assert capped(THESIS, 5.0, 0.4, 0.1) is THESIS
    assert capped(THESIS, 0.0, 0.0, 0.1).max_vel_x > 0.0


def test_the_cure_ends_the_orbit_of_the_printed_fusion() -> None:
    """A sub-goal beside the robot at full speed: the printed rule circles it to the end, the cured one goes on."""
    open_ground = GridMap(np.zeros((40, 40), dtype=bool))
    path = np.array([[14.0, 20.0], [20.0, 22.6], [34.0, 20.0]])
    world, loop = World(grid=open_ground), simulate.Loop(velocity=(1.0, 0.0))
    runs = [
        simulate.run(world, THESIS, controller, [20.0, 19.74, 0.0], path[-1], t_max=120.0, loop=loop)
        for controller in (Printed(THESIS, path), Cured(THESIS, path, open_ground))
    ]
    assert [run.status for run in runs] == ["timeout", "reached"]
    assert not runs[0].log["subgoal"].any()
    assert np.abs(np.diff(np.unwrap(runs[0].poses[:, 2]))).sum() > 6.0 * np.pi
