"""The any-angle optimum against geometry and brute force; the sampling planners against the optimum."""

import itertools
import math
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse.csgraph import dijkstra

from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar, sampling, visibility
from fuzzynav.planning.sampling import PRM, RRT, Swarm
from fuzzynav.smoothing import simplify

BLOCK = GridMap.from_ascii(".....\n.###.\n.###.\n.###.\n.....")


def random_map(seed: int, size: int = 12, density: float = 0.25) -> GridMap:
    occupied = np.random.default_rng(seed).random((size, size)) < density
    occupied[0, 0] = occupied[-1, -1] = False
    return GridMap(occupied)


def by_all_corners(grid: GridMap, start, goal) -> float:
    """Shortest way for a point by brute force: every lattice point is a node, every clear line an edge."""
    rows, cols = grid.shape
    nodes = [np.array(start), np.array(goal)]
    nodes += [
        np.array([x, y], dtype=float)
        for x in range(cols + 1)
        for y in range(rows + 1)
        if not grid.is_occupied([[x + i, y + j] for i in (-0.5, 0.5) for j in (-0.5, 0.5)]).all()
    ]
    weights = np.zeros((len(nodes), len(nodes)))
    for i, j in itertools.combinations(range(len(nodes)), 2):
        if grid.clear_line(nodes[i], nodes[j], 0.0, "permissive"):
            weights[i, j] = np.hypot(*(nodes[i] - nodes[j]))
    return float(dijkstra(weights, directed=False, indices=0)[1])


@pytest.mark.parametrize("seed", range(6))
def test_point_optimum_equals_brute_force(seed: int) -> None:
    grid = random_map(seed, size=7)
    expected = by_all_corners(grid, (0.5, 0.5), (6.5, 6.5))
    found = visibility.shortest(grid, (0.5, 0.5), (6.5, 6.5), 0.0, "permissive")
    assert (found.status == "reached") == np.isfinite(expected)
    if np.isfinite(expected):
        assert found.length == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("radius", [0.1, 0.3, 0.5])
def test_around_a_block_by_hand(radius: float) -> None:
    # from the middle of the left side to the middle of the right, around the corners (1, 1) and (4, 1)
    whole = math.hypot(0.5, 1.5)
    tangent = math.sqrt(whole**2 - radius**2)
    to_start = math.pi - math.atan2(1.5, 0.5)  # direction from the corner to the start, counter-clockwise from east
    arc = 1.5 * math.pi - to_start - math.acos(radius / whole)
    expected = 2 * (tangent + radius * arc) + 3.0
    assert visibility.shortest(BLOCK, (0.5, 2.5), (4.5, 2.5), radius).length == pytest.approx(expected, abs=1e-9)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), radius=st.sampled_from([0.0, 0.2, 0.35, 0.5]))
def test_optimum_is_free_and_no_path_is_shorter(seed: int, radius: float) -> None:
    grid = random_map(seed, density=0.2)
    best = visibility.shortest(grid, (0.5, 0.5), (11.5, 11.5), radius)
    planned = astar.search(grid, (0, 0), (11, 11), replace(astar.OPTIMAL, safety_radius=radius))
    if planned.status == "reached":
        kept = simplify.best_shortcut(planned.cells, grid, radius, "strict")  # at radius 0: slips through no corner
        assert best.status == "reached"
        assert best.length <= astar.path_length(kept) + 1e-5
    if best.status == "reached":
        assert best.length >= math.hypot(11, 11) - 1e-9
        chord = max(radius - 0.002, 0.0)
        assert all(grid.clear_line(a, b, chord, "permissive") for a, b in itertools.pairwise(best.points))
        assert np.hypot(*np.diff(best.points, axis=0).T).sum() == pytest.approx(best.length, rel=2e-3)


def test_a_larger_robot_needs_a_longer_way() -> None:
    for seed in range(10):
        grid = random_map(seed, density=0.12)
        lengths = []
        for radius in (0.0, 0.1, 0.25, 0.4, 0.5, 0.7):
            found = visibility.shortest(grid, (0.5, 0.5), (11.5, 11.5), radius)
            lengths.append(found.length if found.status == "reached" else math.inf)
        assert lengths == sorted(lengths)


def test_turned_map_same_optimum() -> None:
    for seed in range(8):
        grid = random_map(seed)
        turned = GridMap(np.rot90(grid.occupied))
        for radius in (0.0, 0.3):
            one = visibility.shortest(grid, (0.5, 0.5), (11.5, 11.5), radius)
            two = visibility.shortest(turned, (0.5, 11.5), (11.5, 0.5), radius)
            assert one.status == two.status
            assert one.length == pytest.approx(two.length, abs=1e-6, nan_ok=True)


def test_a_point_slips_between_two_squares_only_where_it_may() -> None:
    grid = GridMap.from_ascii("#.\n.#")
    assert visibility.shortest(grid, (0.5, 0.5), (1.5, 1.5)).status == "no_path"
    slip = visibility.shortest(grid, (0.5, 0.5), (1.5, 1.5), corners="permissive")
    assert slip.length == pytest.approx(math.sqrt(2.0))
    half = GridMap(grid.occupied, 0.5, (3.0, 0.0))
    metres = visibility.shortest(half, (3.25, 0.25), (3.75, 0.75), corners="permissive")
    assert metres.length == pytest.approx(math.sqrt(0.5))


def test_bad_input_of_the_optimum() -> None:
    assert visibility.shortest(BLOCK, (2.5, 2.5), (0.5, 0.5)).status == "start_blocked"
    assert visibility.shortest(BLOCK, (0.5, 0.5), (9.0, 0.5)).status == "goal_blocked"
    assert visibility.shortest(BLOCK, (0.5, 0.5), (4.5, 0.5), 0.6).status == "start_blocked"
    same = visibility.shortest(BLOCK, (0.5, 0.5), (0.5, 0.5))
    assert (same.status, same.length) == ("reached", 0.0)
    for wrong in ({"radius": -1.0}, {"radius": math.nan}, {"corners": "round"}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            visibility.shortest(BLOCK, (0.5, 0.5), (4.5, 4.5), **wrong)
    with pytest.raises(ValueError, match="finite"):
        visibility.shortest(BLOCK, (math.nan, 0.5), (4.5, 4.5))
    crowd = GridMap(np.random.default_rng(0).random((90, 90)) < 0.3)
    free = np.argwhere(~crowd.occupied)[:2, ::-1] + 0.5
    with pytest.raises(ValueError, match="corners"):
        visibility.shortest(crowd, *free)


# -- planners that sample

PLANNERS = ((sampling.rrt, RRT(radius=0.3)), (sampling.prm, PRM(radius=0.3)), (sampling.swarm, Swarm(radius=0.3)))


@pytest.mark.parametrize(("planner", "options"), PLANNERS, ids=lambda v: getattr(v, "__name__", ""))
def test_sampled_paths_are_free_longer_than_the_optimum_and_repeatable(planner, options) -> None:
    grid = random_map(3, size=15, density=0.08)
    start, goal = (0.5, 0.5), (14.5, 14.5)
    best = visibility.shortest(grid, start, goal, 0.3).length
    found = [planner(grid, start, goal, np.random.default_rng(5), options) for _ in range(2)]
    assert found[0].status == "reached"
    assert np.array_equal(found[0].points, found[1].points)
    assert best - 1e-6 <= found[0].length < 3.0 * best
    assert all(grid.clear_line(a, b, 0.3, "permissive") for a, b in itertools.pairwise(found[0].points))
    assert np.allclose(found[0].points[[0, -1]], [start, goal])
    other = planner(grid, start, goal, np.random.default_rng(6), options)
    assert not np.array_equal(found[0].points, other.points)


@pytest.mark.parametrize(("planner", "options"), PLANNERS, ids=lambda v: getattr(v, "__name__", ""))
def test_sampling_planners_say_when_they_fail(planner, options) -> None:
    wall = GridMap.from_ascii("..#..\n..#..\n..#..\n..#..")
    few = replace(options, samples=60) if hasattr(options, "samples") else replace(options, iterations=5)
    lost = planner(wall, (0.5, 0.5), (4.5, 3.5), np.random.default_rng(1), few)
    assert (lost.status, len(lost.points), math.isnan(lost.length)) == ("no_path", 0, True)
    assert planner(wall, (2.5, 0.5), (4.5, 3.5), np.random.default_rng(1), few).status == "start_blocked"
    assert planner(wall, (0.5, 0.5), (0.1, 3.5), np.random.default_rng(1), few).status == "goal_blocked"
    with pytest.raises(ValueError, match="start"):
        planner(wall, (math.nan, 0.5), (4.5, 3.5), np.random.default_rng(1), few)


@pytest.mark.parametrize(("planner", "options"), PLANNERS, ids=lambda v: getattr(v, "__name__", ""))
def test_every_option_has_an_effect_and_a_limit(planner, options) -> None:
    grid = random_map(3, size=15, density=0.08)
    names = [f.name for f in fields(options)]

    def points(o) -> list:
        found = planner(grid, (0.5, 0.5), (14.5, 14.5), np.random.default_rng(5), o)
        return [*found.points.ravel().tolist(), found.checks, np.concatenate(found.evidence).sum()]

    base = points(options)
    for name in names:
        value = getattr(options, name)
        few = {"samples": 3, "goal_bias": 0.9}.get(name, 2 if isinstance(value, int) else value * 0.6)
        assert points(replace(options, **{name: few})) != base, name
        with pytest.raises(ValueError, match=name):
            replace(options, **{name: -1})
