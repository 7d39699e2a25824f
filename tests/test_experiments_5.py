"""Chapter 5, tracking: the reproductions, the studies behind them, and a fixed part of the studies recomputed."""

import numpy as np
import pandas as pd
import pytest

from fuzzynav import batch, published, tracking
from fuzzynav.experiments import chapter_5, tracking_study

RIVALS = tracking_study.RESULTS / "tracking_rivals.csv"
MINE = {r.claim: r for r in chapter_5.REPRODUCTIONS}


def test_the_printed_length_comes_out() -> None:
    trace = chapter_5.simulation_run()
    assert trace.length == pytest.approx(published.claim("thesis:c-5.3-tracking-len").value, abs=0.005)
    assert trace.t[-1] == pytest.approx(126.0)
    assert (trace.rms < 0.02).all()


@pytest.mark.parametrize("claim", MINE)
def test_every_number_is_reproduced_but_the_claim_against_the_baseline(claim: str) -> None:
    reproduction = MINE[claim]
    if reproduction.verdict is None:
        verdict = published.verdict(published.claim(claim), reproduction.measure(), reproduction)
        wanted = "not reproduced" if claim == "thesis:c-5-baseline" else "reproduced"
        assert verdict == wanted
    else:
        assert len(reproduction.because) > 20


def test_129_seconds_are_not_the_time_of_the_motion() -> None:
    curve = chapter_5.SIMULATION
    printed = published.claim("thesis:c-5.3-tracking-time").value
    assert curve.length(printed) == pytest.approx(19.593, abs=1e-3)
    assert curve.length(printed) > published.claim("thesis:c-5.3-tracking-len").value + 0.6


@pytest.mark.parametrize(
    ("duration", "amplitude"), [(123.0, 1.2885), (40 * np.pi, 1.2482), (126.0, 1.2433), (129.0, 1.2014)]
)
def test_amplitude_of_the_experiment(duration: float, amplitude: float) -> None:
    assert chapter_5.amplitude_for_length(11.77, duration) == pytest.approx(amplitude, abs=1e-4)


def test_all_laws_are_tuned_with_the_same_budget_and_gain_from_it() -> None:
    table = batch.read(tracking_study.RESULTS / "tracking_gains.csv")
    assert set(table["case"]) == set(tracking_study.CONTESTANTS)
    budget = tracking_study.POPULATION * tracking_study.GENERATIONS
    assert (table["trials"] == budget).all()
    for method in ("DFL", "linear flatness", "Kanayama", "sliding mode", "PID + feed-forward"):
        plain = {"DFL": tracking.Dfl, "linear flatness": tracking.Flatness, "Kanayama": tracking.Kanayama,
                 "sliding mode": tracking.Sliding, "PID + feed-forward": tracking.Pid}[method]
        worth = float(table[table["case"] == method]["score"].iloc[0])
        tuned = tracking_study.build(method, tracking_study.PRACTICE, tracking_study.tuned(method))
        assert tracking_study.score(tuned) == pytest.approx(worth, rel=1e-3)
        assert worth < tracking_study.score(plain(tracking_study.PRACTICE))


def test_one_percent_of_the_comparison_recomputed() -> None:
    table = batch.read(RIVALS)
    stored = dict(tuple(table.groupby("case")))
    assert len(stored) == len(tracking_study.CONTESTANTS) * tracking_study.SEEDS
    for k, method in enumerate(tracking_study.CONTESTANTS):
        for seed in (17 * k + 3, 199 - 11 * k):
            again = pd.DataFrame(tracking_study.compare(f"{method}/{seed}"))
            kept = stored[f"{method}/{seed}"].reset_index(drop=True)
            assert list(again["condition"]) == list(kept["condition"])
            for column in ("rms", "late_rms", "late_max", "heading", "effort"):
                tolerance = 0.02 if method == "MPC" else 1e-3
                assert again[column].to_numpy() == pytest.approx(kept[column].to_numpy(), rel=tolerance, abs=1e-6)


def test_observer_study_recomputed_in_part() -> None:
    table = batch.read(tracking_study.RESULTS / "tracking_observers.csv").set_index("case")
    for case in ("differences/0.01/3", "Luenberger/0.02/7", "Kalman/0.005/11", "kinematics (2.14)/0.05/0"):
        row = tracking_study.observe(case)[0]
        assert row["rms"] == pytest.approx(table.loc[case, "rms"], rel=1e-2)
    means = table.groupby(["observer", "noise"])["rms"].mean().unstack()
    assert (means.loc["Kalman"] < means.loc["differences"]).all()
    assert (means.loc["Luenberger"] < means.loc["differences"]).all()


def test_error_bounds_hold_for_every_law_and_condition() -> None:
    table = tracking_study.bounds_table(batch.read(RIVALS))
    assert list(table.index) == list(tracking_study.CONTESTANTS)
    assert list(table.columns) == list(tracking_study.CONDITIONS)
    assert np.isfinite(table.to_numpy()).all()
    assert (table.drop(index="PID").to_numpy() < 0.15).all()
    assert (table.drop(index="PID")["ideal"] < 0.02).all()


def test_whether_the_linear_baseline_is_beaten_follows_from_the_table() -> None:
    medians = batch.read(RIVALS).groupby(["condition", "method"])["late_rms"].median().unstack()
    assert chapter_5.baseline_is_beaten() == bool((medians["DFL"] < medians["linear flatness"]).all())
