"""Kinds of parts, one room each: what is made, when it is congruent, its boundary and dimensions.

A kind is a `fabrication.specs.Kind` and one or more records with the methods of
`fabrication.specs.Shape`. Nothing lists the kinds there are: a piece brings its own.
"""
