"""Students' cells in a process of their own: limits on time and output, and nothing of it left behind."""

from __future__ import annotations

import os
import subprocess
import threading
import uuid
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat
import psutil
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient
from nbclient.exceptions import CellTimeoutError, DeadKernelError
from nbformat import NotebookNode

__all__ = ["Stopped", "end_all", "end_marked", "run_cells"]

MARK = "FUZZYNAV_GRADE_RUN"  # in the environment of everything that a run starts
RUNNING: set[str] = set()  # marks of the runs that are not over
LOUDEST = 2_000_000  # bytes that one cell may print


@dataclass(frozen=True, slots=True)
class Stopped:
    """The cell that stopped a run, and why."""

    index: int
    reason: str


class Client(NotebookClient):
    """Runs cells; one that prints more than LOUDEST bytes is ended, and what it prints is no longer kept."""

    mark = ""
    printed = 0

    def process_message(self, msg: dict[str, Any], cell: NotebookNode, cell_index: int) -> Any:
        """Take in one message of the kernel."""
        if msg.get("msg_type") in ("stream", "display_data", "execute_result", "error", "update_display_data"):
            self.printed += len(str(msg.get("content")))
            if self.printed > LOUDEST:
                end_marked(self.mark)
                return None
        return super().process_message(msg, cell, cell_index)


def run_cells(
    cells: list[NotebookNode], folder: Path, seconds: int, stop: threading.Event | None = None
) -> Stopped | None:
    """Run all cells in `folder`, their outputs put into them; which one stopped the run and why, or None.

    The package is the copy beside `folder`. `seconds` limits each cell. Once `stop` is set no further cell runs.
    """
    client = Client(
        nbformat.v4.new_notebook(cells=cells),
        km=AsyncKernelManager(kernel_name="python3"),
        timeout=seconds,
        allow_errors=True,
        store_widget_state=False,
        resources={"metadata": {"path": str(folder)}},
    )
    client.mark = uuid.uuid4().hex
    RUNNING.add(client.mark)
    paths = [str(folder.parent), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = {**os.environ, "FUZZYNAV_GRADE": "1", MARK: client.mark, "PYTHONPATH": os.pathsep.join(paths)}
    index = 0
    try:
        with client.setup_kernel(env=environment, stderr=subprocess.DEVNULL):
            for index, cell in enumerate(client.nb.cells):
                if stop is not None and stop.is_set():
                    break
                client.printed = 0
                client.execute_cell(cell, index)
    except CellTimeoutError:
        return Stopped(index, f"it ran longer than {seconds} s")
    except DeadKernelError:
        loud = client.printed > LOUDEST
        return Stopped(index, f"it printed more than {LOUDEST // 1_000_000} MB" if loud else "it ended Python")
    finally:
        end_marked(client.mark)
        RUNNING.discard(client.mark)
    return None


def end_all() -> None:
    """End every run that is not over."""
    for mark in list(RUNNING):
        end_marked(mark)


def end_marked(mark: str) -> None:
    """End every process that was started by the run with this mark, by its id."""
    for process in psutil.process_iter():
        try:
            if process.environ().get(MARK) == mark:
                process.kill()
        except (psutil.Error, OSError):
            continue
