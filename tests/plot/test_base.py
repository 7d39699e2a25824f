"""Pictures: scale and roles are right, and the quick redraw equals the slow one."""

import io

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from fuzzynav import plot
from fuzzynav.maps.gridmap import GridMap


def pixels(png: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)


@pytest.fixture
def ax():
    return Figure().add_subplot()


def test_colours_differ_in_grey_and_are_named_by_role():
    def grey(colour):
        r, g, b = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
        return 0.299 * r + 0.587 * g + 0.114 * b

    assert {"robot", "path", "reference", "obstacle", "mover", "goal"} <= set(plot.COLORS)
    for one, other in (("robot", "mover"), ("obstacle", "free"), ("obstacle", "unknown"), ("robot", "accent")):
        assert abs(grey(plot.COLORS[one]) - grey(plot.COLORS[other])) > 30


def test_a_robot_has_its_true_size_and_moves(ax):
    mark = plot.draw_robot(ax, [1.0, 2.0, 0.0], 0.3)
    assert mark.disc.get_radius() == 0.3
    mark.place([0.0, 0.0, np.pi / 2])
    assert mark.disc.center == (0.0, 0.0)
    np.testing.assert_allclose([line[1] for line in mark.heading.get_data()], [0.0, 0.3], atol=1e-12)


def test_a_grid_lies_where_the_map_lies(ax):
    occupied = np.zeros((4, 6), dtype=bool)
    occupied[0, 5] = True  # lower right
    image = plot.draw_grid(ax, GridMap(occupied, 0.5, (-1.0, 2.0)), lines=True)
    assert list(image.get_extent()) == [-1.0, 2.0, 2.0, 4.0]
    assert image.origin == "lower"
    assert ax.get_aspect() == 1.0


def test_a_path_may_begin_empty(ax):
    line = plot.draw_path(ax, [])
    assert len(line.get_xdata()) == 0
    assert list(plot.draw_path(ax, np.ones((3, 3))).get_ydata()) == [1.0, 1.0, 1.0]


def test_metric_axes_and_goal(ax):
    plot.metric_axes(ax, (0, 4, 0, 2), title="Plan")
    star, ring = plot.draw_goal(ax, [1, 1], tolerance=0.2)
    assert ax.get_xlabel() == "x [m]"
    assert ax.get_xlim() == (0.0, 4.0)
    assert ring.get_radius() == 0.2
    assert len(plot.draw_goal(ax, [1, 1])) == 1
    assert star.get_marker() == "*"


def test_blocks_have_anchors_for_arrows(ax):
    plot.diagram(ax, 6, 2)
    box = plot.block(ax, [1, 1], "plan", size=(1.5, 0.8), role="robot")
    np.testing.assert_allclose([box.left, box.right, box.top, box.bottom], [[0.25, 1], [1.75, 1], [1, 1.4], [1, 0.6]])
    end = plot.arrow(ax, box.right, [3, 1], "v")
    assert end.get_path().vertices.shape[1] == 2


def make(size=(4.0, 3.0)):
    blit = plot.Blit(size)
    ax = blit.figure.add_subplot()
    ax.set(xlim=(0, 1), ylim=(0, 1))
    (line,) = ax.plot([0.0, 1.0], [0.0, 1.0], label="a line below the legend and the frame")
    ax.legend(loc="center")
    return blit, ax, line


def test_the_quick_redraw_equals_the_slow_one():
    quick, _, line = make()
    quick.png([line])
    line.set_ydata([0.8, 0.3])
    fast = pixels(quick.png([line]))
    assert np.abs(fast - pixels(quick.png(None))).max() <= 2
    other, _, line = make()
    line.set_ydata([0.8, 0.3])
    assert np.abs(fast - pixels(other.png(None))).max() <= 2


def test_nothing_of_the_last_picture_remains():
    blit, _, line = make()
    first = blit.png([line])
    line.set_ydata([0.8, 0.3])
    assert blit.png([line]) != first
    line.set_ydata([0.0, 1.0])
    assert blit.png([line]) == first


def test_an_artist_that_was_background_leaves_no_ghost():
    blit, ax, line = make()
    (second,) = ax.plot([0.1, 0.9], [0.2, 0.2])
    blit.png([line])
    second.set_ydata([0.7, 0.7])
    moved = pixels(blit.png([line, second]))
    other, other_ax, _ = make()
    other_ax.plot([0.1, 0.9], [0.7, 0.7])
    assert np.abs(moved - pixels(other.png(None))).max() <= 2


def test_artists_made_anew_keep_the_background():
    blit, ax, line = make()
    blit.png([line])
    kept = blit._background
    fill = ax.fill_between([0, 1], [0, 0], [1, 1])
    with_fill = blit.png([line, fill])
    fill.remove()
    assert blit._background is kept
    assert with_fill != blit.png([line])


def test_pictures_are_small_and_of_the_size_asked():
    blit, _, line = make((7.0, 4.0))
    png = blit.png([line], level=9)
    assert pixels(png).shape == (360, 630, 3)
    assert blit.width == 630
    assert len(png) < 60_000


def test_the_start_page_shows_what_odometry_cannot_see():
    believed, true = plot.odometry_lap(0.0)
    np.testing.assert_allclose(believed, true, atol=1e-12)
    np.testing.assert_allclose(believed[-1], believed[0], atol=1e-9)
    errors = [plot.odometry_error(e) for e in (0.0, 0.001, 0.002, 0.01)]
    assert errors[0] < 1e-9
    assert errors == sorted(errors)
    assert 1.9 < errors[2] / errors[1] < 2.1  # small errors add up in proportion
    heading = plot.odometry_lap(0.01)[1][-1, 2]
    length = 4 * (3.0 - 1.0) + np.pi  # lap of the outer path; the right wheel travels half a track further out
    right = length + np.pi * 0.23
    assert abs(heading - 0.01 * right / 0.23) < 1e-9
