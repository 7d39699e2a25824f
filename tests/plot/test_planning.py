"""Pictures of global planning show the data they are given."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from fuzzynav import plot, smoothing
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar, sampling
from fuzzynav.smoothing import simplify
from fuzzynav.studies.planning.maps import SCENES_3

SCENE = SCENES_3["S1"]
FOUND = astar.search(SCENE.grid, SCENE.start, SCENE.goal, astar.TRADITIONAL)


@pytest.fixture
def ax():
    return Figure(figsize=(4, 4)).subplots()


def test_a_search_shows_its_cells_and_its_path(ax):
    plot.draw_search(ax, SCENE.grid, FOUND, title="here")
    squares = [c for c in ax.collections if len(c.get_paths()) == FOUND.searched]
    assert len(squares) == 1
    longest = max(ax.lines, key=lambda line: len(line.get_xdata()))
    assert np.allclose(longest.get_xydata(), SCENE.grid.center_of(FOUND.cells))
    assert ax.get_title() == "here"


def test_a_search_without_a_path_shows_no_path(ax):
    grid = GridMap.from_ascii("..#.\n..#.")
    lost = astar.search(grid, (0, 0), (3, 0))
    artists = plot.draw_search(ax, grid, lost)
    assert len(artists) == 3
    assert len(ax.collections[0].get_paths()) == 4


def test_the_film_uncovers_cells_in_their_order(ax):
    picture = plot.order_image(ax, SCENE.grid, FOUND)
    values = np.ma.filled(picture.get_array().astype(float), np.nan)
    for k in (0, 10, FOUND.searched - 1):
        x, y = FOUND.expanded[k]
        assert values[y, x] == k
    assert np.isfinite(values).sum() == FOUND.searched


def test_compass_dims_the_three_that_are_dropped(ax):
    plot.draw_compass(ax, (1, 0))
    dim = {t.get_text() for t in ax.texts if t.get_color() == "#777777"}
    assert dim == {"225T", "270T", "315T"}


def test_neighbours_lose_the_diagonals_past_an_obstacle():
    counts = []
    for count, rule in ((4, "permissive"), (8, "permissive"), (8, "strict")):
        axes = Figure().subplots()
        plot.draw_neighbours(axes, count, rule)
        counts.append(sum(t.arrow_patch.get_linestyle() == "-" for t in axes.texts))
    assert counts == [4, 8, 5]


def test_heuristics_are_drawn_over_the_true_cost(ax):
    curves = plot.draw_heuristics(ax, (0, 0), (10, 10))
    assert curves["Euclidean"] == pytest.approx(1.0)
    assert curves["Manhattan"] == pytest.approx(np.sqrt(2.0))
    assert curves["e^P Manhattan (eq 3.7)"][0] == pytest.approx(np.e * np.sqrt(2.0))


def test_boxes_of_a_study_have_its_medians(ax):
    table = pd.DataFrame({"density": [0.1] * 5 + [0.3] * 5, "a": np.arange(10.0), "b": np.arange(10.0) ** 2})
    plot.draw_study(ax, table, {"a": table["a"].to_numpy(), "b": table["b"].to_numpy()}, ylabel="value")
    heights = sorted(
        line.get_ydata()[0]
        for line in ax.lines
        if line.get_color() == "black" and len(set(line.get_ydata())) == 1 and len(line.get_ydata()) == 2
    )
    assert {2.0, 7.0, 4.0, 49.0} <= set(heights)


def test_the_rest_can_be_drawn():
    figure = Figure(figsize=(8, 6))
    axes = figure.subplots(3, 3).ravel()
    plot.draw_planner_tree(axes[0])
    kept = simplify.prune(FOUND.cells, SCENE.grid)
    plot.draw_removal(axes[1], SCENE.grid, FOUND.cells, kept, title="x")
    points = SCENE.grid.center_of(kept)
    spline = smoothing.bspline(points)
    plot.draw_spline(axes[2], spline)
    plot.draw_curvature(axes[3], {"a": (spline.points(50), spline.curvature(spline.parameters(50)))}, limit=2.0)
    plot.draw_eta_family(axes[4:6], {"one": smoothing.eta3([0, 0, 0], [1, 1, 0])})
    t = np.linspace(0, 1, 11)
    plot.draw_printed_basis(axes[6], smoothing.cubic_basis(t), smoothing.segment_as_printed(np.eye(4), t), t)
    a, b = SCENE.grid.center_of([SCENE.start, SCENE.goal])
    few = replace(sampling.Swarm(), iterations=3)
    plot.draw_sampled(axes[7], SCENE.grid, sampling.swarm(SCENE.grid, a, b, np.random.default_rng(0), few))
    plot.draw_sampled(axes[8], SCENE.grid, sampling.rrt(SCENE.grid, a, b, np.random.default_rng(0)))
    figure.canvas.draw()
    assert all(axis.has_data() or axis.texts for axis in axes)
