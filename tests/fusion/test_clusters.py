"""What a scan shows of round things, against scenes whose answer is known and against a fit by SciPy."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares

from fuzzynav.fusion import clusters
from fuzzynav.fusion.tracks import TrackParams
from fuzzynav.geometry import sealed
from fuzzynav.maps import GridMap
from fuzzynav.maps.kernels import framed
from fuzzynav.world import World

RULES = TrackParams().rules()
ROUND = np.linspace(-np.pi, np.pi, 360, endpoint=False)
AHEAD = np.linspace(-0.75, 0.75, 720) * np.pi
NONE = (sealed(np.zeros((0, 0), dtype=np.bool_)), sealed(np.zeros((0, 0))), framed(1.0, (0.0, 0.0)))


def look(
    world: World, pose: Any = (0.0, 0.0, 0.0), angles: Any = ROUND, chart: GridMap | None = None, lost: Any = ()
) -> tuple[Any, Any]:
    """Beams and clusters of an exact scan of 10 m; the beams `lost` return nothing."""
    place = np.array(pose, dtype=float)
    ranges = world.cast(place, angles, 10.0)
    ranges[ranges >= 10.0] = np.inf
    ranges[list(lost)] = np.nan
    known = NONE
    if chart is not None:
        known = (chart.occupied, chart.field_in_cells(), framed(chart.resolution, chart.origin))
    return clusters.observe(ranges, np.array(angles), place, 10.0, *known, RULES)


@settings(max_examples=60, deadline=None)
@given(
    bearing=st.floats(-np.pi, np.pi),
    away=st.floats(1.2, 6.0),
    radius=st.floats(0.2, 0.6),
    heading=st.floats(-np.pi, np.pi),
)
def test_a_disc_in_the_open_is_found(bearing: float, away: float, radius: float, heading: float) -> None:
    center = 3.0 + away * np.cos(bearing), -1.0 + away * np.sin(bearing)
    _, found = look(World(discs=[[*center, radius]]), (3.0, -1.0, heading))
    assert len(found) == 1, "one disc is one cluster, also across the seam of the scan"
    disc = found[0]
    assert disc["right_open"] and disc["left_open"]
    assert np.hypot(disc["x"] - center[0], disc["y"] - center[1]) < 0.05
    assert abs(disc["radius"] - radius) < 0.05
    assert disc["misfit"] < 0.01


def test_the_fit_is_that_of_scipy() -> None:
    beams, found = look(World(discs=[[3.0, 1.0, 0.4], [2.0, 0.45, 0.15]]))
    group = max(found, key=lambda g: np.hypot(g["x"], g["y"]))
    assert not group["right_open"] and group["left_open"], "the small disc hides the right side of the large one"
    rule, first, last = RULES[0], group["first"], group["first"] + group["count"] - 1
    hits = np.stack([beams["x"], beams["y"]], axis=-1)[first : last + 1]
    edge, gap = beams["bearing"][last] + 0.5 * beams["gap"][last], beams["gap"][last] * beams["range"][last]

    def misses(state: Any) -> Any:
        rim = (np.hypot(*(hits - state[:2]).T) - state[2]) / rule.range_noise
        tangent = (-np.sin(edge) * state[0] + np.cos(edge) * state[1] + state[2]) / gap * np.sqrt(12.0)
        return [*rim, tangent, (state[2] - rule.radius_mean) / rule.radius_spread]

    answer = least_squares(misses, [3.2, 1.2, 0.3], xtol=1e-12, ftol=1e-12)
    assert [group["x"], group["y"], group["radius"]] == pytest.approx(answer.x, abs=2e-3)
    cov = np.linalg.inv(answer.jac.T @ answer.jac)
    assert [group["xx"], group["xy"], group["yy"]] == pytest.approx([cov[0, 0], cov[0, 1], cov[1, 1]], rel=0.05)
    assert group["spread"] == pytest.approx(np.sqrt(cov[2, 2]), rel=0.05)


def test_a_known_radius_carries_the_fit_of_a_hidden_disc() -> None:
    beams, found = look(World(discs=[[4.0, 0.0, 0.5], [2.0, -0.18, 0.2]]))
    group = max(found, key=lambda g: g["x"])
    assert group["count"] < 12 and not group["right_open"]
    blind = np.hypot(group["x"] - 4.0, group["y"])
    clusters.fit_disc(beams, group, np.zeros(3), 0.5, 0.01, RULES)
    assert np.hypot(group["x"] - 4.0, group["y"]) < min(0.01, blind)


def test_the_end_of_the_field_of_view_hides_a_side() -> None:
    edge = AHEAD[0]
    _, found = look(World(discs=[[3.0 * np.cos(edge), 3.0 * np.sin(edge), 0.4]]), angles=AHEAD)
    assert len(found) == 1 and not found[0]["right_open"] and found[0]["left_open"]


@pytest.mark.parametrize("turn", [0.0, 0.4, 0.8])
@pytest.mark.parametrize("size", [1.0, 3.0])
def test_what_is_no_disc_has_no_misfit(turn: float, size: float) -> None:
    _, found = look(World(rectangles=[[3.0, 0.0, size, size, turn]]))
    assert len(found) == 1
    assert np.isinf(found["misfit"][0])


def test_things_apart_are_clusters_apart_and_lost_beams_are_bridged() -> None:
    world = World(discs=[[3.0, 0.6, 0.4], [3.0, -0.6, 0.4]])
    _, found = look(world)
    assert len(found) == 2
    middle = int(np.argmin(np.abs(ROUND - np.arctan2(0.6, 3.0))))
    _, dropped = look(world, lost=[middle, middle + 1])
    assert len(dropped) == 2
    assert dropped["count"].sum() == found["count"].sum() - 2
    _, broken = look(world, lost=range(middle, middle + 5))
    assert len(broken) == 3


def test_a_chart_explains_its_walls_and_not_what_stands_beside_them() -> None:
    wall = [2.0, 0.0, 0.2, 3.0, 0.0]
    chart = World(rectangles=[wall], bounds=(-5, 5, -5, 5)).known_grid(0.05)
    scene = World(rectangles=[wall], unknown_discs=[[-2.0, 0.0, 0.3]], bounds=(-5, 5, -5, 5))
    beams, found = look(scene, chart=chart)
    assert len(found) == 1 and found["x"][0] == pytest.approx(-2.0, abs=0.02)
    inside = slice(found["first"][0], found["first"][0] + found["count"][0])
    assert (beams["owner"][inside] == clusters.NOBODY).all()
    assert (beams["owner"] == clusters.NOTHING).sum() == len(beams) - found["count"][0]
    assert len(look(scene)[1]) > 1


def test_what_a_scan_looked_past() -> None:
    pose = np.array([1.0, 2.0, 0.7])
    beams, _ = look(World(rectangles=[[5.0, 2.0, 0.2, 4.0, 0.0]]), pose)  # its face is 3.9 m ahead in x

    def free(x: float, y: float) -> bool:
        return clusters.looked_past(beams, pose, x, y, 0.05)

    assert free(4.7, 2.0) and free(4.7, 3.0) and free(0.0, -3.0)
    assert not free(4.88, 2.0), "nearer to the face than the margin"
    assert not free(5.3, 2.0), "behind it"
    assert not free(1.0, 12.5), "out of reach"
    ahead, _ = look(World(), angles=AHEAD)
    assert clusters.looked_past(ahead, np.zeros(3), 2.0, 0.0, 0.05)
    assert not clusters.looked_past(ahead, np.zeros(3), -2.0, 0.0, 0.05), "outside the field of view"
    assert not clusters.looked_past(ahead[:0], np.zeros(3), 2.0, 0.0, 0.05)


@settings(max_examples=40, deadline=None)
@given(bearing=st.floats(-9.0, 9.0), seed=st.integers(0, 99))
def test_the_beam_at_a_bearing(bearing: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(-np.pi, np.pi, 40))
    beams, _ = look(World(), (0.0, 0.0, rng.uniform(-3.0, 3.0)), angles)
    j = clusters.at_bearing(beams, bearing)
    turned = (bearing - beams["bearing"][j]) % (2.0 * np.pi)
    assert turned <= beams["gap"][j] + 1e-9
