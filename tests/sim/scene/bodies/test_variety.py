from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from datmo.messages import Kind
from sim.scene import assets
from sim.scene.bodies.families import FAMILIES
from sim.scene.bodies.variety import SEEDS, Look, Variety, parse

LIMITS = {  # EU 96/53/EC for lorries and buses; segments A to F and large vans for the rest [m]
    Kind.CAR: ((3.3, 5.7), (1.55, 2.0), (1.35, 1.95)),
    Kind.VAN: ((4.5, 7.0), (1.8, 2.1), (1.8, 2.9)),
    Kind.TRUCK: ((7.0, 16.501), (2.4, 2.551), (3.1, 4.001)),
    Kind.BUS: ((11.0, 13.5), (2.4, 2.551), (2.9, 3.4)),
    Kind.MOTORCYCLE: ((1.7, 2.3), (0.6, 1.0), (1.4, 1.9)),
    Kind.BICYCLE: ((1.5, 2.0), (0.4, 0.9), (1.5, 2.0)),
    Kind.PEDESTRIAN: ((0.15, 1.3), (0.25, 0.8), (1.0, 2.1)),
}


@st.composite
def looks(draw):
    family = draw(st.sampled_from(list(FAMILIES.values())))
    still = Look(
        family.name, draw(st.integers(0, len(family.words) - 1)), seed=draw(st.integers(0, SEEDS - 1))
    )
    return draw(st.sampled_from(family.poses(still)))


@given(looks())
@settings(max_examples=60, deadline=None)
def test_every_body_is_closed_faces_outwards_and_has_a_size_of_its_kind(look):
    family = FAMILIES[look.name]
    shell = family.make(look, Variety(look))
    used = shell.vertices[shell.triangles.ravel()]
    assert np.isfinite(used).all()
    assert len(shell.triangles) < 3000
    assert ((shell.reflectivity > 0) & (shell.reflectivity <= 1)).all()
    aloft = look.gait == "run" and look.phase in (7, 15)
    assert (0.0 < used[:, 2].min() < 0.06) if aloft else used[:, 2].min() == pytest.approx(0, abs=1e-9)
    extent = np.ptp(used, axis=0)
    assert all(low < e < high for e, (low, high) in zip(extent, LIMITS[family.kind], strict=True)), extent
    mesh = trimesh.Trimesh(shell.vertices, shell.triangles, process=False)
    mesh.merge_vertices(digits_vertex=7)
    for part in mesh.split(only_watertight=False):
        assert part.volume > 0
        assert abs(part.area_faces @ part.face_normals).max() < 2e-4


@given(looks())
@settings(max_examples=60, deadline=None)
def test_a_key_says_what_it_was_made_of(look):
    assert parse(look.key) == look
    assert FAMILIES[look.name].has(look)


@pytest.mark.parametrize("key", assets.catalogue())
def test_seeds_differ_in_size_shape_or_shade_and_none_is_the_nominal_one(key):
    look = parse(key)
    family = FAMILIES[look.name]
    made = [
        family.make(one, Variety(one)) for one in (Look(look.name, look.variant, seed=n) for n in range(8))
    ]
    seen = {(tuple(np.ptp(s.vertices, axis=0).round(6)), float(s.reflectivity.sum())) for s in made}
    assert len(seen) == 8
    lengths = np.array([np.ptp(s.vertices, axis=0)[2] for s in made])
    assert 0.002 < np.ptp(lengths) / lengths[0] < 0.15


def test_a_body_varies_alike_in_all_its_forms():
    forms = [assets.asset(k) for k in ("pedestrian/0~5", "pedestrian/0/3~5", "pedestrian/0/run/8~5")]
    assert len({f.size for f in forms}) == 1
    assert forms[0].size != assets.asset("pedestrian/0").size
    assert set(map(float, forms[0].reflectivity)) == set(map(float, forms[1].reflectivity))


@pytest.mark.long  # the digests of fresh processes hold bodies too
def test_another_process_makes_the_same_bytes():
    code = (
        "import hashlib; from sim.scene.assets import asset; "
        "keys = ('car/1~7', 'pedestrian/3/4~31', 'bicycle/1/2~9', 'bus/0~1'); "
        "print(hashlib.sha256(b''.join(asset(k).vertices.tobytes() for k in keys)).hexdigest())"
    )
    told = {
        subprocess.run([sys.executable, "-c", code], check=True, capture_output=True).stdout for _ in "ab"
    }
    assert len(told) == 1


@given(looks())
@settings(max_examples=12, deadline=None)
def test_every_form_lies_within_the_one_box_of_its_body(look):
    a = assets.asset(look.key)
    assert a.size == assets.asset(look.still.key).size
    half = np.array([a.size[0] / 2, a.size[1] / 2])
    assert (np.abs(a.vertices[:, :2]) <= half + 1e-6).all()
    assert a.vertices[:, 2].min() >= 0
    assert a.vertices[:, 2].max() <= a.size[2] + 1e-6
