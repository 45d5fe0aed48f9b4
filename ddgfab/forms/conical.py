"""The generator of conical nets: the conical partner of a bent and arched circular net."""

from __future__ import annotations

from typing import Annotated

from ddgfab.forms.generators import About, generator
from ddgfab.forms.placing import checked_forward, grounded
from ddgfab.forms.station_canopy import canopy_net
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Mesh
from ddgfab.nets.conical import circular_to_conical


@generator("conical")
def conical_roof(
    panels_along: Annotated[int, About("panels along the spine", 2, 1000)] = 14,
    panels_across: Annotated[int, About("panels across it", 2, 1000)] = 6,
    panel_mm: Annotated[float, About("side of a panel on the spine at mid-length", 1e-3)] = 1500.0,
    bend_deg: Annotated[float, About("swing of the spine to either side, as an S", -59, 59)] = 14.0,
    rise_deg: Annotated[
        float, About("slope at which the spine climbs at one end and falls at the other", -59, 59)
    ] = 9.0,
    arch_deg: Annotated[float, About("slope of the roof at its long eaves", -85, 85)] = 38.0,
    flare: Annotated[
        float, About("how much larger panels are at the wide end than at the narrow", 0.1, 10)
    ] = 1.5,
) -> Mesh:
    """Arched vault along an S-shaped spine whose panes all move by one distance: a conical net.

    Its faces lie in the planes across the normals of a circular net, so inner and outer glass
    skins can be parallel at one constant distance of faces.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.
    DegenerateError
        A bend so sharp that a panel folds over; names it.

    Source: `circular_to_conical`.
    """
    net = canopy_net(
        panels_along + 1,
        panels_across + 1,
        panel_mm,
        slopes_deg=(arch_deg, 0.0, -arch_deg),
        spine_deg=(bend_deg, rise_deg),
        turn=0.5,
        flare=flare,
    )
    return grid_mesh(grounded(checked_forward(circular_to_conical(net))))
