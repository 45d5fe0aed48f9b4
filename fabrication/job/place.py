"""A finished folder takes its place, whatever happens meanwhile; what was broken off is put right.

Beside the target stands a hidden working folder: the lock, `new-...` in which a job writes,
`old-...` a result that was in the target's place, `gone-...` what is to be deleted. A result with
its manifest is complete, or it is damaged and `faults` says so. A target that cannot be renamed (a
mount point, the current folder) has its working folder inside; files then move one by one, by a
journal that is written before the first and removed after the last.
"""

from __future__ import annotations

import errno
import json
import os
import shutil
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import Final

from ddgfab.errors import InputError, OutputError
from ddgfab.io.atomic import atomic_write
from fabrication.job.exchange import exchange, sync_file_system
from fabrication.job.lock import LOCK
from fabrication.job.manifest import MANIFEST, UNLISTED, faults, listed, read_manifest
from fabrication.job.others import WORK, Others, carry, free_name, link, note_of

JOURNAL: Final = "journal.json"
NEW, OLD, GONE = "new-", "old-", "gone-"

_FIXED: Final = (errno.EBUSY, errno.EXDEV)
"""What systems say of a folder that cannot be renamed."""


def put_in_place(new: Path, target: Path, work: Path) -> list[str]:
    """A complete folder becomes the target; returns what people must know.

    Parameters
    ----------
    new : inside `work`
    work : the working folder, beside the target or inside it

    Raises
    ------
    OSError
        The system refused; the target is as it was.
    """
    if work.parent == target:
        return _install(new, target, work)
    try:
        notes = _swap(new, target, work)
    except OSError as error:
        if error.errno not in _FIXED:
            raise
        notes = _install(_copied(new, target), target, target / WORK)
        with suppress(OSError):
            (target / WORK).rmdir()
    return notes


def recover(target: Path, work: Path) -> list[str]:
    """Put right what a job left that was killed, and delete what is not needed any more.

    Raises
    ------
    OutputError
        Nothing complete is left of a target; the working folder stays, and is named.
    OSError
        The system refused.
    """
    notes = []
    for path in work.iterdir():
        if path.is_file() and path.name not in (JOURNAL, LOCK):  # written half
            path.unlink()
    if work.parent == target and (work / JOURNAL).is_file():
        notes += _carry_on(target, work)
    for path in _inside(work, GONE):
        _delete(path)
    beside = work.parent != target
    left = [path for path in _inside(work, NEW, OLD) if beside and _is_result(path)]
    for path in _inside(work, NEW, OLD):
        if path not in left:
            discard(path)
    whole = [path for path in left if faults(path) is None]
    if left and not _occupied(target):
        if not whole:
            raise OutputError(
                f"{target}: a job was killed and its files are damaged; see {work}, and remove it"
            )
        whole[0].rename(target)
        left.remove(whole[0])
        notes.append(f"{target}: a job was killed as it ended; its files are in place again")
    elif whole and _is_result(target) and faults(target) is not None and _lost(target):
        _swap(whole[0], target, work)
        left = [path for path in _inside(work, NEW, OLD) if _is_result(path)]
        notes.append(f"{target}: files were missing; an earlier result is in place again")
    for path in left:
        if _is_result(target):
            notes += carry(path, target, Others(listed(path)))
            discard(path)
    return notes


def discard(folder: Path) -> None:
    """Delete a folder of ours; one that is not deleted wholly is known as such by its name."""
    gone = folder.with_name(GONE + folder.name.partition("-")[2])
    with suppress(OSError):
        folder.rename(gone)
        _delete(gone)


def _delete(folder: Path) -> None:
    """Delete a tree, whose folders others may have made unwritable; links are not followed."""
    for above, folders, _ in os.walk(folder):
        for path in [Path(above), *(Path(above, name) for name in folders)]:
            if not path.is_symlink() and not os.access(path, os.W_OK | os.X_OK):
                with suppress(OSError):
                    path.chmod(0o700)
    shutil.rmtree(folder, ignore_errors=True)


def _swap(new: Path, target: Path, work: Path) -> list[str]:
    """Exchange the folders, in one step where the system can; the old one is deleted after that."""
    if not _occupied(target):
        with suppress(FileNotFoundError):
            shutil.copystat(target, new)
        try:
            if os.name == "nt" and target.exists():
                target.rmdir()
            new.rename(target)
        except OSError as error:
            if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
                raise
        else:
            return []
    others = Others(listed(target))
    notes = carry(target, new, others, link)
    with suppress(OSError, AttributeError):
        shutil.copystat(target, new)
        owner = target.stat()
        os.chown(new, owner.st_uid, owner.st_gid)
    if exchange(new, target):
        old = new
    else:
        old = work / new.name.replace(NEW, OLD, 1)
        target.rename(old)
        try:
            new.rename(target)
        except BaseException:
            old.rename(target)
            raise
    notes += carry(old, target, others)
    discard(old)
    return notes


def _copied(new: Path, target: Path) -> Path:
    """The files of ours of a folder, copied into the working folder inside a target."""
    copy = target / WORK / new.name
    for name in (*listed(new), *UNLISTED):
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileNotFoundError):
            shutil.copy2(new / name, copy / name)
    if found := faults(copy):
        raise OSError(errno.EIO, found)
    return copy


# --- a target that cannot be renamed ------------------------------------------------------------
def _install(new: Path, target: Path, work: Path) -> list[str]:
    """Move files one by one, by a journal: old ones out, new ones in, the manifest last."""
    before = listed(target) if (target / MANIFEST).is_file() else {}
    coming = {*listed(new), *UNLISTED}
    above = {str(folder) for name in coming for folder in PurePosixPath(name).parents}
    old = work / new.name.replace(NEW, OLD, 1)
    moves: list[tuple[Path, Path]] = []
    notes = []
    edited = set()
    for other in Others(before).within(target):
        if other.edited or other.name in (coming if other.folder else coming | above):
            name = free_name(other.name, target, target, kept=True)
            moves.append((target / other.name, target / name))
            edited.add(other.name)
            notes.append(note_of(other, name))
    ours = [MANIFEST, *sorted((before.keys() | UNLISTED) - {MANIFEST})]
    # Only what is there: done again, a move of nothing would take the new file of that name away.
    leaving = [n for n in ours if n not in edited and os.path.lexists(target / n)]
    moves += [(target / name, old / name) for name in leaving]
    incoming = [*sorted(coming - {MANIFEST}), MANIFEST]
    moves += [(new / name, target / name) for name in incoming]
    journal = {
        "moves": [[os.fspath(p.relative_to(target)) for p in move] for move in moves],
        "folders": sorted(
            {str(p) for n in before for p in PurePosixPath(n).parents if str(p) != "."}
        ),
    }
    with atomic_write(work / JOURNAL) as file:
        file.write(json.dumps(journal).encode())
    try:
        return notes + _carry_on(target, work)
    except OSError:
        _undo(target, moves)
        (work / JOURNAL).unlink(missing_ok=True)
        raise


def _carry_on(target: Path, work: Path) -> list[str]:
    """What the journal says and is not done yet; then the journal goes."""
    journal = json.loads((work / JOURNAL).read_bytes())
    for source, place in journal["moves"]:
        _move(target / source, target / place)
    sync_file_system(target)
    if found := faults(target):
        raise OSError(errno.EIO, found)
    (work / JOURNAL).unlink()
    for name in sorted(journal["folders"], key=len, reverse=True):
        with suppress(OSError):  # not empty
            (target / name).rmdir()
    for path in _inside(work, NEW, OLD):
        discard(path)
    return []


def _move(source: Path, place: Path) -> None:
    """Move a file unless that has been done: its place is taken, and old files went before."""
    if not os.path.lexists(source) or os.path.lexists(place):
        return
    place.parent.mkdir(parents=True, exist_ok=True)
    source.rename(place)


def _undo(target: Path, moves: list[tuple[Path, Path]]) -> None:
    for source, place in reversed(moves):
        with suppress(OSError):
            _move(place, source)


# --- what is there ------------------------------------------------------------------------------
def _inside(work: Path, *beginnings: str) -> list[Path]:
    """Folders of ours in a working folder."""
    with suppress(FileNotFoundError):
        return sorted(path for path in work.iterdir() if path.name.startswith(beginnings))
    return []


def _occupied(target: Path) -> bool:
    """Whether a target is there and not empty."""
    try:
        return any(target.iterdir())
    except FileNotFoundError:
        return False


def _is_result(folder: Path) -> bool:
    """Whether a folder has a manifest of ours."""
    with suppress(InputError):
        read_manifest(folder / MANIFEST)
        return True
    return False


def _lost(folder: Path) -> bool:
    """Whether files of the list are not there at all; an edited one is."""
    return any(not os.path.lexists(folder / name) for name in listed(folder))
