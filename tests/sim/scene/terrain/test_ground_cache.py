"""Grounds kept on disk: the same bytes, told apart by everything that makes them."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from scenarios import spec
from sim.scene.roads import Road
from sim.scene.terrain import build, build_terrain, cache

AREA = (-6.0, -5.0, 6.0, 5.0)
ROAD = Road(np.array([[-9.0, 0.0], [9.0, 1.0]]), 4.0)
GROUND = spec.Terrain(cell=0.5, roughness="D", layers=[{"kind": "hills", "density": 50}])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("DATMO_CACHE_DIR", str(tmp_path / "kept"))
    return tmp_path / "kept" / "terrain"


def built(terrain=GROUND, roads=(ROAD,), area=AREA, seed=7):
    return build_terrain(terrain, roads, area, np.random.SeedSequence(seed))


def same(a, b):
    return a.height.tobytes() == b.height.tobytes() and a.kind.tobytes() == b.kind.tobytes()


def forbid(monkeypatch):
    def never(*_):
        raise AssertionError("built anew")

    monkeypatch.setattr(build, "_raise", never)


def test_a_kept_ground_has_the_bytes_of_a_built_one(folder, monkeypatch):
    first = built()
    assert len(list(folder.iterdir())) == 1
    forbid(monkeypatch)
    again = built()
    assert same(first, again)
    assert again.height.dtype == np.float64
    assert again.height.flags.c_contiguous == first.height.flags.c_contiguous


def test_off_keeps_nothing(folder, monkeypatch):
    kept = built()
    monkeypatch.setenv("DATMO_CACHE_DIR", "off")
    assert cache.folder() is None
    monkeypatch.setattr(cache, "_read", None)  # not even looked at
    assert same(built(), kept)


@pytest.mark.parametrize("broken", [b"", b"nonsense", None])
def test_a_broken_file_is_built_anew(folder, broken, monkeypatch):
    first = built()
    (path,) = folder.iterdir()
    whole = path.read_bytes()
    if broken is None:
        broken = bytearray(whole)
        broken[len(whole) // 2] ^= 0xFF
    path.write_bytes(broken)
    assert same(built(), first)
    assert path.read_bytes() == whole
    forbid(monkeypatch)
    built()


def test_a_file_of_another_shape_is_built_anew(folder):
    first = built()
    (path,) = folder.iterdir()
    np.savez(path, height=np.zeros((3, 3), np.float32), kind=np.zeros((2, 2), np.uint8))
    assert same(built(), first)


def test_all_that_makes_a_ground_tells_it_apart(folder, tmp_path):
    np.save(tmp_path / "map.npy", np.zeros((40, 40)))
    from_file = GROUND.model_copy(
        update={"file": spec.TerrainFile(path=str(tmp_path / "map.npy"), pixel=1.0)}
    )
    cases = [
        {},
        {"seed": 8},
        {"area": (-6.0, -5.0, 6.5, 5.0)},
        {"roads": ()},
        {"roads": (Road(ROAD.centerline, 4.5),)},
        {"roads": (Road(ROAD.centerline + 0.1, 4.0),)},
        {"terrain": GROUND.model_copy(update={"grade": 0.01})},
        {"terrain": GROUND.model_copy(update={"layers": ()})},
        {"terrain": from_file},
    ]
    for count, case in enumerate(cases, 1):
        built(**case)
        assert len(list(folder.iterdir())) == count
    np.save(tmp_path / "map.npy", np.ones((40, 40)))
    assert built(terrain=from_file).height.mean() > 0.5


def test_a_spawned_seed_is_another(folder):
    child = np.random.SeedSequence(7).spawn(1)[0]
    assert not same(built(), build_terrain(GROUND, (ROAD,), AREA, child))


def test_a_folder_that_cannot_be_written_is_done_without(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("DATMO_CACHE_DIR", str(tmp_path / "file"))
    assert np.isfinite(built().height).all()


def test_the_oldest_go_first_when_there_are_too_many(folder, monkeypatch):
    built(seed=0)
    (path,) = folder.iterdir()
    monkeypatch.setattr(cache, "MOST_BYTES", int(2.5 * path.stat().st_size))
    os.utime(path, (1, 1))
    built(seed=1)
    old = next(p for p in folder.iterdir() if p != path)
    os.utime(old, (2, 2))
    built(seed=0)  # used again: no longer the oldest
    built(seed=2)
    assert path.exists()
    assert not old.exists()
    assert len(list(folder.iterdir())) == 2


def test_no_reader_meets_half_a_file(folder, monkeypatch):
    def fail(*_, **__):
        raise OSError("disk full")

    monkeypatch.setattr(np, "savez", fail)
    assert np.isfinite(built().height).all()
    assert list(folder.iterdir()) == []


@pytest.mark.long
def test_a_fresh_process_builds_the_same_bytes(folder):
    code = """
import hashlib, numpy as np
from scenarios import spec
from sim.scene.roads import Road
from sim.scene.terrain import build_terrain
ground = spec.Terrain(cell=0.5, roughness="D", layers=[{"kind": "hills", "density": 50}])
road = Road(np.array([[-9.0, 0.0], [9.0, 1.0]]), 4.0)
t = build_terrain(ground, [road], (-6.0, -5.0, 6.0, 5.0), np.random.SeedSequence(7))
print(hashlib.sha256(t.height.tobytes() + t.kind.tobytes()).hexdigest())
"""
    environment = {**os.environ, "DATMO_CACHE_DIR": "off"}
    said = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    ).stdout.strip()
    here = built()
    assert said == hashlib.sha256(here.height.tobytes() + here.kind.tobytes()).hexdigest()


def test_many_at_once_agree_and_leave_nothing_half_done(folder):
    with ThreadPoolExecutor(4) as pool:
        made = list(pool.map(lambda _: built(), range(8)))
    assert all(same(made[0], other) for other in made)
    assert [p.suffix for p in folder.iterdir()] == [".npz"]


def test_the_folder_is_the_platforms_own(monkeypatch, tmp_path):
    monkeypatch.delenv("DATMO_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(sys, "platform", "linux")
    assert cache.folder() == tmp_path / "datmo-gym" / "terrain"
