"""Height maps: PNG, GeoTIFF and numpy arrays."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from datmo.arrays import F64, Array
from datmo.errors import ScenarioError
from scenarios import spec
from sim.scene.terrain.grid import Area

MAPS = (".png", ".tif", ".tiff", ".npy")
PIXEL_SCALE, NO_DATA = "ModelPixelScale", 42113
"""The GeoTIFF key of the spacing, and GDAL's tag of the value that stands for no height."""


@dataclass(frozen=True, eq=False)
class HeightMap:
    """Heights on a grid, linear along x and y between them.

    Args:
        x0, y0: the corner of row 0, column 0, the lowest x and y [m, world].
        pixel: spacing along x and y [m]. height: (rows, columns) [m].
    """

    x0: float
    y0: float
    pixel: tuple[float, float]
    height: F64

    @property
    def area(self) -> Area:
        """x_min, y_min, x_max, y_max [m, world]."""
        rows, columns = self.height.shape
        return (
            self.x0,
            self.y0,
            self.x0 + (columns - 1) * self.pixel[0],
            self.y0 + (rows - 1) * self.pixel[1],
        )

    def heights(self, x: F64, y: F64) -> F64:
        """Bilinear heights (ny, nx) [m] at x (1, nx) and y (ny, 1) within the area [m, world]."""
        rows, columns = self.height.shape
        u, v = (x.ravel() - self.x0) / self.pixel[0], (y.ravel() - self.y0) / self.pixel[1]
        i, j = np.clip(u.astype(int), 0, columns - 2), np.clip(v.astype(int), 0, rows - 2)
        u, v = (u - i)[None, :], (v - j)[:, None]
        along = self.height[:, i] * (1 - u) + self.height[:, i + 1] * u
        return np.asarray(along[j] * (1 - v) + along[j + 1] * v)


def read_map(file: spec.TerrainFile, path: Path) -> HeightMap:
    """The height map of a file. Row 0 of a picture is its highest y, row 0 of a .npy its lowest.

    Raises:
        ScenarioError: it cannot be read, is no map of one value a pixel, has a value that is no
            height, or its spacing or scale is not told.
    """
    ending = path.suffix.lower()
    own = None
    if ending == ".npy":
        values = _read_npy(path)
    elif ending == ".png":
        values = _read_png(path)
    else:
        values, own = _read_tiff(path)
    _check(values, path)
    if file.pixel is None and own is None:
        raise ScenarioError(
            f"terrain.file {file.path!r}: pixel is not given; write the map's metres per pixel"
        )
    if file.height_scale is None and ending == ".png":
        raise ScenarioError(
            f"terrain.file {file.path!r}: height_scale is not given; "
            "write the metres that one step of grey is worth"
        )
    pixel = (file.pixel, file.pixel) if file.pixel is not None else own
    assert pixel is not None
    rows, columns = values.shape
    middle = -(columns - 1) * pixel[0] / 2, -(rows - 1) * pixel[1] / 2
    x0, y0 = file.corner if file.corner is not None else middle
    height = values.astype(float) * (file.height_scale or 1.0) + file.height_offset
    return HeightMap(x0, y0, pixel, height if ending == ".npy" else height[::-1])


def _check(values: Array, path: Path) -> None:
    if values.ndim != 2 or min(values.shape) < 2 or values.dtype.kind not in "iuf":
        raise ScenarioError(
            f"height map {path}: it holds {values.dtype} of shape {values.shape}; "
            "it must be (rows >= 2, columns >= 2) with one number a pixel; save it as grey"
        )
    wrong = ~np.isfinite(values) if values.dtype.kind == "f" else np.zeros(values.shape, bool)
    if wrong.any():
        j, i = np.argwhere(wrong)[0]
        raise ScenarioError(
            f"height map {path}: {wrong.sum()} of {values.size} pixels hold no height, the first in row {j}, "
            f"column {i}; fill the gaps"
        )


def _read_npy(path: Path) -> Array:
    try:
        return np.asarray(np.load(path, allow_pickle=False))
    except (OSError, ValueError, EOFError) as error:
        raise ScenarioError(
            f"height map {path}: it cannot be read ({error}); save it with numpy.save"
        ) from None


def _read_png(path: Path) -> Array:
    try:
        with Image.open(path) as image:
            return np.asarray(image.convert("RGB") if image.mode == "P" else image)
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise ScenarioError(f"height map {path}: it cannot be read ({error}); give a grey PNG") from None


def _read_tiff(path: Path) -> tuple[Array, tuple[float, float] | None]:
    """Values, NaN where there is none, and the spacing along x and y that the file tells."""
    try:
        import tifffile
    except ImportError:
        raise ScenarioError(
            f"height map {path}: a TIFF needs tifffile, which is not installed; pip install 'datmo-gym[geo]'"
        ) from None
    try:
        with tifffile.TiffFile(path) as file:
            page: Any = file.pages[0]
            values = np.asarray(page.asarray())
            geo = page.geotiff_tags or {}
            empty = page.tags.get(NO_DATA)
    except Exception as error:  # it raises many kinds on a broken file
        raise ScenarioError(f"height map {path}: it cannot be read ({error}); give a plain GeoTIFF") from None
    if empty is not None:
        values = np.where(values == float(str(empty.value).strip("\0 ")), np.nan, values.astype(float))
    scale = geo.get(PIXEL_SCALE)
    return values, None if scale is None else (float(scale[0]), float(scale[1]))
