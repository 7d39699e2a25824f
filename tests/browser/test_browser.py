"""A real browser opens JupyterLab, runs a chapter, moves a slider and sees the picture change."""

import contextlib
import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

HOME = Path(__file__).parents[2]
TOKEN = "course"
# chapter and the label of the slider to move; None: whichever slider stands last in the chapter
LABS = [("00", "right wheel larger by"), ("03", None), ("07a", "yaw rate")]


def with_labs() -> list[tuple[str, str | None]]:
    """For each chapter of LABS that is there: its last notebook with a lab, and the slider."""
    found = []
    for chapter, label in LABS:
        paths = sorted((HOME / "notebooks").glob(f"{chapter}*.ipynb"))
        names = [p.stem for p in paths if "lab.P" in p.read_text(encoding="utf-8")]
        found += [(names[-1], label)] if names else []
    return found


@dataclass(frozen=True)
class Lab:
    """A running JupyterLab on a copy of the notebooks."""

    url: str
    folder: Path

    def get(self, path: str) -> object:
        with urllib.request.urlopen(f"{self.url}{path}?token={TOKEN}", timeout=10) as answer:
            return json.load(answer)


def chromium() -> str:
    """The browser's program; without it the test is skipped, in CI it fails."""
    found = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if found is None:
        reason = "no Chromium on this computer: install the package chromium to run the browser tests"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)
    return found


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def wait_for(what: str, ready, seconds: float = 60.0):
    """The first true answer of `ready()`; fails with `what` after the time."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        with contextlib.suppress(OSError):  # the server is not up yet
            if answer := ready():
                return answer
        time.sleep(0.2)
    pytest.fail(f"waited {seconds:.0f} s in vain for {what}")


@pytest.fixture(scope="module")
def lab(tmp_path_factory) -> Iterator[Lab]:
    chromium()
    root = tmp_path_factory.mktemp("course")
    shutil.copytree(HOME / "notebooks", root / "notebooks")
    shutil.copytree(HOME / "data", root / "data")
    for name in ("pyproject.toml", "constraints.txt"):
        shutil.copy(HOME / name, root)
    port = free_port()
    home = tmp_path_factory.mktemp("home")
    quiet = {
        "JUPYTER_CONFIG_DIR": "config",
        "JUPYTER_DATA_DIR": "data",
        "JUPYTER_RUNTIME_DIR": "runtime",
        "JUPYTERLAB_SETTINGS_DIR": "settings",
        "JUPYTERLAB_WORKSPACES_DIR": "workspaces",
    }
    words = [
        sys.executable,
        "-m",
        "jupyterlab",
        "--no-browser",
        "--allow-root",
        "--ip=127.0.0.1",
        f"--port={port}",
        f"--IdentityProvider.token={TOKEN}",
        f"--ServerApp.root_dir={root}",
        "--LabApp.news_url=None",
        "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate",
    ]
    with (root / "server.log").open("w") as log:
        server = subprocess.Popen(
            words, stdout=log, stderr=log, cwd=root, env={**os.environ, **{k: str(home / v) for k, v in quiet.items()}}
        )
    running = Lab(f"http://127.0.0.1:{port}", root / "notebooks")
    try:
        wait_for("JupyterLab", lambda: running.get("/api/status"))
        yield running
    finally:
        server.terminate()
        server.wait(20)


@pytest.fixture(scope="module")
def browser() -> Iterator[object]:
    program = chromium()
    from playwright.sync_api import sync_playwright

    flags = ["--no-sandbox", "--disable-background-networking", "--disable-dev-shm-usage"]
    with sync_playwright() as play:
        window = play.chromium.launch(executable_path=program, headless=True, args=flags)
        yield window
        window.close()


@pytest.fixture
def page(browser) -> Iterator[object]:
    tab = browser.new_page(viewport={"width": 1500, "height": 1100})
    yield tab
    tab.close()


def open_notebook(page, lab: Lab, name: str) -> None:
    """Open a notebook and wait until its kernel is idle and connected; the toolbar says so too early."""
    page.goto(f"{lab.url}/doc/tree/notebooks/{name}.ipynb?reset&token={TOKEN}")
    page.wait_for_selector(".jp-Notebook .jp-CodeCell", timeout=60_000)

    def connected() -> bool:
        sessions = [s for s in lab.get("/api/sessions") if s["path"].endswith(f"{name}.ipynb")]
        kernels = [s["kernel"] for s in sessions if s["kernel"]]
        return any(k["execution_state"] == "idle" and k["connections"] > 0 for k in kernels)

    wait_for("a connected kernel", connected)


def run_all(page, cells: int, seconds: float = 180.0) -> None:
    """Run all cells from the menu and wait until every prompt is a number."""
    page.get_by_role("menuitem", name="Run", exact=True).click()
    page.locator("#jp-mainmenu-run").get_by_text("Run All Cells", exact=True).click()
    count = "() => [...document.querySelectorAll('.jp-CodeCell .jp-InputPrompt')].map(e => e.textContent)"

    def done() -> bool:
        prompts = page.evaluate(count)
        return "[*]:" not in prompts and _last_run(page) >= cells

    wait_for("the last cell", done, seconds)


def _last_run(page) -> int:
    """The highest number among the prompts; the notebook is scrolled, for only what is seen is drawn."""
    page.evaluate("""() => { const n = document.querySelector('.jp-WindowedPanel-outer');
                             if (n) n.scrollTop = n.scrollHeight; }""")
    found = page.evaluate("""() => Math.max(0, ...[...document.querySelectorAll('.jp-CodeCell .jp-InputPrompt')]
                             .map(e => parseInt(e.textContent.replace(/[^0-9]/g, '')) || 0))""")
    return int(found)


# the time from a key on the slider's handle to the next picture that the browser shows
PRESS = """async (handle) => {
    const picture = handle.closest('.jp-OutputArea-output').querySelector('img.widget-image, .widget-image img');
    const bytes = async () => Array.from(new Uint8Array(await (await fetch(picture.src)).arrayBuffer()));
    const before = await bytes(), begin = performance.now();
    const shown = new Promise(done => picture.addEventListener(
        'load', () => done(performance.now() - begin), {once: true}));
    const atEnd = handle.getAttribute('aria-valuenow') === handle.getAttribute('aria-valuemax');
    const key = atEnd ? 'ArrowLeft' : 'ArrowRight';
    handle.dispatchEvent(new KeyboardEvent('keydown', {key: key, bubbles: true}));
    const late = new Promise(done => setTimeout(() => done(-1), 10000));
    const milliseconds = await Promise.race([shown, late]);
    return {milliseconds, before, after: await bytes()};
}"""


def press_slider(page, label: str | None) -> dict:
    """Press an arrow key on the labelled slider, or the last one; the time to the new picture, and both pictures."""
    beside_picture = page.locator(".jp-OutputArea-output", has=page.locator("img.widget-image, .widget-image img"))
    named = page.locator(".widget-label", has_text=label) if label else page.locator(".noUi-handle")
    row = beside_picture.locator(".widget-slider", has=named).last
    wait_for(f"the slider '{label or 'of the last lab'}'", lambda: row.count() or scroll(page, -600))
    row.scroll_into_view_if_needed()
    handle = row.locator(".noUi-handle").first
    handle.focus()
    return handle.evaluate(PRESS)


def scroll(page, pixels: int) -> None:
    page.evaluate(
        """d => { const n = document.querySelector('.jp-WindowedPanel-outer');
                            if (n) n.scrollTop += d; }""",
        pixels,
    )


def whole_cells(path: Path) -> list[dict] | None:
    """The cells of a stored notebook; None while it is being written."""
    with contextlib.suppress(json.JSONDecodeError):
        return json.loads(path.read_text(encoding="utf-8"))["cells"]
    return None


def stored_faults(page, lab: Lab, name: str) -> list[str]:
    """Save the notebook and list the errors and warnings among its outputs."""
    page.keyboard.press("Control+s")
    path = lab.folder / f"{name}.ipynb"
    before = path.stat().st_mtime_ns
    wait_for("the notebook to be saved", lambda: path.stat().st_mtime_ns > before or page.keyboard.press("Control+s"))
    cells = wait_for("all of the file to be written", lambda: whole_cells(path))
    outputs = [output for cell in cells for output in cell.get("outputs", [])]
    return [str(o) for o in outputs if o["output_type"] == "error" or o.get("name") == "stderr"]


@pytest.mark.parametrize(("name", "label"), with_labs())
def test_a_slider_moves_the_picture(lab, page, name, label):
    cells = json.loads((HOME / "notebooks" / f"{name}.ipynb").read_text(encoding="utf-8"))["cells"]
    open_notebook(page, lab, name)
    run_all(page, sum(c["cell_type"] == "code" for c in cells))
    steps = [press_slider(page, label) for _ in range(5)]
    if shots := os.environ.get("FUZZYNAV_SCREENSHOTS"):
        page.screenshot(path=f"{shots}/{name}.png")
    times = sorted(step["milliseconds"] for step in steps)
    print(f"{name}: key to new picture {times[2]:.0f} ms (median of 5)")
    assert all(step["before"] != step["after"] for step in steps)
    assert 0 < times[2] < 2000  # far above what it takes, for a busy machine
    assert stored_faults(page, lab, name) == []
