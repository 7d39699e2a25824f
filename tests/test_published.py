"""The ledger: every claim and item is readable, and verdicts follow the stated rules."""

import csv
import math
from collections import Counter
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav import documents, published
from fuzzynav.studies.reproduction import VERDICTS, Reproduction

LENGTH = published.claim("thesis:c-3.4-S1-TA-len")
RATE = published.claim("thesis:c-3.5-TDWA-succ")
PERCENT = published.claim("thesis:c-3.4-pct-4")


def test_every_claim_belongs_to_a_known_document():
    assert len(published.claims()) == 300
    assert {c.id.split(":")[0] for c in published.claims().values()} == {
        "thesis", "effc", "fuzzy-apf", "fuzzy-planner", "barn"}  # fmt: skip
    assert all(c.better in ("lower", "higher", "equal") for c in published.claims().values())


def test_every_item_says_whether_it_can_be_reproduced():
    assert len(published.items()) == 401
    assert {i.reproducible for i in published.items().values()} == {"yes", "approx", "concept", "no"}


def test_values_have_their_kind():
    assert LENGTH.value == 24.73
    assert LENGTH.decimals == 2
    assert published.claim("thesis:c-3.4-S1-TA-smooth").value == "No"
    assert published.claim("thesis:c-formula-4").value is True
    assert published.claim("effc:c-turn").value == math.pi / 4


def test_unknown_names_are_answered_with_near_ones():
    with pytest.raises(ValueError, match="no published claim 'thesis:c-nothing'"):
        published.claim("thesis:c-nothing")
    with pytest.raises(ValueError, match="no published item"):
        published.item("thesis:fig-99")
    with pytest.raises(ValueError, match="topic chess has no reproductions"):
        published.table("chess")


def verdict(claim, ours, **more):
    return published.verdict(claim, ours, Reproduction(claim=claim.id, measure=lambda: ours, **more))


@pytest.mark.parametrize(
    ("claim", "ours", "more", "expected"),
    [
        (LENGTH, 24.7279, {}, "reproduced"),
        (LENGTH, 24.735, {}, "reproduced"),
        (LENGTH, 24.7351, {}, "not reproduced"),
        (LENGTH, 25.0, {"tolerance": 0.5}, "reproduced"),
        (LENGTH, math.nan, {}, "not reproduced"),
        (LENGTH, 24.7279, {"shows": "fitted", "free": "the map"}, "fitted"),
        (LENGTH, 24.7279, {"shows": "input"}, "input"),
        (LENGTH, 24.7279, {"shows": "by definition", "free": "the measure"}, "by definition"),
        (LENGTH, 25.0, {"shows": "fitted", "free": "the map"}, "not reproduced"),
        (PERCENT, 60.0, {}, "reproduced"),
        (PERCENT, 31.0, {}, "not reproduced"),
        (PERCENT, 31.0, {"direction": lambda: (30.0, 0.1, 60.0)}, "direction holds"),
        (PERCENT, 31.0, {"direction": lambda: (30.0, 0.0, 60.0)}, "not reproduced"),
        (PERCENT, 31.0, {"direction": lambda: (30.0, math.nan, 60.0)}, "not reproduced"),
        (PERCENT, 0.6, {}, "not reproduced"),  # a fraction is not the percentage
        (RATE, 10.8, {}, "not reproduced"),
    ],
)
def test_verdicts_on_numbers(claim, ours, more, expected):
    assert verdict(claim, ours, **more) == expected


@pytest.mark.parametrize(
    ("name", "ours", "expected"),
    [
        ("thesis:c-3.4-S1-TA-smooth", "No", "reproduced"),
        ("thesis:c-3.4-S1-TA-smooth", "Yes", "not reproduced"),
        ("thesis:c-formula-4", True, "reproduced"),
        ("thesis:c-formula-4", False, "not reproduced"),
        ("thesis:c-formula-4", 1.0, "not reproduced"),
        ("fuzzy-planner:c-opt90", 93.0, "reproduced"),
        ("fuzzy-planner:c-opt90", 88.0, "not reproduced"),
    ],
)
def test_verdicts_on_words_truths_and_bounds(name, ours, expected):
    assert verdict(published.claim(name), ours) == expected


@pytest.mark.parametrize("claim", [LENGTH, RATE])
def test_a_length_and_a_rate_have_no_direction(claim):
    with pytest.raises(ValueError, match="states no change and no comparison"):
        verdict(claim, 31.0, direction=lambda: (1.0, 0.5, 2.0))


@given(st.floats(0, 10), st.floats(-20, 70))
def test_within_the_tolerance_means_reproduced(tolerance, ours):
    said = verdict(LENGTH, ours, tolerance=tolerance)
    assert (said == "reproduced") == (abs(ours - 24.73) <= tolerance + 1e-9)


def test_a_verdict_by_hand_needs_its_reason():
    with pytest.raises(ValueError, match="needs its reason"):
        Reproduction(claim=LENGTH.id, verdict="not testable")
    with pytest.raises(ValueError, match="give a function that measures"):
        Reproduction(claim=LENGTH.id)
    with pytest.raises(ValueError, match="is not one of"):
        Reproduction(claim=LENGTH.id, verdict="fine", because="x")
    with pytest.raises(ValueError, match="agreement shows one of reproduced, fitted, input, by definition"):
        Reproduction(claim=LENGTH.id, measure=lambda: 1.0, shows="direction holds")
    with pytest.raises(ValueError, match="'fitted' needs what was free"):
        Reproduction(claim=LENGTH.id, measure=lambda: 1.0, shows="fitted")
    by_hand = Reproduction(claim=LENGTH.id, verdict="not testable", because="hardware")
    assert published.verdict(LENGTH, "", by_hand) == "not testable"


@pytest.fixture
def one_chapter(monkeypatch):
    rows = (
        Reproduction(claim=LENGTH.id, measure=lambda: 24.7279, because="rounding of two decimals"),
        Reproduction(
            claim=PERCENT.id,
            measure=lambda: 33.3333,
            free="the map",
            direction=lambda: (20.0, 10.0, 30.0),
            beside=lambda: "21 % on 500 maps",
            holds_for=lambda: (2, 7),
        ),
        Reproduction(claim="thesis:c-formula-2", because="P = 1.4 there", verdict="contradicts itself"),
    )
    monkeypatch.setattr(published, "reproductions", lambda: {"maps": rows})
    return rows


def test_a_chapters_table(one_chapter):
    table = published.table("maps")
    assert list(table["verdict"]) == ["reproduced", "direction holds", "contradicts itself"]
    assert list(table["published"]) == ["24.73", "60", "true"]
    assert list(table["ours"]) == ["24.728", "33.3", ""]
    change = "change on seeded cases +20.0 [+10.0, +30.0]; beside it: 21 % on 500 maps"
    assert list(table["why"]) == ["rounding of two decimals", change, "P = 1.4 there"]
    assert list(table["free"]) == ["", "the map", ""]
    assert list(table["holds_for"]) == ["", "2 of 7", ""]
    assert "rounding of two decimals" in table._repr_html_()


def test_the_ledger_has_a_row_for_each_claim(one_chapter, tmp_path, capsys):
    assert published.main(["--csv", str(tmp_path / "ledger.csv")]) == 0
    said = capsys.readouterr().out
    assert "300 claims: 1 reproduced, 1 direction holds, 1 contradicts itself, 297 not yet" in said
    assert "published 24.73 m; ours 24.728; reproduced" in said
    assert "free: the map; holds for 2 of 7; change on seeded cases" in said
    with (tmp_path / "ledger.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == len(published.claims())
    assert {r["verdict"] for r in rows} <= set(VERDICTS)


def test_a_study_that_was_not_run_is_not_yet(monkeypatch):
    def measure():
        raise FileNotFoundError("runs.csv is not there yet")

    monkeypatch.setattr(published, "reproductions", lambda: {"maps": (Reproduction(claim=LENGTH.id, measure=measure),)})
    table = published.table("maps")
    assert list(table["verdict"]) == ["not yet"]
    assert list(table["why"]) == ["runs.csv is not there yet"]


def test_a_reproduction_of_an_unknown_claim_is_refused(one_chapter, monkeypatch):
    wrong = (replace(one_chapter[0], claim="thesis:c-typo"),)
    monkeypatch.setattr(published, "reproductions", lambda: {"maps": wrong})
    with pytest.raises(ValueError, match="no published claim 'thesis:c-typo'"):
        published.ledger()


def test_the_chapters_present_are_sound():
    seen: set[str] = set()
    for chapter, group in published.reproductions().items():
        for reproduction in group:
            assert published.claim(reproduction.claim).id not in seen, f"{reproduction.claim} twice ({chapter})"
            seen.add(reproduction.claim)


def test_a_fit_a_tendency_and_a_measured_value_say_what_was_free_and_how_far_it_carries():
    for group in published.reproductions().values():
        for r in group:
            assert r.verdict or r.because, f"{r.claim}: where does the tolerance come from?"
            if r.free and r.verdict is None:
                assert r.holds_for, f"{r.claim}: for which of our reconstructions?"


def test_the_claims_hold_what_was_printed_and_no_result_of_ours():
    text = documents.folder("published").joinpath("claims.csv").read_text(encoding="utf-8")
    for ours in (
        "1993",
        "REFUTED",
        "REPRODUCED",
        "confirmed",
        "own check",
        "own run",
        "not printed here",
        "computed here",
    ):
        assert ours not in text, ours


def test_fractions_of_pi_are_shown_in_full():
    row = next(r for r in published.ledger() if r.claim == "thesis:c-5-fov")
    assert (row.published, row.ours, row.verdict) == ("pi/4", "0.7854", "input")


def test_the_verdicts_of_today():
    """Whoever moves one says why in the log."""
    counts = Counter((r.source.partition(":")[0], r.verdict) for r in published.ledger() if r.verdict != "not yet")
    assert counts == {
        ("thesis", "reproduced"): 12,
        ("thesis", "fitted"): 27,
        ("thesis", "input"): 16,
        ("thesis", "by definition"): 13,
        ("thesis", "direction holds"): 1,
        ("thesis", "not reproduced"): 44,
        ("thesis", "contradicts itself"): 8,
        ("thesis", "not testable"): 28,
        ("fuzzy-planner", "reproduced"): 2,
        ("fuzzy-planner", "input"): 4,
        ("fuzzy-planner", "not reproduced"): 1,
        ("fuzzy-apf", "fitted"): 17,
        ("fuzzy-apf", "input"): 7,
        ("fuzzy-apf", "reproduced"): 4,
        ("fuzzy-apf", "not reproduced"): 15,
        ("fuzzy-apf", "contradicts itself"): 3,
        ("fuzzy-apf", "not testable"): 32,
        ("barn", "contradicts itself"): 2,
    }


def test_items_in_notebooks_exist():
    assert set(published.reproduced_items()) <= set(published.items())


def test_a_damaged_file_names_its_row(tmp_path, monkeypatch):
    (tmp_path / "claims.csv").write_text("id,value\na,b,c\n")
    monkeypatch.setattr(documents, "folder", lambda name: tmp_path)
    with pytest.raises(ValueError, match=r"claims\.csv, row 2: 9 fields are needed, found 3"):
        documents._rows("claims.csv", 9)
