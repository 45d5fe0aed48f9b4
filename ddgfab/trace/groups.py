"""Groups of a traced mesh by tag: what rules of projects and other programs select."""

from __future__ import annotations

import numpy as np

from ddgfab.arguments import checked
from ddgfab.io.groups import Groups
from ddgfab.mesh import Ints, Mesh
from ddgfab.trace.mesh import TAGS


@checked
def tag_groups(mesh: Mesh, tag: Ints) -> Groups:
    """Groups inner, rim and corner of a mesh with tags.

    Parameters
    ----------
    tag : (V,) index into `TAGS` of each vertex

    Returns
    -------
    Groups: rim with the vertices and edges of the boundary, corners too; corner with vertices only;
    inner with the other vertices and the edges between them.
    """
    at, used = np.asarray(tag), mesh.valences > 0
    inner = (at == TAGS.index("inner")) & used
    return Groups.of(
        {
            "rim": (np.flatnonzero((at > 0) & used), mesh.edges[mesh.boundary_edge]),
            "corner": (np.flatnonzero(at == TAGS.index("corner")), []),
            "inner": (np.flatnonzero(inner), mesh.edges[inner[mesh.edges].all(axis=1)]),
        }
    )
