"""Surfaces that nets are traced on, from CAD files and by name."""
