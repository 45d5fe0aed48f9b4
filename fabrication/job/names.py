"""Names of output folders: those of projects, in any script, as file systems can have them."""

from __future__ import annotations

import errno
import hashlib
import os
import re
import unicodedata
from contextlib import suppress
from pathlib import Path
from typing import Final

_RESERVED: Final = re.compile(r"(con|prn|aux|nul|(com|lpt)[\d¹²³])(\..*)?", re.IGNORECASE)
_LONGEST: Final = 180
"""Bytes of a name; file systems have 255, and hidden names beside it are longer."""
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


def _kept(character: str) -> bool:
    return character in "-_." or unicodedata.category(character)[0] in "LMN"


def _plain(name: str) -> str:
    """The same in ASCII, with a hash for what it lost."""
    letters = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode().strip(".-")
    return f"{letters or 'unnamed'}-{_hash(name)}"


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:8]
