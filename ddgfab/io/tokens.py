"""Text of mesh files: bytes to text, and tokens to numbers, with errors that name the token."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from ddgfab.errors import MeshError, clipped

LARGEST_ID = 2**53
"""Whole numbers beyond this are not ids of anything; they would not fit into arrays either."""


def decode(data: bytes, file: str, lines_before: int = 0) -> str:
    """Text of a file with plain line ends, without byte order mark; binary content is refused."""
    for mark, codec in ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"), (b"\xef\xbb\xbf", "")):
        if data.startswith(mark) and codec:
            try:
                data = data.decode(codec).encode()
            except UnicodeDecodeError as error:
                raise MeshError(f"is not text: {error.reason}", file=file) from error
        elif data.startswith(mark):
            data = data[len(mark) :]
    zero = data.find(b"\0")
    if zero >= 0:
        line = lines_before + data.count(b"\n", 0, zero) + 1
        raise MeshError("holds binary data; a text file was expected", file=file, line=line)
    # Names in old files are Latin-1 as often as UTF-8; only ASCII matters for the mesh.
    text = data.decode("utf-8", errors="replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")


_LINE = re.compile(r"\S[^\n]*")


def numbered(text: str) -> Iterator[tuple[int, str]]:
    """Number (from 1) and content of each line that is not blank, one after the other."""
    line, at = 1, 0
    for found in _LINE.finditer(text):
        line += text.count("\n", at, found.start())
        at = found.start()
        yield line, found[0]


def token_rows(text: str) -> Iterator[tuple[int, list[str]]]:
    """Number and tokens of each line that has more than a comment (#)."""
    for line, content in numbered(text):
        parts = content.partition("#")[0].split()
        if parts:
            yield line, parts


def number(token: str, file: str, line: int) -> float:
    """A finite coordinate, also with the exponent of Fortran (1.5D+03); the error names it."""
    try:
        value = float(token)
    except ValueError:
        try:
            value = float(token.replace("D", "e").replace("d", "e"))
        except ValueError:
            reason = f"'{clip(token)}' is not a number"
            if token.replace(",", ".", 1).lstrip("+-").replace(".", "", 1).isdecimal():
                reason += ": decimals need a point"
            raise MeshError(reason, file=file, line=line) from None
    if "_" in token:
        raise MeshError(f"'{clip(token)}' is not a number", file=file, line=line)
    if not math.isfinite(value):
        raise MeshError(f"coordinate '{clip(token)}' is not finite", file=file, line=line)
    return value


def integer(token: str, file: str, line: int, what: str = "vertex number") -> int:
    """A whole number; the error names the token."""
    try:
        if "_" in token:
            raise ValueError
        value = int(token)
        if abs(value) > LARGEST_ID:
            raise ValueError
    except ValueError:
        raise MeshError(f"'{clip(token)}' is not a {what}", file=file, line=line) from None
    return value


def clip(token: str, most: int = 40) -> str:
    """A token short and printable enough for a message."""
    return clipped(token, most)
