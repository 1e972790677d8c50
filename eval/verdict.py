"""Verdicts: which expectations of a scenario a run meets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from eval.score import Metric
from scenarios.spec import Bound


@dataclass(frozen=True)
class Verdict:
    """One expectation held against one value.

    Attributes:
        name: the metric. value: None where there was nothing to measure. unit.
        bound: as text, e.g. "≥ 0.97" or "0.1 … 0.3".
        met: whether the value lies within; a metric with nothing to measure meets nothing.
        open: the run was cut short, and what it lacks may still come: nothing measured yet, or too
            small a count. Neither met nor failed.
    """

    name: str
    value: float | None
    unit: str
    bound: str
    met: bool
    open: bool = False

    @property
    def failed(self) -> bool:
        """Not met, and nothing to wait for."""
        return not (self.met or self.open)

    @property
    def word(self) -> str:
        """The verdict in a word or two."""
        return "met" if self.met else "open" if self.open else "not met"


def judge(expect: Mapping[str, Bound], metrics: Sequence[Metric], whole: bool = True) -> list[Verdict]:
    """A verdict for each expectation, in the order of the scenario.

    Args:
        expect: metric -> bounds. metrics: of the run.
        whole: whether the scenario was played to its end; if not, some verdicts stay open.
    """
    found = {m.name: m for m in metrics}
    verdicts = []
    for name, bound in expect.items():
        metric = found[name]
        met = within(bound, metric.value)
        awaited = metric.value is None or (metric.unit == "count" and metric.value < (bound.min or 0))
        verdicts.append(
            Verdict(name, metric.value, metric.unit, say_bound(bound), met, not (met or whole) and awaited)
        )
    return verdicts


def within(bound: Bound, value: float | None) -> bool:
    """Whether a value meets a bound, ends included; None and NaN do not."""
    if value is None or value != value:
        return False
    return (bound.min is None or value >= bound.min) and (bound.max is None or value <= bound.max)


def say_bound(bound: Bound) -> str:
    """A bound in signs."""
    if bound.min is None:
        return f"≤ {bound.max:g}"
    if bound.max is None:
        return f"≥ {bound.min:g}"
    return f"{bound.min:g} … {bound.max:g}"


def say_value(value: float | None) -> str:
    """A value to four significant figures, "-" where there was nothing to measure."""
    return "-" if value is None or value != value else f"{value:.4g}"
