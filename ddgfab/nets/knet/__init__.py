"""K-nets: discrete surfaces of constant negative Gauss curvature."""

from __future__ import annotations

from ddgfab.nets.knet.amsler_net import amsler
from ddgfab.nets.knet.angles import (
    angle_coefficient,
    angle_relation_defect,
    chi_of_phi,
    evolve_hirota,
    hirota_potential,
    hirota_residual,
    knet_from_potential,
    product_defect,
    quad_angles,
    vertex_angle_defect,
)
from ddgfab.nets.knet.breather_net import breather
from ddgfab.nets.knet.crab import CrabNet, crab_net, string_forces, string_tensions
from ddgfab.nets.knet.dini_net import dini, pseudosphere, vacuum
from ddgfab.nets.knet.kuen_net import kuen
from ddgfab.nets.knet.net import CauchyData, KNet, knet
from ddgfab.nets.knet.oriented import oriented_angle
from ddgfab.nets.knet.quad import SkewParallelogram, skew_parallelogram
from ddgfab.nets.knet.recover import KNetRecovery, knet_from_mesh, recover_knet
from ddgfab.nets.knet.spherical import evolve_spherical, spherical_fourth

__all__ = [
    "CauchyData",
    "CrabNet",
    "KNet",
    "KNetRecovery",
    "SkewParallelogram",
    "amsler",
    "angle_coefficient",
    "angle_relation_defect",
    "breather",
    "chi_of_phi",
    "crab_net",
    "dini",
    "evolve_hirota",
    "evolve_spherical",
    "hirota_potential",
    "hirota_residual",
    "knet",
    "knet_from_mesh",
    "knet_from_potential",
    "kuen",
    "oriented_angle",
    "product_defect",
    "pseudosphere",
    "quad_angles",
    "recover_knet",
    "skew_parallelogram",
    "spherical_fourth",
    "string_forces",
    "string_tensions",
    "vacuum",
    "vertex_angle_defect",
]
