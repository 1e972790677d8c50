"""Grounds from files: every format there and back, and everything that can be wrong with one."""

from __future__ import annotations

import builtins
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from datmo.errors import ScenarioError
from scenarios import spec
from scenarios.load import load
from sim.scene.terrain import build_terrain

AREA = (-8.0, -6.0, 8.0, 6.0)
SEED = np.random.SeedSequence(1)


@pytest.fixture(autouse=True)
def _no_cache(monkeypatch):
    monkeypatch.setenv("DATMO_CACHE_DIR", "off")


def slanted(x, y):
    """A plane, which bilinear pixels and flat triangles both hold exactly."""
    return 3 + 0.25 * x - 0.5 * y


def built(path, area=AREA, **file):
    return build_terrain(spec.Terrain(cell=0.5, file={"path": str(path), **file}), [], area, SEED)


def assert_slanted(terrain, tolerance=1e-5):
    xy = np.random.default_rng(0).uniform(AREA[:2], AREA[2:], (200, 2))
    assert terrain.height_at(xy) == pytest.approx(slanted(*xy.T), abs=tolerance)


def pixels():
    """Heights of a map of 1 m pixels, 21 by 17, row 0 at the lowest y."""
    x, y = np.meshgrid(np.arange(-10.0, 11), np.arange(-8.0, 9))
    return slanted(x, y)


def test_a_numpy_array_has_its_lowest_y_first(tmp_path):
    np.save(tmp_path / "map.npy", pixels())
    assert_slanted(built(tmp_path / "map.npy", pixel=1.0))


def test_the_corner_and_the_scale_place_a_map(tmp_path):
    np.save(tmp_path / "map.npy", pixels().astype(np.float32) - 3)
    terrain = built(
        tmp_path / "map.npy",
        pixel=1.0,
        height_scale=2.0,
        height_offset=7.0,
        corner=[-20.0, -30.0],
        area=(-19, -29, -1, -15),
    )
    assert terrain.height_at(np.array([[-10.0, -22.0]])) == pytest.approx([7.0], abs=1e-5)
    assert terrain.height_at(np.array([[-6.0, -22.0]])) == pytest.approx([9.0], abs=1e-5)


@pytest.mark.parametrize(("depth", "scale"), [(np.uint8, 0.25 / 4), (np.uint16, 1 / 1024)])
def test_a_png_is_seen_from_above_its_top_row_north(tmp_path, depth, scale):
    steps = np.round((pixels() + 6) / scale)
    assert steps.max() <= np.iinfo(depth).max
    Image.fromarray(steps[::-1].astype(depth)).save(tmp_path / "map.png")
    assert_slanted(built(tmp_path / "map.png", pixel=1.0, height_scale=scale, height_offset=-6.0), scale)


def test_between_pixels_heights_are_bilinear(tmp_path):
    values = np.random.default_rng(2).normal(size=(9, 12))
    np.save(tmp_path / "map.npy", values)
    terrain = built(tmp_path / "map.npy", pixel=2.0, corner=[0, 0], area=(0, 0, 22, 16))
    for x, y in ((3.0, 5.0), (20.5, 0.5), (22, 16)):
        i, j = min(int(x / 2), 10), min(int(y / 2), 7)
        u, v = x / 2 - i, y / 2 - j
        low, high = (values[k, i] * (1 - u) + values[k, i + 1] * u for k in (j, j + 1))
        assert terrain.height_at(np.array([[x, y]])) == pytest.approx([low * (1 - v) + high * v], abs=1e-6)


def test_a_geotiff_tells_its_own_spacing(tmp_path):
    tifffile = pytest.importorskip("tifffile")
    scale = (33550, "d", 3, (1.0, 1.0, 0.0), False)
    tie = (33922, "d", 6, (0.0, 0.0, 0.0, 5e5, 4.5e6, 0.0), False)
    keys = (34735, "H", 4, (1, 1, 0, 0), False)
    path = tmp_path / "map.tif"
    tifffile.imwrite(path, pixels()[::-1].astype(np.float32), extratags=[scale, tie, keys])
    assert_slanted(built(path))
    tifffile.imwrite(
        path,
        pixels()[::-1].astype(np.float32),
        compression="zlib",
        extratags=[(42113, "s", 0, "-9999", True)],
    )
    assert_slanted(built(path, pixel=1.0))
    gap = pixels().astype(np.float32)
    gap[3, 4] = -9999
    tifffile.imwrite(path, gap, extratags=[(42113, "s", 0, "-9999", True)])
    with pytest.raises(ScenarioError, match="1 of 357 pixels hold no height, the first in row 3, column 4"):
        built(path, pixel=1.0)


def test_a_tiff_without_the_library_names_the_extra(tmp_path, monkeypatch):
    (tmp_path / "map.tif").write_bytes(b"II*\0")
    real = builtins.__import__

    def without(name, *args, **kwargs):
        if name == "tifffile":
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(ScenarioError, match=r"datmo-gym\[geo\]"):
        built(tmp_path / "map.tif", pixel=1.0)


def plate(low=(-10.0, -8.0), high=(10.0, 8.0)):
    """A mesh of the plane with uneven triangles."""
    rng = np.random.default_rng(3)
    x, y = (np.concatenate([[a], np.sort(rng.uniform(a, b, 6)), [b]]) for a, b in zip(low, high, strict=True))
    X, Y = np.meshgrid(x, y)
    corner = (np.arange(7)[:, None] * 8 + np.arange(7)).ravel()
    faces = np.vstack(
        [np.column_stack([corner, corner + 1, corner + 9]), np.column_stack([corner, corner + 9, corner + 8])]
    )
    vertices = np.column_stack([X.ravel(), Y.ravel(), slanted(X, Y).ravel()])
    return trimesh.Trimesh(vertices, faces, process=False)


@pytest.mark.parametrize("ending", ["obj", "ply", "stl", "off", "glb"])
def test_every_mesh_format_gives_its_plane(tmp_path, ending):
    plate().export(tmp_path / f"ground.{ending}")
    assert_slanted(built(tmp_path / f"ground.{ending}"), 2e-5)


def test_the_topmost_surface_counts_and_walls_do_not(tmp_path):
    table = trimesh.creation.box((4.0, 3.0, 0.5), trimesh.transformations.translation_matrix((2, 1, 9)))
    trimesh.util.concatenate([plate(), table]).export(tmp_path / "ground.ply")
    terrain = built(tmp_path / "ground.ply")
    assert terrain.height_at(np.array([[2.0, 1.0], [3.9, 2.0], [-3, 1]])) == pytest.approx(
        [9.25, 9.25, slanted(-3, 1)], abs=1e-5
    )


def test_a_mesh_may_lie_on_its_side_and_elsewhere(tmp_path):
    mesh = plate()
    mesh.vertices = (mesh.vertices - [100, 50, 3]) * 100
    mesh.vertices = mesh.vertices[:, [0, 2, 1]] * [1, 1, -1]  # y up, as many tools write it
    mesh.export(tmp_path / "ground.obj")
    assert_slanted(
        built(tmp_path / "ground.obj", up="y", height_scale=0.01, shift=[100, 50], height_offset=3), 1e-4
    )


def test_a_file_smaller_than_the_drive_names_both_extents_or_is_clamped(tmp_path):
    np.save(tmp_path / "map.npy", pixels())
    wide = (-30.0, -6.0, 8.0, 6.0)
    with pytest.raises(ScenarioError, match=r"x -10.0 to 10.0 m, y -8.0 to 8.0 m.*x -30.0 to 8.0 m.*clamp"):
        built(tmp_path / "map.npy", pixel=1.0, area=wide)
    clamped = built(tmp_path / "map.npy", pixel=1.0, area=wide, outside="clamp")
    assert clamped.height_at(np.array([[-25.0, 2.0]])) == pytest.approx([slanted(-10, 2)], abs=1e-5)
    plate().export(tmp_path / "ground.ply")
    with pytest.raises(ScenarioError, match=r"covers x -10.0 to 10.0 m"):
        built(tmp_path / "ground.ply", area=wide)
    assert built(tmp_path / "ground.ply", area=wide, outside="clamp").height_at(
        np.array([[-25.0, 2.0]])
    ) == pytest.approx([slanted(-10, 2)], abs=1e-5)


def holed():
    mesh = plate()
    mesh.update_faces(np.arange(len(mesh.faces)) != 48)
    return mesh


def broken():
    mesh = plate()
    mesh.vertices[5, 2] = np.nan
    return mesh


@pytest.mark.parametrize(
    ("mesh", "match"),
    [
        (holed, r"holes: no face over \d+ of \d+ places, the first at \("),
        (broken, "1 of 64 vertices are not finite, the first is number 5"),
        (lambda: trimesh.PointCloud(plate().vertices), "no faces|cannot be read"),
    ],
)
def test_broken_meshes_are_refused(tmp_path, mesh, match):
    mesh().export(tmp_path / "ground.ply")
    with pytest.raises(ScenarioError, match=match):
        built(tmp_path / "ground.ply")


@pytest.mark.parametrize(
    ("name", "content", "match"),
    [
        ("none.npy", None, "is no file"),
        ("map.xyz", b"1 2 3", "must be a height map or a mesh"),
        ("map.npy", b"\x93NUMPY broken", "cannot be read"),
        ("map.png", b"not a picture", "cannot be read"),
        ("map.tif", b"not a picture", "cannot be read|datmo-gym"),
        ("ground.obj", b"", "no faces|cannot be read"),
        ("ground.ply", b"ply\nnonsense", "cannot be read"),
    ],
)
def test_broken_files_are_refused(tmp_path, name, content, match):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(ScenarioError, match=match):
        built(tmp_path / name, pixel=1.0, height_scale=1.0)


@pytest.mark.parametrize(
    ("values", "match"),
    [
        (np.full((4, 5), np.nan), "20 of 20 pixels hold no height"),
        (np.zeros((4, 5, 3)), "one number a pixel"),
        (np.zeros((1, 5)), "rows >= 2"),
        (np.array([["a", "b"], ["c", "d"]]), "one number a pixel"),
    ],
)
def test_arrays_that_are_no_map_are_refused(tmp_path, values, match):
    np.save(tmp_path / "map.npy", values)
    with pytest.raises(ScenarioError, match=match):
        built(tmp_path / "map.npy", pixel=1.0)


def test_what_a_map_cannot_tell_must_be_said(tmp_path):
    np.save(tmp_path / "map.npy", pixels())
    with pytest.raises(ScenarioError, match="pixel is not given"):
        built(tmp_path / "map.npy")
    Image.fromarray(np.zeros((40, 40), np.uint8)).save(tmp_path / "map.png")
    with pytest.raises(ScenarioError, match="height_scale is not given"):
        built(tmp_path / "map.png", pixel=1.0)
    Image.fromarray(np.zeros((40, 40, 3), np.uint8)).save(tmp_path / "map.png")
    with pytest.raises(ScenarioError, match="save it as grey"):
        built(tmp_path / "map.png", pixel=1.0, height_scale=1.0)


def test_a_palette_is_no_height_and_a_wrong_scale_is_told(tmp_path):
    Image.fromarray(np.zeros((40, 40), np.uint8)).convert("P").save(tmp_path / "map.png")
    with pytest.raises(ScenarioError, match="save it as grey"):
        built(tmp_path / "map.png", pixel=1.0, height_scale=1.0)
    np.save(tmp_path / "map.npy", pixels() * 1e300)
    with pytest.raises(ScenarioError, match="set height_scale"):
        built(tmp_path / "map.npy", pixel=1.0)


def test_a_scenario_finds_its_file_from_its_own_folder(tmp_path, monkeypatch):
    (tmp_path / "sub").mkdir()
    np.save(tmp_path / "sub" / "map.npy", pixels())
    text = "name: it\nterrain: {file: {path: map.npy, pixel: 1}}\n"
    (tmp_path / "sub" / "it.yaml").write_text(text)
    (tmp_path / "child.yaml").write_text("name: child\nextends: sub/it.yaml\nterrain: {cell: 0.5}\n")
    monkeypatch.chdir(tmp_path)
    for name in ("sub/it.yaml", tmp_path / "child.yaml"):
        file = load(name).terrain.file
        assert file is not None
        assert Path(file.path) == tmp_path / "sub" / "map.npy"
