"""What an answer to a lab question is: its words, computed where they hold numbers, and the fold that hides them."""

from __future__ import annotations

import html
import re
from collections.abc import Callable
from dataclasses import dataclass

__all__ = ["Answer", "Folded"]


@dataclass(frozen=True, slots=True)
class Answer:
    """The answer to one question of a lab, as a text or as a function that computes it from the package.

    Raises ValueError if the id is not like 06.lab1 or if the text is empty.
    """

    id: str
    text: str | Callable[[], str]

    def __post_init__(self) -> None:
        if not re.fullmatch(r"\d\d[ab]?\.lab\d+", self.id):
            raise ValueError(f"an answer is named like 06.lab1, not '{self.id}'")
        if not self.text:
            raise ValueError(f"the answer {self.id} needs a text")

    def words(self) -> str:
        """The text, with its numbers computed."""
        return " ".join((self.text if isinstance(self.text, str) else self.text()).split())

    def folded(self) -> Folded:
        """The answer as a notebook shows it: a line to unfold."""
        return Folded("Answer", self.words())


class Folded:
    """A text that Jupyter shows folded under its title, and a terminal shows plain."""

    def __init__(self, title: str, text: str) -> None:
        self.title, self.text = title, text

    def __repr__(self) -> str:
        return f"{self.title}: {self.text}"

    def _repr_html_(self) -> str:
        return f"<details><summary>{html.escape(self.title)}</summary>{html.escape(self.text)}</details>"
