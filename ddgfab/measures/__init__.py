"""What a mesh is, in numbers: defects of faces, edges and vertices."""

from __future__ import annotations

from ddgfab.measures.edges import dihedral_angles, lean, torsion

__all__ = ["dihedral_angles", "lean", "torsion"]
