"""Thesis 4 among placements of our own: scenes as said, rows that come out again, verdicts that follow the numbers."""

from dataclasses import replace

import numpy as np
import pytest

from fuzzynav import batch, published
from fuzzynav.data import folder
from fuzzynav.dwa.controller import Controller
from fuzzynav.dwa.decision import Field
from fuzzynav.dwa.steps import TABLE_4_1
from fuzzynav.robot import THESIS
from fuzzynav.simulate import run as drive_openly
from fuzzynav.studies.fusion import claims, placements, settings
from fuzzynav.studies.planning.maps import SCENES_4, enhanced
from fuzzynav.world import World

SAMPLE = ("M1/3", "M1 Manhattan/70", "M2/111", "M2 cut/249")


@pytest.mark.parametrize("case", SAMPLE)
def test_a_placement_is_what_it_is_said_to_be(case: str) -> None:
    world, task = placements.placed(case), placements.task_of(case)
    path = placements.path_on(case.split("/")[0])
    assert len(world.unknown_rectangles) == len(world.movers) == 2
    for x, y, width, height, _ in world.unknown_rectangles:
        assert (width, height) == (1.0, 1.0)
        assert not world.grid.is_occupied((x, y))
        assert np.allclose(world.grid.center_of(world.grid.cell_of((x, y))), (x, y))
    ends = path[[0, -1]]
    for mover in world.movers:
        assert 0.2 <= mover.speed <= 0.35
        walk = np.linspace(*np.array(mover.waypoints), 50)
        assert 2.0 <= np.hypot(*(walk[-1] - walk[0])) <= 4.0
        assert np.hypot(*(ends[:, None] - walk).T).min() > 1.6
    assert world.clearance(task.start[:2]) > task.robot.radius
    assert world.clearance(task.goal, []) > task.robot.radius
    again = placements.placed(case)
    np.testing.assert_array_equal(world.unknown_rectangles, again.unknown_rectangles)
    assert world.movers == again.movers


def test_placements_differ_from_seed_to_seed() -> None:
    worlds = [placements.placed(f"M2/{seed}") for seed in range(20)]
    assert len({world.movers for world in worlds}) == 20
    assert len({world.unknown_rectangles.tobytes() for world in worlds}) > 15


@pytest.mark.parametrize("name", ["M1", "M1 Manhattan", "M2", "M2 cut"])
def test_the_path_is_that_of_table_4_2(name: str) -> None:
    path = placements.path_on(name)
    assert np.hypot(*np.diff(path, axis=0).T).sum() == pytest.approx(enhanced(SCENES_4[name]).length)


@pytest.mark.parametrize("case", ["M2/0.30/2/goal/end/as_printed", "M1 Manhattan/0.35/1/0/arc/arc"])
def test_a_setting_drives_as_the_open_loop_does(case: str) -> None:
    name, radius, cut, _, scored, bound = case.split("/")
    made, grid = settings.traditional(case), SCENES_4[name].grid
    assert made.radius == float(radius)
    start = made.poses[0]
    params = replace(TABLE_4_1, distance=scored, bound=bound, d_max=float(cut), blind=False)
    robot = replace(THESIS, radius=float(radius))
    controller = Controller(robot, params, field=Field.of(grid))
    open_ = drive_openly(World(grid=grid), robot, controller, start, made.goal, t_max=300.0, laser=None)
    assert (made.status, made.iterations) == (open_.status, open_.iterations)
    np.testing.assert_allclose(made.poses, open_.poses, atol=1e-9)


def test_every_case_of_both_studies_is_there() -> None:
    for name, cases, rows in (
        ("fusion_placements", placements.CASES, len(placements.METHODS)),
        ("fusion_settings", settings.CASES, 1),
    ):
        table = batch.read(folder("results") / f"{name}.csv")
        assert list(dict.fromkeys(table["case"])) == list(cases)
        assert (table.groupby("case").size() == rows).all()


def test_the_run_that_is_shown_is_the_nearest_of_all() -> None:
    for given in ("M1", "M2"):
        for who in ("TDWA", "IDWA"):
            printed = float(published.claim(f"thesis:c-4.3-{given}-{who}-len").value)
            case, _ = claims.case_of(given, who)
            gap = abs(claims.nearest(given, who) - printed)
            rows = claims.arrived(given, who)
            assert case in set(rows["case"])
            assert gap == pytest.approx((rows["length"] - printed).abs().min(), abs=1e-6)
        run = claims.traditional_run(given)
        assert run.success
        assert run.length == pytest.approx(claims.nearest(given, "TDWA"), abs=6e-4)
        run, task = claims.fusion_run(given)
        assert run.success
        assert task.name == claims.case_of(given, "IDWA")[0]
        assert run.length == pytest.approx(claims.nearest(given, "IDWA"), abs=6e-4)


def test_the_interval_is_that_of_the_pairs() -> None:
    pairs = claims.pairs(("M1", "M2"), claims.CURED)
    assert len(pairs) >= 2
    gap = pairs["variation_omega_theirs"] - pairs["variation_omega_ours"]
    mean, low, high = claims.less(("M1", "M2"), "variation_omega")
    assert mean == pytest.approx(gap.mean())
    assert low < mean < high
    assert abs((high - low) / 2 - 1.96 * gap.std() / np.sqrt(len(gap))) < 0.2 * (high - low)


def test_every_claim_of_the_chapter_has_a_verdict() -> None:
    starts = ("thesis:c-4.3-", "thesis:c-4.5text-", "thesis:c-4.6-", "thesis:c-4.10-", "barn:")
    wanted = {c for c in published.claims() if c.startswith(starts)}
    assert {r.claim for r in claims.REPRODUCTIONS} == wanted
    shown = published.table("fusion")
    assert len(shown) == len(wanted)
    assert not (shown["verdict"] == "not yet").any()
    assert not (shown["verdict"] == "reproduced").any()  # every length was sought
    for name in ("c-4.6-alpha", "c-4.6-beta"):
        assert shown.loc[f"thesis:{name}", "verdict"] == "contradicts itself"
    assert (shown.loc[[c for c in shown.index if c.endswith("time")], "verdict"] == "not testable").all()
