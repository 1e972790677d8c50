"""docs/terrain.md tells every layer and every key of it."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import pytest

from scenarios.spec import TerrainFile, layers

TEXT = (Path(__file__).parents[2] / "docs" / "terrain.md").read_text()
LAYERS = get_args(get_args(layers.Layer)[0])


@pytest.mark.parametrize("model", LAYERS, ids=lambda m: m.__name__)
def test_every_layer_has_a_row_with_its_keys(model):
    name = model.model_fields["kind"].default
    (row,) = [
        line for line in TEXT.splitlines() if line.startswith("|") and f"`{name}`" in line.split("|")[1]
    ]
    for key in set(model.model_fields) - {"kind"}:
        assert f"`{key}`" in row, key


def test_every_key_of_a_file_is_told():
    for key in TerrainFile.model_fields:
        assert f"`{key}" in TEXT or f"{key}:" in TEXT, key
