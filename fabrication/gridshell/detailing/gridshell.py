"""Gridshell: the whole structure as specs, and the one function that details it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.io import Groups
from ddgfab.mesh import Mesh
from fabrication.gridshell.detailing.arm_room import close_arms
from fabrication.gridshell.detailing.beams import beam_specs, end_cuts
from fabrication.gridshell.detailing.clearance import panel_offset, steel_heights
from fabrication.gridshell.detailing.connections.base import Joined
from fabrication.gridshell.detailing.connections.bolts import fastener_pieces
from fabrication.gridshell.detailing.frames import Axes, arms_of, edge_frames, node_mark
from fabrication.gridshell.detailing.ground import grounded
from fabrication.gridshell.detailing.joining import Place, ends_of, joined_places, nodes_and_bolts
from fabrication.gridshell.detailing.nodes.base import NodeSize
from fabrication.gridshell.detailing.panels import face_planes, not_flat, panel_specs
from fabrication.gridshell.detailing.places import NO_GROUPS, Net, rules_of_nodes
from fabrication.gridshell.detailing.sections import beam_sections
from fabrication.gridshell.load import make_project
from fabrication.gridshell.pieces import (
    Anchor,
    Base,
    Beam,
    Bolt,
    FastenerPiece,
    Node,
    Panel,
)
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
    places : the nodes of each rule: their size, and how beams are joined to them
    offset : the panes' inner surface above the faces [mm]
    problems : what was found beyond single parts, one sentence each
    bolts : the bolts and studs, by node and arm
    groups : named vertices and edges of the mesh, which rules may select
    bases, anchors : base plates under the supports, and their anchors
    """

    mesh: Mesh
    support: Axes
    project: Project
    beams: tuple[Beam, ...]
    nodes: tuple[Node, ...]
    panels: tuple[Panel, ...]
    places: tuple[Place, ...]
    offset: float
    problems: tuple[str, ...]
    bolts: tuple[Bolt, ...]
    groups: Groups = NO_GROUPS
    bases: tuple[Base, ...] = ()
    anchors: tuple[Anchor, ...] = ()

    @property
    def size(self) -> NodeSize:
        """Dimensions of the nodes without a rule of their own, and the node that forces them."""
        return self.places[0].size

    @property
    def joined(self) -> Joined:
        """What the connections of the first profile to these nodes share."""
        return self.places[0].each[0][1]

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """All pieces: beams, nodes, base plates, panels, and fasteners that are to be parts."""
        return (*self.beams, *self.nodes, *self.bases, *self.panels, *self.fasteners)

    @cached_property
    def fasteners(self) -> tuple[FastenerPiece, ...]:
        """Fasteners as pieces, where the project wants them as parts."""
        bolts = self.bolts if self.project.connection.fasteners else ()
        anchors = self.anchors if self.project.ground.fasteners else ()
        return fastener_pieces((*bolts, *anchors))

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


def detail(
    mesh: Mesh, support: Axes, project: Project | None = None, groups: Groups = NO_GROUPS
) -> Gridshell:
    """Beams, nodes and panels of a mesh [mm] with unit node axes, by the rules of docs/parts.md.

    Parameters
    ----------
    support : anything with `axes` (V, 3), on the outer side of the faces
    project : the settings; None means all defaults
    groups : named vertices and edges of the mesh, which rules may select

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
    net = Net(mesh, groups, project.ground)
    frames = edge_frames(mesh, axes)
    arms = arms_of(mesh, axes, frames)
    sections = beam_sections(net, project)
    rules = (
        rules_of_nodes(net, project.node.rules),
        rules_of_nodes(net, project.connection.rules, "connection"),
    )
    places = joined_places(frames, arms, sections, project, rules)
    ends = ends_of(places, mesh)
    cuts = end_cuts(frames, ends.cut, project.beam.eccentricity_mm)
    beams = beam_specs(mesh, frames, cuts, ends, sections, project)
    fitted = nodes_and_bolts(mesh, axes, places, sections)
    bases, anchors = grounded(
        mesh, axes, frames, arms, sections, places, fitted, net.supports, project
    )
    panels: tuple[Panel, ...] = ()
    offset, problem = 0.0, None
    if project.panel.kind != "none":
        planes = face_planes(mesh)
        heights = steel_heights(
            mesh, axes, planes, frames, fitted.tops, fitted.radii, sections, project
        )
        offset, problem = panel_offset(heights, project)
        panels = panel_specs(mesh, planes, frames, offset, project)
    close = close_arms(arms, project.checks.min_angle_deg)
    found = (close, problem, not_flat(mesh, panels))
    problems = tuple(sentence for sentence in found if sentence is not None)
    return Gridshell(
        mesh,
        support,
        project,
        beams,
        fitted.nodes,
        panels,
        places,
        offset,
        problems,
        fitted.bolts,
        groups,
        bases,
        anchors,
    )
