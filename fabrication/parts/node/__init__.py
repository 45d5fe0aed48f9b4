"""Nodes: a cylinder or tube with milled seats, radial holes and a mark that gives azimuth 0."""

from __future__ import annotations

from fabrication.parts.node.shape import NODE, NodeShape, RadialHole, ReferenceMark, Seat

__all__ = ["NODE", "NodeShape", "RadialHole", "ReferenceMark", "Seat"]
