"""Limits on the time and memory of a process, where the system has them."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path


def limit_process(seconds: float, memory: int) -> Callable[[], None]:
    """Limit what this process may use from now on; returns what takes the limits away.

    Parameters
    ----------
    seconds : of computing
    memory : bytes of address space, beside what it has
    """
    try:
        import resource
    except ImportError:
        return lambda: None
    used = resource.getrusage(resource.RUSAGE_SELF)
    until = math.ceil(used.ru_utime + used.ru_stime + seconds)
    _, hard_time = resource.getrlimit(resource.RLIMIT_CPU)
    _, hard_memory = resource.getrlimit(resource.RLIMIT_AS)
    taken = _address_space()
    with suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_CPU, (_least(until, hard_time), hard_time))
    with suppress(ValueError, OSError):
        if taken:
            most = _least(taken + memory, hard_memory)
            resource.setrlimit(resource.RLIMIT_AS, (most, hard_memory))

    def free() -> None:
        with suppress(ValueError, OSError):
            resource.setrlimit(resource.RLIMIT_AS, (hard_memory, hard_memory))
            resource.setrlimit(resource.RLIMIT_CPU, (hard_time, hard_time))

    return free


def _least(wanted: int, hard: int) -> int:
    return wanted if hard < 0 else min(wanted, hard)  # a negative one is none


def _address_space() -> int:
    """Bytes of address space that this process has; 0 where the system does not say."""
    with suppress(OSError, ValueError):
        pages = int(Path("/proc/self/statm").read_text("ascii").split()[0])
        return pages * os.sysconf("SC_PAGE_SIZE")
    return 0
