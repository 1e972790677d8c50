from __future__ import annotations

import threading
import time

import numpy as np
import pytest

from datmo import threads
from datmo.threads import blocks, groups, over_rows, spread


def test_results_are_in_the_order_of_the_items_whoever_is_late() -> None:
    def late(i: int) -> int:
        time.sleep(0.002 * (5 - i % 5))
        return i * i

    assert spread(late, range(23)) == [i * i for i in range(23)]
    assert spread(late, []) == []


def test_one_processor_needs_no_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "workers", lambda: 1)
    assert set(spread(lambda _: threading.get_ident(), range(9))) == {threading.get_ident()}


@pytest.mark.parametrize("bad", [0, 4, 8])
def test_an_error_reaches_the_caller(bad: int) -> None:
    def work(i: int) -> int:
        if i == bad:
            raise ValueError(f"item {i}")
        return i

    with pytest.raises(ValueError, match=f"item {bad}"):
        spread(work, range(9))


@pytest.mark.parametrize("rows", [0, 1, 15, 16, 17, 1000])
def test_slices_cover_every_row_once(rows: int) -> None:
    for slices in (blocks(rows), blocks(rows, 3), groups(rows, 4)):
        assert [i for s in slices for i in range(s.start, s.stop)] == list(range(rows))


def test_a_kernel_writes_into_the_rows_of_its_block() -> None:
    def kernel(x: np.ndarray, out: np.ndarray, factor: float) -> None:
        out[:] = factor * x

    x, out = np.arange(11.0), np.empty(11)
    over_rows(kernel, (x, out), (3.0,))
    assert np.array_equal(out, 3 * x)
