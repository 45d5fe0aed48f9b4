"""A second reader of STEP text (ISO 10303-21): strings, header, entities; knows nothing of ours."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

_TOKEN = re.compile(
    r"\s*(?:(?P<string>'(?:[^']|'')*')|(?P<real>[+-]?\d+\.\d*(?:E[+-]?\d+)?)|(?P<integer>[+-]?\d+)"
    r"|(?P<reference>#\d+)|(?P<enumeration>\.[A-Z_0-9]+\.)|(?P<keyword>[A-Z][A-Z0-9_-]*)"
    r"|(?P<mark>[();,=$*]))"
)


@dataclass(frozen=True)
class Token:
    kind: str
    text: str


def tokens(text: str) -> list[Token]:
    """All tokens of an exchange file; anything else in it is an error."""
    assert all(" " <= c <= "~" or c == "\n" for c in text), "outside of the alphabet"
    found, at, text = [], 0, text.rstrip()
    while at < len(text):
        match = _TOKEN.match(text, at)
        assert match, f"no token: {text[at : at + 40]!r}"
        found.append(Token(str(match.lastgroup), match[match.lastgroup or 0]))
        at = match.end()
    return found


def decode(quoted: str) -> str:
    """The characters of a string token (clause 6.4.3); every control directive is checked."""
    assert quoted[0] == quoted[-1] == "'"
    body, out, at = quoted[1:-1], [], 0
    while at < len(body):
        here = body[at:]
        if here.startswith("''"):
            out.append("'")
            at += 2
        elif here.startswith("\\\\"):
            out.append("\\")
            at += 2
        elif match := re.match(r"\\X2\\((?:[0-9A-F]{4})+)\\X0\\", here):
            codes = [int(match[1][i : i + 4], 16) for i in range(0, len(match[1]), 4)]
            assert not any(0xD800 <= code < 0xE000 for code in codes), "a surrogate in \\X2\\"
            out += map(chr, codes)
            at += match.end()
        elif match := re.match(r"\\X4\\((?:[0-9A-F]{8})+)\\X0\\", here):
            out += [chr(int(match[1][i : i + 8], 16)) for i in range(0, len(match[1]), 8)]
            at += match.end()
        else:
            assert here[0] not in "\\'", f"no directive: {here[:8]}"
            out.append(here[0])
            at += 1
    return "".join(out)


def header(text: str) -> dict[str, list[Any]]:
    """The parameters of the header's three entities, lists as lists, strings decoded.

    Checks their order, their types, the length of strings (256, clause 8.2) and the time.
    """
    start, end = "ISO-10303-21;\nHEADER;\n", "ENDSEC;\nDATA;\n"
    assert text.startswith(start)
    assert end in text
    stream = tokens(text[len(start) : text.index(end)])
    found: dict[str, list[Any]] = {}
    at = 0
    while at < len(stream):
        name = stream[at]
        assert name.kind == "keyword"
        assert stream[at + 1].text == "("
        value, at = _list(stream, at + 1)
        assert stream[at].text == ";"
        at += 1
        found[name.text] = value
    assert list(found) == ["FILE_DESCRIPTION", "FILE_NAME", "FILE_SCHEMA"]
    description, level = found["FILE_DESCRIPTION"]
    name, stamp, author, organization, preprocessor, system, authorisation = found["FILE_NAME"]
    (schemas,) = found["FILE_SCHEMA"]
    assert level == "2;1"
    assert schemas
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d([+-]\d\d:\d\d|Z)?", stamp)
    for row in (description, author, organization):
        assert isinstance(row, list)
        assert row
    for string in (name, *description, *author, *organization, preprocessor, system, authorisation):
        assert isinstance(string, str)
        assert len(string) <= 256
        assert not re.search(r"[\x00-\x1f\x7f-\x9f]", string), "a control character"
    return found


def _list(stream: list[Token], at: int) -> tuple[list[Any], int]:
    """Parameters from an opening bracket on, and where they end."""
    values: list[Any] = []
    at += 1
    while stream[at].text != ")":
        if stream[at].text == "(":
            inner, at = _list(stream, at)
            values.append(inner)
        else:
            assert stream[at].kind == "string"
            values.append(decode(stream[at].text))
            at += 1
        assert stream[at].text in ",)"
        if stream[at].text == ",":
            at += 1
            assert stream[at].text != ")"
    return values, at + 1
