"""Exact marginals of joint association (2.68-2.71; method.md section 12).

The sum over joint events is carried track by track over the set of boxes already taken, of which
only those that later tracks can still claim are remembered: subtrees of the event tree that agree
on them are one. Cost is links x 2^frontier, the frontier being the widest such set.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from datmo.arrays import F64, I64

CELLS = 1 << 22  # weights kept at a time, 32 MB: bounds the non-parametric form, which also counts boxes


@njit(cache=True, nogil=True)
def _order(start: I64, column: I64, c: int) -> tuple[I64, int]:  # pragma: no cover - compiled
    """Order of rows that keeps the frontier small, greedily, and the widest frontier.

    The columns linked to row i are column[start[i] : start[i + 1]].
    """
    r = len(start) - 1
    order, done, open_ = np.empty(r, np.int64), np.zeros(r, np.bool_), np.zeros(c, np.bool_)
    left = np.zeros(c, np.int64)
    for j in column:
        left[j] += 1
    widest = 0
    for k in range(r):
        best, cost, opens = -1, 1 << 30, 0
        for i in range(r):
            if not done[i]:
                new, closed = 0, 0
                for j in column[start[i] : start[i + 1]]:
                    new += not open_[j]
                    closed += left[j] == 1
                if new * 64 - closed < cost:
                    best, cost, opens = i, new * 64 - closed, new
        order[k], done[best] = best, True
        widest = max(widest, open_.sum() + opens)
        for j in column[start[best] : start[best + 1]]:
            left[j] -= 1
            open_[j] = left[j] > 0
    return order, widest


@njit(cache=True, nogil=True)
def _plan(start: I64, column: I64, c: int, order: I64) -> tuple[I64, I64]:  # pragma: no cover - compiled
    """Bit of each column while it is open, and the step after which it closes."""
    r = len(order)
    last, slot = np.full(c, -1), np.full(c, -1)
    for k in range(r):
        for j in column[start[order[k]] : start[order[k] + 1]]:
            last[j] = k
    used = np.zeros(64, np.bool_)
    for k in range(r):
        linked = column[start[order[k]] : start[order[k] + 1]]
        for j in linked:
            if slot[j] < 0:
                bit = 0
                while used[bit]:
                    bit += 1
                slot[j], used[bit] = bit, True
        for j in linked:
            if last[j] == k:
                used[slot[j]] = False
    return slot, last


@njit(cache=True, nogil=True)
def _forward(W, miss, start, column, order, slot, last, counts, bits):  # type: ignore[no-untyped-def]  # pragma: no cover
    """Weight of all ways to reach each (count, mask) before each row."""
    r = len(order)
    step = 1 if counts > 1 else 0
    F = np.zeros((r + 1, counts, 1 << bits))
    F[0, 0, 0] = 1
    for k in range(r):
        i = order[k]
        linked = column[start[i] : start[i + 1]]
        for n in range(counts):
            for mask in range(1 << bits):
                f = F[k, n, mask]
                if f > 0:
                    F[k + 1, n, mask] += f * miss[i]
                    for j in linked:
                        if not mask >> slot[j] & 1:
                            F[k + 1, n + step, mask | 1 << slot[j]] += f * W[i, j]
        for j in linked:
            if last[j] == k:
                for n in range(counts):
                    for mask in range(1 << bits):
                        if mask >> slot[j] & 1:
                            F[k + 1, n, mask ^ 1 << slot[j]] += F[k + 1, n, mask]
                            F[k + 1, n, mask] = 0
        F[k + 1] /= F[k + 1].max()
    return F


@njit(cache=True, nogil=True)
def _backward(W, miss, phi, F, start, column, order, slot, last, counts, bits):  # type: ignore[no-untyped-def]  # pragma: no cover
    """Marginals (r, c + 1) from the forward weights; the last column is the miss."""
    r, c = W.shape
    step = 1 if counts > 1 else 0
    out = np.zeros((r, c + 1))
    B = np.zeros((counts, 1 << bits))
    B[:, 0] = phi[:counts]
    for k in range(r - 1, -1, -1):
        i = order[k]
        linked = column[start[i] : start[i + 1]]
        for j in linked[::-1]:
            if last[j] == k:
                for n in range(counts):
                    for mask in range(1 << bits):
                        if mask >> slot[j] & 1:
                            B[n, mask] = B[n, mask ^ 1 << slot[j]]
        A = np.zeros_like(B)
        for n in range(counts):
            for mask in range(1 << bits):
                f = F[k, n, mask]
                if f > 0:
                    out[i, c] += f * miss[i] * B[n, mask]
                    A[n, mask] = miss[i] * B[n, mask]
                    for j in linked:
                        if not mask >> slot[j] & 1:
                            g = W[i, j] * B[n + step, mask | 1 << slot[j]]
                            out[i, j] += f * g
                            A[n, mask] += g
        B = A / A.max()
        out[i] /= out[i].sum()
    return out


def marginals(W: F64, miss: F64, phi: F64 | None = None, max_bits: int = 14) -> tuple[F64, int]:
    """Marginal association probabilities of one group of tracks.

    Args:
        W: (r, c) weight of giving box j to track i, 0 where not gated.
        miss: (r,) weight of giving it none, > 0.
        phi: (min(r, c) + 1,) weight of an event by the number of boxes it assigns; None is 1 for
            all, the Poisson form.
        max_bits: widest frontier summed exactly; beyond it, or where memory does not hold it, the
            weakest links are cut until it fits, which bounds time and memory.

    Returns:
        (r, c + 1) marginals, each row sums to one, the last column is the miss; and the number of
        links that were cut (0: exact).
    """
    r, c = W.shape
    if c == 0 or r == 0:
        return np.ones((r, 1)) if c == 0 else np.zeros((r, c + 1)), 0
    W, miss = np.array(W, float), np.asarray(miss, float)
    scale = np.maximum(W.max(axis=1), miss)
    W, miss = W / scale[:, None], miss / scale
    counts = 1 if phi is None else min(r, c) + 1
    weights = np.ones(1) if phi is None else phi / phi.max()
    rows, columns = _weakest_first(W)
    cut = 0
    while True:
        order, widest = _order(*_by_row(rows[cut:], columns[cut:], r), c)
        flipped, narrow = _order(*_by_row(columns[cut:], rows[cut:], c), r)
        plain = _fits(widest, r, counts, max_bits)
        if plain or _fits(narrow, c, counts, max_bits):
            break
        cut += max((len(rows) - cut) // 20, 1)
    W[rows[:cut], columns[:cut]] = 0
    if plain and widest <= narrow:
        return _run(W, miss, weights, order, counts, widest), cut
    tracks_last = _run((W / miss[:, None]).T.copy(), np.ones(c), weights, flipped, counts, narrow)
    beta = tracks_last[:, :r].T
    return np.concatenate([beta, np.maximum(1 - beta.sum(axis=1), 0)[:, None]], 1), cut


def _fits(bits: int, rows: int, counts: int, max_bits: int) -> bool:
    """Whether a frontier may be summed; the Poisson form (one count) is bounded by its bits alone."""
    return bits <= max_bits and (counts == 1 or (rows + 1) * counts << bits <= CELLS)


def _weakest_first(W: F64) -> tuple[I64, I64]:
    """Rows and columns of the links of W, weakest first.

    Among equals those far from the diagonal come first, so that no track loses all of its own.
    """
    rows, columns = np.nonzero(W)
    order = np.lexsort((-((columns - rows) % W.shape[1]), W[rows, columns]))
    return rows[order], columns[order]


def _by_row(rows: I64, columns: I64, r: int) -> tuple[I64, I64]:
    """Where the columns linked to each of r rows begin (r + 1,), and those columns, row after row."""
    return np.append(0, np.cumsum(np.bincount(rows, minlength=r))), columns[np.argsort(rows, kind="stable")]


def _run(W: F64, miss: F64, phi: F64, order: I64, counts: int, bits: int) -> F64:
    rows, columns = np.nonzero(W)
    start, column = _by_row(rows, columns, len(W))
    slot, last = _plan(start, column, W.shape[1], order)
    F = _forward(W, miss, start, column, order, slot, last, counts, bits)
    return np.asarray(_backward(W, miss, phi, F, start, column, order, slot, last, counts, bits))
