"""Pictures of the planner among movers show what the guard, the prediction and the map hold."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from fuzzynav import dwa, fusion, plot
from fuzzynav.robot import THESIS, TURTLEBOT2

HERE = (0.0, 0.0, 0.0)


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def watched():
    task = fusion.hall_task(blocks=[[5.6, 6.3]], walkers=[[3.0, 1.5, 3.0, 6.5, 0.4]], ideal=False)
    return task, *fusion.watch(task)


@pytest.mark.parametrize("robot", [THESIS, TURTLEBOT2], ids=["thesis", "turtlebot2"])
@pytest.mark.parametrize("sample", [(0.6, 0.0), (0.5, 0.3), (0.13, -0.2)])
def test_the_braking_arc_ends_where_the_robot_stands(robot, sample):
    moments, places = plot.braking_arc(HERE, sample, robot, 0.1)
    need = dwa.stopping_distance([sample], robot, 0.1)[0]
    assert 0.5 * moments[-1] == pytest.approx(fusion.reached_by_then(sample, 0.5, robot, 0.1))
    assert np.hypot(*np.diff(places[:, :2], axis=0).T).sum() == pytest.approx(need, rel=1e-3)
    curvature = sample[1] / sample[0]
    assert places[-1, 2] == pytest.approx(curvature * need, abs=1e-9)


def test_a_robot_that_stands_has_no_braking_arc():
    moments, places = plot.braking_arc(HERE, (0.0, 0.3), TURTLEBOT2, 0.1)
    assert moments.tolist() == [0.0]
    assert places.tolist() == [[0.0, 0.0, 0.0]]


def test_what_movers_reach_grows_until_the_robot_stands():
    _, ax = plt.subplots()
    mark = plot.draw_reachable(ax, [0.6, 0.0], [[3.0, 0.5, 0.3]], 0.5, THESIS)
    outer = mark.ground.get_paths()[0].vertices
    reach = np.hypot(*(outer[:-1] - [3.0, 0.5]).T)
    np.testing.assert_allclose(reach, 0.3 + fusion.reached_by_then([0.6, 0.0], 0.5, THESIS, 0.1), atol=1e-9)
    assert len(mark.rings.get_segments()) == len(mark.bodies.get_segments()) == 4


def test_a_larger_bound_forbids_more():
    walker = [[2.6, 0.0, 0.3]]
    shares = [plot.forbidden(THESIS, walker, bound, n=(11, 11))[0] for bound in (0.0, 0.3, 0.8)]
    assert not shares[0][0].any()  # who stands is always clear
    assert (shares[0] <= shares[1]).all()
    assert (shares[1] <= shares[2]).all()
    assert 0 < shares[1].sum() < shares[2].sum()


def test_every_sample_of_a_window_is_drawn_once(watched):
    _, _, moments = watched
    made = max((m.decision for m in moments), key=lambda d: int((d.reasons != 0).sum()))
    _, ax = plt.subplots()
    mark = plot.draw_reasons(ax, made, made.samples[made.chosen], fusion.ROBOTS["turtlebot2"])
    drawn = [len(mark.scored.get_offsets()), *(len(line.get_xdata()) for line in mark.refused)]
    assert sum(drawn) == len(made.samples)
    for reason in (1, 2, 3):
        assert drawn[1 + reason] == ((made.reasons == reason) & ~made.eligible).sum()
    assert [line.get_xdata()[0] for line in (mark.chosen,)] == [0.0]


def test_a_prediction_moves_on_and_grows():
    _, ax = plt.subplots()
    mark = plot.prediction_mark(ax)
    mark.place([[1.0, 2.0, 0.5, -0.2, 0.3]], 3.0, 0.1)
    for t, disc in zip((1, 2, 3), mark.discs.get_segments(), strict=True):
        np.testing.assert_allclose(np.hypot(*(disc - [1.0 + 0.5 * t, 2.0 - 0.2 * t]).T), 0.3 + 0.1 * t, atol=1e-9)


def test_a_moment_shows_the_cells_that_were_entered(watched):
    task, driven, moments = watched
    _, ax = plt.subplots()
    mark = plot.draw_moment(ax, task, moments[-1], driven=driven.run.poses)
    shown = np.asarray(mark.image.get_array().filled(0.0))
    assert shown.sum() == moments[-1].entered.sum() > 0
    assert tuple(np.ravel(mark.target.get_data())) == tuple(moments[-1].decision.target)


def test_a_track_is_drawn_where_it_is_believed(watched):
    _, _, moments = watched
    seen = next(m for m in moments if m.tracks.moving.any())
    k = int(np.flatnonzero(seen.tracks.moving)[0])
    _, ax = plt.subplots()
    _, now, way, later = plot.draw_track(ax, seen.tracks, k, ahead=2.0)
    ring = np.column_stack(now.get_data()) - seen.tracks.centers[k]
    inverse = np.linalg.inv(seen.tracks.covariances[k][:2, :2])
    np.testing.assert_allclose(np.einsum("ni,ij,nj->n", ring, inverse, ring), 4.0, rtol=1e-6)  # two deviations
    assert np.ptp(later.get_xdata()) > np.ptp(now.get_xdata())
    np.testing.assert_allclose(
        np.column_stack(way.get_data())[1], seen.tracks.centers[k] + 2.0 * seen.tracks.velocities[k]
    )


def test_hits_need_a_scan(watched):
    _, _, moments = watched
    seen = moments[0].observation
    _, ax = plt.subplots()
    hits, lines = plot.draw_scan_hits(ax, seen, np.ones(360, dtype=bool))
    assert len(lines.get_segments()) == len(hits.get_xdata()) > 100
    bare = type(seen)(time=0.0, pose=seen.pose, velocity=seen.velocity, goal=seen.goal, points=seen.points)
    with pytest.raises(ValueError, match="no scan"):
        plot.draw_scan_hits(ax, bare, np.ones(360, dtype=bool))
