"""Sub-goals: where a path turns, when the next one is taken, and the orbit that the printed rule falls into."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav.fusion import subgoals
from fuzzynav.fusion.subgoals import SubGoals, arc_cap, global_path, sub_goals, switched_by_radius, switched_by_view
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar
from fuzzynav.robot import THESIS, move
from fuzzynav.studies.planning.maps import SCENES_4, enhanced

WALL = GridMap.from_ascii("""
..........
..........
.....#....
.....#....
.....#....
.....#....
..........""")
CORNERS = [[1.5, 1.5], [4.5, 5.5], [7.5, 5.5], [9.5, 1.5]]
angles = st.floats(-np.pi, np.pi)
metres = st.floats(-20.0, 20.0)


def turned(path: np.ndarray) -> np.ndarray:
    return np.column_stack([10.0 - path[:, 0], path[:, 1]])


# --- the path ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["M1 Manhattan", "M2", "M2 cut"])
def test_the_path_on_the_maps_of_thesis_4_is_the_planners(name: str) -> None:
    scene = SCENES_4[name]
    nodes = scene.grid.center_of(enhanced(scene).nodes)
    np.testing.assert_allclose(global_path(scene.grid, nodes[0], nodes[-1]), nodes)


@pytest.mark.parametrize("keep", [subgoals.pruned, subgoals.key_nodes, subgoals.turning_points])
@pytest.mark.parametrize("parts", [1, 4])
def test_every_leg_is_free_for_the_disc(keep: subgoals.Keep, parts: int) -> None:
    grid = GridMap(np.kron(WALL.occupied, np.ones((parts, parts), dtype=bool)), 1.0 / parts)
    options = astar.Options(heuristic="euclidean", safety_radius=0.5)
    path = global_path(grid, (1.3, 1.6), (8.7, 1.2), options, keep)
    assert path[0].tolist() == [1.3, 1.6]
    assert path[-1].tolist() == [8.7, 1.2]
    assert len(path) >= 3
    assert all(grid.clear_line(a, b, 0.3) for a, b in itertools.pairwise(path))


def test_pruning_shortens_and_keeps_fewer_points() -> None:
    options = astar.Options(heuristic="euclidean", safety_radius=0.5)
    plain, cut = (
        global_path(WALL, (1.5, 1.5), (8.5, 1.5), options, keep) for keep in (subgoals.turning_points, subgoals.pruned)
    )
    way = [np.hypot(*np.diff(path, axis=0).T).sum() for path in (plain, cut)]
    assert len(cut) <= len(plain)
    assert way[1] < way[0]


def test_without_a_path_there_are_no_points() -> None:
    walled = GridMap.from_ascii("..#..\n..#..\n..#..")
    assert len(global_path(walled, (0.5, 0.5), (4.5, 0.5))) == 0
    assert len(global_path(GridMap(np.ones((3, 3), dtype=bool)), (0.5, 0.5), (2.5, 0.5))) == 0


def test_a_start_that_the_safety_radius_blocks_is_joined_to_the_nearest_free_cell() -> None:
    grid = GridMap(np.kron(WALL.occupied, np.ones((4, 4), dtype=bool)), 0.25)
    path = global_path(grid, (4.9, 2.1), (8.5, 1.5))  # 0.1 m from the wall
    assert path[0].tolist() == [4.9, 2.1]
    first = path[1]
    assert grid.distance(first) >= 0.5
    assert np.hypot(*(first - path[0])) < 0.7


# --- the switch ----------------------------------------------------------------------------------------


def test_the_start_is_no_sub_goal() -> None:
    goals = sub_goals(CORNERS)
    assert goals.current.tolist() == CORNERS[1]
    assert [goals.last, goals.next().last, goals.next().next().last] == [False, False, True]
    assert goals.next().next().next().current.tolist() == CORNERS[-1]
    assert sub_goals([[2.0, 3.0]]).current.tolist() == [2.0, 3.0]
    with pytest.raises(ValueError, match="no sub-goal 3"):
        SubGoals(points=np.array(CORNERS[1:]), index=3)
    with pytest.raises(ValueError, match="no sub-goal"):
        sub_goals([])


@given(metres, metres, angles, st.floats(0.1, 5.0))
def test_the_radius_rule_goes_on_inside_the_circle_and_nowhere_else(x: float, y: float, th: float, r: float) -> None:
    goals = switched_by_radius(sub_goals(CORNERS), [x, y, th], r)
    away = np.hypot(*(np.array(CORNERS[1:]) - (x, y)).T)
    assert (away[: goals.index] <= r).all()
    assert goals.last or away[goals.index] > r


@given(st.floats(0.5, 4.4), st.floats(0.5, 6.5), angles)
def test_the_view_rule_needs_sight_of_the_next(x: float, y: float, th: float) -> None:
    first, after = np.array([4.5, 6.5]), np.array([8.5, 1.5])
    start = SubGoals(points=np.array([first, after]))
    goals = switched_by_view(start, [x, y, th], WALL, 0.3)
    sees = WALL.clear_line((x, y), after, 0.3)
    away = np.hypot(*(first - (x, y)))
    assert (goals.index == 1) == (away <= 0.5 or (sees and away < 3.0))
    assert switched_by_view(start, [x, y, th], None, 0.3).index == int(away <= 0.5)


def test_several_sub_goals_are_passed_at_once() -> None:
    near = sub_goals([[0, 0], [1, 0], [1.2, 0], [1.4, 0], [9, 0]])
    assert switched_by_radius(near, [1.2, 0.0, 0.0], 0.5).index == 3
    ground = GridMap(np.zeros((3, 10), dtype=bool), origin=(0.0, -1.5))
    assert switched_by_view(near, [0.9, 0.5, 0.0], ground, 0.1).index == 3


# --- the orbit -----------------------------------------------------------------------------------------


def steer(target: np.ndarray, *, capped: bool, seconds: float = 60.0) -> tuple[np.ndarray, float]:
    """Drive at full speed, or at the cap, and always turn towards the target: path and least distance to it."""
    pose, dt, speed = np.zeros(3), 0.1, THESIS.max_vel_x
    path = [pose]
    for _ in range(round(seconds / dt)):
        dx, dy = target - pose[:2]
        error = (np.arctan2(dy, dx) - pose[2] + np.pi) % (2.0 * np.pi) - np.pi
        wish = min(THESIS.max_vel_x, arc_cap(pose, target, THESIS.max_vel_theta)) if capped else THESIS.max_vel_x
        speed = float(np.clip(wish, speed - THESIS.dec_lim_x * dt, speed + THESIS.acc_lim_x * dt))
        omega = float(np.clip(error / dt, -THESIS.max_vel_theta, THESIS.max_vel_theta))
        pose = move(pose, np.array([speed, omega]), dt)
        path.append(pose)
        if np.hypot(*(target - pose[:2])) <= 1.0:
            break
    away = np.hypot(*(np.array(path)[:, :2] - target).T)
    return np.array(path), float(away.min())


def test_the_printed_rule_orbits_and_the_cap_ends_it() -> None:
    """At 1 m/s and 0.35 rad/s the circle has radius 2.86 m: a sub-goal at its centre is never nearer than that."""
    target = np.array([0.0, 1.0 / 0.35])
    path, nearest = steer(target, capped=False)
    assert len(path) == 601
    assert nearest > 2.5  # never within the metre of the printed rule
    assert switched_by_radius(SubGoals(points=np.array([target, [9.0, 9.0]])), path[-1]).index == 0
    turns = np.abs(np.diff(np.unwrap(path[:, 2]))).sum() / (2.0 * np.pi)
    assert turns > 3.0
    ended, nearest = steer(target, capped=True)
    assert nearest <= 1.0
    assert len(ended) < 300


def test_the_view_ends_the_orbit_too() -> None:
    target, after = np.array([0.0, 1.0 / 0.35]), np.array([6.0, 6.0])
    path, _ = steer(target, capped=False)
    goals = SubGoals(points=np.array([target, after]))
    open_ground = GridMap(np.zeros((30, 30), dtype=bool), origin=(-10.0, -10.0))
    assert switched_by_view(goals, path[-1], open_ground, 0.3).index == 1


@given(metres, metres, angles, metres, metres, st.floats(0.1, 3.0))
def test_the_capped_arc_leads_through_the_target(
    x: float, y: float, th: float, tx: float, ty: float, omega: float
) -> None:
    """Driven at the cap and the full turn, the robot meets the target; at any lower speed it turns inside of it."""
    dx, dy = tx - x, ty - y
    distance, error = np.hypot(dx, dy), (np.arctan2(dy, dx) - th + np.pi) % (2.0 * np.pi) - np.pi
    cap = arc_cap([x, y, th], [tx, ty], omega)
    if distance < 0.1 or abs(error) < 0.01 or abs(error) > 0.5 * np.pi:
        assert cap >= 0.5 * omega * distance * (1.0 - 1e-9)
        return
    turn = np.sign(error) * omega
    reached = move(np.array([x, y, th]), np.array([cap, turn]), 2.0 * abs(error) / omega)
    np.testing.assert_allclose(reached[:2], [tx, ty], atol=1e-6)
