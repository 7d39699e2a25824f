"""Maps: exact distances, lines and rays, held against slow and plain computations."""

import copy
import pickle
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.ndimage import distance_transform_edt

from fuzzynav.maps.gridmap import GridMap

MASKS = hnp.arrays(bool, hnp.array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=9))
relaxed = settings(deadline=None, max_examples=60)  # the first example may wait for the compiler
QUARTER = st.integers(-4, 40).map(lambda k: k / 4)


def squares(grid: GridMap, border: bool = False) -> np.ndarray:
    """Lower left corners (n, 2) [cells] of the occupied squares, with a ring of them round the map where asked."""
    rows, cols = np.nonzero(np.pad(grid.occupied, 1, constant_values=border))
    return np.stack([cols, rows], axis=-1) - 1


def slow_distance(grid: GridMap, points: np.ndarray, border: bool) -> np.ndarray:
    corners = squares(grid, border)
    if len(corners) == 0:
        return np.full(len(points), np.inf)
    gap = np.maximum(np.maximum(corners - points[:, None], points[:, None] - corners - 1), 0.0)
    return np.hypot(gap[..., 0], gap[..., 1]).min(axis=1)


def centres(grid: GridMap) -> np.ndarray:
    rows, cols = np.indices(grid.shape).reshape(2, -1)
    return np.stack([cols, rows], axis=-1) + 0.5


@relaxed
@given(MASKS, st.booleans())
def test_distance_field_is_exact(mask, border):
    grid = GridMap(mask)
    field = grid.distance_field(border=border)
    assert np.allclose(field.ravel(), slow_distance(grid, centres(grid), border), rtol=1e-14)
    assert np.array_equal(field == 0.0, mask)


def test_distance_field_agrees_with_scipy_on_the_half_cell_lattice():
    rng = np.random.default_rng(0)
    mask = rng.random((70, 90)) < 0.01
    fine = np.zeros((141, 181), dtype=bool)
    for dy in range(3):
        for dx in range(3):
            fine[dy : dy + 140 : 2, dx : dx + 180 : 2] |= mask
    assert np.allclose(GridMap(mask, 0.2).distance_field(border=False), distance_transform_edt(~fine)[1::2, 1::2] * 0.1)


@relaxed
@given(MASKS, st.booleans(), st.integers(0, 2**32))
def test_distance_of_any_point_is_exact(mask, border, seed):
    grid = GridMap(mask, 0.5, (1.0, -2.0))
    cells = np.random.default_rng(seed).uniform(0, 1, (20, 2)) * mask.shape[::-1]
    found = grid.distance(cells * 0.5 + grid.origin, border=border)
    assert np.allclose(found, 0.5 * slow_distance(grid, cells, border), atol=1e-12)


@relaxed
@given(MASKS, st.integers(0, 12), st.integers(0, 12))
def test_inflation_grows_with_the_radius_and_blocks_just_the_overlaps(mask, a, b):
    grid = GridMap(mask)
    small, large = grid.inflate(min(a, b) / 4), grid.inflate(max(a, b) / 4)
    assert not (small.occupied & ~large.occupied).any()
    assert not (mask & ~small.occupied).any()
    slow = slow_distance(grid, centres(grid), True).reshape(grid.shape)
    assert np.array_equal(large.occupied, mask | (slow < max(a, b) / 4 - 1e-9))


def crossed_exactly(a, b, i, j, closed: bool) -> bool:
    """Whether the segment meets the square, by clipping in fractions; open squares without their edge."""
    low, high, strict = Fraction(0), Fraction(1), not closed
    for k, left in ((0, i), (1, j)):
        start, along = Fraction(a[k]), Fraction(b[k]) - Fraction(a[k])
        if along == 0:
            inside = left < start < left + 1 if strict else left <= start <= left + 1
            if not inside:
                return False
            continue
        first, second = sorted(((left - start) / along, (left + 1 - start) / along))
        low, high = max(low, first), min(high, second)
    if strict and a == b:
        return all(left < Fraction(v) < left + 1 for v, left in zip(a, (i, j), strict=True))
    return low < high if strict else low <= high


@relaxed
@given(QUARTER, QUARTER, QUARTER, QUARTER, st.sampled_from(["strict", "permissive"]))
def test_supercover_is_every_square_met(ax, ay, bx, by, rule):
    grid = GridMap(np.zeros((9, 9), dtype=bool))
    found = grid.line_cells([ax, ay], [bx, by], rule)
    wanted = {
        (i, j)
        for i in range(-3, 13)
        for j in range(-3, 13)
        if crossed_exactly((ax, ay), (bx, by), i, j, rule == "strict")
    }
    assert {tuple(c) for c in found.tolist()} == wanted
    assert len(found) == len(wanted)
    assert {tuple(c) for c in grid.line_cells([bx, by], [ax, ay], rule).tolist()} == wanted
    way = (found + 0.5 - [ax, ay]) @ [bx - ax, by - ay]
    assert np.all(np.diff(way) > -1e-9)


@relaxed
@given(MASKS, st.integers(0, 2**32), st.sampled_from(["strict", "permissive"]))
def test_sight_is_clear_when_no_met_cell_is_occupied(mask, seed, rule):
    grid = GridMap(mask)
    a, b = np.random.default_rng(seed).integers(1, 4 * np.array(mask.shape[::-1]), (2, 2)) / 4
    cells = grid.line_cells(a, b, rule)
    cells = cells[grid.contains(cells)]
    assert grid.clear_line(a, b, corners=rule) == (not mask[cells[:, 1], cells[:, 0]].any())
    assert grid.clear_line(a, b, corners=rule) == grid.clear_line(b, a, corners=rule)


@relaxed
@given(MASKS, st.integers(0, 2**32), st.floats(0.05, 2.0))
def test_a_disc_passes_where_its_centre_keeps_the_radius(mask, seed, radius):
    grid = GridMap(mask)
    a, b = np.random.default_rng(seed).uniform(0, 1, (2, 2)) * mask.shape[::-1]
    line = a + np.linspace(0, 1, 2001)[:, None] * (b - a)
    nearest = slow_distance(grid, line, True).min()
    if abs(nearest - radius) > 0.02:
        assert grid.clear_line(a, b, radius) == (nearest > radius)


def test_a_disc_passes_a_corner_far_from_both_ends_of_its_way():
    """The line y = x + 1 runs sqrt(1/2) beside the corner (10, 10)."""
    mask = np.zeros((20, 20), dtype=bool)
    mask[9, 10] = True
    for a, b in (([2, 3], [17, 18]), ([17, 18], [2, 3])):
        assert GridMap(mask).clear_line(a, b, radius=0.70)
        assert not GridMap(mask).clear_line(a, b, radius=0.72)


@pytest.mark.parametrize("resolution", [1.0, 0.1, 0.05, 0.3])
def test_inflation_leaves_what_the_disc_only_touches(resolution):
    grid = GridMap.from_ascii("#....", resolution)
    for cells in (0.5, 1.5, 2.5):
        assert grid.inflate(cells * resolution, border=False).to_ascii().strip() == "#" * int(cells + 0.5) + "." * int(
            5.0 - cells
        )


def test_corner_rules_by_example():
    gap = GridMap.from_ascii("#.\n.#")
    assert not gap.clear_line([0.5, 0.5], [1.5, 1.5])
    assert gap.clear_line([0.5, 0.5], [1.5, 1.5], corners="permissive")
    assert gap.move_allowed((0, 0), (1, 1), "permissive")
    assert not gap.move_allowed((0, 0), (1, 1), "strict")
    assert not gap.move_allowed((0, 0), (1, 0))
    assert not gap.move_allowed((0, 0), (-1, 0))
    wall = GridMap.from_ascii("###\n...")
    assert not wall.clear_line([0.5, 1.0], [2.5, 1.0])
    assert wall.clear_line([0.5, 0.5], [2.5, 0.5], radius=0.5)
    assert not wall.clear_line([0.5, 0.5], [2.5, 0.5], radius=0.51)


def slow_ray(grid: GridMap, x: float, y: float, heading: float, reach: float) -> float:
    """Least entry into a closed occupied square, with a ring of squares for the border."""
    best = reach
    for i, j in squares(grid, True):
        low, high = 0.0, reach
        for start, along, left in ((x, np.cos(heading), i), (y, np.sin(heading), j)):
            if abs(along) < 1e-300:
                low, high = (low, high) if left <= start <= left + 1 else (1.0, 0.0)
                continue
            first, second = sorted(((left - start) / along, (left + 1 - start) / along))
            low, high = max(low, first), min(high, second)
        if low <= high:
            best = min(best, low)
    return best


@relaxed
@given(MASKS, st.integers(0, 2**32), st.sampled_from([3.3, 50.0]))
def test_rays_end_on_the_face_of_the_nearest_square(mask, seed, reach):
    rng = np.random.default_rng(seed)
    grid = GridMap(mask)
    pose = [*(rng.uniform(0.01, 0.99, 2) * mask.shape[::-1]), rng.uniform(-4, 4)]
    angles = rng.uniform(-np.pi, np.pi, 12)
    wanted = [slow_ray(grid, *pose[:2], pose[2] + angle, reach) for angle in angles]
    assert np.allclose(grid.cast(pose, angles, reach), wanted, atol=1e-9)


def test_jumping_over_empty_ground_changes_no_ray():
    rng = np.random.default_rng(3)
    mask = rng.random((200, 300)) < 0.002
    poses = np.column_stack([rng.uniform(0, 30, 40), rng.uniform(0, 20, 40), rng.uniform(-3, 3, 40)])
    angles = np.linspace(-np.pi, np.pi, 181)
    walking = np.stack([GridMap(mask, 0.1).cast(p, angles[k : k + 1], 60.0)[0] for p in poses for k in range(181)])
    jumping = GridMap(mask, 0.1).cast(poses, angles, 60.0)
    assert np.array_equal(jumping, walking.reshape(40, 181))
    assert jumping.max() < 36.1


def test_ray_through_a_corner_stops_and_axis_rays_are_exact():
    grid = GridMap.from_ascii("#.\n.#", 0.5)
    assert grid.cast([0.25, 0.25, 0.0], [np.pi / 4], 9.0)[0] == pytest.approx(np.sqrt(2) / 4)
    room = GridMap.from_ascii("....\n....\n...#")
    assert room.cast([0.5, 0.5, np.pi / 2], [-np.pi / 2, 0.0, np.pi / 2], 9.0).tolist() == [2.5, 2.5, 0.5]
    assert room.cast([0.5, 0.5, 0.0], [np.pi / 2], 9.0, border=False).tolist() == [9.0]
    assert room.cast([3.5, 0.5, 0.0], [0.0], 9.0).tolist() == [0.0]


@relaxed
@given(MASKS, st.integers(0, 2**32))
def test_mirrored_map_mirrored_rays(mask, seed):
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(0, 1, 2) * mask.shape[::-1]
    angles = rng.uniform(-np.pi, np.pi, 10)
    mirrored = GridMap(mask[:, ::-1]).cast([mask.shape[1] - x, y, 0.0], np.pi - angles, 30.0)
    assert np.allclose(GridMap(mask).cast([x, y, 0.0], angles, 30.0), mirrored, atol=1e-9)


def test_cells_points_and_what_lies_outside():
    grid = GridMap.from_ascii("..#\n?..", 0.5, (-1.0, 2.0))
    assert grid.shape == (2, 3)
    assert grid.extent == (-1.0, 0.5, 2.0, 3.0)
    assert grid.cell_of([-0.1, 2.6]).tolist() == [1, 1]
    assert grid.center_of([1, 1]).tolist() == [-0.25, 2.75]
    assert grid.is_occupied([[0.2, 2.7], [0.2, 2.2], [0.6, 2.2], [-1.01, 2.2]]).tolist() == [True, False, True, True]
    assert grid.unknown[0, 0]
    assert not grid.is_occupied([-0.8, 2.2])
    assert grid.unknown_as_occupied().is_occupied([-0.8, 2.2])
    assert grid.to_ascii() == "..#\n?.."


def test_a_map_keeps_its_own_copy():
    mask = np.zeros((2, 2), dtype=bool)
    grid = GridMap(mask)
    mask[:] = True
    grid.distance_field()[:] = 7.0
    assert not grid.occupied.any()
    assert grid.distance_field().max() == 0.5


@pytest.mark.parametrize(
    "array",
    [
        lambda g: g.occupied,
        lambda g: g.unknown,
        lambda g: g.field_in_cells(),
        lambda g: g.skip_in_cells(),
        lambda g: copy.deepcopy(g).occupied,
        lambda g: pickle.loads(pickle.dumps(g)).occupied,
        lambda g: replace(g, resolution=2.0).unknown,
        lambda g: g.inflate(0.3).occupied,
        lambda g: g.unknown_as_occupied().occupied,
    ],
)
def test_a_map_cannot_be_written_to(array):
    grid = GridMap.from_ascii("..#\n?..")
    before = grid.distance_field()
    with pytest.raises(ValueError, match="read-only"):
        array(grid)[0, 0] = True
    assert np.array_equal(grid.distance_field(), before)


COMPILED_ONCE = """
import numpy as np
from fuzzynav import localization, mapping
from fuzzynav.localization import particles
from fuzzynav.mapping import occupancy
from fuzzynav.maps import kernels
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.sensors import Scan
from fuzzynav.world import kernels as world_kernels
from fuzzynav.world.world import World
grid = GridMap(np.eye(9, dtype=bool)[::-1])
belief = localization.Belief([4.5, 2.5, 0.0], np.eye(3))
swarm = particles.spread(belief, 8, np.random.default_rng(0))
for poses in (belief.mean, swarm.poses, np.array(swarm.poses), swarm.poses[::2], belief.mean.tolist()):
    for angles in (np.zeros(4), np.zeros(8)[::2], [0.0]):
        grid.cast(poses, angles, 5.0)
        grid.distance([4.5, 2.5])
        grid.cast(poses, angles, 5.0)
        mapping.build(poses, np.ones((len(np.atleast_2d(poses)), len(angles))), angles)
    scan = Scan(angles=np.zeros(2), ranges=np.ones(2), range_max=2.0)
    params = particles.MonteCarlo()
    particles.log_likelihoods(poses, scan, particles.likelihood_field(grid, params), params)
for world in (World(grid=grid), World(bounds=(0, 9, 0, 9))):
    world.cast([4.5, 2.5, 0.0], np.zeros(4), 5.0)
    world.clearance([4.5, 2.5])
for k in (kernels.cast_rays, kernels.distance_field, kernels.distances_at, occupancy._update, particles._score,
          world_kernels.scan, world_kernels.clearance):
    assert len(k.signatures) == 1, (k, k.signatures)
print("once")
"""


def test_every_kernel_serves_all_arrays_with_one_compilation():
    done = subprocess.run([sys.executable, "-c", COMPILED_ONCE], capture_output=True, text=True, timeout=300)
    assert done.stdout == "once\n", done.stderr


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"occupied": np.zeros((0, 3), dtype=bool)}, "at least one cell"),
        ({"occupied": np.zeros(3, dtype=bool)}, "two-dimensional"),
        ({"occupied": np.zeros((2, 2))}, "boolean"),
        ({"resolution": 0.0}, "resolution"),
        ({"resolution": np.nan}, "resolution"),
        ({"origin": (0.0, np.inf)}, "origin"),
        ({"origin": (0.0,)}, "origin"),
        ({"unknown": np.zeros((1, 2), dtype=bool)}, "unknown has shape"),
        ({"occupied": np.ones((2, 2), dtype=bool), "unknown": np.eye(2, dtype=bool)}, "both unknown and occupied"),
    ],
)
def test_malformed_maps_are_refused(fields, words):
    with pytest.raises(ValueError, match=words):
        GridMap(**{"occupied": np.zeros((2, 2), dtype=bool), **fields})


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda g: g.inflate(-1.0), "radius"),
        (lambda g: g.inflate(np.nan), "radius"),
        (lambda g: g.clear_line([0, 0], [1, np.nan]), "finite"),
        (lambda g: g.clear_line([0, 0], [1, 1], -0.1), "radius"),
        (lambda g: g.clear_line([0, 0], [1, 1], corners="loose"), "corners"),
        (lambda g: g.cast([0, 0, np.nan], [0.0], 1.0), "pose"),
        (lambda g: g.cast([0, 0, 0], [np.inf], 1.0), "angles"),
        (lambda g: g.cast([0, 0], [0.0], 1.0), "pose"),
        (lambda g: g.cast([0, 0, 0], [0.0], 0.0), "range_max"),
        (lambda g: g.is_occupied([np.nan, 0.0]), "points"),
        (lambda g: g.distance([[0.0, np.inf]]), "points"),
        (lambda g: g.line_cells([0, 0], [1e9, 0]), "longer than a million cells"),
        (lambda g: g.line_cells([0, -1e308], [0, 1e308]), "longer than a million cells"),
    ],
)
def test_bad_arguments_are_refused(call, words):
    with pytest.raises(ValueError, match=words):
        call(GridMap(np.zeros((2, 2), dtype=bool)))


@pytest.mark.filterwarnings("error")
def test_points_at_the_end_of_the_world_lie_outside():
    grid = GridMap.from_ascii("..\n..")
    assert grid.is_occupied([[1e300, 0.5], [-1e300, 0.5], [0.5, 1e19], [0.5, 0.5]]).tolist() == [True] * 3 + [False]
    assert (grid.cell_of([[1e300, -1e300]]) == [[2**62, -(2**62)]]).all()
