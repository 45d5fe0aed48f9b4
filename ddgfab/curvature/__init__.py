"""Curvature: from the metric alone, of smooth surfaces, nets and meshes."""

from __future__ import annotations

from ddgfab.curvature.intrinsic import (
    MetricJet,
    brioschi,
    gauss_curvature,
    metric_of,
    net_curvature,
)
from ddgfab.curvature.skew import knet_curvature, skew_curvature, unit_curvature_scale

__all__ = [
    "MetricJet",
    "brioschi",
    "gauss_curvature",
    "knet_curvature",
    "metric_of",
    "net_curvature",
    "skew_curvature",
    "unit_curvature_scale",
]
