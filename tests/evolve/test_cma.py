"""The evolution strategy finds what can be found, and repeats itself."""

import numpy as np

from fuzzynav import evolve


def test_evolution_finds_the_bottom_of_a_bowl() -> None:
    target = np.linspace(-1, 1, 6)
    means = evolve.minimise(lambda x: float(((x - target) ** 2 * np.arange(1, 7)).sum()), np.zeros(6), 0.5, 60)
    assert np.abs(means[-1] - target).max() < 0.05
    again = evolve.minimise(lambda x: float(((x - target) ** 2 * np.arange(1, 7)).sum()), np.zeros(6), 0.5, 60)
    np.testing.assert_array_equal(means[-1], again[-1])
