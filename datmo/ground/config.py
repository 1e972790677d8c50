"""Everything the ground stage can be told; the defaults suit an HDL-64 on a car."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from datmo import bins as shared
from datmo.ground.lines import LineMethod

Method = Literal["default", "z-se", "z", "zl", "zli"]
Objective = Literal["whitened", "printed", "prior"]


class GroundConfig(BaseModel):
    """Frozen; an unknown key is an error. Symbols in brackets are those of method.md."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    method: Method = Field(
        "default",
        description="default: tied field; z-se: one length-scale; z: lines; zl: latent; zli: noise too",
    )
    segments: int = Field(shared.SEGMENTS, ge=12, le=720, description="M, sectors of the polar grid")
    bins: int = Field(shared.BINS, ge=10, le=400, description="N, bins of a segment")
    blind: float = Field(shared.BLIND, ge=0, le=10, description="inner edge of the grid [m]")
    radius: float = Field(shared.RADIUS, gt=10, le=500, description="B, outer edge of the grid [m]")
    multipath: float = Field(0.3, gt=0, description="second lowest is taken if this much higher [m]")
    start_height: float = Field(-shared.SENSOR_HEIGHT, description="ground, where nothing is seen [m]")

    plane_radius: float = Field(25.0, gt=1, description="points that the local slope is taken from [m]")
    coarse: bool = Field(True, description="whether a coarse 2-D surface follows the plane")
    coarse_noise: float = Field(0.1, gt=0, description="scatter about the coarse surface [m]")
    coarse_bend: float = Field(
        0.9, gt=0, description="τ, its second difference over h has a std of τ h [m/m]"
    )
    coarse_slope: float = Field(2.0, gt=0, description="ς, std of its first differences, whatever h [m]")
    asymmetric: bool = Field(True, description="points above pull less than points below")
    reject: bool = Field(True, description="cells of large vertical extent count little")
    connect: bool = Field(True, description="cells that do not connect to the ground are left out")

    lines: LineMethod = Field("incremental", description="extractor of the lines that `z` learns from")
    slope_max: float = Field(0.3, gt=0, description="ζ_slope, a line this steep is not ground [m/m]")
    line_rmse: float = Field(0.1, gt=0, description="T_RMSE [m]")
    line_join: float = Field(0.15, gt=0, description="a point this far off a line ends it [m]")
    line_turn: float = Field(0.02, gt=0, description="a point that turns a line this much ends it [rad]")
    line_small: float = Field(0.02, gt=0, description="T_small, a line is nearly flat below [m/m]")
    line_intercept: float = Field(0.5, gt=0, description="ζ_b, flat lines lie this near the ground [m]")

    length_factor: float = Field(1.0, gt=0, description="a, metres per log of 1/slope, if not learned")
    slope_default: float = Field(0.02, gt=0, lt=1, description="g_def, smallest slope that counts [m/m]")
    slope_clip: float = Field(0.6, gt=0, lt=1, description="g_max, largest slope that counts [m/m]")
    length: float = Field(3.0, gt=0, description="ℓ of the stationary kernel, if not learned [m]")
    signal_std: float = Field(0.12, gt=0, description="σ_f, if not learned [m]")
    noise_std: float = Field(0.03, gt=0, description="σ_n, if not learned [m]")
    noise_floor: float = Field(0.01, gt=0, description="smallest σ_n, the range noise [m]")
    learn: bool = Field(True, description="maximum likelihood of a or ℓ, σ_f, σ_n once a frame")
    objective: Objective = Field("whitened", description="of zl and zli; the others are the thesis's")
    truncated: bool = Field(False, description="leave out the gradient through η, as the thesis does")
    line_factor: bool = Field(True, description="zl, zli: learn a factor on the line length, else 1")
    support_angle: float = Field(0.2, gt=0, le=2, description="ζ_h, pseudo-inputs about the mean [rad]")
    supports: int = Field(8, ge=1, le=60, description="most pseudo-inputs of a segment")
    learn_cells: int = Field(32, ge=3, le=400, description="most cells of a segment to learn from")
    learn_segments: int = Field(24, ge=1, le=720, description="most segments that z and z-se learn from")
    learn_first: int = Field(20, ge=1, le=500, description="steps of L-BFGS in the first frame")
    learn_next: int = Field(4, ge=1, le=500, description="steps of L-BFGS in a frame that follows")
    drift: float = Field(0.002, ge=0, description="least std gained per metre from what was seen [m/m]")
    most_std: float = Field(5.0, gt=0, description="largest std from that [m]")

    seed_height: float = Field(0.3, gt=0, description="T_s, seeds lie this near the expected ground [m]")
    seed_radius: float = Field(50.0, gt=0, description="seeds lie within this range [m]")
    join_variance: float = Field(0.05, gt=0, description="ζ_v, most variance where a point joins [m²]")
    join_distance: float = Field(3.0, gt=0, description="ζ_d, most standardised distance to join")
    refit: bool = Field(True, description="fit again on all ground points of each cell")

    point_height: float = Field(0.25, gt=0, description="ζ_r at the sensor [m]")
    point_range: float = Field(0.001, ge=0, description="growth of ζ_r with range [m/m]")
    point_slope: float = Field(0.1, ge=0, description="growth of ζ_r with the local residual slope [m]")
    point_most: float = Field(0.4, gt=0, description="largest ζ_r [m]")
    point_below: float = Field(3.0, ge=1, description="below the ground ζ_r is this much larger")
    point_noise: float = Field(2.0, ge=0, description="least ζ_r in stds of an observation")
    foot_factor: float = Field(0.22, gt=0, le=1, description="share of ζ_r kept near feet of obstacles")
