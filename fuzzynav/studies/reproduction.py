"""One reproduction: a function that measures what a document printed, what was free, and what agreement shows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

__all__ = ["MEANING", "VERDICTS", "Interval", "Measured", "Reproduction", "Verdict"]

Verdict = Literal[
    "reproduced",
    "fitted",
    "input",
    "by definition",
    "direction holds",
    "not reproduced",
    "contradicts itself",
    "not testable",
    "not yet",
]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
MEANING: dict[Verdict, str] = {
    "reproduced": "it could have failed and did not; the tolerance comes from rounding or from a stated freedom",
    "fitted": "it comes out for a choice of ours that was sought until it did: the print is possible, no more",
    "input": "a printed parameter that our code uses; changing it changes a run",
    "by definition": "it follows from how we had to define the measure",
    "direction holds": "the number does not come out, the change goes the printed way on seeded cases, by its interval",
    "not reproduced": "it does not come out",
    "contradicts itself": "the document refutes it, with the proof",
    "not testable": "it cannot be held against anything, with the reason",
    "not yet": "not measured so far",
}
Measured = float | int | bool | str
Interval = tuple[float, float, float]  # mean, low and high of a 95 % interval


@dataclass(frozen=True, slots=True, kw_only=True)
class Reproduction:
    """How one published number is measured here.

    `measure` returns our value: a number in the claim's unit (percentages as percent), True or False for a qualitative
    claim, or the same kind of text. `tolerance` is absolute, in the claim's unit; `because` says where it comes from,
    or why the value is what it is. `free` names what of the set-up is our choice. `shows` is what agreement is called:
    'reproduced', 'fitted', 'input' or 'by definition'. `direction`, for a change or a comparison only, gives the change
    in the printed sense on seeded cases: it holds if all of its interval is positive. `beside` is the same comparison
    on cases that nobody tuned. `holds_for` counts our admissible reconstructions, as (it comes out for, of), or says
    why there is no count. `verdict` is given only where numbers cannot decide: 'contradicts itself' (proof in
    `because`) or 'not testable'.
    Raises ValueError for a verdict without a reason, for neither measure nor verdict, or for a fit that says not what
    was free.
    """

    claim: str
    measure: Callable[[], Measured] | None = None
    tolerance: float = 0.005
    because: str = ""
    free: str = ""
    shows: Verdict = "reproduced"
    direction: Callable[[], Interval] | None = None
    beside: Callable[[], str] | None = None
    holds_for: Callable[[], tuple[int, int]] | str = ""
    verdict: Verdict | None = None

    def __post_init__(self) -> None:
        if self.verdict is not None and self.verdict not in VERDICTS:
            raise ValueError(f"{self.claim}: verdict '{self.verdict}' is not one of {', '.join(VERDICTS)}")
        if self.verdict is not None and not self.because:
            raise ValueError(f"{self.claim}: a verdict set by hand needs its reason in 'because'")
        if self.verdict is None and self.measure is None:
            raise ValueError(f"{self.claim}: give a function that measures, or a verdict with its reason")
        if self.shows not in VERDICTS[:4]:
            raise ValueError(f"{self.claim}: agreement shows one of {', '.join(VERDICTS[:4])}, not '{self.shows}'")
        if self.shows in ("fitted", "by definition") and not self.free:
            raise ValueError(f"{self.claim}: '{self.shows}' needs what was free in 'free'")
        if not self.tolerance >= 0:
            raise ValueError(f"{self.claim}: tolerance must not be negative, got {self.tolerance}")
