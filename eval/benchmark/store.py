"""Messages as flat named arrays, and files of them kept in the project's cache folder."""

from __future__ import annotations

import contextlib
import os
import tempfile
import zipfile
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar, get_type_hints

import numpy as np

from datmo.arrays import Array
from datmo.messages.base import Message
from sim.scene.terrain import cache

MOST_BYTES = 1_500_000_000
"""What all kept scenes may take up; the ones unused for longest go first."""

Arrays = dict[str, Array]
M = TypeVar("M", bound=Message)


def pack(message: Message, prefix: str) -> Arrays:
    """The fields of a message, and of the messages in it, as arrays named prefix.field."""
    arrays: Arrays = {}
    for field in fields(message):
        name, value = f"{prefix}.{field.name}", getattr(message, field.name)
        arrays |= pack(value, name) if isinstance(value, Message) else {name: np.asarray(value)}
    return arrays


def unpack(kind: type[M], arrays: Arrays, prefix: str) -> M:
    """The message that `pack` took apart.

    Raises:
        KeyError: a field is missing.
    """
    hints: dict[str, Any] = get_type_hints(kind)
    values: dict[str, Any] = {}
    for field in fields(kind):
        name, hint = f"{prefix}.{field.name}", hints[field.name]
        if isinstance(hint, type) and issubclass(hint, Message):
            values[field.name] = unpack(hint, arrays, name)
        else:
            values[field.name] = arrays[name][()] if arrays[name].ndim == 0 else arrays[name]
    return kind(**values)


def folder() -> Path | None:
    """Where scenes are kept, beside the grounds; None where the cache is off."""
    grounds = cache.folder()
    return None if grounds is None else grounds.parent / "scenes"


def kept(key: str, make: Callable[[], Arrays]) -> Arrays:
    """The arrays of a key from the disk, or made and then kept; the same bytes either way.

    A broken file is made anew; a folder that cannot be written is done without.
    """
    where = folder()
    if where is None:
        return make()
    path = where / f"{key}.npz"
    found = _read(path)
    if found is not None:
        return found
    made = make()
    with contextlib.suppress(OSError):
        _write(path, made)
        _trim(where, path)
    return made


def _read(path: Path) -> Arrays | None:
    try:
        with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    with contextlib.suppress(OSError):  # used: not the first to go
        os.utime(path)
    return arrays


def _write(path: Path, arrays: Arrays) -> None:
    """Beside it first, then renamed: no reader meets half a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, beside = tempfile.mkstemp(dir=path.parent, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            np.savez(file, **arrays)  # type: ignore[arg-type]
        os.replace(beside, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(beside)
        raise


def _trim(where: Path, keep: Path) -> None:
    """Delete what was unused for longest until all fits; not `keep`."""
    files = [(p.stat(), p) for p in where.glob("*.npz")]
    total = sum(stat.st_size for stat, _ in files)
    for stat, path in sorted(files, key=lambda f: f[0].st_mtime_ns):
        if total <= MOST_BYTES:
            return
        if path != keep:
            path.unlink(missing_ok=True)
            total -= stat.st_size
