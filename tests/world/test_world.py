"""The true world: rays and clearances against slow geometry, honest maps, movers that keep their rules."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav.maps.gridmap import GridMap
from fuzzynav.world import Mover, World, movers_start, movers_step

relaxed = settings(deadline=None, max_examples=40)
SEEDS = st.integers(0, 2**32)


def random_world(seed: int, **more) -> World:
    rng = np.random.default_rng(seed)
    counts = rng.integers(0, 5, 4)
    discs = [np.column_stack([rng.uniform(0, 8, (n, 2)), rng.uniform(0.1, 1, n)]) for n in counts[:2]]
    boxes = [
        np.column_stack([rng.uniform(0, 8, (n, 2)), rng.uniform(0.1, 2, (n, 2)), rng.uniform(-4, 4, n)])
        for n in counts[2:]
    ]
    return World(
        discs=discs[0],
        unknown_discs=discs[1],
        rectangles=boxes[0],
        unknown_rectangles=boxes[1],
        **{"bounds": (0, 8, 0, 8), **more},
    )


def outline(world: World, movers: np.ndarray, n: int = 4000) -> np.ndarray:
    """Points on every disc and rectangle."""
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    points = [
        d[:2] + d[2] * np.stack([np.cos(t), np.sin(t)], -1)
        for d in np.concatenate([world.discs, world.unknown_discs, movers])
    ]
    u = np.linspace(-1, 1, n)
    edges = np.concatenate([np.stack(np.broadcast_arrays(u, s), -1) for s in (-1, 1)])
    for x, y, w, h, theta in np.concatenate([world.rectangles, world.unknown_rectangles]):
        c, s = np.cos(theta), np.sin(theta)
        local = np.concatenate([edges, edges[:, ::-1]]) * [w / 2, h / 2]
        points.append(local @ [[c, s], [-s, c]] + [x, y])
    return np.concatenate(points) if points else np.empty((0, 2))


@relaxed
@given(SEEDS)
def test_clearance_is_the_distance_to_the_nearest_outline(seed):
    world = random_world(seed, bounds=None)
    points = np.random.default_rng(seed + 1).uniform(-1, 9, (20, 2))
    lines = outline(world, np.empty((0, 3)))
    found = world.clearance(points)
    if len(lines) == 0:
        assert np.all(np.isinf(found))
        return
    slow = np.hypot(*(lines[:, None] - points).T).min(axis=1)
    outside = found > 0
    assert np.allclose(found[outside], slow[outside], atol=2e-3)
    assert np.all(-found[~outside] >= slow[~outside] - 2e-3)


@relaxed
@given(SEEDS)
def test_rays_are_free_up_to_their_end_and_end_on_a_surface(seed):
    rng = np.random.default_rng(seed)
    grid = GridMap(rng.random((16, 16)) < 0.04, 0.5) if seed % 2 else None
    walker = Mover.constant((4, 4), (1, 0), 0.4)
    world = random_world(seed, grid=grid, bounds=None if grid else (0, 8, 0, 8), movers=(walker,))
    at = rng.uniform(0.5, 7.5, (1, 2))
    start = rng.uniform(0, 8, 2)
    angles = rng.uniform(-np.pi, np.pi, 25)
    ranges = world.cast([*start, 0.3], angles, 5.0, at)
    if world.clearance(start, at) <= 0:
        assert np.all(ranges == 0.0)
        return
    direction = np.stack([np.cos(angles + 0.3), np.sin(angles + 0.3)], -1)
    along = start + (np.linspace(0, 1, 200, endpoint=False)[:, None] * ranges)[..., None] * direction
    assert np.all(world.clearance(along, at) > 0)
    ends = world.clearance(start + ranges[:, None] * direction, at)
    assert np.all(np.abs(ends[ranges < 5.0]) < 1e-9)
    assert np.all(ranges <= 5.0)


@relaxed
@given(SEEDS, st.floats(-7, 7), st.floats(-7, 7), st.floats(0.05, 2 * np.pi), st.integers(2, 90))
def test_even_beams_and_single_beams_say_the_same(seed, heading, first, span, beams):
    world = random_world(seed, movers=(Mover.constant((2, 5), (0, 0), 0.4), Mover.constant((6, 2), (0, 0), 0.7)))
    pose = [*np.random.default_rng(seed).uniform(0, 8, 2), heading]
    angles = first + np.linspace(0, span, beams)
    together, names = world.cast_labelled(pose, angles, 7.0)
    alone = [world.cast_labelled(pose, [a], 7.0) for a in angles]
    assert np.array_equal(together, [r[0] for r, _ in alone])
    assert np.array_equal(names, [label[0] for _, label in alone])


@relaxed
@given(SEEDS)
def test_mirrored_world_mirrored_scan(seed):
    world = random_world(seed)
    flip = np.array([8.0, 0, 0]), np.array([-1.0, 1, 1])
    boxes = [b * [-1, 1, 1, 1, -1] + [8, 0, 0, 0, 0] for b in (world.rectangles, world.unknown_rectangles)]
    other = World(
        discs=world.discs * flip[1] + flip[0],
        unknown_discs=world.unknown_discs * flip[1] + flip[0],
        rectangles=boxes[0],
        unknown_rectangles=boxes[1],
        bounds=(0, 8, 0, 8),
    )
    angles = np.linspace(-3, 3, 31)
    assert np.allclose(world.cast([3, 4, 0.5], angles, 9.0), other.cast([5, 4, np.pi - 0.5], -angles, 9.0), atol=1e-9)


def test_known_answers():
    world = World(
        discs=[[4, 0, 1]],
        rectangles=[[0, 3, 2, 2, 0]],
        unknown_rectangles=[[0, -4, 2, 2, np.pi / 4]],
        bounds=(-6, 6, -6, 6),
    )
    ranges = world.cast([0, 0, 0], [0, np.pi / 2, -np.pi / 2, np.pi], 10.0)
    assert ranges == pytest.approx([3.0, 2.0, 4 - np.sqrt(2), 6.0])
    assert world.clearance([[0, 0], [4, 0.5], [0, 3.25], [-7, 0]]) == pytest.approx([2.0, -0.5, -0.75, -1.0])
    assert world.cast([4, 0, 0], [0.0, 1.0], 10.0).tolist() == [0.0, 0.0]
    assert World().cast([0, 0, 0], [0.0], 4.0).tolist() == [4.0]


def test_labels_name_the_mover_that_is_seen():
    both = Mover.constant((0, 3), (0, 0), 0.5), Mover.constant((4, 0), (0, 0), 0.5)
    world = World(discs=[[2, 0, 0.5]], movers=both)
    ranges, labels = world.cast_labelled([0, 0, 0], [0.0, np.pi / 2, np.pi], 9.0)
    assert labels.tolist() == [-1, 0, -1]
    assert ranges.tolist() == [1.5, pytest.approx(2.5), 9.0]
    assert world.cast([0, 0, 0], [np.pi / 2], 9.0, []).tolist() == [9.0]


@relaxed
@given(SEEDS, st.sampled_from([0.1, 0.25, 0.37]))
def test_known_map_covers_every_known_solid_and_nothing_far_from_one(seed, resolution):
    world = random_world(seed)
    known = replace(world, unknown_discs=(), unknown_rectangles=(), bounds=None)
    grid = world.known_grid(resolution)
    points = np.random.default_rng(seed).uniform(0, 8, (2000, 2))
    solid = known.clearance(points) < -1e-9
    assert np.all(grid.is_occupied(points[solid]))
    rows, cols = np.nonzero(grid.occupied)
    centres = grid.center_of(np.stack([cols, rows], -1))
    assert len(centres) == 0 or known.clearance(centres).max() <= resolution * np.sqrt(0.5)


def test_known_map_of_a_grid_is_the_grid_at_any_scale():
    grid = GridMap.from_ascii("#..\n..#", 0.5, (1.0, -2.0))
    assert np.array_equal(World(grid=grid).known_grid().occupied, grid.occupied)
    fine = World(grid=grid).known_grid(0.25)
    assert np.array_equal(fine.occupied, np.kron(grid.occupied, np.ones((2, 2), dtype=bool)))
    assert World(grid=grid).known_grid(1.5).occupied.all()
    assert fine.origin == (1.0, -2.0)


def run(world: World, seconds: float, dt: float, robot=None, seed: int = 0):
    rng = np.random.default_rng(seed)
    state = movers_start(world, rng)
    states = [state]
    for _ in range(round(seconds / dt)):
        state = movers_step(state, dt, robot, rng)
        states.append(state)
    return states


@pytest.mark.parametrize("dt", [0.1, 0.7])
def test_constant_and_patrol_positions_do_not_depend_on_the_step(dt):
    world = World(movers=(Mover.constant((1, 1), (0.5, -0.2), 0.3), Mover.patrol([[0, 0], [2, 0], [2, 1]], 1.0, 0.3)))
    for state, t in zip(run(world, 8.4, dt), np.arange(99) * dt, strict=False):
        assert state.positions[0] == pytest.approx([1 + 0.5 * t, 1 - 0.2 * t])
        s = 3 - abs(3 - t % 6)
        assert state.positions[1] == pytest.approx([min(s, 2), max(s - 2, 0)], abs=1e-9)
    assert run(world, 4.2, dt)[-1].velocities[1] == pytest.approx([-1.0, 0.0])


@relaxed
@given(SEEDS)
def test_wanderers_repeat_stay_clear_and_keep_their_speed(seed):
    world = random_world(seed)
    rng = np.random.default_rng(seed)
    free = [p for p in rng.uniform(0.5, 7.5, (40, 2)) if world.clearance(p) > 0.35]
    if not free:
        return
    world = replace(world, movers=(Mover.wander(free[0], 0.8, 0.3),))
    states = run(world, 20.0, 0.1, seed=seed)
    way = np.array([s.positions[0] for s in states])
    assert np.array_equal(way, [s.positions[0] for s in run(world, 20.0, 0.1, seed=seed)])
    assert np.all(world.clearance(way, []) >= 0.3 - 0.01)
    assert np.all(np.hypot(*np.diff(way, axis=0).T) <= 0.08 + 1e-12)


def test_wanderers_do_move():
    world = World(bounds=(0, 10, 0, 10), movers=(Mover.wander((5, 5), 1.0, 0.3),))
    states = run(world, 60.0, 0.1)
    assert states[-1].travelled[0] > 50.0
    assert len({tuple(s.targets[0]) for s in states}) > 5


def test_yielding_movers_slow_down_and_stand_before_the_robot():
    walker = Mover.constant((0, 0), (1, 0), 0.3, yield_distance=1.0)
    world = World(movers=(walker,))
    ahead = run(world, 20.0, 0.05, robot=[3.0, 0.0, 0.0])[-1]
    gap = 3.0 - ahead.positions[0, 0] - 0.3
    assert 0.5 - 1e-9 <= gap < 0.51
    assert np.hypot(*ahead.velocities[0]) < 0.02
    behind = run(world, 5.0, 0.05, robot=[-0.5, 0.0, 0.0])[-1]
    assert behind.positions[0, 0] == pytest.approx(5.0)
    bold = World(movers=(replace(walker, yield_distance=0.0),))
    assert run(bold, 5.0, 0.05, robot=[3.0, 0.0, 0.0])[-1].positions[0, 0] == pytest.approx(5.0)


def test_steps_do_not_change_the_state_they_start_from():
    both = Mover.wander((4, 4), 1.0, 0.2), Mover.patrol([[1, 1], [2, 1]], 1.0, 0.2)
    world = World(bounds=(0, 9, 0, 9), movers=both)
    state = movers_start(world, 1)
    before = [a.copy() for a in (state.positions, state.velocities, state.targets, state.travelled)]
    movers_step(state, 0.5, None, np.random.default_rng(0))
    assert all(
        np.array_equal(a, b)
        for a, b in zip(before, (state.positions, state.velocities, state.targets, state.travelled), strict=True)
    )
    assert movers_step(movers_start(World()), 0.1, None, np.random.default_rng(0)).positions.shape == (0, 2)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: World(discs=[[0, 0]]), "discs"),
        (lambda: World(discs=[[0, 0, 0]]), "positive sizes"),
        (lambda: World(rectangles=[[0, 0, 1, -1, 0]]), "rectangles"),
        (lambda: World(unknown_discs=[[0, np.nan, 1]]), "finite"),
        (lambda: World(bounds=(1, 1, 0, 2)), "bounds"),
        (lambda: World(bounds=(0, 1, 0)), "bounds"),
        (lambda: World(grid=GridMap.from_ascii("."), bounds=(0, 5, 0, 5)), "leave bounds out"),
        (lambda: World(movers=("person",)), "Mover"),
        (lambda: World(movers=(Mover.wander((0, 0), 1, 0.3),)), "bounds or a grid"),
        (lambda: World().known_grid(0.1), "an end"),
        (lambda: World(bounds=(0, 1, 0, 1)).known_grid(), "resolution"),
        (lambda: World(bounds=(0, 1, 0, 1)).known_grid(0.0), "resolution"),
        (lambda: World().clearance([0.0, np.nan]), "points"),
        (lambda: World().clearance([0.0, 1.0, 2.0]), "points"),
        (lambda: World().cast([0, 0, np.inf], [0.0], 1.0), "pose"),
        (lambda: World().cast([0, 0, 0], [np.nan], 1.0), "angles"),
        (lambda: World().cast([0, 0, 0], [0.0], -1.0), "range_max"),
        (lambda: World(movers=(Mover.constant((0, 0), (0, 0), 1),)).clearance([0, 0], [[1, 1], [2, 2]]), "1 finite"),
        (lambda: Mover.constant((0, 0), (0, 0), 0.0), "radius"),
        (lambda: Mover.constant((0, np.nan), (0, 0), 1.0), "finite"),
        (lambda: Mover.constant((0, 0, 0), (0, 0), 1.0), "two numbers"),
        (lambda: Mover.patrol([], 1.0, 0.3), "waypoints"),
        (lambda: Mover.patrol([[1, 1], [1, 1]], 1.0, 0.3), "waypoints"),
        (lambda: Mover.wander((0, 0), -1.0, 0.3), "speed"),
        (lambda: Mover(radius=1.0, start=(0, 0), motion="fly"), "motion"),
        (lambda: movers_step(movers_start(World()), 0.0, None, np.random.default_rng(0)), "dt"),
    ],
)
def test_bad_worlds_are_refused(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_a_world_cannot_be_changed_behind_its_back() -> None:
    world = World(discs=[[1.0, 1.0, 0.2]], rectangles=[[2.0, 2.0, 0.2, 0.2, 0.1]], unknown_discs=[[3.0, 3.0, 0.5]])
    for array in (world.discs, world.rectangles, world.unknown_discs, *world.scene):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


@pytest.mark.parametrize("resolution", [1e-5, 1e-300])
def test_a_map_of_too_many_cells_is_refused(resolution):
    with pytest.raises(ValueError, match=r"cells .* are too many"):
        World(bounds=(0, 10, 0, 10)).known_grid(resolution)
