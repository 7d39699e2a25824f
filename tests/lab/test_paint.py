"""The painting lab: strokes, the keyboard's way, start and goal, speed; and the other labs of global planning."""

import json
import time

import numpy as np
import pytest

from fuzzynav import lab, plot
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar
from fuzzynav.studies.planning.maps import SCENES_3, SCENES_4

PLANNERS = {"traditional": astar.TRADITIONAL, "Dijkstra": astar.DIJKSTRA}


@pytest.fixture
def paint():
    return lab.Paint(GridMap(np.zeros((10, 12), dtype=bool)), (1, 1), (10, 8), PLANNERS, title="Walls <mine>", size=240)


def send(paint, event, x=0.0, y=0.0):
    """What the browser sends when the mouse acts at a point of the picture."""
    paint._canvas[2]._handle_frontend_event(None, {"event": event, "x": x, "y": y}, [])


def press(paint, cells):
    """A stroke through the middles of cells."""
    rows, side = paint.grid.shape[0], paint._side
    for k, (x, y) in enumerate(cells):
        send(paint, "mouse_down" if k == 0 else "mouse_move", (x + 0.5) * side, (rows - 0.5 - y) * side)
    send(paint, "mouse_up")


def test_first_picture_and_words(paint):
    data = paint._repr_mimebundle_()
    assert data["text/plain"] == repr(paint) == "Lab: Walls <mine>"
    assert data["image/png"].startswith(b"\x89PNG")
    json.dumps({k: v for k, v in data.items() if k != "image/png"})
    assert paint.text == f"{paint.result.searched} cells searched, length {paint.result.length:.2f} m"


def test_a_stroke_paints_without_gaps_and_the_search_goes_round(paint):
    before = paint.result.length
    press(paint, [(6, 1), (6, 8)])
    assert paint.grid.occupied[1:9, 6].all()
    assert paint.result.length > before
    press(paint, [(6, 0), (6, 9)])
    assert paint.text.endswith("no path")
    assert len(paint.result.cells) == 0


def test_moving_without_pressing_paints_nothing(paint):
    send(paint, "mouse_move", 100.0, 100.0)
    assert not paint.grid.occupied.any()


def test_strokes_beyond_the_edge_stay_on_the_map(paint):
    press(paint, [(-3, 4), (40, 4)])
    assert paint.grid.occupied[4].all()


def test_start_and_goal_cannot_be_painted_over_and_can_move(paint):
    paint.touch((1, 1), "draw walls")
    paint.touch((10, 8), "draw walls")
    assert not paint.grid.occupied.any()
    paint.touch((4, 4), "move start")
    paint.touch((5, 5), "draw walls")
    paint.touch((5, 5), "move goal")  # a wall: refused
    paint.touch((4, 4), "move goal")  # the start: refused
    assert (paint.start, paint.goal) == ((4, 4), (10, 8))
    paint.touch((2, 8), "move goal")
    assert paint.result.cells[[0, -1]].tolist() == [[4, 4], [2, 8]]
    paint.touch((5, 5), "erase walls")
    assert not paint.grid.occupied.any()
    paint.reset()
    assert (paint.start, paint.goal) == ((1, 1), (10, 8))


def test_the_keyboard_does_what_the_mouse_does(paint):
    paint._column.value, paint._row.value = 7, 3
    buttons = [w for w in paint._view.children[0].children[6].children]
    buttons[0].click()
    assert np.argwhere(paint.grid.occupied).tolist() == [[3, 7]]
    buttons[1].click()
    assert not paint.grid.occupied.any()


def test_another_planner_searches_at_once(paint):
    before = paint.result.searched
    paint.choose("Dijkstra")
    assert paint.result.searched > before
    with pytest.raises(ValueError, match="planner"):
        paint.choose("best")


def test_a_stroke_is_answered_within_a_tenth_of_a_second():
    rng = np.random.default_rng(0)
    occupied = rng.random((60, 60)) < 0.2
    occupied[0, 0] = occupied[-1, -1] = False
    large = lab.Paint(GridMap(occupied), (0, 0), (59, 59), {"Dijkstra": astar.DIJKSTRA}, title="large")
    spent = []
    for x in range(20, 31):
        began = time.perf_counter()
        large.touch((x, 30), "erase walls" if large.grid.occupied[30, x] else "draw walls")
        spent.append(time.perf_counter() - began)
    assert np.median(spent) < 0.1


def test_bad_input_is_refused(paint):
    empty = GridMap(np.zeros((3, 3), dtype=bool))
    with pytest.raises(ValueError, match="planner"):
        lab.Paint(empty, (0, 0), (2, 2), {}, title="x")
    with pytest.raises(ValueError, match="start"):
        lab.Paint(empty, (5, 0), (2, 2), PLANNERS, title="x")
    with pytest.raises(ValueError, match="free cell"):
        lab.Paint(GridMap.from_ascii("#..\n...\n..."), (0, 2), (2, 2), PLANNERS, title="x")
    with pytest.raises(ValueError, match="outside"):
        paint.touch((12, 0))
    with pytest.raises(ValueError, match="action"):
        paint.touch((1, 0), "burn")


def moved(panel, **values) -> bool:
    before = panel.png
    panel.set(**values)
    return panel.png != before


def test_search_lab_follows_every_control():
    scene = SCENES_4["M2 cut"]
    choices = ("zero", "euclidean", "octile", "manhattan", "enhanced")
    panel = lab.Panel(
        plot.search_lab,
        {
            "heuristic": lab.Choice("heuristic", choices, "octile"),
            "weight": lab.Slider("weight", 0.0, 4.0, 1.0, 0.1),
            "neighbours": lab.Choice("neighbours", ("4", "8"), "8"),
            "corners": lab.Choice("corners", ("strict", "permissive"), "strict"),
            "radius": lab.Slider("radius", 0.0, 2.0, 0.0, 0.1),
        },
        title="search",
        size=(4, 4),
        given={"grid": scene.grid, "start": scene.start, "goal": scene.goal},
    )
    assert "over the shortest" in panel.text
    for values in ({"weight": 3.0}, {"heuristic": "zero"}, {"neighbours": "4"}, {"radius": 0.7}):
        panel.reset()
        assert moved(panel, **values), values
    panel.set(radius=2.0)
    assert panel.text.startswith("start blocked")


def test_film_safety_and_eta_labs():
    scene = SCENES_3["S1"]
    found = {n: astar.search(scene.grid, scene.start, scene.goal, o) for n, o in PLANNERS.items()}
    film = lab.Player(plot.search_film, 60, title="film", size=(6, 3), given={"grid": scene.grid, "results": found})
    assert moved(film, frame=30)
    assert film.text == "cells expanded: traditional 30 of 35, Dijkstra 30 of " + str(found["Dijkstra"].searched)
    wide = SCENES_4["M2 cut"]
    safety = lab.Panel(
        plot.safety_lab,
        {
            "radius": lab.Slider("radius", 0.0, 2.0, 0.5, 0.1),
            "base": lab.Slider("base", 2.0, 12.0, 10.0, 1.0),
        },
        title="safety",
        size=(4, 5),
        given={"grid": wide.grid, "start": wide.start, "goal": wide.goal},
    )
    assert moved(safety, radius=0.8)
    safety.set(radius=2.0)
    assert safety.text == "start blocked at 2.00 m"
    eta = lab.Panel(
        plot.eta_lab,
        {
            "speeds": lab.Slider("speeds", 0.5, 15.0, 5.0, 0.5),
            "accelerations": lab.Slider("a", -30.0, 30.0, 0.0, 1.0),
            "jerks": lab.Slider("j", -100.0, 100.0, 0.0, 5.0),
            "heading": lab.Slider("heading", -90.0, 90.0, 0.0, 5.0),
        },
        title="eta",
        size=(4, 5),
    )
    for values in ({"speeds": 9.0}, {"accelerations": 10.0}, {"jerks": 50.0}, {"heading": 45.0}):
        eta.reset()
        assert moved(eta, **values), values
