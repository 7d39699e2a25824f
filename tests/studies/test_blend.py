"""Thesis 5, avoidance: the ledger, the studies recomputed in part, the exercises of chapter 08, its pictures."""

import importlib.util
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

from fuzzynav import blend, course, lab, plot, published
from fuzzynav.robot import TURTLEBOT2
from fuzzynav.studies.blend import blocks as study
from fuzzynav.studies.blend import claims
from fuzzynav.tracking.reference import FigureEight

HOME = Path(__file__).parents[2]
REAL = ("clearance", "late_rms", "late_cross_track", "max_error", "max_cross_track", "length")


def test_the_ledger_of_the_chapter() -> None:
    verdicts = published.table("blend")["verdict"]
    for claim in ("c-5.3-avoidance-len", "c-5.5-avoidance-len"):
        assert verdicts[f"thesis:{claim}"] == "fitted", claim
    for claim in ("c-extra-7", "c-extra-8"):
        assert verdicts[f"thesis:{claim}"] == "reproduced", claim
    assert verdicts["thesis:c-5.13-window"] == "not reproduced"
    assert verdicts["thesis:c-formula-8"] == "not reproduced"
    assert verdicts["thesis:c-5.3-avoidance-time"] == "contradicts itself"


def test_blocks_lie_where_the_study_says() -> None:
    curve = FigureEight(duration=blend.LAP).sample(np.linspace(0, blend.LAP, 4001)).position
    for seed in range(50):
        block = study.block_of(seed)
        assert np.hypot(*(curve - block[:2]).T).min() <= 0.2 + 1e-3
        assert study.edge_distance(block, np.zeros((1, 2)))[0] >= 0.5
        np.testing.assert_array_equal(block, study.block_of(seed))


def test_a_corridor_is_missing_where_the_block_shuts_the_square() -> None:
    assert study.corridor_exists(study.block_of(0))
    assert not study.corridor_exists(np.array([0.0, 0.0, 0.2, 9.0, 0.0])), "a wall through the middle"


def test_a_hundredth_of_the_blocks_again() -> None:
    table = study.batch.read(study.RESULTS / "avoidance_blocks.csv")
    assert table["case"].nunique() == len(study.BLOCK_CASES)
    for case in range(7, 1000, 100):
        kept = table[table["case"] == str(case)].to_dict("records")
        again = study.one_block(case)
        assert [r["scheme"] for r in kept] == [r["scheme"] for r in again]
        for old, new in zip(kept, again, strict=True):
            assert (old["status"], old["success"], old["corridor"]) == (new["status"], new["success"], new["corridor"])
            for name in REAL:
                assert old[name] == pytest.approx(new[name], abs=2e-3, nan_ok=True), (case, old["scheme"], name)


def test_a_hundredth_of_the_movers_again() -> None:
    table = study.batch.read(study.RESULTS / "avoidance_movers.csv")
    assert table["case"].nunique() == len(study.MOVER_CASES)
    for case in (17, 117):
        for old, new in zip(table[table["case"] == str(case)].to_dict("records"), study.one_mover(case), strict=True):
            assert (old["scheme"], old["status"], old["success"]) == (new["scheme"], new["status"], new["success"])


def test_what_the_chapter_says_of_the_schemes() -> None:
    table = study.summary("blocks")
    assert (table["runs"] == 1000).all()
    assert table.loc["safe blend", "collided"] == 0
    assert table.loc["safe blend", "back"] == 1000
    assert table.loc["printed, gate ±45°", "collided"] == 1000
    assert 0.6 < table.loc["gate widened to ±90°", "back"] / 1000 < 0.8
    rows = study.batch.read(study.RESULTS / "avoidance_blocks.csv").groupby("scheme")["max_error"].median()
    assert rows["hard switch"] > 5 * rows["safe blend"], "the hard switch loses the reference meanwhile"


def test_mover_starts_clear_of_the_robot() -> None:
    for seed in range(30):
        mover = study.mover_of(seed)
        assert np.hypot(*mover.start) > mover.radius + TURTLEBOT2.radius
        assert 0.1 <= mover.radius <= 0.25


# --- exercises


def solutions() -> dict[str, object]:
    text = (HOME / "notebooks/solutions/08_fuzzy_dfl.py").read_text(encoding="utf-8")
    names: dict[str, object] = {"np": np}
    exec(compile(text, "solutions", "exec"), names)
    return names


ANSWERS = {"08.1": "reach", "08.2": "balance", "08.3": "gate", "08.4": "wait", "08.5": "safe_speed"}


@pytest.mark.parametrize(("name", "answer"), ANSWERS.items())
def test_solutions_pass_and_stubs_are_not_answered(name: str, answer: str) -> None:
    assert course.check(name, solutions()[answer]).points > 0
    assert "not answered yet" in repr(course.check(name, ...))


# --- pictures


def test_pictures_of_runs_and_diagrams() -> None:
    run = claims.avoidance_simulation()
    figure, axes = plt.subplots(2, 4)
    driven, part = plot.draw_blend_path(axes[0, 0], run, claims.SIMULATION_BLOCK)
    assert len(driven.get_xdata()) == len(run.poses)
    assert np.isfinite(part.get_xdata()).sum() == (run.log["weight"] > 0).sum()
    assert len(plot.draw_blend_errors(axes[0, 1], run)) == 3
    assert len(plot.draw_blend_speeds(axes[0, 2], run)) == 2
    assert len(plot.draw_weight(axes[0, 3], run)) == 2
    for ax, draw in zip(axes[1], (plot.draw_blend_framework, plot.draw_blend_design, plot.draw_blend_flowchart)):
        assert draw(ax).texts
    surface = plot.weight_surface(blend.table_5_1())
    assert plot.draw_gate(axes[1, 3], surface).get_array().shape == surface.shape
    plt.close(figure)
    np.testing.assert_allclose(plot.block_corners([1.0, 0.0, 0.2, 0.4, np.pi / 2]).max(axis=0), [1.2, 0.1], atol=1e-12)


def test_labs_follow_their_sliders() -> None:
    sliders = {
        "x": lab.Slider("block x", -2.3, 2.3, 0.0, 0.05),
        "y": lab.Slider("block y", 0.6, 2.4, 1.9, 0.05),
        "turn": lab.Slider("turn", 0, 175, 0, 5),
        "gate": lab.Slider("gate", 10, 180, 45, 5),
        "d0": lab.Slider("d0", 0.3, 1.5, 0.7, 0.1),
    }
    panel = lab.Panel(plot.block_lab, sliders, title="block")
    assert "printed: contact" in panel.text
    panel.set(gate=90)
    assert "printed: clearance" in panel.text
    weights = lab.Panel(
        plot.weight_lab,
        {
            "close": lab.Slider("close", 0.1, 1.0, 0.5, 0.05),
            "far": lab.Slider("far", 0.3, 1.9, 1.0, 0.05),
            "ahead": lab.Slider("ahead", 0.2, 3.0, 1.0, 0.1),
            "peak": lab.Slider("peak", 0.1, 0.9, 0.5, 0.05),
        },
        title="F",
    )
    before = weights.png
    weights.set(peak=0.8)
    assert weights.png != before
    weights.set(close=0.9, far=0.5)
    assert "Far must end above Close" in weights.text


def test_the_notebook_and_its_solutions_are_there() -> None:
    assert (HOME / "notebooks/08_fuzzy_dfl.ipynb").exists()
    assert importlib.util.find_spec("fuzzynav.course.exercises.ch08")
