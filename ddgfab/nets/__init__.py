"""Nets: functions on arrays of shape (M + 1, N + 1, 3), and the generated example."""

from __future__ import annotations

from ddgfab.nets.axes import vertex_normals
from ddgfab.nets.canopy import canopy
from ddgfab.nets.circular import circularity
from ddgfab.nets.grid import grid_mesh
from ddgfab.nets.monge import monge, profile_polyline

__all__ = ["canopy", "circularity", "grid_mesh", "monge", "profile_polyline", "vertex_normals"]
