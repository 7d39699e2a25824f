"""Compile every numba kernel once, with a progress line: `python -m fuzzynav.warm`.

The compiled code is cached beside the sources, so that no notebook pauses without a word.
A module takes part by holding a function `_warm()` that calls its kernels on tiny data.
"""

from __future__ import annotations

import hashlib
import importlib
import sys
from pathlib import Path

from tqdm import tqdm

PACKAGE = Path(__file__).resolve().parent

MODULES: tuple[str, ...] = (
    "fuzzynav.blend.kernels",
    "fuzzynav.blend.points",
    "fuzzynav.control",
    "fuzzynav.dwa.contact",
    "fuzzynav.dwa.fast",
    "fuzzynav.dwa.kernels",
    "fuzzynav.dwa.sight",
    "fuzzynav.fuzzy.engine",
    "fuzzynav.fuzzy.kernels",
    "fuzzynav.fuzzy.set_kernels",
    "fuzzynav.localization.particles",
    "fuzzynav.mapping.occupancy",
    "fuzzynav.maps.kernels",
    "fuzzynav.planning.kernels",
    "fuzzynav.planning.visibility",
    "fuzzynav.robot.kernels",
    "fuzzynav.tracking.kernels",
    "fuzzynav.world.kernels",
)


def forget_stale() -> bool:
    """Remove the compiled kernels if any of their sources changed since; True if some were removed.

    numba looks only at the file of the function itself: a kernel that calls one of another module would
    go on running the old one.
    """
    digest = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*.py")):
        text = path.read_bytes()
        if b"njit" in text:
            digest.update(text)
    stamp = PACKAGE / "__pycache__" / "kernels.sha256"
    if stamp.exists() and stamp.read_text() == digest.hexdigest():
        return False
    removed = [path for pattern in ("*.nbi", "*.nbc") for path in PACKAGE.rglob(f"__pycache__/{pattern}")]
    for path in removed:
        path.unlink(missing_ok=True)
    stamp.parent.mkdir(exist_ok=True)
    stamp.write_text(digest.hexdigest())
    return bool(removed)


def main() -> int:
    """Import and warm each module of MODULES; return 0."""
    forget_stale()
    bar = tqdm(MODULES, desc="compiling kernels", unit="module", file=sys.stdout, leave=False, disable=None)
    for name in bar:
        bar.set_postfix_str(name.removeprefix("fuzzynav."))
        importlib.import_module(name)._warm()
    print(f"kernels ready: {len(MODULES)} modules")
    return 0


if __name__ == "__main__":
    sys.exit(main())
