"""One SHA-256 over scans and truths: two runs are the same, byte for byte, or they are not."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import fields
from typing import Any

import numpy as np

from datmo.messages import Scan, Truth
from datmo.messages.base import Message


class Digest:
    """SHA-256 over messages in the order in which they come.

    Every field takes part but measured times, with its name, type and shape, so that no two
    different streams of messages feed the same bytes.
    """

    def __init__(self) -> None:
        self._hash = hashlib.sha256()

    def add(self, message: Message) -> None:
        """Take in one message."""
        self._hash.update(type(message).__name__.encode())
        for field in fields(message):
            if field.metadata.get("compare", True):
                self._field(field.name, getattr(message, field.name))

    def hex(self) -> str:
        """The digest of what was taken in so far, 64 hexadecimal digits."""
        return self._hash.hexdigest()

    def _field(self, name: str, value: Any) -> None:
        if isinstance(value, Message):
            self._hash.update(name.encode())
            self.add(value)
            return
        array = np.ascontiguousarray(value)
        self._hash.update(f"{name} {array.dtype.str} {array.shape}".encode())
        self._hash.update(array.tobytes())


def digest(pairs: Iterable[tuple[Scan, Truth]]) -> str:
    """SHA-256 (hexadecimal) over the scans and truths of an episode."""
    total = Digest()
    for scan, truth in pairs:
        total.add(scan)
        total.add(truth)
    return total.hex()
