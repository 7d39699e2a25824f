"""What a sweep comes to: rates with their intervals, medians among successes, paired differences."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy import stats

__all__ = ["paired", "proportion", "summary"]


def proportion(successes: int, trials: int, confidence: float = 0.95) -> tuple[float, float, float]:
    """Rate with its Wilson interval: (rate, low, high).

    >>> [round(x, 3) for x in proportion(90, 100)]
    [0.9, 0.826, 0.945]
    """
    if trials < 1:
        raise ValueError("a rate needs at least one trial")
    interval = stats.binomtest(successes, trials).proportion_ci(confidence, method="wilson")
    return successes / trials, float(interval.low), float(interval.high)


def summary(
    table: pd.DataFrame, by: str | Sequence[str], quantities: Sequence[str], success: str = "success"
) -> pd.DataFrame:
    """One row a group: runs, rate of success with its 95 % Wilson interval, medians among successes.

    Raises ValueError if a column is missing.
    """
    by = [by] if isinstance(by, str) else list(by)
    missing = [c for c in [*by, *quantities, success] if c not in table.columns]
    if missing:
        raise ValueError(f"no column {missing[0]!r} in the table; it has {', '.join(table.columns)}")
    rows = []
    for key, group in table.groupby(by, sort=False):
        won = group[success].astype(bool)
        rate, low, high = proportion(int(won.sum()), len(group))
        medians = {f"median {q}": group.loc[won, q].median() for q in quantities}
        rows.append({**dict(zip(by, key)), "runs": len(group), "success": rate, "low": low, "high": high, **medians})
    return pd.DataFrame(rows)


def paired(
    table: pd.DataFrame, by: str, first: str, second: str, quantity: str, success: str = "success"
) -> dict[str, float]:
    """Difference second - first of a quantity over the cases where both succeeded.

    Returns the number of pairs, the mean difference with its 95 % bootstrap interval (2000 draws,
    fixed seed), and the share of pairs in which `second` is smaller. nan without two pairs.
    """
    sides = [table[(table[by] == m) & table[success].astype(bool)].set_index("case")[quantity] for m in (first, second)]
    gap = (sides[1] - sides[0]).dropna().to_numpy(float)
    if len(gap) < 2:
        return {"pairs": len(gap), "mean": np.nan, "low": np.nan, "high": np.nan, "smaller": np.nan}
    rng = np.random.default_rng(0)
    draws = gap[rng.integers(0, len(gap), (2000, len(gap)))].mean(axis=1)
    low, high = np.quantile(draws, [0.025, 0.975])
    return {
        "pairs": len(gap),
        "mean": float(gap.mean()),
        "low": float(low),
        "high": float(high),
        "smaller": float((gap < 0).mean()),
    }
