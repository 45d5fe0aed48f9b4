"""The product gridshell: from a mesh to beams, nodes and panels, their families and schedules."""
