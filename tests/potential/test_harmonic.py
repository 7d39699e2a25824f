"""Harmonic fields: the mean of the neighbours, no local extremum, the same as another solver."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from fuzzynav.maps.gridmap import GridMap
from fuzzynav.potential.harmonic import climb, harmonic


def scattered(seed: int, share: float = 0.25, size: int = 14) -> GridMap:
    cells = np.random.default_rng(seed).random((size, size)) < share
    cells[0, 0] = cells[-1, -1] = False
    return GridMap(cells)


def test_a_corridor_by_hand() -> None:
    """Three free cells between walls, the goal at the right end: a quarter of the sum of both neighbours."""
    field = harmonic(GridMap(np.zeros((1, 3), dtype=bool)), [2.5, 0.5])
    # a = b/4, b = (a + 1)/4
    assert field[0] == pytest.approx([1 / 15, 4 / 15, 1.0])


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000), share=st.floats(0.0, 0.4))
def test_no_free_cell_but_the_goal_is_a_summit(seed: int, share: float) -> None:
    grid = scattered(seed, share)
    field = harmonic(grid, [13.5, 13.5])
    regions, _ = ndimage.label(~grid.occupied)
    reachable = regions == regions[-1, -1]
    padded = np.pad(field, 1)
    sides = np.stack([padded[1:-1, 2:], padded[1:-1, :-2], padded[2:, 1:-1], padded[:-2, 1:-1]])
    inner = reachable.copy()
    inner[-1, -1] = False
    np.testing.assert_allclose(field[inner], sides.mean(axis=0)[inner], atol=1e-12)
    assert (sides.max(axis=0)[inner] > field[inner]).all()
    assert (field[~reachable] == 0.0).all()


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_it_leads_to_the_goal_wherever_a_way_leads(seed: int) -> None:
    grid = scattered(seed, 0.3)
    made = climb(harmonic(grid, [13.5, 13.5]), grid, [0.5, 0.5])
    regions, _ = ndimage.label(~grid.occupied)
    assert (made.status == "reached") == bool(regions[0, 0] == regions[-1, -1])
    assert not grid.occupied[made.cells[:, 1], made.cells[:, 0]].any()
    assert (np.abs(np.diff(made.cells, axis=0)).sum(axis=1) == 1).all()


def test_another_solver_agrees() -> None:
    """Gauss and Seidel's sweeps, many of them."""
    grid = scattered(5, 0.2, 10)
    field, u = harmonic(grid, [9.5, 9.5]), np.zeros((12, 12))
    regions, _ = ndimage.label(~grid.occupied)
    free = np.argwhere(regions == regions[-1, -1]) + 1
    u[10, 10] = 1.0
    for _ in range(3000):
        for j, i in free[:-1]:
            u[j, i] = 0.25 * (u[j, i + 1] + u[j, i - 1] + u[j + 1, i] + u[j - 1, i])
    np.testing.assert_allclose(field, u[1:-1, 1:-1], atol=1e-9)


def test_small_chances_keep_their_digits() -> None:
    """A corridor of one cell: each step away costs a factor of 2 + sqrt 3, down to 1e-200 and below."""
    grid = GridMap(np.zeros((1, 400), dtype=bool))
    field = harmonic(grid, [399.5, 0.5])[0]
    assert field[0] < 1e-220
    np.testing.assert_allclose(field[51:399] / field[50:398], 2.0 + np.sqrt(3.0), rtol=1e-12)
    assert climb(field[None], grid, [0.5, 0.5]).status == "reached"


def test_bad_input_is_named() -> None:
    grid = scattered(1)
    blocked = np.argwhere(grid.occupied)[0][::-1] + 0.5
    for goal in (blocked, [-1.0, 3.0], [99.0, 3.0]):
        with pytest.raises(ValueError, match="must lie on a free cell"):
            harmonic(grid, goal)
    field = harmonic(grid, [13.5, 13.5])
    with pytest.raises(ValueError, match="outside the map"):
        climb(field, grid, [-3.0, 0.0])
    assert climb(field, grid, blocked).status == "no_path"
