"""Make the course's own Python environment: `python3 tools/environment.py [--test] [--bench] [--download]`.

Needs nothing but Python's standard library, says what it does, can be interrupted and run again,
and ends with one clear line when something is missing. The Makefile calls it; on a machine without
make it is called by hand (README). A folder `wheels/` beside the README, made by `--download`,
is used in place of the network.
"""

import argparse
import hashlib
import re
import shutil
import subprocess
import sys
from pathlib import Path

OLDEST = (3, 11)
HOME = Path(__file__).resolve().parent.parent
VENV = HOME / ".venv"
WHEELS = HOME / "wheels"
SAYS = {
    "No matching distribution": "a package was not found: check the network or the wheels folder",
    "Temporary failure in name resolution": "the package index was not reached: check the network and run the same command again",
    "NewConnectionError": "the package index was not reached: check the network and run the same command again",
    "ConnectTimeoutError": "the package index was not reached: check the network and run the same command again",
    "No space left": "the disk is full: free about 2 GB and run the same command again",
    "Permission denied": "this folder cannot be written: copy the course to a folder of your own",
}


def stop(sentence):
    """End with one line for the reader."""
    sys.exit("fuzzynav: " + sentence)


def interpreter():
    """The environment's python, on Windows and elsewhere."""
    return VENV / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")


def check_python():
    """Stop with one line if this Python is too old or cannot make environments."""
    if sys.version_info < OLDEST:
        have = ".".join(map(str, sys.version_info[:2]))
        stop(
            "Python %d.%d or newer is needed, this is %s: install one and run `make PYTHON=python3.12 ...`"
            % (*OLDEST, have)
        )
    try:
        import ensurepip  # noqa: F401
        import venv  # noqa: F401
    except ImportError:
        stop(
            "Python's venv module is missing: install it (Debian and Ubuntu: apt install python3-venv) and run the same command again"
        )


def fingerprint(groups):
    """What the environment is made from; when it changes, the environment is made anew."""
    digest = hashlib.sha256(repr((groups, sys.version_info[:2])).encode())
    for name in ("pyproject.toml", "constraints.txt", "tests/oracles.txt", "tests/bench/requirements.txt"):
        path = HOME / name
        digest.update(path.read_bytes() if path.exists() else b"")
    return digest.hexdigest()


def pip(*arguments):
    """Run pip in the environment with one moving line of progress; stop with one line if it fails."""
    source = ["--no-index", "--find-links", str(WHEELS)] if WHEELS.is_dir() and arguments[0] == "install" else []
    command = [
        str(interpreter()),
        "-m",
        "pip",
        "--disable-pip-version-check",
        *arguments[:1],
        "--progress-bar=off",
        *source,
        *arguments[1:],
    ]
    lines, count, wide = [], 0, shutil.get_terminal_size().columns - 1
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=HOME) as process:
        for line in process.stdout:
            lines.append(line)
            if line.startswith("Collecting "):
                count += 1
                if sys.stdout.isatty():
                    print(("\r  %d packages: %s" % (count, line.split()[1])).ljust(wide)[:wide], end="", flush=True)
            elif line.startswith("Installing collected"):
                print(
                    ("\r" if sys.stdout.isatty() else "")
                    + "  unpacking them".ljust(wide if sys.stdout.isatty() else 0),
                    flush=True,
                )
    if process.returncode:
        log = HOME / ".venv" / "install.log"
        log.write_text("".join(lines), encoding="utf-8")
        text = "".join(lines)
        reason = next((says for sign, says in SAYS.items() if sign in text), "an installation step failed")
        stop(reason + " (details: .venv/install.log)")


def stamp_of(groups):
    """The file that says an installation with these extras was finished."""
    return VENV / ("ready-" + "-".join(["course", *groups]))


def ready(groups):
    """Whether the environment holds these extras, as the project's files ask for them now."""
    stamp = stamp_of(groups)
    return interpreter().exists() and stamp.exists() and stamp.read_text() == fingerprint(groups)


def build(groups):
    """Make or complete the environment for the extras named in `groups`."""
    known = ([], ["test"], ["bench"], ["test", "bench"])
    if any(ready(other) for other in known if set(groups) <= set(other)):
        return
    if not interpreter().exists():
        print("making a Python environment in .venv", flush=True)
        # --clear: what an interrupted first run left behind is no use
        if subprocess.run(
            [sys.executable, "-m", "venv", "--clear", str(VENV)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        ).returncode:
            stop(
                "the environment could not be made in .venv: check that this folder can be written and that Python's venv module works"
            )
    where = "from the folder wheels" if WHEELS.is_dir() else "from the package index"
    print("installing the packages of constraints.txt %s (first time: two to five minutes)" % where, flush=True)
    target = ".[" + ",".join(["course", *groups]) + "]"
    pip("install", "-c", "constraints.txt", "-e", target)
    for group, names in (("test", "tests/oracles.txt"), ("bench", "tests/bench/requirements.txt")):
        if group in groups:
            # independent programs to compare with; their own version limits are older than ours
            pip("install", "--no-deps", "-r", names)
    stamp_of(groups).write_text(fingerprint(groups))


def backend():
    """What builds the package itself: pip fetches it apart from the package's own dependencies."""
    text = (HOME / "pyproject.toml").read_text(encoding="utf-8")
    return re.findall(r'"([^"]+)"', re.search(r"^requires = \[(.*?)\]", text, re.M).group(1))


def download():
    """Fill wheels/ with everything that an installation without a network needs."""
    print("downloading every package into wheels/", flush=True)
    fresh = HOME / "wheels.part"
    shutil.rmtree(fresh, ignore_errors=True)
    pip("wheel", "-w", str(fresh), "-c", "constraints.txt", ".[test]", *backend())
    pip("wheel", "-w", str(fresh), "--no-deps", "-r", "tests/oracles.txt")
    for own in fresh.glob("fuzzynav-*.whl"):
        own.unlink()
    shutil.rmtree(WHEELS, ignore_errors=True)
    fresh.rename(WHEELS)
    print(
        "%d files in wheels/: copy the whole folder to each seat, `make lab` then needs no network"
        % len(list(WHEELS.iterdir()))
    )


def main():
    """Parse the command line and do what it asks."""
    parser = argparse.ArgumentParser(description="make the course's Python environment")
    parser.add_argument("--test", action="store_true", help="with what the tests need")
    parser.add_argument("--bench", action="store_true", help="with the peers that the benchmarks compare with")
    parser.add_argument(
        "--download", action="store_true", help="download all packages into wheels/ for seats without a network"
    )
    asked = parser.parse_args()
    check_python()
    build([name for name in ("test", "bench") if getattr(asked, name)])
    if asked.download:
        download()


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        stop("interrupted: run the same command again to go on")
