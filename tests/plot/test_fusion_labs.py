"""The labs of chapter 07 answer their sliders."""

import time

import matplotlib.pyplot as plt
import numpy as np
import pytest

from fuzzynav import course, fusion, lab, plot

TURTLE, THESIS = "TurtleBot2, brakes 2.5 m/s²", "thesis, 0.2 m/s²"


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def test_inside_the_circle_a_robot_orbits_and_the_cap_ends_it():
    for speed in (0.5, 1.0):
        turn = speed / 0.35
        path, there = plot.orbit_path((0.0, turn), speed, 0.35)  # the centre of its own circle
        assert not there
        np.testing.assert_allclose(np.hypot(path[:, 0], path[:, 1] - turn), turn, atol=0.01)
        assert plot.orbit_path((0.0, turn), speed, 0.35, cap=True)[1]
    assert plot.orbit_path((6.0, 1.0), 1.0, 0.35)[1]


def test_the_orbit_lab_says_what_the_path_does():
    update = plot.orbit_lab(plt.figure())
    assert "orbits" in update(ahead=2.0, aside=2.0, speed=1.0, turn=0.35, cap="held")[1]
    assert "there after" in update(ahead=2.0, aside=2.0, speed=1.0, turn=0.35, cap="capped by the arc")[1]


def test_the_bound_lab_grows_its_forbidden_region():
    update = plot.bound_lab(plt.figure())
    given = {"away": 2.0, "bearing": 0.0, "v": 0.5, "omega": 0.0, "robot": THESIS}
    words = [update(bound=b, **given)[1] for b in (0.0, 0.4, 1.5)]
    shares = [int(w.split(" %")[0]) for w in words]
    assert shares == sorted(shares)
    assert shares[0] < shares[2]
    assert "allowed" in words[0]
    assert "refused, the theorem" in words[2]
    assert "allowed" in update(bound=1.5, **{**given, "robot": TURTLE})[1]


def test_the_guard_keeps_the_robot_from_driving_into_anybody():
    found = {name: plot.guard_run((0.4, 0.1, 0.6, 0.1), 0.15, name, "turtlebot2")[1].row for name in plot.LAYERS}
    assert found["guard and prediction"]["ending"] != "hit"
    assert found["guard alone"]["ending"] != "hit"
    assert found["neither"]["ending"] == "hit"
    update = plot.guard_lab(plt.figure())
    weights = {"alpha": 0.4, "beta": 0.1, "gamma": 0.6, "delta": 0.1}
    _, words = update(**weights, reserve=0.15, layers="neither", robot="turtlebot2")
    assert words.startswith("hit after")


def test_the_hall_is_driven_once_and_then_only_scrubbed():
    sliders = {
        "time": lab.Slider("time", 0.0, 60.0, 1.0, 0.1, "s"),
        "block_x": lab.Slider("block x", 5.0, 9.0, 6.0, 0.1, "m"),
        "block_y": lab.Slider("block y", 0.6, 7.4, 1.4, 0.1, "m"),
        "walker_x": lab.Slider("walker x", 2.4, 4.1, 3.2, 0.1, "m"),
        "speed": lab.Slider("speed", 0.0, 0.5, 0.3, 0.05, "m/s"),
        "movers": lab.Choice("movers", ("told by an ideal tracker", "tracked from scans"), "tracked from scans"),
    }
    panel = lab.Panel(plot.hall_lab, sliders, title="t")
    first, words = panel.png, panel.text
    begin = time.perf_counter()
    panel.set(time=6.0)
    assert time.perf_counter() - begin < 1.0  # 0.05 s on a quiet machine
    assert panel.png != first
    assert panel.text != words
    assert panel.text.startswith("6.0 of")
    panel.set(speed=0.0)
    assert "reached" in panel.text
    panel.set(time=60.0, speed=0.3)  # after the end the last moment stays
    assert "reached" in panel.text


def test_the_answers_hold_what_the_labs_show():
    answers = course.all_answers()
    assert "hit" not in answers["07b.lab2"].words().split("guard alone")[0].split("each:")[1]
    assert f"{2.0 * 0.35:.2f} m/s" in answers["07a.lab1"].words()
    assert "TurtleBot2" in answers["07b.lab3"].words()


def test_a_hall_refuses_a_runner_and_keeps_its_walkers():
    with pytest.raises(ValueError, match="no walker is faster"):
        fusion.hall_task(walkers=[[3, 2, 3, 6, 0.6]])
    task = fusion.hall_task(blocks=[[8, 2]], walkers=[[3, 2, 3, 6, 0.4]], courtesy=0.0)
    assert len(task.world.movers) == len(task.world.unknown_rectangles) == 1
    assert task.world.movers[0].courtesy == 0.0
    assert not task.chart.is_occupied([8.0, 2.0])  # the map does not know the block
    assert task.optimum > 10.0


def test_a_witness_changes_nothing_of_a_run():
    task = fusion.hall_task(blocks=[[5.6, 6.3]], walkers=[[3.0, 1.5, 3.0, 6.5, 0.4]])
    watched, moments = fusion.watch(task)
    plain = fusion.protocol.drive(task, fusion.METHODS["ours"])
    np.testing.assert_array_equal(watched.run.poses, plain.run.poses)
    assert len(moments) == watched.run.iterations
    np.testing.assert_array_equal([m.decision.command for m in moments], watched.run.log["wish"])
    assert [m.searches for m in moments] == sorted(m.searches for m in moments)
