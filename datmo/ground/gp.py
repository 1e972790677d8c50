"""Gaussian process along a segment: kernel (3.10, 3.16), growth from seeds (Alg. 2, 3.41), prediction.

Everything rests on one step, `_append`: it adds an observation to a Cholesky factor and carries
mean and variance at all targets along, so that growing a set costs as much as fitting it once.
"""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, Array, Bool

FAR = 20.0
TINY = 1e-12


@numba.njit(cache=True, nogil=True)
def correlation(ra: float, rb: float, La: float, Lb: float) -> float:
    """K_ij / σ_f² of (3.16): sqrt(2 L_i L_j / S_ij) exp(-2 (r_i - r_j)² / S_ij), S_ij = L_i² + L_j².

    Values below exp(-20) are 0.
    """
    S = La * La + Lb * Lb
    u = 2 * (ra - rb) ** 2 / S
    if u > FAR:
        return 0.0
    return float(np.sqrt(2 * La * Lb / S) * np.exp(-u))


@numba.njit(cache=True, nogil=True)
def _append(
    j: int, k: int, t0: int, y: float, noise: float, r: F64, L: F64, sf2: float, V: F64, mean: F64, var: F64
) -> tuple[float, float]:
    """Observe target j, with value y and noise variance, as the k-th row.

    The row is (k(r_j, ·) - Σ_i V_ij V_i·) / l, l² = v_j + noise: the next column of the factor of
    A = K + D, and of its inverse applied to K(·, targets). mean += row β, β the whitened
    innovation. Targets before t0 are left as they are. Returns β and l².
    """
    row, n = V[k], len(r)
    for t in range(t0, n):
        row[t] = sf2 * correlation(r[j], r[t], L[j], L[t])
    for i in range(k):
        f = V[i, j]
        if f != 0.0:
            for t in range(t0, n):
                row[t] -= f * V[i, t]
    l2 = max(var[j], 0.0) + noise
    pivot = np.sqrt(l2)
    beta = (y - mean[j]) / pivot
    inverse = 1 / pivot
    for t in range(t0, n):
        row[t] *= inverse
        mean[t] += row[t] * beta
        var[t] -= row[t] * row[t]
    return beta, l2


@numba.njit(cache=True, nogil=True)
def regress(
    r: F64, y: F64, noise: F64, L: F64, rq: F64, Lq: F64, sf2: float
) -> tuple[F64, F64, float, float]:
    """Latent mean (q,) and variance (q,) at rq; yᵀ A⁻¹ y and log|A|, A = K + diag(noise).

    The log marginal likelihood is -½ (yᵀ A⁻¹ y + log|A| + n log 2π).

    Args:
        r, y: (n,) [m]. noise: (n,) variance [m²]. L: (n,) length-scales [m]. rq, Lq: (q,) [m].
        sf2: σ_f² [m²].
    """
    n, q = len(r), len(rq)
    R, Ls = np.concatenate((r, rq)), np.concatenate((L, Lq))
    V, mean, var = np.empty((n, n + q)), np.zeros(n + q), np.full(n + q, sf2)
    square, log_det = 0.0, 0.0
    for k in range(n):
        beta, l2 = _append(k, k, k, y[k], noise[k], R, Ls, sf2, V, mean, var)
        square += beta * beta
        log_det += np.log(l2)
    return mean[n:], np.maximum(var[n:], TINY), square, log_det


@numba.njit(cache=True, nogil=True)
def grow(r: F64, y: F64, L: F64, noise: F64, seed: Bool, above: float, rules: F64) -> tuple[Bool, F64]:
    """Which candidates of a segment are ground (Alg. 2), and the mean μ* (n,) at all of them.

    From the seeds on, a candidate joins when v* <= ζ_v and |y - μ*| / sqrt(σ_n² + v*) <= ζ_d; all
    that pass one fit join together, until none does. With `above` > 0 a point over the surface
    joins with its noise raised by (above · (y - μ*))²: above pulls little, below pulls hard.

    Args:
        r, y, L, noise: (n,). seed: (n,). rules: σ_f² [m²], ζ_v [m²], ζ_d.
    """
    n = len(r)
    sf2, most_var, most_distance = rules[0], rules[1], rules[2]
    V, mean, var = np.empty((n, n)), np.zeros(n), np.full(n, sf2)
    member, joins, k = np.zeros(n, np.bool_), seed.copy(), 0
    while joins.any():
        expected = mean.copy()
        for j in range(n):
            if joins[j]:
                pull = above * max(y[j] - expected[j], 0.0)
                _append(j, k, 0, y[j], noise[j] + pull * pull, r, L, sf2, V, mean, var)
                member[j] = True
                k += 1
        for j in range(n):
            v = max(var[j], 0.0)
            near = abs(y[j] - mean[j]) <= most_distance * np.sqrt(noise[j] + v)
            joins[j] = not member[j] and v <= most_var and near
    return member, mean


@numba.njit(cache=True, nogil=True)
def grow_segments(
    r: F64,
    y: F64,
    L: F64,
    noise: F64,
    use: Bool,
    seed: Bool,
    member: Bool,
    mean: F64,
    above: float,
    rules: F64,
) -> None:
    """`grow` for each row of (M, N) arrays; writes member and mean (M, N) where `use`."""
    for m in range(len(r)):
        at = np.flatnonzero(use[m])
        joined, level = grow(r[m][at], y[m][at], L[m][at], noise[m][at], seed[m][at], above, rules)
        for i in range(len(at)):
            member[m, at[i]], mean[m, at[i]] = joined[i], level[i]


@numba.njit(cache=True, nogil=True)
def fit_segments(
    r: F64, y: F64, L: F64, noise: F64, use: Bool, L_nodes: F64, mean: F64, var: F64, nodes: F64, sf2: float
) -> None:
    """`regress` for each row of (M, N) arrays at nodes (Q,); writes mean, var (M, Q)."""
    for m in range(len(r)):
        at = np.flatnonzero(use[m])
        mean[m], var[m], _, _ = regress(r[m][at], y[m][at], noise[m][at], L[m][at], nodes, L_nodes[m], sf2)


@numba.njit(cache=True, nogil=True)
def evidence(r: F64, y: F64, L: F64, noise: F64, use: Bool, rows: Array) -> tuple[float, float]:
    """Σ yᵀ A⁻¹ y and Σ log|A| over the segments `rows` at σ_f = 1."""
    none = np.empty(0)
    square, log_det = 0.0, 0.0
    for m in rows:
        at = np.flatnonzero(use[m])
        _, _, s, d = regress(r[m][at], y[m][at], noise[m][at], L[m][at], none, none, 1.0)
        square += s
        log_det += d
    return square, log_det
