"""Transformations that keep classes of nets."""

from __future__ import annotations

from ddgfab.transforms.moebius import invert, invert_normals

__all__ = ["invert", "invert_normals"]
