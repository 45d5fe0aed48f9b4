"""Where the work on parts runs: processes, or this process. A process that dies is not the end."""

from __future__ import annotations

import os
import queue
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing import active_children, get_context, parent_process
from typing import Any, Final, Protocol

from ddgfab.errors import DdgError
from fabrication.processes import expendable


class WorkerLostError(DdgError):
    """A process ended while it worked, twice: with others beside it, and then alone.

    Attributes
    ----------
    why : the message without what it was about
    """

    why = "a worker was killed, probably out of memory; try --jobs 1"

    def __init__(self, what: str = "") -> None:
        super().__init__(f"{what}: {self.why}" if what else self.why)


class Workers(Protocol):
    """What a job needs of its workers: the interface of `concurrent.futures`, and a hard stop.

    at_once : whether a call is over when `submit` comes back
    """

    at_once: bool

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Future[Any]:
        """Start a call. Its result raises `WorkerLostError` where processes die of it."""

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


class _Processes:
    """Processes that start at once, leave Ctrl-C to this process and end with it.

    When one dies, all calls that were not over are lost with the pool. They run once more, one
    after the other, each in a process that has no others beside it: then it is known which call
    it was, and there is more memory.
    """

    at_once = False

    def __init__(self, count: int, kernel: bool) -> None:
        self._kernel = kernel
        self._pool = _Executor(count, kernel)
        self._lost: queue.SimpleQueue[tuple[Future[Any], Any, Any]] = queue.SimpleQueue()
        self._rescue: threading.Thread | None = None
        self._alone: _Executor | None = None
        self._guard = threading.Lock()
        self._stopped = False

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Future[Any]:
        result: Future[Any] = Future()
        try:
            first = self._pool.submit(fn, *args)
        except BrokenProcessPool:
            self._again(result, fn, args)
            return result
        first.add_done_callback(lambda done: self._over(done, result, fn, args))
        return result

    def stop(self) -> None:
        self._stopped = True
        self._pool.stop()
        with self._guard:
            if self._alone is not None:
                self._alone.stop()

    def _over(
        self, done: Future[Any], result: Future[Any], fn: Callable[..., Any], args: Any
    ) -> None:
        """Hand a result on, or begin again where the pool was lost."""
        if done.cancelled() or self._stopped:
            result.cancel()
            return
        error = done.exception()
        if isinstance(error, BrokenProcessPool):
            self._again(result, fn, args)
        elif error is not None:
            result.set_exception(error)
        else:
            result.set_result(done.result())

    def _again(self, result: Future[Any], fn: Callable[..., Any], args: Any) -> None:
        self._lost.put((result, fn, args))
        with self._guard:
            if self._rescue is None:
                self._rescue = threading.Thread(target=self._one_by_one, daemon=True)
                self._rescue.start()

    def _one_by_one(self) -> None:
        """Carry out what was lost, in a process that works for nobody else."""
        while not self._stopped:
            result, fn, args = self._lost.get()
            try:
                with self._guard:
                    if self._stopped:
                        return
                    if self._alone is None:
                        self._alone = _Executor(1, self._kernel)
                result.set_result(self._alone.submit(fn, *args).result())
            except BrokenProcessPool:
                with self._guard:
                    self._alone = None
                result.set_exception(WorkerLostError())
            except Exception as error:
                result.set_exception(error)


class _Executor(ProcessPoolExecutor):
    """A pool whose workers start at once."""

    def __init__(self, count: int, kernel: bool) -> None:
        self._others = active_children()
        with _interrupts_ignored():  # inherited by the workers, and what multiprocessing starts
            super().__init__(
                count, mp_context=get_context("spawn"), initializer=_begin, initargs=(kernel,)
            )
            for _ in range(count):
                with suppress(BrokenProcessPool):  # one that dies at once is found when it is used
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


_OF_TERMINALS: Final = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGHUP") if hasattr(signal, name)
)
"""Signals that a terminal sends to all processes of a job: the first of them ends the others."""


@contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """SIGINT and SIGHUP ignored in this process, where they may be (the main thread)."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, signal.SIG_IGN) for number in _OF_TERMINALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _begin(kernel: bool) -> None:
    """Of a worker: end with the parent; if asked, load the kernel and keep it quiet."""
    for number in _OF_TERMINALS:
        with suppress(ValueError):
            signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    expendable()
    if not kernel:
        return
    with suppress(Exception):  # what needs it says why it cannot be loaded; here nobody listens
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
