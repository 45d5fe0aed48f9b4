"""What a mesh is, in numbers: defects of faces, edges and vertices."""

from __future__ import annotations

from ddgfab.measures.areas import mixed_areas, oriented_areas
from ddgfab.measures.edges import dihedral_angles, lean, torsion
from ddgfab.measures.faces import (
    chebyshev_defect,
    circular_defect,
    interior_angles,
    planarity,
    planarity_percent,
    translation_defect,
)
from ddgfab.measures.kinds import kind_names, kind_words, not_a_disk
from ddgfab.measures.report import Measure, Report, inspect
from ddgfab.measures.vertices import conical_defect, isothermic_defect, star_defect

__all__ = [
    "Measure",
    "Report",
    "chebyshev_defect",
    "circular_defect",
    "conical_defect",
    "dihedral_angles",
    "inspect",
    "interior_angles",
    "isothermic_defect",
    "kind_names",
    "kind_words",
    "lean",
    "mixed_areas",
    "not_a_disk",
    "oriented_areas",
    "planarity",
    "planarity_percent",
    "star_defect",
    "torsion",
    "translation_defect",
]
