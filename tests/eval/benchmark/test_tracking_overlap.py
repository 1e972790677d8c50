from __future__ import annotations

import numpy as np
import pytest

from datmo.geometry import corners_bev
from datmo.messages import Boxes
from eval.benchmark.tracking_overlap import iou_3d


def some(rng: np.random.Generator, n: int) -> Boxes:
    return Boxes(rng.uniform(-3, 3, (n, 3)), rng.uniform(0.5, 5, (n, 3)), rng.uniform(-7, 7, n))


@pytest.mark.parametrize("seed", range(5))
def test_overlap_is_that_of_shapely(seed: int) -> None:
    from shapely import Polygon

    rng = np.random.default_rng(seed)
    a, b = some(rng, 20), some(rng, 25)
    got = iou_3d(a, b)
    areas = [[Polygon(c) for c in corners_bev(x.center, x.size, x.yaw)] for x in (a, b)]
    for i, p in enumerate(areas[0]):
        for j, q in enumerate(areas[1]):
            low = max(x.center[k, 2] - x.size[k, 2] / 2 for x, k in ((a, i), (b, j)))
            top = min(x.center[k, 2] + x.size[k, 2] / 2 for x, k in ((a, i), (b, j)))
            shared = p.intersection(q).area * max(top - low, 0)
            want = shared / (a.size[i].prod() + b.size[j].prod() - shared)
            assert got[i, j] == pytest.approx(want, abs=1e-9)


@pytest.mark.parametrize("yaw", [0.0, 0.3, np.pi / 2, -2.0])
def test_what_touches_or_coincides(yaw: float) -> None:
    one = Boxes([[10.0, -4, 1]], [[4.0, 2, 1.5]], [yaw])
    assert iou_3d(one, one)[0, 0] == pytest.approx(1)
    turned = Boxes(one.center, one.size, one.yaw + np.pi)
    assert iou_3d(one, turned)[0, 0] == pytest.approx(1)
    step = np.array([np.cos(yaw), np.sin(yaw), 0])
    for gap, want in ((2.0, 1 / 3), (4.0, 0.0), (9.0, 0.0)):
        moved = Boxes(one.center + gap * step, one.size, one.yaw)
        assert iou_3d(one, moved)[0, 0] == pytest.approx(want, abs=1e-9)
    above = Boxes(one.center + np.array([0, 0, 0.75]), one.size, one.yaw)
    assert iou_3d(one, above)[0, 0] == pytest.approx(1 / 3)
    inside = Boxes(one.center, one.size / 2, one.yaw)
    assert iou_3d(one, inside)[0, 0] == pytest.approx(1 / 8)


def test_none_at_all() -> None:
    one = some(np.random.default_rng(0), 3)
    assert iou_3d(one, Boxes.empty()).shape == (3, 0)
    assert iou_3d(Boxes.empty(), one).shape == (0, 3)
