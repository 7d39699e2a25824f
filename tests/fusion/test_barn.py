"""BARN as tasks: worlds read from either form, the protocol's numbers, the score, the published runs."""

import json

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav.control import Controller
from fuzzynav.data import folder
from fuzzynav.documents import claim
from fuzzynav.fusion import barn
from fuzzynav.fusion.protocol import measure
from tests.fusion.barn_files import write_barn


class Ahead(Controller):
    def __init__(self, v=2.0):
        self.v = v

    def reset(self):
        pass

    def __call__(self, observation):
        return self.v, 0.0


@pytest.fixture
def packed(tmp_path):
    return write_barn(tmp_path)


def sdf(discs):
    """A world file as Gazebo writes it: ground, cylinders, and a state that repeats the poses."""
    model = (
        "<model name='unit_cylinder_{}'>\n<pose frame=''>{} {} 0.0 0 0 0</pose>\n<link name='link'>{}</link></model>"
    )
    shape = "<collision name='c'><geometry><cylinder>\n<radius>{}</radius>\n<length>1</length></cylinder></geometry>"
    body = [model.format(k, x, y, shape.format(r)) for k, (x, y, r) in enumerate(discs)]
    state = [
        f"<model name='unit_cylinder_{k}'><pose frame=''>{x} {y} 0 0 0 0</pose></model>"
        for k, (x, y, _) in enumerate(discs)
    ]
    ground = "<model name='ground_plane'><static>1</static><link name='link'><plane/></link></model>"
    return f"<sdf><world>{ground}{''.join(body)}<state>{''.join(state)}</state></world></sdf>"


@pytest.fixture
def checkout(tmp_path, packed):
    """The same worlds 0 and 5 as a checkout has them."""
    home = tmp_path / "checkout"
    (home / barn.PATHS).mkdir(parents=True)
    (home / barn.PLUGINS).mkdir()
    for n in (0, 5):
        (home / barn.SDF / f"world_{n}.world").write_text(sdf(barn.static_task(packed, n).world.discs))
        np.save(home / barn.PATHS / f"path_{n}.npy", np.array([[15, 0], [16, 1], [16, 20]]))
    (home / "res").mkdir()
    (home / "res" / "dwa_out.txt").write_text("0 1 0 0 12.5 0.4\n5 0 1 0 3.0 0.0\n")
    return home


# --- tasks --------------------------------------------------------------------------------------


def test_static_world_by_hand(packed):
    task = barn.static_task(packed, 70, top_speed=0.5)
    assert sorted(task.world.discs.round(3).tolist()) == [[-3.975, 0.975, 0.075], [-0.075, 1.575, 0.075]]
    assert task.optimum == pytest.approx(10.7)
    assert (task.start.tolist(), task.goal.tolist()) == ([-2.25, 3.0, np.pi / 2], [-2.25, 13.0])
    assert (task.loop.goal_tolerance, task.t_max, task.speed_bound) == (1.0, 100.0, 0.0)
    assert (task.robot.radius, task.robot.max_vel_x, task.robot.min_vel_x) == (0.333, 0.5, -0.5)
    assert (task.laser.beams, task.laser.range_max, task.laser.noise) == (720, 30.0, 0.001)
    assert np.ptp(task.laser.angles) == pytest.approx(np.radians(270.0))
    assert barn.static_task(packed, 70).robot.max_vel_x == 2.0
    assert task.chart is None and not task.ideal


def test_straight_ahead_scores_what_its_time_says(packed):
    row = measure(barn.static_task(packed, 60, top_speed=1.0), lambda t: Ahead())
    assert row["ending"] == "reached"
    assert row["time"] == pytest.approx(9.1, abs=0.1)  # 9 m at 1 m/s, and one step to get there
    assert barn.score(True, row["time"], row["optimum"]) == 0.5  # within 2 * 10.6 / 2 s


def test_a_robot_that_waits_is_not_stalled_but_out_of_time(packed):
    row = measure(barn.static_task(packed, 60), lambda t: Ahead(0.0))
    assert (row["status"], row["time"]) == ("timeout", pytest.approx(100.0))


def test_a_checkout_gives_the_same_world(packed, checkout):
    for n in (0, 5):
        mine, theirs = barn.static_task(packed, n), barn.static_task(checkout, n)
        assert np.allclose(np.sort(mine.world.discs, axis=0), np.sort(theirs.world.discs, axis=0))
    # from (-2.25, 3) to (15, 0) -> (-2.325, 5.075), one diagonal of the lattice, 19 cells up, and on to (-2.25, 13)
    by_hand = np.hypot(0.075, 2.075) + 0.15 * np.sqrt(2) + 19 * 0.15 + np.hypot(0.075, 13.0 - 8.075)
    assert theirs.optimum == pytest.approx(by_hand)


def test_a_mover_walks_its_key_frames_from_its_phase_on(packed):
    for phase, y in ((0, 3.0), (1, 6.0), (3, 4.0)):  # after 0 s, 3 s, and 9 s of a loop of 4 s
        task = barn.dynamic_task(packed, 0, phase)
        assert task.world.movers[0].start == pytest.approx((-5.0, y))
    assert task.speed_bound == pytest.approx(1.0)
    assert (task.start.tolist(), task.goal.tolist(), task.robot.radius) == ([11, 0, np.pi], [-9, 0], 0.3)
    assert task.optimum == 20.0
    assert float(task.world.clearance([-9.0, 0.0], [])) == pytest.approx(0.75)  # the wall behind the goal
    assert np.isinf(task.world.cast([11.0, 0.0, 0.0], [0.0], np.inf)[0])  # open behind the start
    assert barn.dynamic_task(packed, 0, 3, ideal=True).ideal


def test_a_phase_with_a_mover_on_the_start_begins_later(packed):
    assert barn.dynamic_task(packed, 7, 2).name == "dynabarn 7 phase 2 from 6.0 s"
    late = barn.dynamic_task(packed, 7, 1)  # it stands there until 5 s, then leaves at 2.6 m/s
    assert late.name == "dynabarn 7 phase 1 from 5.4 s"
    assert measure(late, lambda t: Ahead(0.0))["ending"] != "failed"


def test_contact_is_looked_for_more_often_than_forty_times_a_second(packed):
    # at 2 m/s past a robot that stands: nearer than 0.8 m only for 0.09 s between two steps of the loop
    aside = 0.8 - 0.001
    half = np.sqrt(0.8**2 - aside**2)
    assert half / 2.0 < 0.05
    frames = [[0.0, 11.0 + aside, -2.1], [10.0, 11.0 + aside, 17.9]]
    found = json.loads((packed / "dynabarn60.json").read_text())
    found["worlds"][9] = [[10.0, frames]]
    (packed / "other").mkdir()
    (packed / "other" / "dynabarn60.json").write_text(json.dumps(found))
    assert measure(barn.dynamic_task(packed / "other", 9), lambda t: Ahead(0.0))["ending"] == "struck"


def test_tuning_and_report_share_no_world():
    for kind, count in (("barn", 300), ("dynabarn", 60)):
        tuned, held = set(barn.tuning_numbers(kind)), set(barn.test_numbers(kind))
        assert not tuned & held
        assert tuned | held == set(range(count))
    assert barn.test_numbers("barn")[:3] == (0, 6, 12)  # the benchmark's own fifty
    assert len(barn.test_numbers("barn")) == 50
    assert barn.tuning_numbers("dynabarn")[:2] == (1, 3)


# --- what is not there, or not whole ------------------------------------------------------------


def test_a_folder_that_lacks_the_worlds_says_what_to_bring(tmp_path, packed, checkout):
    assert barn.lacking(packed, "barn") == barn.lacking(packed, "dynabarn") == barn.lacking(checkout, "barn") == ""
    assert "compiled plugins" in barn.lacking(checkout, "dynabarn")
    (tmp_path / "empty").mkdir()
    assert "neither barn300.npz nor" in barn.lacking(tmp_path / "empty", "barn")
    assert "no folder gone" in barn.lacking(tmp_path / "gone", "dynabarn")
    with pytest.raises(FileNotFoundError, match="compiled plugins"):
        barn.dynamic_task(checkout, 0, 0)
    with pytest.raises(FileNotFoundError, match="checkout of Daffan"):
        barn.static_task(tmp_path / "empty", 0)
    with pytest.raises(FileNotFoundError, match=r"dwa_500_runs\.csv"):
        barn.published_runs(packed)


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda home: barn.static_task(home, 300), "worlds 0 to 299"),
        (lambda home: barn.static_task(home, -1), "worlds 0 to 299"),
        (lambda home: barn.dynamic_task(home, 60), "worlds 0 to 59"),
        (lambda home: barn.dynamic_task(home, 0, 10), "from 0 to 9"),
        (lambda home: barn.tuning_numbers("cheese"), "barn and dynabarn"),
        (lambda home: barn.sdf_discs("<sdf><world></world></sdf>", "world 3"), "world 3 names no cylinder"),
    ],
)
def test_bad_numbers_and_files_are_refused(packed, ask, said):
    with pytest.raises(ValueError, match=said):
        ask(packed)


@pytest.mark.parametrize("text", ["", "[]", '{"worlds": []}', '{"worlds": 3}', '{"worlds": [[[1.0, [[0, 1]]]]]}'])
def test_a_damaged_file_is_named(tmp_path, text):
    (tmp_path / "dynabarn60.json").write_text(text)
    with pytest.raises(ValueError, match=r"dynabarn60\.json does not hold"):
        barn.dynamic_task(tmp_path, 0)
    (tmp_path / "barn300.npz").write_text(text)
    with pytest.raises(ValueError, match=r"barn300\.npz does not hold"):
        barn.static_task(tmp_path, 0)


# --- score --------------------------------------------------------------------------------------


@given(st.floats(0.1, 500.0), st.floats(0.1, 500.0), st.floats(1.0, 50.0))
def test_score_falls_with_time_between_its_ends(first, second, length):
    quick, slow = barn.score(True, sorted([first, second]), length)
    assert 0.125 - 1e-12 <= slow <= quick <= 0.5 + 1e-12
    assert barn.score(False, first, length) == 0.0
    if length < first < 4.0 * length:
        assert barn.score(True, first, length) == pytest.approx(length / 2.0 / first)


def test_a_failure_has_no_time_and_scores_nothing():
    assert barn.score([True, False], [np.nan, np.nan], 10.0)[1] == 0.0


def test_published_runs_of_either_form(packed, checkout):
    raw = barn.published_runs(checkout)
    assert raw[["world", "success", "collision", "timeout", "seconds"]].values.tolist() == [
        [0, 1, 0, 0, 12.5],
        [5, 0, 1, 0, 3],
    ]
    raw.drop(columns="optimum").to_csv(packed / barn.RUNS, index=False)
    table = barn.published_runs(packed)
    assert table["optimum"].tolist() == [10.0, 10.05]
    found = barn.outcome(table)
    assert (found["success"], found["contact"], found["late"]) == (0.5, 0.5, 0.0)
    assert found["metric"] == pytest.approx(0.5 * 5.0 / 12.5)


# --- the files themselves -----------------------------------------------------------------------

REAL = folder("benchmarks")


def test_the_published_file_contradicts_what_is_promised_beside_it():
    found = barn.outcome(barn.published_runs(REAL))
    assert {k: round(v, 4) for k, v in found.items()} == {
        "success": 0.85, "contact": 0.056, "late": 0.094, "metric": 0.1586}  # fmt: skip
    assert found["success"] < claim("barn:c-dwa-success").value
    assert found["metric"] < claim("barn:c-dwa-metric").value


def test_every_world_of_the_benchmark_can_begin():
    discs = sum(len(barn.static_task(REAL, n).world.discs) for n in range(300))
    assert discs == 78_925
    movers = 0
    for n in range(60):
        tasks = [barn.dynamic_task(REAL, n, phase) for phase in range(barn.PHASES)]
        assert [t.name.split("from ")[1] for t in tasks] == [
            f"{3.0 * k:.1f} s" for k in range(10)
        ]  # no start is touched
        assert 0.85 < tasks[0].speed_bound < 2.0
        movers += len(tasks[0].world.movers)
    assert movers == 963
    assert isinstance(barn.published_runs(REAL), pd.DataFrame)
