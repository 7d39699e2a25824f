"""A robot that evades: what its speeds promise, that it is not struck where standing is, and what its map holds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav import simulate
from fuzzynav.control import Controller, Observation
from fuzzynav.fusion import Memory, Navigator, Task
from fuzzynav.fusion.decision import EVADING, Evasion, decide
from fuzzynav.fusion.methods import METHODS
from fuzzynav.fusion.sensed import Surroundings
from fuzzynav.geometry import Array
from fuzzynav.robot import Robot
from fuzzynav.world import Mover, World

ROBOT = Robot(
    name="disc", wheel_radius=0.1, track=0.4, radius=0.3, max_vel_x=2.0, min_vel_x=-0.5, max_vel_theta=1.5,
    acc_lim_x=10.0, dec_lim_x=10.0, acc_lim_theta=20.0, mass=17.0, inertia=0.6, source="test",
)  # fmt: skip


class Standing(Controller):
    """A robot that stands."""

    def reset(self) -> None:
        """Nothing to forget."""

    def __call__(self, observation: Observation) -> Array:
        """No speed."""
        return np.zeros(2)


def around(movers: Array, points: Array | None = None) -> Surroundings:
    """Surroundings of told movers and standing points, without a border of what was seen."""
    stands = np.empty((0, 2)) if points is None else points
    return Surroundings(
        points=stands, border=np.empty((0, 2)), radii=np.empty(0), holes=0, hazards=movers[:, [0, 1, 4]].copy(),
        movers=movers, standing=np.ones(len(stands), dtype=np.bool_),
    )  # fmt: skip


def seen(velocity: tuple[float, float] = (0.0, 0.0)) -> Observation:
    """A robot at the origin that looks along x, its goal 9 m ahead."""
    return Observation(
        time=0.0, pose=np.zeros(3), velocity=np.array(velocity), goal=np.array([9.0, 0.0]), points=np.empty((0, 2))
    )


def test_on_free_ground_it_drives_straight_on_as_fast_as_the_window_allows() -> None:
    made = decide(seen(), [9.0, 0.0], around(np.empty((0, 5))), ROBOT, EVADING, 2.0)
    assert made.command == pytest.approx([1.0, 0.0])
    gain = 0.3 * 0.5 + 0.7 * (1.0 + 2.0 * 2.0) / 6.0  # 1 m in the first second, then 4 m more
    assert gain - 3.0 * np.exp(-6.0) < np.nanmax(made.totals) <= gain


@given(st.floats(1.0, 4.0), st.floats(-3.0, 3.0), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_mirrored_movers_give_mirrored_promises(x: float, y: float, vx: float, vy: float) -> None:
    row = np.array([[x, y, vx, vy, 0.5]])
    ours = decide(seen((1.0, 0.0)), [9.0, 0.0], around(row), ROBOT, EVADING, 2.0)
    other = decide(seen((1.0, 0.0)), [9.0, 0.0], around(row * [1, -1, 1, -1, 1]), ROBOT, EVADING, 2.0)
    order = np.array([int(np.argmin(np.abs(other.samples - s * [1, -1]).sum(axis=1))) for s in ours.samples])
    assert ours.totals == pytest.approx(other.totals[order], abs=1e-6, nan_ok=True)


def test_contact_is_foretold_when_two_discs_meet() -> None:
    row = np.array([[5.8, 0.0, -2.0, 0.0, 0.5]])
    made = decide(seen((2.0, 0.0)), [9.0, 0.0], around(row), ROBOT, replace(EVADING, growth=0.0, sim_time=1.01), 2.0)
    ahead = int(np.argmin(np.abs(made.samples - [2.0, 0.0]).sum(axis=1)))
    assert made.ways[ahead, 4] == np.inf  # they meet after 5 m at 4 m/s, beyond the horizon
    longer = decide(seen((2.0, 0.0)), [9.0, 0.0], around(row), ROBOT, replace(EVADING, growth=0.0,
                    evasion=replace(Evasion(), hold=2.0)), 2.0)  # fmt: skip
    assert longer.ways[ahead, 4] == pytest.approx(1.3, abs=0.051)


def test_a_wall_behind_the_turn_counts() -> None:
    wall = np.column_stack([np.full(81, 1.2), np.linspace(-4.0, 4.0, 81)])
    free = decide(seen((2.0, 0.0)), [9.0, 0.0], around(np.empty((0, 5))), ROBOT, EVADING, 2.0)
    made = decide(seen((2.0, 0.0)), [9.0, 0.0], around(np.empty((0, 5)), wall), ROBOT, EVADING, 2.0)
    assert made.ways[made.chosen, 4] == np.inf and made.command[0] < free.command[0]


def test_it_leaves_where_standing_would_be_struck() -> None:
    """Two movers abreast leave no way past them but beside: a robot that stood would be struck."""
    movers = tuple(Mover.timed([[0.0, 9.0, y], [10.0, -9.0, y]], 0.5) for y in (-0.4, 0.6))
    task = Task(
        name="abreast", world=World(movers=movers), robot=ROBOT, start=np.zeros(3), goal=np.array([9.0, 0.0]),
        speed_bound=1.8, ideal=True,
    )  # fmt: skip
    loop = replace(task.loop, standing=0.05, end_when_struck=True)
    run = simulate.run(
        task.world, ROBOT, METHODS["ours, evading"](task), task.start, task.goal, t_max=30.0, track_movers=True,
        loop=loop,
    )  # fmt: skip
    stood = simulate.run(
        task.world, ROBOT, Standing(), task.start, task.goal, t_max=30.0, track_movers=True, loop=loop
    )  # fmt: skip
    assert (run.status, stood.status) == ("reached", "struck")


def test_the_map_enters_the_hits_that_stand_whatever_beams_miss() -> None:
    angles = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
    ranges = np.array([np.inf, 2.0, np.inf, 3.0, 4.0])
    hits = np.isfinite(ranges)
    points = np.column_stack([ranges[hits] * np.cos(angles[hits]), ranges[hits] * np.sin(angles[hits])])
    told = Observation(
        time=0.0, pose=np.zeros(3), velocity=np.zeros(2), goal=np.array([3.0, 0.0]), points=points, ranges=ranges,
        angles=angles, range_max=10.0,
    )  # fmt: skip
    memory = Memory(None)
    memory.enter(told, np.array([True, False, True]))
    assert memory.changes == 2
    assert [bool(memory.grid().occupied[tuple(memory.grid().cell_of(p)[::-1])]) for p in points] == [True, False, True]


def test_evasion_refuses_what_makes_no_sense() -> None:
    for wrong in ({"hold": 0.0}, {"early": 1.5}, {"dread": -1.0}, {"scale": 0.0}, {"fade": 0.0}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            Evasion(**wrong)
    assert Navigator(ROBOT, speed_bound=1.0, params=EVADING).params.evasion == Evasion()
