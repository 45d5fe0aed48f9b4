"""Import direction: ddgfab knows numpy and scipy only, rooms point one way, CAD stays in functions.

Prints each offence as file:line and exits with 1 if there is any.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
GEOMETRY_MAY_IMPORT = {"ddgfab", "numpy", "scipy"}
INSIDE_FUNCTIONS_ONLY = {
    "OCP",
    "build123d",
    "cadquery",
    "manifold3d",
    "pyvista",
    "vtk",
    "xlsxwriter",
    "pandas",
    "lib3mf",
    "rectpack",
    "reportlab",
    "rhino3dm",
}
# A room (module or folder) of ddgfab may import itself and the rooms before it.
GEOMETRY_ROOMS = [
    "errors",
    "instead",
    "arguments",
    "suggest",
    "tolerances",
    "symmetric",
    "mesh_tables",
    "mesh",
    "grid",
    "net",
    "trees",
    "quads",
    "circles",
    "io",
    "measures",
    "curvature",
    "surfaces",
    "trace",
    "support",
    "offsets",
    "nets",
    "transforms",
    "optimize",
    "redesign",
    "forms",
    "linkages",
    "__main__",
]
# A room of fabrication may import itself and the rooms before it.
ROOMS = [
    "crossing_curves",
    "boundary",
    "variants",
    "specs",
    "version",
    "progress",
    "processes",
    "standards",
    "solids",
    "drawings",
    "parts",
    "families",
    "checks",
    "meshes_in",
    "formats",
    "surfaces_in",
    "table",
    "cutting",
    "nesting",
    "project",
    "pictures",
    "handover",
    "job",
    "gridshell",
    "motion",
    "linkage",
    "cli",
    "start",
]

# Products share rooms, and know nothing of each other.
PRODUCTS = {"gridshell", "linkage"}


def imports(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and full module name of every import statement below a node."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.lineno, node.module or ""
            if node.module in ("ddgfab", "fabrication"):
                yield from ((node.lineno, f"{node.module}.{alias.name}") for alias in node.names)


def for_types(node: ast.stmt) -> bool:
    """Whether a statement is `if TYPE_CHECKING:`."""
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)


def module_level(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Imports that run when the module is imported (not those under TYPE_CHECKING)."""
    for node in tree.body:
        if for_types(node):
            continue
        if not isinstance(node, ast.FunctionDef | ast.ClassDef | ast.AsyncFunctionDef):
            yield from imports(node)


def offences(path: Path) -> Iterator[str]:
    """One line of text for each import in a file that points the wrong way."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    where = path.relative_to(ROOT)
    package, room = where.parts[0], where.parts[1].removesuffix(".py")
    if package == "ddgfab" and room not in ("__init__", *GEOMETRY_ROOMS):
        yield f"{where}:1: room {room} has no place in GEOMETRY_ROOMS"
    for line, name in imports(tree):
        top = name.split(".")[0]
        if top == "__future__" or not name:
            continue
        outside = top not in GEOMETRY_MAY_IMPORT and top not in sys.stdlib_module_names
        if package == "ddgfab" and outside:
            yield f"{where}:{line}: ddgfab imports {name}"
        if package == top and "." in name:
            target = name.split(".")[1]
            rooms = GEOMETRY_ROOMS if package == "ddgfab" else ROOMS
            known = room in rooms and target in rooms
            if known and rooms.index(target) > rooms.index(room):
                yield f"{where}:{line}: room {room} imports the later room {target}"
            if room != target and {room, target} <= PRODUCTS:
                yield f"{where}:{line}: product {room} imports product {target}"
    for line, name in module_level(tree):
        if name.split(".")[0] in INSIDE_FUNCTIONS_ONLY:
            yield f"{where}:{line}: {name} imported at module level"


def circles(package: Path) -> Iterator[str]:
    """One line of text for each circle of modules that import each other outside functions."""
    files = {
        ".".join(path.relative_to(package.parent).with_suffix("").parts).removesuffix(
            ".__init__"
        ): path
        for path in package.rglob("*.py")
    }
    graph: dict[str, set[str]] = {}
    for name, path in files.items():
        graph[name] = set()
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.FunctionDef | ast.ClassDef) or for_types(node):
                continue
            for part in ast.walk(node):
                if isinstance(part, ast.ImportFrom) and part.module in files:
                    inner = {f"{part.module}.{alias.name}" for alias in part.names}
                    graph[name] |= (inner & files.keys()) or {part.module}
    waiting = dict(graph)
    while free := [name for name, after in waiting.items() if not after & waiting.keys()]:
        for name in free:
            del waiting[name]
    while free := [
        name for name in waiting if not any(name in after for after in waiting.values())
    ]:
        for name in free:
            del waiting[name]
    if waiting:
        yield f"modules of {package.name} import each other in a circle: {', '.join(waiting)}"


def main() -> int:
    """Check both packages."""
    found = [
        text
        for package in ("ddgfab", "fabrication")
        for path in sorted((ROOT / package).rglob("*.py"))
        for text in offences(path)
    ]
    found += circles(ROOT / "ddgfab")
    found += circles(ROOT / "fabrication")
    print("\n".join(found) or "imports point one way")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
