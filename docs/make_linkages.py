"""docs/linkages.png: the kits of every kind in two poses, drawn off-screen by pyvista.

python docs/make_linkages.py
"""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

from PIL import Image

from fabrication.linkage.animation import animation_gif
from fabrication.linkage.kit import Kit, kit
from fabrication.linkage.scene import moving_scene

TARGET = Path(__file__).parent / "linkages.png"
SIZE = (400, 300)
COLORS = 48
# The part of the free range at which each is shown, below and above.
SHOWN = {"bennett": (0.25, 0.75), "cube": (0.35, 0.7), "knet": (0.45, 0.85), "crab": (0.45, 1.0)}


def pictures(made: Kit, shown: tuple[float, float]) -> list[Image.Image]:
    """The kit in two poses."""
    scene = moving_scene(made)
    at = [round(part * (len(scene.values_deg) - 1)) for part in shown]
    two = replace(
        scene, motions=scene.motions[at], values_deg=scene.values_deg[at], design=0, touches=()
    )
    drawn = Image.open(io.BytesIO(animation_gif(two, size=SIZE)))
    frames = []
    for place in (0, 1):
        drawn.seek(place)
        frames.append(drawn.convert("RGB"))
    return frames


def main() -> None:
    """Draw and write."""
    sheet = Image.new("RGB", (SIZE[0] * len(SHOWN), SIZE[1] * 2), "white")
    for column, (kind, shown) in enumerate(SHOWN.items()):
        made = kit(kind, cells=[5, 5], deltas_deg=[12.0, 12.0]) if kind == "knet" else kit(kind)
        for row, picture in enumerate(pictures(made, shown)):
            sheet.paste(picture, (column * SIZE[0], row * SIZE[1]))
    sheet.quantize(COLORS).save(TARGET, optimize=True)


if __name__ == "__main__":
    main()
