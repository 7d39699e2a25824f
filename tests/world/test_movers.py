"""What moves by a clock, and who waits for a robot that stands: against interpolation and against plain distances."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav.world import Mover, World, movers_between, movers_start, movers_step

relaxed = settings(deadline=None, max_examples=60)
SEEDS = st.integers(0, 2**32)
BOX = (-20.0, 20.0, -20.0, 20.0)


def random_frames(rng: np.random.Generator, count: int, first: float = 0.0) -> np.ndarray:
    times = first + np.cumsum(np.r_[0.0, rng.uniform(0.2, 3.0, count - 1)])
    return np.column_stack([times, rng.uniform(-4, 4, (count, 2))])


def place(frames: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Where a looping mover is at times t, by numpy."""
    late = np.mod(t, frames[-1, 0])
    return np.column_stack([np.interp(late, frames[:, 0], frames[:, k]) for k in (1, 2)])


def walk(mover: Mover, steps: int, dt: float, robot=None, radius: float = 0.3, stands: bool = False):
    rng = np.random.default_rng(0)
    states = [movers_start(World(bounds=BOX, movers=(mover,)), rng)]
    for _ in range(steps):
        states.append(movers_step(states[-1], dt, robot, rng, radius, stands))
    return states


@relaxed
@given(SEEDS, st.integers(2, 6), st.floats(0.01, 5.0), st.floats(-50, 50), st.sampled_from([0.0, 0.7]))
def test_a_timed_mover_is_where_interpolation_says_at_any_step(seed, count, dt, phase, first):
    frames = random_frames(np.random.default_rng(seed), count, first)
    states, t = walk(Mover.timed(frames, 0.3, phase), 40, dt), phase + dt * np.arange(41)
    late = np.mod(t, frames[-1, 0])
    sure = np.minimum(late, frames[-1, 0] - late) > 1e-9  # on the jump itself the last digit decides
    np.testing.assert_allclose(np.array([s.positions[0] for s in states])[sure], place(frames, t)[sure], atol=1e-9)
    ahead = (place(frames, t + 1e-6) - place(frames, t)) / 1e-6
    inside = np.abs(late[:, None] - np.r_[0.0, frames[:, 0]]).min(axis=1) > 2e-6  # one segment, no corner, no jump
    np.testing.assert_allclose(np.array([s.velocities[0] for s in states])[inside], ahead[inside], atol=1e-6)


def test_a_jump_has_no_velocity_and_no_way():
    states = walk(Mover.timed([[0, 0, 0], [2, 4, 0]], 0.3), 5, 0.8)
    assert [round(float(s.positions[0, 0]), 9) for s in states] == [0.0, 1.6, 3.2, 0.8, 2.4, 0.0]
    assert all(s.velocities[0].tolist() == [2.0, 0.0] for s in states)
    across = [movers_between(states[2], states[3], u)[0, 0] for u in (0.25, 0.75)]
    assert across == pytest.approx([3.6, 0.4])  # 3.2 to 4, then 0 to 0.8: never from 3.2 back to 0.8
    patrol = walk(Mover.patrol([[0, 0], [4, 0]], 2.0, 0.3), 2, 0.8)
    assert movers_between(patrol[1], patrol[2], 0.25)[0] == pytest.approx([2.0, 0.0])


def test_one_frame_stands_and_a_phase_is_taken_around_the_loop():
    assert walk(Mover.timed([[3.0, 1.0, 2.0]], 0.3, phase=7.0), 9, 0.7)[-1].positions[0].tolist() == [1.0, 2.0]
    frames = [[0, 0, 0], [2, 4, 0], [5, 4, 3]]
    assert Mover.timed(frames, 0.3, phase=-1.0).start == pytest.approx((4.0, 2.0))
    assert Mover.timed(frames, 0.3, phase=13.0) == Mover.timed(frames, 0.3, phase=3.0)
    assert replace(Mover.timed(frames, 0.3), phase=1.0).start == (2.0, 0.0)
    early = walk(Mover.timed([[1, 5, 5], [2, 6, 5]], 0.3), 3, 0.5)
    assert [s.positions[0].tolist() for s in early] == [[5, 5], [5, 5], [5, 5], [5.5, 5]]
    assert [s.velocities[0].tolist() for s in early] == [[0, 0], [0, 0], [1, 0], [1, 0]]


def any_mover(seed: int, courtesy: float) -> Mover:
    rng = np.random.default_rng(seed)
    way, speed = rng.uniform(-4, 4, (4, 2)), rng.uniform(0.05, 3.0)
    frames = random_frames(rng, 4)
    made = (
        Mover.constant(way[0], -speed * way[0] / np.hypot(*way[0]), 0.3),
        Mover.patrol(way, speed, 0.3),
        Mover.timed(frames, 0.3, rng.uniform(0, 9)),
        Mover.wander(way[0], speed, 0.3),
    )[seed % 4]
    return replace(made, courtesy=courtesy)


@settings(deadline=None, max_examples=200)
@given(SEEDS, st.floats(0.01, 0.5), st.sampled_from([0.05, 0.1, 1.0]))
def test_a_courteous_mover_never_touches_a_robot_that_stands(seed, courtesy, dt):
    mover, robot = any_mover(seed, courtesy), np.random.default_rng(seed + 1).uniform(-2, 2, 3)
    states = walk(mover, 100, dt, robot, 0.2, True)
    first = np.hypot(*(states[0].positions[0] - robot[:2])) - 0.5
    if first <= 0.0:
        return
    for old, new in pairwise(states):
        for u in np.linspace(0, 1, 11):
            gap = np.hypot(*(movers_between(old, new, u)[0] - robot[:2])) - 0.5
            assert gap >= min(courtesy, first) - 1e-9
        if np.array_equal(old.positions, new.positions) and mover.motion == "constant":
            assert not new.velocities.any()


def test_a_blind_mover_walks_on_and_a_courteous_one_waits_only_for_who_stands():
    polite = Mover.constant((0, 0), (1, 0), 0.3, courtesy=0.1)
    stood = walk(polite, 100, 0.05, [3.0, 0.0, 0.0], 0.3, True)[-1]
    assert 2.25 - 1e-9 <= stood.positions[0, 0] <= 2.3 + 1e-9  # within a step of 3 - 0.3 - 0.3 - 0.1
    assert stood.velocities[0].tolist() == [0.0, 0.0]
    for mover, robot, stands in (
        (replace(polite, courtesy=0.0), [3.0, 0.0, 0.0], True),
        (polite, [3.0, 0.0, 0.0], False),
        (polite, [3.0, 1.0, 0.0], True),  # beside the way
        (polite, [-0.65, 0.0, 0.0], True),  # within courtesy, but left behind
        (polite, None, True),
    ):
        last = walk(mover, 100, 0.05, robot, 0.3, stands)[-1]
        assert last.positions[0] == pytest.approx([5.0, 0.0])
        assert last.velocities[0].tolist() == [1.0, 0.0]


@pytest.mark.parametrize(
    "mover",
    [
        Mover.timed([[0, 0, 0], [4, 4, 0], [6, 4, 2]], 0.3, courtesy=0.1),
        Mover.patrol([[0, 0], [4, 0], [4, 2]], 1.0, 0.3, courtesy=0.1),
    ],
    ids=["timed", "patrol"],
)
def test_who_waited_goes_on_where_it_stopped(mover):
    rng, dt = np.random.default_rng(0), 0.1
    free = [s.positions[0] for s in walk(mover, 80, dt)]
    state, seen, waited = movers_start(World(movers=(mover,))), [], 0
    for k in range(80):
        state = movers_step(state, dt, [3.0, 0.0, 0.0], rng, 0.3, k < 40)
        waited += not state.velocities[0].any()
        seen.append(state.positions[0])
    assert 10 < waited < 40
    np.testing.assert_allclose(seen[40:], free[41 - waited : 81 - waited], atol=1e-9)


def test_a_timed_mover_does_not_jump_onto_a_robot_that_stands():
    mover = Mover.timed([[0, 0, 0], [2, 4, 0]], 0.3, courtesy=0.1)
    waiting = walk(mover, 60, 0.1, [-0.2, 0.0, 0.0], 0.3, True)[-1]  # it leaves, and cannot come back
    assert 3.8 - 1e-9 <= waiting.positions[0, 0] <= 4.0
    aside = walk(mover, 21, 0.1, [2.0, 3.0, 0.0], 0.3, True)[-1]
    assert aside.positions[0, 0] == pytest.approx(0.2)


def test_no_courteous_mover_passes_through_a_robot_within_one_step():
    robot = [2.0, 0.0, 0.0]
    straight = Mover.timed([[0, 0, 0], [1, 4, 0], [9, 4, 0]], 0.3, courtesy=0.1)
    after = Mover.timed([[0, 0, 0], [1, 4, 0], [9, 4, 0]], 0.3, phase=8.5, courtesy=0.1)  # jumps back, then walks
    for mover in (straight, after, Mover.constant((0, 0), (4, 0), 0.3, courtesy=0.1)):
        waiting = walk(mover, 3, 2.0, robot, 0.3, True)[-1]
        assert waiting.positions[0].tolist() == list(mover.start)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Mover.timed([[0, 0, 0], [0, 1, 1]], 0.3), "rising"),
        (lambda: Mover.timed([[-1, 0, 0], [1, 1, 1]], 0.3), "rising"),
        (lambda: Mover.timed([[0, 0], [1, 1]], 0.3), "rows of t, x, y"),
        (lambda: Mover.timed([], 0.3), "rows of t, x, y"),
        (lambda: Mover.timed([[0, np.nan, 0]], 0.3), "finite"),
        (lambda: Mover.timed([[0, 0, 0], [1, 1, 1]], 0.3, phase=np.inf), "finite"),
        (lambda: Mover(radius=1.0, start=(0, 0), motion="timed"), "rows of t, x, y"),
        (lambda: Mover(radius=1.0, start=(0, 0), phase=1.0), "timed mover"),
        (lambda: Mover.constant((0, 0), (0, 0), 1.0, courtesy=-0.1), "courtesy"),
    ],
)
def test_bad_movers_are_refused(make, words):
    with pytest.raises(ValueError, match=words):
        make()
