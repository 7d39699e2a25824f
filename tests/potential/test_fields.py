"""Potential fields: the force is minus the gradient, known values, and what the print leaves out."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav.geometry import Array
from fuzzynav.potential import CLASSICAL, Gains, discs, force, potential, printed_force, walls

SCENE = np.vstack([discs([[2.0, 2.0, 0.3], [4.0, 1.0, 0.0]]), walls([[5.0, 5.0], [6.0, 5.0], [6.0, 6.0]], 0.1)])
GOAL = np.array([8.0, 8.0])
H = 1e-6


def slope(point: Array, gains: Gains, radius: float = 0.0) -> Array:
    """Minus the gradient of the potential by central differences."""
    steps = H * np.eye(2)
    up = potential(point + steps, GOAL, SCENE, gains, radius)
    down = potential(point - steps, GOAL, SCENE, gains, radius)
    return -(up - down) / (2 * H)


@settings(max_examples=300)
@given(
    place=st.tuples(st.floats(0, 9), st.floats(0, 9)),
    exponent=st.sampled_from([0.0, 1.0, 2.0, 3.5, 10.0]),
    conic=st.sampled_from([np.inf, 3.0]),
    radius=st.sampled_from([0.0, 0.2]),
)
def test_the_force_is_minus_the_gradient(
    place: tuple[float, float], exponent: float, conic: float, radius: float
) -> None:
    point, gains = np.array(place), Gains(exponent=exponent, conic=conic)
    rows = SCENE.copy()
    middle = np.clip(((point - rows[:, :2]) * (rows[:, 2:4] - rows[:, :2])).sum(1), 0, 1)[:, None]
    away = np.hypot(*(point - rows[:, :2] - middle * (rows[:, 2:4] - rows[:, :2])).T) - rows[:, 4] - radius
    far = np.abs(np.hypot(*(point - GOAL)) - 3.0) > 1e-3 and np.hypot(*(point - GOAL)) > 1e-2
    if (away > 0.2).all() and far and (np.abs(away - 5.0) > 1e-3).all():
        found, wanted = force(point, GOAL, SCENE, gains, radius), slope(point, gains, radius)
        np.testing.assert_allclose(found, wanted, rtol=2e-6, atol=2e-6)


def test_by_hand() -> None:
    # 1 m from a point, 5 m from the goal: eta d = 10 towards the goal, k (1 - 1/5) = 16 away, k (1 - 1/5)/1^2 right
    found = force([3.0, 0.0], [8.0, 0.0], discs([[4.0, 0.0]]), CLASSICAL)
    assert found == pytest.approx([10.0 - 16.0, 0.0])
    assert potential([3.0, 0.0], [8.0, 0.0], discs([[4.0, 0.0]]), CLASSICAL) == pytest.approx(25.0 + 10 * 0.64)
    # 2 m away the print and the gradient differ by 1/rho^2 = 1/4
    right, printed = (f([2.0, 0.0], [8.0, 0.0], discs([[4.0, 0.0]]), CLASSICAL)[0] for f in (force, printed_force))
    assert right == pytest.approx(12.0 - 20 * 0.3 / 4)
    assert printed == pytest.approx(12.0 - 20 * 0.3)


def test_a_wall_is_as_near_as_its_nearest_point() -> None:
    wall, gains = walls([[0.0, 0.0], [4.0, 0.0]], 0.1), Gains(attract=0.0)
    for place, gap in (([2.0, 1.1], 1.0), ([3.5, -1.6], 1.5), ([5.1, 0.0], 1.0), ([-3.0, 4.0], 4.9)):
        assert potential(place, GOAL, wall, gains) == pytest.approx(10.0 * (1.0 / gap - 0.2) ** 2)
    assert force([2.0, 1.1], GOAL, wall, gains) == pytest.approx([0.0, 16.0])


def test_the_second_term_points_to_the_goal() -> None:
    """What eq 9 leaves out (errata A5): with the distance factor the field also falls towards the goal."""
    block, gains = discs([[4.0, 1.0]]), Gains(exponent=4.0)
    at = np.array([4.0, 0.0])
    d = 4.0
    more = 0.5 * (1.0 - 0.2) ** 2 * 20.0 * 4.0 * d**3 / (d + 1.0) ** 5
    sideways = 20.0 * (d / (d + 1.0)) ** 4 * (1.0 - 0.2)
    assert force(at, [8.0, 0.0], block, gains) == pytest.approx([2.0 * d + more, -sideways])
    assert printed_force(at, [8.0, 0.0], block, gains) == pytest.approx([2.0 * d, -sideways])


def test_beyond_its_influence_an_obstacle_is_not_there() -> None:
    point = [0.0, 0.0]
    near, far = (discs([[x, 0.0, 0.5]]) for x in (5.49, 5.51))
    empty = force(point, GOAL, [], CLASSICAL)
    assert (force(point, GOAL, far, CLASSICAL) == empty).all()
    assert force(point, GOAL, near, CLASSICAL)[0] < empty[0]
    assert force(point, GOAL, far, CLASSICAL, 0.1)[0] < empty[0]  # a wider robot is nearer


@given(turn=st.floats(-3.0, 3.0), x=st.floats(-3, 3), y=st.floats(-3, 3))
def test_turning_and_moving_the_scene_turns_the_force(turn: float, x: float, y: float) -> None:
    c, s = np.cos(turn), np.sin(turn)
    spin, shift = np.array([[c, -s], [s, c]]), np.array([x, y])
    rows = SCENE.copy()
    rows[:, :2], rows[:, 2:4] = SCENE[:, :2] @ spin.T + shift, SCENE[:, 2:4] @ spin.T + shift
    at, gains = np.array([3.0, 3.5]), Gains(exponent=2.0)
    there = force(spin @ at + shift, spin @ GOAL + shift, rows, gains)
    np.testing.assert_allclose(there, spin @ force(at, GOAL, SCENE, gains), atol=1e-9)


def test_a_conic_attraction_has_one_size_beyond_its_distance() -> None:
    gains = Gains(conic=2.0)
    assert np.hypot(*force([0.0, 0.0], [8.0, 0.0], [], gains)) == pytest.approx(4.0)
    assert np.hypot(*force([7.0, 0.0], [8.0, 0.0], [], gains)) == pytest.approx(2.0)
    steps = potential([[5.999, 0.0], [6.001, 0.0]], [8.0, 0.0], [], gains)
    assert steps[0] - steps[1] == pytest.approx(0.008, abs=1e-5)


def test_at_the_goal_nothing_pulls_and_nothing_divides_by_zero() -> None:
    block = discs([[8.5, 8.0]])
    assert (
        force(GOAL, GOAL, block, Gains(exponent=3.0)) == 0.0
    ).all()  # with the distance factor, right beside a block
    assert force(GOAL, GOAL, block, CLASSICAL)[0] < 0.0  # without it the goal is out of reach


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda: Gains(attract=-1.0), "attract"),
        (lambda: Gains(influence=0.0), "influence"),
        (lambda: Gains(conic=0.0), "conic must be a positive distance"),
        (lambda: force([1.0, 2.0, 3.0], GOAL, SCENE, CLASSICAL), "x and y in their last axis"),
        (lambda: force([1.0, 2.0], [np.nan, 0.0], SCENE, CLASSICAL), "the goal"),
        (lambda: force([1.0, 2.0], GOAL, [[1.0, 2.0]], CLASSICAL), "rows x1, y1, x2, y2, radius"),
        (lambda: discs([[1.0, 2.0, -0.1]]), "radii of 0 m or more"),
        (lambda: walls([[1.0, 2.0]]), "two points"),
    ],
)
def test_bad_input_is_named(wrong: object, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        wrong()  # type: ignore[operator]
