"""The preview as a sheet: model on its soft shadow, a close-up in a ring where there is room."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from PIL.Image import Image

Pixels: TypeAlias = NDArray[np.uint8]  # (height, width, 3)

LENSES: Final = (0.58, 0.54, 0.50, 0.46, 0.42)
"""Diameters of the ring that are tried, as parts of the picture's height."""

_SHRINK: Final = 0.96  # the model becomes smaller by this until the least ring has room
_STEPS: Final = 12  # at most so often less one: to 0.64 of its size
_CORNERS: Final = ((True, False), (False, False), (False, True), (True, True))  # right?, low?
_AWAY: Final = (1.0, 0.75, 0.5, 0.25, 0.0)  # 1: the model is at the margin opposite to the ring
_EDGE: Final = 0.03  # white margin, as a part of the picture's height
_AIR: Final = 0.012  # between ring and model, likewise
_SOFT: Final = 0.008  # blur of the shadow, likewise
_SHADE: Final = 0.17  # how dark the shadow is, 1 is black
_THROUGH: Final = 0.3  # how much of it is seen through the model
_WHITE: Final = 248  # brighter is background
_COARSE: Final = 4  # room is looked for in squares of so many pixels
_INK: Final = (70, 76, 84)
_RING: Final = 2.0  # width of the frame of 1000 pixels of height
_SPOT: Final = 0.013  # radius of the small ring about the node, as a part of the height


@dataclass(frozen=True)
class SheetLayout:
    """Scale of the model, its shift [pixels], middle and radius of the ring [pixels]."""

    scale: float
    shift: tuple[float, float]
    middle: tuple[float, float]
    radius: float


def compose(
    model: Pixels,
    shade: Pixels,
    size: tuple[int, int],
    lens: Callable[[int], Pixels] | None = None,
    spot: tuple[float, float] = (0.0, 0.0),
) -> Pixels:
    """The finished picture.

    Parameters
    ----------
    model : the structure on white, of any multiple of the size
    shade : the ground, dark where the shadow is, of the size
    size : pixels across and down
    lens : draws the close-up, given the diameter of the ring in pixels; None for no close-up
    spot : the pixel of the model (across, down) that the close-up shows

    Raises
    ------
    RuntimeError
        Nothing was drawn.
    """
    from PIL import Image, ImageChops, ImageFilter

    drawn = Image.fromarray(model)
    small = drawn.resize(size, Image.Resampling.BOX)
    if int(np.asarray(small).min()) >= _WHITE:
        raise RuntimeError("the picture stayed empty")
    soft = Image.fromarray(shade).filter(ImageFilter.GaussianBlur(_SOFT * size[1]))
    soft = Image.composite(
        _faded(soft, _SHADE), _faded(soft, _SHADE * _THROUGH), _background(small)
    )
    whole = ImageChops.multiply(small, soft)
    if lens is None:
        return np.asarray(whole)
    layout = _layout(np.asarray(small), np.asarray(whole), size)
    whole = _moved(ImageChops.multiply(drawn, soft.resize(drawn.size)), size, layout)
    x, y = (layout.scale * at + by for at, by in zip(spot, layout.shift, strict=True))
    return np.asarray(_with_ring(whole, lens, layout, (x, y)))


def _faded(shade: Image, strength: float) -> Image:
    """A shadow as weak as wanted."""
    return shade.point([round(255 - strength * (255 - value)) for value in range(256)] * 3)


def _background(picture: Image) -> Image:
    """Mask of the white pixels."""
    return picture.convert("L").point([255 * (value >= _WHITE) for value in range(256)])


def png(picture: Pixels) -> bytes:
    """The bytes of a PNG."""
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(picture).save(stream, format="PNG")
    return stream.getvalue()


def _layout(model: Pixels, whole: Pixels, size: tuple[int, int]) -> SheetLayout:
    """The largest ring that fits in a corner, if need be beside a smaller model.

    With the model as large as it is, then smaller and away from the ring's corner; the shadow may
    pass beneath the ring, the model may not.
    """
    darkest = model.min(axis=2)
    for axis in (0, 1):
        steps = np.arange(0, darkest.shape[axis], _COARSE)
        darkest = np.minimum.reduceat(darkest, steps, axis=axis)
    rows, columns = np.nonzero(darkest < _WHITE)
    dots = np.stack([columns, rows], axis=1) * float(_COARSE)
    rows, columns = np.nonzero(whole.min(axis=2) < _WHITE)
    start = (float(columns.min()), float(rows.min()))
    extent = (float(columns.max() + 1) - start[0], float(rows.max() + 1) - start[1])
    for layout in _candidates(start, extent, size):
        here = dots * layout.scale + layout.shift
        gap = float(np.hypot(*(here - layout.middle).T).min()) - layout.radius
        if gap > _AIR * size[1]:
            break
    return layout


def _candidates(
    start: tuple[float, float], extent: tuple[float, float], size: tuple[int, int]
) -> Iterator[SheetLayout]:
    """Layouts from the best to the last resort, given where the model with its shadow is."""
    width, height = size
    edge = _EDGE * height
    for step in range(_STEPS):
        scale = _SHRINK**step
        spare = [
            max(whole - 2 * edge - scale * part, 0.0)
            for whole, part in zip(size, extent, strict=True)
        ]
        for lens, (right, low), away in product(LENSES, _CORNERS, _AWAY):
            radius = lens * height / 2
            middle = (
                width - edge - radius if right else edge + radius,
                height - edge - radius if low else edge + radius,
            )
            x, y = (
                edge + space * (1 + (-away if taken else away)) / 2 - scale * first
                for space, taken, first in zip(spare, (right, low), start, strict=True)
            )
            yield SheetLayout(scale, (x, y), middle, radius)


def _moved(drawn: Image, size: tuple[int, int], layout: SheetLayout) -> Image:
    """The model smaller and elsewhere on white."""
    from PIL import Image as Images

    small = (round(size[0] * layout.scale), round(size[1] * layout.scale))
    sheet = Images.new("RGB", size, "white")
    at = (round(layout.shift[0]), round(layout.shift[1]))
    sheet.paste(drawn.resize(small, Images.Resampling.LANCZOS), at)
    return sheet


def _with_ring(
    sheet: Image, lens: Callable[[int], Pixels], layout: SheetLayout, spot: tuple[float, float]
) -> Image:
    """The sheet with the close-up, a small ring about its node, and a line between them."""
    from PIL import Image as Images
    from PIL import ImageDraw

    fine = 3
    width = sheet.height * _RING / 1000
    little = max(_SPOT * sheet.height, 2.0)
    mask = Images.new("L", (sheet.width * fine, sheet.height * fine))
    pen = ImageDraw.Draw(mask)
    (x, y), radius = layout.middle, layout.radius
    towards = np.array(spot) - layout.middle
    towards /= np.linalg.norm(towards)
    line = [*(layout.middle + towards * radius), *(spot - towards * little)]
    pen.line([fine * float(c) for c in line], fill=255, width=round(fine * width))
    for (a, b), r in ((spot, little), ((x, y), radius)):
        disc = [fine * c for c in (a - r, b - r, a + r, b + r)]
        pen.ellipse(disc, outline=255, width=round(fine * width))
    disc_mask = Images.new("L", mask.size)
    ImageDraw.Draw(disc_mask).ellipse(
        [fine * c for c in (x - radius, y - radius, x + radius, y + radius)], fill=255
    )
    diameter = round(2 * radius)
    near = Images.fromarray(lens(diameter)).resize((diameter, diameter), Images.Resampling.BOX)
    under = Images.new("RGB", sheet.size, "white")
    under.paste(near, (round(x - radius), round(y - radius)))
    sheet = Images.composite(under, sheet, disc_mask.resize(sheet.size, Images.Resampling.BOX))
    ink = Images.new("RGB", sheet.size, _INK)
    return Images.composite(ink, sheet, mask.resize(sheet.size, Images.Resampling.BOX))
