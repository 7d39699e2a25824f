"""What chapter 07 says of its long studies: every promise that its text makes is held by the stored rows."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from fuzzynav import plot
from fuzzynav.fusion.scenes import ROBOTS
from fuzzynav.studies.fusion import contacts, scenes, tables
from fuzzynav.studies.fusion.worlds import outcome


def test_a_guarded_robot_that_is_told_hits_nothing() -> None:
    table = tables.stored("fusion_scenes")
    told = table[(table["planner"] == "ours") & ~table["movers"].str.contains("scans")]
    assert len(told) == 2 * (scenes.SEEDS + scenes.SOME)
    assert not (told["ending"] == "hit").any()
    assert not (told[told["movers"] == "yield"]["ending"] == "struck").any()
    brakes = tables.stored("fusion_braking")
    assert set(brakes["planner"].astype(float)) == set(scenes.BRAKES)
    assert not (brakes["ending"] == "hit").any()


def test_what_the_chapter_asks_of_the_scenes() -> None:
    """At least 95 % among movers that yield with a TurtleBot2's brakes; from scans contacts below 1 %."""
    for robot in ROBOTS:
        table = tables.comparison(robot).set_index("method")
        assert table.loc["ours, from scans", "hit rate"] < 0.01
        rivals = [name for name in scenes.PLANNERS if name in table.index]
        assert len(rivals) == 6
        assert table.loc["ours, movers told", "reached low"] > table.loc[rivals, "reached high"].max()
    assert tables.comparison("turtlebot2").set_index("method").loc["ours, movers told", "reached rate"] >= 0.95


def test_every_contact_from_scans_has_a_cause() -> None:
    table = tables.stored("fusion_scenes")
    hit = table[(table["ending"] == "hit") & (table["planner"] == "ours")]
    found = contacts.contacts()
    assert set(found["case"]) == set(hit["case"])
    assert set(found["cause"]) <= set(contacts.CAUSES)
    assert (found["gap"] > 0).all()
    assert (found["warning"] > 0).all()


def test_a_run_without_contact_has_no_cause() -> None:
    with pytest.raises(ValueError, match="ends as reached: there is no contact to explain"):
        contacts.cause("turtlebot2/yield scans/ours/20000")


def test_the_public_worlds() -> None:
    barn = tables.barn_worlds().set_index(["planner", "speed"])
    assert barn.loc[("move_base DWA, published", 2.0), "score"] == pytest.approx(0.1586, abs=5e-5)
    assert barn.loc[("ours", 2.0), "reached rate"] >= 0.96
    assert barn.loc[("ours", 2.0), "score"] >= 0.42
    assert barn.loc[("ours", 0.5), "score"] >= 0.25
    assert (barn.loc["ours", "hit rate"] == 0.0).all()
    dynamic = tables.dynabarn_worlds().set_index(["planner", "tracking", "speed"])
    for tracking, least in (("ideal", (0.95, 0.90, 0.85)), ("scans", (0.90, 0.75, 0.60))):
        ours = dynamic.loc[("ours, evading", tracking, 2.0)]
        assert all(ours[name] >= share for name, share in zip(("easy", "medium", "hard"), least, strict=True))
        assert ours["runs"] == 300
    whole = tables.dynabarn_worlds("all")
    assert (whole["runs"] == 600).all()
    assert set(whole["planner"]) == {"ours, evading"}


def test_a_guest_that_is_not_installed_is_no_failure_of_the_guest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(ModuleNotFoundError, match="pip install navground"):
        outcome("dynabarn/ORCA/ideal/2.0/0.0")


def test_the_picture_of_the_brakes_shows_the_table() -> None:
    table = tables.braking()
    axes = Figure().subplots(1, 2)
    lines = plot.draw_braking(axes, table)
    assert [line.get_label() for line in lines[::2]] == ["movers that yield", "movers that do not"]
    rows = table[table["movers"] == "blind"].sort_values("brake")
    np.testing.assert_allclose(lines[2].get_xydata(), rows[["brake", "reached rate"]])
    np.testing.assert_allclose(lines[3].get_ydata(), rows["median time"])
    assert isinstance(table, pd.DataFrame)
