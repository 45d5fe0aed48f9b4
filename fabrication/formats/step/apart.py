"""The CAD kernel reads files in a process of its own: a damaged file ends that one, not this one.

One process loads the kernel, which takes seconds, and stays; for each file of others it makes a
copy of itself, where the system can, which reads that file and ends. Memory and computing time are
limited by the file's size. Processes that a job keeps for its parts read for themselves
(`processes.expendable`): the job goes on without one of them.
"""

from __future__ import annotations

import atexit
import ctypes
import math
import os
import pickle
import queue
import signal
import stat
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, Final, TypeVar

from ddgfab.errors import DdgError, InputError, KernelError, clipped
from fabrication.formats.step.resources import limit_process
from fabrication.processes import is_expendable

SECONDS, SECONDS_PER_MB = 4.0, 40.0
"""Computing time [s] that a file may take, and more for each megabyte."""

MEMORY, MEMORY_PER_BYTE = 512 << 20, 100
"""Memory [bytes] that a file may take beside the kernel's own, and more for each of its bytes."""

STARTING: Final = 300.0
"""Longest time [s] that the kernel may take to load."""

_COPIES: Final = hasattr(os, "fork")
"""Whether a process can make a copy of itself."""

_T = TypeVar("_T")
_LOCK: Final = threading.RLock()


def apart(function: Callable[..., _T], path: Path, *arguments: Any, foreign: bool = True) -> _T:
    """What `function(path, *arguments)` gives in the process that reads.

    Parameters
    ----------
    function : of a module, as it is sent by name
    path : of the file
    foreign : whether it may be damaged; files of ours, just written, are read without a copy of
        the process

    Raises
    ------
    InputError
        The file is missing or no regular file; the kernel crashed on it, refused it, or needed
        more time or memory than the limits; or what the function raises.
    KernelError
        The process cannot be started.
    """
    size = _regular(path)
    if is_expendable():
        return _timed(function, path, arguments, size)
    folder = None if path.is_absolute() else Path.cwd()
    with _LOCK:
        for _ in range(2):
            child = _child()
            used = child.served > 0
            try:
                kind, value = child.ask((folder, function, path, arguments, foreign), size)
            except _DiedError as died:
                if not child.alive:
                    _drop()
                if used and not died.limit and not _COPIES:
                    continue  # an earlier file may have left it broken
                raise InputError(str(died), file=str(path)) from None
            except BaseException:
                _drop()
                raise
            if kind == "value":
                result: _T = value
                return result
            if kind == "memory" and not (foreign and _COPIES):
                _drop()
            raise value
        raise AssertionError


def limits(size: int) -> tuple[float, int]:
    """Computing time [s] and memory [bytes] for a file of so many bytes."""
    return SECONDS + SECONDS_PER_MB * size / 1e6, MEMORY + MEMORY_PER_BYTE * size


def _regular(path: Path) -> int:
    """Bytes of a regular file."""
    try:
        found = path.stat()
    except (OSError, ValueError) as error:
        if isinstance(error, FileNotFoundError):
            raise InputError("no such file", file=str(path)) from None
        why = getattr(error, "strerror", None) or str(error)
        raise InputError(f"cannot be read: {why}", file=str(path)) from None
    if not stat.S_ISREG(found.st_mode):
        raise InputError("is not a file, but a folder, pipe or device", file=str(path))
    return found.st_size


# --- this side ----------------------------------------------------------------------------------
class _DiedError(Exception):
    """The process is gone; `limit` when a limit ended it."""

    def __init__(self, why: str, *, limit: bool) -> None:
        super().__init__(why)
        self.limit = limit


class _Child:
    """The process that reads."""

    def __init__(self) -> None:
        self.owner = os.getpid()
        self.served = 0
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join(entry or os.getcwd() for entry in sys.path),  # noqa: PTH109
        }
        program = f"from {__name__} import serve; serve()"
        try:
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-c", program],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=environment,
            )
        except OSError as error:
            raise KernelError(f"the process that reads CAD files: {error.strerror}") from error
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self._questions: BinaryIO = self.process.stdin  # type: ignore[assignment]
        self._answers: queue.SimpleQueue[Any] = queue.SimpleQueue()
        threading.Thread(target=self._listen, args=(self.process.stdout,), daemon=True).start()
        try:
            ready = self._answers.get(timeout=STARTING)
        except queue.Empty:
            ready = None
        except BaseException:
            self.end()
            raise
        if ready is None or ready[0] != "value":
            self.end()
            why = "ended" if ready is None else str(ready[1])
            raise KernelError(f"the process that reads CAD files does not start: {why}")

    @property
    def alive(self) -> bool:
        return self.owner == os.getpid() and self.process.poll() is None

    def _listen(self, stream: BinaryIO) -> None:
        """Put every answer into the queue, and None at the end."""
        try:
            while True:
                self._answers.put(pickle.load(stream))
        except Exception:  # the end, or half an answer
            self._answers.put(None)

    def ask(self, question: Any, size: int) -> tuple[str, Any]:
        """An answer, as (kind, value)."""
        seconds, _ = limits(size)
        self.served += 1
        with suppress(OSError):  # it died: the answer says so
            pickle.dump((question, size), self._questions)
            self._questions.flush()
        try:
            answer = self._answers.get(timeout=20.0 + 10.0 * seconds)
        except queue.Empty:
            self.end()
            raise _DiedError(_too_long(seconds), limit=True) from None
        if answer is not None:
            kind, value = answer
            if kind != "died":
                return kind, value
            code = value
        else:
            code = self.process.wait()
        if code in (-getattr(signal, "SIGXCPU", 0), -getattr(signal, "SIGALRM", 0)):
            raise _DiedError(_too_long(seconds), limit=True)
        if code == -getattr(signal, "SIGKILL", 0):
            raise _DiedError("the CAD kernel was killed on it, probably out of memory", limit=True)
        name = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        raise _DiedError(f"the CAD kernel crashed on it ({name}): it is damaged", limit=False)

    def end(self) -> None:
        if self.owner == os.getpid():
            self.process.kill()
            self.process.wait()


_CHILDREN: Final[list[_Child]] = []


def _child() -> _Child:
    if _CHILDREN and not _CHILDREN[0].alive:
        _drop()
    if not _CHILDREN:
        _CHILDREN.append(_Child())
    return _CHILDREN[0]


@atexit.register
def _drop() -> None:
    for child in _CHILDREN:
        child.end()
    _CHILDREN.clear()


def _too_long(seconds: float) -> str:
    return (
        f"reading it takes more than {seconds:.0f} s of computing, the limit for a file of its "
        "size: it is damaged, or too much for the CAD kernel"
    )


def _too_much(size: int) -> str:
    return (
        f"reading it takes more than {limits(size)[1] / 2**20:.0f} MB of memory, the limit for a "
        "file of its size: it is damaged, or too much for the CAD kernel"
    )


# --- the other side -----------------------------------------------------------------------------
def serve() -> None:
    """Answer questions on standard input until it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    questions = sys.stdin.buffer
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what the kernel prints
    try:
        from fabrication.formats.step.xcaf import mute
        from fabrication.solids.kernel import load_kernel

        load_kernel()
        mute()
        answer: tuple[str, Any] = ("value", None)
    except Exception as error:
        answer = ("error", KernelError(f"{type(error).__name__}: {clipped(error, 300)}"))
    while True:
        data = pickle.dumps(answer)
        answers.write(data)
        answers.flush()
        try:
            (folder, function, path, arguments, foreign), size = pickle.load(questions)
        except EOFError:
            os._exit(0)  # leaving the kernel takes time
        if folder is not None:
            os.chdir(folder)
        if foreign and _COPIES:
            answer = _copied(function, path, arguments, size)
        else:
            answer = _answer(function, path, arguments, size)


def _copied(
    function: Callable[..., Any], path: Path, arguments: tuple[Any, ...], size: int
) -> tuple[str, Any]:
    """The answer of a copy of this process."""
    reading, writing = os.pipe()
    copy = os.fork()
    if not copy:
        os.close(reading)
        _end_with_parent()
        signal.alarm(math.ceil(20.0 + 8.0 * limits(size)[0]))
        data = pickle.dumps(_answer(function, path, arguments, size))
        with os.fdopen(writing, "wb") as stream:
            stream.write(data)
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as stream:
        data = stream.read()
    code = os.waitstatus_to_exitcode(os.waitpid(copy, 0)[1])
    if code:
        return "died", code
    answer: tuple[str, Any] = pickle.loads(data)
    return answer


def _end_with_parent() -> None:
    """Where the system can: end when the process ends that this one is a copy of."""
    with suppress(OSError, AttributeError, TypeError):
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


def _answer(
    function: Callable[..., Any], path: Path, arguments: tuple[Any, ...], size: int
) -> tuple[str, Any]:
    free = limit_process(*limits(size))
    try:
        return "value", _sheltered(function, path, arguments)
    except _MemoryError:
        free()
        return "memory", InputError(_too_much(size), file=str(path))
    except DdgError as error:
        return "error", error
    finally:
        free()


class _MemoryError(Exception):
    """The memory did not suffice."""


def _sheltered(function: Callable[..., _T], path: Path, arguments: tuple[Any, ...]) -> _T:
    """A call in which whatever the kernel raises becomes an InputError."""
    try:
        return function(path, *arguments)
    except DdgError:
        raise
    except MemoryError:
        raise _MemoryError from None
    except Exception as error:
        if "memory" in type(error).__name__.lower() or "bad_alloc" in str(error):
            raise _MemoryError from None
        what = f"{type(error).__name__}: {clipped(error, 200)}".rstrip(": ")
        raise InputError(f"the CAD kernel cannot use it ({what})", file=str(path)) from None


def _timed(function: Callable[..., _T], path: Path, arguments: tuple[Any, ...], size: int) -> _T:
    """A call in an expendable process, which ends when it takes too long (by the clock)."""
    timer = hasattr(signal, "setitimer") and (threading.current_thread() is threading.main_thread())
    if timer:
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, 60.0 + 10.0 * limits(size)[0])
    try:
        return _sheltered(function, path, arguments)
    except _MemoryError:
        raise InputError("there is too little memory to read it", file=str(path)) from None
    finally:
        if timer:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
