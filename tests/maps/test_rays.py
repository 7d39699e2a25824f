"""Rays end, and end where exact arithmetic says: the walk against intersections in fractions, cell edges included."""

import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest

from fuzzynav.maps import kernels
from fuzzynav.maps.gridmap import GridMap

INF = Fraction(10**9)

HANGING = """
import numpy as np
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.world import World
occupied = np.zeros((20, 20), dtype=bool)
occupied[12, 4:8] = True
angles = np.linspace(-np.pi, np.pi, 360, endpoint=False)
for heading in (0.0, np.pi / 2, np.pi, -np.pi / 2):
    poses = [[x, y, heading] for x in range(1, 10) for y in range(1, 10)]
    for border in (True, False):
        grid = GridMap(occupied, 0.5)
        grid.distance_field(border)
        ranges = grid.cast(poses, angles, 10.0, border)
        assert np.isfinite(ranges).all()
    World(grid=GridMap(occupied, 0.5)).cast(poses, angles, 10.0)
nothing = GridMap(np.zeros((9, 9), dtype=bool))
nothing.distance_field(border=False)
assert np.isinf(nothing.cast([4, 4, 0], angles, np.inf, border=False)).all()
print("done")
"""


def test_every_ray_ends() -> None:
    """Whole metres on half-metre cells: beams almost along an axis that start on a cell's edge beside an obstacle."""
    done = subprocess.run([sys.executable, "-c", HANGING], capture_output=True, text=True, timeout=180)
    assert done.stdout == "done\n", done.stderr


def entry(
    square: tuple[int, int], start: tuple[Fraction, Fraction], along: tuple[Fraction, Fraction], margin: Fraction
) -> Fraction:
    """Least t >= 0 at which start + t along lies in the closed square, grown by a margin; INF where none does."""
    low, high = Fraction(0), INF
    for left, at, step in zip(square, start, along, strict=True):
        if step == 0:
            if not left <= at <= left + 1:
                return INF
            continue
        first, second = sorted(((left - margin - at) / step, (left + 1 + margin - at) / step))
        low, high = max(low, first), min(high, second)
    return low if low <= high else INF


def met(square: tuple[int, int], start: tuple[Fraction, Fraction], along: tuple[Fraction, Fraction]) -> bool:
    """Whether a square that the ray touches must stop it: it is more than a contact at the start, or a graze."""
    for left, at, step in zip(square, start, along, strict=True):
        if step == 0 and at in (left, left + 1):
            return False
        if (step > 0 and at >= left + 1) or (step < 0 and at <= left):
            return False
    return True


def bounds(mask: np.ndarray, x: float, y: float, heading: float) -> tuple[float, float]:
    """Range with every contact counted, and without those at the start and along an edge; 1e9 for none.

    A slanted ray that passes a corner within 2e-9 cells touches it: that is the rule of the kernels.
    """
    start = Fraction(x), Fraction(y)
    along = Fraction(float(np.cos(heading))), Fraction(float(np.sin(heading)))
    near = Fraction(2e-9) if min(abs(along[0]), abs(along[1])) > 1e-6 else Fraction(0)
    squares = [(i, j) for j, i in np.argwhere(mask).tolist()]
    every = min([entry(s, start, along, near) for s in squares], default=INF)
    return float(every), float(
        min([entry(s, start, along, Fraction(0)) for s in squares if met(s, start, along)], default=INF)
    )


def heading_near_an_axis(rng: np.random.Generator) -> float:
    return float(rng.integers(-4, 5) * np.pi / 4 + rng.choice([0.0, 0.0, 1e-17, -1e-17, 1e-16, -1e-16, 1e-12, -1e-12]))


@pytest.mark.parametrize("seed", range(30))
@pytest.mark.parametrize("jumping", [True, False])
def test_rays_agree_with_exact_arithmetic(seed: int, jumping: bool) -> None:
    """100 rays a seed: from lattice points, edges and open ground, along axes, diagonals and anywhere."""
    rng = np.random.default_rng(seed)
    mask = rng.random(rng.integers(3, 22, 2)) < rng.choice([0.02, 0.1, 0.3])
    grid = GridMap(mask)
    skip = grid.skip_in_cells(border=False) if jumping else np.empty((0, 0), dtype=np.uint8)
    exact = 0
    for _ in range(100):
        x, y = rng.uniform(0, mask.shape[1]), rng.uniform(0, mask.shape[0])
        x, y = (np.floor(x) if rng.random() < 0.5 else x), (np.floor(y) if rng.random() < 0.5 else y)
        heading = heading_near_an_axis(rng) if rng.random() < 0.6 else float(rng.uniform(-4, 4))
        every, only_met = bounds(mask, x, y, heading)
        inside = mask[int(y), int(x)]
        found = kernels.ray_length(mask, skip, x, y, np.cos(heading), np.sin(heading), 1e9, False)
        assert every - 1e-8 <= found <= (0.0 if inside else only_met) + 1e-9, (x, y, heading)
        exact += abs(every - only_met) < 1e-7
    assert exact > 50


def test_a_ray_along_an_edge_belongs_to_the_upper_or_right_cell() -> None:
    below, above = GridMap.from_ascii("....\n...#"), GridMap.from_ascii("...#\n....")
    for grid, wanted in ((below, 4.0), (above, 3.0)):
        assert grid.cast([0.0, 1.0, 0.0], [0.0], 9.0).tolist() == [wanted]
    left, right = GridMap.from_ascii("#.\n..\n.."), GridMap.from_ascii(".#\n..\n..")
    for grid, wanted in ((left, 3.0), (right, 2.0)):
        assert kernels.ray_length(grid.occupied, np.empty((0, 0), np.uint8), 1.0, 0.0, 0.0, 1.0, 9.0, True) == wanted


@pytest.mark.parametrize("lean", [0.0, 1e-17, -1e-17, 1e-16, -1e-16])
@pytest.mark.parametrize("quarter", range(4))
def test_beams_almost_along_an_axis_from_a_cells_edge(quarter: int, lean: float) -> None:
    """The beam runs on past the obstacle beside its start; the obstacle ahead, on both sides of the line, stops it."""
    mask = np.zeros((30, 30), dtype=bool)
    mask[17:19, 14:16] = mask[13, 14:16] = mask[:2] = mask[28:] = mask[:, :2] = mask[:, 28:] = True
    grid = GridMap(mask)
    grid.distance_field()
    heading = quarter * np.pi / 2 + lean
    found = grid.cast([15.0, 15.0, heading], [0.0], 50.0)[0]
    assert found == pytest.approx([13.0, 2.0, 13.0, 1.0][quarter], abs=1e-9)
