"""Where the program starts: the command line, or what is missing for it."""

from __future__ import annotations

import os
import signal
import sys

from fabrication.processes import TOO_LITTLE, too_little

LEAST_MB = 512
"""Address space [MB] without which numpy and scipy cannot be loaded, and more than they take."""

THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""Threads of the libraries behind numpy: one unless the user says otherwise.

Matrices are small here: beside other work the threads wait for each other, and a step of `optimize`
takes ten times as long. Parallel work is in processes. With one thread the results are the same
whatever the number of cores.
"""

BAD_INPUT = 2
"""Exit code, as in `fabrication.cli.terminal`."""


def main() -> None:
    """Run the console script `ddgfab`, also where only the geometry is installed."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # no traceback while modules are loaded
    _open_closed_streams()
    _require_memory()
    for name in THREADS:
        os.environ.setdefault(name, "1")  # read when numpy is loaded
    try:
        from fabrication.cli import main as run

        run()
    except ModuleNotFoundError as error:
        package = str(error.name).partition(".")[0]
        if package in ("ddgfab", "fabrication"):
            raise
        sys.stderr.write(
            f"error: the command line needs {package}, which is not installed: "
            "pip install ddgfab with its dependencies\n"
        )
        raise SystemExit(BAD_INPUT) from None
    except Exception as error:
        if not too_little(error):
            raise
        sys.stderr.write(f"error: {TOO_LITTLE}\n")
        raise SystemExit(BAD_INPUT) from None


def _require_memory() -> None:
    """End where less memory is allowed than libraries of numbers need: they crash or hang then."""
    try:
        import resource
    except ImportError:  # a system without such limits
        return
    allowed, _ = resource.getrlimit(resource.RLIMIT_AS)
    if 0 <= allowed < LEAST_MB << 20:
        sys.stderr.write(
            f"error: {allowed >> 20} MB of address space are allowed (ulimit -v); at least "
            f"{LEAST_MB} are needed\n"
        )
        raise SystemExit(BAD_INPUT)


def _open_closed_streams() -> None:
    """Standard streams that were closed (`>&-`) lead nowhere: else files would take their numbers.

    What a library prints to number 1 would then stand in the first file that is written.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the least number that is free: this one
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode))  # noqa: PTH123, SIM115 - to the end
