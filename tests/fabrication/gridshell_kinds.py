"""The kinds of a gridshell by role, for tests that write files without detailing a roof."""

from __future__ import annotations

from fabrication.parts.beam import BEAM
from fabrication.parts.node import NODE
from fabrication.parts.panel import PANEL
from fabrication.specs import Kind

KINDS: dict[str, Kind] = {kind.role: kind for kind in (BEAM, NODE, PANEL)}
