"""Pictures of a comparison show its numbers."""

import io

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from PIL import Image

from fuzzynav import plot
from fuzzynav.fusion.protocol import TIMED, summary
from fuzzynav.simulate import Run
from fuzzynav.world import World


@pytest.fixture
def table():
    endings = ["reached"] * 3 + ["hit"] + ["late", "failed", "unsolvable", "reached"]
    times = [3.0, 1.0, 2.0, 0.5, 9.0, np.nan, np.nan, 4.0]
    columns = dict.fromkeys(("length", "ratio", "clearance", *TIMED), 1.0)
    return pd.DataFrame({"method": ["a"] * 4 + ["b"] * 4, "ending": endings, "time": times, **columns})


def test_bars_are_the_shares_and_fill_the_row(table):
    bars = plot.draw_endings(Figure().subplots(), summary(table))
    widths = np.array([[patch.get_width() for patch in bar] for bar in bars])
    assert widths[0].tolist() == [0.75, pytest.approx(1 / 3)]  # b has three tasks that can be solved
    assert widths.sum(axis=0) == pytest.approx([1.0, 1.0])
    assert bars[1][0].get_x() == 0.75


def test_the_line_of_time_ends_at_the_share_that_reached(table):
    lines = plot.draw_solved(Figure().subplots(), table)
    x, y = lines[0].get_data()
    assert x.tolist() == [0.0, 1.0, 2.0, 3.0, 9.0]
    assert y.tolist() == [0.0, 0.25, 0.5, 0.75, 0.75]
    assert lines[1].get_ydata()[-1] == pytest.approx(1 / 3)


def test_pictures_of_a_comparison_repeat_even_where_nothing_was_reached(table):
    lost = table.assign(ending="failed", time=np.nan)
    for rows in (table, lost):
        assert plot.comparison_svg(summary(rows), rows) == plot.comparison_svg(summary(rows), rows)


def test_the_ground_of_a_player_lies_where_its_edges_say():
    run = Run(
        t=np.arange(2.0), poses=np.array([[0.0, 0.0, 0.0], [4.0, 2.0, 0.0]]), commands=np.zeros((1, 2)),
        clearance=np.ones(1), log={}, status="timeout", goal=np.array([6.0, 0.0]),
    )  # fmt: skip
    picture, box = plot.ground_png(World(discs=[[2.0, 1.0, 0.5]]), run, width=480)
    assert box == (-3.0, 9.0, -3.0, 5.0)
    pixels = np.asarray(Image.open(io.BytesIO(picture)).convert("L"))
    assert pixels.shape == (320, 480)

    def at(x, y):
        return pixels[round((5.0 - y) * 40), round((x + 3.0) * 40)]

    assert at(2.0, 1.0) < 120 and at(2.4, 1.0) < 120
    assert at(2.6, 1.0) > 240 and at(2.0, 1.6) > 240
