"""Pictures are drawn in a process of its own: a renderer without memory ends that one, not this.

VTK and the graphics libraries below it end the process where they find no memory. One process loads
them, which takes a second, and stays for further pictures. Processes that a job keeps for its parts
draw for themselves (`processes.expendable`).
"""

from __future__ import annotations

import atexit
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any, BinaryIO, Final, TypeVar

from ddgfab.errors import OutputError, clipped
from fabrication.processes import is_expendable

ADVICE: Final = "; on Linux without a display VTK needs libEGL or libOSMesa (apt install libegl1)"

SECONDS: Final = 1800
"""A picture may take so long, by the clock."""

_T = TypeVar("_T")
_LOCK: Final = threading.Lock()


def drawn(function: Callable[..., _T], *arguments: Any) -> _T:
    """What `function(pyvista, *arguments)` gives in the process that draws.

    Parameters
    ----------
    function : of a module, as it is sent by name

    Raises
    ------
    OutputError
        This machine cannot render: names the packages to install; or the process ended, for lack
        of memory.
    """
    if is_expendable():
        return _answer(function, arguments)
    with _LOCK:
        try:
            kind, value = _child().ask((function, arguments))
        except BaseException:
            _drop()
            raise
    if kind == "error":
        raise value
    result: _T = value
    return result


def _answer(function: Callable[..., _T], arguments: tuple[Any, ...]) -> _T:
    try:
        import pyvista

        with pyvista.vtk_verbosity("off"):  # it complains of a missing X server, does without
            return function(pyvista, *arguments)
    except ImportError as error:
        raise OutputError(f"rendering needs pyvista: pip install pyvista ({error})") from error
    except MemoryError as error:
        raise OutputError("there is too little memory to draw") from error
    except (RuntimeError, OSError, AttributeError) as error:
        raise OutputError(f"this machine cannot render ({error}){ADVICE}") from error


# --- this side ----------------------------------------------------------------------------------
class _Child:
    """The process that draws."""

    def __init__(self) -> None:
        self.owner = os.getpid()
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join(entry or os.getcwd() for entry in sys.path),  # noqa: PTH109
        }
        try:
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-c", f"from {__name__} import serve; serve()"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=environment,
            )
        except OSError as error:
            raise OutputError(f"the process that draws cannot start: {error.strerror}") from error

    @property
    def alive(self) -> bool:
        return self.owner == os.getpid() and self.process.poll() is None

    def ask(self, question: Any) -> tuple[str, Any]:
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        try:
            with suppress(BrokenPipeError):  # it died: there is no answer then
                pickle.dump(question, self.process.stdin)
                self.process.stdin.flush()
            answer: tuple[str, Any] = pickle.load(self.process.stdout)
        except (EOFError, pickle.UnpicklingError):
            code = self.process.wait()
            name = signal.Signals(-code).name if code < 0 else f"exit code {code}"
            raise OutputError(
                f"the process that draws ended ({name}), probably for lack of memory"
            ) from None
        return answer

    def end(self) -> None:
        if self.owner != os.getpid():
            return
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            with suppress(OSError):
                if stream is not None:
                    stream.close()


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


# --- the other side -----------------------------------------------------------------------------
def serve() -> None:
    """Draw what is asked for on standard input until it ends."""
    for name in ("SIGINT", "SIGHUP"):  # of a terminal; the process that asks is stopped by them
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what libraries print
    questions: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(sys.stdin.buffer, questions), daemon=True).start()
    while True:
        function, arguments = questions.get()
        if hasattr(signal, "alarm"):
            signal.alarm(SECONDS)
        try:
            answer: tuple[str, Any] = ("value", _answer(function, arguments))
        except OutputError as error:
            answer = ("error", error)
        except Exception as error:
            why = f"{type(error).__name__}: {clipped(error, 300)}"
            answer = ("error", OutputError(f"the picture cannot be drawn ({why})"))
        if hasattr(signal, "alarm"):
            signal.alarm(0)
        answers.write(pickle.dumps(answer))
        answers.flush()


def _listen(stream: BinaryIO, questions: queue.SimpleQueue[Any]) -> None:
    """Put every question into the queue; at the end of them this process ends, also as it draws."""
    try:
        while True:
            questions.put(pickle.load(stream))
    except BaseException:  # the end, half a question, or no memory for it
        os._exit(1)
