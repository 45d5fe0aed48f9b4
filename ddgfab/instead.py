"""What to give instead of an object of the wrong class, for messages about arguments."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

_INSTEAD: Final = {
    ("Mesh", "array"): "its vertices are mesh.vertices, points of a net Net.from_mesh(mesh).points",
    ("Mesh", "KNet"): "recover_knet(Net.from_mesh(mesh)) finds one",
    ("Mesh", "SIsothermic"): "SIsothermic.of(mesh) makes one",
    ("Net", "array"): "its points are net.points",
    ("Net", "Mesh"): "net.to_mesh() is one",
    ("Net", "KNet"): "recover_knet(net) finds one",
    ("KNet", "array"): "its points are net.points",
    ("KNet", "Mesh"): "net.to_net().to_mesh() is one",
    ("SIsothermic", "array"): "its vertices are net.mesh.vertices",
    ("SIsothermic", "Mesh"): "its mesh is net.mesh",
    (
        "ndarray",
        "Mesh",
    ): "grid_mesh(points) makes one of a net, Mesh.build(vertices, faces) of faces",
    ("ndarray", "KNet"): "recover_knet(points) finds one",
    ("ReadResult", "Mesh"): "its mesh is result.mesh",
    ("Mesh", "Net"): "Net.from_mesh(mesh) makes one",
    ("KNet", "Net"): "net.to_net() is one",
    ("ndarray", "Net"): "Net.build(points) makes one",
}

_MAKERS: Final = {
    "Mesh": "Mesh.build(vertices, faces) or read_mesh(path).mesh makes one",
    "Net": "Net.build(points) makes one",
    "KNet": "knet(deltas, turns, corner_angles) makes one, recover_knet(net) finds one",
    "CrabNet": "crab_net(n_fold, delta, theta0, rings) makes one",
    "SIsothermic": "SIsothermic.of(mesh) makes one of a Koebe polyhedron or its like",
    "SupportStructure": "support_structure(mesh) makes one",
    "Pose": "mechanism.pose(t) is one",
    "SplineSurface": "fit_mesh(mesh).surface or a function of ddgfab.surfaces makes one",
    "Network": "place(field, spacing) makes one",
    "TracedMesh": "network_mesh(network) makes one",
    "MetricJet": "its doc string says what it holds",
    "Forecast": "result.forecast of an optimisation is one",
}
"""What makes an object of a class, where nothing better is known of what was given."""


def instead(value: Any, kind: str) -> str:
    """What to give instead of a value where an object of a class is needed; empty if not known."""
    advice = _INSTEAD.get((type(value).__name__, kind), "")
    if advice or kind not in _MAKERS:
        return advice
    for name, call in (("mesh", ""), ("to_mesh", "()"), ("net", ""), ("to_net", "()")):
        found = getattr(value, name, None)
        if kind == "Mesh" and name.endswith("mesh") and found is not None:
            return f"its mesh is .{name}{call}"
        if kind == "Net" and name.endswith("net") and found is not None:
            return f"its net is .{name}{call}"
    if isinstance(value, (str, Path)) and kind != "Mesh":
        return f"read_mesh(path).mesh reads a mesh; {_MAKERS[kind]}"
    return _MAKERS[kind]
