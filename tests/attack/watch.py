"""One call after the other under watch: what it ends with, how long, in how much memory.

In the process itself, as a process for each of half a million files would be most of the work. A
call that computes for more than `SECONDS` is interrupted; one that hangs in a library and cannot
be interrupted ends the process after `DEAF` seconds, with the place on standard error. Memory is
limited for the whole process, so that too much of it is a `MemoryError` of the call.
"""

from __future__ import annotations

import argparse
import faulthandler
import os
import signal
import time
import warnings
from collections import Counter
from collections.abc import Callable
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ddgfab.errors import DdgError

SECONDS, MEMORY = 5.0, 1 << 30
"""What a call may take: seconds of computing, bytes beside what the process has."""

DEAF = 600.0
"""Seconds by the clock until a process that does not hear its alarm is ended."""

BAD = ("FOREIGN", "SLOW", "WRONG")
"""How outcomes begin that may not happen."""


class TooLongError(BaseException):
    """The limit on computing is reached; nothing but the watch catches it."""


class Watch:
    """Counts how calls end.

    Attributes
    ----------
    outcomes : how often by kind; those that begin with one of `BAD` may not happen
    slowest : seconds of computing of the slowest call, and its name
    """

    def __init__(self) -> None:
        self.outcomes: Counter[str] = Counter()
        self.slowest = (0.0, "none")
        self.calls = 0
        self._renew = 0.0

    def call(self, name: object, function: Callable[[], Any], seconds: float = SECONDS) -> Any:
        """What a function gives; None where it raised. `name` tells a bad case: a seed."""
        if time.monotonic() > self._renew:
            faulthandler.dump_traceback_later(DEAF, exit=True)
            self._renew = time.monotonic() + DEAF / 20
        self.calls += 1
        begin = time.process_time()
        result = None
        try:
            signal.setitimer(signal.ITIMER_PROF, seconds)
            try:
                result = function()
            finally:
                signal.setitimer(signal.ITIMER_PROF, 0.0)
            kind = "passed"
        except DdgError as error:
            kind = "refused" if said_well(str(error)) else f"WRONG message at {name}: {error!r}"
        except TooLongError:
            kind = f"SLOW: more than {seconds} s at {name}"
        except KeyboardInterrupt:
            raise
        except AssertionError as error:
            kind = f"WRONG {error} at {name}"
        except BaseException as error:
            kind = f"FOREIGN {type(error).__name__} at {name}: {str(error)[:200]}"
        self.outcomes[kind] += 1
        taken = time.process_time() - begin
        if taken > self.slowest[0]:
            self.slowest = (taken, str(name))
        return result

    @property
    def bad(self) -> list[str]:
        """What may not happen, and did."""
        return [kind for kind in self.outcomes if kind.startswith(BAD)]

    def __str__(self) -> str:
        taken, name = self.slowest
        kinds = {kind: self.outcomes[kind] for kind in sorted(self.outcomes)}
        return f"{self.calls} calls: {kinds}; the slowest {taken:.2f} s ({name})"


def said_well(message: str) -> bool:
    """Whether a message is one: not empty, printable, of a few lines."""
    lines = message.split("\n")
    return bool(message) and len(lines) <= 8 and all(line.isprintable() for line in lines)


@contextmanager
def limited(memory: int = MEMORY) -> Any:
    """The limits of this process on memory [bytes], and the alarm of its calls."""
    import resource

    def alarm(number: int, frame: object) -> None:
        raise TooLongError

    before = signal.signal(signal.SIGPROF, alarm)
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (pages * os.sysconf("SC_PAGE_SIZE") + memory, hard))
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
        with suppress(TypeError):
            signal.signal(signal.SIGPROF, before)


def run(
    attack: Callable[[Watch, int, Path], None],
    description: str | None,
    count: int,
    folder: Path,
    *,
    memory: int = MEMORY,
) -> int:
    """The program of an attack: seeds from --begin on, --count of them; 1 where it broke something.

    Parameters
    ----------
    attack : called as (watch, seed, folder)
    count : how many, unless --count says so
    memory : of the process [bytes], beside what it has
    """
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--count", type=int, default=count)
    parser.add_argument("--begin", type=int, default=0, help="first seed")
    parser.add_argument("--show", type=int, default=2000, help="print after so many")
    given = parser.parse_args()
    watch, told = Watch(), set[str]()
    warnings.simplefilter("error")  # what numpy says of an overflow is no message for people
    with limited(memory):
        for number, seed in enumerate(range(given.begin, given.begin + given.count), 1):
            attack(watch, seed, folder)
            if number % given.show == 0 or number == given.count:
                shown = {k: n for k, n in watch.outcomes.items() if not k.startswith(BAD)}
                taken, name = watch.slowest
                print(
                    f"{number} cases, {watch.calls} calls: {shown}, {len(watch.bad)} bad kinds; "
                    f"slowest {taken:.2f} s ({name})",
                    flush=True,
                )
                for kind in sorted(set(watch.bad) - told):
                    print(kind, flush=True)
                told.update(watch.bad)
    return 1 if watch.bad else 0
