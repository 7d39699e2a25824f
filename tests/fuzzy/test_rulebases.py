"""The seven shipped rule bases against what the documents print, and where each of them is silent."""

import math
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from fuzzynav import published
from fuzzynav.fuzzy import FuzzySystem, Rule

DATA = Path(__file__).parents[2] / "data" / "fuzzy"
NAMES = ("effc_table_1", "effc_table_2", "fuzzy_apf_table_1", "fuzzy_planner_table_i", "thesis_table_3_2",
         "thesis_table_3_2_completed", "thesis_table_5_1")  # fmt: skip
HEAD, DISTANCE, SPEED = ("Little", "More", "Lots"), ("Close", "Medium", "Far"), ("Slow", "Normal", "Fast")


def load(name: str) -> FuzzySystem:
    return FuzzySystem.load(DATA / f"{name}.fll")


def terms(rule: Rule) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Words of the antecedent and of the consequents, in order."""
    parts = getattr(rule.antecedent, "parts", (rule.antecedent,))
    return tuple(p.term or "any" for p in parts), tuple(c.term for c in rule.consequents)


@pytest.mark.parametrize("name", NAMES)
def test_every_file_says_what_is_printed_and_what_is_ours(name: str) -> None:
    text = (DATA / f"{name}.fll").read_text(encoding="utf-8")
    system = load(name)
    assert system.name == name
    assert {f.stem for f in DATA.glob("*.fll") if not f.stem.startswith("ours_")} == set(NAMES)
    assert text.startswith("# ")
    assert "ours" in text.lower() or "not\n# printed" in text
    for variable in (*system.inputs, *system.outputs):
        note = text.split(f"Variable: {variable.name}\n")[1].split("range:")[0]
        assert "# " in note, f"{variable.name} has no note"
    for output in system.outputs:
        assert (output.quadrature, output.resolution, output.defuzzifier) == ("trapezoid", 101, "centroid")


@pytest.mark.parametrize("name", NAMES)
def test_answers_stay_in_the_range_of_the_output(name: str) -> None:
    system = load(name)
    points = [np.random.default_rng(1).uniform(v.low, v.high, 2000) for v in system.inputs]
    for output, values in zip(system.outputs, system(*points), strict=True):
        assert (values[np.isfinite(values)] >= output.low).all()
        assert (values[np.isfinite(values)] <= output.high).all()


def table_3_2(head: str, distance: str) -> tuple[str, str, str]:
    """Weights of the printed rules in words: Close is careful, Far is fast, Medium turns careful at Lots."""
    if distance == "Close":
        return "Low", "High", "Low"
    if distance == "Far":
        return "High", "Low", "High"
    return ("Low", "Medium", "Medium") if head == "Lots" else ("Medium", "Low", "Medium")


def test_table_3_2_holds_the_nine_printed_rules() -> None:
    expected = [((h, d, v), table_3_2(h, d)) for d in DISTANCE for h, v in zip(HEAD, SPEED, strict=True)]
    assert [terms(rule) for rule in load("thesis_table_3_2").rules] == expected


def test_table_3_2_is_silent_where_heading_and_speed_are_out_of_step() -> None:
    system = load("thesis_table_3_2")
    gaps = system.uncovered()
    assert len(gaps.missing) == 18
    assert all(HEAD.index(h) != SPEED.index(v) for h, _, v in gaps.missing)
    nominal = (0.8, 0.1, 0.1)  # table 3.3
    assert system(0.0, 3.0, 1.0) == system(0.0, 15.0, 0.5) == system(90.0, 5.0, 1.0) == nominal
    assert system(45.0, 3.0, 0.25) != nominal


def test_a_tenth_of_the_states_matches_no_rule_by_a_tenth() -> None:
    system = load("thesis_table_3_2")
    head, speed = np.meshgrid(np.linspace(0, 180, 181), np.linspace(0, 1, 181))
    match = system.evaluate(head, 7.5, speed).firing.max(-1)
    assert np.mean(match < 0.1) == pytest.approx(0.105, abs=0.005)


def test_the_completed_table_keeps_the_nine_and_covers_all() -> None:
    printed, completed = load("thesis_table_3_2"), load("thesis_table_3_2_completed")
    assert completed.rules[:9] == printed.rules
    found = dict(terms(rule) for rule in completed.rules)
    assert set(found) == set(product(HEAD, DISTANCE, SPEED))
    assert len(completed.rules) == 27
    assert len(completed.uncovered()) == 0
    for (head, distance, speed), weights in found.items():
        if distance != "Medium":
            assert weights == table_3_2(head, distance)
        else:
            careful = HEAD.index(head) + SPEED.index(speed) >= 3
            assert weights == (("Low", "Medium", "Medium") if careful else ("Medium", "Low", "Medium"))
    assert completed(0.0, 15.0, 1.0) == pytest.approx((5 / 6, 1 / 6, 5 / 6), abs=1e-3)


def test_table_5_1_is_complete_and_grows_towards_the_obstacle() -> None:
    system = load("thesis_table_5_1")
    bearing = ("Negative", "Zero", "Positive")
    close = dict(zip(bearing, ("More", "Lots", "More"), strict=True))
    expected = [(("Close", t), (close[t],)) for t in bearing] + [(("Far", t), ("Little",)) for t in bearing]
    assert [terms(rule) for rule in system.rules] == expected
    assert len(system.uncovered()) == 0
    (blend,) = system(np.linspace(0.0, 2.0, 41), 0.0)
    assert (np.diff(blend) <= 1e-12).all()
    assert (blend[0], blend[-1]) == pytest.approx((5 / 6, 1 / 6), abs=1e-3)
    left, right = system(0.4, 0.8)[0], system(0.4, -0.8)[0]
    assert left == right


def test_effc_rules_are_the_printed_ones() -> None:
    low = "if alpha is LOW and delta_theta is LOW then w is HIGH"
    free = "if alpha is any and delta_theta is HIGH then w is LOW"
    assert [str(rule) for rule in load("effc_table_2").rules] == [low, free]
    assert [str(rule) for rule in load("effc_table_1").rules] == [
        "if alpha is LOW and delta_theta is HIGH then w is LOW",
        low,
        free,
        "if alpha is HIGH and delta_theta is HIGH then w is LOW",
        "if alpha is LOW and delta_theta is any then w is LOW",
    ]


def test_effc_is_silent_in_one_corner_and_heads_for_the_target_there() -> None:
    for name in ("effc_table_1", "effc_table_2"):
        system = load(name)
        gaps = system.uncovered()
        assert gaps.missing == (("HIGH", "LOW"),)
        assert np.array_equal(gaps.points, [[2.0, 0.0]])
        assert system(2.0, 0.0) == system(7.0, 0.0) == (0.0,)


def test_effc_numbers_of_the_errata() -> None:
    one, two = load("effc_table_1"), load("effc_table_2")
    assert one(0.0, 0.0)[0] == pytest.approx(0.5, abs=1e-3)
    assert two(0.0, 0.0)[0] == pytest.approx(0.7085, abs=1e-3)
    grid = np.meshgrid(np.linspace(0.0, 1.99, 60), np.linspace(0.0, math.pi / 2, 60))
    (w,) = two(*grid)
    assert (w.min(), w.max()) == pytest.approx((0.2915, 0.7085), abs=1e-3)
    short = [rule for k, rule in enumerate(one.rules, start=1) if k not in (1, 4)]
    reduced = replace(one, blocks=(replace(one.blocks[0], rules=tuple(short)),))
    assert np.array_equal(reduced(*grid)[0], one(*grid)[0])  # rules 1 and 4 change nothing: errata E5


def test_fuzzy_apf_is_complete_and_weakest_where_the_robot_is_trapped() -> None:
    system = load("fuzzy_apf_table_1")
    size = {"s": 0, "m": 1, "l": 2}
    angle = {"f_s": "sss", "f_m": "sml", "f_l": "smm"}
    gain = {"f_s": "sss", "f_m": "sml", "f_l": "mml"}
    found = dict(terms(rule) for rule in system.rules)
    assert len(found) == len(system.rules) == 9
    for (force, distance), (a, k) in found.items():
        column = size[distance[-1]]
        assert (a, k) == (f"angle_{angle[force][column]}", f"k_{gain[force][column]}")
    assert len(system.uncovered()) == 0
    trapped = system(0.0, 0.5)
    assert trapped == pytest.approx((1 / 6, 1 / 6), abs=1e-3)  # 10 degrees of 60, 0.83 of 5: errata A11
    assert system(1.0, 1.0)[1] > trapped[1]


def test_the_planner_is_complete_and_gives_the_worked_example() -> None:
    system = load("fuzzy_planner_table_i")
    found = dict(terms(rule) for rule in system.rules)
    assert len(found) == len(system.rules) == int(published.claim("fuzzy-planner:c-rules").value)
    near = ("Close", "Normal", "Far")
    assert set(found) == set(product(near, near, near))
    odd = {"CCN": "AA", "CCF": "HA", "NCN": "AA", "NNN": "HA", "NFN": "AL", "FCN": "HA"}  # the rest are HL, Close LH
    for combination, answer in found.items():
        letters = "".join(word[0] for word in combination)
        usual = "LH" if letters.endswith("C") else "HL"
        assert "".join(word[0] for word in answer) == odd.get(letters, usual)
    v, omega = system(0.8, 0.3, 0.5)
    assert round(v, 3) == float(published.claim("fuzzy-planner:c-ex-v").value)
    assert round(omega, 1) == float(published.claim("fuzzy-planner:c-ex-w").value)
    sigma = float(published.claim("fuzzy-planner:c-sigma").value)
    assert {t.parameters[1] for v in system.inputs for t in v.terms} == {sigma}
    assert {t.parameters[1] for t in system.outputs[1].terms} == {round(90 * sigma, 9)}


def test_the_planner_is_never_silent_and_never_straight() -> None:
    system = load("fuzzy_planner_table_i")
    assert len(system.uncovered(21)) == 0
    grid = np.meshgrid(*[np.linspace(0, 1, 15)] * 3)
    v, omega = system(*grid)
    assert (v.min(), v.max()) == pytest.approx((0.1494, 0.8506), abs=1e-3)
    assert (omega.min(), omega.max()) == pytest.approx((13.449, 76.551), abs=0.05)
    assert system(0.0, 0.5, 0.5)[0] == pytest.approx(0.8506, abs=1e-3)  # at the goal: errata P6
