"""Support structure -> specs: beams, nodes and panels as plain numbers."""
