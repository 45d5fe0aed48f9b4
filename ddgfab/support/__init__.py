"""Torsion-free support structures: node axes, and why some nets have none."""

from __future__ import annotations

from ddgfab.measures.edge_offset import koebe_field
from ddgfab.support.asymptotic import edge_bend
from ddgfab.support.choose import SupportKind, support_structure
from ddgfab.support.edge import beam_heights, edge_axes
from ddgfab.support.even import even_lean
from ddgfab.support.exact import cone_axes, reflected_axes
from ddgfab.support.nearest_axes import AxesOptions, torsion_free_axes
from ddgfab.support.parallel import parallel_axes, parallel_field
from ddgfab.support.propagate import node_torsion, propagate_axes
from ddgfab.support.structure import SupportStructure
from ddgfab.support.triangles import best_center, central, incircle_axes

__all__ = [
    "AxesOptions",
    "SupportKind",
    "SupportStructure",
    "beam_heights",
    "best_center",
    "central",
    "cone_axes",
    "edge_axes",
    "edge_bend",
    "even_lean",
    "incircle_axes",
    "koebe_field",
    "node_torsion",
    "parallel_axes",
    "parallel_field",
    "propagate_axes",
    "reflected_axes",
    "support_structure",
    "torsion_free_axes",
]
