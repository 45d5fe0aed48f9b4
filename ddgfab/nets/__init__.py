"""Nets: functions on arrays of shape (n1, ..., nd, dim), and the generated example.

A class of nets a module: what it is (measures), how it evolves, how it is generated.
"""

from __future__ import annotations

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
from ddgfab.nets.canal import canal_circles, canal_net
from ddgfab.nets.canopy import canopy
from ddgfab.nets.circles import Circles, Spheres
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
from ddgfab.nets.grid import grid_mesh
from ddgfab.nets.isothermic import (
    cross_ratio_labels,
    evolve_isothermic,
    isothermic_point,
    isothermic_residuals,
)
from ddgfab.nets.knet import CauchyData, KNet, knet, oriented_angle
from ddgfab.nets.knet_amsler import amsler
from ddgfab.nets.knet_angles import (
    angle_coefficient,
    angle_relation_defect,
    chi_of_phi,
    evolve_hirota,
    hirota_potential,
    hirota_residual,
    product_defect,
    quad_angles,
    vertex_angle_defect,
)
from ddgfab.nets.knet_breather import breather
from ddgfab.nets.knet_crab import CrabNet, crab_net, string_forces, string_tensions
from ddgfab.nets.knet_dini import dini, pseudosphere, vacuum
from ddgfab.nets.knet_evolve import evolve_spherical, spherical_fourth
from ddgfab.nets.knet_kuen import kuen
from ddgfab.nets.knet_quad import SkewParallelogram, skew_parallelogram
from ddgfab.nets.knet_recover import KNetRecovery, knet_from_mesh, recover_knet
from ddgfab.nets.koebe import KoebePolyhedron, koebe
from ddgfab.nets.koebe_grids import catenoid_koebe, enneper_koebe, koebe_vertex
from ddgfab.nets.layers import common_transform, lattice, sample, stack_transforms
from ddgfab.nets.minimal import MinimalNet, catenoid, enneper, helicoid, minimal_surface
from ddgfab.nets.minimal_cells import scherk, schwarz_d, schwarz_p, schwarz_p_cell
from ddgfab.nets.miquel import (
    evolve_circular,
    evolve_circular_by_angles,
    miquel_point,
    sphere_defect,
)
from ddgfab.nets.monge import monge, profile_polyline
from ddgfab.nets.moulding import moulding_net
from ddgfab.nets.moutard import (
    evolve_moutard,
    evolve_tnet,
    moutard_coefficients,
    moutard_cube,
    star_triangle,
)
from ddgfab.nets.registry import generate, kinds
from ddgfab.nets.rotational import rotational_net
from ddgfab.nets.sisothermic import SIsothermic, dual, dual_face
from ddgfab.nets.sisothermic_labels import double_cover, label_edges, piece
from ddgfab.nets.translation import translation_net

__all__ = [
    "CauchyData",
    "Circles",
    "CrabNet",
    "KNet",
    "KNetRecovery",
    "KoebePolyhedron",
    "MinimalNet",
    "SIsothermic",
    "SkewParallelogram",
    "Spheres",
    "amsler",
    "anet_from_moutard",
    "angle_balance",
    "angle_coefficient",
    "angle_relation_defect",
    "angle_sum_defect",
    "axis_coplanarity",
    "axis_intersections",
    "best_normal",
    "breather",
    "canal_circles",
    "canal_net",
    "canopy",
    "catenoid",
    "catenoid_koebe",
    "chi_of_phi",
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
    "conical_residuals",
    "conical_to_circular",
    "conj_coeffs",
    "conj_residual",
    "conjugate_residuals",
    "coordinate_surfaces",
    "crab_net",
    "cross_ratio",
    "cross_ratio_labels",
    "cross_ratios",
    "cube_point",
    "cube_xi",
    "dini",
    "double_cover",
    "dual",
    "dual_face",
    "enneper",
    "enneper_koebe",
    "evolve_3d",
    "evolve_by_angles",
    "evolve_by_cross_ratio",
    "evolve_circular",
    "evolve_circular_by_angles",
    "evolve_conjugate",
    "evolve_hirota",
    "evolve_isothermic",
    "evolve_moutard",
    "evolve_nd",
    "evolve_spherical",
    "evolve_tnet",
    "face_normals",
    "fourth_by_angle",
    "fourth_by_t",
    "generate",
    "grid_mesh",
    "helicoid",
    "hirota_potential",
    "hirota_residual",
    "interior_angles",
    "isothermic_point",
    "isothermic_residuals",
    "kinds",
    "knet",
    "knet_from_mesh",
    "koebe",
    "koebe_vertex",
    "kuen",
    "label_edges",
    "lattice",
    "lelieuvre",
    "minimal_surface",
    "miquel_point",
    "monge",
    "moulding_net",
    "moutard_coefficients",
    "moutard_cube",
    "normals_closure",
    "oriented_angle",
    "phi",
    "phi_inverse",
    "piece",
    "planarity",
    "planarity_flagged",
    "product_defect",
    "profile_polyline",
    "pseudosphere",
    "quad_angles",
    "quad_volume_density",
    "quad_volumes",
    "recover_knet",
    "rotational_net",
    "sample",
    "scherk",
    "schwarz_d",
    "schwarz_p",
    "schwarz_p_cell",
    "seen_from_opposite",
    "skew_parallelogram",
    "sphere_defect",
    "spherical_fourth",
    "stack_transforms",
    "star_edges",
    "star_flatness",
    "star_triangle",
    "string_forces",
    "string_tensions",
    "tangent_normals",
    "translation_net",
    "vacuum",
    "vertex_angle_defect",
    "vertex_normals",
]
