"""Fuzzy-APF in the long: counts of sought and of other layouts, traps, and who is freed from them."""

import numpy as np
import pytest

from fuzzynav import batch, published
from fuzzynav.data import folder
from fuzzynav.potential.traps import KINDS, trap
from fuzzynav.studies.potential import claims, freeing, layouts, tuning


def stored(name: str):
    return batch.read(folder("results") / f"{name}.csv")


def test_layouts_repeat_and_keep_from_start_and_goal() -> None:
    for seed in range(50):
        points, tolerance = layouts.random_layout(seed)
        assert (points == layouts.random_layout(seed)[0]).all()
        assert 2 <= len(points) <= 6
        assert 0.1 <= tolerance <= 0.5
        for end in layouts.START_GOAL:
            assert (np.hypot(*(points - end).T) > 1.5).all()


def test_what_was_sought_is_what_is_shown() -> None:
    for n in layouts.EXPONENTS:
        shown = published.table("potential").loc[f"fuzzy-apf:c-3-n{n}-iter"]
        assert float(shown["ours"]) == claims.sought_counts("3")[n]
        gap = abs(claims.sought_counts("3")[n] - float(published.claim(f"fuzzy-apf:c-3-n{n}-iter").value))
        assert shown["verdict"] == ("fitted" if gap <= claims.FEW else "not reproduced")


def test_every_claim_of_the_paper_has_a_verdict() -> None:
    wanted = {c for c in published.claims() if c.startswith("fuzzy-apf:")}
    assert {r.claim for r in claims.REPRODUCTIONS} == wanted
    shown = published.table("potential")
    assert not (shown["verdict"] == "not yet").any()
    assert (shown.loc[[c for c in shown.index if c.endswith("time")], "verdict"] == "not testable").all()


def test_ours_is_the_best_of_the_candidates() -> None:
    table = stored("apf_tuning")
    clean = table[table["touched"] == 0]
    best = clean.sort_values(["freed", "length"], ascending=[False, True], kind="stable").iloc[0]
    assert freeing.OURS == {name: type(value)(best[name]) for name, value in freeing.OURS.items()}
    assert not set(freeing.TRAINED) & set(range(freeing.JUDGED, freeing.JUDGED + freeing.TRAPS))


def test_who_is_freed() -> None:
    table = stored("apf_traps")
    freed = table[table["status"] == "reached"].groupby("method").size().reindex(freeing.escapes()).fillna(0)
    assert set(table.groupby("method").size()) == {freeing.TRAPS}
    assert freed["no escape"] == 0
    assert freed["ours"] >= 0.95 * freeing.TRAPS
    assert not (table[table["method"] == "ours"]["status"] == "collided").any()
    assert all(freed[name] < 0.5 * freeing.TRAPS for name in freeing.READINGS)
    assert freed["ours, without memory"] < freed["ours"] - 0.05 * freeing.TRAPS
    assert set(table["kind"]) == set(KINDS)


@pytest.mark.parametrize("seed", [10_000, 10_001, 10_004])
def test_a_trap_is_one_of_those_judged(seed: int) -> None:
    row = freeing.one_trap(f"{seed}/no escape")
    assert row["status"] == "local_minimum"
    assert row["kind"] == trap(seed).kind
    assert row["left"] > 0.1


def test_a_candidate_repeats() -> None:
    assert tuning.candidate(3) == tuning.candidate(3)
    assert len({str(tuning.candidate(k)) for k in range(50)}) == 50
