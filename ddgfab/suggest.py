"""The known names most like a misspelt one, for the end of an error message."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Final

from ddgfab.arguments import checked

LEAST_LIKENESS: Final = 0.5
"""Least ratio of `difflib.SequenceMatcher` at which a known name may have been meant."""


@checked
def nearest(name: str, known: Iterable[str], count: int = 3) -> list[str]:
    """At most `count` known names like `name`, the most alike first; case does not matter."""
    folded = {other.casefold(): other for other in known}
    near = difflib.get_close_matches(name.casefold(), folded, count, LEAST_LIKENESS)
    return [folded[other] for other in near]


@checked
def suggestion(name: str, known: Iterable[str]) -> str:
    """The known name that was probably meant, or all known names.

    Examples
    --------
    >>> suggestion("conicl", ["circular", "conical"])
    'did you mean conical?'
    >>> suggestion("roof", ["circular", "conical"])
    'known: circular, conical'
    """
    names = list(known)
    near = nearest(name, names, 1)
    return f"did you mean {near[0]}?" if near else f"known: {', '.join(names)}"
