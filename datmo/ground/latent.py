"""A latent Gaussian process on the logarithm of a segment's length-scales or noise (3.20, App. C, E).

log L(r) = μ(r) + K̄(r, r̄) h, with h = B⁻¹ δ for values δ = L̄ - μ_L at the supports r̄, or whitened
h = C⁻ᵀ u, δ = C u, C Cᵀ = B = K̄(r̄, r̄) + σ̄_n² I. K̄ is the squared exponential (3.9).
"""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, I64

WHITENED, PRINTED, PRIOR = 0, 1, 2
OBJECTIVES = {"whitened": WHITENED, "printed": PRINTED, "prior": PRIOR}


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _cholesky(rb: F64, hyper: F64) -> tuple[F64, F64]:
    """K̄(r̄, r̄) (p, p) and the lower factor C of B."""
    p = len(rb)
    K, C = np.empty((p, p)), np.zeros((p, p))
    for i in range(p):
        for j in range(i + 1):
            K[i, j] = K[j, i] = hyper[0] ** 2 * np.exp(-((rb[i] - rb[j]) ** 2) / (2 * hyper[1] ** 2))
            s = K[i, j] + (hyper[2] ** 2 if i == j else 0.0)
            for k in range(j):
                s -= C[i, k] * C[j, k]
            C[i, j] = np.sqrt(max(s, 1e-300)) if i == j else s / C[j, j]
    return K, C


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _forward(C: F64, b: F64) -> F64:
    """C⁻¹ b."""
    x = b.copy()
    for i in range(len(x)):
        for k in range(i):
            x[i] -= C[i, k] * x[k]
        x[i] /= C[i, i]
    return x


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _backward(C: F64, b: F64) -> F64:
    """C⁻ᵀ b."""
    x = b.copy()
    for i in range(len(x) - 1, -1, -1):
        for k in range(i + 1, len(x)):
            x[i] -= C[k, i] * x[k]
        x[i] /= C[i, i]
    return x


@numba.njit(cache=True, nogil=True, error_model="numpy")
def weights(rb: F64, count: I64, x: F64, h: F64, cost: F64, hyper: F64, objective: int) -> None:
    """h (B, P) of rows of supports rb (B, P), and what the objective charges for them, cost (B,).

    Args:
        x: (B, P) u when whitened, else δ. hyper: σ̄_f, σ̄_l [m], σ̄_n.
        objective: whitened ½ uᵀu; printed ½ log|B|; prior ½ δᵀB⁻¹δ + ½ log|B|.
    """
    for m in range(len(rb)):
        p = count[m]
        _, C = _cholesky(rb[m, :p], hyper)
        xm, s = x[m, :p], 0.0
        if objective == WHITENED:
            h[m, :p] = _backward(C, xm)
            for i in range(p):
                s += 0.5 * xm[i] * xm[i]
        else:
            h[m, :p] = _backward(C, _forward(C, xm))
            for i in range(p):
                s += np.log(C[i, i])
                if objective == PRIOR:
                    s += 0.5 * xm[i] * h[m, i]
        cost[m] = s


@numba.njit(cache=True, nogil=True, error_model="numpy")
def whiten(rb: F64, count: I64, delta: F64, hyper: F64) -> None:
    """u = C⁻¹ δ in the place of δ (B, P)."""
    for m in range(len(rb)):
        p = count[m]
        _, C = _cholesky(rb[m, :p], hyper)
        delta[m, :p] = _forward(C, delta[m, :p])


@numba.njit(cache=True, nogil=True, error_model="numpy")
def spread(r: F64, n: I64, rb: F64, count: I64, h: F64, out: F64, hyper: F64) -> None:
    """Add K̄(r, r̄) h to the first n of each row of out (B, K), r (B, K)."""
    for m in range(len(r)):
        for i in range(n[m]):
            for j in range(count[m]):
                e = -((r[m, i] - rb[m, j]) ** 2) / (2 * hyper[1] ** 2)
                out[m, i] += hyper[0] ** 2 * np.exp(e) * h[m, j]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _adjoint(C: F64, x: F64, h: F64, q: F64, objective: int, truncated: bool) -> tuple[F64, F64]:
    """∂/∂x (p,) and Y (p, p), for which ∂/∂σ̄ = Σ Y∘∂B + gᵀ ∂K̄ h; see `gradients`.

    With s = C⁻¹ q, whitened: hᵀ ∂C s = uᵀ Φ(C⁻¹ ∂B C⁻ᵀ) s = Σ ∂B∘(C⁻ᵀ X C⁻¹), X = Φ's mask of u sᵀ.
    """
    p = len(x)
    Y, s = np.zeros((p, p)), _forward(C, q)
    if objective == WHITENED:
        if not truncated:
            for i in range(p):
                for j in range(i + 1):
                    Y[i, j] = -x[i] * s[j] * (0.5 if i == j else 1.0)
            for j in range(p):
                Y[:, j] = _backward(C, Y[:, j])
            for i in range(p):
                Y[i] = _backward(C, Y[i])
        return s - x, Y
    eta, unit = _backward(C, s), np.zeros(p)
    prior = 1.0 if objective == PRIOR else 0.0
    for j in range(p):
        unit[:] = 0.0
        unit[j] = 1.0
        Y[:, j] = 0.5 * (prior * h * h[j] - _backward(C, _forward(C, unit)))
        if not truncated:
            Y[:, j] -= eta * h[j]
    return eta - prior * h, Y


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _by_hyper(rb: F64, Kb: F64, Y: F64, hyper: F64) -> tuple[float, float, float]:
    """Σ Y∘∂B in the logarithms of σ̄_f, σ̄_l, σ̄_n; Kb = K̄(r̄, r̄)."""
    by_f, by_l, by_n = 0.0, 0.0, 0.0
    for i in range(len(rb)):
        by_n += 2 * hyper[2] ** 2 * Y[i, i]
        for j in range(len(rb)):
            by_f += 2 * Kb[i, j] * Y[i, j]
            by_l += Kb[i, j] * Y[i, j] * (rb[i] - rb[j]) ** 2 / hyper[1] ** 2
    return by_f, by_l, by_n


@numba.njit(cache=True, nogil=True, error_model="numpy")
def gradients(
    r: F64,
    n: I64,
    rb: F64,
    count: I64,
    x: F64,
    h: F64,
    g: F64,
    dx: F64,
    dhyper: F64,
    hyper: F64,
    objective: int,
    truncated: bool,
) -> None:
    """Gradients of Σ (evidence - cost), given g (B, K) = ∂ evidence / ∂ log L at r (B, K).

    Writes dx (B, P) and dhyper (B, 3), the latter in the logarithms of σ̄_f, σ̄_l, σ̄_n.
    Whitened: ∂/∂u = C⁻¹ K̄ᵀ g - u; ∂/∂σ̄ = gᵀ(∂K̄ - K̄ C⁻ᵀ ∂Cᵀ) C⁻ᵀ u. Else, γ = B⁻¹δ with the prior, 0
    without: ∂/∂δ = ηᵀ g - γ; ∂/∂σ̄ = ½ tr[(γγᵀ - B⁻¹) ∂B] + gᵀ(∂K̄ - η ∂B) B⁻¹ δ.

    Args:
        truncated: leave out the terms through η, as the thesis does.
    """
    for m in range(len(r)):
        p = count[m]
        Kb, C = _cholesky(rb[m, :p], hyper)
        q, by_f, by_l = np.zeros(p), 0.0, 0.0
        for i in range(n[m]):
            for j in range(p):
                d2 = (r[m, i] - rb[m, j]) ** 2 / hyper[1] ** 2
                k = hyper[0] ** 2 * np.exp(-0.5 * d2) * g[m, i]
                q[j] += k
                by_f += 2 * k * h[m, j]
                by_l += k * h[m, j] * d2
        dx[m, :p], Y = _adjoint(C, x[m, :p], h[m, :p], q, objective, truncated)
        through = 0.0 if truncated else 1.0
        dhyper[m, 0], dhyper[m, 1], dhyper[m, 2] = _by_hyper(rb[m, :p], Kb, Y, hyper)
        dhyper[m, 0] += through * by_f
        dhyper[m, 1] += through * by_l
