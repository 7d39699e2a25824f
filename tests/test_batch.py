"""A sweep gives one table, whatever runs it and however often it is interrupted, and never another one's rows."""

import functools
import importlib.util
import io
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav import batch
from fuzzynav.batch import source
from fuzzynav.batch.__main__ import main

CASES = range(37)
SEEN: list[int] = []
INSIDE, LEAVE = threading.Event(), threading.Event()


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


def counted(seed: int) -> dict[str, object]:
    SEEN.append(seed)
    return {"success": True}


def scaled(seed: int, factor: float = 1.0) -> dict[str, object]:
    return {"value": factor * seed}


def dies_at_three(seed: int) -> dict[str, object]:
    if seed == 3:
        os._exit(1)
    return {"value": seed}


def dies_once(seed: int, folder: str = "") -> dict[str, object]:
    mark = Path(folder) / str(seed)
    if seed == 5 and not mark.exists():
        mark.touch()
        os._exit(1)
    return {"value": seed}


def slow(seed: int) -> dict[str, object]:
    INSIDE.set()
    LEAVE.wait(30)
    return {"value": seed}


# --- one table -----------------------------------------------------------------------------------


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


def odd(seed: int) -> dict[str, object]:
    return {
        "text": f"'{seed}',\r\n\"ä\" # {seed}\n",
        "n": 2**70 + seed,
        "m": 2**60 + seed if seed % 2 else float("nan"),
    }


@settings(max_examples=40, deadline=None)
@given(cut=st.integers(0, 1000))
def test_texts_with_line_ends_survive_a_cut(cut: int, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("cut") / "sweep.csv"
    whole = batch.run(odd, range(9), path=path, progress=False)
    data = path.read_bytes()
    path.write_bytes(data[: max(data.index(b"\n") + 1, cut)])
    pd.testing.assert_frame_equal(batch.run(odd, range(9), path=path, progress=False), whole)
    assert path.read_bytes() == data
    assert batch.read(path)["n"].tolist() == [2**70 + k for k in range(9)]
    assert [str(m) for m in batch.read(path)["m"]] == [str(2**60 + k) if k % 2 else "nan" for k in range(9)]


VALUES = st.one_of(
    st.text(st.characters(exclude_categories=["Cs"]), max_size=12),
    st.sampled_from(
        ["", "007", "7", "NA", "nan", "None", "#", "a#b", "a\nb", "a\r\n", '"', "'", "''=1", "=1+1", "@x", "-3"]
    ),
)


@settings(max_examples=200, deadline=None)
@given(
    rows=st.lists(
        st.tuples(VALUES, VALUES, st.one_of(st.integers(-(2**90), 2**90), st.floats())), min_size=1, max_size=6
    )
)
def test_every_value_survives_the_file_exactly(rows: list, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("exact") / "sweep.csv"
    cases = list(dict.fromkeys(case for case, _, _ in rows))
    given = {case: [(text, number) for c, text, number in rows if c == case] for case in cases}

    def experiment(case: str) -> list[dict[str, object]]:
        return [{"text": text, "number": number} for text, number in given[case]]

    table = batch.run(experiment, cases, path=path, progress=False)
    back = batch.read(path)
    pd.testing.assert_frame_equal(back, table)
    flat = [(case, text, number) for case in cases for text, number in given[case]]
    assert back["case"].tolist() == [case for case, _, _ in flat]
    assert back["text"].tolist() == [text for _, text, _ in flat]
    for stored, (_, _, number) in zip(back["number"].tolist(), flat):
        assert repr(stored) == repr(number) or stored == number, (stored, number)
    kept = batch.sheet_of(path).rows
    assert [repr(row["number"]) for case in cases for row in kept[case]] == [repr(n) for _, _, n in flat]


def test_no_program_finds_a_formula_in_the_file(tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    batch.run(lambda case: {"text": case}, ["=1+1", "+1", "-1", "@A1", "\t=1"], path=path, progress=False)
    for line in path.read_text().splitlines()[2:]:
        assert all(cell[0] not in "=+-@\t" for cell in line.split(","))
    assert batch.read(path)["text"].tolist() == ["=1+1", "+1", "-1", "@A1", "\t=1"]


# --- a file takes more cases, and nothing else -----------------------------------------------------


def test_done_cases_are_not_run_again(tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    SEEN.clear()
    batch.run(counted, range(5), path=path, progress=False)
    batch.run(counted, range(8), path=path, progress=False)
    assert list(range(8)) == SEEN


def test_another_set_of_seeds_adds_to_the_file(tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    batch.run(scaled, range(100), path=path, progress=False)
    text = path.read_text()
    assert len(batch.run(scaled, range(10), path=path, progress=False)) == 10
    assert path.read_text() == text
    other = tmp_path / "other.csv"
    batch.run(scaled, range(10), path=other, progress=False)
    assert batch.run(scaled, range(5, 15), path=other, progress=False)["case"].tolist() == [
        str(k) for k in range(5, 15)
    ]
    assert batch.read(other)["case"].tolist() == [str(k) for k in range(15)]


@dataclass
class Drive:
    speed: float

    def __call__(self, seed: int) -> dict[str, object]:
        return {"value": self.speed * seed}


class Held:
    def __init__(self, speed: float) -> None:
        self.speed = speed

    def drive(self, seed: int) -> dict[str, object]:
        return {"value": self.speed * seed}


def closure(speed: float) -> Callable[[int], dict[str, object]]:
    return lambda seed: {"value": speed * seed}


PAIRS = {
    "partial": (
        functools.partial(scaled, factor=0.1),
        functools.partial(scaled, factor=0.2),
        "factor = 0.1.*factor = 0.2",
    ),
    "default": (functools.partial(scaled, factor=2.0), scaled, "factor = 2.0, this is with factor = 1.0"),
    "closure": (closure(0.1), closure(0.2), "speed = 0.1, this is with speed = 0.2"),
    "object": (Drive(0.1), Drive(0.2), "speed = 0.1, this is with speed = 0.2"),
    "method": (Held(0.1).drive, Held(0.2).drive, "speed = 0.1, this is with speed = 0.2"),
    "array": (
        functools.partial(scaled, factor=np.arange(3000.0)),
        functools.partial(scaled, factor=np.where(np.arange(3000) == 1500, 7.0, np.arange(3000.0))),
        "was made with factor = array",
    ),
    "function": (
        functools.partial(scaled, factor=closure(1.0)),
        functools.partial(scaled, factor=closure(2.0)),
        "factor",
    ),
    "experiment": (scaled, counted, "does not hold results of .*counted, but of .*scaled"),
}


@pytest.mark.parametrize("kind", PAIRS)
def test_another_parameter_or_experiment_is_refused_by_name(kind: str, tmp_path: Path) -> None:
    first, second, says = PAIRS[kind]
    path = tmp_path / "sweep.csv"
    label = batch.label_of(first)
    batch.run(lambda seed: {"value": seed}, range(3), path=path, label=label, progress=False)
    before = path.read_bytes()
    with pytest.raises(ValueError, match=says):
        batch.run(second, range(3), path=path, progress=False)
    assert path.read_bytes() == before
    assert batch.label_of(first) == label


def in_a_notebook(text: str) -> Callable[[int], dict[str, object]]:
    names: dict[str, object] = {"__name__": "__main__"}
    exec(text, names)
    return names["experiment"]


def test_other_code_is_refused(tmp_path: Path) -> None:
    """Functions of a notebook: their code, what they read and what they call."""
    path = tmp_path / "sweep.csv"
    cell = "SPEED = 0.3\ndef twice(x): return 2 * x\ndef experiment(seed): return {'value': twice(SPEED) * seed}"
    batch.run(in_a_notebook(cell), range(3), path=path, progress=False)
    batch.run(in_a_notebook(cell), range(4), path=path, progress=False)
    for old, new, says in (
        ("0.3", "0.4", "SPEED = 0.3, this is with SPEED = 0.4"),
        ("2 * x", "3 * x", "with twice ="),
        ("* seed}", "+ seed}", "other code"),
    ):
        with pytest.raises(ValueError, match=says):
            batch.run(in_a_notebook(cell.replace(old, new)), range(3), path=path, progress=False)


def test_a_parameter_that_prints_a_place_in_memory_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"factor prints as <object object at 0x.*place in memory"):
        batch.run(functools.partial(scaled, factor=object()), range(2), path=tmp_path / "a.csv", progress=False)


# --- the code behind a function --------------------------------------------------------------------

KERNEL = '''
"""A module."""
from demo_{n} import helper
GAIN = 0.5
def unused():
    return 3
def experiment(seed: int) -> dict:
    """Words."""
    if seed < 0:
        raise ValueError(f"not {{seed}}")
    return {{"value": helper.twice(GAIN * seed)}}
'''
HELPER = "FACTOR = 2\ndef twice(x):\n    # a comment\n    return FACTOR * x\n"


@pytest.mark.parametrize(
    ("change", "same"),
    [
        (("kernel", "GAIN = 0.5", "GAIN = 0.6"), False),
        (("helper", "FACTOR = 2", "FACTOR = 3"), False),
        (("helper", "FACTOR * x", "-FACTOR * x"), False),
        (("kernel", "seed < 0", "seed <= 0"), False),
        (("helper", "# a comment", "# another"), True),
        (("kernel", "Words.", "Other words."), True),
        (("kernel", "seed: int", "seed: float"), True),
        (("kernel", "not {seed}", "never {seed}"), True),
        (("kernel", "return 3", "return 4"), True),
        (("kernel", "GAIN * seed", "GAIN*seed"), True),
    ],
)
def test_code_is_told_by_what_it_computes(
    change: tuple, same: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    name = f"demo_{abs(hash(str(tmp_path)))}"
    folder = tmp_path / name
    folder.mkdir()
    texts = {"kernel": KERNEL.format(n=name.removeprefix("demo_")), "helper": HELPER}
    (folder / "__init__.py").touch()
    for which, text in texts.items():
        (folder / f"{which}.py").write_text(text)
    before = source.code_of(f"{name}.kernel", "experiment")
    which, old, new = change
    assert old in texts[which]
    (folder / f"{which}.py").write_text(texts[which].replace(old, new))
    os.utime(folder / f"{which}.py", ns=(1, time.time_ns()))
    assert (source.code_of(f"{name}.kernel", "experiment") == before) is same


def test_a_moved_definition_is_the_same_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    first, second = tmp_path / "demo_first.py", tmp_path / "demo_second"
    first.write_text(
        "FACTOR = 2\ndef twice(x):\n    return FACTOR * x\ndef experiment(seed):\n    return twice(seed)\n"
    )
    second.mkdir()
    (second / "__init__.py").write_text("from demo_second.deep import twice\n")
    (second / "deep.py").write_text("FACTOR = 2\ndef twice(x):\n    return FACTOR * x\n")
    (second / "top.py").write_text("import demo_second as d\ndef experiment(seed):\n    return d.twice(seed)\n")
    assert source.code_of("demo_first", "experiment") == source.code_of("demo_second.top", "experiment")


def test_code_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="no definition nothing"):
        source.code_of("fuzzynav.geometry", "nothing")


# --- nothing is lost -------------------------------------------------------------------------------


def test_a_failing_case_is_named_and_costs_no_other(tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    with pytest.raises(RuntimeError, match=r"1 of 6 cases failed; the first, 3: ValueError: three is not my number"):
        batch.run(fails_at_three, range(6), path=path, progress=False)
    assert batch.read(path)["square"].tolist() == [0, 1, 4, 16, 25]


def test_a_case_that_kills_its_worker_is_named_and_costs_no_other(tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    with (
        ProcessPoolExecutor(2) as pool,
        pytest.raises(RuntimeError, match=r"1 of 20 cases failed; the first, 3: Broken"),
    ):
        batch.run(dies_at_three, range(20), executor=pool, path=path, chunk=4, progress=False)
    assert sorted(batch.read(path)["value"]) == [k for k in range(20) if k != 3]


def test_a_worker_that_dies_once_costs_nothing(tmp_path: Path) -> None:
    experiment = functools.partial(dies_once, folder=str(tmp_path))
    with ProcessPoolExecutor(2) as pool:
        table = batch.run(experiment, range(12), executor=pool, chunk=3, progress=False)
    assert table["value"].tolist() == list(range(12))


class Forgetful(ThreadPoolExecutor):
    """Loses the first job it is given, as a cluster that restarts a machine."""

    lost = False

    def submit(self, work, /, *arguments):  # type: ignore[no-untyped-def]
        if not self.lost:
            self.lost = True
            return super().submit(self._lose)
        return super().submit(work, *arguments)

    @staticmethod
    def _lose() -> None:
        raise ConnectionError("the machine went away")


def test_what_another_executor_loses_is_asked_for_again() -> None:
    with Forgetful(2) as pool:
        assert batch.run(fails_at_three, [0, 1, 2, 5], executor=pool, chunk=2, progress=False)["square"].tolist() == [
            0,
            1,
            4,
            25,
        ]


def test_what_waits_is_cancelled_when_a_sweep_ends_early() -> None:
    def experiment(seed: int) -> dict[str, object]:
        SEEN.append(seed)
        time.sleep(0.01)
        return {"value": None}

    SEEN.clear()
    with ThreadPoolExecutor(1) as pool, pytest.raises(ValueError, match="column 'value' holds NoneType 'None'"):
        batch.run(experiment, range(300), executor=pool, chunk=1, progress=False)
    assert len(SEEN) < 100


def test_a_second_writer_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    first = threading.Thread(target=lambda: batch.run(slow, range(2), path=path, progress=False))
    first.start()
    try:
        assert INSIDE.wait(30)
        with pytest.raises(ValueError, match="being written by another sweep"):
            batch.run(scaled, range(2), path=path, progress=False)
        program = (
            "from pathlib import Path; from fuzzynav.batch.writer import only_writer\n"
            f"with only_writer(Path({str(path)!r})): print('in')"
        )
        other = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        assert "being written by another sweep" in other.stderr
        assert "in" not in other.stdout
    finally:
        LEAVE.set()
        first.join()
    assert batch.read(path)["value"].tolist() == [0, 1]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["sweep.csv"]


def test_a_killed_writer_leaves_no_lock(tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    program = (
        "import os; from pathlib import Path; from fuzzynav.batch.writer import only_writer\n"
        f"with only_writer(Path({str(path)!r})): os._exit(1)"
    )
    subprocess.run([sys.executable, "-c", program], check=False)
    assert path.with_name("sweep.csv.lock").exists()
    assert len(batch.run(scaled, range(3), path=path, progress=False)) == 3


# --- refusals --------------------------------------------------------------------------------------


def test_refusals(tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    batch.run(walk, range(2), path=path, progress=False)
    with pytest.raises(ValueError, match="no cases"):
        batch.run(walk, [], progress=False)
    with pytest.raises(ValueError, match="print alike"):
        batch.run(walk, [1, 1], progress=False)
    with pytest.raises(ValueError, match="chunk must be at least 1"):
        batch.run(walk, [1], chunk=0, progress=False)
    with pytest.raises(ValueError, match="prints a place in memory"):
        batch.run(walk, [object()], progress=False)
    with pytest.raises(FileNotFoundError, match="make reproduce"):
        batch.read(tmp_path / "none.csv")
    with pytest.raises(ValueError, match="no column 'speed'"):
        batch.summary(batch.run(walk, range(2), progress=False), "method", ["speed"])


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        ([], "no row for case 0"),
        ({}, "a row has no column"),
        ({"case": 1}, "a row has a column 'case'"),
        ({"complete": 1}, "a row has a column 'complete'"),
        ({"=a": 1}, "a row has a column '=a'"),
        ([{"a": 1}, {"b": 1}], r"case 0 has columns \['b'\], the earlier ones \['a'\]"),
        ([{"a": 1}, {"a": "1"}], "column 'a' holds a text here and numbers before"),
        ([{"a": "x"}, {"a": 1}], "column 'a' holds a number here and texts before"),
        ({"a": [1]}, "column 'a' holds list"),
        ({"a": "\ud800"}, "half a character"),
        ({"a": 10**4000}, "column 'a' holds int"),
    ],
)
def test_rows_that_a_table_cannot_hold_are_refused(rows: object, says: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=says):
        batch.run(lambda seed: rows, [0], path=tmp_path / "sweep.csv", progress=False)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("case,a,complete\n0,1,1\n", "does not begin with the line"),
        ("", "does not begin with the line"),
        ('# {"text": []}\ncase,a,complete\n0,1\n1,2,1\n', "line 3: 3 fields are needed, found 2"),
        (b'# {"text": []}\n\xff\xff\xff\xff\xff', "byte 15 is not UTF-8"),
    ],
)
def test_files_that_are_no_sweeps_are_refused(text: str | bytes, says: str, tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ValueError, match=says):
        batch.read(path)


# --- what a sweep comes to ---------------------------------------------------------------------------


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
    assert main(["fuzzynav.batch:nothing", "--out", str(out)]) == 2
    assert "there is no experiment fuzzynav.batch:nothing" in capsys.readouterr().err
    assert main(["collections:Counter", "--seeds", "0"]) == 2
    assert not out.exists()
    assert main(["fuzzynav.studies.planning.random_maps:one_map", "--seeds", "x:y"]) == 2
