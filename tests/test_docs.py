"""The docs name what the code has."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import BaseModel

from scenarios import spec
from scenarios.expect import UNITS
from sim.scan.units import unit_names

DOCS = Path(__file__).parents[1] / "docs"
MODELS = [m for m in vars(spec).values() if isinstance(m, type) and issubclass(m, spec.Model)]


@pytest.mark.parametrize("model", MODELS, ids=lambda m: m.__name__)
def test_every_key_of_a_scenario_is_told(model: type[BaseModel]) -> None:
    text = (DOCS / "scenarios.md").read_text()
    for key in model.model_fields:
        assert f"`{key}`" in text or f"{key}," in text or f"{key}:" in text or f"{key}}}" in text, key


def test_every_unit_of_the_sensor_is_told() -> None:
    text = (DOCS / "scenarios.md").read_text()
    for name in unit_names():
        assert name in text


def test_every_metric_is_told() -> None:
    text = (DOCS / "metrics.md").read_text()
    for name in UNITS:
        _, short = name.split(".")
        tail = short.split("_", 1)[-1]
        assert name in text or f".{short}`" in text or f"_{tail}`" in text, name
