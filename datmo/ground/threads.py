"""Work over fixed blocks on the threads of this process; the result does not depend on them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from itertools import pairwise
from typing import Any

from datmo.arrays import Array

WORKERS = 2
BLOCKS = 4


@lru_cache(maxsize=1)
def _pool(process: int) -> ThreadPoolExecutor:
    """The pool of this process: threads do not survive a fork, so the process is part of the key."""
    return ThreadPoolExecutor(WORKERS, thread_name_prefix=f"ground-{process}")


def each(task: Callable[[Any], Any], items: Iterable[Any]) -> list[Any]:
    """task(item) of each, in order."""
    return list(_pool(os.getpid()).map(task, items))


def blocks(n: int, count: int = 0) -> list[tuple[int, int]]:
    """First row and the one after the last of each of `count` blocks of n rows, of `BLOCKS` if 0."""
    count = count or BLOCKS
    edges = [n * b // count for b in range(count + 1)]
    return list(pairwise(edges))


def over_rows(kernel: Callable[..., None], arrays: tuple[Array, ...], constants: tuple[Any, ...]) -> None:
    """kernel(*blocks, *constants) for fixed blocks of the arrays' rows; it writes into some of them."""
    each(lambda rows: kernel(*(a[slice(*rows)] for a in arrays), *constants), blocks(len(arrays[0])))
