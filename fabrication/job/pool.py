"""Where the work on parts runs: processes, or this process."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from typing import Any, Protocol


class Workers(Protocol):
    """What a job needs of its workers: the interface of `concurrent.futures`, and a hard stop.

    at_once : whether a call is over when `submit` comes back
    """

    at_once: bool

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Future[Any]:
        """Start a call."""

    def stop(self) -> None:
        """End everything at once; whatever was being written stays as it is."""


def process_count(jobs: int) -> int:
    """How many processes a pool of `jobs` has; 0 stands for one a core."""
    return jobs or os.cpu_count() or 1


@contextmanager
def worker_pool(jobs: int, *, kernel: bool = True) -> Iterator[Workers]:
    """Processes to work in.

    Parameters
    ----------
    jobs : how many; 0: one a core, 1: this process
    kernel : whether they load the CAD kernel at once, while this process designs
    """
    count = process_count(jobs)
    if count == 1:
        yield _Here()
        return
    pool = _Processes(count, kernel)
    try:
        yield pool
    finally:
        pool.stop()  # at the good end too: nothing runs any more, and leaving the kernel takes time


class _Processes(ProcessPoolExecutor):
    """A pool whose workers start at once, leave Ctrl-C to this process and end with it."""

    at_once = False

    def __init__(self, count: int, kernel: bool) -> None:
        self._others = active_children()
        super().__init__(
            count, mp_context=get_context("spawn"), initializer=_begin, initargs=(kernel,)
        )
        with _interrupts_ignored():  # inherited by the workers
            for _ in range(count):
                self.submit(_ready)

    def stop(self) -> None:
        for worker in active_children():
            if worker not in self._others:
                worker.terminate()
        # A worker that ends while it writes leaves half a message, for whose rest the executor
        # would wait as long as this process has the pipe open for writing itself.
        results = getattr(self, "_result_queue", None)
        if results is not None:
            results._writer.close()
        self.shutdown(wait=True, cancel_futures=True)


class _Here:
    """Works at once in this process."""

    at_once = True

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args))
        except Exception as error:
            future.set_exception(error)
        return future

    def stop(self) -> None:
        """Nothing runs."""


@contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """SIGINT ignored in this process, where it may be changed (the main thread)."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _begin(kernel: bool) -> None:
    """Of a worker: end with the parent; if asked, load the kernel and keep it quiet."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    if not kernel:
        return
    from fabrication.formats.step.xcaf import mute
    from fabrication.solids.kernel import load_kernel

    load_kernel()
    mute()


def _end_with_parent() -> None:
    """A killed parent cannot stop its workers, and they would wait for work for ever."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _ready() -> None:
    """Nothing: a task that makes a worker start."""
