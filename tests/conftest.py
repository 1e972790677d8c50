"""Shared by the tests: a small quick scenario, and where the real data lies."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import settings

from scenarios.spec import Scenario

# How long a case takes is the machine's affair, not the code's.
settings.register_profile("unhurried", deadline=None, derandomize=True)  # one run is as another
settings.load_profile("unhurried")
ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="session", autouse=True)
def _own_cache(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Grounds that tests build are kept for the session only, wherever the environment says nothing else.

    Processes that share the tests share them.
    """
    base = tmp_path_factory.getbasetemp()
    own = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    os.environ.setdefault("DATMO_CACHE_DIR", str(own / "cache"))


@pytest.fixture(scope="session")
def tiny() -> Scenario:
    """Real traffic, real rays, little ground: quick to build and quick to play."""
    return Scenario.model_validate(
        {
            "name": "tiny",
            "duration": 0.6,
            "terrain": {"grade": 0.03, "roughness": "C", "cell": 1.0},
            "traffic": {"vehicles": 4, "warm_up": 1.0},
            "sensor": {"range": 40.0},
        }
    )


@pytest.fixture(scope="session")
def real_data() -> Path:
    """The folder of real scans and tracks; the test is skipped where it is absent."""
    folder = Path(os.environ.get("DATMO_REAL_DATA", ROOT.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"no real data at {folder}; set DATMO_REAL_DATA")
    return folder
