"""Several patches in one go: a net on each, lines that go on across their borders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
from scipy.spatial import cKDTree

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.trace.joining import JoinedMeshes, joined
from ddgfab.trace.recipe import Traced, trace
from ddgfab.trace.reference import reference_mesh
from ddgfab.trace.samples import Samples

_BORDER: Final = 0.05
"""Rims of two patches nearer than this [spacings] are one border."""


@dataclass(frozen=True, eq=False)
class Patches:
    """Nets on one or more patches, and the mesh of all of them.

    Attributes
    ----------
    surfaces, traced : one a patch
    tag : (V,) index into `ddgfab.trace.mesh.TAGS`; vertices of a border inside do not count as rim
    joints : sentences on the borders, and on what could not be kept together
    """

    surfaces: tuple[SplineSurface, ...]
    traced: tuple[Traced, ...]
    joined: JoinedMeshes
    tag: Ints
    joints: tuple[str, ...]
    spacing: float

    @property
    def mesh(self) -> Mesh:
        """The mesh of all patches."""
        return self.joined.mesh

    def remarks(self) -> tuple[str, ...]:
        """What a designer must know of each patch and of the borders."""
        many = len(self.surfaces) > 1
        rows = []
        for surface, one in zip(self.surfaces, self.traced, strict=True):
            head = f"{surface.name}: " if many else ""
            rows += [head + remark for remark in one.quality.remarks()]
        return (*rows, *self.joints)

    @cached_property
    def reference(self) -> Mesh:
        """The surfaces as fine meshes in one, what an optimisation stays near to."""
        parts = [
            reference_mesh(surface, one.traced)
            for surface, one in zip(self.surfaces, self.traced, strict=True)
        ]
        if len(parts) == 1:
            return parts[0]
        start = np.cumsum([0, *(part.n_vertices for part in parts)]).tolist()
        faces = [face + k for part, k in zip(parts, start, strict=False) for face in part.faces]
        return Mesh.build(np.concatenate([part.vertices for part in parts]), faces)


@checked
def trace_patches(
    surfaces: Sequence[SplineSurface], spacing: float | tuple[float, float], **ways: Any
) -> Patches:
    """A net on each of some patches, and one mesh of them.

    On a border the lines of a later patch end where those of an earlier one do. Where they do not
    meet, the vertex of one side becomes a corner of the face on the other; `joints` counts them.

    Parameters
    ----------
    ways : `along`, `turn`, `drawn`, `through` of `trace`; points and curves belong to the patch
        that they are nearest to

    Raises
    ------
    InputError, DegenerateError, MeshError
        As `trace`, and as `joined`.
    """
    if not surfaces:
        raise InputError("no surface is given; one or more are needed")
    least = float(min(spacing)) if isinstance(spacing, tuple) else float(spacing)
    shared = _split(surfaces, ways)
    found: list[Traced] = []
    for k, surface in enumerate(surfaces):
        given = np.zeros((0, 3))
        if found:  # the first patch has shown that the spacing suits the surface
            rim = Samples.of(surface).rim(_BORDER * least)
            given = np.concatenate(
                [
                    one.mesh.vertices[_on(one.mesh, rim, least) & (one.traced.tag < _CORNER)]
                    for one in found
                ]
            )
        found.append(trace(surface, spacing, **shared[k], ends=given if len(given) else None))
    meshes = [one.mesh for one in found]
    whole = joined(meshes, _shared(surfaces, meshes, least), least)
    tag = np.zeros(whole.mesh.n_vertices, dtype=np.int64)
    for one, index in zip(found, whole.index, strict=True):
        keep = index >= 0
        np.maximum.at(tag, index[keep], one.traced.tag[keep])
    tag = np.where(whole.mesh.boundary_vertex, tag, 0)
    return Patches(tuple(surfaces), tuple(found), whole, tag, _joints(surfaces, whole), least)


_CORNER: Final = 2


def _on(mesh: Mesh, rim: Floats, spacing: float) -> Any:
    """(V,) which rim vertices of a mesh lie on another rim, given by points."""
    near = cKDTree(rim).query(mesh.vertices)[0] < 2 * _BORDER * spacing
    return near & mesh.boundary_vertex


def _shared(
    surfaces: Sequence[SplineSurface], meshes: Sequence[Mesh], spacing: float
) -> list[list[Ints]]:
    if len(surfaces) == 1:
        return [[np.zeros(0, dtype=np.int64)]]
    rims = [Samples.of(surface).rim(_BORDER * spacing) for surface in surfaces]
    return [
        [
            np.flatnonzero(_on(mesh, rims[j], spacing)) if i != j else np.zeros(0, dtype=np.int64)
            for j in range(len(surfaces))
        ]
        for i, mesh in enumerate(meshes)
    ]


def _split(surfaces: Sequence[SplineSurface], ways: dict[str, Any]) -> list[dict[str, Any]]:
    """The same settings for each patch, points to run through only for the nearest one."""
    through = ways.get("through")
    if through is None or len(surfaces) == 1:
        return [dict(ways) for _ in surfaces]
    points = np.asarray(through, dtype=np.float64)
    trees = [cKDTree(Samples.of(surface).points) for surface in surfaces]
    owner = np.argmin([tree.query(points)[0] for tree in trees], axis=0)
    return [
        ways | {"through": points[owner == k] if (owner == k).any() else None}
        for k in range(len(surfaces))
    ]


def _joints(surfaces: Sequence[SplineSurface], whole: JoinedMeshes) -> tuple[str, ...]:
    if len(surfaces) == 1:
        return ()
    rows = []
    for i, j, together, alone, moved in whole.borders:
        text = f"border of {surfaces[i].name} and {surfaces[j].name}: {together} nodes together"
        if moved > 0:
            text += f" (moved {moved:.3g} at most)"
        if alone:
            text += f", {alone} lines end there on one side only: the face beyond has a corner more"
        rows.append(text)
    linked = {k for i, j, *_ in whole.borders for k in (i, j)}
    rows += [
        f"{surface.name} has no border with the other patches"
        for k, surface in enumerate(surfaces)
        if k not in linked
    ]
    return tuple(rows)
