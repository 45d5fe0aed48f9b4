"""What planar faces of a mesh will cost, printed before solving: in inspect, make and optimize."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any, Final

from ddgfab.errors import DegenerateError
from ddgfab.measures import not_a_disk
from ddgfab.mesh import Mesh
from ddgfab.optimize import Forecast, better_diagonals, doubtful, expected, forecast_text

MOST_FACES: Final = 20_000
"""Larger meshes have no forecast: it costs as much as a step of the optimization (seconds)."""


def foreseen(mesh: Mesh) -> Forecast | None:
    """The forecast of planar faces for a mesh [mm].

    None where faces are planar, where the mesh is large, or has faces without area.
    """
    if mesh.n_faces > MOST_FACES:
        return None
    try:
        return expected(mesh)
    except DegenerateError:
        return None


def foreseen_text(mesh: Mesh) -> str:
    """The forecast as a sentence; empty where there is none."""
    forecast = foreseen(mesh)
    return "" if forecast is None else _text(mesh, forecast)


def _text(mesh: Mesh, forecast: Forecast) -> str:
    """The sentence, with the net of diagonals where that is better."""
    diagonals = better_diagonals(mesh) if doubtful(forecast) else None
    return forecast_text(forecast, "mm", diagonals, traceable=not not_a_disk(mesh))


def diagonals_are_better(mesh: Mesh) -> bool:
    """Whether a mesh cannot be planar near its surface, and the net of its diagonals can."""
    forecast = foreseen(mesh)
    return forecast is not None and doubtful(forecast) and better_diagonals(mesh) is not None


def foreseen_record(mesh: Mesh) -> dict[str, Any] | None:
    """The forecast ready for JSON: lengths [mm], and the sentence."""
    forecast = foreseen(mesh)
    if forecast is None:
        return None
    return {**asdict(forecast), "text": _text(mesh, forecast)}
