from __future__ import annotations

import numpy as np
import pytest

from datmo.messages import Kind
from sim.scan.returns import BLUR, FADE, FAINTEST
from sim.scan.surface import _kept
from sim.scene import assets
from sim.scene.bodies import materials as m


def returned(key, away, focus=24.0):
    """Share of the light on windows, and on all else, that comes back from `away` [m] beyond the body.

    Seen from eight sides, 1.9 m above the ground; triangles weigh as much as they show. `focus` is that
    of the receiver [m]: 24 in the upper block of an S3.
    """
    a = assets.asset(key)
    p, q, r = np.moveaxis(a.vertices.astype(float)[a.triangles], 1, 0)
    middle, normal = (p + q + r) / 3, np.cross(q - p, r - p) / 2
    area = np.linalg.norm(normal, axis=1)
    shown, kept = np.zeros(2), np.zeros(2)
    for turn in 2 * np.pi * np.arange(8) / 8:
        ahead = np.array([np.cos(turn), np.sin(turn)])
        eye = np.append(ahead * ((np.abs(ahead) * a.size[:2]).sum() / 2 + away), 1.9)
        ray = eye - middle
        R = np.linalg.norm(ray, axis=1)
        cosine = np.maximum((normal * ray).sum(1) / (area * R), 0)
        power = a.reflectivity * np.array([_kept(c, 0.0) for c in cosine]) / R**2
        power /= 1 + (BLUR * (1 / R - 1 / focus)) ** 2
        weight = area * cosine / R**2
        back = power**FADE / (power**FADE + FAINTEST**FADE)
        for k, those in enumerate((a.reflectivity < 0.01, a.reflectivity >= 0.01)):
            shown[k] += weight[those].sum()
            kept[k] += (weight * back)[those].sum()
    return kept / shown


@pytest.mark.parametrize("key", assets.keys(Kind.CAR))
def test_four_in_five_rays_at_windows_do_not_come_back_from_eight_metres(key):
    """As from two cars in three sweeps of a real HDL-64E; nearly all else of a car returns."""
    glass, rest = returned(key, 7.0)
    assert 0.08 < glass < 0.35
    assert rest > 0.85  # bonnets of dark cars go with the windscreens
    assert returned(key, 30.0)[0] < 0.05
    assert returned(key, 7.0, focus=9.5)[0] > 0.6  # the lower block sees them


def test_only_what_has_windows_has_glass():
    glazed = {k.split("/")[0] for k in assets.catalogue() if (assets.asset(k).reflectivity < 0.01).any()}
    assert glazed == {"car", "van", "truck", "bus"}
    assert np.float32(m.GLASS) in assets.asset("bus/0").reflectivity
