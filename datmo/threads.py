"""Threads for work over fixed blocks of rows: one pool a process, results in order, whoever does them."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any, TypeVar

from datmo.arrays import Array

ROWS = 4
"""Blocks of `over_rows`."""

Item = TypeVar("Item")
Result = TypeVar("Result")


def workers() -> int:
    """Processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@cache
def _pool(_process: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(workers(), thread_name_prefix="datmo")


def spread(work: Callable[[Item], Result], items: Iterable[Item]) -> list[Result]:
    """`work` of each item, in the order of the items, on the threads of this process.

    Whoever is free takes the next item, the caller too: a sweep has a dozen of these, and handing over
    every item by itself would cost more than the items. The pool belongs to the process that made it: a
    forked child makes its own.
    """
    todo = list(items)
    done: dict[int, Result] = {}
    turn = itertools.count()

    def take_turns() -> None:
        while (i := next(turn)) < len(todo):
            done[i] = work(todo[i])

    helpers = [_pool(os.getpid()).submit(take_turns) for _ in range(min(workers(), len(todo)) - 1)]
    try:
        take_turns()
    finally:
        late = [helper for helper in helpers if not helper.cancel()]
        for helper in late:
            helper.result()
    return [done[i] for i in range(len(todo))]


def blocks(rows: int, count: int = 16) -> list[slice]:
    """`count` fixed slices that cover `rows`, whatever the number of threads."""
    edges = [rows * i // count for i in range(count + 1)]
    return [slice(a, b) for a, b in itertools.pairwise(edges)]


def groups(count: int, size: int) -> list[slice]:
    """Slices of `size` that cover `count` items; the last may be shorter."""
    return [slice(i, min(i + size, count)) for i in range(0, count, size)]


def over_rows(kernel: Callable[..., None], arrays: tuple[Array, ...], constants: tuple[Any, ...]) -> None:
    """kernel(*blocks, *constants) for fixed blocks of the arrays' rows; it writes into some of them."""
    spread(lambda rows: kernel(*(a[rows] for a in arrays), *constants), blocks(len(arrays[0]), ROWS))
