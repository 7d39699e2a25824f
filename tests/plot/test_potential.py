"""Pictures of potential fields show what was computed."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from fuzzynav import plot
from fuzzynav.potential import CLASSICAL, IMPROVED, Steps, discs, force, walk, walls

SCENE = np.vstack([discs([[3.0, 4.0, 0.4], [5.0, 5.0, 0.0]]), walls([[6.0, 2.0], [7.0, 3.0]], 0.1)])
GOAL = [8.0, 8.0]


def test_obstacles_cover_what_they_are() -> None:
    ax = Figure().subplots()
    made = plot.draw_obstacles(ax, SCENE)
    paths = made.get_paths()
    assert len(paths) == 7  # two rounds for each, and the body of the wall
    inside = [any(path.contains_point(place) for path in paths) for place in ([3.3, 4.0], [6.5, 2.5], [4.0, 4.0])]
    assert inside == [True, True, False]


def test_arrows_point_along_the_force() -> None:
    points = plot.lattice([0.0, 0.0], [8.0, 8.0], 5)
    assert points.shape == (5, 5, 2)
    np.testing.assert_allclose(points[1, 3], [6.0, 2.0])
    arrows = plot.draw_forces(Figure().subplots(), points[:4, :4], GOAL, SCENE, CLASSICAL)
    found = force(points[:4, :4], GOAL, SCENE, CLASSICAL)
    angles = np.arctan2(found[..., 1], found[..., 0]).ravel()
    np.testing.assert_allclose(np.arctan2(arrows.V, arrows.U), angles, atol=1e-9)


def test_a_surface_is_the_potential_cut() -> None:
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    height = plot.draw_potential(ax, plot.lattice([0, 0], [8, 8], 9), GOAL, SCENE, CLASSICAL, cut=100.0)
    assert height.max() == 100.0
    assert height[-1, -1] < 10.0
    plt.close(fig)


def test_walks_and_counts_say_how_they_end() -> None:
    fig = Figure()
    axes = fig.subplots(1, 2)
    made = {"improved": walk([0, 0], GOAL, SCENE, IMPROVED, Steps())}
    (line,) = plot.draw_walks(axes[0], made, GOAL, SCENE)
    assert line.get_label() == f"improved: {made['improved'].status}, {made['improved'].iterations} iterations"
    np.testing.assert_allclose(line.get_xydata(), made["improved"].places)
    (counts,) = plot.draw_counts(axes[1], [1, 2], {"printed": [1012, 891]})
    np.testing.assert_allclose(counts.get_ydata(), [1012, 891])
