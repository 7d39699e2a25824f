"""Pictures and labs of local planning show what the plan holds."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from PIL import Image

from fuzzynav import dwa, lab, plot, simulate
from fuzzynav.dwa import retuned
from fuzzynav.dwa.fast import RULES
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.robot import THESIS
from fuzzynav.studies.dwa import claims, comparison
from fuzzynav.world import Mover, World

YARD = World(
    discs=[[3.0, 2.6, 0.5]],
    rectangles=[[1.0, 4.0, 0.8, 0.5, 0.3]],
    unknown_discs=[[5.0, 1.0, 0.3]],
    movers=(Mover.constant((4, 5), (0.0, -0.3), 0.3),),
    bounds=(0, 7, 0, 7),
)


@pytest.fixture(scope="module")
def driven():
    controller = dwa.Controller(THESIS, dwa.TABLE_4_1, keep=True)
    run = simulate.run(YARD, THESIS, controller, (1, 1), (6, 6), t_max=8.0)
    return run, controller.plans


def test_the_window_shows_every_sample_once() -> None:
    seen = claims.small_scene((0.8, 0.1))
    made = dwa.plan(seen, THESIS)
    _, ax = plt.subplots()
    mark = plot.draw_window(ax, made, seen.velocity, THESIS, dwa.TABLE_3_3)
    ok = made.admissible[:-1]
    assert 0 < ok.sum() < ok.size
    assert len(mark.scored.get_offsets()) == ok.sum()
    assert len(mark.refused.get_xdata()) == (~ok).sum()
    shown = np.array([mark.chosen.get_xdata()[0], mark.chosen.get_ydata()[0]])
    np.testing.assert_allclose(shown[::-1] + seen.velocity, made.command, atol=1e-12)
    plt.close("all")


def test_refused_arcs_end_at_first_contact() -> None:
    seen = claims.small_scene((0.8, 0.1))
    made = dwa.plan(seen, THESIS)
    _, ax = plt.subplots()
    mark = plot.draw_candidates(ax, seen, made, THESIS, dwa.TABLE_3_3)
    ends = [line[-1] for line in mark.refused.get_segments()]
    assert len(ends) == (~made.admissible).sum()
    gaps = [np.hypot(*(seen.points - end).T).min() for end in ends]
    assert min(gaps) >= THESIS.radius - 1e-6
    plt.close("all")


def test_the_light_region_is_what_can_stop() -> None:
    seen = claims.small_scene()
    _, ax = plt.subplots()
    image = plot.draw_velocity_sets(ax, seen, THESIS, dwa.TABLE_3_3, n=21)
    safe = np.asarray(image.get_array())
    assert safe[0].all()  # at rest everything can stop
    assert 0 < safe.mean() < 1
    plt.close("all")


def test_the_scrubber_shows_another_moment(driven) -> None:
    run, plans = driven
    player = lab.Player(
        plot.dwa_scrubber,
        run.iterations,
        title="t",
        given={"run": run, "plans": plans, "world": YARD, "params": dwa.TABLE_4_1},
    )
    first, words = player.png, player.text
    player.set(frame=30)
    assert player.png != first
    assert player.text != words
    assert f"{run.t[30]:.1f} s" in player.text
    player.set(frame=0)
    assert player.text == words


def test_the_player_and_the_gif_hold_the_run(driven, tmp_path) -> None:
    run, _ = driven
    path = plot.save_gif(run, YARD, tmp_path / "run.gif", every=20)
    with Image.open(path) as film:
        assert film.n_frames == len(list(run.frames(20)))
    with pytest.raises(ValueError, match="every"):
        plot.save_gif(run, YARD, tmp_path / "run.gif", every=0)


def test_labs_answer_their_sliders() -> None:
    world = World(grid=comparison.random_map("0.05/40004"))
    update = plot.weights_lab(plt.figure(), world=world, start=comparison.START, goal=comparison.GOAL)
    _, stall = update(alpha=0.8, beta=0.1, gamma=0.1, rival="printed .8 .1 .1")
    assert stall.count("stalled") == 2
    _, free = update(alpha=0.2, beta=0.7, gamma=0.1, rival="fuzzy, 27 rules")
    assert "sliders: reached" in free
    obstacle = plot.obstacle_lab(plt.figure())
    assert "full braking" in obstacle(x=1.0, y=0.0, v=0.9, omega=0.0)[1]
    assert obstacle(x=4.0, y=1.5, v=0.3, omega=0.0)[1].startswith("0 of")
    plt.close("all")


def test_narrower_sets_leave_more_states_without_a_rule() -> None:
    nine = FuzzySystem.load(RULES / "thesis_table_3_2.fll")
    peaks = {"headGoal": 90.0, "distObs": 7.5, "velRob": 0.5}
    same = retuned(nine, peaks, dict.fromkeys(peaks, 1.0))
    assert same.inputs[0].terms[1].parameters == nine.inputs[0].terms[1].parameters
    gaps = [retuned(nine, peaks, dict.fromkeys(peaks, reach)).uncovered(15).fraction for reach in (1.0, 0.7, 0.4)]
    assert gaps[0] < gaps[1] < gaps[2]
