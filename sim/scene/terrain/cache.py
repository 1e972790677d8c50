"""Grounds once built, kept on disk by all that they are made of.

A file is named by the SHA-256 of the scenario's terrain, the roads, the grid, the seed, the content of
a terrain file, the versions of numpy, scipy and numba, the processor's kind, and the code that builds.
`DATMO_CACHE_DIR` names the folder, or says `off`.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import platform
import sys
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

import numba
import numpy as np
import scipy

from datmo.arrays import F32, F64, U8
from scenarios import spec
from sim.scene import roads as roads_code
from sim.scene import roughness as roughness_code
from sim.scene.roads import Road
from sim.scene.terrain.grid import Grid

VARIABLE = "DATMO_CACHE_DIR"
MOST_BYTES = 1_000_000_000
"""What all kept grounds may take up; the ones unused for longest go first."""


def folder() -> Path | None:
    """Where grounds are kept; None where `DATMO_CACHE_DIR` is `off`."""
    said = os.environ.get(VARIABLE, "")
    if said.lower() == "off":
        return None
    if said:
        return Path(said).expanduser() / "terrain"
    home = Path(os.path.expanduser("~"))  # unlike Path.home() it lives without one
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", home / "AppData" / "Local"))
    elif sys.platform == "darwin":
        base = home / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache")
    return base / "datmo-gym" / "terrain"


def key_of(terrain: spec.Terrain, roads: Sequence[Road], grid: Grid, seed: np.random.SeedSequence) -> str:
    """The name, 64 hexadecimal digits, of a ground."""
    digest = hashlib.sha256(_makers())
    for part in (terrain.model_dump_json(), repr(grid), repr((seed.entropy, seed.spawn_key))):
        digest.update(part.encode() + b"\0")
    for road in roads:
        digest.update(repr((road.width, road.centerline.shape)).encode())
        digest.update(road.centerline.tobytes())
    if terrain.file is not None:
        with contextlib.suppress(OSError):  # the builder tells what is wrong with it
            digest.update(Path(terrain.file.path).read_bytes())
    return digest.hexdigest()


def kept(key: str, shape: tuple[int, int], build: Callable[[], tuple[F64, U8]]) -> tuple[F32, U8]:
    """Heights and kinds from the disk, or built and then kept; the same bytes either way.

    A file that is broken or of another shape is built anew; a folder that cannot be written is
    done without.
    """
    where = folder()
    path = None if where is None else where / f"{key}.npz"
    found = None if path is None else _read(path, shape)
    if found is not None:
        return found
    height, kind = build()
    made = height.astype(np.float32), kind
    if path is not None:
        with contextlib.suppress(OSError):
            _write(path, *made)
            _trim(path.parent, path)
    return made


def _read(path: Path, shape: tuple[int, int]) -> tuple[F32, U8] | None:
    try:
        with np.load(path, allow_pickle=False) as file:
            height, kind = file["height"], file["kind"]
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    with contextlib.suppress(OSError):  # used: not the first to go
        os.utime(path)
    right = height.shape == shape and kind.shape == (shape[0] - 1, shape[1] - 1)
    typed = height.dtype == np.float32 and kind.dtype == np.uint8
    return (height, kind) if right and typed else None


def _write(path: Path, height: F32, kind: U8) -> None:
    """Beside it first, then renamed: no reader meets half a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, beside = tempfile.mkstemp(dir=path.parent, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            np.savez(file, height=height, kind=kind)
        os.replace(beside, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(beside)
        raise


def _trim(where: Path, keep: Path) -> None:
    """Delete what was unused for longest, and what a killed process left, until all fits; not `keep`."""
    files = [(p.stat(), p) for ending in ("*.npz", "*.part") for p in where.glob(ending)]
    total = sum(stat.st_size for stat, _ in files)
    for stat, path in sorted(files, key=lambda f: f[0].st_mtime_ns):
        if total <= MOST_BYTES:
            return
        if path != keep:
            path.unlink(missing_ok=True)
            total -= stat.st_size


@cache
def _makers() -> bytes:
    """Who builds: the code of this package and of what it calls, and the libraries under it."""
    here = Path(__file__).parent
    code = [*sorted(here.glob("*.py")), Path(roads_code.__file__), Path(roughness_code.__file__)]
    versions = np.__version__, scipy.__version__, numba.__version__, platform.machine()
    digest = hashlib.sha256(" ".join(versions).encode())
    for path in code:
        digest.update(path.read_bytes())
    return digest.digest()
