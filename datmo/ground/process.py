"""The segments' Gaussian processes as one model: length-scales, learning, growth, surface."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from datmo.arrays import F64, Bool
from datmo.ground.config import GroundConfig
from datmo.ground.gp import evidence, fit_segments, grow_segments
from datmo.ground.lines import LineRules, as_array, segment_slopes
from datmo.ground.threads import each, over_rows

LEARNING_SEGMENTS = 8
RATIOS = (0.05, 0.1, 0.2, 0.3, 0.45, 0.7, 1.0)
FACTORS = (0.25, 0.5, 1.0, 2.0, 4.0)
ABOVE = 1.0
DOUBT = 20.0


@dataclass(frozen=True)
class Hyper:
    """scale: a of (3.11) [m], or ℓ of the stationary kernel [m]; sf: σ_f [m]; sn: σ_n [m]."""

    scale: float
    sf: float
    sn: float


@dataclass(frozen=True)
class Data:
    """What the processes are given: (M, N) ranges [m], heights over h0 [m], and where they count.

    Attributes:
        shape, shape_nodes: length-scale of each candidate (M, N) and node (M, Q) per unit `scale`.
    """

    r: F64
    y: F64
    use: Bool
    shape: F64
    shape_nodes: F64


def narrow(data: Data, use: Bool) -> Data:
    """The same with only `use` (M, N) counting."""
    return replace(data, use=use)


def start(config: GroundConfig) -> Hyper:
    """The hyper-parameters before any learning."""
    scale = config.length_factor if config.method == "z" else config.length
    return Hyper(scale, config.signal_std, config.noise_std)


def describe(r: F64, y: F64, use: Bool, nodes: F64, config: GroundConfig) -> Data:
    """Data with length-scales from the lines of each segment.

    "z": L = a log(1 / clip(|g|, g_def, g_max)), g the slope of the nearest extracted line (3.11).
    "z-se": L = ℓ everywhere.
    """
    if config.method == "z-se":
        return Data(r, y, use, np.ones_like(r), np.ones((len(r), len(nodes))))
    rules = LineRules(
        config.line_join,
        config.line_turn,
        config.slope_max,
        config.line_rmse,
        config.line_small,
        config.line_intercept,
    )
    at, at_nodes, _ = segment_slopes(r, y, use, nodes, as_array(rules), config.slope_default, config.lines)
    low, high = config.slope_default, config.slope_clip
    return Data(r, y, use, -np.log(np.clip(at, low, high)), -np.log(np.clip(at_nodes, low, high)))


def learn(data: Data, config: GroundConfig) -> Hyper:
    """Hyper-parameters of the largest marginal likelihood over the fullest segments of a frame.

    A grid over scale and σ_n / σ_f; for each, the best σ_f² is yᵀ (A / σ_f²)⁻¹ y / n, in closed
    form. Without data `start` stays.
    """
    count = data.use.sum(1)
    # Of equally full segments the farthest-reaching come first, so that turning changes nothing.
    rows = np.lexsort((-(data.r * data.use).sum(1), -count))[:LEARNING_SEGMENTS]
    rows = rows[count[rows] >= 3]
    n = int(count[rows].sum())
    if not n:
        return start(config)

    def profile(choice: tuple[float, float]) -> tuple[float, float]:
        scale, ratio = choice
        noise = np.full(data.r.shape, ratio**2)
        square, log_det = evidence(data.r, data.y, scale * data.shape, noise, data.use, rows)
        sf2 = max(square / n, 1e-8)
        return -0.5 * (n * float(np.log(sf2)) + log_det), sf2

    choices = [(factor * start(config).scale, ratio) for factor in FACTORS for ratio in RATIOS]
    found = each(profile, choices)
    best = max(range(len(found)), key=lambda k: found[k][0])
    (scale, ratio), sf = choices[best], float(np.sqrt(found[best][1]))
    return Hyper(scale, sf, max(sf * ratio, config.noise_floor))


def grow(data: Data, seed: Bool, doubtful: Bool, hyper: Hyper, config: GroundConfig) -> tuple[Bool, F64]:
    """Which candidates are ground (M, N), and the noise variance each has by then (M, N) [m²].

    A doubtful candidate (above the ground in a cell that reaches far up) has twenty times the
    variance.
    """
    noise = np.where(doubtful, DOUBT, 1.0) * hyper.sn**2
    rules = np.array([hyper.sf**2, config.join_variance, config.join_distance])
    above = ABOVE if config.asymmetric else 0.0
    member, mean = np.zeros(data.r.shape, bool), np.zeros(data.r.shape)
    L = hyper.scale * data.shape
    over_rows(grow_segments, (data.r, data.y, L, noise, data.use, seed, member, mean), (above, rules))
    return member, noise + (above * np.maximum(data.y - mean, 0)) ** 2


def fit(data: Data, noise: F64, nodes: F64, hyper: Hyper) -> tuple[F64, F64]:
    """Mean [m] and variance [m²] of the latent height over h0 at the nodes, both (M, Q)."""
    mean, var = np.zeros((len(data.r), len(nodes))), np.zeros((len(data.r), len(nodes)))
    L, L_nodes = hyper.scale * data.shape, hyper.scale * data.shape_nodes
    over_rows(fit_segments, (data.r, data.y, L, noise, data.use, L_nodes, mean, var), (nodes, hyper.sf**2))
    return mean, var
