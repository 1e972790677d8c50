"""Log marginal likelihood of segments and its gradient in every log L_i and log n_i (App. C, corrected)."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, I64
from datmo.ground.gp import correlation

LOG_2PI = float(np.log(2 * np.pi))


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _factor(A: F64, n: int) -> float:
    """Upper factor U of A = UᵀU in A's upper half; log|A|."""
    log_det = 0.0
    for k in range(n):
        row = A[k]
        for i in range(k):
            f, above = A[i, k], A[i]
            for t in range(k, n):
                row[t] -= f * above[t]
        pivot = np.sqrt(max(row[k], 1e-300))
        log_det += 2 * np.log(pivot)
        inverse = 1 / pivot
        for t in range(k, n):
            row[t] *= inverse
    return log_det


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _invert(U: F64, n: int, Z: F64, A: F64) -> None:
    """A⁻¹ (n, n) into A, both halves, from the upper factor; Z is room for U⁻ᵀ."""
    for k in range(n):
        row = Z[k]
        for t in range(k):
            row[t] = 0.0
        row[k] = 1.0
        for i in range(k):
            f, before = U[i, k], Z[i]
            for t in range(i + 1):
                row[t] -= f * before[t]
        inverse = 1 / U[k, k]
        for t in range(k + 1):
            row[t] *= inverse
    for i in range(n):
        row = A[i]
        for t in range(i + 1):
            row[t] = 0.0
        for k in range(i, n):
            f, below = Z[k, i], Z[k]
            for t in range(i + 1):
                row[t] += f * below[t]
        for t in range(i):
            A[t, i] = row[t]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _segment(
    r: F64, z: F64, L: F64, noise: F64, sf2: float, room: F64, g: F64, w: F64
) -> tuple[float, float]:
    """Log likelihood of one segment and Σ W∘K; writes g and w, see `evidence`. room: (4, n, n)."""
    n = len(r)
    K, U, Z, A = room[0], room[1], room[2], room[3]
    for i in range(n):
        ri, Li, row = r[i], L[i], K[i]
        for j in range(n):
            row[j] = sf2 * correlation(ri, r[j], Li, L[j])
        for j in range(i, n):
            U[i, j] = row[j]
        U[i, i] += noise[i]
    log_det = _factor(U, n)
    _invert(U, n, Z, A)
    alpha = np.zeros(n)
    for i in range(n):
        zi, row = z[i], A[i]
        for j in range(n):
            alpha[j] += zi * row[j]
    square, wk = 0.0, np.zeros(n)
    for i in range(n):
        square += z[i] * alpha[i]
        w[i] = alpha[i] * alpha[i] - A[i, i]
        g[i] = 0.0
    for i in range(n):
        ri, L2, ai, Ki, Ai = r[i], L[i] * L[i], alpha[i], K[i], A[i]
        for j in range(n):
            q = 1 / (L2 + L[j] * L[j])
            share = L[j] * L[j] * q
            WK = (ai * alpha[j] - Ai[j]) * Ki[j]
            wk[j] += WK
            g[j] += WK * (0.5 - share + 4 * (ri - r[j]) ** 2 * q * share)
    total = 0.0
    for j in range(n):
        total += wk[j]
    return -0.5 * (square + log_det + n * LOG_2PI), total


@numba.njit(cache=True, nogil=True)
def evidence(
    r: F64,
    z: F64,
    count: I64,
    log_L: F64,
    log_n: F64,
    value: F64,
    trace: F64,
    g: F64,
    w: F64,
    log_sf: float,
    floor: float,
) -> None:
    """Log likelihood of each row of (B, n) arrays, whose first `count` entries hold, and gradients.

    A = K + diag(floor² + n²). With α = A⁻¹ z and W = ααᵀ - A⁻¹ it writes
    value (B,); trace (B,) = ∂/∂log σ_f = Σ W∘K; g (B, n) = ∂/∂log L_i = Σ_j W_ij ∂K_ij/∂log L_i,
    ∂K_ij/∂log L_i = K_ij (½ - L_i²/S_ij + 4 (r_i - r_j)² L_i² / S_ij²); w (B, n) = ∂/∂log n_i = W_ii n_i².
    """
    most = 0
    for m in range(len(r)):
        most = max(most, count[m])
    room = np.empty((4, most, most))
    for m in range(len(r)):
        n = count[m]
        n2 = np.exp(2 * log_n[m, :n])
        value[m], trace[m] = _segment(
            r[m, :n], z[m, :n], np.exp(log_L[m, :n]), n2 + floor * floor, np.exp(2 * log_sf), room, g[m], w[m]
        )
        for i in range(n):
            w[m, i] *= n2[i]
        g[m, n:], w[m, n:] = 0.0, 0.0
