"""Names of output folders: those of projects, in any script, as file systems can have them."""

from __future__ import annotations

import errno
import hashlib
import os
import re
import unicodedata
from contextlib import suppress
from pathlib import Path, PureWindowsPath
from typing import Final

from ddgfab.errors import clipped

_RESERVED: Final = re.compile(
    r"(con|prn|aux|nul|conin\$|conout\$|(com|lpt)[\d¹²³]) *(\..*)?", re.IGNORECASE | re.DOTALL
)
_LONGEST: Final = 180
"""Bytes of a name; file systems have 255, and hidden names beside it are longer."""
_LONGEST_PATH: Final = 259
"""Characters of a path that Windows takes unless long paths are enabled."""
_INSIDE: Final = 90
"""Characters of the longest path below an output folder, in its working folder."""
_FORBIDDEN: Final = re.compile(r'[<>:"|?*\x00-\x1f]')
_NO_NAME: Final = (errno.EILSEQ, errno.EINVAL, errno.ENAMETOOLONG)


def safe_name(text: str) -> str:
    """A name for a file or folder: letters and digits of any script and - _ . only, never a path.

    Texts without any such character, and texts that are too long, get a name with a hash of the
    text, so that two of them never share a name.

    >>> safe_name("Dach über Hof/2")
    'Dach-über-Hof-2'
    """
    plain = unicodedata.normalize("NFC", text)
    name = "".join(c if _kept(c) else "\0" for c in plain)
    name = re.sub("\0+", "-", name).strip(".-")
    if not name:
        return f"unnamed-{_hash(text)}" if text else "unnamed"
    if len(name.encode()) > _LONGEST:
        cut = name.encode()[: _LONGEST - 10].decode(errors="ignore").rstrip(".-")
        name = f"{cut}-{_hash(text)}"
    return f"_{name}" if _RESERVED.fullmatch(name) else name


def folder_for(parent: Path, text: str) -> Path:
    """The folder of a project of this name; with a hash where the file system has no such names."""
    name = safe_name(text)
    try:
        os.fsencode(name)
        with suppress(FileNotFoundError, NotADirectoryError):
            os.lstat(parent / name)
    except UnicodeEncodeError:
        return parent / _plain(name)
    except OSError as error:
        if error.errno in _NO_NAME:
            return parent / _plain(name)
    return parent / name


def windows_fault(path: str) -> str | None:
    """Why Windows cannot have an output folder at an absolute path; None where it can.

    The names of devices, a dot or space at the end and characters that Windows keeps for itself
    lead to another place, or to none; a path that is too long fails in the middle of a job.
    """
    whole = PureWindowsPath(path)
    for part in whole.parts[1 if whole.anchor else 0 :]:
        if found := _FORBIDDEN.search(part):
            return f"{clipped(part)} has the character {clipped(found[0])}"
        if _RESERVED.fullmatch(part.rstrip(" .")) or _RESERVED.fullmatch(part):
            return f"{clipped(part)} is the name of a device"
        if part not in (".", "..") and part[-1] in " .":
            return f"{clipped(part)} ends with a {'dot' if part[-1] == '.' else 'space'}"
    if len(path) + _INSIDE > _LONGEST_PATH:
        most = _LONGEST_PATH - _INSIDE
        return f"its {len(path)} characters leave no room for file names (at most {most})"
    return None


def _kept(character: str) -> bool:
    return character in "-_." or unicodedata.category(character)[0] in "LMN"


def _plain(name: str) -> str:
    """The same in ASCII, with a hash for what it lost."""
    letters = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode().strip(".-")
    return f"{letters or 'unnamed'}-{_hash(name)}"


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:8]
