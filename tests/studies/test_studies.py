"""Every stored result comes out again, a falsified one is found, and a study is made when it must be, not otherwise."""

import math
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from fuzzynav import batch
from fuzzynav.data import folder
from fuzzynav.studies import __main__ as program
from fuzzynav.studies import study as machine
from fuzzynav.studies.study import Study

STUDIES = {study.name: study for study in program.studies()}
NOT_STUDIES = {"bench"}


def count_of(study: Study) -> int:
    return 1 if study.name == "dwa_tuning" else 3  # two seconds a case


def test_every_file_of_results_belongs_to_a_study() -> None:
    assert {p.stem for p in folder("results").glob("*.csv")} == set(STUDIES) | NOT_STUDIES


@pytest.mark.parametrize("name", STUDIES)
def test_a_file_is_current(name: str) -> None:
    """If code changed and results did not: `python -m fuzzynav.studies --accept`; else `make reproduce`."""
    assert machine.state(STUDIES[name]) == "current"


@pytest.mark.parametrize("name", STUDIES)
def test_a_sample_of_rows_comes_out_again(name: str) -> None:
    study = STUDIES[name]
    assert not machine.differences(study, count_of(study))


def false(value: object, timed: bool) -> object:
    if isinstance(value, str):
        return value + "x"
    if timed:
        return value * 1000.0
    return 1.0 if math.isnan(value) else value * 1.5 + 1


@pytest.mark.parametrize("name", STUDIES)
def test_a_falsified_row_is_found(name: str, tmp_path: Path) -> None:
    """In every column of a sampled row by recomputing it, in any other row by the checksum."""
    study = STUDIES[name]
    path = machine.path_of(study, tmp_path)
    shutil.copy(machine.path_of(study), path)
    stored = batch.sheet_of(path)
    case, _ = machine.sample(study, stored.rows, 1)[0]
    stored.rows = {case: stored.rows[case]}
    batch.write_whole(path, batch.encoded(stored, closed=True))
    which = machine.sample(study, stored.rows, 1)[0][1]
    made = study.experiment(case) if study.row is None else study.row(case, which)
    again = replace(study, experiment=lambda _: made, row=None if study.row is None else lambda *_: made)
    assert not machine.differences(again, 1, place=tmp_path)
    row = stored.rows[case][which]
    for column, value in dict(row).items():
        row[column] = false(value, column in study.timed)
        batch.write_whole(path, batch.encoded(stored, closed=True))
        found = machine.differences(again, 1, place=tmp_path)
        assert len(found) == 1 and f"{column} is stored as" in found[0], found
        row[column] = value
    shutil.copy(machine.path_of(study), path)
    lines = path.read_bytes().decode().splitlines(keepends=True)
    middle = len(lines) // 2
    digits = [k for k, c in enumerate(lines[middle]) if c.isdigit()]
    k = digits[len(digits) // 2]
    lines[middle] = lines[middle][:k] + str((int(lines[middle][k]) + 1) % 10) + lines[middle][k + 1 :]
    path.write_bytes("".join(lines).encode())
    assert "changed by hand" in machine.state(study, tmp_path)


# --- the machinery, on a small study ---------------------------------------------------------------

GAIN = [1.0]
SEEN: list[str] = []


def small(case: object) -> dict[str, object]:
    SEEN.append(str(case))
    if GAIN[0] < 0 and int(str(case)) == 3:
        raise KeyboardInterrupt
    return {"name": f"0.{case}0", "value": abs(GAIN[0]) * int(str(case))}


@pytest.fixture
def study(monkeypatch: pytest.MonkeyPatch) -> Study:
    GAIN[0] = 1.0
    SEEN.clear()
    made = Study(name="small", experiment=small, cases=range(5), parameters={"n": 5})
    code = {"code": "one"}
    monkeypatch.setattr(machine.batch, "code_of", lambda module, name: code["code"])
    monkeypatch.setattr(machine, "CODE", code, raising=False)
    return made


def test_a_study_is_run_once(study: Study, tmp_path: Path) -> None:
    assert machine.state(study, tmp_path) == "missing"
    machine.run(study, place=tmp_path)
    data = (tmp_path / "small.csv").read_bytes()
    assert machine.state(study, tmp_path) == "current"
    assert machine.run(study, place=tmp_path) == 0
    assert SEEN == list("01234")
    assert (tmp_path / "small.csv").read_bytes() == data
    assert b'"study": "small", "parameters": {"n": 5}, "inputs": {}, "code": "one"' in data
    assert b"\n1,0.10,1.0,1\n" in data


def test_more_cases_are_added(study: Study, tmp_path: Path) -> None:
    machine.run(study, place=tmp_path)
    more = replace(study, cases=range(7))
    assert machine.state(more, tmp_path) == "unfinished"
    machine.run(more, place=tmp_path)
    assert SEEN == list("0123456")
    assert machine.state(more, tmp_path) == "current"


def test_other_code_or_parameters_make_a_file_stale(study: Study, tmp_path: Path) -> None:
    machine.run(study, place=tmp_path)
    assert "n = 5, this is with n = 6" in machine.state(replace(study, parameters={"n": 6}), tmp_path)
    assert "fuzzy/none.fll" in machine.state(replace(study, inputs=("fuzzy/none.fll",)), tmp_path)
    machine.CODE["code"] = "two"
    assert "made by other code than small" in machine.state(study, tmp_path)
    GAIN[0] = 2.0
    assert machine.run(study, place=tmp_path) == 4  # of five rows; 2 times 0 is 0
    assert machine.state(study, tmp_path) == "current"
    assert batch.read(tmp_path / "small.csv")["value"].tolist() == [0.0, 2.0, 4.0, 6.0, 8.0]


def test_an_interrupted_new_edition_goes_on_and_the_old_one_stays(study: Study, tmp_path: Path) -> None:
    machine.run(study, place=tmp_path)
    old = (tmp_path / "small.csv").read_bytes()
    SEEN.clear()
    GAIN[0] = -2.0
    with pytest.raises(KeyboardInterrupt):
        machine.run(study, fresh=True, place=tmp_path)
    assert (tmp_path / "small.csv").read_bytes() == old
    GAIN[0] = 2.0
    machine.run(study, fresh=True, place=tmp_path)
    assert SEEN == list("01234")[:4] + ["3", "4"]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["small.csv"]


def test_a_new_edition_begun_with_other_code_is_begun_again(study: Study, tmp_path: Path) -> None:
    machine.run(study, place=tmp_path)
    GAIN[0] = -2.0
    with pytest.raises(KeyboardInterrupt):
        machine.run(study, fresh=True, place=tmp_path)
    machine.CODE["code"] = "two"
    GAIN[0] = 3.0
    assert machine.run(study, place=tmp_path) == 4
    assert batch.read(tmp_path / "small.csv")["value"].tolist() == [0.0, 3.0, 6.0, 9.0, 12.0]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["small.csv"]


def test_a_refactoring_is_accepted_and_a_change_is_not(study: Study, tmp_path: Path) -> None:
    machine.run(study, place=tmp_path)
    machine.CODE["code"] = "two"
    GAIN[0] = 1.0 + 1e-12
    assert not machine.differences(study, 5, place=tmp_path)
    assert len(machine.accept(study, 5, tmp_path)) == 4
    assert "other code" in machine.state(study, tmp_path)
    GAIN[0] = 1.0
    assert machine.accept(study, 5, tmp_path) == []
    assert machine.state(study, tmp_path) == "current"
    path = tmp_path / "small.csv"
    path.write_bytes(path.read_bytes().replace(b"3.0", b"3.5"))
    with pytest.raises(ValueError, match=r"small cannot be taken over: small\.csv was changed by hand"):
        machine.accept(study, 5, tmp_path)


def test_a_number_counts_as_the_same_within_the_tolerance_only(study: Study, tmp_path: Path) -> None:
    machine.run(study, place=tmp_path)
    for gain, unlike in ((1.0005, 0), (1.02, 4), (0.5, 4)):  # of the values 0 to 4, to a thousandth
        GAIN[0] = gain
        assert len(machine.differences(study, 5, place=tmp_path)) == unlike


def test_one_command_for_all_of_it(study: Study, tmp_path: Path, monkeypatch, capsys) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(program, "studies", lambda: (study,))
    monkeypatch.setattr(machine, "folder", lambda name: tmp_path)
    monkeypatch.setattr(program, "folder", lambda name: tmp_path)
    assert program.main(["chess"]) == 2
    assert program.main(["small", "--processes", "1"]) == 0
    assert program.main(["--processes", "1"]) == 0
    assert SEEN == list("01234")
    assert program.main(["--fresh", "--processes", "1"]) == 0
    assert SEEN == list("0123401234")
    assert program.main(["--check"]) == 0
    GAIN[0] = 3.0
    assert program.main(["--check", "--rows", "5"]) == 1
    said = capsys.readouterr().out
    assert "small: missing\nsmall: done\nsmall: current\nsmall: made anew\nsmall: done\n" in said
    assert "value is stored as 1.0; 3.0 comes out" in said
    assert sorted(p.name for p in tmp_path.iterdir()) == ["small.csv"]


def test_a_fresh_run_that_was_interrupted_skips_what_it_made(tmp_path: Path, study: Study, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    other = replace(study, name="other")
    monkeypatch.setattr(program, "studies", lambda: (study, other))
    monkeypatch.setattr(machine, "folder", lambda name: tmp_path)
    monkeypatch.setattr(program, "folder", lambda name: tmp_path)
    program.main(["--processes", "1"])
    (tmp_path / ".made_anew").write_text("small\n")
    SEEN.clear()
    program.main(["--fresh", "--processes", "1"])
    assert SEEN == list("01234")  # of the other one only
    assert not (tmp_path / ".made_anew").exists()
