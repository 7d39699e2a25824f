"""Our choices for what is not printed, what each published claim measures here, and the long studies; by topic."""

from __future__ import annotations

import importlib
import pkgutil
from types import ModuleType

FRAME = ("__main__", "reproduction", "study")  # what is no topic

__all__ = ["claims_of", "topics"]


def topics() -> tuple[str, ...]:
    """The topics present, in alphabetical order; each is a file, or a folder with a file `claims`."""
    return tuple(sorted(m.name for m in pkgutil.iter_modules(__path__) if m.name not in FRAME))


def claims_of(topic: str) -> ModuleType:
    """The module that holds a topic's REPRODUCTIONS and STUDIES, where it has some."""
    found = importlib.import_module(f"{__name__}.{topic}")
    return importlib.import_module(f"{__name__}.{topic}.claims") if hasattr(found, "__path__") else found
