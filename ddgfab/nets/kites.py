"""The net of kites of an s-isothermic net: vertices, contact points and centers of incircles.

Every corner of a face gives a kite with right angles at its two contact points. Kites have the
cross-ratio -1, so they make an isothermic net, and Christoffel's dual of it is the kite net of the
dual s-isothermic net. Source: Bobenko, Pinkall 1999; mathematics.md 6.2, 7.4.
"""

from __future__ import annotations

import numpy as np

from ddgfab.arguments import checked
from ddgfab.mesh import Mesh
from ddgfab.nets.sisothermic import SIsothermic


@checked
def kite_net(net: SIsothermic) -> Mesh:
    """Mesh of kites (vertex, contact point, center of the incircle, contact point).

    Its vertices are the V vertices of the net, its E contact points in the order of the edges and
    its F centers in the order of the faces; one face for each corner, in the corners' order. Edges
    at a contact point with the label s of its edge carry s towards vertices and -s towards centers
    in Christoffel's dual: Delta x* = s Delta x / |Delta x|^2.

    Source: mathematics.md 6.2, 7.4, (16)-(18) of the survey in section 13.
    """
    mesh = net.mesh
    points = np.concatenate([mesh.vertices, net.contacts, net.incircles.centers])
    contact = mesh.n_vertices + mesh.corner_edge
    before = np.empty_like(mesh.corner_next)
    before[mesh.corner_next] = np.arange(len(before))
    center = mesh.n_vertices + mesh.n_edges + mesh.corner_face
    faces = np.stack([mesh.corners, contact, center, contact[before]], axis=1)
    return Mesh.build(points, faces)
