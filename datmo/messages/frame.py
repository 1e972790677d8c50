"""Frame: everything perception made of one scan."""

from __future__ import annotations

from dataclasses import dataclass, field

from datmo.messages.base import Message
from datmo.messages.ground import Ground
from datmo.messages.objects import Boxes, Clusters, Tracks
from datmo.messages.scan import Scan


@dataclass(frozen=True, eq=False)
class Frame(Message):
    """The output of `Datmo.step`, stage by stage.

    Attributes:
        scan, ground, clusters, boxes, tracks: the message of each stage.
        milliseconds: time of each stage [ms]; not compared.
        notes: what a stage has to say to whoever debugs it (reasons of rejected boxes,
            points dropped, bounds hit).
    """

    scan: Scan
    ground: Ground
    clusters: Clusters
    boxes: Boxes
    tracks: Tracks
    milliseconds: dict[str, float] = field(default_factory=dict, metadata={"compare": False})
    notes: dict[str, str] = field(default_factory=dict)
