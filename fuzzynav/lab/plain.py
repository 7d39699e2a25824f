"""Errors in plain words: what a learner reads where Python would print a stack trace."""

from __future__ import annotations

from types import TracebackType

__all__ = ["Guard", "plain_words"]

MEANING: tuple[tuple[type[BaseException], str], ...] = (
    (ZeroDivisionError, "it divided by zero"),
    (RecursionError, "it called itself without end"),
    (IndexError, "it asked for an entry that is not there"),
    (KeyError, "it asked for a name that is not there"),
    (AttributeError, "it used a name that the object does not have"),
    (NameError, "it used a name that is not defined"),
    (TypeError, "it got or used a value of the wrong kind"),
    (FileNotFoundError, "it could not find a file"),
    (NotImplementedError, "it is not finished"),
    (SystemExit, "it tried to end Python"),
)


def plain_words(error: BaseException) -> str:
    """One sentence for an error: what it means, Python's name for it, and its message.

    >>> plain_words(ZeroDivisionError("division by zero"))
    'it divided by zero (ZeroDivisionError: division by zero)'
    """
    message = " ".join(str(error).split())[:200]
    name = type(error).__name__
    detail = f"{name}: {message}" if message else name
    for kind, meaning in MEANING:
        if isinstance(error, kind):
            return f"{meaning} ({detail})"
    if isinstance(error, ValueError) and message:
        return message
    return f"it stopped ({detail})"


class Guard:
    """A with-block that keeps any error of the code inside it as `error`, and lets interrupts pass."""

    def __init__(self) -> None:
        self.error: BaseException | None = None

    def __enter__(self) -> Guard:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> bool:
        self.error = error
        return isinstance(error, (Exception, SystemExit))
