"""Compiled kernels whose source changed are forgotten when the package is imported.

numba keeps compiled code beside the sources and looks only at the file of the function itself: a kernel that calls
one of another file, or holds a constant of another file, would go on running what it was compiled with.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterator
from pathlib import Path

__all__ = ["PACKAGE", "forget_stale", "kernel_digest"]

PACKAGE = Path(os.path.abspath(__file__)).parent  # as numba sees it: symbolic links are not followed
COMPILED = (b"njit", b"vectorize")
# what a kernel of another file can have taken over when it was compiled: constants, dtypes and records
TAKEN_OVER = re.compile(rb"\n(?:[A-Z][^=\n]*=|\(\n|class \w+\(NamedTuple\):).*(?:\n+[ \t)\]}].*)*")


def kernel_digest(package: Path) -> str:
    """A digest of every file with kernels below `package`, and of the constants and records of the other files."""
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        text = path.read_bytes()
        whole = any(word in text for word in COMPILED)
        parts = [text] if whole else TAKEN_OVER.findall(text)
        if parts:
            digest.update(b"\n".join([path.relative_to(package).as_posix().encode(), *parts]))
    return digest.hexdigest()


def forget_stale(package: Path = PACKAGE) -> bool:
    """Remove the compiled kernels of `package` if their sources changed since; True if some were removed.

    Where neither the package nor a folder of the user's can be written, nothing was kept and nothing is done.
    """
    digest = kernel_digest(package)
    stamp = _cache(package) / "kernels.sha256"
    try:
        if stamp.exists() and stamp.read_text() == digest:
            return False
        removed = list(_kept(package))
        for path in removed:
            path.unlink(missing_ok=True)
        stamp.parent.mkdir(parents=True, exist_ok=True)
        fresh = stamp.with_name(f"{stamp.name}.{os.getpid()}")  # two processes may import at once
        fresh.write_text(digest)
        fresh.replace(stamp)
    except OSError:  # a folder that cannot be written: numba keeps nothing there either
        return False
    return bool(removed)


def _kept(package: Path) -> Iterator[Path]:
    """The files that numba wrote for the package, those that name the others first."""
    folders = [package, *(p for p in package.rglob("*") if p.is_dir() and p.name != "__pycache__")]
    for pattern in ("*.nbi", "*.nbc"):
        for folder in folders:
            yield from _cache(folder).glob(pattern)


def _cache(folder: Path) -> Path:
    """Where numba keeps what it compiles from the files of `folder`, by its own rules."""
    name = f"{folder.name}_{hashlib.sha1(str(folder).encode(), usedforsecurity=False).hexdigest()}"
    if os.environ.get("NUMBA_CACHE_DIR"):
        return Path(os.environ["NUMBA_CACHE_DIR"]) / name
    beside = folder / "__pycache__"
    if os.access(beside if beside.exists() else folder, os.W_OK):
        return beside
    from numba.misc.appdirs import AppDirs  # only here: a package that is read-only for this user

    return Path(AppDirs(appname="numba", appauthor=False).user_cache_dir) / name
