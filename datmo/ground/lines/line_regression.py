"""Line regression: lines of a sliding window, those alike next to each other clustered (Alg. 13)."""

from __future__ import annotations

import numba
import numpy as np

from datmo.arrays import F64, I32
from datmo.ground.lines.table import JOIN, MOST_RMSE, fit, record_labels

WINDOW = 7
"""N_f, points of the sliding window."""
FIDELITY = 4.0
"""Most sum of squared Mahalanobis distances of a window to the one before and the one behind."""
ALIKE = 13.8
"""Most squared Mahalanobis distance of two clusters that are merged: chi-square, 2 degrees, 99.9 %."""
ANGLE, R, Z, FIT, SPREAD, N = range(6)
MODEL = 6


@numba.njit(cache=True, nogil=True)
def _model(r: F64, z: F64, a: int, b: int, model: F64) -> None:
    """Line through points a..b-1 and what its uncertainty depends on: Σ along², number of points."""
    model[ANGLE], model[R], model[Z], model[FIT] = fit(r, z, a, b)
    c, s = np.cos(model[ANGLE]), np.sin(model[ANGLE])
    model[SPREAD] = 1e-12
    for i in range(a, b):
        model[SPREAD] += (c * (r[i] - model[R]) + s * (z[i] - model[Z])) ** 2
    model[N] = b - a


@numba.njit(cache=True, nogil=True)
def _distance(p: F64, q: F64, sigma: float) -> float:
    """Squared Mahalanobis distance of two lines in angle and offset half-way between their centroids.

    Of a line fitted to points with scatter σ, the variance of the angle is σ² / Σ along², and that of
    the offset at the centroid is σ² / n, independent of each other; the offset at a distance x along
    it has x times the angle's error more.
    """
    turn = q[ANGLE] - p[ANGLE]
    turn -= np.pi * np.round(turn / np.pi)
    middle = p[ANGLE] + 0.5 * turn
    c, s = np.cos(middle), np.sin(middle)
    u, v = 0.5 * (q[R] - p[R]), 0.5 * (q[Z] - p[Z])
    lever = c * u + s * v
    off = 2 * (c * v - s * u)
    vp, vq = 1.0 / p[SPREAD], 1.0 / q[SPREAD]
    aa = vp + vq
    ao = lever * (vp - vq)
    oo = 1.0 / p[N] + 1.0 / q[N] + lever * lever * (vp + vq)
    det = aa * oo - ao * ao
    return float((oo * turn * turn - 2 * ao * turn * off + aa * off * off) / (det * sigma * sigma))


@numba.njit(cache=True, nogil=True)
def _fidelity(windows: F64, rules: F64, fidelity: F64) -> None:
    """Of each window (w,), how ill it agrees with its neighbours; infinite for an ill fit."""
    last = len(windows) - 1
    for i in range(last + 1):
        before = _distance(windows[i - 1], windows[i], rules[JOIN] / 3) if i else 0.0
        behind = _distance(windows[i], windows[i + 1], rules[JOIN] / 3) if i < last else 0.0
        fidelity[i] = before + behind if windows[i, FIT] <= rules[MOST_RMSE] else np.inf


@numba.njit(cache=True, nogil=True)
def _clusters(r: F64, z: F64, fidelity: F64, width: int, spans: I32, models: F64) -> int:
    """Write the points (first, one behind last) of each run of faithful windows, and its line."""
    k, a = 0, -1
    for i in range(len(fidelity) + 1):
        faithful = i < len(fidelity) and fidelity[i] <= FIDELITY
        if faithful and a < 0:
            a = i
        elif not faithful and a >= 0:
            spans[k, 0], spans[k, 1] = a, i - 1 + width
            _model(r, z, a, i - 1 + width, models[k])
            k, a = k + 1, -1
    return k


@numba.njit(cache=True, nogil=True)
def _agglomerate(r: F64, z: F64, rules: F64, spans: I32, models: F64, k: int) -> int:
    """Merge the two nearest neighbours while they are alike; how many clusters are left."""
    sigma, apart = rules[JOIN] / 3, np.empty(k + 1)
    for j in range(k - 1):
        apart[j] = _distance(models[j], models[j + 1], sigma)
    while k > 1:
        best = 0
        for j in range(1, k - 1):
            if apart[j] < apart[best]:
                best = j
        if apart[best] > ALIKE:
            break
        if fit(r, z, spans[best, 0], spans[best + 1, 1])[3] > rules[MOST_RMSE]:
            apart[best] = np.inf
            continue
        spans[best, 1] = spans[best + 1, 1]
        k -= 1
        for j in range(best + 1, k):
            spans[j, 0], spans[j, 1] = spans[j + 1, 0], spans[j + 1, 1]
            apart[j - 1] = apart[j]
            for c in range(MODEL):
                models[j, c] = models[j + 1, c]
        _model(r, z, spans[best, 0], spans[best, 1], models[best])
        for j in range(max(best - 1, 0), min(best + 1, k - 1)):
            apart[j] = _distance(models[j], models[j + 1], sigma)
    return k


@numba.njit(cache=True, nogil=True)
def line_regression(r: F64, z: F64, rules: F64, draws: F64, lines: F64) -> int:  # noqa: ARG001
    """Fill `lines` with the lines of ordered points (n,); their number. `draws` is not used.

    Windows that straddle a break are faithful to neither side. Their points, and those where two
    clusters overlap, go to the nearest line within `join`. σ of a point is a third of `join`.
    """
    n = len(r)
    if n < 2:
        return 0
    width = min(WINDOW, n)
    windows, fidelity = np.empty((n - width + 1, MODEL)), np.empty(n - width + 1)
    for i in range(len(windows)):
        _model(r, z, i, i + width, windows[i])
    _fidelity(windows, rules, fidelity)
    spans, models = np.empty((len(windows), 2), np.int32), np.empty((len(windows), MODEL))
    k = _clusters(r, z, fidelity, width, spans, models)
    k = _agglomerate(r, z, rules, spans, models, k)
    label, nearest = np.empty(n, np.int32), np.empty(n)
    for i in range(n):
        label[i], nearest[i] = -1, rules[JOIN]
    for j in range(k):
        c, s = np.cos(models[j, ANGLE]), np.sin(models[j, ANGLE])
        for i in range(max(spans[j, 0] - width, 0), min(spans[j, 1] + width, n)):
            off = abs(c * (z[i] - models[j, Z]) - s * (r[i] - models[j, R]))
            if off <= nearest[i]:
                label[i], nearest[i] = j, off
    return int(record_labels(r, z, label, k, rules, lines))
