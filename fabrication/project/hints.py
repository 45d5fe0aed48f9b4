"""What is meant where a project file is not TOML: the line, and how it is written."""

from __future__ import annotations

import re
import tomllib
from typing import Final

_KEY: Final = r"^\s*(?P<key>[\w.\"'-]+)\s*=\s*"
_BACKSLASH: Final = re.compile(_KEY + r'"(?P<text>[^"\n]*\\[^"\n]*)"?')
_OPEN: Final = re.compile(_KEY + r"""(?P<quote>["'])(?P<text>(?:(?!(?P=quote)).)*)$""")
_CURLED: Final = re.compile(_KEY + "[\u2018\u2019\u201c\u201d\u201e\u00ab\u00bb](?P<text>.*)$")
_SIZE: Final = re.compile(_KEY + r"(?P<a>[\d.]+)\s*[xX×]\s*(?P<b>[\d.]+)\s*(?:#.*)?$")
_COMMA: Final = re.compile(_KEY + r"(?P<text>[+-]?\d+,\d+)\s*(?:#.*)?$")
_UNIT: Final = re.compile(
    _KEY + r"(?P<text>[+-]?\d+(?:\.\d+)?)\s*(?P<unit>mm|cm|m|deg|°|%)\s*(?:#.*)?$"
)
_FRACTION: Final = re.compile(_KEY + r"(?P<a>\d+(?:\.\d+)?)\s*/\s*(?P<b>\d+(?:\.\d+)?)\s*(?:#.*)?$")
_ENDED: Final = re.compile(r"^(?P<line>\s*[^;#]+?)\s*[;,]\s*(?:#.*)?$")
_COLON: Final = re.compile(r"^\s*(?P<key>[\w-]+)\s*:\s*(?P<text>[^\s#][^#]*?)\s*(?:#.*)?$")
_BARE: Final = re.compile(_KEY + r"(?P<text>[^\s\"'\[{#][^#\"]*?)\s*(?:#.*)?$")
_WORDS: Final = {"True": "true", "False": "false", "yes": "true", "no": "false"}

WINDOWS: Final = "backslashes in \"...\" begin escapes: write '...' (single quotes), or / for \\"
"""Advice for paths of Windows."""


def place_of(error: tomllib.TOMLDecodeError, text: str) -> tuple[int, int | None]:
    """Line and column (from 1) of a TOML error; the last line where it names none."""
    found = re.search(r"line (\d+), column (\d+)", str(error))
    if found:
        return int(found[1]), int(found[2])
    return text.count("\n") + 1, None


def advice_for(line: str) -> str:
    """How a line that is not TOML is written; an empty text where that is not clear."""
    try:
        tomllib.loads(line)
    except tomllib.TOMLDecodeError:
        return _advice(line)
    except (ValueError, RecursionError):
        pass
    return ""  # the fault is in what stands before it


def unclosed(line: str) -> bool:
    """Whether a text begins in a line that has no closing quote."""
    return _OPEN.match(line) is not None


def _advice(line: str) -> str:
    if (found := _ENDED.match(line)) and _is_toml(found["line"]):
        return f"nothing ends a line: {found['line'].strip()}"
    if (found := _COLON.match(line)) and _is_toml(f"{found['key']} = {found['text']}"):
        return f"= stands between key and value: {found['key']} = {found['text']}"
    if (found := _FRACTION.match(line)) and float(found["b"]):
        value = float(found["a"]) / float(found["b"])
        return f"numbers stand without a slash: {found['key']} = {value:.12g}"
    if found := _BACKSLASH.match(line):
        return f"{WINDOWS}\n{found['key']} = {_quoted(found['text'])}"
    if found := _CURLED.match(line):
        meant = re.sub("[\u2018\u2019\u201c\u201d\u201e\u00ab\u00bb].*", "", found["text"])
        return f"straight quotes are needed: {found['key']} = {_quoted(meant)}"
    if found := _OPEN.match(line):
        quote = found["quote"]
        return f"the closing quote is missing: {found['key']} = {quote}{found['text']}{quote}"
    if found := _SIZE.match(line):
        return f"two numbers are a list: {found['key']} = [{found['a']}, {found['b']}]"
    if found := _COMMA.match(line):
        return f"decimals need a point: {found['key']} = {found['text'].replace(',', '.')}"
    if found := _UNIT.match(line):
        return f"numbers stand without a unit: {found['key']} = {found['text']}"
    if found := _BARE.match(line):
        if found["text"] in _WORDS:
            return f"write {found['key']} = {_WORDS[found['text']]}"
        return f"text needs quotes: {found['key']} = {_quoted(found['text'])}"
    return ""


def _is_toml(line: str) -> bool:
    try:
        tomllib.loads(line)
    except (ValueError, RecursionError):
        return False
    return True


def _quoted(text: str) -> str:
    """Text as TOML."""
    return f"'{text}'" if "\\" in text else f'"{text}"'
