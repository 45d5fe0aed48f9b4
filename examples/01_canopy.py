"""A canopy of flat glass on torsion-free beams: from parameters to checked numbers and an OBJ."""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import gettempdir

import numpy as np

from ddgfab.forms import canopy
from ddgfab.io import write_obj
from ddgfab.measures import planarity
from ddgfab.support import support_structure


def main() -> None:
    """Write the canopy of the built-in example with fewer, larger panels."""
    roof = canopy(panels_along=24, panels_across=9, panel_mm=1600, flare=1.4)
    structure = support_structure(roof)
    target = Path(gettempdir()) / "canopy.obj"
    write_obj(target, roof)
    sys.stdout.write(
        f"{roof}\n{structure}\n"
        f"panels are planar to {planarity(roof).max():.1e} mm, "
        f"edges {roof.edge_lengths.min():.0f} to {roof.edge_lengths.max():.0f} mm, "
        f"median {np.median(roof.edge_lengths):.0f} mm\nwritten to {target}\n"
    )


if __name__ == "__main__":
    main()
