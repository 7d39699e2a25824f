"""The rule base that gives the weight F: table 5.1 of the thesis, and its breakpoints."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fuzzynav.data import folder
from fuzzynav.fuzzy import FuzzySystem

__all__ = ["TABLE", "reach_of", "rule_base", "table_5_1"]

TABLE = folder("fuzzy") / "thesis_table_5_1.fll"


@lru_cache(maxsize=1)
def table_5_1() -> FuzzySystem:
    """The rule base of table 5.1, from data/fuzzy."""
    return FuzzySystem.load(TABLE)


def rule_base(close: float = 0.5, far: float = 1.0, ahead: float = 1.0, peak: float = 0.5) -> FuzzySystem:
    """Table 5.1 with other breakpoints: Close ends from `close` to `far` [m], Zero spans +-ahead [rad], More at peak.

    Raises ValueError unless 0 < close < far < 2, 0 < ahead < 4 and 0 < peak < 1.
    """
    if not (0.0 < close < far < 2.0 and 0.0 < ahead < 4.0 and 0.0 < peak < 1.0):
        raise ValueError(f"need 0 < close < far < 2, 0 < ahead < 4, 0 < peak < 1: {close}, {far}, {ahead}, {peak}")
    return table_5_1().with_terms(
        {
            ("distObs", "Close"): (0.0, 0.0, close, far),
            ("distObs", "Far"): (close, far, 2.0, 2.0),
            ("thetaObs", "Negative"): (-4.0, -4.0, -ahead, 0.0),
            ("thetaObs", "Zero"): (-ahead, 0.0, ahead),
            ("thetaObs", "Positive"): (0.0, ahead, 4.0, 4.0),
            ("F", "Little"): (0.0, 0.0, peak),
            ("F", "More"): (0.0, peak, 1.0),
            ("F", "Lots"): (peak, 1.0, 1.0),
        }
    )


def reach_of(system: FuzzySystem) -> tuple[float, float]:
    """Least and greatest F that the rule base can give: the centroid never reaches 0 nor 1 (errata T60).

    >>> [round(f, 3) for f in reach_of(table_5_1())]
    [0.167, 0.833]
    """
    d, b = np.meshgrid(np.linspace(0.0, 2.0, 41), np.linspace(-4.0, 4.0, 81))
    f = system(d, b)[0]
    return float(np.nanmin(f)), float(np.nanmax(f))
