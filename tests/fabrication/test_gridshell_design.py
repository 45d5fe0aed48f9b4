"""Designs from Python: arrays in any unit, names, and what a notebook shows."""

from __future__ import annotations

import numpy as np
import pytest
from roofs import barrel

from ddgfab.errors import DdgError
from fabrication.gridshell.design import Design, design


def test_arrays_in_metres_are_the_same_roof() -> None:
    mesh = barrel()
    one = design(mesh, project={"name": "roof"})
    faces = [face.tolist() for face in mesh.faces]
    two = design((mesh.vertices / 1000, faces), project={"name": "roof", "units": "m"})
    assert repr(one) == repr(two)
    np.testing.assert_allclose(one.mesh.vertices, two.mesh.vertices, atol=1e-9)


def test_a_given_mesh_is_called_so(small_design: Design) -> None:
    assert "given in Python" in repr(design(barrel()))
    settings = small_design.project.settings["net"]
    assert settings["file"] is None
    assert "given" in settings["kind"]


def test_sections_change_a_built_in_project() -> None:
    roof = design(net={"panels_along": 6, "panels_across": 4}, beam={"profile": "FL 60x8"})
    assert len(roof.panels) == 24
    assert {row["profile"] for row in roof.beams} == {"FL 60x8"}


def test_unknown_sections_and_tiny_meshes_are_refused() -> None:
    with pytest.raises(DdgError, match="beam"):
        design(barrel(), bem={"profile": "FL 60x8"})
    with pytest.raises(DdgError, match="median edge"):
        design(barrel().scaled(1e-3))


def test_solids_are_labelled_and_placed(small_design: Design) -> None:
    """build123d and cadquery objects hold the same volume where the schedule says it is."""
    compound = small_design.to_build123d()
    labels = {leaf.label for group in compound.children for leaf in group.children}
    assert labels == {piece.mark for piece in small_design.gridshell.pieces}
    mass = sum(small_design.schedules["bom"].column("mass_kg"))
    density = {"Beams": 7850.0, "Nodes": 7850.0, "Panels": 2500.0}
    weighed = sum(density[g.label] * g.volume * 1e-9 for g in compound.children)
    assert weighed == pytest.approx(mass, rel=1e-6)
    assembly = small_design.to_cadquery()
    assert assembly.toCompound().Volume() == pytest.approx(compound.volume, rel=1e-9)
    node = small_design.gridshell.nodes[5]
    where = assembly.objects[node.mark].loc.toTuple()[0]
    np.testing.assert_allclose(where, node.position, atol=1e-6)


def test_a_notebook_shows_a_picture(small_design: Design) -> None:
    assert small_design._repr_png_().startswith(b"\x89PNG")
