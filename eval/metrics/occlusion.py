"""Detection recall by how much of the object the sensor sees."""

from __future__ import annotations

from datmo.messages import Truth, Visibility
from eval.metrics.detection import Matched
from eval.metrics.ratio import ratio

CLASSES = (Visibility.VISIBLE, Visibility.PARTIAL, Visibility.HEAVY)


class OcclusionScores:
    """Objects with at least five returns, and those found, by visibility."""

    def __init__(self) -> None:
        self._objects = dict.fromkeys(CLASSES, 0)
        self._found = dict.fromkeys(CLASSES, 0)

    def add(self, truth: Truth, matched: Matched) -> None:
        """Take in one scan."""
        for name in CLASSES:
            rows = matched.valid & (truth.visibility == name)
            self._objects[name] += int(rows.sum())
            self._found[name] += int((rows & matched.found).sum())

    def scores(self) -> dict[str, float | None]:
        """The named scores."""
        return {
            f"occlusion.recall_{name.name.lower()}": ratio(self._found[name], self._objects[name])
            for name in CLASSES
        }

    def detail(self) -> dict[str, int]:
        """How many objects each recall speaks of."""
        return {name.name.lower(): count for name, count in self._objects.items()}
