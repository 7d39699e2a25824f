"""Small wrong changes of the code, each of which some test must notice. By hand: `python tests/mutants.py`.

Each change of `mutations.MUTANTS` is made in a private copy of the project, and the tests that should turn red are run
there. What stays green is a survivor: a test is missing, or the change makes no difference. A run that does not end
counts as noticed.
"""

from __future__ import annotations

import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Collection, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HOME = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HOME))

from fuzzynav.stale import kernel_digest  # noqa: E402
from tests.mutations import MUTANTS, Mutant  # noqa: E402

COPIED = ("fuzzynav", "tests", "data", "notebooks", "pyproject.toml")
TIMEOUT = 150.0  # [s] for the tests of one change, compiling included
IMPORTED = re.compile(r"^\s*from (fuzzynav[\w.]*) import \(?([^)]*)", re.MULTILINE)
WORDS = {0: "survived", 1: "killed"}  # by pytest's code; any other means that the tests did not run


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the chosen changes one after the other and print what became of each; 1 if any survived or did not run."""
    parser = argparse.ArgumentParser(description="small wrong changes that tests must notice")
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help="only these: planning, course, ... (default: all)")
    parser.add_argument("--jobs", type=int, default=1, help="how many at once (default: 1)")
    parser.add_argument("--list", action="store_true", help="say what there is and run nothing")
    parser.add_argument("--only", default="", metavar="TEXT", help="only changes whose reason holds this text")
    options = parser.parse_args(arguments)
    known = dict.fromkeys(m.room for m in MUTANTS)
    if unknown := set(options.rooms) - set(known):
        parser.error(f"no changes for {', '.join(sorted(unknown))}; there are some for {', '.join(known)}")
    chosen = [m for m in MUTANTS if m.room in (options.rooms or known) and options.only in m.why]
    if options.list:
        for mutant in chosen:
            print(
                f"{mutant.room:12} {mutant.why}" + (f" (no difference: {mutant.equivalent})" * bool(mutant.equivalent))
            )
        return 0
    with ThreadPoolExecutor(options.jobs) as pool:
        told = [pool.submit(tried, m) for m in chosen if not m.equivalent]
        found = Counter(said.result() for said in told)
    skipped = sum(bool(m.equivalent) for m in chosen)
    print(", ".join(f"{count} {word}" for word, count in found.items()), f"; {skipped} make no difference")
    return int(found.keys() - {"killed"} != set())


def tried(mutant: Mutant) -> str:
    """What became of one change: 'killed', 'survived' or 'not run'; prints it with its time."""
    began = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="fuzzynav-mutant-", ignore_cleanup_errors=True) as scratch:
        place = copied(Path(scratch))
        applied(mutant, place)
        command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *shlex.split(mutant.tests)]
        environment = {**os.environ, "PYTHONPATH": str(place)} | ({"NUMBA_DISABLE_JIT": "1"} if mutant.plain else {})
        environment.pop("NUMBA_CACHE_DIR", None)
        try:
            done = subprocess.run(command, cwd=place, env=environment, capture_output=True, timeout=TIMEOUT, text=True)
            word, output = WORDS.get(done.returncode, "not run"), done.stdout + done.stderr
        except subprocess.TimeoutExpired:
            word, output = "killed", "it did not end"
    red = next((line.split(" - ")[0] for line in output.splitlines() if line.startswith(("FAILED", "ERROR"))), "")
    print(f"{word:8} {time.perf_counter() - began:5.0f} s  {mutant.room}: {mutant.why}   {red}", flush=True)
    if word == "not run":
        print(output[-1500:], flush=True)
    return word


def copied(scratch: Path) -> Path:
    """A copy of what the tests need, with everything that was compiled."""
    place = scratch / "project"
    for name in COPIED:
        if (HOME / name).is_dir():
            shutil.copytree(HOME / name, place / name)
        else:
            shutil.copy2(HOME / name, place / name)
    return place


def applied(mutant: Mutant, place: Path) -> None:
    """Make the change; forget the kernels of the file and of the kernels that import it, and keep the others."""
    package, path = place / "fuzzynav", place / mutant.path
    before = kernel_digest(package)
    path.write_text(changed(mutant, path.read_text(encoding="utf-8")), encoding="utf-8")
    after = kernel_digest(package)
    if before == after:
        return
    texts = {p.relative_to(place).as_posix(): p.read_text(encoding="utf-8") for p in package.rglob("*.py")}
    users = {name: imports(text, texts) for name, text in texts.items() if "njit" in text}
    touched = {mutant.path}
    while more := {name for name, used in users.items() if used & touched} - touched:
        touched |= more
    for name in touched:
        for kept in (place / name).parent.glob(f"__pycache__/{Path(name).stem}.*.nb?"):
            kept.unlink()
    stamp = package / "__pycache__" / "kernels.sha256"
    if stamp.exists():  # or the package would forget all of them
        stamp.write_text(after)


def changed(mutant: Mutant, text: str) -> str:
    """The text with the change; ValueError unless its old part stands there once."""
    count = text.count(mutant.old)
    if count != 1 or mutant.old == mutant.new:
        raise ValueError(f"{mutant.path}: {mutant.old!r} stands there {count} times, once is needed ({mutant.why})")
    return text.replace(mutant.old, mutant.new)


def imports(text: str, sources: Collection[str]) -> set[str]:
    """The files of the package that a file imports from."""
    found = set()
    for module, names in IMPORTED.findall(text):
        base = module.replace(".", "/")
        ends = (base, *(f"{base}/{name.split(' as ')[0].strip()}" for name in names.split(",")))
        found |= {f"{end}{tail}" for end in ends for tail in (".py", "/__init__.py")} & set(sources)
    return found


if __name__ == "__main__":
    sys.exit(main())
