"""Meshes and node axes that a script gives to `design`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import is_numeric
from ddgfab.errors import InputError, SupportError
from ddgfab.instead import instead
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize import OptimizeResult, TorsionFreeResult
from ddgfab.support import SupportStructure
from fabrication.gridshell.net_input import NetInput
from fabrication.gridshell.project import Project

Source: TypeAlias = (
    "str | Path | Mesh | tuple[Floats, Sequence[Sequence[int]]] | SupportStructure | "
    "OptimizeResult | None"
)
"""A project file, a mesh file, a mesh, (vertices, faces), a mesh with node axes (what
`support_structure` or `optimize` gave), or None for the built-in example."""


def given_mesh(source: Source, axes: ArrayLike | None) -> tuple[Mesh | None, ArrayLike | None]:
    """The mesh of a source that is not a file, and its node axes; None where there is none.

    Raises
    ------
    InputError
        A source of another type; axes with a source that has axes, or is a file.
    """
    carried: ArrayLike | None = None
    if isinstance(source, SupportStructure | TorsionFreeResult):
        carried = source.axes
    if isinstance(source, SupportStructure | OptimizeResult):
        source = source.mesh
    if isinstance(source, tuple) and len(source) == 2:
        source = Mesh.build(*source)
    if source is not None and not isinstance(source, (str, Path, Mesh)):
        advice = instead(source, "Mesh")
        raise InputError(
            f"design: source is of type {type(source).__name__}; a project or mesh file, a Mesh or "
            f"(vertices, faces) is needed{f' ({advice})' if advice else ''}"
        )
    if axes is None:
        return (source if isinstance(source, Mesh) else None), carried
    if carried is not None:
        raise InputError("design: axes are given twice, in source and as axes; leave one out")
    if not isinstance(source, Mesh):
        raise InputError(
            "design: axes go with a mesh given in Python: design(mesh, axes=axes); "
            "read_mesh(path).mesh is that of a file"
        )
    if not is_numeric(axes):
        raise InputError(
            f"design: axes are of type {type(axes).__name__}; an array of {source.n_vertices} x 3 "
            "numbers is needed, one axis a vertex"
        )
    return source, axes


def with_axes(net: NetInput, axes: ArrayLike, project: Project) -> NetInput:
    """The net with the node axes of a script, which have to keep the limits of the project.

    Raises
    ------
    InputError
        Settings that ask for other axes, or move the net.
    SupportError
        Axes of another shape, that are zero or not finite, that twist or lean beyond a limit;
        names vertex or edge, the value, and the key of the limit.
    """
    for section, key, value, usual in (
        ("support", "kind", project.support.kind, "auto"),
        ("optimize", "goal", project.optimize.goal, "none"),
    ):
        if value != usual:
            raise InputError(
                f'design: axes are given, and [{section}] {key} = "{value}" asks for others; leave '
                "one of the two out"
            )
    structure = SupportStructure.of(net.mesh, axes, "given")
    lean = np.degrees(structure.lean)
    vertex = int(lean.argmax())
    if np.median(lean[net.mesh.valences > 0]) > 90.0:
        raise SupportError(
            f"design: axes point to the other side of the surface: the axis of vertex {vertex} is "
            f"{lean[vertex]:.3g} deg from its normal; give -axes, or a mesh with its faces turned "
            "round"
        )
    limit = project.support.lean_limit_deg
    if lean[vertex] > limit:
        raise SupportError(
            f"design: the axis of vertex {vertex} leans by {lean[vertex]:.3g} deg, the limit is "
            f"{limit:g} ([support] lean_limit_deg)"
        )
    torsion, edge = np.degrees(structure.torsion), int(structure.worst_edges(1)[0])
    if torsion[edge] > project.checks.torsion_deg:
        i, j = net.mesh.edges[edge].tolist()
        raise SupportError(
            f"design: the axes twist edge {edge} (vertices {i} and {j}) by {torsion[edge]:.3g} "
            f"deg, the limit is {project.checks.torsion_deg:g} ([checks] torsion_deg)"
        )
    return replace(net, axes=structure.axes)
