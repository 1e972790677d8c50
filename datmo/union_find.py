"""Disjoint sets: which things belong together, from pairs of them (Tarjan 1975)."""

from __future__ import annotations

from numba import njit

from datmo.arrays import Array


@njit(cache=True, nogil=True)
def join(parent: Array, a: int, b: int) -> None:  # pragma: no cover - compiled
    """Make the sets of `a` and `b` one, in place; the lowest member of a set is its root.

    Args:
        parent: (n,) of integers; a root is its own parent, at first each is.
    """
    while parent[a] != a:
        parent[a] = parent[parent[a]]
        a = parent[a]
    while parent[b] != b:
        parent[b] = parent[parent[b]]
        b = parent[b]
    if a < b:
        parent[b] = a
    else:
        parent[a] = b
