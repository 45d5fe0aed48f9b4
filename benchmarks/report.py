"""report.html: seconds to write it, its size, milliseconds until a browser shows it, draw calls.

    python benchmarks/report.py [PROJECT OR MESH]

Without an argument the built-in canopy. The browser is a headless Chromium that renders in
software; its start is not counted.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
from pathlib import Path

from fabrication import design
from fabrication.job.run import make

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "fabrication"))
from browser import page

READY = "document.documentElement.dataset.ready === 'model' && view.dataset.calls"
ROUNDS = 5


def main() -> None:
    """Measure and print."""
    made = design(
        sys.argv[1] if len(sys.argv) > 1 else None,
        output={"formats": ["csv", "html"]},
        checks={"verify": "none"},
    )
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        result = make(made, Path(folder) / "out")
        path = result.folder / "report.html"
        print(f"{len(result.manifest['parts'])} pieces, {path.stat().st_size / 1e6:.2f} MB")
        print(f"written in {result.seconds['html of the whole']:.2f} s")
        opened = []
        for n in range(ROUNDS):
            with page(Path(folder) / f"profile{n}", path) as found:
                calls = found.wait(READY)
                opened.append(found.run("performance.now()"))
        print(f"opened in {statistics.median(opened) / 1000:.2f} s (median of {ROUNDS})")
        print(f"{calls} draw calls")


if __name__ == "__main__":
    main()
