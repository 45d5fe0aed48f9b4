"""Zip archives, which 3MF files and workbooks are: what reading a damaged one raises."""

from __future__ import annotations

import struct
import zipfile
import zlib
from typing import Final

UNREADABLE: Final = (
    OSError,
    EOFError,
    KeyError,
    NotImplementedError,  # a method of packing, or a version, that Python has not
    RuntimeError,  # packed with a password
    ValueError,
    struct.error,
    zipfile.BadZipFile,
    zlib.error,
)
"""What `zipfile` raises for an archive that is damaged."""
