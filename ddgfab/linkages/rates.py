"""Bounds on the speeds and accelerations of a lattice of isograms."""
