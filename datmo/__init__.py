"""Detection and tracking of moving objects from lidar scans.

from datmo import Datmo, Scan
frame = Datmo().step(scan)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from datmo.messages import Boxes, Frame, Ground, Scan, Tracks, Truth
    from datmo.pipeline import Datmo

__all__ = ["Boxes", "Datmo", "Frame", "Ground", "Scan", "Tracks", "Truth"]


def __getattr__(name: str) -> Any:
    """Import on first use, so that `import datmo` is quick and messages load alone."""
    if name == "Datmo":
        from datmo.pipeline import Datmo

        return Datmo
    if name in __all__:
        import datmo.messages

        return getattr(datmo.messages, name)
    raise AttributeError(f"module 'datmo' has no attribute {name!r}")
