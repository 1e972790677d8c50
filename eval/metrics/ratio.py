"""Small arithmetic that every metric shares: what has nothing to measure is None."""

from __future__ import annotations

from typing import Any

import numpy as np

from datmo.arrays import Array


def ratio(part: float, whole: float) -> float | None:
    """part / whole; None when the whole is zero."""
    return float(part) / float(whole) if whole else None


def f1(true: float, false: float, missed: float) -> float | None:
    """Harmonic mean of precision and recall from counts; None without any."""
    return ratio(2 * true, 2 * true + false + missed)


def mean(values: Any) -> float | None:
    """Mean; None when empty."""
    values = np.asarray(values, float)
    return float(values.mean()) if values.size else None


def root(value: float | None) -> float | None:
    """Square root; None stays None."""
    return None if value is None else float(np.sqrt(value))


def spread(values: Any) -> dict[str, float | None]:
    """Mean, median, 95th percentile and count of values (n,)."""
    array: Array = np.asarray(values, float)
    if not array.size:
        return {"mean": None, "median": None, "p95": None, "count": 0}
    median, p95 = np.percentile(array, [50, 95])
    return {"mean": float(array.mean()), "median": float(median), "p95": float(p95), "count": array.size}
