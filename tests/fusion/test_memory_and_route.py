"""The map that remembers, the way over it, and when a new one is sought."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav.control import Observation
from fuzzynav.fusion import Guide, Memory, Planning, surroundings
from fuzzynav.fusion.route import clear_from, route, target_of
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning.astar import OPTIMAL
from fuzzynav.sensors import Laser, laser_ideal
from fuzzynav.world import World

LASER = Laser(beams=360, field_of_view=2.0 * np.pi, range_min=0.0, range_max=8.0, noise=0.0)
EMPTY = GridMap(np.zeros((10, 10), dtype=bool))


def look(
    world: World, pose: tuple[float, float, float], time: float = 0.0, goal: tuple[float, float] = (9, 9)
) -> Observation:
    scan = laser_ideal(world, pose, LASER)
    return Observation(
        time=time, pose=np.array(pose), velocity=np.zeros(2), goal=np.array(goal, dtype=float),
        points=scan.world_points(pose), ranges=scan.ranges, angles=scan.angles, range_max=LASER.range_max,
    )  # fmt: skip


def every(seen: Observation) -> Array:
    return np.ones(len(seen.points), dtype=bool)


def test_what_was_seen_is_blocked_and_what_is_looked_through_is_free_again() -> None:
    memory, there = Memory(EMPTY, 0.1), World(grid=EMPTY, discs=[[5.0, 5.0, 0.3]])
    first = look(there, (2.0, 5.0, 0.0))
    memory.enter(first, every(first))
    assert memory.grid().is_occupied([4.75, 5.0])
    assert not memory.grid().is_occupied([3.5, 5.0])
    gone = look(World(grid=EMPTY), (2.0, 5.0, 0.0))
    memory.enter(gone, every(gone))
    assert memory.grid().is_occupied([4.75, 5.0]), "one look is not enough"
    for _ in range(8):
        memory.enter(gone, every(gone))
    assert not memory.grid().occupied[20:80, 20:80].any()


def test_without_fading_nothing_is_forgotten() -> None:
    memory = Memory(EMPTY, 0.1, fades=False)
    for world in (World(grid=EMPTY, discs=[[5.0, 5.0, 0.3]]), *[World(grid=EMPTY)] * 12):
        seen = look(world, (2.0, 5.0, 0.0))
        memory.enter(seen, every(seen))
    assert memory.grid().is_occupied([4.75, 5.0])


def test_beams_that_may_not_be_entered_are_not() -> None:
    memory, seen = Memory(EMPTY, 0.1), look(World(grid=EMPTY, discs=[[5.0, 5.0, 0.3]]), (2.0, 5.0, 0.0))
    memory.enter(seen, np.hypot(*(seen.points - [2.0, 5.0]).T) > 4.0)
    assert not memory.grid().is_occupied([4.75, 5.0])


@settings(max_examples=40)
@given(x=st.floats(1.5, 8.5), y=st.floats(1.5, 8.5), theta=st.floats(-np.pi, np.pi), radius=st.floats(0.15, 0.6))
def test_every_hit_lies_in_a_blocked_cell_and_blocked_cells_are_near_hits(
    x: float, y: float, theta: float, radius: float
) -> None:
    world = World(grid=EMPTY, discs=[[5.0, 5.0, radius]])
    if float(world.clearance([x, y])) < 0.2:
        return
    memory, seen = Memory(EMPTY, 0.1), look(world, (x, y, theta))
    memory.enter(seen, every(seen))
    inside = (np.abs(seen.points - 5.0) < 4.9).all(axis=1)
    assert memory.grid().is_occupied(seen.points[inside] + 1e-6 * (5.0 - seen.points[inside])).mean() > 0.9
    cells = memory.grid().center_of(np.argwhere(memory.grid().occupied)[:, ::-1])
    away = np.hypot(cells[:, None, 0] - seen.points[:, 0], cells[:, None, 1] - seen.points[:, 1]).min(axis=1)
    assert away.max() < 0.1


def test_growing_and_discs() -> None:
    memory, seen = Memory(EMPTY, 0.1), look(World(grid=EMPTY, discs=[[5.0, 5.0, 0.3]]), (2.0, 5.0, 0.0))
    memory.enter(seen, every(seen))
    assert memory.grid(wary=0.1).is_occupied([4.65, 5.05])
    assert not memory.grid().is_occupied([4.65, 5.05])
    grid = memory.grid(np.array([[8.0, 8.0, 0.5]]))
    assert grid.is_occupied([8.4, 8.0])
    assert not grid.is_occupied([8.6, 8.0])


WALL = GridMap(
    np.kron(np.array([[0, 0, 0, 0], [0, 1, 1, 0], [0, 0, 0, 0]], dtype=bool), np.ones((10, 10), dtype=bool)), 0.1
)


def test_a_way_keeps_its_room_and_prefers_more_of_it() -> None:
    found = route(WALL, np.array([0.5, 1.5]), np.array([3.5, 1.5]), 0.2, (0.2, 0.1), OPTIMAL)
    assert found is not None
    assert found.room == pytest.approx(0.4 - 0.075)
    assert all(WALL.clear_line(a, b, found.room) for a, b in zip(found.points[:-1], found.points[1:], strict=True))
    np.testing.assert_allclose(found.points[[0, -1]], [[0.5, 1.5], [3.5, 1.5]])
    assert found.length == pytest.approx(found.left(np.array([0.5, 1.5]), 1))


def test_a_narrow_way_is_taken_where_it_is_the_only_one() -> None:
    walls = np.zeros((30, 40), dtype=bool)
    walls[:, 20] = True
    walls[12:18, 20] = False  # 0.6 m
    gap = GridMap(walls, 0.1)
    ends = np.array([0.5, 1.5]), np.array([3.5, 1.5])
    wide = route(gap, *ends, 0.2, (0.25, 0.0), OPTIMAL)
    assert wide is not None
    assert wide.room < 0.2
    assert route(gap, *ends, 0.35, (0.25, 0.1), OPTIMAL) is None


def test_more_room_is_not_worth_any_detour() -> None:
    """Straight through a gap of 0.8 m, or far round where there is more room: the gap, for a robot of 0.2 m."""
    walls = np.zeros((72, 40), dtype=bool)
    walls[:50, 20] = True
    walls[11:19, 20] = False
    gap = GridMap(walls, 0.1)
    ends = np.array([0.5, 1.5]), np.array([3.5, 1.5])
    found = route(gap, *ends, 0.2, (0.35, 0.1, 0.0), OPTIMAL)
    round_it = route(gap, *ends, 0.2, (0.35,), OPTIMAL)
    assert found is not None
    assert round_it is not None
    assert found.length < 3.5
    assert round_it.length > 6.0
    assert found.room == pytest.approx(0.3 - 0.075)


def test_the_target_is_the_last_point_in_view() -> None:
    found = route(WALL, np.array([0.5, 1.5]), np.array([3.5, 1.5]), 0.2, (0.1,), OPTIMAL)
    assert found is not None
    assert target_of(WALL, np.array([0.5, 1.5]), found, 1, 0.05) < len(found.points) - 1
    beyond = found.points[-2] + [0.0, 0.0]
    assert target_of(WALL, beyond, found, 1, 0.05) == len(found.points) - 1
    assert clear_from(WALL, np.array([0.5, 1.5]), found, 1, 0.05)
    shut = WALL.occupied.copy()
    shut[:, 25] = True
    assert not clear_from(GridMap(shut, 0.1), np.array([0.5, 1.5]), found, 1, 0.05)


def test_a_guide_seeks_a_new_way_when_the_old_one_is_blocked() -> None:
    guide = Guide(0.3, Planning(every=np.inf), EMPTY, 0.0)
    free, wall = World(grid=EMPTY), World(grid=EMPTY, unknown_rectangles=[[5.0, 5.0, 0.5, 6.0, 0.0]])
    targets = []
    for k, world in enumerate([free] * 3 + [wall] * 12):
        seen = look(world, (2.0, 5.0, 0.0), 0.1 * k, goal=(8.0, 5.0))
        around = surroundings(seen, 0.3, 0.2, chart=EMPTY, tracks=None, tell=0.15)
        targets.append(guide.update(seen, around))
    np.testing.assert_allclose(targets[0], [8.0, 5.0])
    assert guide.searches == 2
    assert abs(targets[-1][1] - 5.0) > 2.5, "round one end of the wall"


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"resolution": 0.0}, "resolution"), ({"every": 0.0}, "every"), ({"patience": -1.0}, "patience"),
        ({"rooms": ()}, "rooms"), ({"rooms": (0.0, 0.2)}, "widest first"),
    ],
)  # fmt: skip
def test_planning_refuses_what_cannot_be(given: dict[str, float], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Planning(**given)  # type: ignore[arg-type]
