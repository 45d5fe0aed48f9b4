"""Support structure -> specs: beams, nodes and panels as plain numbers."""

from fabrication.gridshell.detailing.gridshell import Gridshell, detail

__all__ = ["Gridshell", "detail"]
