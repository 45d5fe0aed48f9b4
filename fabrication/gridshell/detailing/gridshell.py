"""Gridshell: the whole structure as specs, and the one function that details it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Mesh
from fabrication.gridshell.detailing.arm_room import arm_width, close_arms
from fabrication.gridshell.detailing.beams import beam_specs, end_cuts
from fabrication.gridshell.detailing.clearance import panel_offset, steel_heights
from fabrication.gridshell.detailing.connections import registry as connections
from fabrication.gridshell.detailing.connections.base import Joined
from fabrication.gridshell.detailing.connections.bolts import bolt_specs, fastener_pieces
from fabrication.gridshell.detailing.frames import Axes, arms_of, edge_frames, node_mark
from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
from fabrication.gridshell.detailing.nodes.heights import end_heights, node_ends
from fabrication.gridshell.detailing.nodes.pieces import node_specs
from fabrication.gridshell.detailing.nodes.registry import find
from fabrication.gridshell.detailing.panels import face_planes, not_flat, panel_specs
from fabrication.gridshell.detailing.sections import beam_sections
from fabrication.gridshell.load import make_project
from fabrication.gridshell.pieces import Beam, Bolt, FastenerPiece, Node, Panel
from fabrication.gridshell.project import Project
from fabrication.specs import Check, Piece

BOLTED_TOLERANCE: Final = 0.002
"""Greatest deviation [mm] within a part number where bolts join parts: their holes agree within
0.01 mm."""


@dataclass(frozen=True, eq=False, repr=False)
class Gridshell:
    """Beams, nodes and panels of a mesh and its node axes, before any CAD.

    Attributes
    ----------
    mesh : the mesh, in mm
    support : the structure that carries the node axes
    project : the settings
    beams, nodes, panels : the pieces, by edge, vertex and face
    size : the dimensions that all nodes share, and the node that forces them
    offset : the panes' inner surface above the faces [mm]
    problems : what was found beyond single parts, one sentence each
    joined : what all connections of beams to nodes share
    bolts : the bolts and studs, by node and arm
    """

    mesh: Mesh
    support: Axes
    project: Project
    beams: tuple[Beam, ...]
    nodes: tuple[Node, ...]
    panels: tuple[Panel, ...]
    size: NodeSize
    offset: float
    problems: tuple[str, ...]
    joined: Joined
    bolts: tuple[Bolt, ...]

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """All pieces: beams, nodes, panels; fasteners where the project wants them as parts."""
        return (*self.beams, *self.nodes, *self.panels, *self.fasteners)

    @cached_property
    def fasteners(self) -> tuple[FastenerPiece, ...]:
        """Fasteners as pieces, where the project wants them as parts."""
        return fastener_pieces(self.bolts) if self.project.connection.fasteners else ()

    @property
    def family_tolerance(self) -> float:
        """Within which [mm] pieces share a part number: holes of bolts agree more closely."""
        tolerance = self.project.checks.family_tolerance_mm
        return min(tolerance, BOLTED_TOLERANCE) if self.bolts else tolerance

    def failures(self) -> Iterator[tuple[str, Check]]:
        """Marks and checks of the pieces beyond a limit of the project."""
        for piece in self.pieces:
            for check in piece.checks:
                if not check.passed:
                    yield piece.mark, check

    def __repr__(self) -> str:
        torsion = np.degrees(max(beam.torsion for beam in self.beams))
        lean = np.degrees(max(node.lean for node in self.nodes))
        return (
            f"Gridshell({len(self.beams)} beams {self.project.beam.section().name}, "
            f"{len(self.nodes)} nodes d {2 * self.size.radius:g} mm "
            f"(forced by {node_mark(self.size.forced_by)}), {len(self.panels)} panels, "
            f"torsion {torsion:.1e} deg, lean {lean:.1f} deg, "
            f"{sum(1 for _ in self.failures())} limits exceeded)"
        )


def detail(mesh: Mesh, support: Axes, project: Project | None = None) -> Gridshell:
    """Beams, nodes and panels of a mesh [mm] with unit node axes, by the rules of docs/parts.md.

    Parameters
    ----------
    support : anything with `axes` (V, 3), on the outer side of the faces
    project : the settings; None means all defaults

    Raises
    ------
    DetailError
        A part cannot be made: nodes too small, beams too short, panes used up.
        What merely exceeds a limit of the project is a failing check of its piece instead.

    Source: docs/parts.md, Beam, Node element, Panel.
    """
    project = make_project({}) if project is None else project
    axes = np.asarray(support.axes, dtype=np.float64)
    if axes.shape != mesh.vertices.shape:
        raise DetailError(f"node axes have shape {axes.shape}; expected {mesh.vertices.shape}")
    profile = project.beam.section()
    frames = edge_frames(mesh, axes)
    arms = arms_of(mesh, axes, frames)
    connection = connections.find(project.connection.kind).of(project)
    sections = beam_sections(mesh, project)
    width = max(
        max(arm_width(frames, section, project), connection.arm_width(section))
        for section in sections.profiles
    )
    joints = Joints(frames, arms, width, profile, project, connection)
    connection.check(joints)
    size = find(project.node.kind).fit(joints)
    joined = connection.fit(joints, size)
    cuts = end_cuts(frames, size, project.beam.eccentricity_mm)
    beams = beam_specs(mesh, frames, cuts, size, sections, joined, project)
    low, middle, high = end_heights(frames, arms, size, sections, project)
    low = np.minimum(low, middle - 0.5 * joined.cover)
    high = np.maximum(high, middle + 0.5 * joined.cover)
    ends = size.ends(joints, *node_ends(mesh, arms, low, high, project))
    nodes = node_specs(mesh, axes, joints, size, joined, ends, middle)
    bolts = bolt_specs(mesh, axes, joints, size, joined, middle)
    panels: tuple[Panel, ...] = ()
    offset, problem = 0.0, None
    if project.panel.kind != "none":
        planes = face_planes(mesh)
        heights = steel_heights(mesh, axes, planes, frames, ends[1], size, sections, project)
        offset, problem = panel_offset(heights, project)
        panels = panel_specs(mesh, planes, frames, offset, project)
    close = close_arms(arms, project.checks.min_angle_deg)
    found = (close, problem, not_flat(mesh, panels))
    problems = tuple(sentence for sentence in found if sentence is not None)
    return Gridshell(
        mesh, support, project, beams, nodes, panels, size, offset, problems, joined, bolts
    )
