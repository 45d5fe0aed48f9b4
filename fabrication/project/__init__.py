"""Project files: TOML -> `Project`, validated, with errors that name the line and the key."""

from fabrication.project.load import load_project, make_project, project_for_mesh
from fabrication.project.models import MESH, OptimizeSettings, Project

__all__ = [
    "MESH",
    "OptimizeSettings",
    "Project",
    "load_project",
    "make_project",
    "project_for_mesh",
]
