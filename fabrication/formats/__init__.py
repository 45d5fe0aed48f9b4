"""Formats: one file or folder each, with all that is known of it."""
