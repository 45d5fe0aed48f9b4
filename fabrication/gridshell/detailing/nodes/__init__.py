"""Nodes: what all kinds share, a file for each kind, and their registry.

A kind of node is a subclass of `base.NodeSize`: it sizes the nodes and gives the shape of each. To
add one, write its file, name it in `registry.MODULES`, and add keys that it alone has to [node].
"""
