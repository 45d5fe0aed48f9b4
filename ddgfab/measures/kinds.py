"""Which kind of net a mesh is within tolerance, as text."""

from __future__ import annotations

import numpy as np

from ddgfab.arguments import checked
from ddgfab.measures.edge_offset import edge_offset_kinds
from ddgfab.measures.edges import dihedral_angles
from ddgfab.measures.faces import (
    chebyshev_defect,
    circular_defect,
    planarity_percent,
    translation_defect,
)
from ddgfab.measures.vertices import conical_defect, isothermic_defect, star_defect
from ddgfab.mesh import Mesh
from ddgfab.tolerances import (
    NET_ANGLE_DEG,
    NET_EDGE_OFFSET,
    NET_ISOTHERMIC,
    NET_PLANAR_PERCENT,
    NET_SIDES_PERCENT,
    NET_STAR_DEG,
)


@checked
def kind_names(mesh: Mesh) -> tuple[str, ...]:
    """Short names of all kinds of net that the mesh is within tolerance, the most telling first.

    Of: flat, conical, circular, planar, Koebe, edge-offset, isothermic, translation, K-net, A-net,
    Chebyshev, equal-angle-sums, quad, triangle, polygon. Tolerances: `NET_PLANAR_PERCENT`,
    `NET_ANGLE_DEG`, `NET_STAR_DEG`, `NET_SIDES_PERCENT`, `NET_EDGE_OFFSET`, `NET_ISOTHERMIC`.
    """
    quads = bool((mesh.face_sizes == 4).all())
    triangles = bool((mesh.face_sizes == 3).all())
    planar = bool(planarity_percent(mesh).max() <= NET_PLANAR_PERCENT)
    has_inner = bool((~mesh.boundary_vertex & (mesh.valences > 3)).any())
    angle = np.radians(NET_ANGLE_DEG)
    conical = has_inner and bool(conical_defect(mesh).max() <= angle)
    circular = bool(circular_defect(mesh).max() <= angle)
    flat = bool(np.abs(dihedral_angles(mesh)).max() <= angle)
    stars = has_inner and bool(star_defect(mesh).max() <= np.radians(NET_STAR_DEG))
    sides = quads and bool(chebyshev_defect(mesh).max() <= NET_SIDES_PERCENT)
    skew = quads and not planar
    # Parallel to a Koebe net; one itself.
    curved = planar and has_inner and not flat and not triangles
    offset, koebe = edge_offset_kinds(mesh, NET_EDGE_OFFSET) if curved else (False, False)
    four = bool((~mesh.boundary_vertex & (mesh.valences == 4)).any())
    isothermic = quads and four and bool(isothermic_defect(mesh).max() <= NET_ISOTHERMIC)
    translated = quads and bool(translation_defect(mesh).max() <= NET_SIDES_PERCENT)
    found = {
        "flat": planar and flat,
        "conical": planar and conical and not flat and not triangles,
        "circular": planar and circular and not triangles,
        "planar": planar and not triangles,
        "Koebe": koebe,
        "edge-offset": offset,
        "isothermic": planar and circular and isothermic,
        "translation": translated,
        "K-net": skew and stars and sides,
        "A-net": skew and stars,
        "Chebyshev": sides,
        "equal-angle-sums": skew and circular and conical,
        "quad": quads,
        "triangle": triangles,
        "polygon": not quads and not triangles,
    }
    return tuple(name for name, holds in found.items() if holds)


@checked
def kind_words(mesh: Mesh, names: tuple[str, ...] | None = None) -> str:
    """One line for people: the kind of net, its polygons, how planar it is, what else it is."""
    names = kind_names(mesh) if names is None else names
    also = [words for name, words in _ALSO.items() if name in names]
    if "Koebe" in names:
        also.remove(_ALSO["edge-offset"])
    return "; ".join([_main_words(mesh, names), *also])


_ALSO = {
    "Koebe": "Koebe net (edges touch one sphere)",
    "edge-offset": "parallel to a Koebe net (edge offset)",
    "isothermic": "isothermic",
    "translation": "translation net",
}


def _main_words(mesh: Mesh, names: tuple[str, ...]) -> str:
    percent = float(planarity_percent(mesh).max())
    polygons = "quads" if "quad" in names else "polygons"
    planar = f"{polygons}, planar to {percent:.2g} %"
    if "triangle" in names:
        return "flat triangle mesh" if "flat" in names else "triangle mesh"
    if "flat" in names:
        return f"flat mesh ({planar})"
    if "conical" in names:
        both = "conical and circular net" if "circular" in names else "conical net"
        return f"{both} ({planar})"
    if "circular" in names:
        return f"circular net ({planar})"
    if "planar" in names:
        quads = "planar quad mesh (PQ mesh, conjugate net; planar to"
        many = "planar polygon mesh (planar to"
        return f"{quads if 'quad' in names else many} {percent:.2g} %)"
    skew = f"not planar, up to {percent:.2g} %"
    if "K-net" in names:
        return f"K-net: A-net along asymptotic lines, opposite sides equal (quads, {skew})"
    if "A-net" in names:
        return f"A-net along asymptotic lines (quads, {skew})"
    if "Chebyshev" in names:
        return f"Chebyshev net: opposite sides equal (quads, {skew})"
    if "equal-angle-sums" in names:
        return f"quad mesh with equal sums of opposite angles at faces and vertices, but {skew}"
    return f"general {'quad' if 'quad' in names else 'polygon'} mesh, {skew}"


@checked
def not_a_disk(mesh: Mesh) -> str:
    """What keeps a mesh from being one piece with one boundary and no handles; empty for a disk."""
    pieces = int(mesh.components.max()) + 1
    if pieces > 1:
        return f"{pieces} pieces; one is needed"
    euler = int((mesh.valences > 0).sum()) - mesh.n_edges + mesh.n_faces
    if len(mesh.boundary_loops) != 1 or euler != 1:
        return (
            f"{len(mesh.boundary_loops)} rims, Euler characteristic {euler}; a disk with one rim "
            "is needed: cut it open, or fill its holes"
        )
    return ""
