"""What runs work somewhere: in threads or processes, or on other machines."""

from __future__ import annotations

import functools
import logging
import os
import uuid
from collections import deque
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import BrokenExecutor
from typing import Any, Protocol, TypeVar

from umbmark._arguments import whole

log = logging.getLogger("umbmark.distributed")

# What is under way or waits for something before it, for each worker.
AHEAD = 4
# How often work is tried again where its worker fails.
RETRIES = 3
MOST_WORKERS = 1_000_000

Item = TypeVar("Item")
Part = TypeVar("Part")


class Future(Protocol):
    """Work that was submitted. Where it has a method ``cancel``, needless work is cancelled."""

    def result(self) -> Any:
        """Wait for what the work gives, or raise what it raised."""


class Executor(Protocol):
    """What runs work somewhere: in threads or processes, or on other machines.

    Work and what it gives are pickled where they leave the process.
    """

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Future:
        """Begin ``function(*arguments)``, and return at once."""
        ...


def in_order(
    executor: Executor, work: Callable[[Item], Part], items: Sequence[Item], workers: int | None
) -> Generator[Part, None, None]:
    """Give the work of each item, in their order, however they come.

    ``workers`` is how many the executor does at a time, found out where None is given.
    """
    if workers is not None:
        workers = whole("workers", workers, 1, MOST_WORKERS)
    # Dask gives equal calls one result, and cancels it for all of them: no two studies are equal.
    study = uuid.uuid4().hex
    begin = functools.partial(executor.submit, _chunk, work, study)
    waiting: deque[tuple[int, Future]] = deque()
    begun = 0
    try:
        while begun < len(items) or waiting:
            ahead = AHEAD * (workers or _workers_of(executor))
            while begun < len(items) and len(waiting) < ahead:
                waiting.append((begun, begin(items[begun], 0)))
                begun += 1
            index, future = waiting[0]
            part = _result(functools.partial(begin, items[index]), index, future)
            waiting.popleft()
            yield part
    finally:
        for _, future in waiting:
            cancel = getattr(future, "cancel", None)
            if cancel is not None:
                cancel()


def _chunk(work: Callable[[Item], Part], study: str, item: Item, retry: int) -> Part:
    """Do the work of one item; a retry is another call than what failed."""
    return work(item)


def _result(again: Callable[[int], Future], index: int, future: Future) -> Any:
    """Give what an item's work gives; where its worker failed, try again."""
    for retry in range(1, RETRIES + 1):
        try:
            return future.result()
        except (ValueError, TypeError, BrokenExecutor):
            # The study is wrong, or nothing can be submitted any more.
            raise
        except Exception as error:
            log.warning("chunk %d failed, retry %d of %d: %r", index, retry, RETRIES, error)
            future = again(retry)
    return future.result()


def _workers_of(executor: Executor) -> int:
    """Give how many run at a time: Dask tells, and may grow meanwhile."""
    threads: Any = getattr(executor, "nthreads", None)
    known = os.cpu_count() if threads is None else sum(threads().values())
    return max(1, known or 1)
