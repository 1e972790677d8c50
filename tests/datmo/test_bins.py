from __future__ import annotations

import numpy as np
import pytest

from datmo.bins import bin_edges
from datmo.errors import ConfigError


@pytest.mark.parametrize(("n", "blind", "radius"), [(120, 2.0, 80.0), (60, 0.0, 50.0), (1, 3.0, 120.0)])
def test_edges_span_the_range_and_widen(n: int, blind: float, radius: float) -> None:
    edges = bin_edges(n, blind, radius)
    width = np.diff(edges)
    assert edges.shape == (n + 1,)
    assert (edges[0], edges[-1]) == (blind, radius)
    assert (width > 0).all()
    assert (np.diff(width) > -1e-6).all()


def test_default_widths_follow_the_rings() -> None:
    edges = bin_edges()
    width = np.diff(edges)
    assert width[0] < 0.12
    assert 0.4 < width[np.searchsorted(edges, 10.0) - 1] < 0.6
    assert 0.95 < width[-1] < 1.05


@pytest.mark.parametrize(("n", "blind", "radius"), [(0, 2, 80), (10, 5, 5), (10, -1, 5), (10, 1, np.inf)])
def test_bad_bins_are_refused(n: int, blind: float, radius: float) -> None:
    with pytest.raises(ConfigError, match="n must be at least 1"):
        bin_edges(n, blind, radius)
