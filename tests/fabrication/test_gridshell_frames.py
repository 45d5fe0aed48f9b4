"""Frames of beams: cuts that hold the node axes, with torsion or none; how steep they may be."""

from __future__ import annotations

import numpy as np
import pytest
from roofs import barrel

from ddgfab.errors import DetailError
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Mesh, unit
from fabrication.gridshell.detailing.frames import NAMED, edge_frames


def square() -> Mesh:
    return Mesh.build([[0.0, 0, 0], [900, 0, 0], [900, 900, 0], [0, 900, 0]], [[0, 1, 2, 3]])


def leaning(degrees: float) -> np.ndarray:
    """Axes of the square, all turned along its first side."""
    angle = np.radians(degrees)
    return np.tile([np.sin(angle), 0.0, np.cos(angle)], (4, 1))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_axes_may_lean_by_75_degrees_along_a_beam(side: float) -> None:
    frames = edge_frames(square(), leaning(74.9 * side))
    assert np.degrees(np.arctan(np.abs(frames.slope).max())) == pytest.approx(74.9)
    with pytest.raises(DetailError, match=r"at 75\.1 deg") as caught:
        edge_frames(square(), leaning(75.1 * side))
    assert "at most 75 deg" in str(caught.value)


def test_of_many_steep_beams_a_few_are_named() -> None:
    mesh = grid_mesh(np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0), [0.0]), axis=-1)[:, :, 0])
    with pytest.raises(DetailError) as caught:
        edge_frames(mesh, np.tile([0.99, 0.0, np.sqrt(1 - 0.99**2)], (16, 1)))
    text = str(caught.value)
    assert text.count("meets the plane") == NAMED == 5
    assert f"and {2 * 12 - NAMED} more" in text  # both ends of the 12 edges along x


@pytest.mark.parametrize("torsion", [0.0, 0.1, 0.3])
def test_every_cut_holds_the_axis_and_what_is_across_axis_and_edge(torsion: float) -> None:
    """Two directions span the plane of a flat cut, in whatever frame it is written."""
    mesh = barrel()
    rng = np.random.default_rng(1)
    axes = unit(mesh.vertex_normals + torsion * rng.normal(size=mesh.vertices.shape))
    frames = edge_frames(mesh, axes)
    assert frames.twisted == (torsion > 0)
    for end in (0, 1):
        normal = (
            frames.x - frames.skew[:, end, None] * frames.y - frames.slope[:, end, None] * frames.z
        )
        axis = axes[mesh.edges[:, end]]
        limit = 1e-8 if torsion else 2e-3  # what torsion is left in the vertex normals is ignored
        for inside in (axis, unit(np.cross(axis, frames.x))):
            assert np.abs(np.einsum("ei,ei->e", normal, inside)).max() < limit
