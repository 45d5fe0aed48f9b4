"""Order data: what holds for all parts of a kind, where it comes from, and what is not stated."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fabrication.gridshell.bolt_lists import class_of
from fabrication.gridshell.detailing.connections import registry as connections
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.detailing.joining import Place
from fabrication.gridshell.detailing.nodes.base import Joints
from fabrication.gridshell.part_settings import ConnectionSettings, PanelSettings
from fabrication.gridshell.project import Project
from fabrication.gridshell.schedules.common import Detailed, Row
from fabrication.gridshell.schedules.panels import EDGE_WORK
from fabrication.gridshell.where import shown
from fabrication.parts.beam import BEAM
from fabrication.parts.node import NODE
from fabrication.parts.panel import PANEL
from fabrication.project.sections import one_line
from fabrication.project.statements import Statements
from fabrication.specs import Role
from fabrication.standards.fasteners import property_class
from fabrication.standards.ordering import (
    bar_tolerances,
    node_tolerances,
    pane_tolerances,
    profile_standard,
)


def order_rows(gridshell: Gridshell) -> list[Row]:
    """Statements for the orders of panes, bars, nodes and fasteners."""
    rows = [*_beams(gridshell), *_nodes(gridshell), *_connection(gridshell)]
    return [*_panes(gridshell), *rows] if gridshell.panels else rows


def tolerances(project: Project) -> dict[Role, str]:
    """Tolerances of parts by role: those of the project, or of what they are made of."""
    beam, panel = project.beam, project.panel
    usual = bar_tolerances(beam.material, beam.clearance_mm)
    return {
        BEAM.role: one_line(beam.tolerances) or usual,
        NODE.role: one_line(project.node.tolerances) or node_tolerances(),
        PANEL.role: one_line(panel.tolerances) or pane_tolerances(panel.build_up),
    }


def _panes(gridshell: Gridshell) -> Iterator[Row]:
    project = gridshell.project
    panel, of = project.panel, Statements("panes", "panel", project.panel)
    if panel.build_up:
        yield of.row("build-up from the outside inwards", panel.build_up, "build_up")
    else:
        yield of.row("build-up", f"one pane, {panel.thickness_mm:g} mm", "thickness_mm")
    yield of.row("glass, heat treatment, coatings, standards", panel.grade, "grade")
    for where, key, work in (
        ("between panes", "edge_work", panel.edge_work),
        ("at the boundary", "edge_work_boundary", panel.edge_work_boundary),
    ):
        yield of.row(f"edges {where}", f"{work} ({EDGE_WORK[work]}), EN 12150-1", key)
    sides = "square to the pane" if panel.edge == "square" else "bevelled as in the list of panels"
    yield of.row("sides", sides, "edge")
    yield of.row("corners", _corners(panel), "corner_radius_mm")
    if panel.panes > 1:
        stand = f"{panel.step_mm:g} mm behind the outer one" if panel.step_mm else "flush"
        yield of.row("inner panes at the boundary", stand, "step_mm")
    yield of.row("holes and notches", "none", "kind")
    yield of.row("tolerances", tolerances(project)[PANEL.role], "tolerances")
    stock, cut = project.stock, Statements("panes", "stock", project.stock)
    sheet = " x ".join(f"{side:g}" for side in stock.glass())
    yield cut.row("estimate of glass: sheets of stock", f"{sheet} mm", "glass_mm")
    trim, land = f"{stock.glass_trim_mm:g} mm", f"{stock.glass_gap_mm:g} mm"
    yield cut.row("estimate of glass: off each edge of a sheet", trim, "glass_trim_mm")
    yield cut.row("estimate of glass: between two panes", land, "glass_gap_mm")
    gap, between = f"{panel.gap_mm:g} mm ({panel.gap_at})", Statements("joints", "panel", panel)
    yield between.row("gap between panes", gap, "gap_mm")
    above = f"{gridshell.offset:g} mm above the faces of the mesh"
    yield between.row("inner surface of the panes", above, "offset_mm")
    joint, at = project.joint, Statements("joints", "joint", project.joint)
    yield at.row("gasket inside", joint.gasket, "gasket")
    yield at.row("clamp", joint.clamp, "clamp")
    yield at.row("cap outside", joint.cap, "cap")


def _corners(panel: PanelSettings) -> str:
    radius = panel.corner_radius_mm
    return f"rounded, radius {radius:g} mm" if radius else "not rounded"


def _beams(gridshell: Gridshell) -> Iterator[Row]:
    project = gridshell.project
    beam, of = project.beam, Statements("beams", "beam", project.beam)
    found = {joints.profile.name: joints.profile for joints in _joints(gridshell)}
    for section in found.values():
        standard = profile_standard(section, beam.material)
        name = f"{section.name}, depth {section.depth:g} x width {section.width:g} mm"
        yield of.row("profile", f"{name}, {standard}" if standard else name, "profile")
    yield of.row("material", beam.material, "material")
    yield of.row("grade, surface", beam.grade, "grade")
    ends = "coped to the cylinders of the nodes" if beam.end == "cope" else "plane"
    yield of.row("cuts", ends, "end")
    clearance = f"{beam.clearance_mm:g} mm at each end"
    yield of.row("clearance to the nodes", clearance, "clearance_mm")
    yield of.row("tolerances", tolerances(project)[BEAM.role], "tolerances")
    stock, cut = project.stock, Statements("beams", "stock", project.stock)
    yield cut.row("cut list: width of a cut", f"{stock.kerf_mm:g} mm", "kerf_mm")
    yield cut.row("cut list: off each end of a bar", f"{stock.trim_mm:g} mm", "trim_mm")


def _joints(gridshell: Gridshell) -> Iterator[Joints]:
    for place in gridshell.places:
        for joints, _, _ in place.each:
            yield joints


def _nodes(gridshell: Gridshell) -> Iterator[Row]:
    node = gridshell.project.node
    of = Statements("nodes", "node", node)
    for kind, text in {
        place.joints.project.node.kind: place.size.summary for place in gridshell.places
    }.items():
        yield of.row("made of", text or kind, "kind")
    yield of.row("grade, surface", node.grade, "grade")
    marks = (
        piece.shape.details() for piece in gridshell.nodes if isinstance(piece.shape, Detailed)
    )
    holes = {(m["mark_diameter_mm"], m["mark_depth_mm"]) for m in marks if "mark_depth_mm" in m}
    found = ", ".join(f"diameter {wide:g} mm, depth {deep:g} mm" for wide, deep in sorted(holes))
    if found:
        yield of.row("blind hole that marks azimuth 0", found, "kind")
    yield of.row("tolerances", tolerances(gridshell.project)[NODE.role], "tolerances")


def _connection(gridshell: Gridshell) -> Iterator[Row]:
    whole = gridshell.project.connection
    for number in dict.fromkeys(place.rule for place in gridshell.places):
        places = [place for place in gridshell.places if place.rule == number]
        where = f" at {shown(whole.rules[number - 1].where)}" if number else ""
        yield from _connection_of(whole.of_rule(number), places, where)
    if not gridshell.bolts:
        return
    of, made = Statements("connections", "connection", whole), property_class(whole.bolt_class)
    shapes = (mounted.shape for bolt in gridshell.bolts for mounted in bolt.mounted)
    classes = dict.fromkeys(f"{shape.kind}s {class_of(shape, made)}" for shape in shapes)
    yield of.row("property classes and hardness", ", ".join(classes), "bolt_class")
    yield of.row("coating and tightening of fasteners", whole.grade, "grade")


def _connection_of(
    connection: ConnectionSettings, places: Sequence[Place], where: str
) -> Iterator[Row]:
    """Statements about the connections of one rule."""
    of = Statements(f"connections{where}", "connection", connection)
    kind = connections.find(connection.kind)
    yield of.row("kind", f"{connection.kind}: {kind.summary}", "kind")
    throats = {how.weld for place in places for _, how, _ in place.each}
    if any(place.size.welded for place in places):
        throats.add(connection.weld_mm)
    if welds := sorted(weld for weld in throats if weld is not None):
        found = ", ".join(f"{weld:g}" for weld in welds)
        yield of.row("throat of fillet welds", f"{found} mm", "weld_mm")
    if any(how.mounted for place in places for _, how, _ in place.each):
        yield of.row("thread", f"{connection.bolt}, coarse (ISO 261)", "bolt")
