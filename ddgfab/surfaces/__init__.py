"""Smooth surfaces that the nets discretise: oracles of the tests and sources of nets."""

from __future__ import annotations

from ddgfab.surfaces.ellipsoid import (
    ellipsoid_curvatures,
    ellipsoid_normals,
    ellipsoid_patch,
    ellipsoid_umbilics,
)

__all__ = ["ellipsoid_curvatures", "ellipsoid_normals", "ellipsoid_patch", "ellipsoid_umbilics"]
