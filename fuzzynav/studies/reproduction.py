"""One reproduction: a function that measures what a document printed, and what may differ."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

__all__ = ["VERDICTS", "Measured", "Reproduction", "Verdict"]

Verdict = Literal["reproduced", "direction holds", "not reproduced", "contradicts itself", "not testable", "not yet"]
VERDICTS: tuple[Verdict, ...] = (
    "reproduced",
    "direction holds",
    "not reproduced",
    "contradicts itself",
    "not testable",
    "not yet",
)
Measured = float | int | bool | str


@dataclass(frozen=True, slots=True, kw_only=True)
class Reproduction:
    """How one published number is measured here.

    `measure` returns our value: a number in the claim's unit (percentages as percent), True or False
    for a qualitative claim, or the same kind of text. `tolerance` is absolute, in the claim's unit;
    `because` says where it comes from. `direction` answers whether the stated tendency holds
    although the number does not. `ours` names what of the set-up is our choice. `verdict` is given
    only where numbers cannot decide: 'contradicts itself' (proof in `because`) or 'not testable'.
    Raises ValueError for a verdict without a reason, or for neither measure nor verdict.
    """

    claim: str
    measure: Callable[[], Measured] | None = None
    tolerance: float = 0.005
    because: str = ""
    ours: str = ""
    direction: Callable[[], bool] | None = None
    verdict: Verdict | None = None

    def __post_init__(self) -> None:
        if self.verdict is not None and self.verdict not in VERDICTS:
            raise ValueError(f"{self.claim}: verdict '{self.verdict}' is not one of {', '.join(VERDICTS)}")
        if self.verdict is not None and not self.because:
            raise ValueError(f"{self.claim}: a verdict set by hand needs its reason in 'because'")
        if self.verdict is None and self.measure is None:
            raise ValueError(f"{self.claim}: give a function that measures, or a verdict with its reason")
        if not self.tolerance >= 0:
            raise ValueError(f"{self.claim}: tolerance must not be negative, got {self.tolerance}")
