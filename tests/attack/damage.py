"""Files damaged in ways that disks, transfers, editors and other programs damage them."""

from __future__ import annotations

import random
import re

ABSURD = [
    "1.E308",
    "-1.E308",
    "1.E-320",
    "NAN",
    "INF",
    "0.",
    "-1.",
    "1.E20",
    "99999999999999999999",
    "$",
    "*",
    "''",
    "()",
]
"""What a number is replaced by."""


def damaged(data: bytes, seed: int) -> bytes:
    """The file with one to four damages of kinds that the seed chooses."""
    rng = random.Random(seed)
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        data = rng.choice(KINDS)(data, rng)
    return data


def truncate(data: bytes, rng: random.Random) -> bytes:
    """The end is missing."""
    return data[: rng.randrange(len(data) + 1)]


def flip(data: bytes, rng: random.Random) -> bytes:
    """Some bytes are others."""
    out = bytearray(data)
    for _ in range(rng.choice((1, 3, 30)) if out else 0):
        out[rng.randrange(len(out))] ^= 1 << rng.randrange(8)
    return bytes(out)


def cut(data: bytes, rng: random.Random) -> bytes:
    """A piece is missing."""
    begin = rng.randrange(len(data) + 1)
    return data[:begin] + data[begin + rng.choice((1, 10, 100, 1000)) :]


def double(data: bytes, rng: random.Random) -> bytes:
    """A piece stands there twice."""
    begin = rng.randrange(len(data) + 1)
    end = begin + rng.choice((1, 10, 100, 1000))
    return data[:end] + data[begin:]


def drop_lines(data: bytes, rng: random.Random) -> bytes:
    """Lines are missing."""
    lines = data.split(b"\n")
    for _ in range(rng.choice((1, 2, 10))):
        if lines:
            del lines[rng.randrange(len(lines))]
    return b"\n".join(lines)


def swap_lines(data: bytes, rng: random.Random) -> bytes:
    """Contents of two entities are exchanged."""
    lines = data.split(b"\n")
    one, two = rng.randrange(len(lines)), rng.randrange(len(lines))
    first, second = lines[one].partition(b"="), lines[two].partition(b"=")
    lines[one], lines[two] = b"=".join((first[0], second[2])), b"=".join((second[0], first[2]))
    return b"\n".join(lines)


def absurd_number(data: bytes, rng: random.Random) -> bytes:
    """A number is not one that makes sense."""
    return _replaced(data, rng, rb"(?<![#\w])-?\d+\.\d*(?:E[-+]?\d+)?", rng.choice(ABSURD).encode())


def wrong_reference(data: bytes, rng: random.Random) -> bytes:
    """An entity refers to another one, to itself, or to none."""
    ids = re.findall(rb"#\d+", data) or [b"#1"]
    return _replaced(data, rng, rb"#\d+", rng.choice([*ids, b"#0", b"#999999999"]))


def wrong_kind(data: bytes, rng: random.Random) -> bytes:
    """An entity is of another kind."""
    kinds = re.findall(rb"[A-Z_]{6,}", data) or [b"PLANE"]
    return _replaced(data, rng, rb"[A-Z_]{6,}", rng.choice([*kinds, b"NO_SUCH_THING"]))


KINDS = [
    truncate,
    flip,
    cut,
    double,
    drop_lines,
    swap_lines,
    absurd_number,
    wrong_reference,
    wrong_kind,
]


def _replaced(data: bytes, rng: random.Random, pattern: bytes, by: bytes) -> bytes:
    """The file with one or some matches of a pattern replaced."""
    found = list(re.finditer(pattern, data))
    for match in sorted(
        rng.sample(found, min(len(found), rng.choice((1, 1, 5)))), key=lambda m: -m.start()
    ):
        data = data[: match.start()] + by + data[match.end() :]
    return data
