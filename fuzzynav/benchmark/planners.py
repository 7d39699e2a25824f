"""Planners by name: those of the course, guests, or a reader's own as `module:object`."""

from __future__ import annotations

import importlib
from typing import cast

from fuzzynav.fusion.guests import GUESTS
from fuzzynav.fusion.methods import METHODS
from fuzzynav.fusion.task import Method

__all__ = ["named", "names"]


def names() -> tuple[str, ...]:
    """The planners that have a name here."""
    return (*METHODS, *GUESTS)


def named(text: str) -> Method:
    """The planner of a name, or the function from a task to a controller at `module:object`.

    Raises ValueError where there is none.
    """
    known = {**METHODS, **GUESTS}
    if text in known:
        return known[text]
    module, colon, name = text.partition(":")
    if not (module and colon and name):
        raise ValueError(f"there is no planner {text!r}: take one of {', '.join(map(repr, known))}, or module:object")
    try:
        found = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError) as error:
        raise ValueError(f"there is no planner {text}: {error}") from None
    if not callable(found):
        raise ValueError(f"{text} is {type(found).__name__}: a planner is a function from a task to its controller")
    return cast(Method, found)
