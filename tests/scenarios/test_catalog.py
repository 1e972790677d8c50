from __future__ import annotations

import pytest

from datmo.errors import ScenarioError
from scenarios.catalog import names, path, summaries, tagged


def test_names_are_sorted_and_have_files() -> None:
    assert "rough-crossing" in names()
    assert list(names()) == sorted(names())
    assert all(path(name).is_file() for name in names())


def test_every_scenario_says_what_it_is() -> None:
    assert set(summaries()) == set(names())
    assert all(summaries().values())


def test_tags_select() -> None:
    assert "rough-crossing" in tagged("occlusion")
    assert "rough-crossing" not in tagged("smoke")
    assert tagged("smoke")
    assert tagged("nothing-like-it") == ()


def test_unknown_name() -> None:
    with pytest.raises(ScenarioError, match="did you mean 'empty-road'"):
        path("empty-rod")
