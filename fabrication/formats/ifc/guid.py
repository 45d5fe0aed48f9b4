"""Global ids of IFC: a UUID of a name, in the 22 characters of IfcGloballyUniqueId."""

from __future__ import annotations

from base64 import b64encode
from typing import Final
from uuid import NAMESPACE_URL, UUID, uuid5

_STANDARD: Final = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"
_DIGITS: Final = b"0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_$"
_TO_DIGITS: Final = bytes.maketrans(_STANDARD, _DIGITS)
_SPACE: Final = uuid5(NAMESPACE_URL, "ddgfab")


class Guids:
    """Ids that are the same in every run: of the project's name and what each object is called."""

    def __init__(self, project: str) -> None:
        self._space = uuid5(_SPACE, project)

    def __call__(self, kind: str, name: str = "") -> str:
        """The id of an object of a kind."""
        return compressed(uuid5(self._space, f"{kind}/{name}"))


def compressed(uuid: UUID) -> str:
    """128 bits as 22 digits of base 64, as buildingSMART defines them; the first one is 0 to 3."""
    padded = b64encode(b"\0\0" + uuid.bytes)  # 24 digits, the first two of them 0
    return padded[2:].translate(_TO_DIGITS).decode("ascii")
