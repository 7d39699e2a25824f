"""`make lab` opens the course: as root with an address to open, as an ordinary user in the browser."""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

PATIENCE = 60.0  # [s]
NOBODY = 65534
AS_NOBODY = [
    "setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups",
    # the interpreter may stand in a folder of root's
    "--inh-caps=+dac_override", "--ambient-caps=+dac_override",
]  # fmt: skip
IS_ROOT = getattr(os, "geteuid", lambda: 1)() == 0
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="uses Linux's setpriv and process groups")


@pytest.fixture
def course(home: Path, tmp_path: Path) -> Path:
    """A copy of the course whose environment is this one, ready and with its kernels compiled."""
    copy = tmp_path / "course"
    for folder in ("notebooks", "tools", "fuzzynav"):
        shutil.copytree(home / folder, copy / folder, ignore=shutil.ignore_patterns("__pycache__", "backup", ".*"))
    for name in ("Makefile", "pyproject.toml", "constraints.txt"):
        shutil.copy2(home / name, copy / name)
    (copy / ".venv").mkdir()
    for part in ("bin", "lib", "share", "etc", "pyvenv.cfg"):
        if (Path(sys.prefix) / part).exists():
            (copy / ".venv" / part).symlink_to(Path(sys.prefix) / part)
    (copy / ".venv" / "kernels").touch()
    (tmp_path / "home").mkdir()
    return copy


@contextmanager
def make_lab(course: Path, prefix: list[str], **variables: str) -> Iterator[tuple[Path, int]]:
    """Run `make lab`; gives the file with what it says, and the port."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    said = course.parent / "said.txt"
    kept = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER", "MAKEFLAGS")}
    environment = {**kept, "HOME": str(course.parent / "home"), "JUPYTER_PORT": str(port), **variables}
    environment.pop("XDG_RUNTIME_DIR", None)
    with said.open("w") as stream:
        process = subprocess.Popen(
            command(course, prefix), cwd=course, env=environment, stdout=stream, stderr=stream, start_new_session=True
        )
    try:
        yield said, port
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def command(course: Path, prefix: list[str]) -> list[str]:
    """`make lab`; behind a prefix what it runs, as make asks for the rights of the user who stands behind setpriv."""
    if not prefix:
        return ["make", "lab"]
    listed = subprocess.run(["make", "-n", "lab"], cwd=course, capture_output=True, text=True, check=True)
    return [*prefix, "sh", "-c", listed.stdout]


def wait_for(pattern: str, file: Path) -> re.Match[str]:
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        found = re.search(pattern, file.read_text()) if file.exists() else None
        if found:
            return found
        time.sleep(0.2)
    raise AssertionError(f"{pattern} was not said: {file.read_text() if file.exists() else 'nothing'}")


def page(address: str) -> str:
    with urllib.request.urlopen(address, timeout=60) as answer:
        assert answer.status == 200
        return str(answer.read().decode())


@LINUX
@pytest.mark.skipif(not IS_ROOT, reason="only the superuser can start it as root")
def test_root_gets_one_line_and_the_address(course: Path) -> None:
    with make_lab(course, []) as (said, port):
        address = wait_for(r"open this address: (\S+)\n", said)[1]
        assert re.fullmatch(rf"http://127\.0\.0\.1:{port}/lab/tree/00_start_here\.ipynb\?token=\w{{20,}}", address)
        assert "you are root: allowed, on this machine only (bound to 127.0.0.1)" in said.read_text().splitlines()
        assert "jupyter-config-data" in page(address)


@LINUX
def test_without_a_display_an_ordinary_user_gets_the_address(course: Path) -> None:
    with make_lab(course, ordinary(course)) as (said, _):
        address = wait_for(r"open this address: (\S+)\n", said)[1]
        assert "jupyter-config-data" in page(address)
        assert "you are root" not in said.read_text()


@LINUX
def test_an_ordinary_user_gets_the_browser(course: Path) -> None:
    program, opened = course.parent / "browser", course.parent / "home" / "opened.txt"
    program.write_text(f'#!/bin/sh\necho "$1" > "{opened}"\n')
    program.chmod(0o755)
    with make_lab(course, ordinary(course), DISPLAY=":99", BROWSER=f"{program} %s") as (said, _):
        start = Path(wait_for(r"(?:file://)?(/\S+\.html)\n", opened)[1]).read_text()
        address = re.search(r'href="(http[^"]+)"', start)
        assert address, start
        assert "jupyter-config-data" in page(address[1])
        assert "open this address" not in said.read_text()


def ordinary(course: Path) -> list[str]:
    """What stands before the command so that it does not run as root; the copied course belongs to that user."""
    if not IS_ROOT:
        return []
    for path in [*course.parent.rglob("*"), course.parent]:
        if not path.is_symlink() and ".venv/" not in str(path.relative_to(course.parent)):
            os.chown(path, NOBODY, NOBODY)
    return AS_NOBODY
