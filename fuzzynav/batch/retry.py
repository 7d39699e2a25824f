"""Cases whose worker died: tried again where a death costs nobody else, and given up by name after the second."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from typing import Any

__all__ = ["once_more"]

Answer = tuple[Any, Any, BaseException | None]
TRIES = 2  # a case alone in its pool


def once_more(
    work: Callable[[list[Any]], Any], cases: Sequence[Any], executor: Executor, broken: bool
) -> Iterator[Answer]:
    """(case, what `work([case])` returned, what its worker died of), each case by itself.

    A broken pool of processes is replaced by pools of the same kind; any other executor is asked again.
    """
    if not broken or not isinstance(executor, ProcessPoolExecutor):
        for case in cases:
            yield _asked(work, case, executor)
        return
    suspects: list[Any] = []
    taken = 0
    while taken < len(cases):
        taken += yield from _until_broken(work, cases[taken:], executor, suspects)
    for case in suspects:
        for last in range(TRIES):
            with _new_pool(executor, 1) as pool:
                answer = _asked(work, case, pool)
            if answer[2] is None or last == TRIES - 1:
                yield answer
                break


def _asked(work: Callable[[list[Any]], Any], case: Any, executor: Executor) -> Answer:
    try:
        return case, executor.submit(work, [case]).result(), None
    except Exception as error:  # whatever an executor makes of a lost worker or of rows that cannot travel
        return case, None, error


def _until_broken(
    work: Callable[[list[Any]], Any], cases: Sequence[Any], old: ProcessPoolExecutor, suspects: list[Any]
) -> Generator[Answer, None, int]:
    """Run cases in a new pool, as many at a time as it has workers; how many were taken when it broke, or all.

    Those in the workers when it breaks are added to `suspects`.
    """
    width = getattr(old, "_max_workers", 1)
    taken = 0
    running: dict[Future[Any], Any] = {}
    with _new_pool(old, width) as pool:
        while taken < len(cases) or running:
            while taken < len(cases) and len(running) < width:
                try:
                    running[pool.submit(work, [cases[taken]])] = cases[taken]
                except BrokenExecutor:
                    break
                taken += 1
            if not running:  # a pool that never took a case
                suspects.append(cases[taken])
                return taken + 1
            dead = False
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                case = running.pop(future)
                error = future.exception()
                if isinstance(error, BrokenExecutor):
                    suspects.append(case)
                    dead = True
                else:
                    yield case, None if error else future.result(), error
            if dead:
                suspects.extend(running.values())
                return taken
    return taken


def _new_pool(old: ProcessPoolExecutor, workers: int) -> ProcessPoolExecutor:
    """A pool made like another one."""
    made: dict[str, Any] = {
        "mp_context": getattr(old, "_mp_context", None),
        "initializer": getattr(old, "_initializer", None),
        "initargs": getattr(old, "_initargs", ()),
    }
    return ProcessPoolExecutor(workers, **made)
