"""Angles, rigid motions, polylines and distances."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav import geometry as g

reals = st.floats(-50.0, 50.0)
poses = st.tuples(reals, reals, st.floats(-3.1, 3.1)).map(np.array)
points = st.lists(st.tuples(reals, reals), min_size=1, max_size=8).map(np.array)


@given(st.floats(-1e4, 1e4))
def test_wrap_keeps_the_direction_and_the_interval(angle: float) -> None:
    wrapped = g.wrap(angle)
    assert -np.pi <= wrapped < np.pi
    assert np.allclose([np.cos(wrapped), np.sin(wrapped)], [np.cos(angle), np.sin(angle)], atol=1e-9)


def test_wrap_at_the_ends() -> None:
    assert g.wrap([np.pi, -np.pi, 3 * np.pi, 0.0]).tolist() == [-np.pi, -np.pi, -np.pi, 0.0]
    assert g.wrap(-np.pi - 1e-16) < np.pi
    assert g.wrap(np.nextafter(-np.pi, -4.0)) < np.pi
    assert np.isnan(g.wrap(np.nan))
    assert g.wrap([0.4, -3.0, 1e-17]).tolist() == [0.4, -3.0, 1e-17]


@given(poses, poses, poses)
def test_rigid_motions_form_a_group(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> None:
    left, right = g.compose(g.compose(a, b), c), g.compose(a, g.compose(b, c))
    assert np.allclose(left[:2], right[:2], atol=1e-9)
    assert abs(g.wrap(left[2] - right[2])) < 1e-9
    assert np.allclose(g.compose(g.inverse(a), a), 0.0, atol=1e-9)


@given(poses, points)
def test_world_and_body_are_inverse_and_keep_lengths(pose: np.ndarray, pts: np.ndarray) -> None:
    there = g.to_world(pose, pts)
    assert np.allclose(g.to_body(pose, there), pts, atol=1e-9)
    assert g.length(there) == pytest.approx(g.length(pts), abs=1e-8)
    assert np.allclose(there, g.compose(pose, np.column_stack([pts, np.zeros(len(pts))]))[:, :2], atol=1e-9)


def test_known_transform() -> None:
    assert g.to_world([1.0, 2.0, np.pi / 2], [[1.0, 0.0], [0.0, 1.0]]).round(12).tolist() == [[1.0, 3.0], [0.0, 2.0]]


@given(st.lists(st.tuples(reals, reals), min_size=2, max_size=8).map(np.array), st.floats(0.05, 5.0))
def test_resample_keeps_ends_and_spacing(pts: np.ndarray, spacing: float) -> None:
    walked = g.resample(pts, spacing)
    assert np.allclose(walked[[0, -1]], pts[[0, -1]])
    assert np.hypot(*np.diff(walked, axis=0).T).max() <= spacing * (1 + 1e-9)
    assert g.length(walked) <= g.length(pts) + 1e-9


def test_lengths() -> None:
    assert g.cumulative_length([[0, 0], [3, 4], [3, 4], [3, 5]]).tolist() == [0.0, 5.0, 5.0, 6.0]
    assert g.length([[2.0, 2.0]]) == 0.0


@pytest.mark.parametrize("pts", [np.empty((0, 2)), np.zeros(3), np.zeros((3, 1))])
def test_a_polyline_without_points_is_refused(pts: np.ndarray) -> None:
    with pytest.raises(ValueError, match="polyline"):
        g.length(pts)


@pytest.mark.parametrize("spacing", [0.0, -1.0, np.nan, np.inf])
def test_a_bad_spacing_is_refused(spacing: float) -> None:
    with pytest.raises(ValueError, match="spacing"):
        g.resample([[0, 0], [1, 0]], spacing)


def test_curvature_of_circles_by_sense_of_turn() -> None:
    t = np.linspace(0.0, 6.0, 7)
    for radius, sense in [(2.0, 1.0), (0.5, -1.0)]:
        d1 = radius * np.stack([-np.sin(t), sense * np.cos(t)], axis=-1)
        d2 = radius * np.stack([-np.cos(t), -sense * np.sin(t)], axis=-1)
        assert np.allclose(g.curvature(d1, d2), sense / radius)
    assert np.isnan(g.curvature([0.0, 0.0], [1.0, 0.0]))


@given(points, st.tuples(reals, reals), st.tuples(reals, reals))
def test_segment_distance_against_sampling(pts: np.ndarray, a: tuple[float, float], b: tuple[float, float]) -> None:
    t = np.linspace(0.0, 1.0, 2001)[:, None]
    along = np.array(a) * (1 - t) + np.array(b) * t
    sampled = np.hypot(*(pts[:, None] - along).transpose(2, 0, 1)).min(axis=1)
    exact = g.point_segment_distance(pts, a, b)
    assert np.all(exact <= sampled + 1e-9)
    assert np.all(sampled <= exact + np.hypot(*np.subtract(a, b)) / 2000 + 1e-9)


@pytest.mark.parametrize(
    ("points", "spacing"), [([[0, 0], [1, 0]], 1e-12), ([[0, 0], [1e308, 0]], 1.0), ([[0, 0], [np.nan, 0]], 1.0)]
)
def test_absurd_steps_along_a_line_are_refused(points: list[list[float]], spacing: float) -> None:
    with pytest.raises(ValueError, match=r"take longer steps|must be finite"):
        g.resample(points, spacing)


def test_a_sealed_array_is_copied_only_once() -> None:
    mine = np.zeros(3)
    kept = g.read_only(mine)
    mine[0] = 1.0
    assert kept[0] == 0.0
    assert g.read_only(kept) is kept
    assert g.read_only(kept[:2]) is not kept
    with pytest.raises(ValueError, match="read-only"):
        kept[0] = 1.0
