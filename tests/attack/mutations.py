"""Texts, JSON and bytes of mesh files and projects, changed by their grammar.

Bytes that are damaged anywhere (`damage`) mostly end at the first check of a reader. Here a word is
replaced by another word, a number by another number, a line by another line: what comes out is
often read, and has to be a sound mesh then.
"""

from __future__ import annotations

import copy
import json
import random
import re
from collections.abc import Callable
from contextlib import suppress
from typing import Any

NUMBERS = [
    *("0", "-0.0", "1", "-1", "2", "3", "7", "0.5", "1e-7", "1e-300", "5e-324", "1e16", "1e60"),
    *("1e61", "1e154", "1e308", "1e999", "nan", "-inf", "1d2", "0x1", "1_0", "1,5", "--1", "+.5"),
    *("٣", "1.0000001", "0.9999999", "", str(2**31), str(2**53), str(2**63), str(-(2**64))),
    *(
        "9" * 400,
        "1" + "0" * 5000,
        "1e",
        ".",
        "-",
        "1.2.3",
        "1/0",
        "//",
        "-1/-1",
        "127",
        "255",
        "256",
    ),
]
WORDS = [
    *("v", "f", "l", "vn", "vt", "p", "g", "fo", "usemtl", "surf", "#", "\\", "/", "OFF", "COFF"),
    *("4OFF", "nOFF", "STNOFF", "BINARY", "solid", "vertex", "facet", "endsolid", "ply", "face"),
    *("end_header", "property", "element", "list", "uchar", "double", "char", "comment", "format"),
    *(
        "# units: m",
        "# units: ft",
        "\x00",
        "\x1b[2J",
        "\ufeff",
        "\u202e",
        "é",
        "\ud7ff",
        "x" * 3000,
    ),
    *("binary_big_endian", "binary_little_endian", "ascii", "vertex_indices", "\u2028", "\x85"),
]
ENDS = ["\n", "\r\n", "\r", " \\\n", "\n\n\n", " ", "\t\n", "\x0c", "\n# x\n"]

_WORD = re.compile(r"\S+")
_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


def changed_text(text: str, rng: random.Random) -> str:
    """One to six changes; the more, the rarer."""
    for _ in range(rng.choice((1, 1, 1, 2, 3, 6))):
        text = rng.choice(TEXT)(text, rng)
    return text


def number(text: str, rng: random.Random) -> str:
    """A number is another one."""
    return _in_line(text, rng, _NUMBER, lambda match: rng.choice(NUMBERS))


def other_number(text: str, rng: random.Random) -> str:
    """A number is one that stands elsewhere: an index, a coordinate, a count."""
    rows = text.split("\n")
    there = _NUMBER.findall(rng.choice(rows)) or _NUMBER.findall(rows[-2:][0]) or ["0"]
    return _in_line(text, rng, _NUMBER, lambda match: rng.choice(there))


def nudged(text: str, rng: random.Random) -> str:
    """A number is a little more or less: vertices that nearly meet, faces that nearly are flat."""

    def by(match: re.Match[str]) -> str:
        if match[0].isdigit() and len(match[0]) < 1000:
            return str(int(match[0]) + rng.choice((-1, 1)))
        return repr(float(match[0]) * (1 + rng.choice((1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 1.0))))

    return _in_line(text, rng, _NUMBER, by)


def word(text: str, rng: random.Random) -> str:
    """A word is put before another, or in its place."""
    before = rng.random() < 0.4
    return _in_line(
        text, rng, _WORD, lambda match: f"{rng.choice(WORDS)} {match[0] if before else ''}"
    )


def _in_line(
    text: str, rng: random.Random, pattern: re.Pattern[str], by: Callable[[re.Match[str]], str]
) -> str:
    """One match of a pattern in a line that chance chooses, replaced."""
    rows = text.split("\n")
    at = rng.randrange(len(rows))
    found = list(pattern.finditer(rows[at]))
    if found:
        match = rng.choice(found)
        rows[at] = rows[at][: match.start()] + by(match) + rows[at][match.end() :]
    return "\n".join(rows)


def lines(text: str, rng: random.Random) -> str:
    """A line is gone, there twice, elsewhere, or has words that are gone, doubled or exchanged."""
    rows = text.split("\n")
    at, to = rng.randrange(len(rows)), rng.randrange(len(rows))
    kind = rng.randrange(7)
    words = rows[at].split(" ")
    here, there = rng.randrange(len(words)), rng.randrange(len(words))
    if kind == 0:
        del rows[at]
    elif kind == 1:
        rows.insert(to, rows[at])
    elif kind == 2:
        rows[at], rows[to] = rows[to], rows[at]
    elif kind == 3:
        del words[here]
    elif kind == 4:
        words.insert(there, words[here])
    elif kind == 5:
        words[here], words[there] = words[there], words[here]
    else:
        words.reverse()
    if kind > 2:
        rows[at] = " ".join(words)
    return "\n".join(rows)


def block(text: str, rng: random.Random) -> str:
    """Many lines are gone, or there again: a second body, a hole, a file cut off."""
    rows = text.split("\n")
    begin = rng.randrange(len(rows))
    end = begin + rng.randrange(1, 30)
    if rng.random() < 0.5:
        return "\n".join(rows[:begin] + rows[end:])
    to = rng.randrange(len(rows))
    return "\n".join(rows[:to] + rows[begin:end] + rows[to:])


def ends(text: str, rng: random.Random) -> str:
    """Line breaks are of another kind, one of them or all."""
    if rng.random() < 0.5:
        return text.replace("\n", rng.choice(ENDS))
    return text.replace("\n", rng.choice(ENDS), rng.randrange(1, 10))


def stretched(text: str, rng: random.Random) -> str:
    """A line is there very often."""
    rows = text.split("\n")
    at = rng.randrange(len(rows))
    return "\n".join(rows[:at] + rows[at : at + 1] * rng.choice((10, 100, 1000)) + rows[at:])


def scaled(text: str, rng: random.Random) -> str:
    """All numbers with a point are larger or smaller."""
    factor = rng.choice((1e-320, 1e-30, 1e-9, 1e-4, -1.0, 0.0, 1e4, 1e9, 1e30, 1e300))
    return re.sub(r"-?\d+\.\d+(?:e[-+]?\d+)?", lambda m: repr(float(m[0]) * factor), text)


TEXT = [number, other_number, other_number, nudged, word, lines, lines, block, ends, scaled]
TEXT = [*TEXT, *TEXT, *TEXT, stretched]


VALUES: list[Any] = [
    *(
        None,
        True,
        False,
        0,
        1,
        -1,
        2.5,
        1e308,
        -1e-320,
        2**63,
        -(2**70),
        10**4000,
        "",
        "a",
        "0",
        "x",
    ),
    *(
        [],
        {},
        [[]],
        [1, 2, 3],
        [0.0, 0.0, 0.0],
        {"x": 1},
        {"vertices": [], "faces": []},
        "\x00",
        "é",
    ),
    *([0, 1, 2], [0, 0, 0], [5, 4, 3, 2, 1, 0], "compas.datastructures/Mesh", [[[[[[[]]]]]]]),
]
KEYS = [
    "x",
    "y",
    "z",
    "0",
    "1",
    "vertex",
    "vertices",
    "face",
    "faces",
    "data",
    "dtype",
    "dva",
    "value",
]


def changed_json(text: str, rng: random.Random) -> str:
    """Values, keys and whole branches of a JSON text are others."""
    tree = json.loads(text)
    for _ in range(rng.choice((1, 1, 2, 4))):
        places = list(_places(tree))
        if not places:
            break
        holder, key = rng.choice(places)
        kind = rng.randrange(6)
        if kind == 0:
            del holder[key]
        elif kind == 1 and isinstance(holder, dict):
            holder[rng.choice(KEYS)] = holder.pop(key)
        elif kind == 2:
            other, name = rng.choice(places)
            try:
                holder[key] = json.loads(json.dumps(other[name]))
            except (KeyError, IndexError):
                holder[key] = None
        elif kind == 3:
            holder[key] = [holder[key]] * rng.choice((0, 1, 2, 20))
        elif kind == 4 and isinstance(holder[key], int | float):
            with suppress(OverflowError):  # whole numbers of any length
                holder[key] = holder[key] * rng.choice((-1, 0, 1 + 1e-9, 1e9))
        else:
            holder[key] = copy.deepcopy(rng.choice(VALUES))
    try:
        return json.dumps(tree)
    except ValueError:  # more digits than Python writes
        return text


def _places(tree: Any) -> Any:
    """(container, key) of every value in a tree."""
    stack = [tree]
    while stack:
        node = stack.pop()
        keys = list(node) if isinstance(node, dict) else range(len(node))
        for key in keys:
            yield node, key
            if isinstance(node[key], dict | list):
                stack.append(node[key])
