"""What a result depends on beside its inputs: versions and hardware."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = ("datmo-gym", "gymnasium", "highway-env", "embreex", "numpy", "scipy", "numba")


def versions() -> dict[str, str]:
    """Version of Python and of each package that a figure may depend on."""
    found = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def hardware() -> dict[str, str]:
    """Processor, cores and system."""
    return {"processor": _processor(), "cores": str(os.cpu_count()), "system": platform.platform(terse=True)}


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(errors="replace").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
