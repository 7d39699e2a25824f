"""Pictures of trajectory tracking show the numbers they were given; labs answer to every slider."""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from fuzzynav import plot, tracking
from fuzzynav.tracking import reference

EIGHT = reference.FigureEight(duration=20.0)
GAINS = {"kp": 1.0, "kd": 0.7, "heading": 20.0, "v0": 0.22}
RIVAL = {"rival": "Kanayama", "noise": 5.0, "delay": 0.1, "lag": 0.1, "slip": 5.0}


@pytest.fixture
def ax():
    figure, axes = plt.subplots()
    yield axes
    plt.close(figure)


def test_paths_errors_and_speeds_are_those_of_the_run(ax):
    trace = tracking.follow(tracking.Tracker(EIGHT, tracking.Dfl()), [0.1, 0.0, 0.3])
    wanted, driven = plot.draw_tracking_path(ax, trace)
    assert np.array_equal(np.transpose(driven.get_data()), trace.poses[:, :2])
    assert np.array_equal(np.transpose(wanted.get_data()), trace.wanted[:, :2])
    lines = plot.draw_tracking_errors(ax, trace)
    assert lines[2].get_ydata() == pytest.approx(1e3 * trace.errors[:, 2])
    v, omega = plot.draw_tracking_speeds(ax, trace)
    assert np.array_equal(omega.get_ydata(), trace.commands[:, 1])
    assert len(v.get_xdata()) == len(trace.commands)


def test_a_reference_is_drawn_to_its_end(ax):
    line = plot.draw_reference(ax, EIGHT)
    assert [line.get_xdata()[-1], line.get_ydata()[-1]] == pytest.approx(EIGHT.sample(20.0).position.tolist())


def test_the_singularity_is_outside_the_picture_at_rest(ax):
    for line in plot.draw_singularity(ax):
        shown = line.get_ydata()[np.isfinite(line.get_ydata())]
        assert np.abs(shown).max() <= 3.5


def test_poles_are_where_they_are(ax):
    line = plot.draw_poles(ax, [-1 + 2j, -1 - 2j])
    assert line.get_xdata().tolist() == [-1, -1]
    assert line.get_ydata().tolist() == [2, -2]


def test_sketches_are_drawn(ax):
    plot.draw_unicycle(ax)
    assert "body frame" in ax.get_title()
    plot.draw_flat_loop(ax)
    assert any("compensator" in text.get_text() for text in ax.texts)


def test_tables_become_pictures(ax):
    table = pd.DataFrame({"ideal": [0.001, 0.002], "noise": [0.01, 0.02]}, index=["DFL", "PID"])
    plot.draw_rivals(ax, table)
    assert [t.get_text() for t in ax.texts] == ["1.0", "10.0", "2.0", "20.0"]
    lines = plot.draw_time_against_error(ax, {"DFL": 2.0, "MPC": 300.0}, {"DFL": 5.0, "MPC": 4.0})
    assert [line.get_xdata()[0] for line in lines] == [2.0, 300.0]


def test_estimates_are_averaged_over_seeds(ax):
    table = pd.DataFrame({"observer": ["a"] * 4, "noise": [0.01, 0.01, 0.02, 0.02], "rms": [1.0, 3.0, 5.0, 7.0]})
    (line,) = plot.draw_velocity_estimates(ax, table)
    assert line.get_ydata().tolist() == [2e3, 6e3]


@pytest.mark.parametrize("change", [{}, {"kp": 4.0}, {"kd": 2.0}, {"heading": -170.0}, {"v0": 0.02}])
def test_every_slider_of_the_gains_lab_acts(change):
    update = plot.dfl_gains_lab(Figure(figsize=(7, 4)))
    artists, text = update(**GAINS)
    before = [np.array(a.get_data()) for a in artists]
    artists, other = update(**{**GAINS, **change})
    moved = any(not np.array_equal(b, a.get_data()) for a, b in zip(artists, before, strict=True))
    assert moved == bool(change)
    assert (text != other) == bool(change)


@pytest.mark.parametrize("change", [{"rival": "PID"}, {"noise": 30.0}, {"delay": 0.4}, {"lag": 0.4}, {"slip": 20.0}])
def test_every_slider_of_the_rivals_lab_acts(change):
    update = plot.rivals_lab(Figure(figsize=(7, 4)))
    _, text = update(**RIVAL)
    _, other = update(**{**RIVAL, **change})
    assert text != other
    assert "DFL" in other
