"""Compile every numba kernel once, with a progress line: `python -m fuzzynav.warm`.

The compiled code is cached beside the sources, so that no notebook pauses without a word.
A module takes part by holding a function `_warm()` that calls its kernels on tiny data.
Kernels whose sources changed are forgotten before, by `fuzzynav.stale`, when the package is imported.
"""

from __future__ import annotations

import importlib
import sys

from tqdm import tqdm

__all__ = ["MODULES", "main"]

MODULES: tuple[str, ...] = (
    "fuzzynav.blend.kernels",
    "fuzzynav.blend.points",
    "fuzzynav.control",
    "fuzzynav.dwa.contact",
    "fuzzynav.dwa.fast",
    "fuzzynav.dwa.kernels",
    "fuzzynav.dwa.moving",
    "fuzzynav.dwa.sight",
    "fuzzynav.fusion.clusters",
    "fuzzynav.fusion.evasion",
    "fuzzynav.fusion.filters",
    "fuzzynav.fusion.kernels",
    "fuzzynav.fusion.memory",
    "fuzzynav.fusion.tracks",
    "fuzzynav.fuzzy.engine",
    "fuzzynav.fuzzy.kernels",
    "fuzzynav.fuzzy.set_kernels",
    "fuzzynav.localization.particles",
    "fuzzynav.mapping.occupancy",
    "fuzzynav.maps.kernels",
    "fuzzynav.planning.kernels",
    "fuzzynav.planning.openlist",
    "fuzzynav.planning.visibility",
    "fuzzynav.potential.kernels",
    "fuzzynav.robot.kernels",
    "fuzzynav.simulate.kernels",
    "fuzzynav.tracking.kernels",
    "fuzzynav.world.kernels",
    "fuzzynav.world.timed",
)


def main() -> int:
    """Import and warm each module of MODULES; return 0."""
    bar = tqdm(MODULES, desc="compiling kernels", unit="module", file=sys.stdout, leave=False, disable=None)
    for name in bar:
        bar.set_postfix_str(name.removeprefix("fuzzynav."))
        importlib.import_module(name)._warm()
    print(f"kernels ready: {len(MODULES)} modules")
    return 0


if __name__ == "__main__":
    sys.exit(main())
