"""Lines of the ordered candidates of a segment: six extractors, one interface (3.6, Appendix D)."""

from datmo.ground.lines.extract import (
    DRAWS,
    EXTRACTORS,
    RANDOM,
    Extractor,
    LineMethod,
    draw,
    extract_lines,
    extractor,
)
from datmo.ground.lines.slopes import nearest_slope, segment_slopes
from datmo.ground.lines.table import (
    COLUMNS,
    COUNT,
    END,
    GROUND,
    INTERCEPT,
    RMSE,
    SLOPE,
    START,
    LineRules,
    as_array,
)

__all__ = [
    "COLUMNS",
    "COUNT",
    "DRAWS",
    "END",
    "EXTRACTORS",
    "GROUND",
    "INTERCEPT",
    "RANDOM",
    "RMSE",
    "SLOPE",
    "START",
    "Extractor",
    "LineMethod",
    "LineRules",
    "as_array",
    "draw",
    "extract_lines",
    "extractor",
    "nearest_slope",
    "segment_slopes",
]
