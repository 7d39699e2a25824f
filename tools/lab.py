"""Open a notebook in JupyterLab, also as root and without a display: `python tools/lab.py NOTEBOOK`.

Where no browser can be opened, the address to open is printed instead.
"""

import json
import os
import sys
import threading
import time
from pathlib import Path

from jupyter_core.paths import jupyter_runtime_dir
from jupyterlab.labapp import main

HERE_ONLY = "127.0.0.1"
PATIENCE = 60.0  # [s] until the server must have written down its address


def is_root() -> bool:
    """Whether this is the superuser, as in most containers; Windows has none."""
    return getattr(os, "geteuid", lambda: 1)() == 0


def has_display() -> bool:
    """Whether a browser has somewhere to open."""
    return sys.platform in ("win32", "darwin") or any(map(os.environ.get, ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")))


def say_address(notebook: str) -> None:
    """Wait until the server of this process has written down where it listens, then print the address to open."""
    record = Path(jupyter_runtime_dir()) / f"jpserver-{os.getpid()}.json"
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if record.exists() and (text := record.read_text(encoding="utf-8")).endswith("}"):
            server = json.loads(text)
            key = f"?token={server['token']}" if server["token"] else ""
            page = Path(notebook).resolve().relative_to(Path(server["root_dir"]).resolve()).as_posix()
            print(f"open this address: {server['url']}lab/tree/{page}{key}", flush=True)
            return
        time.sleep(0.1)


def options(notebook: str) -> list[str]:
    """The arguments for JupyterLab, after one line for each thing that a newcomer should know."""
    chosen = [notebook, "--ServerApp.log_level=WARN"]
    if is_root():
        print(f"you are root: allowed, on this machine only (bound to {HERE_ONLY})", flush=True)
        chosen += ["--allow-root", f"--ServerApp.ip={HERE_ONLY}"]
    if is_root() or not has_display():
        chosen.append("--no-browser")
        threading.Thread(target=say_address, args=(notebook,), daemon=True).start()
    return chosen


if __name__ == "__main__":
    sys.exit(main(options(sys.argv[1])))
