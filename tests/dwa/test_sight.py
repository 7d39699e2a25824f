"""What no beam has crossed is not free: dead, sparse and narrow scanners, faults of sensors, input without meaning."""

import os
from dataclasses import replace

import numpy as np
import pytest

from fuzzynav import dwa, simulate
from fuzzynav.control import FAULTS, Observation
from fuzzynav.dwa import sight
from fuzzynav.dwa.decision import REASONS
from fuzzynav.dwa.fast import drive
from fuzzynav.dwa.steps import Params
from fuzzynav.robot import THESIS
from fuzzynav.simulate.loop import IDEAL_LASER
from fuzzynav.studies.dwa import safety
from fuzzynav.world import World

CIRCLE = np.linspace(-np.pi, np.pi, 360, endpoint=False)
NOTHING = np.full(360, np.inf)
UNSEEN = REASONS.index("nothing was seen there")


def told(**changed) -> Observation:
    given = {"time": 0.0, "pose": np.zeros(3), "velocity": np.array([0.5, 0.1]), "goal": np.array([9.0, 0.0]),
             "points": np.empty((0, 2)), "ranges": NOTHING, "angles": CIRCLE, "range_max": 10.0}  # fmt: skip
    return Observation(**{**given, **changed})


def view(degrees: float, beams: int = 181) -> dict:
    return {"angles": np.radians(np.linspace(-0.5, 0.5, beams) * degrees), "ranges": np.full(beams, np.inf)}


# --- nothing is seen --------------------------------------------------------------------------------

ONE = np.where(np.arange(360) == 180, 5.0, np.nan)


@pytest.mark.parametrize("scan", [
    {"ranges": np.full(360, np.nan)}, {"ranges": np.empty(0), "angles": np.empty(0)}, {"ranges": ONE},
    {"ranges": np.full(8, np.inf), "angles": CIRCLE[::45]}, {"ranges": NOTHING, "angles": np.zeros(360)},
], ids=("dead", "no beams", "one beam", "eight beams", "all one way"))  # fmt: skip
def test_who_sees_too_little_brakes_on_its_arc(scan: dict) -> None:
    made = dwa.plan(told(**scan), THESIS)
    moving = np.abs(made.samples[:, 0]) > 0
    assert made.braking
    assert made.blind
    assert set(made.reasons[moving]) == {UNSEEN}
    np.testing.assert_allclose(made.command, dwa.brake([0.5, 0.1], THESIS, 0.1))
    assert not dwa.plan(told(**scan), THESIS, Params(blind=False)).braking  # told that it may


def test_a_map_counts_as_known_but_not_against_a_dead_scanner() -> None:
    field = dwa.Field(np.full((400, 400), 5.0), 0.05, (-10.0, -10.0))
    none = {"ranges": None, "angles": None}
    assert not dwa.plan(told(**none), THESIS, field=field).braking
    assert not dwa.plan(told(**view(60)), THESIS, field=field).braking
    assert dwa.plan(told(ranges=np.full(360, np.nan)), THESIS, field=field).braking
    unknown = dwa.Field(np.full((400, 400), np.nan), 0.05, (-10.0, -10.0))
    made = dwa.plan(told(**none), THESIS, field=unknown)
    assert made.braking
    assert made.blind


def test_points_alone_are_all_there_is() -> None:
    assert not dwa.plan(told(ranges=None, angles=None), THESIS).braking


def test_disc_turns_in_place_unseen_and_a_bar_does_not() -> None:
    dead = told(velocity=np.zeros(2), goal=np.array([0.0, 9.0]), ranges=np.full(360, np.nan))
    assert dwa.plan(dead, THESIS).command[1] > 0
    bar = Params(footprint=((0.5, -0.1), (0.5, 0.1), (-0.5, 0.1), (-0.5, -0.1)))
    stuck = dwa.plan(dead, THESIS, bar)
    assert stuck.command.tolist() == [0.0, 0.0]
    turning = (stuck.samples[:, 0] == 0) & (np.abs(stuck.samples[:, 1]) > 0.02)
    assert set(stuck.reasons[turning]) == {UNSEEN}


def test_half_a_circle_is_enough_to_drive_on_and_less_is_not() -> None:
    for degrees, drives in ((360, True), (270, True), (180, True), (90, False), (60, False)):
        made = dwa.plan(told(**view(degrees)), THESIS)
        assert made.braking != drives, f"{degrees} degrees"
        if drives:
            assert made.command[0] > 0.5
    back = replace(THESIS, min_vel_x=-0.3)
    half = dwa.plan(told(velocity=np.zeros(2), **view(180)), back)
    assert set(half.reasons[half.samples[:, 0] < 0]) == {UNSEEN}
    assert not half.admissible[half.samples[:, 0] < 0].any()


def test_gap_between_beams_is_known_as_far_as_nothing_can_hide_in_it() -> None:
    """A disc of the thinnest diameter that no beam hits starts beyond what counts as known."""
    for gap in (0.01, 0.1, 0.5, 1.0):
        hidden = 0.1 / np.sin(gap / 2) - 0.1  # its centre where both beams just miss it
        assert sight.sight(gap, 0.2) <= hidden
    assert sight.sight(0.1, 0.2) == pytest.approx(1.7642, abs=1e-3)
    assert sight.sight(np.pi / 2, 0.2) == 0.0
    assert sight.sight(0.1, 0.4) == pytest.approx(2 * sight.sight(0.1, 0.2))


def test_dropped_beams_leave_a_hole_that_is_not_bridged() -> None:
    holed = NOTHING.copy()
    holed[170:190] = np.nan
    made = dwa.plan(told(ranges=holed), THESIS, Params(weights=(1.0, 0.0, 0.0)))
    straight = np.argmin(np.abs(made.samples - (0.5, 0.0)).sum(axis=1))
    assert made.known[straight] < 0.6 < made.free[straight]
    assert dwa.plan(told(), THESIS).known[straight] > 5.0


def test_both_edges_of_a_hole_bound_what_is_known() -> None:
    scan = told(ranges=np.where((np.arange(360) >= 200) & (np.arange(360) < 220), np.nan, 5.0))
    border, radii = dwa.blind_spots(scan, THESIS)
    for beam in (199, 220):
        for away in np.linspace(1.0, 4.9, 20):
            point = away * np.array([np.cos(CIRCLE[beam]), np.sin(CIRCLE[beam])])
            assert (np.hypot(*(border - point).T) - radii).min() < 0.02


def test_beams_may_come_in_any_order() -> None:
    rng = np.random.default_rng(3)
    ranges = rng.uniform(1.0, 4.0, 360)
    first = dwa.plan(told(ranges=ranges), THESIS)
    for order in (np.arange(360)[::-1], rng.permutation(360)):
        other = dwa.plan(told(ranges=ranges[order], angles=CIRCLE[order]), THESIS)
        np.testing.assert_array_equal(other.reasons, first.reasons)
        np.testing.assert_allclose(other.known, first.known, atol=1e-9)


# --- closed loops -----------------------------------------------------------------------------------

SCANNERS = {
    "0 beams": {"beams": 0}, "1 beam": {"beams": 1}, "8 beams": {"beams": 8}, "60 beams": {"beams": 60},
    "dropout 0.5": {"dropout": 0.5}, "dropout 0.9": {"dropout": 0.9}, "dropout 0.99": {"dropout": 0.99},
    "dropout 0.999": {"dropout": 0.999},
    **{f"view {d}": {"field_of_view": np.radians(d)} for d in (60, 90, 180, 270, 360)},
}  # fmt: skip


def closed(seed: int, scanner: str) -> simulate.Run:
    """One of the safety worlds with a poor scanner."""
    world, robot, params, start, goal, laser = safety.case_of(seed)
    laser = replace(laser, **SCANNERS[scanner])
    if laser.dropout == 0.0:
        return drive(world, start, goal, params, robot=robot, laser=laser, t_max=safety.T_MAX, loop=safety.ENDS)
    controller = dwa.Controller(robot, params)
    return simulate.run(
        world, robot, controller, start, goal, t_max=safety.T_MAX, laser=laser, rng=seed, loop=safety.ENDS
    )


@pytest.mark.parametrize("scanner", SCANNERS)
def test_no_contact_however_little_is_seen(scanner: str) -> None:
    """A seeded few; SCANNER_WORLDS=200 for the whole."""
    count = int(os.environ.get("SCANNER_WORLDS", "6"))
    runs = [closed(30_000 + k, scanner) for k in range(count)]
    assert sum(run.contacts_moving for run in runs) == 0
    print(f"{scanner}: {sum(r.success for r in runs)} of {count} arrive, {sum(r.length for r in runs) / count:.2f} m")


def test_compiled_loop_is_the_open_loop_where_little_is_seen() -> None:
    for seed, beams, angle in ((30_001, 60, 2 * np.pi), (30_002, 181, np.pi), (30_003, 8, 2 * np.pi)):
        world, robot, params, start, goal, laser = safety.case_of(seed)
        laser = replace(laser, beams=beams, field_of_view=angle)
        given = {"t_max": 20.0, "laser": laser, "loop": safety.ENDS}
        open_ = simulate.run(world, robot, dwa.Controller(robot, params), start, goal, **given)
        made = drive(world, start, goal, params, robot=robot, **given)
        assert (made.status, made.iterations) == (open_.status, open_.iterations)
        np.testing.assert_allclose(made.poses, open_.poses, atol=1e-9)


def test_run_of_a_dead_scanner_ends_as_blind() -> None:
    laser = replace(IDEAL_LASER, beams=0)
    run = simulate.run(World(), THESIS, dwa.Controller(THESIS), (0, 0, 0), (5, 0), laser=laser)
    assert (run.status, run.length) == ("blind", 0.0)
    assert run.duration == pytest.approx(3.1)
    assert drive(World(), (0, 0, 0), (5, 0), laser=laser).status == "blind"


# --- faults and input without meaning ---------------------------------------------------------------


@pytest.mark.parametrize(("fault", "name"), [
    ({"pose": np.array([0.0, np.nan, 0.0])}, FAULTS[0]), ({"points": np.full((3, 2), np.nan)}, FAULTS[1]),
    ({"points": np.array([[1.0, 2.0], [np.inf, 0.0]])}, FAULTS[1]), ({"range_max": np.nan}, FAULTS[2]),
])  # fmt: skip
def test_faulty_sensor_brakes_and_is_named(fault: dict, name: str) -> None:
    made = dwa.plan(told(**fault), THESIS)
    assert made.braking
    assert made.blind
    assert {REASONS[code] for code in made.reasons} == {name}
    np.testing.assert_allclose(made.command, dwa.brake([0.5, 0.1], THESIS, 0.1))
    driver = dwa.Controller(THESIS, stuck=dwa.Stuck(tries=2))
    for k in range(40):
        assert driver(told(time=0.1 * k, velocity=np.zeros(2), **fault)).tolist() == [0.0, 0.0]
    assert driver.status == "blind"


@pytest.mark.parametrize(("wrong", "words"), [
    ({"velocity": np.array([np.inf, 0.0])}, "velocity must be finite"),
    ({"velocity": np.array([0.5, np.nan])}, "velocity must be finite"),
    ({"velocity": np.array([1e6, 0.0])}, "cannot drive"), ({"velocity": np.array([0.0, 4.0])}, "cannot drive"),
    ({"goal": np.array([np.nan, 0.0])}, "goal must be finite"), ({"goal": np.array([np.inf, 0.0])}, "goal must be"),
    ({"goal": np.array([1.0])}, "2 numbers"), ({"pose": np.zeros(2)}, "must be 3, 2 and 2"),
    ({"ranges": np.ones(5)}, "one range for each angle"), ({"angles": None}, "both ranges and angles"),
    ({"angles": np.full(360, np.nan)}, "angles must be finite"), ({"points": np.zeros((4, 3))}, "rows of x and y"),
])  # fmt: skip
def test_observation_without_meaning_is_refused(wrong: dict, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        dwa.plan(told(**wrong), THESIS)


@pytest.mark.parametrize("weights", [(np.nan, 1, 1), (np.inf, 1, 1), (0, 0, 0), (-1, 1, 1), (1, 1)])
def test_weights_without_meaning_are_refused(weights: tuple) -> None:
    with pytest.raises(ValueError, match="weights"):
        dwa.plan(told(), THESIS, weights=weights)


@pytest.mark.parametrize("wrong", [
    {"margin": np.nan}, {"margin": np.inf}, {"reaction": np.nan}, {"reaction": np.inf}, {"reaction": -0.1},
    {"thinnest": 0.0},
])  # fmt: skip
def test_parameters_without_meaning_are_refused(wrong: dict) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        Params(**wrong)


def test_a_window_of_millions_is_refused() -> None:
    with pytest.raises(ValueError, match="samples"):
        dwa.plan(told(), THESIS, Params(v_resolution=1e-7, omega_resolution=1e-4))


@pytest.mark.parametrize("resolution", [0.0, -1.0, np.nan, 1e-6])
def test_field_of_no_resolution_is_refused(resolution: float) -> None:
    from fuzzynav.maps.gridmap import GridMap

    with pytest.raises(ValueError, match="resolution"):
        dwa.Field.of(GridMap(np.zeros((3, 3), dtype=bool)), resolution)


def test_last_digit_of_a_heading_fires_no_rule() -> None:
    ahead = told(pose=np.array([0.0, 0.0, 1e-16]))
    assert dwa.inputs_of(ahead, 1.0)[0] == 0.0
    assert dwa.inputs_of(told(pose=np.array([0.0, 0.0, 1e-6])), 1.0)[0] > 0.0
