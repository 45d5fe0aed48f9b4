"""Signals that end the program, at any time: what came, and whether it has been told."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, Final

_ENDING: Final = ("SIGINT", "SIGTERM", "SIGHUP")


class StoppedError(KeyboardInterrupt):
    """A signal ends the program.

    Python ends by SIGINT, whatever code is asked for, once a `KeyboardInterrupt` itself has left
    a text that `exec` runs, as dataclasses do while modules are loaded; not so a subclass.
    """


class _Stops:
    """The signal that came, if any.

    Attributes
    ----------
    number : the signal's number, or None
    told : whether the message about it was printed
    """

    def __init__(self) -> None:
        self.number: int | None = None
        self.told = False

    @property
    def code(self) -> int:
        """The exit code: 128 and the signal's number."""
        return 128 + (self.number or int(signal.SIGINT))


STOPS: Final = _Stops()
"""Of this run of the program."""


@contextmanager
def stopping() -> Iterator[None]:
    """Signals raise `StoppedError` (main thread), but for those that are ignored, as by nohup."""
    STOPS.number, STOPS.told = None, False
    before: dict[int, Any] = {}
    try:
        if threading.current_thread() is threading.main_thread():
            for name in _ENDING:
                number = getattr(signal, name, None)  # Windows has no SIGHUP
                if number is not None and signal.getsignal(number) not in (None, signal.SIG_IGN):
                    before[number] = signal.signal(number, _stop)
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def hidden_stops() -> Iterator[None]:
    """Errors after a signal are its own: libraries make others of it as they are loaded."""
    try:
        yield
    except Exception as error:
        if STOPS.number is None:
            raise
        raise StoppedError from error


def _stop(number: int, frame: FrameType | None) -> None:
    STOPS.number = number
    raise StoppedError
