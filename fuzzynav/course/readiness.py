"""Is this computer ready for the course? Every part is checked and, where missing, named with its remedy."""

from __future__ import annotations

import importlib
import importlib.metadata as metadata
import importlib.util
import os
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from fuzzynav.course.folders import course_root
from fuzzynav.lab.plain import Guard, plain_words

__all__ = ["Finding", "Readiness", "ready"]

OLDEST = (3, 11)
AGAIN = "close Jupyter and run `make lab` again"


@dataclass(frozen=True, slots=True)
class Finding:
    """One part of the check: its name, whether it is well, and what to do or know."""

    part: str
    well: bool
    words: str


class Readiness:
    """The findings as a table and one closing sentence."""

    def __init__(self, findings: tuple[Finding, ...]) -> None:
        self.findings = findings

    @property
    def sentence(self) -> str:
        """Whether the course can start, in one sentence."""
        faults = [f.part.lower() for f in self.findings if not f.well]
        if not faults:
            return "Everything the course needs is here."
        return "Something is missing: " + ", ".join(faults) + ". The table says what to do."

    def __repr__(self) -> str:
        return "\n".join([*(f"{f.part}: {f.words}" for f in self.findings), self.sentence])

    def _repr_markdown_(self) -> str:
        rows = [f"| {f.part} | {'ready' if f.well else '**missing**'} | {f.words} |" for f in self.findings]
        return "\n".join(["| Part | State | In words |", "| --- | --- | --- |", *rows, "", self.sentence])


def ready() -> Readiness:
    """Check Python, packages, compiled kernels, widgets and data; a check that fails is a finding too."""
    checks: tuple[tuple[str, Callable[[], Finding]], ...] = (
        ("Python", python),
        ("Packages", packages),
        ("Compiled kernels", kernels),
        ("Sliders", widgets),
        ("Published data", data),
    )
    return Readiness(tuple(_checked(part, check) for part, check in checks))


def python(version: tuple[int, int] = sys.version_info[:2]) -> Finding:
    """Whether this Python is new enough."""
    well = version >= OLDEST
    need = f"{OLDEST[0]}.{OLDEST[1]} or newer"
    return Finding("Python", well, need if well else f"this is {version[0]}.{version[1]}, the course needs {need}")


def packages(wanted: tuple[str, ...] | None = None, pins: dict[str, set[str]] | None = None) -> Finding:
    """Whether every package is installed, and which differ from the versions that were tested."""
    names = _dependencies() if wanted is None else wanted
    tested = _pins() if pins is None else pins
    present = {name: found for name in names if (found := _version(name)) is not None}
    missing = [name for name in names if name not in present]
    if missing:
        return Finding("Packages", False, f"not installed: {', '.join(missing)}; {AGAIN}")
    other = [
        f"{n} {v} (tested with {' or '.join(sorted(tested[n]))})"
        for n, v in present.items()
        if v not in tested.get(n, {v})
    ]
    if other:
        return Finding("Packages", True, f"all installed; other versions than tested: {', '.join(other)}")
    return Finding("Packages", True, "all installed, in the versions that were tested")


def kernels(modules: tuple[str, ...] | None = None) -> Finding:
    """Whether the fast code is compiled already, so that no cell waits for it."""
    listed = importlib.import_module("fuzzynav.warm").MODULES if modules is None else modules
    cold = [name for name in listed if not _compiled(name)]
    if not cold:
        return Finding("Compiled kernels", True, "compiled, no cell waits for the compiler")
    return Finding(
        "Compiled kernels",
        False,
        f"{len(cold)} modules are not compiled: the first call takes up to a minute; "
        "to do it now, run `python -m fuzzynav.warm` in a terminal",
    )


def widgets() -> Finding:
    """Whether the packages behind the sliders are installed."""
    missing = [name for name in ("ipywidgets", "jupyterlab_widgets", "ipycanvas") if _version(name) is None]
    if missing:
        return Finding("Sliders", False, f"not installed: {', '.join(missing)}; {AGAIN}")
    return Finding("Sliders", True, "installed; if no slider shows below, reload this page in the browser")


def data() -> Finding:
    """Whether the course's data folder is where the notebooks look for it."""
    course_root()
    return Finding("Published data", True, "found beside the notebooks")


def _checked(part: str, check: Callable[[], Finding]) -> Finding:
    guard = Guard()
    with guard:
        return check()
    words = plain_words(guard.error) if guard.error is not None else "no answer"
    return Finding(part, False, words)


def _dependencies() -> tuple[str, ...]:
    """What the package itself and its extra `course` ask for."""
    lines = [line for line in metadata.requires("fuzzynav") or [] if not re.search("extra == .(?!course)", line)]
    return tuple(sorted(re.split(r"[\[<>=;!~ ]", line)[0].lower() for line in lines))


def _pins() -> dict[str, set[str]]:
    path = course_root() / "constraints.txt"
    pins: dict[str, set[str]] = {}
    for line in path.read_text(encoding="utf-8").splitlines() if path.is_file() else []:
        name, _, version = line.partition(";")[0].partition("==")
        if version and not line.startswith("#"):
            pins.setdefault(name.strip().lower(), set()).add(version.strip())
    return pins


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _compiled(module: str) -> bool:
    spec = importlib.util.find_spec(module)
    if spec is None or spec.origin is None:
        return False
    path = Path(spec.origin)
    if "njit" not in path.read_text(encoding="utf-8"):
        return True  # it warms what others compile
    elsewhere = os.environ.get("NUMBA_CACHE_DIR")
    folder = Path(elsewhere) if elsewhere else path.parent / "__pycache__"
    return any(folder.rglob(f"{path.stem}.*.nbi"))
