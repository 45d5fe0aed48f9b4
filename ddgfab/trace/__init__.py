"""From a smooth surface to a mesh: fields of directions, their lines, networks, cells."""

from __future__ import annotations

from ddgfab.trace.field import ConjugateField, Field, PrincipalField, plane_sections, turned
from ddgfab.trace.lines import Line, Tracer
from ddgfab.trace.mesh import TracedMesh, network_mesh
from ddgfab.trace.placing import Network, place
from ddgfab.trace.recipe import Traced, trace
from ddgfab.trace.report import TraceQuality, quality
from ddgfab.trace.umbilics import Umbilic

__all__ = [
    "ConjugateField",
    "Field",
    "Line",
    "Network",
    "PrincipalField",
    "TraceQuality",
    "Traced",
    "TracedMesh",
    "Tracer",
    "Umbilic",
    "network_mesh",
    "place",
    "plane_sections",
    "quality",
    "trace",
    "turned",
]
