"""The output folder: built in a hidden working folder, then put in its place whole."""

from __future__ import annotations

import errno
import hashlib
import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any, Final

from ddgfab.errors import InputError, OutputError, clipped
from ddgfab.io.atomic import will_be_placed
from fabrication.job.exchange import holds_mounts, sync_file_system
from fabrication.job.lock import FolderLock
from fabrication.job.manifest import MANIFEST, faults, made_from, read_manifest
from fabrication.job.names import windows_fault
from fabrication.job.others import WORK
from fabrication.job.place import NEW, discard, put_in_place, recover
from fabrication.job.sources import Sources, source_of

_LONGEST: Final = 200
"""Bytes of a target's name that its working folder can be named by."""


class OtherProjectError(OutputError):
    """A folder that holds the result of another project.

    Attributes
    ----------
    summary : the message without what to do about it
    """

    def __init__(self, summary: str) -> None:
        super().__init__(
            f"{summary}\nChoose another folder, or replace that result: force=True, --force"
        )
        self.summary = summary


class OutputFolder:
    """A folder that appears complete or not at all; a context manager.

    The block gets the path of the folder to write to, the manifest last. When the block ends well
    the folder takes its place. A result of ours that was there is replaced; what is not ours in it,
    and files of ours that were edited since, stay. When the block raises, interrupts included, an
    old folder stays as it was. A job that was killed meanwhile is put right by the next.

    Parameters
    ----------
    project : its name; a result of another one is refused
    sources : the files that it is made from; a result made from others is refused too
    force : replace the result of another project

    Attributes
    ----------
    notes : what people must know of files that were kept, and of jobs that were put right

    Raises
    ------
    OtherProjectError
        On entering: the target holds the result of another project.
    OutputError
        On entering: the target is a file, or a folder that is not ours and not empty, or cannot be
        written, or another job is writing it. On leaving: the disk is full, files that the
        manifest lists are missing, or the system refuses.
    """

    def __init__(
        self,
        target: Path | str,
        *,
        project: str | None = None,
        sources: Sources | None = None,
        force: bool = False,
    ) -> None:
        if str(target) == "":
            raise OutputError("-o is empty; name a folder, or leave it out")
        self.target: Final = _resolved(Path(target))
        if not self.target.name:
            raise OutputError(f"{self.target}: no job can take this place; choose a folder with -o")
        self.project, self.sources, self.force = project, sources, force
        self.notes: list[str] = []

    @property
    def work(self) -> Path:
        """The working folder: beside the target, or inside one that cannot be renamed."""
        inside = self.target / WORK
        if inside.is_dir() or (self.target.is_dir() and _is_fixed(self.target)):
            return inside
        return self._beside

    @property
    def _beside(self) -> Path:
        name = self.target.name
        if len(os.fsencode(name)) > _LONGEST:
            name = hashlib.sha256(os.fsencode(name)).hexdigest()[:16]
        return self.target.with_name(f".{name}{WORK}")

    def check(self) -> None:
        """Raise OutputError where entering would, as far as can be found without writing."""
        if os.name == "nt" and (why := windows_fault(os.fspath(self.target))):
            raise OutputError(f"{self.target}: {why}; choose another folder with -o")
        try:
            self._require_usable()
            above = next(
                folder for folder in (self.target, *self.target.parents) if folder.exists()
            )
        except OSError as error:
            raise explain(error, self.target) from error
        if not above.is_dir():
            raise OutputError(f"{above}: is a file; choose another folder with -o")
        writes = self.work.parent if above == self.target else above
        if not all(os.access(folder, os.W_OK | os.X_OK) for folder in (above, writes)):
            raise explain(PermissionError(errno.EACCES, "no permission"), self.target)

    def prepare(self) -> None:
        """The same before a long job, when what a killed job left has been put right."""
        if self.work.is_dir() or self._beside.is_dir():
            self._lock().release()
        self.check()

    def __enter__(self) -> Path:
        self.check()
        try:
            self.target.parent.mkdir(parents=True, exist_ok=True)
            self._held = self._lock()
            try:
                self._require_usable()
                self.path = self._held.folder / f"{NEW}{self._held.token}"
                self.path.mkdir()
            except BaseException:
                self._held.release()
                raise
        except OSError as error:
            raise explain(error, self.target) from error
        return self.path

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        done = False
        try:
            with _interrupts_later():
                try:
                    if error is None:
                        self._commit()
                        done = True
                    elif isinstance(error, OSError):
                        raise explain(error, self.target) from error
                    elif isinstance(error, OutputError) and os.fspath(self.path) in str(error):
                        raise _in_target(error, self.path, self.target) from error
                finally:
                    discard(self.path)
                    self._held.release()
        except KeyboardInterrupt:
            if not done:
                raise
            raise KeyboardInterrupt(f"the files are complete in {self.target}") from None

    def _lock(self) -> FolderLock:
        """The lock, with what a killed job left put right."""
        lock = FolderLock(self.work, self.target)
        try:
            lock.acquire()
            try:
                with _interrupts_later():
                    self.notes += recover(self.target, lock.folder)
                    if lock.folder != self._beside and self._beside.is_dir():
                        self._recover_beside()
            except BaseException:
                lock.release()
                raise
        except OSError as error:
            raise explain(error, self.target) from error
        return lock

    def _recover_beside(self) -> None:
        """The same in the other working folder, where the target was found fixed at the end."""
        lock = FolderLock(self._beside, self.target, both=False)
        lock.acquire()
        try:
            self.notes += recover(self.target, lock.folder)
        finally:
            lock.release()

    def _commit(self) -> None:
        """Put the staged folder in its place."""
        if not (self.path / MANIFEST).is_file():
            raise OutputError(f"{self.target}: not written, as the job left no {MANIFEST}")
        if not self._held.held():
            raise OutputError(
                f"{self.target}: not written, as another job took the folder over meanwhile\n"
                "Run again, with another folder (-o) where the other job is still at work."
            )
        if found := faults(self.path):
            raise OutputError(f"{self.target}: not written, as files got lost: {found}")
        self._require_usable()  # it may have changed while the job ran
        try:
            sync_file_system(self.path)
            will_be_placed(self.target / MANIFEST, self.path / MANIFEST)
            self.notes += put_in_place(self.path, self.target, self._held.folder)
        except OSError as error:
            raise explain(error, self.target) from error

    def _require_usable(self) -> None:
        """Raise unless the target may be replaced: absent, empty, or a result of the project."""
        target = self.target
        if not target.exists() and not target.is_symlink():
            return
        if target.is_symlink():  # resolved already: it leads nowhere
            raise OutputError(
                f"{target}: its symbolic links lead in a circle; choose another folder with -o"
            )
        if not target.is_dir():
            raise OutputError(f"{target}: is a file; choose another folder with -o")
        with suppress(InputError):
            held = read_manifest(target / MANIFEST).get("project")
            if not self.force:
                self._require_same(held)
            return
        if any(path.name != WORK for path in target.iterdir()):
            raise OutputError(
                f"{target}: exists and is not an output folder of ddgfab (no {MANIFEST} of it)\n"
                "Choose another folder with -o, or remove it yourself. Nothing was written."
            )

    def _require_same(self, held: object) -> None:
        """Raise unless the result that is there is one of this project."""
        target = self.target
        if self.project is not None and held != self.project:
            raise OtherProjectError(
                f"{target}: holds the result of project {clipped(held)}; this is "
                f"{clipped(self.project)}. Nothing was written."
            )
        record = made_from(target)
        if self.sources is None or record is None or self.sources.match(record, target):
            return
        raise OtherProjectError(
            f"{target}: holds the result of another project {clipped(held)}, made from "
            f"{source_of(record, target)}; this is made from {self.sources}. Nothing was written.\n"
            "Give this one a name of its own ([project] name, --set project.name=...)."
        )


def _resolved(target: Path) -> Path:
    """Where a folder is.

    Raises
    ------
    OutputError
        It is nowhere: links that lead in a circle, or characters that no name has.
    """
    try:
        return target.resolve()
    except RuntimeError:
        why = "its symbolic links lead in a circle"
    except (OSError, ValueError) as error:
        why = f"no such place ({getattr(error, 'strerror', None) or error})"
    raise OutputError(f"{clipped(target)}: {why}; choose another folder with -o")


def explain(error: OSError, path: Path) -> OutputError:
    """The one clear message for a file system that refused."""
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        why = "the disk is full; free some space or choose another folder with -o"
    elif error.errno in (errno.EACCES, errno.EPERM, errno.EROFS):
        why = "no permission to write there; choose another folder with -o"
    else:
        why = f"cannot be written ({error.strerror or error})"
    return OutputError(f"{path}: {why}\nNothing was written.")


def _in_target(error: OutputError, staged: Path, target: Path) -> OutputError:
    """An error about a file, which people will look for in the target and not where it is made."""
    message = str(error).replace(os.fspath(staged), os.fspath(target))
    return OutputError(
        message if "othing was written" in message else f"{message}\nNothing was written."
    )


def _is_fixed(target: Path) -> bool:
    """Whether a folder cannot change its name, or should not: where somebody stands in it."""
    if holds_mounts(target) or not os.access(target.parent, os.W_OK | os.X_OK):
        return True
    with suppress(OSError):
        return Path.cwd().is_relative_to(target)
    return False


@contextmanager
def _interrupts_later() -> Iterator[None]:
    """Ctrl-C, SIGTERM and SIGHUP wait for the end of the block, which is short (main thread)."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []

    def later(number: int, frame: FrameType | None) -> None:
        came.append(number)

    before: dict[int, Any] = {}
    ending = ("SIGINT", "SIGTERM", "SIGHUP")
    for number in (getattr(signal, name) for name in ending if hasattr(signal, name)):
        if signal.getsignal(number) not in (
            None,
            signal.SIG_IGN,
        ):  # else one that Python did not set
            before[number] = signal.signal(number, later)
    try:
        yield
    finally:
        for changed, handler in before.items():
            signal.signal(changed, handler)
    if came:
        signal.raise_signal(came[0])
