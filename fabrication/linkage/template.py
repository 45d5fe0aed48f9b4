"""A commented project file of a linkage."""

from __future__ import annotations

from typing import Final

from fabrication.linkage.project import KitProject
from fabrication.project.template import template

BEGIN: Final = (
    "A project for `ddgfab linkage`, with every setting. What is not needed may be deleted: it "
    'then has its default. A line "# key =" is a setting that is not set. Units are in the names: '
    "_mm, _deg (degrees). Try it: ddgfab linkage FILE --dry-run"
)


def kit_template(project: KitProject) -> str:
    """The file of a project, with all keys."""
    return template(project, BEGIN)
