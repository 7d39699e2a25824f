"""One writer for one file: a second one is refused, a dead one leaves nothing behind."""

from __future__ import annotations

import contextlib
import importlib
import os
import threading
from collections.abc import Iterator
from pathlib import Path

__all__ = ["only_writer"]

_mine: set[Path] = set()  # locks of this process: the operating system would grant it each of them again
_guard = threading.Lock()


@contextlib.contextmanager
def only_writer(path: Path) -> Iterator[None]:
    """Hold the file `path` alone, by a lock on `path.lock` that ends with the process at the latest.

    Raises ValueError where another process, or another thread of this one, writes it. Not inherited by workers.
    """
    path = path.resolve()
    lock = path.with_name(path.name + ".lock")
    refusal = f"{path.name} is being written by another sweep: wait for it, or name another file"
    with _guard:
        if path in _mine:
            raise ValueError(refusal)
        _mine.add(path)
    try:
        lock.parent.mkdir(parents=True, exist_ok=True)
        handle = _locked(lock, refusal)
        try:
            yield
        finally:
            with contextlib.suppress(OSError):  # Windows keeps a file that is open
                lock.unlink()
            os.close(handle)
    finally:
        with _guard:
            _mine.discard(path)


def _locked(lock: Path, refusal: str) -> int:
    """An open, locked file that still bears its name: its last holder may have removed it meanwhile."""
    while True:
        handle = os.open(lock, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            _take(handle)
        except OSError:
            os.close(handle)
            raise ValueError(refusal) from None
        with contextlib.suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(handle), os.stat(lock)):
                return handle
        os.close(handle)


def _take(handle: int) -> None:
    """Lock an open file or raise OSError; fcntl on POSIX, msvcrt on Windows."""
    if os.name == "nt":
        windows = importlib.import_module("msvcrt")
        windows.locking(handle, windows.LK_NBLCK, 1)
    else:
        posix = importlib.import_module("fcntl")
        posix.lockf(handle, posix.LOCK_EX | posix.LOCK_NB)
