"""Traps: seeded, truly traps, truly with a way out, and of five kinds."""

import numpy as np
import pytest

from fuzzynav.potential import IMPROVED, Steps, discs, walk, walls
from fuzzynav.potential.traps import GOAL, KINDS, RADIUS, START, solvable, trap


def test_traps_repeat_and_differ() -> None:
    made = [trap(seed) for seed in range(20)]
    assert [t.kind for t in made] == list(KINDS) * 4
    assert len({t.obstacles.tobytes() for t in made}) == 20
    assert (trap(7).obstacles == made[7].obstacles).all()
    with pytest.raises(ValueError, match="number of 0 or more"):
        trap(-1)


@pytest.mark.parametrize("seed", range(40, 60))
def test_a_trap_holds_whoever_follows_the_field(seed: int) -> None:
    scene = trap(seed)
    made = walk(scene.start, scene.goal, scene.obstacles, IMPROVED, Steps(), radius=RADIUS)
    assert made.status == "local_minimum"
    assert np.hypot(*(made.places[-1] - scene.goal)) > 0.1


def test_a_closed_room_has_no_way_and_a_door_makes_one() -> None:
    start, goal = np.array(START), np.array(GOAL)
    room = np.array([[6.0, 6.0], [10.0, 6.0], [10.0, 10.0], [6.0, 10.0], [6.0, 6.0]])
    assert not solvable(walls(room, 0.1), start, goal, RADIUS)
    door = np.array([[6.0, 8.6], [6.0, 10.0], [10.0, 10.0], [10.0, 6.0], [6.0, 6.0], [6.0, 7.4]])
    assert solvable(walls(door, 0.1), start, goal, RADIUS)
    assert not solvable(walls(door, 0.1), start, goal, 0.55)  # 1.2 m less two rims of a wall: 1 m
    assert solvable(discs([[4.0, 4.0, 0.5]]), start, goal, RADIUS)
