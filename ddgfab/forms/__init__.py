"""Forms that designers start from: generators of meshes in millimetres, and their registry.

A form is a module: the net of points it is made of, and the generator with its parameters.
"""

from __future__ import annotations

from ddgfab.forms.canal import canal_circles, canal_net
from ddgfab.forms.monge_surface import monge, profile_polyline
from ddgfab.forms.moulding import moulding_net
from ddgfab.forms.registry import generate, kinds
from ddgfab.forms.rotational import rotational_net
from ddgfab.forms.station_canopy import canopy
from ddgfab.forms.translation import translation_net

__all__ = [
    "canal_circles",
    "canal_net",
    "canopy",
    "generate",
    "kinds",
    "monge",
    "moulding_net",
    "profile_polyline",
    "rotational_net",
    "translation_net",
]
