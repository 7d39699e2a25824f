"""One task, one method, one row: every ending has its name, and everything but the clock repeats."""

import time
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav.control import Controller
from fuzzynav.fusion import protocol
from fuzzynav.fusion.protocol import ENDINGS, TIMED, drive, measure, solvable, summary
from fuzzynav.fusion.task import Task
from fuzzynav.robot import TURTLEBOT2
from fuzzynav.sensors import Laser
from fuzzynav.simulate.loop import Loop
from fuzzynav.world import Mover, World

ROBOT = replace(TURTLEBOT2, radius=0.3)
NOISY = Laser(beams=31, noise=0.05, range_max=6.0)


class Steady(Controller):
    """Drives one command, and does something odd in its third step."""

    def __init__(self, v=0.5, third=None):
        self.v, self.third, self.calls = v, third, 0

    def reset(self):
        self.calls = 0

    def __call__(self, observation):
        self.calls += 1
        return self.third(self) if self.third and self.calls == 3 else (self.v, 0.0)


class Swayed(Steady):
    """Turns by what its noisy scan says."""

    def __call__(self, observation):
        return self.v, float(np.nanmean(np.minimum(observation.ranges, 6.0))) % 0.3 - 0.15


def steady(v=0.5, third=None):
    return lambda task: Steady(v, third)


EMPTY = World()


def task(world=EMPTY, goal=(4.0, 0.0), **kwargs):
    made = {"name": "toy", "world": world, "robot": ROBOT, "start": [0.0, 0.0, 0.0], "goal": goal, "speed_bound": 1.0}
    return Task(**{**made, "optimum": 4.0, "t_max": 30.0, **kwargs})


def same(a, b):
    return all(a[k] == b[k] or (a[k] != a[k] and b[k] != b[k]) for k in a if k not in TIMED) and a.keys() == b.keys()


# --- the endings --------------------------------------------------------------------------------


def test_reached_is_measured_by_hand():
    row = measure(task(World(discs=[[2.0, 1.0, 0.2]])), steady())
    assert (row["ending"], row["status"], row["reason"]) == ("reached", "reached", "")
    # speeding up at 2.5 m/s2 loses at most a step; the goal's tolerance of 0.5 m is not driven
    assert row["length"] == pytest.approx(3.5, abs=0.06)
    assert row["time"] == pytest.approx(7.0, abs=0.31)
    assert row["steps"] == round(row["time"] / 0.1)
    assert row["ratio"] == pytest.approx(row["length"] / 4.0)
    assert row["clearance"] == pytest.approx(1.0 - 0.2 - 0.3, abs=1e-3)
    assert 0.0 < row["step_median_ms"] <= row["step_p99_ms"]


def test_contact_while_driving_is_a_hit():
    row = measure(task(World(discs=[[2.0, 0.0, 0.2]])), steady())
    assert (row["ending"], row["status"]) == ("hit", "collided")
    assert 0.0 < row["clearance"] < 0.06  # before the step that ended it


@pytest.mark.parametrize(("v", "ending"), [(0.0, "struck"), (0.049, "struck"), (0.06, "hit")])
def test_who_moved_when_a_mover_came(v, ending):
    coming = World(movers=(Mover.constant([3.0, 0.0], [-1.0, 0.0], 0.3),))
    assert measure(task(coming), steady(v))["ending"] == ending


def test_creeping_into_what_stands_is_no_strike():
    assert measure(task(World(discs=[[0.7, 0.0, 0.3]])), steady(0.04))["ending"] == "hit"


@pytest.mark.parametrize(("t_max", "status"), [(30.0, "stalled"), (5.0, "timeout")])
def test_standing_about_is_late_and_says_which(t_max, status):
    row = measure(task(t_max=t_max), steady(0.0))
    assert (row["ending"], row["status"]) == ("late", status)


def test_a_planner_that_gives_up_is_late():
    class GivesUp(Steady):
        status = "local_minimum"

    assert measure(task(), lambda t: GivesUp())["status"] == "local_minimum"
    assert measure(task(), lambda t: GivesUp())["ending"] == "late"


# --- failures of the controller -----------------------------------------------------------------


def raises(controller):
    raise RuntimeError(f"no plan in\n{object()}")


@pytest.mark.parametrize(
    ("third", "said"),
    [
        (raises, "RuntimeError: no plan in <object object>"),
        (lambda c: (np.nan, 0.0), "ValueError: the command [nan, 0.0] at 0.2 s is not finite (v, w)"),
        (lambda c: (0.1, 0.2, 0.3), "ValueError: the command [0.1, 0.2, 0.3] at 0.2 s is not finite (v, w)"),
        (lambda c: None, "ValueError: the command nan at 0.2 s is not finite (v, w)"),
        (lambda c: "fast", "ValueError: could not convert string to float: 'fast'"),
    ],
)
def test_a_controller_that_fails_is_named(third, said):
    driven = drive(task(), steady(third=third))
    row = driven.row
    assert driven.run is None
    assert (row["ending"], row["status"], row["reason"]) == ("failed", "failed", said)
    assert row["steps"] in (2, 3) and np.isnan(row["time"])
    assert row.keys() == measure(task(), steady()).keys()


def test_a_slow_controller_is_named_and_one_slow_answer_is_not():
    class Slow(Steady):
        often = 1

        def __call__(self, observation):
            if self.calls % self.often == 0:
                time.sleep(0.02)
            return super().__call__(observation)

    row = measure(task(), lambda t: Slow(), step_limit=0.01)
    assert row["ending"] == "failed"
    assert row["reason"] == "TimeoutError: more than 3 answers took over 0.01 s each"
    assert row["steps"] == 5  # the first is free

    class Hiccup(Slow):
        often = 40

    assert measure(task(), lambda t: Hiccup(), step_limit=0.01)["ending"] == "reached"


def test_what_is_no_method_or_no_controller_is_named():
    def broken(task):
        raise RuntimeError("no rule base")

    assert measure(task(), broken)["reason"] == "RuntimeError: no rule base"
    assert "no controller" in measure(task(), lambda t: len)["reason"]

    class Odd(Steady):
        status = "bored"

    assert "'bored' has no name" in measure(task(), lambda t: Odd())["reason"]


def test_a_task_that_cannot_begin_is_no_failure_of_the_method():
    with pytest.raises(ValueError, match="cannot start"):
        drive(task(World(discs=[[0.3, 0.0, 0.2]])), steady())
    with pytest.raises(ValueError, match="step_limit"):
        drive(task(), steady(), step_limit=0.0)


# --- is there a way -----------------------------------------------------------------------------


def walled(gap, width=0.2):
    """A wall at x = 2 across a hall of 6 m, with one gap."""
    side = 3.0 - gap / 2.0
    rows = [[2.0, sign * (gap / 2.0 + side / 2.0), width, side, 0.0] for sign in (-1.0, 1.0)]
    return World(rectangles=rows, bounds=(-1.0, 5.0, -3.0, 3.0))


def test_an_enclosed_goal_is_counted_apart_and_not_driven():
    asked = []
    shut = task(walled(0.0), optimum=np.nan)
    row = measure(shut, lambda t: asked.append(t))
    assert (row["ending"], row["status"], asked) == ("unsolvable", "no_path", [])
    assert measure(task(walled(0.0), optimum=np.inf), steady())["ending"] == "unsolvable"
    # an optimum is believed
    assert measure(task(walled(0.0)), steady())["ending"] == "hit"


@settings(max_examples=30, deadline=None)
@given(st.floats(0.601, 1.5), st.floats(0.1, 0.6), st.booleans())
def test_a_way_is_never_overlooked(gap, width, bounded):
    world = walled(gap, width)
    if not bounded:
        world = World(rectangles=world.rectangles)
    assert solvable(task(world, optimum=np.nan))


@settings(max_examples=30, deadline=None)
@given(st.floats(0.0, 0.6 - 2 * 0.05 * np.sqrt(0.5) - 1e-6), st.floats(0.2, 0.6))
def test_a_gap_clearly_too_narrow_is_no_way(gap, width):
    assert not solvable(task(walled(gap, width), optimum=np.nan))
    assert solvable(task(World(rectangles=walled(gap, width).rectangles), optimum=np.nan))  # round the wall's end


def test_it_is_enough_to_come_as_near_as_the_goal_asks():
    behind = task(walled(0.0), goal=(2.3, 0.0), optimum=np.nan)  # the wall is 0.2 m thick
    assert not solvable(behind)
    assert solvable(replace(behind, loop=Loop(goal_tolerance=0.8)))


def test_a_goal_inside_an_obstacle_is_unsolvable():
    assert measure(task(World(discs=[[4.0, 0.0, 0.5]])), steady())["ending"] == "unsolvable"


# --- repeats, and many --------------------------------------------------------------------------


def test_the_same_seed_is_the_same_row_and_another_is_not():
    noisy = task(World(discs=[[2.0, 2.0, 0.3]]), laser=NOISY, t_max=3.0)
    rows = [measure(noisy, lambda t: Swayed(), seed=s) for s in (3, 3, 4)]
    assert same(rows[0], rows[1])
    assert rows[0]["length"] == rows[1]["length"]
    paths = [drive(noisy, lambda t: Swayed(), seed=s).run.poses[-1] for s in (3, 3, 4)]
    assert (paths[0] == paths[1]).all()
    assert (paths[0] != paths[2]).any()


def test_ideal_tracking_is_granted_only_by_the_task():
    told = []

    class Listens(Steady):
        def __call__(self, observation):
            told.append(observation.movers)
            return super().__call__(observation)

    world = World(movers=(Mover.constant([3.0, 3.0], [0.0, 0.5], 0.2),))
    drive(task(world, t_max=0.2), lambda t: Listens())
    assert told[0] is None
    drive(task(world, t_max=0.2, ideal=True), lambda t: Listens())
    assert told[-2].tolist() == [[3.0, 3.0, 0.0, 0.5, 0.2]]


def table():
    endings = ["reached"] * 6 + ["hit", "struck", "late", "failed", "unsolvable", "unsolvable"]
    number = np.arange(12.0)
    columns = dict.fromkeys(("time", "length", "ratio", "clearance", *TIMED), number)
    return pd.DataFrame({"case": [f"c{k}" for k in range(12)], "method": "m", "ending": endings, **columns})


def test_summary_counts_every_ending_and_leaves_out_only_the_unsolvable():
    row = summary(table()).iloc[0]
    assert (row["runs"], row["solvable"]) == (12, 10)
    assert [row[name] for name in ENDINGS] == [6, 1, 1, 1, 2, 1]
    assert row["reached rate"] == 0.6  # a failure is not forgiven
    assert row[["reached low", "reached high"]].round(3).tolist() == [0.313, 0.832]  # Wilson, by hand
    assert row["failed rate"] == 0.1
    assert row["median time"] == 2.5  # of those that reached
    with pytest.raises(ValueError, match="no column 'ending'"):
        summary(table().drop(columns="ending"))
    lost = summary(table().assign(ending="unsolvable")).iloc[0]
    assert np.isnan(lost["reached rate"])


def test_fingerprint_sees_results_and_not_the_clock():
    first = protocol.fingerprint(table())
    assert protocol.fingerprint(table().assign(step_median_ms=7.0)) == first
    assert protocol.fingerprint(table().sample(frac=1.0, random_state=1)) == first
    assert protocol.fingerprint(table().assign(length=7.0)) != first
