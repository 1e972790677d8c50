"""Slopes of the nearest lines, and the ground on each extractor."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from datmo.ground import GroundConfig, segment_ground
from datmo.ground.lines import EXTRACTORS, LineRules, as_array, extract_lines, nearest_slope, segment_slopes

NAMES: tuple[Any, ...] = tuple(EXTRACTORS)
every = pytest.mark.parametrize("name", NAMES)


def cloud(M: int = 5, N: int = 60) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(4)
    r = np.linspace(2, 60, N) + rng.uniform(0, 0.5, (M, N))
    z = np.cumsum(rng.normal(0, 0.05, (M, N)), 1)
    present = rng.random((M, N)) < 0.8
    present[0] = False
    return r, z, present


@every
def test_slopes_are_those_of_the_nearest_line(name: Any) -> None:
    r, z, present = cloud()
    nodes = np.linspace(0, 70, 20)
    at, at_nodes, count = segment_slopes(r, z, present, nodes, as_array(LineRules()), 0.02, name)
    assert (at[~present] == 0.02).all()
    assert (at_nodes[0] == 0.02).all()
    for m in range(5):
        lines = extract_lines(r[m, present[m]], z[m, present[m]], method=name)
        assert count[m] == len(lines)
        assert m == 0 or len(lines)
        for q, slope in zip([*nodes, *r[m, present[m]]], [*at_nodes[m], *at[m, present[m]]], strict=True):
            gaps = [max(line[0] - q, q - line[1], 0) for line in lines]
            assert slope == (abs(lines[int(np.argmin(gaps)), 2]) if gaps else 0.02)


@every
def test_every_segment_has_the_same_chances(name: Any) -> None:
    """Turning the cloud by a segment turns the result."""
    r, z, present = cloud()
    ask = np.linspace(0, 70, 20), as_array(LineRules(join=0.06)), 0.02, name
    here = segment_slopes(r, z, present, *ask)
    turned = segment_slopes(*(np.roll(a, 1, 0) for a in (r, z, present)), *ask)
    for a, b in zip(here, turned, strict=True):
        assert np.array_equal(np.roll(a, 1, 0), b)


def test_without_lines_the_slope_is_the_default() -> None:
    out = np.empty(3)
    nearest_slope(np.arange(3.0), np.empty((0, 7)), 0, 0.05, out)
    assert out.tolist() == [0.05] * 3


@pytest.mark.parametrize(
    "name", [n if n == "incremental" else pytest.param(n, marks=pytest.mark.long) for n in NAMES]
)
def test_the_ground_runs_on_each(name: Any, scene: Any, judge: Any) -> None:
    made = scene("D", grade=0.05, columns=521)
    ground = segment_ground(made.points, config=GroundConfig(lines=name))
    f1, leak = judge(made, ground.is_ground)
    assert f1 > 0.985
    assert leak < 0.08
    again = segment_ground(made.points, config=GroundConfig(lines=name))
    assert again == ground


def test_an_unknown_extractor_is_no_config() -> None:
    with pytest.raises(ValidationError, match="lines"):
        GroundConfig(lines="ransack")  # type: ignore[arg-type]
