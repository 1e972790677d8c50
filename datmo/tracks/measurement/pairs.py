"""Links of tracks with boxes."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from datmo.arrays import F64, I64, Array, Bool


@dataclass
class Pairs:
    """Links of a track with a box that might be its own, p rows.

    Attributes:
        track, box: (p,) rows.
        z: (p, 2) the box's centre as this track reads it [m]. R: (p, 2, 2) its noise [m²].
        seen: (p, 2) extent along the track's own axes [m].
        yaw: (p,) [rad], NaN where not sure. yaw_var: (p,) [rad²].
        turned: (p,) box yaw in the track's axes [rad].
        real: (p, 2, 2) by side and end (back, front) of the box in the track's axes: whether rays show it
            to be real.
        distance: (p,) squared Mahalanobis distance. volume: (p,) of the gate [m²].
    """

    track: I64
    box: I64
    z: F64
    R: F64
    seen: F64
    yaw: F64
    yaw_var: F64
    turned: F64
    real: Bool
    distance: F64
    volume: F64

    def __len__(self) -> int:
        return len(self.track)

    @property
    def whole(self) -> Bool:
        """(p, 2) whether both ends of each side are real."""
        return np.asarray(self.real.all(axis=2))

    def select(self, rows: Array) -> Pairs:
        """The pairs of `rows`."""
        return Pairs(*(getattr(self, f.name)[rows] for f in fields(self)))
