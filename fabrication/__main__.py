"""`python -m fabrication` is the program `ddgfab`."""

from __future__ import annotations

from fabrication.start import main

if __name__ == "__main__":
    main()
