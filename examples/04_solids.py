"""Solids in your hands: the pieces as labelled build123d and cadquery objects, to model on."""

from __future__ import annotations

from fabrication import design


def main() -> None:
    """One node of a small canopy as build123d and as cadquery see it."""
    roof = design(net={"kind": "canopy", "panels_along": 6, "panels_across": 4})
    compound = roof.to_build123d()
    nodes = next(group for group in compound.children if group.label == "Nodes")
    node = nodes.children[0]
    print(f"build123d: {node.label}, {len(node.faces())} faces, {node.volume / 1e3:.1f} cm3")
    assembly = roof.to_cadquery()
    piece = assembly.objects[node.label]
    print(f"cadquery: {piece.name} is part number {piece.metadata['number']}")


if __name__ == "__main__":
    main()
