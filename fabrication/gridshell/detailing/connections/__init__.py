"""How beams are joined to nodes: a file for each kind of connection, and their registry.

A kind of connection is a subclass of `base.Connection`. It says what the beams' ends and the nodes
get, which fasteners each arm has, and what does not fit.
"""
