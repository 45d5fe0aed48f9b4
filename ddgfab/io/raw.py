"""What a file says, before anything is checked or mended: points, polygons and their lines."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ddgfab.errors import MeshError
from ddgfab.mesh import Floats, Ints

LIMIT_BYTES = 256 * 1024 * 1024
"""Largest mesh file that is read [bytes] unless the caller says otherwise."""


@dataclass(frozen=True, eq=False)
class RawMesh:
    """Polygons as a file states them, ids from 0, nothing checked yet.

    Attributes
    ----------
    file : name for messages
    points : (V, 3)
    corners : (C,) vertex ids, face after face
    sizes : (F,) number of corners of each face
    point_lines, face_lines : (V,), (F,) line of each in the file, None for binary files
    notes : what was ignored or read in another sense than the format's
    """

    file: str
    points: Floats
    corners: Ints
    sizes: Ints
    point_lines: Ints | None
    face_lines: Ints | None
    notes: list[str] = field(default_factory=list)

    def fail(self, reason: str, *, point: int | None = None, face: int | None = None) -> MeshError:
        """The error to raise, with the line of the point or face it is about."""
        lines, index = (self.point_lines, point) if face is None else (self.face_lines, face)
        line = None if lines is None or index is None else int(lines[index])
        return MeshError(reason, file=self.file, line=line)

    @staticmethod
    def of(
        file: str,
        points: Sequence[Sequence[float]],
        faces: Sequence[Sequence[int]],
        point_lines: Sequence[int],
        face_lines: Sequence[int],
        notes: list[str],
    ) -> RawMesh:
        """Raw mesh from Python lists."""
        flat = [index for face in faces for index in face]
        return RawMesh(
            file,
            np.array(points, dtype=np.float64).reshape(-1, 3),
            np.array(flat, dtype=np.int64),
            np.array([len(face) for face in faces], dtype=np.int64),
            np.array(point_lines, dtype=np.int64),
            np.array(face_lines, dtype=np.int64),
            notes,
        )


def load_bytes(path: Path, limit_bytes: int) -> tuple[bytes, str]:
    """Content of a file and its SHA-256; refuses what is missing, empty or above the limit."""
    file = str(path)
    try:
        size = path.stat().st_size
        if path.is_dir():
            raise MeshError("this is a folder; a mesh file is needed", file=file)
        if size > limit_bytes:
            raise MeshError(
                f"{size} bytes exceed the limit of {limit_bytes}; simplify the mesh or raise "
                "limit_bytes",
                file=file,
            )
        data = path.read_bytes()
    except FileNotFoundError as error:
        raise MeshError("no such file", file=file) from error
    except OSError as error:
        raise MeshError(f"cannot be read: {error.strerror or error}", file=file) from error
    if not data.strip():
        raise MeshError("the file is empty", file=file)
    return data, hashlib.sha256(data).hexdigest()


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


def number(token: str, file: str, line: int) -> float:
    """A finite coordinate; the error names the token."""
    try:
        value = float(token)
    except ValueError:
        value = math.nan
        if "," in token:
            raise MeshError(
                f"'{token}' is not a number: decimals need a point", file=file, line=line
            ) from None
        raise MeshError(f"'{clip(token)}' is not a number", file=file, line=line) from None
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
        return int(token)
    except ValueError:
        raise MeshError(f"'{clip(token)}' is not a {what}", file=file, line=line) from None


def clip(token: str, most: int = 40) -> str:
    """A token short and printable enough for a message."""
    shown = token if len(token) <= most else token[:most] + "..."
    return "".join(c if c.isprintable() else "?" for c in shown)
