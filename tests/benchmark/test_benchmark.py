"""The command that compares planners: every result is kept, named and repeatable."""

import importlib.util
import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from fuzzynav import batch
from fuzzynav.benchmark import Case, TaskSet, cases_of, code_label, named, run_case, tasks
from fuzzynav.benchmark.__main__ import main
from fuzzynav.benchmark.players import FRAMES, player_html
from fuzzynav.benchmark.report import Comparison, page, worst_cases
from fuzzynav.fusion import protocol
from fuzzynav.fusion.scenes import scene_task
from fuzzynav.world import Mover, World
from tests.fusion.barn_files import write_barn

HOME = Path(__file__).parents[2]
HERE = Path(__file__).parent
TOY = "toys:"


@pytest.fixture(autouse=True)
def toys_can_be_imported(monkeypatch):
    monkeypatch.syspath_prepend(HERE)


def runs(out):
    return batch.read(out / "runs.csv")


def asked(*words, out, kind="scenes", cases=3):
    return [kind, "--method", *words, "--cases", str(cases), "--out", str(out)]


def test_the_command_from_end_to_end_with_a_planner_of_ones_own(tmp_path):
    (tmp_path / "mine.py").write_text((HERE / "toys.py").read_text())
    words = [
        sys.executable,
        "-m",
        "fuzzynav.benchmark",
        *asked("mine:straight", "mine:raising", out="report"),
        "--seed",
        "5",
    ]
    done = subprocess.run(
        words, cwd=tmp_path, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(HOME)}
    )
    assert done.returncode == 0, done.stderr
    table = runs(tmp_path / "report")
    assert table["item"].tolist() == ["5", "5", "6", "6", "7", "7"]
    assert set(table.loc[table["method"] == "mine:straight", "ending"]) <= {"reached", "hit", "struck", "late"}
    assert (table.loc[table["method"] == "mine:raising", "ending"] == "failed").all()
    totals = pd.read_csv(tmp_path / "report/summary.csv")
    assert totals["runs"].tolist() == [3, 3]
    assert totals["failed"].tolist() == [0, 3]
    text = (tmp_path / "report/report.html").read_text()
    for said in (protocol.PROTOCOL, "mine:straight", "RuntimeError: the rules are gone &lt;b&gt;", "5, 6, 7",
                 totals["tasks_code"][0], totals["fingerprint"][0], "python -m fuzzynav.benchmark scenes"):  # fmt: skip
        assert said in text, said
    assert "3<br>100.0 %<br><small>43.9-100.0</small>" in text  # three failures of three, Wilson
    assert len(text) < 400_000
    assert "http" not in re.sub(r'"http://www.w3.org[^"]*"', "", text)  # needs nothing else


def test_bad_planners_are_named_and_do_not_end_the_sweep(tmp_path):
    names = [TOY + name for name in ("raising", "nans", "sleepy", "parked", "straight")]
    assert main([*asked(*names, out=tmp_path, cases=2), "--step-limit", "0.01", "--players", "0"]) == 0
    table = runs(tmp_path).set_index("method")
    for name, said in (("raising", "RuntimeError: the rules are gone <b>"), ("nans", "[nan, 0.0] at 0.2 s"),
                       ("sleepy", "TimeoutError"), ("parked", "no controller")):  # fmt: skip
        assert (table.loc[TOY + name, "ending"] == "failed").all()
        assert table.loc[TOY + name, "reason"].str.contains(said, regex=False).all()
    assert (table.loc[TOY + "straight", "ending"] != "failed").all()


def test_what_cannot_be_solved_is_counted_apart(tmp_path, monkeypatch):
    def shut(seed, **kwargs):
        task = scene_task(seed, **kwargs)
        walls = World(rectangles=[[10.0, 10.0, 0.5, 20.0, 0.0]], bounds=(0.0, 20.0, 0.0, 20.0))
        return replace(task, world=walls, optimum=np.nan, chart=None) if seed == 1 else task

    monkeypatch.setattr(tasks, "scene_task", shut)
    assert main(asked(TOY + "straight", out=tmp_path)) == 0
    totals = pd.read_csv(tmp_path / "summary.csv").iloc[0]
    assert (totals["runs"], totals["solvable"], totals["unsolvable"]) == (3, 2, 1)
    assert totals["reached rate"] == totals["reached"] / 2


# --- the same on every machine ------------------------------------------------------------------


def test_rows_do_not_depend_on_who_runs_them(tmp_path):
    names = [TOY + "straight", TOY + "nans"]
    for words, where in (([], "one"), (["--processes", "2"], "two")):
        assert main([*asked(*names, out=tmp_path / where, cases=4), *words]) == 0
    dask = [sys.executable, str(HERE / "two_dask_workers.py"), *asked(*names, out=tmp_path / "dask", cases=4)]
    paths = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HOME), str(HERE)])}
    done = subprocess.run(dask, cwd=tmp_path, capture_output=True, text=True, timeout=240, env=paths)
    assert done.returncode == 0, done.stderr
    assert "2 workers" in done.stdout
    tables = [runs(tmp_path / where).drop(columns=list(protocol.TIMED)) for where in ("one", "two", "dask")]
    for other in tables[1:]:
        pd.testing.assert_frame_equal(tables[0], other)
    marks = {pd.read_csv(tmp_path / where / "summary.csv")["fingerprint"][0] for where in ("one", "two", "dask")}
    assert len(marks) == 1


@pytest.mark.parametrize("left", [0.15, 0.5, 0.8, 0.99])
def test_an_interrupted_file_resumes_to_the_same_bytes(tmp_path, monkeypatch, left):
    monkeypatch.setattr(protocol, "time", SimpleNamespace(perf_counter=lambda: 0.0))  # all but the clock repeats
    words = [*asked(TOY + "straight", TOY + "raising", out=tmp_path), "--players", "0"]
    assert main(words) == 0
    files = [tmp_path / name for name in ("runs.csv", "summary.csv", "report.html")]
    whole = [file.read_bytes() for file in files]
    files[0].write_bytes(whole[0][: int(left * len(whole[0]))])
    if left < 0.5:  # cut inside its first line, a file is no sweep
        assert main(words) == 2
        files[0].unlink()
    assert main(words) == 0
    assert [file.read_bytes() for file in files] == whole


def test_finished_cases_are_not_run_again_and_more_can_be_asked_for(tmp_path, monkeypatch):
    assert main(asked(TOY + "straight", out=tmp_path)) == 0
    before = runs(tmp_path)
    seen = []
    monkeypatch.setattr(tasks, "scene_task", lambda seed, **kwargs: seen.append(seed) or scene_task(seed, **kwargs))
    assert main([*asked(TOY + "straight", out=tmp_path, cases=4), "--players", "0"]) == 0
    assert seen == [3]
    pd.testing.assert_frame_equal(runs(tmp_path).head(3), before)  # the clock's columns, too


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (["--step-limit", "2"], "step_limit = 1.0"),
        (["--ideal"], "ideal = False"),
        (["--robot", "thesis"], "robot = turt"),
    ],
)
def test_rows_of_other_conditions_are_not_mixed(tmp_path, capsys, change, said):
    assert main([*asked(TOY + "straight", out=tmp_path, cases=1), "--players", "0"]) == 0
    assert main([*asked(TOY + "straight", out=tmp_path, cases=1), *change]) == 2
    assert said in capsys.readouterr().err


def test_another_planner_of_the_same_name_is_not_taken_for_the_first(tmp_path, monkeypatch, capsys):
    monkeypatch.syspath_prepend(tmp_path)
    source = "from toys import Straight\ndef plan(task):\n    return Straight(task{})\n"
    (tmp_path / "changing.py").write_text(source.format(""))
    assert main([*asked("changing:plan", out=tmp_path, cases=1), "--players", "0"]) == 0
    (tmp_path / "changing.py").write_text(source.format(", None"))
    assert main([*asked("changing:plan", out=tmp_path, cases=1), "--players", "0"]) == 2
    assert "planner changing:plan" in capsys.readouterr().err


def test_a_planner_that_does_not_repeat_is_found_out(tmp_path):
    assert main([*asked(TOY + "hoarder", out=tmp_path), "--players", "3"]) == 0
    assert "DID NOT REPEAT" in (tmp_path / "report.html").read_text()
    assert main([*asked(TOY + "straight", out=tmp_path / "b"), "--players", "3"]) == 0
    assert "DID NOT REPEAT" not in (tmp_path / "b/report.html").read_text()


# --- what is asked for --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["mazes", "--method", "TDWA"], "the set is one of scenes, barn, dynabarn, got 'mazes'"),
        (["scenes", "--method", "TDWB"], "there is no planner 'TDWB': take one of 'ours'"),
        (["scenes", "--method", "nowhere:plan"], "there is no planner nowhere:plan: No module named 'nowhere'"),
        (["scenes", "--method", TOY + "plan"], "has no attribute 'plan'"),
        (["scenes", "--method", TOY + "NUMBER"], "is int: a planner is a function"),
        (["scenes", "--method", "TDWA", "TDWA"], "each planner once"),
        (["scenes", "--method", "TDWA", "--cases", "0"], "from 1 to"),
        (["scenes", "--method", "TDWA", "--seed", "-1"], "a seed of 0 or more"),
        (["scenes", "--method", "TDWA", "--processes", "0"], "--processes must be at least 1"),
        (["scenes", "--method", "TDWA", "--players", "-1"], "--players must be at least 0"),
        (["scenes", "--method", "TDWA", "--step-limit", "0"], "--step-limit must be positive"),
        (["scenes", "--method", "TDWA", "--robot", "tank"], "the robot is one of thesis, turtlebot2, got 'tank'"),
        (["scenes", "--method", "TDWA", "--top-speed", "1"], "top-speed does not belong to scenes"),
        (["scenes", "somewhere", "--method", "TDWA"], "folder does not belong to scenes"),
        (["barn", "here", "--method", "TDWA", "--courteous"], "courteous does not belong to barn"),
        (["barn", "here", "--method", "TDWA", "--part", "best"], "the part is one of held-out, tuning, all"),
        (["barn", "here", "--method", "TDWA", "--top-speed", "nan"], "positive top speed"),
        (["scenes", "--method", "TDWA", "--dask", "x:1", "--processes", "2"], "exclude each other"),
    ],
)  # fmt: skip
def test_a_bad_request_is_answered_in_one_sentence(tmp_path, monkeypatch, capsys, words, said):
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_worlds_that_are_not_there_are_skipped_with_a_reason(tmp_path, capsys):
    for kind in ("barn", "dynabarn"):
        assert main([kind, str(tmp_path / "gone"), "--method", "TDWA", "--out", str(tmp_path / "out")]) == 0
        assert "skipped, there is no folder gone" in capsys.readouterr().out
    assert not (tmp_path / "out").exists()


# --- BARN ---------------------------------------------------------------------------------------


def test_barn_is_scored_and_dynabarn_is_told_apart_by_class(tmp_path):
    home, out = str(write_barn(tmp_path)), tmp_path / "out"
    names = [TOY + "straight", TOY + "nans"]
    assert main(["barn", home, "--method", *names, "--cases", "3", "--top-speed", "2", "--out", str(out)]) == 0
    totals = pd.read_csv(out / "summary.csv")
    assert runs(out)["item"].unique().tolist() == ["0", "6", "12"]  # held out
    assert totals["score"].tolist() == [0.5, 0.0]
    assert "the same worlds, a cleaner robot" in (out / "report.html").read_text()
    words = ["dynabarn", home, "--method", names[0], "--part", "tuning", "--cases", "40", "--out", str(tmp_path / "d")]
    assert main([*words, "--players", "1"]) == 0
    table = runs(tmp_path / "d")
    assert table["item"].tolist()[:2] == ["1.0", "3.0"]
    assert table["item"].tolist()[30] == "1.1"  # the next phase
    assert table["group"].value_counts().to_dict() == {"easy": 20, "medium": 10, "hard": 10}
    assert f"{names[0]}, medium" in (tmp_path / "d/report.html").read_text()


def test_the_worlds_of_a_set_have_a_mark_of_their_own(tmp_path):
    first = TaskSet(kind="dynabarn", folder=str(write_barn(tmp_path))).worlds
    assert TaskSet(kind="dynabarn", folder=str(tmp_path), top_speed=0.5).worlds == first
    (tmp_path / "other").mkdir()
    file = write_barn(tmp_path / "other") / "dynabarn60.json"
    found = json.loads(file.read_text())
    found["worlds"][58][0][1][1][1] += 0.01
    file.write_text(json.dumps(found))
    assert TaskSet(kind="dynabarn", folder=str(tmp_path / "other")).worlds != first


def test_a_case_is_the_row_of_its_task():
    scenes = TaskSet(courteous=True, ideal=True, robot="thesis")
    assert [str(case) for case in cases_of(scenes, ["TDWA", TOY + "straight"], 2)] == [
        "0 TDWA", f"0 {TOY}straight", "1 TDWA", f"1 {TOY}straight"]  # fmt: skip
    task = scenes.task("1")
    assert task.ideal and task.robot.name == "thesis" and task.world.movers[0].courtesy > 0
    row = run_case(Case(method=TOY + "straight", item="1"), scenes)
    mine = protocol.measure(task, named(TOY + "straight"), seed=1)
    assert all(row[k] == v or v != v for k, v in mine.items() if k not in protocol.TIMED)
    assert code_label(scenes, ["TDWA"])["parameters"]["protocol"] == protocol.PROTOCOL


# --- the report ---------------------------------------------------------------------------------


def table_of(endings, ratio=1.0):
    n = len(endings)
    columns = dict.fromkeys(("time", "length", "clearance", "optimum", *protocol.TIMED), np.arange(1.0, n + 1))
    texts = {"method": "m", "group": "all", "reason": "", "status": "s"}
    return pd.DataFrame({"case": [f"c{k}" for k in range(n)], "item": list(map(str, range(n))), "ending": endings,
                         "ratio": ratio, **texts, **columns})  # fmt: skip


def test_worst_cases_are_contacts_then_lateness_then_detours():
    table = table_of(
        ["reached", "late", "unsolvable", "struck", "failed", "hit", "reached"], [1.1, 0.2, 1, 1, 1, 1, 1.9]
    )
    assert worst_cases(table, 5)["case"].tolist() == ["c5", "c3", "c1", "c6", "c0"]
    assert worst_cases(table, 1)["case"].tolist() == ["c5"]


def test_texts_of_the_reader_are_not_taken_for_markup():
    table = table_of(["failed", "failed"]).assign(reason="ValueError: <script>alert(1)</script>", time=np.nan)
    found = Comparison(
        tasks=TaskSet(), methods=("TDWA",), table=table.assign(method="TDWA"), command="<i>&", step_limit=1.0
    )
    text = page(found)
    assert "<script>alert" not in text and "<i>&" not in text
    assert "&lt;script&gt;alert(1)" in text


def test_a_player_holds_the_run_in_little_room():
    movers = tuple(Mover.constant([10.0, k - 10.0], [-0.1, 0.0], 0.4) for k in range(24))
    base = scene_task(3)
    task = replace(base, world=World(grid=base.world.grid, movers=movers), start=[1.5, 1.5, 0.0], optimum=np.nan)
    run = protocol.drive(replace(task, t_max=30.0), named(TOY + "straight")).run
    text = player_html(run, task.world, "a & b")
    shown = json.loads(re.search(r'<script type="application/json">(.*?)</script>', text).group(1))
    assert len(text) < 60_000
    assert "a &amp; b" in text
    assert len(shown["poses"]) == len(shown["times"]) == len(shown["movers"]) == min(FRAMES, len(run.t))
    assert shown["poses"][-1] == pytest.approx(run.poses[-1], abs=1e-3)
    assert shown["movers"][0][5] == [10.0, -5.0]
    assert shown["box"] == [0.0, 20.0, 0.0, 20.0]


# --- guests -------------------------------------------------------------------------------------

needs_guests = pytest.mark.skipif(importlib.util.find_spec("navground") is None, reason="navground is not installed")


@needs_guests
@pytest.mark.parametrize("name", ["ORCA", "HL", "HRVO"])
def test_a_guest_drives_round_a_mover_that_it_is_told_of(name):
    base = scene_task(3)
    coming = World(movers=(Mover.constant([8.0, 0.0], [-0.5, 0.0], 0.5),), discs=[[4.0, -3.0, 0.5]])
    task = replace(
        base, world=coming, start=[0.0, 0.0, 0.0], goal=[10.0, 0.0], chart=None, optimum=10.0, ideal=True, t_max=60.0
    )
    row = protocol.measure(task, named(name))
    assert row["ending"] == "reached"
    assert row["clearance"] > 0.02
    blind = protocol.measure(task, named(TOY + "straight"))
    assert blind["ending"] == "hit"
    again = protocol.measure(task, named(name))
    assert (row["length"], row["steps"]) == (again["length"], again["steps"])


def test_a_guest_that_is_not_told_says_so():
    row = protocol.measure(replace(scene_task(3), ideal=False), named("HRVO"))
    assert row["reason"] == "ValueError: HRVO must be told where the movers are: ask for ideal tracking"


def test_a_guest_that_is_not_installed_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "navground.core", None)
    row = protocol.measure(replace(scene_task(3), ideal=True), named("HL"))
    assert row["reason"] == "ValueError: HL is a guest from navground: pip install navground"
