"""The seeded scenes: what they promise holds, and a number names one scene."""

import numpy as np
import pytest

from fuzzynav.fusion import GOAL, ROBOTS, SPEED_BOUND, START, scene_task
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import visibility
from fuzzynav.world import movers_start, movers_step

SEEDS = range(50_000, 50_012)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_scene_keeps_its_promises(seed: int) -> None:
    task = scene_task(seed)
    world, chart = task.world, task.chart
    assert chart is not None
    assert len(world.unknown_rectangles) == 3
    assert not chart.is_occupied(world.unknown_rectangles[:, :2]).any(), "the map lacks them"
    full = chart.occupied.copy()
    for x, y in world.unknown_rectangles[:, :2]:
        full[int(y), int(x)] = True
    best = visibility.shortest(GridMap(full), START, GOAL, task.robot.radius)
    assert best.status == "reached"
    assert best.length == task.optimum >= np.hypot(17.0, 17.0)
    assert 0.05 < chart.occupied.mean() < 0.2
    assert len(world.movers) == 4
    for mover in world.movers:
        assert 0.15 <= mover.speed <= SPEED_BOUND
        assert mover.radius == 0.3
        assert mover.courtesy == 0.1
        assert np.hypot(*np.diff(mover.waypoints, axis=0)[0]) >= 2.0


@pytest.mark.parametrize("seed", list(SEEDS)[:4])
def test_movers_walk_on_free_ground_within_the_bound(seed: int) -> None:
    task = scene_task(seed, courteous=False)
    state, rng = movers_start(task.world, 0), np.random.default_rng(0)
    for _ in range(400):
        later = movers_step(state, 0.1, None, rng)
        steps = np.hypot(*(later.positions - state.positions).T)
        assert steps.max() <= SPEED_BOUND * 0.1 + 1e-9
        assert task.world.clearance(later.positions, []).min() >= 0.3 - 1e-9
        state = later


def test_the_same_number_is_the_same_scene_for_all_robots_and_trackers() -> None:
    one, two = scene_task(7), scene_task(7, robot=ROBOTS["thesis"], ideal=False, courteous=False)
    np.testing.assert_array_equal(one.world.unknown_rectangles, two.world.unknown_rectangles)
    assert [m.waypoints for m in one.world.movers] == [m.waypoints for m in two.world.movers]
    assert one.optimum == two.optimum
    assert scene_task(8).optimum != one.optimum


def test_a_number_below_zero_is_refused() -> None:
    with pytest.raises(ValueError, match="0 or more"):
        scene_task(-1)
