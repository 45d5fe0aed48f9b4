"""Schedules by script: no CAD kernel, rows are plain dictionaries, columns of one's own."""

from __future__ import annotations

from pathlib import Path
from tempfile import gettempdir

from fabrication import design


def main() -> None:
    """The canopy on deeper beams: the longest ones with a price, and the heaviest panes."""
    roof = design(
        net={"kind": "canopy", "panels_along": 20, "panels_across": 8, "panel_mm": 1800},
        beam={"profile": "RHS 120x60x5"},
        panel={"thickness_mm": 16, "gap_mm": 15},
    )
    print(roof)
    long = roof.beams.filter(lambda row: row["length_cut_mm"] > 1900).sort("length_cut_mm")
    priced = long.with_column("price", lambda row: round(2.6 * row["mass_kg"], 2))
    target = Path(gettempdir()) / "long_beams.csv"
    priced.to_csv(target)
    print(f"{len(priced)} of {len(roof.beams)} beams are longer than 1.9 m: {target}")
    heaviest = roof.panels.sort("mass_kg", descending=True)[0]
    print(f"the heaviest pane is {heaviest['mark']}: {heaviest['mass_kg']:.1f} kg")


if __name__ == "__main__":
    main()
