"""One interface to the six line extractors of the thesis's Appendix D, chosen by name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal, Protocol

import numpy as np

from datmo.arrays import F64
from datmo.errors import ConfigError, MessageError, nearest
from datmo.ground.lines.em import em
from datmo.ground.lines.hough import hough
from datmo.ground.lines.incremental import incremental
from datmo.ground.lines.line_regression import line_regression
from datmo.ground.lines.ransac import ransac
from datmo.ground.lines.split_and_merge import split_and_merge
from datmo.ground.lines.table import COLUMNS, LineRules, as_array

LineMethod = Literal["incremental", "split-and-merge", "hough", "em", "line-regression", "ransac"]
DRAWS = 4096
SEED = 0


class Extractor(Protocol):
    """Fill `lines` (n or more, 7) with the lines of r, z (n,), ordered by r; return their number.

    rules: see `as_array`. draws: (DRAWS,) uniform in [0, 1), all the chance there is.
    """

    def __call__(self, r: F64, z: F64, rules: F64, draws: F64, lines: F64) -> int:
        """See the class."""


EXTRACTORS: Mapping[str, Extractor] = MappingProxyType(
    {
        "incremental": incremental,
        "split-and-merge": split_and_merge,
        "hough": hough,
        "em": em,
        "line-regression": line_regression,
        "ransac": ransac,
    }
)
RANDOM = frozenset({"em", "ransac"})


def extractor(method: str) -> Extractor:
    """The kernel of that name.

    Raises:
        ConfigError: there is none.
    """
    if method not in EXTRACTORS:
        raise ConfigError(f"line extractor {method!r} is not known; {nearest(str(method), EXTRACTORS)}")
    return EXTRACTORS[method]


def draw(method: str, rng: np.random.Generator | None = None) -> F64:
    """The random numbers (DRAWS,) that a method may use; none (0,) for one without chance."""
    if method not in RANDOM:
        return np.empty(0)
    return (rng or np.random.default_rng(SEED)).random(DRAWS)


def extract_lines(
    r: F64,
    z: F64,
    rules: LineRules | None = None,
    method: LineMethod = "incremental",
    rng: np.random.Generator | None = None,
) -> F64:
    """Lines of one segment. A line is refitted to its own points by centred total least squares (3.6).

    "incremental" and "split-and-merge" make a line of two points or more, "line-regression" of a
    window's; "hough", "em" and "ransac" of four.

    Args:
        r, z: (n,) [m], finite, ordered by r. rules: None takes the defaults.
        method: a name of `EXTRACTORS`. rng: for "em" and "ransac"; None takes one of a fixed seed.

    Returns:
        (k, 7): start and end [m], slope [m/m], intercept [m], rmse [m], number of points, and 1
        where the line is ground. Ordered by start; a point belongs to one line at most.

    Raises:
        ConfigError: the method is not known. MessageError: r and z are no such points.
    """
    find = extractor(method)
    r, z = np.ascontiguousarray(r, float), np.ascontiguousarray(z, float)
    if r.ndim != 1 or r.shape != z.shape:
        raise MessageError(f"r {r.shape} and z {z.shape} must both be (n,); give one of each a point")
    if not (np.isfinite(r).all() and np.isfinite(z).all() and (np.diff(r) >= 0).all()):
        raise MessageError("r and z must be finite and ordered by r; drop what is not, and sort by r")
    lines = np.empty((len(r), COLUMNS))
    k = find(r, z, as_array(rules or LineRules()), draw(method, rng), lines)
    return lines[:k]
