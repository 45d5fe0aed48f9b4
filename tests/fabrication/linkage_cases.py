"""Linkages in parts that several tests start from."""

from __future__ import annotations

from typing import Any

from test_linkage_levels import loop

from ddgfab.linkages import Mechanism
from fabrication.linkage.detail import detail_linkage
from fabrication.linkage.links import Linkage
from fabrication.linkage.settings import settings_for


def kit(mechanism: Mechanism | None = None, **given: Any) -> Linkage:
    return detail_linkage(mechanism or loop(), settings_for(**given))
