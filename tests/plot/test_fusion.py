"""Pictures of thesis 4 show what the run holds."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from fuzzynav import plot
from fuzzynav.plot.fusion import even_moments
from fuzzynav.studies.fusion import placements

CASE = "M2 cut/1"


@pytest.fixture(scope="module")
def driven():
    task = placements.task_of(CASE)
    return task, placements.drive(task, placements.planner(CASE, "fusion"))


def test_moments_lie_at_equal_shares_of_the_way(driven) -> None:
    _, run = driven
    steps = even_moments(run, 8)
    way = np.concatenate([[0.0], np.cumsum(run.commands[:, 0])]) * run.dt
    assert steps[0] == 0
    np.testing.assert_allclose(way[steps], np.linspace(0.0, run.length, 8), atol=0.11)
    with pytest.raises(ValueError, match="two moments or more"):
        even_moments(run, 1)


def test_a_moment_shows_robot_movers_path_and_sub_goal(driven) -> None:
    task, run = driven
    _, ax = plt.subplots()
    step = 200
    path = placements.path_on("M2 cut")
    plot.draw_fusion_moment(ax, task, run, step, path)
    circles = [(tuple(p.center), round(p.get_radius(), 3)) for p in ax.patches if isinstance(p, plt.Circle)]
    assert (tuple(run.poses[step, :2]), task.robot.radius) in circles
    assert sum(radius == 0.5 for _, radius in circles) == 2
    for mover in run.log["movers"][step]:
        assert any(np.allclose(center, mover) for center, _ in circles)
    headed = path[1 + int(run.log["subgoal"][step])]
    assert any(np.allclose(center, headed) and radius == 0.6 for center, radius in circles)
    drawn = [line.get_xydata() for line in ax.lines]
    assert any(len(xy) == step + 1 and np.allclose(xy, run.poses[: step + 1, :2]) for xy in drawn)
    assert any(len(xy) == len(path) and np.allclose(xy, path) for xy in drawn)
    assert f"{run.t[step]:.1f} s" in ax.get_title()
    plt.close("all")


def test_panels_are_lettered_and_end_at_the_end(driven) -> None:
    task, run = driven
    _, axes = plt.subplots(2, 4)
    steps = plot.draw_fusion_moments(axes.ravel(), task, run, placements.path_on("M2 cut"))
    assert [ax.get_title()[:3] for ax in axes.ravel()] == [f"({c})" for c in "abcdefgh"]
    assert run.log["wish"][steps[-1] - 1, 0] > 0.0  # the last step that drove
    plt.close("all")


def test_the_legends_hold_lengths_and_total_variations(driven) -> None:
    task, run = driven
    _, axes = plt.subplots(2)
    lines = plot.draw_two_speeds(axes, {"fusion": run})
    np.testing.assert_array_equal(lines[1].get_ydata(), run.driven[:, 1])
    assert f"{run.variation[0]:.1f} m/s" in lines[0].get_label()
    _, ax = plt.subplots()
    (line,) = plot.draw_driven(ax, task.chart, {"fusion": run})
    assert f"{run.length:.2f} m" in line.get_label()
    plt.close("all")


def test_the_flowchart_has_every_step() -> None:
    _, ax = plt.subplots()
    plot.draw_fusion_flowchart(ax)
    words = " ".join(text.get_text() for text in ax.texts)
    for part in ("A*", "prune", "sub-goals", "window", "(4.15)", "reached?", "the last one?"):
        assert part in words
    plt.close("all")
