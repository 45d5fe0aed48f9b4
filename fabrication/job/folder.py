"""The output folder: built beside its place under a hidden name, then swapped in whole."""

from __future__ import annotations

import errno
import glob
import os
import re
import shutil
import unicodedata
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Final

from ddgfab.errors import InputError, OutputError
from fabrication.job.manifest import MANIFEST, read_manifest

_RESERVED: Final = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
_LONGEST: Final = 100


def safe_name(text: str) -> str:
    """A name for a file or folder: letters, digits and - _ . only, never hidden, never a path.

    >>> safe_name("Dach über Hof/2")
    'Dach-uber-Hof-2'
    """
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    name = re.sub(r"[^A-Za-z0-9._-]+", "-", plain)[:_LONGEST].lstrip(".-").rstrip(".-")
    if not name:
        return "unnamed"
    return f"_{name}" if _RESERVED.fullmatch(name) else name


class OutputFolder:
    """A folder that appears complete or not at all; a context manager.

    The block gets the path of the folder to write to, the manifest last. When the block ends well
    the folder takes its place; a folder of ours that was there is replaced, and files in it that
    its manifest does not list (somebody else's) are carried over. When the block raises,
    interrupts included, nothing remains and an old folder stays as it was.

    Raises
    ------
    OutputError
        On entering: the target is a file, or a folder that is not ours and not empty, or its
        parent cannot be written. On leaving: the disk is full or the swap is refused.
    """

    def __init__(self, target: Path | str) -> None:
        self.target: Final = Path(target).resolve()
        if not self.target.name:
            raise OutputError(f"{self.target}: no job can take this place; choose a folder with -o")
        self.path: Final = self.target.with_name(f".{self.target.name}.partial-{os.getpid()}")
        self._aside: Final = self.target.with_name(f".{self.target.name}.old-{os.getpid()}")

    def check(self) -> None:
        """Raise OutputError where entering would, as far as can be told without writing."""
        _require_ours(self.target)
        above = next(folder for folder in self.target.parents if folder.exists())
        if not above.is_dir():
            raise OutputError(f"{above}: is a file; choose another folder with -o")
        if not os.access(above, os.W_OK | os.X_OK):
            raise explain(PermissionError(errno.EACCES, "no permission"), self.target)

    def __enter__(self) -> Path:
        _require_ours(self.target)
        try:
            self.target.parent.mkdir(parents=True, exist_ok=True)
            _clear_orphans(self.target)
            self.path.mkdir()
        except OSError as error:
            raise explain(error, self.target) from error
        return self.path

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            if error is None:
                self._commit()
            elif isinstance(error, OSError):
                raise explain(error, self.target) from error
        finally:
            shutil.rmtree(self.path, ignore_errors=True)

    def _commit(self) -> None:
        """Put the staged folder in its place."""
        if not (self.path / MANIFEST).is_file():
            raise OutputError(f"{self.target}: not written, as the job left no {MANIFEST}")
        _require_ours(self.target)  # it may have changed while the job ran
        try:
            _sync(self.path)
            if not self.target.exists():
                self.path.rename(self.target)
                return
            _carry_over(self.target, self.path)
            shutil.rmtree(self._aside, ignore_errors=True)
            try:
                self.target.rename(self._aside)
                self.path.rename(self.target)
            except BaseException:
                if not self.target.exists():
                    self._aside.rename(self.target)
                raise
        except OSError as error:
            raise explain(error, self.target) from error
        shutil.rmtree(self._aside, ignore_errors=True)


def explain(error: OSError, path: Path) -> OutputError:
    """The one clear message for a file system that refused."""
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        why = "the disk is full; free some space or choose another folder with -o"
    elif error.errno in (errno.EACCES, errno.EPERM, errno.EROFS):
        why = "no permission to write there; choose another folder with -o"
    else:
        why = f"cannot be written ({error.strerror or error})"
    return OutputError(f"{path}: {why}\nNothing was written.")


def _clear_orphans(target: Path) -> None:
    """Remove what killed jobs left beside a target: staging folders whose process is gone."""
    if os.name != "posix":  # asking whether a process lives would end it elsewhere
        return
    for path in target.parent.glob(f".{glob.escape(target.name)}.partial-*"):
        owner = path.name.rpartition("-")[2]
        if not owner.isdigit():
            continue
        try:
            if int(owner) != os.getpid():
                os.kill(int(owner), 0)
                continue
        except ProcessLookupError:
            pass
        except OSError:
            continue
        shutil.rmtree(path, ignore_errors=True)


def _sync(folder: Path) -> None:
    """Every file on the disk, so that the folder's new name never stands for half a job.

    One call to the system where it has one: thousands of single files cost seconds.
    """
    if hasattr(os, "sync"):
        os.sync()
        return
    for path in folder.rglob("*"):
        if path.is_file():
            with path.open("rb+") as stream:
                os.fsync(stream.fileno())


def _require_ours(target: Path) -> None:
    """Raise unless the target may be replaced: absent, an empty folder, or one of ours."""
    if not target.exists() and not target.is_symlink():
        return
    if not target.is_dir():
        raise OutputError(f"{target}: is a file; choose another folder with -o")
    with suppress(InputError):
        read_manifest(target / MANIFEST)
        return
    try:
        empty = not any(target.iterdir())
    except OSError as error:
        raise explain(error, target) from error
    if not empty:
        raise OutputError(
            f"{target}: exists and is not an output folder of ddgfab (no {MANIFEST} of it)\n"
            "Choose another folder with -o, or remove it yourself. Nothing was written."
        )


def _carry_over(old: Path, new: Path) -> None:
    """Copy files of the old folder that its manifest does not list, where the new has none."""
    if not (old / MANIFEST).is_file():
        return
    ours = {record["path"] for record in read_manifest(old / MANIFEST).get("files", ())}
    for path in old.rglob("*"):
        name = path.relative_to(old).as_posix()
        copy = new / name
        if path.is_file() and name not in ours and name != MANIFEST and not copy.exists():
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(path, copy)
