"""A sweep gives one table, whatever runs it and however often it is interrupted."""

import importlib.util
import io
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav import batch

CASES = range(37)


def walk(seed: int) -> list[dict[str, object]]:
    """Two rows a case, with a text, a truth value and numbers that are not short in decimal."""
    rng = np.random.default_rng(seed)
    return [
        {
            "method": name,
            "success": bool(rng.random() < 0.7),
            "length": float(rng.normal(10 + k, 1)),
            "turns": int(rng.integers(9)),
        }
        for k, name in enumerate(("long", "short, and with a comma"))
    ]


def fails_at_three(seed: int) -> dict[str, object]:
    if seed == 3:
        raise ValueError("three is not my number")
    return {"success": True, "square": seed**2}


def test_processes_dask_and_one_core_agree(tmp_path: Path) -> None:
    alone = batch.run(walk, CASES, progress=False)
    with ProcessPoolExecutor(2) as pool:
        table = batch.run(walk, CASES, executor=pool, path=tmp_path / "p.csv", progress=False)
    pd.testing.assert_frame_equal(table, alone)
    pd.testing.assert_frame_equal(batch.read(tmp_path / "p.csv"), alone)


def test_two_dask_workers_give_the_same_table() -> None:
    program = Path(__file__).with_name("two_dask_workers.py")
    done = subprocess.run([sys.executable, str(program)], capture_output=True, text=True, timeout=240, check=True)
    workers, _, text = done.stdout.partition("\n")
    assert int(workers) == 2
    spec = importlib.util.spec_from_file_location("two_dask_workers", program)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    alone = batch.run(module.experiment, range(37), progress=False)
    pd.testing.assert_frame_equal(pd.read_csv(io.StringIO(text), dtype={"case": str}), alone)


@settings(max_examples=25, deadline=None)
@given(cut=st.integers(0, 3500))
def test_a_file_cut_anywhere_resumes_to_the_same_table(cut: int, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("cut") / "sweep.csv"
    whole = batch.run(walk, CASES, path=path, progress=False)
    text = path.read_text()
    header = text.index("\n") + 1
    path.write_text(text[: max(header, cut)])
    again = batch.run(walk, CASES, path=path, progress=False)
    pd.testing.assert_frame_equal(again, whole)
    assert path.read_text() == text


def test_done_cases_are_not_run_again(tmp_path: Path) -> None:
    path, seen = tmp_path / "sweep.csv", []

    def counted(seed: int) -> dict[str, object]:
        seen.append(seed)
        return {"success": True}

    batch.run(counted, range(5), path=path, progress=False)
    batch.run(counted, range(8), path=path, progress=False)
    assert seen == list(range(8))


def test_a_failing_case_is_named_and_costs_no_other(tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    with pytest.raises(RuntimeError, match=r"1 of 6 cases failed; the first, 3: ValueError: three is not my number"):
        batch.run(fails_at_three, range(6), path=path, progress=False)
    assert batch.read(path)["square"].tolist() == [0, 1, 4, 16, 25]


def test_refusals(tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    batch.run(walk, range(2), path=path, progress=False)
    with pytest.raises(ValueError, match="does not hold results of"):
        batch.run(fails_at_three, range(2), path=path, progress=False)
    with pytest.raises(ValueError, match="no cases"):
        batch.run(walk, [], progress=False)
    with pytest.raises(ValueError, match="print alike"):
        batch.run(walk, [1, 1], progress=False)
    with pytest.raises(FileNotFoundError, match="make reproduce"):
        batch.read(tmp_path / "none.csv")
    with pytest.raises(ValueError, match="no column 'speed'"):
        batch.summary(batch.run(walk, range(2), progress=False), "method", ["speed"])


def test_summary_and_pairs_recover_a_known_difference() -> None:
    table = batch.run(walk, range(400), progress=False)
    report = batch.summary(table, "method", ["length"]).set_index("method")
    assert report["runs"].tolist() == [400, 400]
    assert (report["low"] < 0.7).all()
    assert (report["high"] > 0.7).all()
    pairs = batch.paired(table, "method", "long", "short, and with a comma", "length")
    both = table.groupby("case")["success"].all().sum()
    assert pairs["pairs"] == both
    assert pairs["low"] < 1.0 < pairs["high"]
    assert pairs["high"] - pairs["low"] < 0.6


def test_command_line_writes_the_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "sweep.csv"
    assert batch.main(["fuzzynav.batch:nothing", "--out", str(out)]) == 2
    assert "there is no experiment fuzzynav.batch:nothing" in capsys.readouterr().err
    assert batch.main(["collections:Counter", "--seeds", "0"]) == 2
    assert not out.exists()
