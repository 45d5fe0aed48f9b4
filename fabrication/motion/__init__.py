"""Free motion of a mechanism: convex bodies, their contacts, and the range proven without gaps.

Knows mechanisms and bodies only; which parts the bodies stand for is `fabrication.linkage`'s.
"""
