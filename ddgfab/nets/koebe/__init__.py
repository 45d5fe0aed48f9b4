"""Koebe polyhedra: all edges touch the unit sphere."""

from __future__ import annotations

from ddgfab.nets.koebe.grids import catenoid_koebe, enneper_koebe, koebe_vertex
from ddgfab.nets.koebe.polyhedron import KoebePolyhedron, koebe

__all__ = [
    "KoebePolyhedron",
    "catenoid_koebe",
    "enneper_koebe",
    "koebe",
    "koebe_vertex",
]
