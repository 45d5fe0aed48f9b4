"""Curvature: from the metric alone, of smooth surfaces, nets and meshes."""

from __future__ import annotations

from ddgfab.curvature.area_newton import area_hessian
from ddgfab.curvature.associated import AssociatedFamily, associated_family
from ddgfab.curvature.cotangent import (
    angle_defects,
    area_gradient,
    cotangent_laplacian,
    cotangent_mean_curvature,
    mean_curvature_vectors,
    mixed_vertex_areas,
    triangulate,
)
from ddgfab.curvature.intrinsic import (
    MetricJet,
    brioschi,
    gauss_curvature,
    metric_of,
    net_curvature,
)
from ddgfab.curvature.least_area import (
    LeastArea,
    minimize_area,
    minimize_area_along_normals,
)
from ddgfab.curvature.skew import knet_curvature, skew_curvature, unit_curvature_scale
from ddgfab.curvature.steiner import Curvatures, steiner_curvatures

__all__ = [
    "AssociatedFamily",
    "Curvatures",
    "LeastArea",
    "MetricJet",
    "angle_defects",
    "area_gradient",
    "area_hessian",
    "associated_family",
    "brioschi",
    "cotangent_laplacian",
    "cotangent_mean_curvature",
    "gauss_curvature",
    "knet_curvature",
    "mean_curvature_vectors",
    "metric_of",
    "minimize_area",
    "minimize_area_along_normals",
    "mixed_vertex_areas",
    "net_curvature",
    "skew_curvature",
    "steiner_curvatures",
    "triangulate",
    "unit_curvature_scale",
]
