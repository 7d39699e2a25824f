"""Node removal, B-splines, eta-cubed splines: against first principles, SciPy, linear algebra; free of collision."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.interpolate import BSpline

from fuzzynav import smoothing
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar
from fuzzynav.smoothing import eta as eta_splines
from fuzzynav.smoothing import simplify

SQUARE = np.array([[0.0, 0.0], [2.0, 1.0], [3.0, 4.0], [5.0, 3.0], [6.0, 0.5], [9.0, 1.0]])


def planned(seed: int, radius: float, density: float = 0.2) -> tuple[GridMap, np.ndarray]:
    """A random map and the cells of an enhanced path across it, empty where there is none."""
    rng = np.random.default_rng(seed)
    occupied = rng.random((16, 16)) < density
    occupied[0, 0] = occupied[-1, -1] = False
    grid = GridMap(occupied)
    return grid, astar.search(grid, (0, 0), (15, 15), replace(astar.ENHANCED, safety_radius=radius)).cells


# -- removing nodes


def test_collinear_nodes_go_and_turning_back_stays() -> None:
    assert simplify.remove_collinear([[0, 0], [1, 0], [3, 0], [4, 0]]).tolist() == [[0, 0], [4, 0]]
    assert simplify.remove_collinear([[0, 0], [2, 0], [1, 0]]).tolist() == [[0, 0], [2, 0], [1, 0]]
    assert simplify.remove_collinear([[0, 0]]).tolist() == [[0, 0]]
    assert simplify.remove_collinear(np.empty((0, 2), dtype=int)).shape == (0, 2)


def test_the_three_cases_of_figure_3_5() -> None:
    empty = GridMap(np.zeros((5, 5), dtype=bool))
    wall = GridMap.from_ascii(".....\n.....\n.....\n.##..\n.....")
    assert simplify.key_nodes([[0, 0], [1, 0], [2, 0]], empty).tolist() == [[0, 0], [2, 0]]
    bent = [[0, 0], [0, 2], [3, 2]]
    assert simplify.key_nodes(bent, wall).tolist() == bent
    assert simplify.key_nodes(bent, empty).tolist() == [[0, 0], [3, 2]]


def test_restart_from_the_blocked_node_keeps_an_avoidable_one() -> None:
    wall = GridMap.from_ascii("......\n.####.\n.####.\n......")
    path = [[0, 0], [0, 1], [0, 3], [1, 3], [3, 3], [5, 3], [5, 0]]
    right, printed = simplify.shorten(path, wall), simplify.shorten_as_printed(path, wall)
    assert right.tolist() == [[0, 0], [0, 3], [5, 3], [5, 0]]
    assert len(printed) > len(right)
    assert smoothing.is_free(wall.center_of(printed), wall)


@settings(max_examples=80, deadline=None)
@given(seed=st.integers(0, 10**6), radius=st.sampled_from([0.0, 0.3, 0.5]))
def test_simplified_paths_are_free_and_no_longer(seed: int, radius: float) -> None:
    grid, cells = planned(seed, radius)
    if len(cells) == 0:
        return
    whole = astar.path_length(cells)
    lengths = {}
    for name in ("remove_collinear", "key_nodes", "prune", "shorten", "best_shortcut", "shorten_as_printed"):
        f = getattr(simplify, name)
        kept = f(cells) if name == "remove_collinear" else f(cells, grid, radius)
        assert smoothing.is_free(grid.center_of(kept), grid, radius), name
        assert kept[0].tolist() == cells[0].tolist()
        assert kept[-1].tolist() == cells[-1].tolist()
        lengths[name] = astar.path_length(kept)
        assert lengths[name] <= whole + 1e-9
    assert lengths["best_shortcut"] <= min(lengths.values()) + 1e-9


@pytest.mark.parametrize("name", ["key_nodes", "prune", "shorten", "best_shortcut", "shorten_as_printed"])
def test_paths_too_short_to_simplify_pass_as_they_are(name: str) -> None:
    grid = GridMap(np.zeros((3, 3), dtype=bool))
    for cells in (np.empty((0, 2), dtype=int), [[1, 1]], [[0, 0], [1, 1]]):
        assert getattr(simplify, name)(cells, grid).tolist() == np.asarray(cells).tolist()
    with pytest.raises(ValueError, match="radius"):
        getattr(simplify, name)([[0, 0], [1, 1]], grid, -1.0)
    with pytest.raises(ValueError, match="corners"):
        getattr(simplify, name)([[0, 0], [1, 1]], grid, 0.0, "soft")


def test_a_blocked_path_is_refused() -> None:
    grid = GridMap.from_ascii("...\n.#.\n...")
    with pytest.raises(ValueError, match="not free"):
        simplify.prune([[0, 0], [0, 1], [2, 1]], grid)
    with pytest.raises(ValueError, match="whole numbers"):
        simplify.prune([[0.5, 0.5], [1.0, 1.0]], grid)


# -- B-splines


def test_one_basis_four_ways() -> None:
    t = np.linspace(0.0, 1.0, 11)
    knots = np.arange(8.0)
    powers = np.stack([smoothing.uniform_basis(i, 3, t) for i in range(4)], axis=-1)
    recursion = np.stack([smoothing.cox_de_boor(i, 4, knots, t + 3.0) for i in range(4)], axis=-1)
    matrix = smoothing.segment(np.eye(4), t)
    for other in (powers, recursion, matrix):
        assert np.allclose(smoothing.cubic_basis(t), other, atol=1e-14)
    assert np.allclose(smoothing.cubic_basis(t).sum(axis=-1), 1.0, atol=1e-14)


def test_order_is_not_degree() -> None:
    at = [0.5, 1.0, 1.5, 2.0, 2.5]
    assert smoothing.cox_de_boor(0, 3, np.arange(5.0), at).tolist() == [0.125, 0.5, 0.75, 0.5, 0.125]
    assert np.allclose(smoothing.cox_de_boor(0, 4, np.arange(5.0), [0.5, 2.0]), [1 / 48, 2 / 3])


def test_printed_matrix_does_not_sum_to_one_and_jumps_by_the_shared_point() -> None:
    t = np.linspace(0.0, 1.0, 5)
    assert np.allclose(smoothing.segment_as_printed(np.ones((4, 1)), t)[:, 0], 1.0 + t**3)
    line = np.arange(4.0)[:, None]
    assert np.allclose(smoothing.segment_as_printed(line, t)[:, 0], 2 * t**3 + t + 1)
    controls = SQUARE[:5]
    jump = smoothing.segment_as_printed(controls[1:5], 0.0) - smoothing.segment_as_printed(controls[:4], 1.0)
    assert np.allclose(jump, -controls[2])
    join = smoothing.segment(controls[1:5], 0.0) - smoothing.segment(controls[:4], 1.0)
    assert np.allclose(join, 0.0, atol=1e-14)


def test_printed_summation_limit_is_right_for_one_function_alone() -> None:
    t = np.linspace(0.0, 1.0, 7)
    printed, right = smoothing.uniform_basis_as_printed, smoothing.uniform_basis
    same = [np.allclose(printed(i, 3, t), right(i, 3, t)) for i in range(4)]
    assert same == [False, True, False, False]
    total = sum(smoothing.uniform_basis_as_printed(i, 3, t) for i in range(4))
    assert np.allclose(total, 2 * t**3 - 7 * t**2 + 13 * t - 22 / 3)


@pytest.mark.parametrize("ends", ["clamped", "free"])
@pytest.mark.parametrize("count", [4, 5, 6])
def test_spline_and_its_derivatives_equal_scipy(ends: str, count: int) -> None:
    ours = smoothing.bspline(SQUARE[:count], ends)
    theirs = BSpline(ours.knots, SQUARE[:count], 3)
    t = ours.parameters(57)
    for order in range(3):
        assert np.allclose(ours.derivative(t, order), theirs(t, nu=order), atol=1e-12)
    inside = t[~np.isclose(t, np.round(t))]  # the third derivative jumps at the knots
    assert np.allclose(ours.derivative(inside, 3), theirs(inside, nu=3), atol=1e-11)
    fine = ours.points(20001)
    assert ours.length == pytest.approx(np.hypot(*np.diff(fine, axis=0).T).sum(), abs=1e-6)


def test_free_ends_miss_the_path_and_clamped_ones_do_not() -> None:
    free, clamped = smoothing.bspline(SQUARE, "free"), smoothing.bspline(SQUARE)
    assert np.allclose(free.points(2)[0], (SQUARE[0] + 4 * SQUARE[1] + SQUARE[2]) / 6)
    assert np.allclose(clamped.points(2), SQUARE[[0, -1]], atol=1e-12)
    leave = clamped.derivative(0.0, 1)
    assert math.atan2(*leave[::-1]) == pytest.approx(math.atan2(1.0, 2.0))


def test_free_spline_equals_the_matrix_form_span_by_span() -> None:
    spline = smoothing.bspline(SQUARE, "free")
    t = np.linspace(0.0, 0.999, 9)
    for k in range(3):
        assert np.allclose(spline.derivative(k + t), smoothing.segment(SQUARE[k : k + 4], t), atol=1e-12)


def test_curvature_is_continuous_and_right_on_a_circle() -> None:
    angle = np.linspace(0.0, 2 * np.pi, 60)
    circle = smoothing.bspline(3.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1), "free")
    t = circle.parameters(400)
    assert np.allclose(circle.curvature(t), 1 / 3, rtol=0.01)
    assert np.abs(circle.curvature_rate(t)).max() < 0.01
    bent = smoothing.bspline(SQUARE)
    knot = 2.0
    assert bent.curvature(knot - 1e-9) == pytest.approx(bent.curvature(knot + 1e-9), abs=1e-6)


def test_rate_is_the_slope_of_curvature_along_the_arc() -> None:
    for curve in (smoothing.bspline(SQUARE), eta_splines.eta3([0, 0, 0.3, 0.2, 0.05], [4, 3, 1.1, -0.4, 0.07], [2, 3])):
        u, h = 0.4, 1e-5
        speed = float(np.hypot(*curve.derivative(u, 1)))
        slope = (curve.curvature(u + h) - curve.curvature(u - h)) / (2 * h) / speed
        assert float(curve.curvature_rate(u)) == pytest.approx(float(slope), rel=1e-5)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (SQUARE[:3], "four control points"),
        (np.zeros((5, 2)), "coincide"),
        (SQUARE[[0, 1, 1, 2, 3]], "coincide"),
        (np.full((4, 2), np.nan), "finite"),
        (np.zeros((4, 3)), "finite"),
    ],
)
def test_points_that_make_no_spline(points, words) -> None:
    with pytest.raises(ValueError, match=words):
        smoothing.bspline(points)
    with pytest.raises(ValueError, match="ends"):
        smoothing.bspline(SQUARE, "loose")


@pytest.mark.parametrize("radius", [0.0, 0.3, 0.5])
def test_checked_splines_are_free_at_the_robots_edge(radius: float) -> None:
    done = 0
    for seed in range(40):
        grid, cells = planned(seed, radius)
        if len(cells) == 0:
            continue
        nodes = grid.center_of(simplify.prune(cells, grid, radius))
        smooth = smoothing.free_bspline(nodes, grid, radius)
        assert smooth.status == "free"
        fine = smooth.spline.points(4001)
        assert (grid.distance(fine) >= radius - 1e-3).all()
        assert np.allclose(fine[[0, -1]], nodes[[0, -1]], atol=1e-9)
        done += 1
    assert done > 15


def test_an_unchecked_spline_may_collide_where_the_checked_one_does_not() -> None:
    grid = GridMap.from_ascii("......\n.####.\n.####.\n......\n......")
    nodes = grid.center_of([[0, 0], [0, 4], [5, 4], [5, 0]])
    plain, smooth = smoothing.bspline(nodes), smoothing.free_bspline(nodes, grid, 0.3)
    assert not smoothing.is_free(plain.points(500), grid, 0.3)
    assert smooth.rounds > 0
    assert smoothing.is_free(smooth.spline.points(3000), grid, 0.3)
    assert smoothing.least_clearance(smooth.spline.points(3000), grid) >= 0.3


def test_a_curve_that_cannot_be_freed_says_so() -> None:
    grid = GridMap.from_ascii("..#\n.#.\n...").occupied
    grid = GridMap(grid)
    through = grid.center_of([[0, 0], [1, 0], [2, 1], [2, 1]])
    with pytest.raises(ValueError, match="not free"):
        smoothing.free_bspline(grid.center_of([[0, 0], [2, 2]]), grid)
    with pytest.raises(ValueError, match="two or more"):
        smoothing.free_bspline(through[:1], grid)
    sharp = GridMap.from_ascii("....\n.##.\n.##.\n....")
    corner = np.array([[0.5, 0.5], [1.0, 3.0], [3.5, 3.5]])  # the node lies on the obstacle's corner
    assert smoothing.free_bspline(corner, sharp, rounds=2).status == "blocked"


def test_turning_of_a_circle_and_a_line() -> None:
    angle = np.linspace(0.0, 2 * np.pi, 2001)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    assert smoothing.total_turning(circle) == pytest.approx(2 * np.pi, abs=0.01)
    assert smoothing.total_turning([[0, 0], [1, 1], [4, 4]]) == pytest.approx(0.0, abs=1e-12)
    grid = GridMap(np.zeros((8, 8), dtype=bool))
    found = smoothing.measure(2.0 * circle + 4.0, grid)
    assert found["curvature"] == pytest.approx(0.5, abs=1e-3)
    assert found["clearance"] == pytest.approx(2.0, abs=1e-3)
    assert found["length"] == pytest.approx(4 * np.pi, abs=1e-3)


@pytest.mark.parametrize("turn", [0.1, np.pi / 2, 2.5, 3.1])
def test_a_sharp_corner_turns_by_its_angle(turn):
    for side in (turn, -turn):
        corner = [[0, 0], [2, 0], [2 + np.cos(side), np.sin(side)]]
        assert smoothing.total_turning(corner) == pytest.approx(turn)


# -- eta-cubed splines


def conditions(start, end, eta) -> np.ndarray:
    """The coefficients (2, 8) from the sixteen end conditions, as linear equations."""
    rows, values = [], []
    for u, (x, y, theta, kappa, rate), (e1, e2, e3) in ((0.0, start, eta[::2]), (1.0, end, eta[1::2])):
        t, n = np.array([np.cos(theta), np.sin(theta)]), np.array([-np.sin(theta), np.cos(theta)])
        values += [[x, y], e1 * t, e2 * t + e1**2 * kappa * n, e3 * t + (e1**3 * rate + 3 * e1 * e2 * kappa) * n]
        for order in range(4):
            rows.append([math.perm(i, order) * (u ** (i - order) if i >= order else 0.0) for i in range(8)])
    return np.linalg.solve(np.array(rows), np.array(values)).T


angles, small = st.floats(-3.1, 3.1), st.floats(-1.0, 1.0)


@settings(max_examples=100, deadline=None)
@given(
    a=st.tuples(small, small, angles, small, small),
    b=st.tuples(st.floats(2, 6), st.floats(-4, 4), angles, small, small),
    eta=st.tuples(st.floats(0.2, 8), st.floats(0.2, 8), *[st.floats(-5, 5)] * 4),
)
def test_all_sixteen_conditions_are_met(a, b, eta) -> None:
    curve = eta_splines.eta3(a, b, eta)
    assert np.allclose(curve.coefficients, conditions(a, b, eta), rtol=1e-9, atol=1e-8)
    for u, end in ((0.0, a), (1.0, b)):
        assert np.allclose(curve.derivative(u), end[:2], atol=1e-8)
        assert math.remainder(float(curve.heading(u)) - end[2], 2 * math.pi) == pytest.approx(0.0, abs=1e-7)
        assert float(curve.curvature(u)) == pytest.approx(end[3], abs=1e-4)
        assert float(curve.curvature_rate(u)) == pytest.approx(end[4], abs=5e-2 * max(1.0, 1.0 / min(eta[:2])) ** 3)


def test_the_printed_coefficients_miss_the_end() -> None:
    case = ([0, 0, 0.3, 0.2, 0.05], [4, 3, 1.1, -0.4, 0.07], [2, 3, 0.7, -0.5, 0.9, -1.2])
    assert np.allclose(eta_splines.coefficients(*case).sum(axis=1), [4, 3], atol=1e-12)
    printed = eta_splines.coefficients_as_printed(*case)
    assert np.round(printed.sum(axis=1), 4).tolist() == [5.0986, 248.2926]
    same = np.isclose(printed, eta_splines.coefficients(*case))
    assert same[0].tolist() == [True, True, False, True, True, True, True, True]
    assert same[1].tolist() == [True, True, False, True, False, False, False, False]


def test_straight_and_turned_curves() -> None:
    line = eta_splines.eta3([0, 0, 0], [5, 0, 0])
    assert np.allclose(line.points(50)[:, 1], 0.0, atol=1e-12)
    assert line.length == pytest.approx(5.0)
    a, b = np.array([0.0, 0, 0.2, 0.3, 0.1]), np.array([3.0, 2, 1.0, -0.2, 0.0])
    turn = 0.7
    rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    turned = [np.concatenate([e[:2] @ rotation, [e[2] + turn], e[3:]]) for e in (a, b)]
    assert np.allclose(
        eta_splines.eta3(*turned, [3, 2]).points(), eta_splines.eta3(a, b, [3, 2]).points() @ rotation, atol=1e-12
    )
    wrapped = eta_splines.eta3(a + [0, 0, 2 * np.pi, 0, 0], b, [3, 2])
    assert np.allclose(wrapped.points(), eta_splines.eta3(a, b, [3, 2]).points(), atol=1e-9)


def test_a_chain_has_no_jump_in_curvature_or_its_rate() -> None:
    joined = eta_splines.chain(SQUARE)
    assert len(joined.pieces) == len(SQUARE) - 1
    for one, two in zip(joined.pieces[:-1], joined.pieces[1:], strict=True):
        assert np.allclose(one.derivative(1.0), two.derivative(0.0), atol=1e-10)
        assert float(one.heading(1.0)) == pytest.approx(float(two.heading(0.0)), abs=1e-10)
        assert float(one.curvature(1.0)) == pytest.approx(float(two.curvature(0.0)), abs=1e-8)
        assert float(one.curvature_rate(1.0)) == pytest.approx(float(two.curvature_rate(0.0)), abs=1e-6)
    assert np.allclose(joined.points(3)[::2], SQUARE)
    assert joined.length == pytest.approx(joined.arc_length(2001)[-1], abs=1e-5)
    assert len(joined.points(11)) == len(joined.curvature(11)) == len(joined.curvature_rate(11)) == 51


def test_a_chain_round_a_circle_keeps_its_curvature() -> None:
    angle = np.linspace(0.0, np.pi, 7)
    joined = eta_splines.chain(2.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1), start_heading=np.pi / 2)
    middle = joined.pieces[2]
    assert np.allclose(np.hypot(*middle.points(20).T), 2.0, atol=2e-3)
    assert float(middle.curvature(0.0)) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("start", "end", "eta", "words"),
    [
        ([0, 0, 0], [0, 0, 1], None, "coincide"),
        ([0, 0], [1, 0, 0], None, "start"),
        ([0, 0, 0], [1, math.nan, 0], None, "end"),
        ([0, 0, 0], [1, 0, 0], [0, 1], "positive"),
        ([0, 0, 0], [1, 0, 0], [1, -2], "positive"),
        ([0, 0, 0], [1, 0, 0], [1], "two to six"),
        ([0, 0, 0], [1, 0, 0], [1, 1, math.inf], "two to six"),
    ],
)
def test_ends_that_make_no_curve(start, end, eta, words) -> None:
    with pytest.raises(ValueError, match=words):
        eta_splines.eta3(start, end, eta)


@pytest.mark.parametrize(("points", "words"), [([[0, 0]], "two or more"), ([[0, 0], [0, 0], [1, 1]], "coincide")])
def test_points_that_make_no_chain(points, words) -> None:
    with pytest.raises(ValueError, match=words):
        eta_splines.chain(points)
    with pytest.raises(ValueError, match="stretch"):
        eta_splines.chain(SQUARE, stretch=0.0)


# -- eta-cubed splines at the edge of what they can be


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_a_chain_there_and_back_turns_to_the_same_side_however_it_lies(quarters):
    turned = np.linalg.matrix_power(np.array([[0, -1], [1, 0]]), quarters)
    way = np.array([[0, 0], [2, 0], [0, 0]])
    there, moved = smoothing.chain(way).points(21), smoothing.chain(way @ turned.T).points(21)
    assert np.abs(there[:, 1]).max() > 0.1
    assert np.allclose(moved, there @ turned.T, atol=1e-9)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("seed", range(40))
def test_the_length_is_that_of_scipys_quadrature(seed: int) -> None:
    rng = np.random.default_rng(seed)
    start, end = (
        [0.0, 0.0, rng.uniform(-3, 3), *rng.uniform(-1, 1, 2)],
        [*rng.uniform(-6, 6, 2), *rng.uniform(-3, 3, 3)],
    )
    curve = eta_splines.eta3(start, end, [*rng.uniform(0.3, 9, 2), *rng.uniform(-60, 60, 4)])
    expected, _ = quad(lambda u: float(np.hypot(*curve.derivative(u, 1))), 0, 1, epsabs=0, epsrel=1e-12, limit=2000)
    assert curve.length == pytest.approx(expected, rel=1e-10)


@pytest.mark.filterwarnings("error")
def test_the_length_of_a_curve_with_a_cusp_and_of_a_spline_that_nearly_stops() -> None:
    cusp = smoothing.arc_length(lambda t: np.stack([3 * t**2, 2 * t], axis=-1), [-1.0, 0.3])  # (t^3, t^2), by hand
    assert cusp == pytest.approx(((4 + 9) ** 1.5 + (4 + 9 * 0.09) ** 1.5 - 16) / 27, rel=1e-10)
    turning = smoothing.bspline([[0, 0], [4, 0], [0, 1e-3], [4, 2e-3], [0, 1e-2]])
    ends = np.linspace(0.0, 2.0, 401)
    parts = [
        quad(lambda t: float(np.hypot(*turning.derivative(t, 1))), a, b, epsabs=1e-13)[0]
        for a, b in itertools.pairwise(ends)
    ]
    assert turning.length == pytest.approx(sum(parts), rel=1e-10)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1e-4, 1.0, 1e3, 1e6, 1e9])
def test_a_curve_has_the_same_shape_at_every_size(size: float) -> None:
    one = eta_splines.eta3([0, 0, 0.3, 0.2, 0.05], [0.8, 0.6, 1.1, -0.4, 0.07], [1, 1])
    other = eta_splines.eta3(
        [0, 0, 0.3, 0.2 / size, 0.05 / size**2],
        [0.8 * size, 0.6 * size, 1.1, -0.4 / size, 0.07 / size**2],
        [size, size],
    )
    assert np.allclose(other.points(9) / size, one.points(9), rtol=0, atol=1e-12)
    assert other.length / size == pytest.approx(one.length)
    u = np.linspace(0, 1, 9)
    assert np.allclose(other.curvature(u) * size, one.curvature(u), rtol=1e-6, atol=1e-9)
    assert np.allclose(other.curvature_rate(u) * size**2, one.curvature_rate(u), rtol=1e-6, atol=1e-9)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("start", "end", "eta", "words"),
    [
        ([0, 0, 0], [1e-200, 0, 0], None, "lie 1e-200 m apart"),
        ([0, 0, 0], [1e200, 0, 0], None, "end must be metres"),
        ([-1e308, 0, 0], [1e308, 0, 0], None, "start must be metres"),
        ([0, 0, 0, 1e300], [1, 0, 0], None, "start must be metres"),
        ([0, 0, 0], [1, 0, 0], [1e-200, 1], "must lie in 1e-09 to 1e"),
        ([0, 0, 0], [1, 0, 0], [1, 1e200], "must lie in 1e-09 to 1e"),
        ([0, 0, 0], [1, 0, 0], [1, 1, -1e200], "the others within"),
    ],
)
def test_numbers_whose_powers_no_curve_can_hold_are_refused(start, end, eta, words) -> None:
    with pytest.raises(ValueError, match=words):
        eta_splines.eta3(start, end, eta)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1e-9, 1e9])
def test_the_least_and_the_most_that_is_accepted_stays_finite(size: float) -> None:
    curve, u = eta_splines.eta3([0, 0, 0.3], [size, 0, 1.1], [size, size, size, -size]), np.linspace(0, 1, 9)
    for values in (curve.points(), curve.curvature(u), curve.curvature_rate(u), curve.length):
        assert np.isfinite(values).all()
    extreme = eta_splines.eta3([0, 0, 0.3, 1e9, -1e9], [1e-9, 0, 1.1, 1e9, 1e9], [1e9, 1e9, 1e9, -1e9, 1e9, 1e9])
    assert np.isfinite([*extreme.curvature(u), *extreme.curvature_rate(u), extreme.length]).all()


@pytest.mark.filterwarnings("error")
def test_a_curve_that_stops_has_no_curvature_there() -> None:
    assert np.isnan(eta_splines.curvature_rate([0.0, 0.0], [1.0, 0.0], [0.0, 1.0]))


def test_the_printed_coefficients_are_right_where_errata_name_no_misprint() -> None:
    rng = np.random.default_rng(4)
    wrong = {(0, 2), (1, 2), (1, 4), (1, 5), (1, 6), (1, 7)}  # T5; T8 with T6 and T7
    for _ in range(20):
        case = rng.normal(size=5), rng.normal(size=5), rng.uniform(0.5, 3, 6)
        right, printed = eta_splines.coefficients(*case), eta_splines.coefficients_as_printed(*case)
        assert {tuple(at) for at in np.argwhere(~np.isclose(right, printed, rtol=1e-9)).tolist()} == wrong
        gap = (case[1] - case[0])[0] - (case[1] - case[0])[1]
        assert printed[0, 2] - right[0, 2] == pytest.approx((case[2][1] - case[2][2]) / 2 * np.cos(case[0][2]))  # T5
        assert printed[1, 4] - right[1, 4] == pytest.approx(35 * gap)  # T8
        assert printed[1, 7] - right[1, 7] == pytest.approx(-20 * gap)  # T8


@pytest.mark.parametrize("turn", [0.5, 2.0, math.pi, 4.0, 5.5])
def test_a_turned_chain_is_the_chain_turned(turn: float) -> None:
    rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    loop = np.array([[0.0, 0.0], [2.0, 0.3], [2.5, 2.0], [1.0, 3.0], [-1.0, 2.0], [-0.5, -1.0], [2.0, -1.5]])
    assert np.allclose(eta_splines.chain(loop @ rotation).points(21), eta_splines.chain(loop).points(21) @ rotation)


@pytest.mark.parametrize("rounds", [-1, 0.5])
def test_rounds_that_cannot_be_counted_are_refused(rounds) -> None:
    grid = GridMap(np.zeros((5, 5), dtype=bool))
    with pytest.raises(ValueError, match="rounds must be a whole number"):
        smoothing.free_bspline([[0.5, 0.5], [4.5, 4.5]], grid, rounds=rounds)
    assert smoothing.free_bspline([[0.5, 0.5], [4.5, 4.5]], grid, rounds=0).status == "free"


def test_curves_cannot_be_written_to_and_leave_the_callers_points_alone() -> None:
    points = SQUARE.copy()
    spline, curve = smoothing.bspline(points), eta_splines.eta3([0, 0, 0], [1, 0, 0])
    points[0] = 7.0
    assert spline.controls[0].tolist() == [0.0, 0.0]
    for array in (spline.controls, spline.knots, curve.coefficients):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
