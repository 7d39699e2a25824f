"""The built wheel, installed apart from the checkout: it finds its data, and asks for what it imports and no more."""

import importlib.metadata as metadata
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest
from packaging.requirements import Requirement

LIGHT = ("dwa", "tracking", "fuzzy", "blend", "simulate", "planning")
HEAVY = ("matplotlib", "IPython", "ipywidgets", "jupyterlab", "pandas", "skfuzzy", "networkx", "sympy")
WARM = 1.0  # [s] of processor time that a room may take to import once its kernels are compiled

USE = """
import numpy as np
from fuzzynav import blend, data, published, tracking
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.maps import GridMap
from fuzzynav.planning import astar
from fuzzynav.tracking.reference import FigureEight

assert data.folder("maps").parent.name == "_data", data.folder("maps")
print(len(FuzzySystem.load(data.folder("fuzzy") / "thesis_table_3_2.fll").rules))
print(astar.search(GridMap(np.zeros((5, 5), dtype=bool)), (0, 0), (4, 2)).status)
print(tracking.follow(tracking.Tracker(FigureEight(), tracking.Dfl()), duration=5.0).status)
print(len(published.claims()), "claims;", sorted(set(published.table("fuzzy")["verdict"])))
"""


def pip(*words: str) -> None:
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", *words]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="module")
def elsewhere(home: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The python of a fresh environment with the wheel; this one's packages stand beside it, the checkout does not."""
    folder = tmp_path_factory.mktemp("elsewhere")
    pip("wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", str(folder), str(home))
    (wheel,) = folder.glob("fuzzynav-*.whl")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder / "venv")], check=True)
    python = folder / "venv" / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    pip("--python", str(python), "install", "--quiet", "--no-deps", "--no-index", str(wheel))
    query = [str(python), "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"]
    site = Path(subprocess.run(query, capture_output=True, text=True, check=True).stdout.strip())
    (site / "borrowed.pth").write_text(sysconfig.get_path("purelib") + "\n")  # its own .pth files are not read
    for kept in (home / "fuzzynav").rglob("__pycache__/*.nb[ic]"):  # so that nothing is compiled twice
        target = site / kept.relative_to(home)
        target.parent.mkdir(exist_ok=True)
        shutil.copy2(kept, target)
    return python


def run(python: Path, source: str) -> str:
    # -I: neither the working folder nor PYTHONPATH counts
    command = [str(python), "-I", "-c", source]
    done = subprocess.run(command, cwd=python.parent, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def site_of(python: Path) -> Path:
    return Path(run(python, "import fuzzynav; print(fuzzynav.__file__)").strip()).parents[1]


def asked_for(site: Path) -> set[str]:
    """The distributions that the installed package needs without any extra, and what those need in turn."""

    def plain(name: str) -> str:
        return re.sub(r"[-_.]+", "-", name).lower()

    (own,) = metadata.distributions(name="fuzzynav", path=[str(site)])
    found: set[str] = set()
    open_ends = list(own.requires or [])
    while open_ends:
        requirement = Requirement(open_ends.pop())
        wanted = requirement.marker is None or requirement.marker.evaluate({"extra": ""})
        if wanted and plain(requirement.name) not in found:
            found.add(plain(requirement.name))
            open_ends += metadata.requires(requirement.name) or []
    return found


def test_the_wheel_finds_its_data_from_another_folder(elsewhere: Path, home: Path) -> None:
    assert home not in site_of(elsewhere).parents
    rules, path, loop, ledger = run(elsewhere, USE).splitlines()
    assert (int(rules), path) == (9, "reached")
    assert loop == "done"
    assert re.match(r"\d{3,} claims; \[.+\]", ledger)


def test_the_wheel_holds_all_data_and_no_compiled_code(elsewhere: Path, home: Path) -> None:
    installed = {p.relative_to(site_of(elsewhere) / "fuzzynav" / "_data") for p in data_files(site_of(elsewhere))}
    listed = subprocess.run(["git", "ls-files", "data"], cwd=home, capture_output=True, text=True, check=False)
    here = {Path(line).relative_to("data") for line in listed.stdout.splitlines() if (home / line).is_file()}
    assert here <= installed
    assert Path("published/claims.csv") in installed
    (own,) = metadata.distributions(name="fuzzynav", path=[str(site_of(elsewhere))])
    assert not [f for f in own.files or [] if f.suffix in (".nbi", ".nbc")]


def data_files(site: Path) -> list[Path]:
    return [p for p in (site / "fuzzynav" / "_data").rglob("*") if p.is_file()]


@pytest.mark.parametrize("room", [*LIGHT, "localization", "batch", "published", "studies.tracking.claims"])
def test_a_room_imports_nothing_that_the_package_does_not_ask_for(elsewhere: Path, room: str) -> None:
    allowed = asked_for(site_of(elsewhere)) | {"fuzzynav"}
    owners = metadata.packages_distributions()
    banned = {top for top, names in owners.items() if not allowed & {re.sub(r"[-_.]+", "-", n).lower() for n in names}}
    assert {"IPython", "jupyterlab", "ipywidgets", "skfuzzy", "sympy"} <= banned
    source = f"import sys\nsys.modules.update(dict.fromkeys({sorted(banned)!r}))\nimport fuzzynav.{room}\n"
    heavy = run(elsewhere, source + f"print([m for m in {HEAVY} if sys.modules.get(m)])").strip()
    assert heavy == "[]" or (heavy == "['pandas']" and room not in LIGHT)


@pytest.mark.parametrize("room", LIGHT)
def test_a_room_imports_in_under_a_second(elsewhere: Path, room: str) -> None:
    source = f"import time\nbegan = time.process_time()\nimport fuzzynav.{room}\nprint(time.process_time() - began)"
    times = [float(run(elsewhere, source)) for _ in range(3)]
    assert min(times) < WARM, times
