"""Walks down a field: printed and right steps, endings with their names, traps, and virtual targets."""

import numpy as np
import pytest

from fuzzynav.data import folder
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.potential import AS_PRINTED, CLASSICAL, IMPROVED, Escape, Gains, Steps, discs, force, walk, walls
from fuzzynav.potential.walks import STATUSES

RULES = FuzzySystem.load(folder("fuzzy") / "fuzzy_apf_table_1.fll")
HEAD_ON = discs([[4.0, 4.0, 0.3]])


@pytest.mark.parametrize(("tolerance", "count"), [(0.1, 793), (0.3, 779), (0.4, 772), (0.5, 765)])
def test_the_printed_step_moves_each_axis(tolerance: float, count: int) -> None:
    """8 m on each axis at 0.01 m: 800 steps, less the tolerance on the diagonal."""
    made = walk([0, 0], [8, 8], [], CLASSICAL, Steps(axes=True, tolerance=tolerance))
    assert (made.status, made.iterations) == ("reached", count)
    assert np.abs(np.diff(made.places, axis=0)) == pytest.approx(0.01)


def test_a_right_step_has_its_length() -> None:
    made = walk([0, 0], [8, 8], [], CLASSICAL, Steps(tolerance=0.3))
    assert made.iterations == 1102  # (11.3137 - 0.3)/0.01
    assert np.hypot(*np.diff(made.places, axis=0).T) == pytest.approx(0.01)
    assert made.length == pytest.approx(11.02)


def test_two_points_give_the_counts_of_table_3_nearly() -> None:
    """The printed force with printed steps past two points that were sought: 1002 to 780 (printed 1012 to 772)."""
    steps = Steps(axes=True, tolerance=0.285)
    points = discs([[4.62, 4.11], [3.55, 5.68]])
    made = [walk([0, 0], [8, 8], points, Gains(exponent=n), steps, printed=True).iterations for n in range(1, 15)]
    assert made == [1002, 884, 848, 830, 816, 804, 795, 789, 784, 780, 780, 780, 780, 780]


def test_a_wall_across_the_way_is_a_trap_with_a_name() -> None:
    across = walls([[3.0, 5.0], [5.0, 3.0]], 0.1)
    for steps in (Steps(), AS_PRINTED):
        made = walk([0, 0], [8, 8], across, IMPROVED, steps)
        assert made.status == "local_minimum"
        assert len(made.trapped) == 1
        assert np.hypot(*(made.places[-1] - [8, 8])) > 4.0


def test_an_obstacle_beside_the_goal_keeps_the_robot_off_and_the_distance_factor_does_not() -> None:
    beside = discs([[8.3, 8.3]])
    assert walk([0, 0], [8, 8], beside, CLASSICAL, Steps()).status == "local_minimum"
    assert walk([0, 0], [8, 8], beside, IMPROVED, Steps()).status == "reached"


def test_a_slight_offset_frees_what_a_head_on_obstacle_stops() -> None:
    assert walk([0, 0], [8, 8], HEAD_ON, IMPROVED, Steps()).status == "local_minimum"
    made = walk([0, 0], [8, 8], discs([[4.0, 4.1, 0.3]]), IMPROVED, Steps())
    assert made.status == "reached"
    assert (np.hypot(*(made.places - [4.0, 4.1]).T) > 0.3).all()


def test_a_virtual_target_frees_a_robot_that_stands_before_a_disc() -> None:
    free = Escape(rules=RULES, goalward=True, radius=5.0)
    made = walk([0, 0], [8, 8], HEAD_ON, IMPROVED, Steps(), escape=free)
    assert made.status == "reached"
    assert len(made.trapped) >= 1
    assert walk([0, 0], [8, 8], HEAD_ON, IMPROVED, Steps(), escape=Escape(rules=RULES, gain=0.0, most=3)).status == (
        "local_minimum"
    )


def test_the_pull_is_that_of_the_rules() -> None:
    """The first step of a freed robot: the force of the field and k rho of the virtual target at its angle."""
    free = Escape(rules=RULES, radius=2.0, strong=30.0)
    steps = Steps(watch=5, share=1.0)  # trapped at once: no walk keeps all of its steps on a bend
    made = walk([0, 0], [8, 0], discs([[4.0, 0.5, 0.2]]), Gains(repel=5.0), steps, escape=free)
    k = int(made.trapped[0])
    at = made.places[k]
    pull = force(at, [8, 0], discs([[4.0, 0.5, 0.2]]), Gains(repel=5.0))
    angle, gain = RULES(min(np.hypot(*pull) / 30.0, 1.0), min(np.hypot(*(at - [8, 0])) / 11.32, 1.0))
    a = angle * np.pi / 3
    whole = pull + gain * 5.0 * 2.0 * np.array([np.cos(a), np.sin(a)])
    np.testing.assert_allclose(made.places[k + 1] - at, 0.01 * whole / np.hypot(*whole), atol=1e-9)


def test_sides_change_and_holds_grow_until_it_gives_up() -> None:
    cup = walls([[3.0, 5.0], [5.0, 5.0], [5.0, 3.0]], 0.1)
    free = Escape(rules=RULES, goalward=True, turns=True, growth=1.5, hold=80, most=4)
    made = walk([0, 0], [8, 8], cup, IMPROVED, Steps(most=20_000), escape=free)
    assert made.status == "local_minimum"
    assert len(made.trapped) == 5
    gaps = np.diff(made.trapped)
    assert (np.diff(gaps) > 0).all()
    moves = [made.places[k + 75] - made.places[k] for k in made.trapped[:4]]
    sides = [move[1] - move[0] for move in moves]  # left of the diagonal, or right of it
    assert (np.sign(sides) == [1, -1, 1, -1]).all()


def test_a_walk_that_touches_ends_so() -> None:
    made = walk([0, 0], [8, 8], HEAD_ON, Gains(repel=0.0), Steps())
    assert made.status == "collided"
    assert np.hypot(*(made.places[-1] - 4.0)) <= 0.3
    assert set(STATUSES) == {"reached", "collided", "local_minimum", "timeout"}


def test_too_few_iterations_are_a_timeout() -> None:
    assert walk([0, 0], [8, 8], [], CLASSICAL, Steps(most=100)).status == "timeout"


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda: walk([4.0, 4.0], [8, 8], HEAD_ON, CLASSICAL, Steps()), "the start touches an obstacle"),
        (lambda: walk([0, 0], [4.1, 4.0], HEAD_ON, CLASSICAL, Steps()), "the goal touches an obstacle"),
        (lambda: walk([0, np.inf], [8, 8], HEAD_ON, CLASSICAL, Steps()), "the start"),
        (lambda: Steps(step=0.0), "step"),
        (lambda: Steps(most=0), "iterations of 1 or more"),
        (lambda: Escape(rules=RULES, hold=0), "hold, most and cycle must be 1 or more"),
        (lambda: Escape(rules=FuzzySystem.load(folder("fuzzy") / "thesis_table_3_2.fll")), "two inputs"),
    ],
)
def test_bad_input_is_named(wrong: object, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        wrong()  # type: ignore[operator]
