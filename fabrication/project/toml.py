"""Values as TOML has them, for files that are made, messages and commands to try."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel


def toml_text(value: Any) -> str:
    """A value as it stands in a TOML file.

    >>> toml_text((2500.0, 1500)), toml_text("a"), toml_text(True), toml_text({"x": 0.5})
    ('[2500, 1500]', '"a"', 'true', '{ x = 0.5 }')
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:.0f}" if value.is_integer() and abs(value) < 1e15 else _real(value)
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml_text, value))}]"
    if isinstance(value, BaseModel):
        value = value.model_dump()
    if isinstance(value, Mapping):
        inner = ", ".join(f"{toml_key(key)} = {toml_text(item)}" for key, item in value.items())
        return f"{{ {inner} }}" if inner else "{}"
    if isinstance(value, str | Path):
        return json.dumps(str(value), ensure_ascii=False).replace("\x7f", "\\u007f")
    return str(value)


def _real(value: float) -> str:
    if not math.isfinite(value):
        return str(value)
    return repr(value)


def toml_key(key: str) -> str:
    """A key, in quotes where it needs them."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else toml_text(key)


def argument_text(value: Any) -> str:
    """A value as an argument of the command line has it: TOML, text without quotes."""
    return str(value) if isinstance(value, str | Path) else toml_text(value)
