"""Drawings: one model of a sheet as plain data, filled from shapes; writers for PDF and DXF."""
