"""Links: a straight bar between two round eyes on skew axes, perhaps with a label."""

from __future__ import annotations

from fabrication.parts.link.congruence import link_key_of
from fabrication.parts.link.shape import LINK, LinkShape

__all__ = ["LINK", "LinkShape", "link_key_of"]
