"""A surface by name or from a file, as commands and projects ask for it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from ddgfab.errors import InputError
from ddgfab.io import STATED
from ddgfab.surfaces.analytic import SURFACES, named_surface
from ddgfab.surfaces.fit import fit_mesh
from ddgfab.surfaces.spline import SplineSurface
from fabrication.meshes_in import read_mesh

CAD_SUFFIXES: Final = (".step", ".stp", ".iges", ".igs")
"""Files that the CAD kernel reads."""

MESH_SUFFIXES: Final = (".obj", ".off", ".ply", ".stl", ".3dm")
"""Meshes, to which a smooth surface is fitted; millimetres unless they state their unit."""


def find_surface(
    source: str | Path,
    parameters: Mapping[str, Any] | None = None,
    face: int | None = None,
    *,
    units: str | None = None,
    scale: float = 1.0,
) -> SplineSurface:
    """The surface of a name (`SURFACES`) of a STEP or IGES file, or fitted to a mesh [mm].

    Parameters
    ----------
    parameters : of a surface by name
    face : of a file with several faces, from 0
    units, scale : of a mesh; no unit: the one that the file states, else millimetres

    Raises
    ------
    InputError
        An unknown name, another kind of file, or what its reader refuses.
    """
    text = str(source)
    suffix = Path(text).suffix.lower()
    if suffix in CAD_SUFFIXES:
        if parameters:
            raise InputError(
                f"{next(iter(parameters))} is for surfaces by name, not for files", file=text
            )
        from fabrication.surfaces_in.cad import read_cad_surface

        return read_cad_surface(Path(text), face)
    if suffix in MESH_SUFFIXES:
        if parameters or face is not None:
            raise InputError("parameters and faces are not for meshes", file=text)
        mesh = read_mesh(Path(text), scale, units=units or STATED).in_place
        return fit_mesh(mesh, name=Path(text).name).surface
    if face is not None:
        raise InputError(f"face {face}: only STEP and IGES files have faces")
    known = (*CAD_SUFFIXES, *MESH_SUFFIXES)
    if suffix and text not in SURFACES:
        raise InputError(
            f'unknown kind of surface file "{suffix}"; known: {", ".join(known)}, or a '
            f"surface by name: {', '.join(SURFACES)}"
        )
    return named_surface(text, parameters)
