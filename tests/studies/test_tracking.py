"""Thesis 5, tracking: the reproductions, the studies behind them, and a fixed part of the studies recomputed."""

import numpy as np
import pandas as pd
import pytest

from fuzzynav import batch, published, tracking
from fuzzynav.studies.tracking import claims, rivals

RIVALS = rivals.RESULTS / "tracking_rivals.csv"
MINE = {r.claim: r for r in claims.REPRODUCTIONS}


def test_the_printed_length_comes_out() -> None:
    trace = claims.simulation_run()
    assert trace.length == pytest.approx(published.claim("thesis:c-5.3-tracking-len").value, abs=0.005)
    assert trace.t[-1] == pytest.approx(126.0)
    assert (trace.rms < 0.02).all()


def test_the_ledger_of_the_chapter() -> None:
    verdicts = published.table("tracking")["verdict"].to_dict()
    expected = {
        "c-5.3-tracking-len": "reproduced",
        "c-5.5-tracking-len": "fitted",
        "c-5.8-small": "reproduced",
        "c-5-baseline": "not reproduced",
        "c-formula-7": "reproduced",
        "c-extra-9": "reproduced",
    }
    for claim, verdict in verdicts.items():
        reproduction = MINE[claim]
        if reproduction.verdict is not None:
            assert len(reproduction.because) > 20
        else:
            assert verdict == expected.get(claim.removeprefix("thesis:"), "input"), claim


def test_129_seconds_are_not_the_time_of_the_motion() -> None:
    curve = claims.SIMULATION
    printed = published.claim("thesis:c-5.3-tracking-time").value
    assert curve.length(printed) == pytest.approx(19.593, abs=1e-3)
    assert curve.length(printed) > published.claim("thesis:c-5.3-tracking-len").value + 0.6


@pytest.mark.parametrize(
    ("duration", "amplitude"), [(123.0, 1.2885), (40 * np.pi, 1.2482), (126.0, 1.2433), (129.0, 1.2014)]
)
def test_amplitude_of_the_experiment(duration: float, amplitude: float) -> None:
    assert claims.amplitude_for_length(11.77, duration) == pytest.approx(amplitude, abs=1e-4)


def test_all_laws_are_tuned_with_the_same_budget_and_gain_from_it() -> None:
    table = batch.read(rivals.RESULTS / "tracking_gains.csv")
    assert set(table["case"]) == set(rivals.CONTESTANTS)
    budget = rivals.POPULATION * rivals.GENERATIONS
    assert (table["trials"] == budget).all()
    for method in ("DFL", "linear flatness", "Kanayama", "sliding mode", "PID + feed-forward"):
        plain = {
            "DFL": tracking.Dfl(),
            "linear flatness": tracking.Flatness(),
            "Kanayama": tracking.Kanayama(),
            "sliding mode": tracking.Sliding(),
            "PID + feed-forward": tracking.Pid(),
        }[method]
        worth = float(table[table["case"] == method]["score"].iloc[0])
        tuned = rivals.build(method, rivals.PRACTICE, rivals.tuned(method))
        assert rivals.score(tuned) == pytest.approx(worth, rel=1e-3)
        assert worth < rivals.score(tracking.Tracker(rivals.PRACTICE, plain))


def test_one_percent_of_the_comparison_recomputed() -> None:
    table = batch.read(RIVALS)
    stored = dict(tuple(table.groupby("case")))
    assert len(stored) == len(rivals.CONTESTANTS) * rivals.SEEDS
    for k, method in enumerate(rivals.CONTESTANTS):
        for seed in (17 * k + 3, 199 - 11 * k):
            again = pd.DataFrame(rivals.compare(f"{method}/{seed}"))
            kept = stored[f"{method}/{seed}"].reset_index(drop=True)
            assert list(again["condition"]) == list(kept["condition"])
            for column in ("rms", "late_rms", "late_max", "heading", "effort"):
                tolerance = 0.02 if method == "MPC" else 1e-3
                assert again[column].to_numpy() == pytest.approx(kept[column].to_numpy(), rel=tolerance, abs=1e-6)


def test_observer_study_recomputed_in_part() -> None:
    table = batch.read(rivals.RESULTS / "tracking_observers.csv").set_index("case")
    for case in ("differences/0.01/3", "Luenberger/0.02/7", "Kalman/0.005/11", "kinematics (2.14)/0.05/0"):
        row = rivals.observe(case)[0]
        assert row["rms"] == pytest.approx(table.loc[case, "rms"], rel=1e-2)
    means = table.groupby(["observer", "noise"])["rms"].mean().unstack()
    assert (means.loc["Kalman"] < means.loc["differences"]).all()
    assert (means.loc["Luenberger"] < means.loc["differences"]).all()


def test_error_bounds_hold_for_every_law_and_condition() -> None:
    table = rivals.bounds_table(batch.read(RIVALS))
    assert list(table.index) == list(rivals.CONTESTANTS)
    assert list(table.columns) == list(rivals.CONDITIONS)
    assert np.isfinite(table.to_numpy()).all()
    assert (table.drop(index="PID").to_numpy() < 0.15).all()
    assert (table.drop(index="PID")["ideal"] < 0.02).all()


def test_the_linear_baseline_is_beaten_only_if_every_condition_is_won(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [
        {"condition": c, "method": m, "late_rms": v + 0.1 * k}
        for c, ours, theirs in (("ideal", 1.0, 2.0), ("noise", 1.0, 1.5))
        for m, v in (("DFL", ours), ("linear flatness", theirs))
        for k in range(3)
    ]
    table = pd.DataFrame(rows)
    monkeypatch.setattr(claims.batch, "read", lambda path: table)
    assert claims.baseline_is_beaten() is True
    table.loc[(table["condition"] == "noise") & (table["method"] == "DFL"), "late_rms"] = 1.6
    assert claims.baseline_is_beaten() is False


def test_in_the_stored_study_neither_wins_everywhere() -> None:
    shares = rivals.better_share(batch.read(RIVALS), "DFL", "linear flatness")
    assert (shares[["ideal", "slip", "delay", "wheel radius", "motor lag"]] > 0.9).all()
    assert (shares[["noise", "all"]] < 0.5).all(), "with measurement noise the linear controller is better more often"
