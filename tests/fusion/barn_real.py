"""The real files of BARN and DynaBARN, by hand: `BARN_FOLDER=... pytest tests/fusion/barn_real.py`."""

import os

import pandas as pd

from fuzzynav.fusion import barn


def _folder() -> str:
    """Where the files are."""
    return os.environ["BARN_FOLDER"]


def test_the_published_file_contradicts_what_is_promised_beside_it():
    found = barn.outcome(barn.published_runs(_folder()))
    assert {k: round(v, 4) for k, v in found.items()} == {
        "success": 0.85, "contact": 0.056, "late": 0.094, "metric": 0.1586}  # fmt: skip
    assert found["success"] < barn.DWA_AS_PROMISED["success"]
    assert found["metric"] < barn.DWA_AS_PROMISED["metric"]


def test_every_world_of_the_benchmark_can_begin():
    discs = sum(len(barn.static_task(_folder(), n).world.discs) for n in range(300))
    assert discs == 78_925
    movers = 0
    for n in range(60):
        tasks = [barn.dynamic_task(_folder(), n, phase) for phase in range(barn.PHASES)]
        assert [t.name.split("from ")[1] for t in tasks] == [
            f"{3.0 * k:.1f} s" for k in range(10)
        ]  # no start is touched
        assert 0.85 < tasks[0].speed_bound < 2.0
        movers += len(tasks[0].world.movers)
    assert movers == 963
    assert isinstance(barn.published_runs(_folder()), pd.DataFrame)
