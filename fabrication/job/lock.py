"""One job at a time in an output folder: on one machine, in containers, on a shared drive.

The system's advisory lock decides between processes of one kernel. Where it reaches no further
than one machine, the content of the lock file does: machine, boot, and a sign of life that the
owner gives every few seconds. Process ids decide nothing: another container or host counts its own.
"""

from __future__ import annotations

import errno
import json
import os
import platform
import secrets
import threading
import time
import uuid
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from ddgfab.errors import OutputError

BEAT: Final = 15.0
"""Seconds between two signs of life."""

DEAD: Final = 300.0
"""A lock of another machine, or another boot, without a sign of life for so long [s] is void."""

LOCK: Final = "lock"
"""Name of the file."""

_TRIES: Final = 20
_NO_LOCKS: Final = (errno.ENOSYS, errno.ENOTSUP, errno.ENOLCK, errno.EINVAL, errno.EBADF)


class FolderLock:
    """The lock of a working folder, in which it is the file `lock`.

    Parameters
    ----------
    folder : made when it is locked, removed when it is released and empty
    target : the output folder, for messages
    both : lock the target too, where the system locks folders
    """

    def __init__(self, folder: Path, target: Path, *, both: bool = True) -> None:
        self.folder, self.target, self.both = folder, target, both
        self.file = folder / LOCK
        self.token = secrets.token_hex(8)
        self._own: int | None = None
        self._other: int | None = None
        self._ended = threading.Event()

    def acquire(self) -> None:
        """Take the lock.

        Raises
        ------
        OutputError
            Another job has it; names its process, machine and time.
        OSError
            The folder cannot be made or written.
        """
        self._other = self._lock_target() if self.both else None
        try:
            for _ in range(_TRIES):
                if self._try():
                    threading.Thread(target=self._beat, daemon=True).start()
                    return
        except BaseException:
            self._close()
            raise
        self._close()
        raise OutputError(f"{self.target}: cannot be locked; try again, or choose another with -o")

    def held(self) -> bool:
        """Whether the lock is still this one's."""
        if self._own is None:
            return False
        with suppress(OSError):
            return _same(self._own, self.file) and _content(self._own).get("token") == self.token
        return False

    def release(self) -> None:
        """Let it go."""
        self._ended.set()
        held = self.held()
        if os.name == "nt":
            self._close()
        if held:
            with suppress(OSError):
                self.file.unlink()
        self._close()
        with suppress(OSError):
            self.folder.rmdir()

    def _lock_target(self) -> int | None:
        """The descriptor of the target, locked: another job may work inside it, as on a mount."""
        try:
            descriptor = os.open(self.target, os.O_RDONLY)
        except OSError:
            return None
        if _advisory(descriptor) is False:
            os.close(descriptor)
            raise OutputError(self._busy({}))
        return descriptor

    def _try(self) -> bool:
        """One attempt; False where the file went while it was opened."""
        self.folder.mkdir(exist_ok=True)
        try:
            descriptor = os.open(self.file, os.O_RDWR | os.O_CREAT, 0o666)
        except FileNotFoundError:
            return False
        try:
            locked = _advisory(descriptor)
            if locked is not False and not _same(descriptor, self.file):
                os.close(descriptor)
                return False
            owner = _content(descriptor)
            if locked is False or (owner and self._lives(owner, descriptor, bool(locked))):
                raise OutputError(self._busy(owner))
            text = json.dumps(
                {
                    "token": self.token,
                    "host": platform.node(),
                    "boot": boot(),
                    "process": os.getpid(),
                    "since": time.strftime("%Y-%m-%d %H:%M:%S"),
                }
            )
            os.ftruncate(descriptor, 0)
            os.lseek(descriptor, 0, os.SEEK_SET)
            os.write(descriptor, text.encode())
            os.fsync(descriptor)
            if locked is None:  # nobody decides between two who came at once, but the last word
                time.sleep(0.2)
                if _content(descriptor).get("token") != self.token:
                    raise OutputError(self._busy(_content(descriptor)))
        except BaseException:
            with suppress(OSError):
                os.close(descriptor)
            raise
        self._own = descriptor
        return True

    def _lives(self, owner: dict[str, Any], descriptor: int, locked: bool) -> bool:
        """Whether the owner named in the file may be at work, though its lock is free."""
        if locked and owner.get("boot") == boot():
            return False  # one kernel knows its locks
        clock = self.folder / f"clock-{self.token}"  # the clock of the file's machine, not of ours
        clock.touch()
        now = clock.stat().st_mtime
        clock.unlink()
        return now - os.fstat(descriptor).st_mtime < DEAD

    def _busy(self, owner: dict[str, Any]) -> str:
        who = f"process {owner['process']} on {owner.get('host')}, " if "process" in owner else ""
        since = f"since {owner['since']}" if "since" in owner else "now"
        return (
            f"{self.target}: another job is writing it ({who}{since})\n"
            "Wait for it, or choose another folder with -o. Nothing was written."
        )

    def _beat(self) -> None:
        while not self._ended.wait(BEAT):
            with suppress(OSError):
                if self._own is not None:
                    os.utime(self._own if os.utime in os.supports_fd else self.file)

    def _close(self) -> None:
        for descriptor in (self._own, self._other):
            if descriptor is not None:
                with suppress(OSError):
                    os.close(descriptor)
        self._own = self._other = None


def boot() -> str:
    """What is the same for all processes of one running kernel, containers included."""
    with suppress(OSError):
        return Path("/proc/sys/kernel/random/boot_id").read_text("ascii").strip()
    return f"{platform.node()}-{uuid.getnode():x}"


def _advisory(descriptor: int) -> bool | None:
    """Whether the system's lock was free, and is ours now; None where there are no such locks."""
    try:
        import fcntl
    except ImportError:
        return _windows(descriptor)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno in _NO_LOCKS:
            return None
        if error.errno in (errno.EAGAIN, errno.EACCES):
            return False
        raise
    return True


def _windows(descriptor: int) -> bool | None:
    import msvcrt

    module: Any = msvcrt
    try:
        os.lseek(descriptor, 1 << 30, os.SEEK_SET)  # a byte that nobody reads
        module.locking(descriptor, module.LK_NBLCK, 1)
    except OSError:
        return False
    return True


def _same(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat())
    except FileNotFoundError:
        return False


def _content(descriptor: int) -> dict[str, Any]:
    """What a lock file says; empty where it says nothing that can be read."""
    try:
        os.lseek(descriptor, 0, os.SEEK_SET)
        content = json.loads(os.read(descriptor, 4096))
    except ValueError:
        return {}
    return content if isinstance(content, dict) else {}
