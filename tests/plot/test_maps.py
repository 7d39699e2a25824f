"""The labs of the localization chapter at the ends of their sliders, and the pictures of maps against their data."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from fuzzynav import lab, localization, mapping, plot
from fuzzynav.maps import kinds
from fuzzynav.studies import localization as study

LABS = {
    "doubt": (
        plot.doubt_lab,
        {
            "travel": lab.Slider("t", 0.0, 10.0, 3.0, 0.5),
            "turn": lab.Slider("r", 0.0, 10.0, 3.0, 0.5),
            "laps": lab.Slider("laps", 1, 3, 1, 1),
        },
    ),
    "filter": (
        plot.ekf_lab,
        {
            "sigma": lab.Slider("s", 0.02, 1.0, 0.1, 0.02),
            "bearing": lab.Slider("b", 0.5, 15.0, 2.0, 0.5),
            "trust": lab.Slider("t", 0.2, 5.0, 1.0, 0.1),
            "beacons": lab.Slider("n", 1, 5, 5, 1),
        },
    ),
    "map": (
        plot.occupancy_lab,
        {
            "frame": lab.Slider("f", 0, 65, 0, 1),
            "noise": lab.Slider("n", 0.0, 0.3, 0.02, 0.02),
            "drift": lab.Slider("d", 0, 200, 0, 10),
        },
    ),
}


@pytest.mark.parametrize("name", LABS)
def test_labs_answer_at_every_end(name):
    setup, sliders = LABS[name]
    panel = lab.Panel(setup, sliders, title=name)
    pictures = {panel.png}
    for end in ("low", "high"):
        panel.set(**{key: getattr(slider, end) for key, slider in sliders.items()})
        assert "No picture" not in panel.text
        assert not panel.text.count("nan")
        pictures.add(panel.png)
    assert len(pictures) == 3


@pytest.mark.parametrize("story", plot.STORIES)
def test_every_story_of_the_swarm_plays_to_its_end(story):
    choices = {
        "particles": lab.Choice("particles", ("100", "300"), "100"),
        "story": lab.Choice("story", plot.STORIES, story),
    }
    player = lab.Player(plot.swarm_lab, 132, title="swarm", sliders=choices)
    player.set(frame=131)
    assert "m off" in player.text


def test_doubt_says_how_many_robots_lie_inside():
    panel = lab.Panel(plot.doubt_lab, LABS["doubt"][1], title="doubt")
    share = int(panel.text.split(";")[1].split("%")[0])
    assert 88 <= share <= 99


def test_pictures_of_maps_hold_the_data():
    grid = study.flat()
    found = kinds.places(grid, 1.0)
    names = kinds.name_places(found, grid, study.NAMES)
    _, axes = plt.subplots(2, 2)
    walls = kinds.outline(grid)
    assert len(plot.draw_outline(axes[0, 0], walls).get_segments()) == len(walls)
    assert plot.draw_regions(axes[0, 1], found, names, grid.extent).get_array().max() == len(names)
    assert len(plot.draw_places(axes[1, 0], found, names)) == 2 * len(found.passages) + 2 * len(names)
    chances = plot.draw_occupancy(axes[1, 1], mapping.empty([0, 1, 0, 2], 0.5))
    assert np.all(chances.get_array() == 0.5)
    assert chances.get_extent() == [0, 1, 0, 2]
    plt.close("all")


def test_ellipses_are_drawn_from_the_last_belief_back():
    start = localization.Belief(np.zeros(3), np.eye(3) * 0.01)
    track = localization.dead_reckoning(start, [[0.5, 0.1]] * 7, study.NOISE)
    lines = plot.ellipse_lines(track, every=3)
    assert len(lines) == 3
    assert lines[0].mean(axis=0) == pytest.approx(track.means[-1, :2], abs=0.02)
