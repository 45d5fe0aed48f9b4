"""Checks of meshes, solids and whole assemblies against what the specs state."""
