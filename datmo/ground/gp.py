"""Gaussian process along a segment: kernel (3.10, 3.16), growth from seeds (Alg. 2, 3.41), prediction.

Everything rests on one step, `_append`: it adds an observation to a Cholesky factor and carries
mean and variance at all targets along, so that growing a set costs as much as fitting it once.
Its loops run over rows without branches, for the compiler to spread them over vector lanes.
"""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, Bool

FAR = 20.0
TINY = 1e-12
R, Y, LENGTH, NOISE, MEAN, VAR, EXPECTED, JOINS, NAME = range(9)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def correlation(ra: float, rb: float, La: float, Lb: float) -> float:
    """K_ij / σ_f² of (3.16): sqrt(2 L_i L_j / S_ij) exp(-2 (r_i - r_j)² / S_ij), S_ij = L_i² + L_j².

    Values below exp(-20) are 0. The exponential is its series at a 64th, squared six times: to
    1e-14 what the library gives, but one that runs in vector lanes.
    """
    S = La * La + Lb * Lb
    u = 2 * (ra - rb) ** 2 / S
    x = u * (-1 / 64)
    e = 1 / 40320 + x * (1 / 362880 + x * (1 / 3628800 + x * (1 / 39916800)))
    e = 1 / 24 + x * (1 / 120 + x * (1 / 720 + x * (1 / 5040 + x * e)))
    e = 1 + x * (1 + x * (1 / 2 + x * (1 / 6 + x * e)))
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    c = np.sqrt(2 * La * Lb / S) * e
    return c if u < FAR else 0.0


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _append(
    k: int, y: float, noise: float, r: F64, L: F64, sf2: float, V: F64, mean: F64, var: F64
) -> tuple[float, float]:
    """Observe target k with value y and noise variance, after the targets before it.

    Row k of V is (k(r_k, ·) - Σ_i V_ik V_i·) / l from k on, l² = var_k + noise: the next row of the
    upper factor of A = K + D, l itself on the diagonal, and of its inverse applied to K(·, targets).
    mean += row β, β the whitened innovation. Returns β and l².
    """
    row, n = V[k], len(r)
    rk, Lk = r[k], L[k]
    for t in range(k, n):
        row[t] = sf2 * correlation(rk, r[t], Lk, L[t])
    for i in range(k):
        f = V[i, k]
        if f != 0.0:
            above = V[i]
            for t in range(k, n):
                row[t] -= f * above[t]
    l2 = max(row[k], 0.0) + noise
    pivot = np.sqrt(l2)
    beta = (y - mean[k]) / pivot
    inverse = 1 / pivot
    for t in range(k + 1, n):
        v = row[t] * inverse
        row[t] = v
        mean[t] += v * beta
        var[t] -= v * v
    row[k] = pivot
    return beta, l2


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _weights(V: F64, beta: F64, n: int) -> F64:
    """α = A⁻¹ y (n,) from the upper factor in V and the whitened innovations."""
    alpha = np.empty(n)
    for k in range(n - 1, -1, -1):
        s = beta[k]
        for t in range(k + 1, n):
            s -= V[k, t] * alpha[t]
        alpha[k] = s / V[k, k]
    return alpha


@numba.njit(cache=True, nogil=True, error_model="numpy")
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
    every, Ls = np.concatenate((r, rq)), np.concatenate((L, Lq))
    V, mean, var = np.empty((n, n + q)), np.zeros(n + q), np.full(n + q, sf2)
    square, log_det = 0.0, 0.0
    for k in range(n):
        beta, l2 = _append(k, y[k], noise[k], every, Ls, sf2, V, mean, var)
        square += beta * beta
        log_det += np.log(l2)
    return mean[n:], np.maximum(var[n:], TINY), square, log_det


@numba.njit(cache=True, nogil=True, error_model="numpy")
def expect(r: F64, y: F64, noise: F64, L: F64, rq: F64, Lq: F64, sf2: float) -> F64:
    """Latent mean (q,) at rq alone, K(rq, r) A⁻¹ y; arguments as in `regress`."""
    n, q = len(r), len(rq)
    V, mean, var, beta = np.empty((n, n)), np.zeros(n), np.full(n, sf2), np.empty(n)
    for k in range(n):
        beta[k], _ = _append(k, y[k], noise[k], r, L, sf2, V, mean, var)
    alpha, out = _weights(V, beta, n), np.zeros(q)
    for k in range(n):
        a, rk, Lk = sf2 * alpha[k], r[k], L[k]
        for t in range(q):
            out[t] += a * correlation(rk, rq[t], Lk, Lq[t])
    return out


@numba.njit(cache=True, nogil=True)
def _swap(S: F64, V: F64, j: int, k: int) -> None:
    """Let the targets at places j and k change places."""
    for i in range(len(S)):
        S[i, j], S[i, k] = S[i, k], S[i, j]
    for i in range(k):
        V[i, j], V[i, k] = V[i, k], V[i, j]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def grow(r: F64, y: F64, L: F64, noise: F64, seed: Bool, above: float, rules: F64) -> tuple[Bool, F64]:
    """Which candidates of a segment are ground (Alg. 2), and the mean μ* (n,) at all of them.

    From the seeds on, a candidate joins when v* <= ζ_v and |y - μ*| / sqrt(σ_n² + v*) <= ζ_d; all
    that pass one fit join together, until none does. With `above` > 0 a point over the surface
    joins with its noise raised by (above · (y - μ*))²: above pulls little, below pulls hard.

    Args:
        r, y, L, noise: (n,). seed: (n,). rules: σ_f² [m²], ζ_v [m²], ζ_d.
    """
    n, sf2 = len(r), rules[0]
    S, V, beta = np.zeros((9, n)), np.empty((n, n)), np.empty(n)
    S[R], S[Y], S[LENGTH], S[NOISE], S[VAR], S[NAME] = r, y, L, noise, sf2, np.arange(n)
    for j in range(n):
        S[JOINS, j] = seed[j]
    k, more = 0, True
    while more:
        more = False
        S[EXPECTED] = S[MEAN]
        for j in range(k, n):
            if S[JOINS, j] > 0:
                _swap(S, V, j, k)
                pull = above * max(S[Y, k] - S[EXPECTED, k], 0.0)
                S[NOISE, k] += pull * pull
                beta[k], _ = _append(k, S[Y, k], S[NOISE, k], S[R], S[LENGTH], sf2, V, S[MEAN], S[VAR])
                k += 1
                more = True
        for j in range(k, n):
            v = max(S[VAR, j], 0.0)
            near = abs(S[Y, j] - S[MEAN, j]) <= rules[2] * np.sqrt(S[NOISE, j] + v)
            S[JOINS, j] = v <= rules[1] and near
    member, mean, alpha = np.zeros(n, np.bool_), np.empty(n), _weights(V, beta, k)
    for j in range(n):
        i = int(S[NAME, j])
        member[i] = j < k
        mean[i] = S[Y, j] - S[NOISE, j] * alpha[j] if j < k else S[MEAN, j]  # K α = y - D α
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
    r: F64,
    y: F64,
    L: F64,
    noise: F64,
    use: Bool,
    L_nodes: F64,
    mean: F64,
    var: F64,
    nodes: F64,
    sf2: float,
    spread: bool,
) -> None:
    """`regress` for each row of (M, N) arrays at nodes (Q,); writes mean and, if `spread`, var (M, Q)."""
    for m in range(len(r)):
        at = np.flatnonzero(use[m])
        rs, ys, ns, Ls = r[m][at], y[m][at], noise[m][at], L[m][at]
        if spread:
            mean[m], var[m], _, _ = regress(rs, ys, ns, Ls, nodes, L_nodes[m], sf2)
        else:
            mean[m] = expect(rs, ys, ns, Ls, nodes, L_nodes[m], sf2)
