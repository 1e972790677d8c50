"""Jobs over spawned processes, their results in the order of the jobs whatever the number of workers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from typing import TypeVar

Job = TypeVar("Job")
Result = TypeVar("Result")


def run_all(
    work: Callable[[Job], Result],
    jobs: Sequence[Job],
    workers: int = 1,
    on_done: Callable[[int], None] | None = None,
) -> list[Result]:
    """`work` of each job, in order; the first error stops what has not begun.

    Args:
        work: a function of a module. jobs: what it takes. workers: processes; 1 stays in this one.
        on_done: told how many jobs are done.
    """
    tell = on_done or (lambda _done: None)
    if workers <= 1 or len(jobs) <= 1:
        results = []
        for job in jobs:
            results.append(work(job))
            tell(len(results))
        return results
    with ProcessPoolExecutor(min(workers, len(jobs)), mp_context=get_context("spawn")) as pool:
        futures = [pool.submit(work, job) for job in jobs]
        try:
            for done, future in enumerate(as_completed(futures), 1):
                future.result()
                tell(done)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        return [future.result() for future in futures]
