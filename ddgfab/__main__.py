"""`python -m ddgfab` is the program `ddgfab`, which is installed beside this package."""

from __future__ import annotations

from importlib.metadata import entry_points

if __name__ == "__main__":
    found = list(entry_points(group="console_scripts", name="ddgfab"))
    if not found:
        raise SystemExit("error: the program ddgfab is not installed: pip install .")
    found[0].load()()
