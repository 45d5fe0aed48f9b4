"""Classes of nets: functions on arrays of points of shape (n1, ..., nd, dim).

A class of nets is a module: its measures, how it evolves from initial data, and its partners. The
larger families are packages: `knet` (K-nets), `koebe` (Koebe polyhedra), `minimal` (discrete
minimal surfaces).
"""

from __future__ import annotations

from ddgfab.net import difference, shift
from ddgfab.nets.asymptotic import (
    anet_from_moutard,
    lelieuvre,
    star_edges,
    star_flatness,
    tangent_normals,
)
from ddgfab.nets.axes import (
    axis_coplanarity,
    axis_intersections,
    circle_axes,
    normals_closure,
    vertex_normals,
)
from ddgfab.nets.circular import (
    angle_sum_defect,
    circular_residuals,
    circularity,
    circumcircle,
    evolve_by_angles,
    evolve_by_cross_ratio,
    fourth_by_angle,
    fourth_by_t,
    interior_angles,
)
from ddgfab.nets.conical import (
    angle_balance,
    best_normal,
    circular_to_conical,
    cone_axes,
    cone_offsets,
    conical_determinant,
    conical_residuals,
    conical_to_circular,
    face_normals,
)
from ddgfab.nets.conical_planes import (
    conical_plane,
    contact_planes,
    contact_points,
    evolve_conical,
    evolve_conical_by_angles,
    net_planes,
    plane_meets,
    plane_residuals,
)
from ddgfab.nets.conjugate import (
    coefficients,
    conj_coeffs,
    conj_residual,
    conjugate_residuals,
    evolve_conjugate,
    planarity,
    planarity_flagged,
    quad_volume_density,
    quad_volumes,
)
from ddgfab.nets.crossratio import complex_cross_ratio, cross_ratio, cross_ratios
from ddgfab.nets.cubes import (
    coordinate_surfaces,
    cube_point,
    cube_xi,
    evolve_3d,
    evolve_nd,
    phi,
    phi_inverse,
    seen_from_opposite,
)
from ddgfab.nets.isothermic import (
    cross_ratio_labels,
    evolve_isothermic,
    isothermic_point,
    isothermic_residuals,
)
from ddgfab.nets.isothermic_layers import evolve_isothermic_nd
from ddgfab.nets.kites import kite_net
from ddgfab.nets.layers import common_transform, lattice, sample, stack_transforms
from ddgfab.nets.miquel import (
    evolve_circular,
    evolve_circular_by_angles,
    miquel_point,
    sphere_defect,
)
from ddgfab.nets.moutard import (
    evolve_moutard,
    evolve_tnet,
    moutard_coefficients,
    moutard_cube,
    star_triangle,
)
from ddgfab.nets.sisothermic import SIsothermic, dual, dual_face
from ddgfab.nets.sisothermic_labels import double_cover, label_edges, piece

__all__ = [
    "SIsothermic",
    "anet_from_moutard",
    "angle_balance",
    "angle_sum_defect",
    "axis_coplanarity",
    "axis_intersections",
    "best_normal",
    "circle_axes",
    "circular_residuals",
    "circular_to_conical",
    "circularity",
    "circumcircle",
    "coefficients",
    "common_transform",
    "complex_cross_ratio",
    "cone_axes",
    "cone_offsets",
    "conical_determinant",
    "conical_plane",
    "conical_residuals",
    "conical_to_circular",
    "conj_coeffs",
    "conj_residual",
    "conjugate_residuals",
    "contact_planes",
    "contact_points",
    "coordinate_surfaces",
    "cross_ratio",
    "cross_ratio_labels",
    "cross_ratios",
    "cube_point",
    "cube_xi",
    "difference",
    "double_cover",
    "dual",
    "dual_face",
    "evolve_3d",
    "evolve_by_angles",
    "evolve_by_cross_ratio",
    "evolve_circular",
    "evolve_circular_by_angles",
    "evolve_conical",
    "evolve_conical_by_angles",
    "evolve_conjugate",
    "evolve_isothermic",
    "evolve_isothermic_nd",
    "evolve_moutard",
    "evolve_nd",
    "evolve_tnet",
    "face_normals",
    "fourth_by_angle",
    "fourth_by_t",
    "interior_angles",
    "isothermic_point",
    "isothermic_residuals",
    "kite_net",
    "label_edges",
    "lattice",
    "lelieuvre",
    "miquel_point",
    "moutard_coefficients",
    "moutard_cube",
    "net_planes",
    "normals_closure",
    "phi",
    "phi_inverse",
    "piece",
    "planarity",
    "planarity_flagged",
    "plane_meets",
    "plane_residuals",
    "quad_volume_density",
    "quad_volumes",
    "sample",
    "seen_from_opposite",
    "shift",
    "sphere_defect",
    "stack_transforms",
    "star_edges",
    "star_flatness",
    "star_triangle",
    "tangent_normals",
    "vertex_normals",
]
