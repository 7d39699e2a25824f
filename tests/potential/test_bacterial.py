"""The pseudo-bacterial field: it repeats, never gets worse, stays in its ranges, and frees what fixed gains do not."""

import numpy as np
import pytest

from fuzzynav.potential import IMPROVED, Steps, discs, walk
from fuzzynav.potential.bacterial import Bacterial, bacterial_field

SCENE = ([0.0, 0.0], [8.0, 8.0], discs([[4.0, 4.1, 0.3], [6.0, 5.2, 0.4], [2.0, 3.2, 0.3]]))
QUICK = Steps(step=0.05, tolerance=0.1, most=1000, watch=40)


def test_it_repeats_and_never_gets_worse() -> None:
    made = [bacterial_field(SCENE, QUICK, np.random.default_rng(3), radius=0.2) for _ in range(2)]
    assert made[0].gains == made[1].gains
    assert (np.diff(made[0].history) <= 0.0).all()
    assert len(made[0].history) == 6
    assert made[0].walk.status == "reached"
    assert made[0].walk.length == pytest.approx(made[0].history[-1])


def test_it_is_no_longer_than_the_gains_of_table_2() -> None:
    fixed = walk(*SCENE, IMPROVED, QUICK, radius=0.2)
    found = bacterial_field(SCENE, QUICK, np.random.default_rng(1), radius=0.2)
    assert fixed.status != "reached" or found.walk.length <= fixed.length + 0.05


def test_gains_stay_in_their_ranges() -> None:
    options = Bacterial(attract=(1.0, 1.5), repel=(3.0, 4.0), population=3, generations=2)
    for seed in range(5):
        gains = bacterial_field(SCENE, QUICK, np.random.default_rng(seed), radius=0.2, options=options).gains
        assert 1.0 <= gains.attract <= 1.5
        assert 3.0 <= gains.repel <= 4.0


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"population": 0}, "1 or more"),
        ({"survivors": 1.5}, "survivors"),
        ({"attract": (2.0, 1.0)}, "two rising gains"),
        ({"repel": (0.0, 1.0)}, "repel"),
    ],
)
def test_bad_input_is_named(wrong: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Bacterial(**wrong)  # type: ignore[arg-type]
