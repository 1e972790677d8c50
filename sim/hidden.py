"""When each object was hidden: intervals over the episode so far."""

from __future__ import annotations

from dataclasses import dataclass

from datmo.messages import Truth, Visibility


@dataclass(frozen=True)
class Hidden:
    """One object, wholly out of sight though within range.

    Attributes:
        actor: its id. start: stamp of the first scan in which it is hidden [s].
        end: stamp of the first scan in which it is not, None while it still is [s].
    """

    actor: int
    start: float
    end: float | None = None


class HiddenIntervals:
    """Collects the hidden intervals of every object, scan by scan.

    Hidden is `Visibility.HIDDEN`: the object would return at least 5 rays, and wins fewer than 5.
    Intervals are as the scans show them: nothing is merged and none is too short. An object that
    goes out of range, or out of the world, while hidden ends its interval with that scan.
    """

    def __init__(self) -> None:
        self._done: list[Hidden] = []
        self._open: dict[int, float] = {}

    def add(self, truth: Truth) -> None:
        """Take in the next scan's truth."""
        hidden = set(truth.boxes.id[truth.visibility == Visibility.HIDDEN].tolist())
        for actor in sorted(set(self._open) - hidden):
            self._done.append(Hidden(actor, self._open.pop(actor), truth.stamp))
        for actor in sorted(hidden - set(self._open)):
            self._open[actor] = truth.stamp

    def intervals(self) -> tuple[Hidden, ...]:
        """All intervals so far by start, those still open with no end."""
        still = [Hidden(actor, start) for actor, start in self._open.items()]
        return tuple(sorted([*self._done, *still], key=lambda i: (i.start, i.actor)))
