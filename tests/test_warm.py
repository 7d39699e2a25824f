"""What a reader changes is what runs: compiled kernels are forgotten when a source changes."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from fuzzynav import stale

KERNEL = "from numba import njit\nstep = {}\n"
COMPILED = "outer.run-1.py311.nbi"


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package of two rooms: a kernel's file, a file of constants, and what numba kept for the second room."""
    package = tmp_path / "package"
    (package / "room" / "__pycache__").mkdir(parents=True)
    (package / "inner.py").write_text(KERNEL.format(1))
    (package / "room" / "plain.py").write_text(
        '"""Text."""\n\nHALF = (\n    0.5,\n    2,\n)\n\n\ndef f():\n    return 1\n'
    )
    assert not stale.forget_stale(package)
    (package / "room" / "__pycache__" / COMPILED).write_bytes(b"old")
    return package


def kept(package: Path) -> bool:
    return (package / "room" / "__pycache__" / COMPILED).exists()


def change(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_nothing_changed_forgets_nothing(package: Path) -> None:
    assert not stale.forget_stale(package)
    assert kept(package)


def test_a_changed_kernel_forgets_the_compiled_ones_of_every_room(package: Path) -> None:
    change(package / "inner.py", "step = 1", "step = 2")
    assert stale.forget_stale(package)
    assert not kept(package)
    assert not stale.forget_stale(package)


def test_a_constant_that_a_kernel_may_hold_counts_and_plain_code_does_not(package: Path) -> None:
    change(package / "room" / "plain.py", "return 1", "return 2")
    assert not stale.forget_stale(package)
    change(package / "room" / "plain.py", "    2,", "    3,")
    assert stale.forget_stale(package)


@pytest.mark.parametrize(
    "source",
    ["A = 1", "A: int = 1", "(\n    A,\n    B,\n) = range(1)", "class R(NamedTuple):\n    '''x'''\n\n    a: int = 1"],
)
def test_constants_are_found_in_every_form(tmp_path: Path, source: str) -> None:
    file = tmp_path / "a.py"
    file.write_text(f'"""Text."""\n\n{source}\n\n\nprint(7)\n')
    before = stale.kernel_digest(tmp_path)
    change(file, "7", "8")
    assert stale.kernel_digest(tmp_path) == before
    change(file, "1", "2")
    assert stale.kernel_digest(tmp_path) != before


ELSEWHERE = ["NUMBA_CACHE_DIR", *(["XDG_CACHE_HOME"] if sys.platform == "linux" else [])]


@pytest.mark.parametrize("variable", ELSEWHERE)
def test_kernels_kept_elsewhere_are_forgotten_there(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, variable: str
) -> None:
    from numba.core import caching

    elsewhere = tmp_path / "elsewhere"
    monkeypatch.setenv(variable, str(elsewhere))
    monkeypatch.setattr(os, "access", lambda *_: False)  # an installation that this user cannot write
    numba = elsewhere if variable == "NUMBA_CACHE_DIR" else elsewhere / "numba"
    name = caching._CacheLocator.get_suitable_cache_subpath(str(package / "room" / "plain.py"))
    (numba / name).mkdir(parents=True)
    (numba / name / COMPILED).write_bytes(b"old")
    assert stale.forget_stale(package)
    assert not (numba / name / COMPILED).exists()
    assert kept(package)


def test_a_folder_that_cannot_be_written_is_no_failure(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(package / "inner.py"))  # a file, so nothing can be kept in it
    assert not stale.forget_stale(package)


PROBE = """
import numpy as np
from fuzzynav import blend, tracking
from fuzzynav.tracking.reference import FigureEight
way = lambda run: float(np.hypot(*np.diff(run.poses[:, :2], axis=0).T).sum())
eight, far_away = FigureEight(), [40.0, 0.0, 0.2, 0.3, 0.0]
tracker = tracking.Tracker(eight, tracking.Dfl())
print(way(tracking.follow(tracker)), way(blend.drive(blend.SafeScheme(), far_away, reference=eight)))
"""


def test_a_kernel_changed_in_a_copy_changes_every_caller(home: Path, tmp_path: Path) -> None:
    def probe() -> list[float]:
        done = subprocess.run(
            [sys.executable, "-c", PROBE],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(tmp_path)},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return [float(word) for word in done.stdout.split()]

    shutil.copytree(home / "fuzzynav", tmp_path / "fuzzynav")
    shutil.copytree(home / "data", tmp_path / "data", ignore=shutil.ignore_patterns("results", "logs"))
    before = probe()
    for path in (tmp_path / "fuzzynav").rglob("kernels.py"):
        path.write_text(re.sub(r"return (min\(max\(value, low\), high\))", r"return 0.5 * \1", path.read_text()))
    after = probe()
    assert all(new < 0.8 * old for old, new in zip(before, after, strict=True)), (before, after)
