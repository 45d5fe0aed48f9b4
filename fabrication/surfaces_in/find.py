"""Surfaces by name or from a file, as commands and projects ask for them."""

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
from fabrication.surfaces_in.choice import FaceChoice

CAD_SUFFIXES: Final = (".step", ".stp", ".iges", ".igs")
"""Files that the CAD kernel reads."""

RHINO: Final = ".3dm"
"""Files of NURBS surfaces, or of meshes."""

MESH_SUFFIXES: Final = (".obj", ".off", ".ply", ".stl", RHINO)
"""Meshes, to which a smooth surface is fitted; millimetres unless they state their unit."""


def find_surfaces(
    source: str | Path,
    parameters: Mapping[str, Any] | None = None,
    faces: FaceChoice = None,
    *,
    units: str | None = None,
    scale: float = 1.0,
) -> list[SplineSurface]:
    """The surface of a name (`SURFACES`), faces of a file, or what is fitted to a mesh [mm].

    Of a Rhino file the NURBS surfaces count, or its meshes where it has none.

    Parameters
    ----------
    parameters : of a surface by name
    faces : of a file with several faces, see `fabrication.surfaces_in.choice.chosen`
    units, scale : of a mesh; no unit: the one that the file states, else millimetres

    Raises
    ------
    InputError
        An unknown name, another kind of file, or what its reader refuses.
    """
    text = str(source)
    suffix = Path(text).suffix.lower()
    known = (*CAD_SUFFIXES, *MESH_SUFFIXES)
    if suffix in known and text not in SURFACES:
        if parameters:
            raise InputError(
                f"{next(iter(parameters))} is for surfaces by name, not for files", file=text
            )
        return _of_file(Path(text), suffix, faces, units, scale)
    if faces is not None:
        raise InputError(f"face {faces}: only STEP, IGES and Rhino files have faces")
    if suffix and text not in SURFACES:
        raise InputError(
            f'unknown kind of surface file "{suffix}"; known: {", ".join(known)}, or a '
            f"surface by name: {', '.join(SURFACES)}"
        )
    return [named_surface(text, parameters)]


def _of_file(
    path: Path, suffix: str, faces: FaceChoice, units: str | None, scale: float
) -> list[SplineSurface]:
    if suffix in CAD_SUFFIXES:
        from fabrication.surfaces_in.cad import read_cad_surfaces

        return read_cad_surfaces(path, faces)
    if suffix == RHINO:
        from fabrication.surfaces_in.rhino import has_surfaces, read_rhino_surfaces

        if has_surfaces(path):
            if units is not None or scale != 1.0:
                raise InputError(
                    "units and scale are for meshes: NURBS surfaces are in the unit of the file",
                    file=str(path),
                )
            return read_rhino_surfaces(path, faces)
    if faces is not None:
        raise InputError("faces are chosen of STEP, IGES and Rhino surfaces", file=str(path))
    mesh = read_mesh(path, scale, units=units or STATED).in_place
    return [fit_mesh(mesh, name=path.name).surface]
