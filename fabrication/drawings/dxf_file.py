"""What is around the entities of a DXF file: header, tables and objects, made by ezdxf once."""

from __future__ import annotations

import io
import logging
from functools import lru_cache
from typing import NamedTuple


class Layer(NamedTuple):
    """A layer: its name, color by index, width of its lines [0.01 mm], dashes and gaps [mm].

    width : -3 for the default of the program
    """

    name: str
    color: int
    width: int = -3
    dashes: tuple[float, ...] = ()


@lru_cache(maxsize=8)
def template(
    release: str, layers: tuple[Layer, ...], fonts: tuple[tuple[str, str], ...] = ()
) -> tuple[str, str, str]:
    """Text before and after the entities, and the handle of the model space.

    The text before has $SEED$ where the first free handle belongs. Release R12 names no unit.

    Parameters
    ----------
    fonts : names of text styles and their fonts
    """
    from ezdxf import options, units  # type: ignore[attr-defined]  # no __all__
    from ezdxf.filemanagement import new
    from ezdxf.lldxf import const

    log = logging.getLogger("ezdxf")
    level = log.level
    log.setLevel(logging.ERROR)  # it warns that R12 has no units
    fixed = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True  # no dates, no random ids
    try:
        document = new(release)
        if document.dxfversion > const.DXF12:
            document.units = units.MM
        else:  # that release has no such variable, and ezdxf warns of it
            del document.header["$INSUNITS"]
        for name, font in fonts:
            document.styles.add(name, font=font)
        for layer in layers:
            linetype = "CONTINUOUS"
            if layer.dashes:
                linetype = f"DDGFAB_{layer.name}"
                ways = [d if k % 2 == 0 else -d for k, d in enumerate(layer.dashes)]
                document.linetypes.add(linetype, [sum(layer.dashes), *ways])
            document.layers.add(
                layer.name, color=layer.color, linetype=linetype, lineweight=layer.width
            )
        stream = io.StringIO()
        document.write(stream)
    finally:
        options.write_fixed_meta_data_for_testing = fixed
        log.setLevel(level)
    text = stream.getvalue()
    start = "  2\nENTITIES\n"
    at = text.index(start) + len(start)
    before = text[:at]
    seed = before.index("$HANDSEED\n  5\n") + len("$HANDSEED\n  5\n")
    before = before[:seed] + "$SEED$" + before[before.index("\n", seed) :]
    return before, text[at:], document.modelspace().layout_key
