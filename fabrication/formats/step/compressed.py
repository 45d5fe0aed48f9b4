"""STEP files compressed by gzip: .stpZ, as CATIA, NX and FreeCAD read them."""

from __future__ import annotations

import gzip
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from ddgfab.errors import InputError
from ddgfab.io.regular import read_regular

SUFFIX: Final = ".stpZ"

LIMIT_BYTES: Final = 512 * 1024 * 1024
"""Larger files are refused."""

UNPACKED_BYTES: Final = 1024 * 1024 * 1024
"""What a file may be unpacked to."""

_STEP: Final = 1024 * 1024


def is_compressed(path: Path) -> bool:
    """Whether the file has the suffix, in small letters or capitals."""
    return path.suffix.lower() == SUFFIX.lower()


def compressed(data: bytes) -> bytes:
    """The file, without a name or a date of its own."""
    return gzip.compress(data, compresslevel=6, mtime=0)


@contextmanager
def unpacked(path: Path) -> Iterator[Path]:
    """The path of the STEP file: its own, or that of a copy of it that is not compressed.

    Raises
    ------
    InputError
        Missing, not gzip, truncated, or beyond the limits.
    """
    if not is_compressed(path):
        yield path
        return
    file = str(path)
    data = read_regular(path, LIMIT_BYTES, InputError, what="a STEP file", advice="split it")
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "unpacked.step"
        try:
            with copy.open("wb") as stream:
                size = 0
                for block in _blocks(data):
                    size += len(block)
                    if size > UNPACKED_BYTES:
                        text = f"unpacks to more than {UNPACKED_BYTES} bytes; split it"
                        raise InputError(text, file=file)
                    stream.write(block)
        except (zlib.error, EOFError) as error:
            raise InputError(f"not compressed by gzip, or truncated ({error})", file=file) from None
        try:
            yield copy
        except InputError as error:
            if error.file != str(copy):
                raise
            raise InputError(str(error).removeprefix(f"{copy}: "), file=file) from None


def _blocks(data: bytes) -> Iterator[bytes]:
    unpacker = zlib.decompressobj(wbits=31)  # with a header of gzip
    rest = data
    while not unpacker.eof:
        block = unpacker.decompress(rest, _STEP)
        rest = unpacker.unconsumed_tail
        if not block and not rest and not unpacker.eof:
            raise EOFError("its end is missing")
        yield block
