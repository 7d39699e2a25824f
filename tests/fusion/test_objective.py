"""The objective of eq 4.15: what raises it, what lowers it, and what the print would have done."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav.dwa.steps import TABLE_4_1, normalise
from fuzzynav.fusion.objective import DELTA, WEIGHTS, improved_objective, terms

share = st.floats(0.0, 1.0)
tenth = st.integers(0, 20).map(lambda k: k / 10.0)
rows = st.lists(st.tuples(tenth.map(lambda k: 90.0 * k), tenth, tenth, tenth), min_size=2, max_size=9)


def test_the_weights_are_those_of_table_4_1_and_ours() -> None:
    assert WEIGHTS[:3] == TABLE_4_1.weights
    assert WEIGHTS[3] == DELTA == 0.2


def test_the_four_terms_by_hand() -> None:
    """Straight at 0.5 m/s for 3 s: 1.5 m on, heading 0; the target stands 2 m to the left of there."""
    found = terms([0, 0, 0], [[0.5, 0.0]], [1.5, 2.0], ([3.0], [0.7]), 3.0, 2.0)
    np.testing.assert_allclose(found, [[90.0, 2.0, 0.5, 0.7]])


def test_phead_falls_with_the_angle() -> None:
    """Errata T39: the printed angle itself would drive the robot away from its sub-goal."""
    turns = np.linspace(-0.3, 0.3, 13)
    samples = np.column_stack([np.full(13, 0.5), turns])
    found = terms([0, 0, 0], samples, [8.0, 0.0], (np.full(13, 2.0), np.full(13, 2.0)), 3.0, 2.0)
    totals = improved_objective(found, (1.0, 0.0, 0.0, 0.0))
    assert np.argmax(totals) == 6
    assert (np.diff(totals[:7]) > 0).all()
    assert (np.diff(totals[6:]) < 0).all()
    printed = np.column_stack([180.0 - found[:, 0], found[:, 1:]])
    assert np.argmax(improved_objective(printed, (1.0, 0.0, 0.0, 0.0))) in (0, 12)


@given(rows, st.tuples(share, share, share, share).filter(lambda w: sum(w) > 0.1), st.floats(0.1, 10.0))
def test_g_is_the_weighted_sum_of_shares(found: list, weights: tuple, times: float) -> None:
    totals = improved_objective(found, weights)
    by_hand = sum(w * normalise(np.array(found)[:, k]) for k, w in enumerate(weights))
    np.testing.assert_allclose(totals, by_hand, atol=1e-12)
    np.testing.assert_allclose(improved_objective(np.array(found) * times, weights), totals, atol=1e-9)
    whole = np.array(found).sum(axis=0) > 0
    assert totals.sum() == pytest.approx(np.array(weights)[whole].sum())


@pytest.mark.parametrize("column", range(4))
def test_more_of_any_term_is_better(column: int) -> None:
    found = np.ones((3, 4))
    found[1, column] = 1.5
    assert np.argmax(improved_objective(found)) == 1


def test_a_clearance_beyond_d_max_counts_alike() -> None:
    far = terms([0, 0, 0], [[0.5, 0.0], [0.4, 0.0]], [5.0, 0.0], ([2.0, 9.0], [np.inf, 2.0]), 3.0, 2.0)
    assert far[:, 1].tolist() == [2.0, 2.0]
    assert far[:, 3].tolist() == [2.0, 2.0]


@pytest.mark.parametrize("weights", [(1, 1, 1), (1, 1, 1, -0.1), (0, 0, 0, 0), (1, 1, np.nan, 1)])
def test_bad_weights_are_refused(weights: tuple) -> None:
    with pytest.raises(ValueError, match="weights must be four finite numbers"):
        improved_objective(np.ones((2, 4)), weights)
